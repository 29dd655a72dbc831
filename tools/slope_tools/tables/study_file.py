"""study.yaml, read by those who work on with it."""
from pathlib import Path
from typing import Any, Dict, List, NamedTuple, Union

from .. import schemas
from ..case import run_folders
from ..errors import SlopeError
from ..schemas import ANY, FLAG, MAYBE as PERHAPS, NUMBER, OBJECT, TEXT, listed, mapping, numbers
from . import named_run
from .quantities import MAYBE
from .study_table import COLUMNS, ROAD_COLUMNS

WHAT = "what `slope study` wrote, of this version (the same command rewrites it, and keeps the runs)"
HEADLINE = mapping(     # the conservative volume
    {**dict.fromkeys(("volume_m3", "chance_m3", "size_m3", "scatter_m3", "degrees_of_freedom"), PERHAPS),
     **numbers("mean_m3", "remove_m3"), "kind": ANY, "repeats": ANY, "rounded": ANY, "run": TEXT}, null=True,
    withheld=listed(mapping({"text": TEXT, "remedy": TEXT}), null=True))        # none in older ones
STUDY = mapping(
    {"study": mapping({"deck": TEXT, "runs": NUMBER, "finished": NUMBER,
                       "set": {"type": "object", "additionalProperties": listed(ANY)}},
                      road=mapping(numbers("cut_angle", "mesh"), null=True)),
     "runs": listed(mapping({"run": TEXT, "status": TEXT, "set": OBJECT})), "conservative": HEADLINE,
     "largest": OBJECT},
    exceedance=listed(mapping(numbers("threshold_m", "area_in_any_run_m2", "area_in_every_run_m2")), null=True),
    envelope=mapping({"max_thickness": mapping({"file": ANY})}, null=True))
OTHERS = {"moving": FLAG, "at_rest": FLAG, "stop_reason": ANY, "end": ANY, "release": OBJECT,
          "summary": TEXT}      # columns of no number


def row_of(columns):
    """The schema of the row of a finished run."""
    return mapping({**{key: PERHAPS if key in MAYBE else NUMBER for key in (*columns, "moving_share")}, **OTHERS})


def read_study(path):
    """study.yaml as a dict, with all that its readers take from it; SlopeError if something is missing."""
    study = schemas.load(path, WHAT, STUDY)
    rows, about, best = study["runs"], study["study"], study["conservative"]
    finished = [row for row in rows if row["status"] == "finished"]
    if not finished:
        raise SlopeError(path, "must have a finished run", f"{len(rows)} that failed")
    schema = row_of((*COLUMNS, *(ROAD_COLUMNS if best else ())))
    for row in finished:
        schemas.check(row, schema, f"{path}: run {row['run']}", WHAT)
    farthest = study["largest"].get("front_m")
    if any(row["set"].keys() != about["set"].keys() for row in rows) or not (
            isinstance(farthest, dict) and all(one["run"] in [row["run"] for row in finished]
                                               for one in (best or farthest, farthest))):
        raise SlopeError(path, f"must be {WHAT}: runs, set, conservative and largest must be of one study")
    if best and (not about.get("road") or best["volume_m3"] is None and not best.get("withheld")):
        raise SlopeError(path, f"must be {WHAT}: conservative must have a volume, or why it is withheld, and a road")
    return study


class Study(NamedTuple):
    """A study, read back; about: study.yaml."""
    folder: Path
    about: Dict[str, Any]

    @classmethod
    def read(cls, folder: Union[str, Path]) -> "Study":
        """That of its folder, or the one that governs of the folder of a site; SlopeError if there is none."""
        place = Path(folder)
        found = named_run.study_in(place) or place
        return cls(found, read_study(found / "study.yaml"))

    @property
    def runs(self) -> List[Dict[str, Any]]:
        """A row for each run: its values (set, repeat), its numbers, how it ended."""
        return self.about["runs"]

    def prefix(self, run: str) -> Path:
        """Prefix of the rasters of a finished run, for deposits.deposit.read and others."""
        for row in self.runs:
            if row["run"] == run and "summary" in row:
                return run_folders.prefix_of(run_folders.summary_of(self.folder, row))
        raise SlopeError(self.folder, "must have a finished run of that name", run)

    def frame(self):
        """study.csv as a pandas.DataFrame: a row for each run, by its name."""
        try:
            import pandas
        except ImportError:
            raise SlopeError("pandas", "must be installed for a frame (Debian: python3-pandas)") from None
        return pandas.read_csv(self.folder / "study.csv", index_col="run")
