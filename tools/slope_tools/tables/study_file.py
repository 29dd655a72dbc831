"""study.yaml, read by those who work on with it."""
from pathlib import Path
from typing import Any, Dict, List, Mapping, NamedTuple, Union

from .. import schemas
from ..case import run_folders
from ..errors import SlopeError
from ..records import NoRecord
from ..schemas import ANY, MAYBE, NUMBER, OBJECT, TEXT, listed, mapping, numbers
from . import rows as rows_
from .answered import STUDY as STUDY_FILE, study_in
from .rows import finished_of

WHAT = "what `slope study` wrote, of this version (the same command rewrites it, and keeps the runs)"
HEADLINE = mapping(     # the conservative volume
    {**dict.fromkeys(("volume_m3", "chance_m3", "size_m3", "scatter_m3", "degrees_of_freedom"), MAYBE),
     **numbers("mean_m3", "remove_m3"), "kind": ANY, "repeats": ANY, "rounded": ANY, "run": TEXT}, null=True,
    withheld=listed(mapping({"text": TEXT, "remedy": TEXT}), null=True))        # none in older ones
QUANTILES = listed(mapping({"share": NUMBER, "value": MAYBE}), null=True)
QUANTITIES = {"type": "object", "additionalProperties": mapping({}, quantiles=QUANTILES)}
STUDY = mapping(
    {"study": mapping({"deck": TEXT, "runs": NUMBER, "finished": NUMBER,
                       "set": {"type": "object", "additionalProperties": listed(ANY)}},
                      road=mapping(numbers("cut_angle", "mesh"), null=True)),
     "runs": listed(mapping({"run": TEXT, "status": TEXT, "set": OBJECT})), "conservative": HEADLINE,
     "largest": OBJECT},
    exceedance=listed(mapping(numbers("threshold_m", "area_in_any_run_m2", "area_in_every_run_m2")), null=True),
    envelope=mapping({"max_thickness": mapping({"file": ANY})}, null=True),
    ensemble=mapping({}, null=True, of={"type": ["string", "null"]}, quantities=QUANTITIES,
                     known_events=mapping({}, null=True, quantities=QUANTITIES, to_remove=QUANTILES)),
    headline=mapping({}, null=True, source={"type": ["string", "null"]}, share=MAYBE, volume_m3=MAYBE))


def read_study(path: Path) -> Dict[str, Any]:
    """study.yaml as a dict, whose runs are rows.Row; SlopeError if something that its readers take is missing."""
    study = schemas.load(path, WHAT, STUDY)
    rows, about, best = [row_of(path, one) for one in study["runs"]], study["study"], study["conservative"]
    finished = finished_of(rows)
    if not finished:
        raise SlopeError(path, "must have a finished run", f"{len(rows)} that failed")
    farthest = study["largest"].get("front_m")
    if any(row.set.keys() != about["set"].keys() for row in rows) or not (
            isinstance(farthest, dict) and all(one["run"] in [row.run for row in finished]
                                               for one in (best or farthest, farthest))):
        raise SlopeError(path, f"must be {WHAT}: runs, set, conservative and largest must be of one study")
    if best and (not about.get("road") or best["volume_m3"] is None and not best.get("withheld")
                 or not all(row.road for row in finished)):
        raise SlopeError(path, f"must be {WHAT}: conservative must have a volume, or why it is withheld, and a road")
    return {**study, "runs": rows}


def plain(study: Mapping[str, Any]) -> Dict[str, Any]:
    """What study.yaml has of a study."""
    return {**study, "runs": [rows_.plain(row) for row in study["runs"]]}


def row_of(path: Path, one: Mapping[str, Any]) -> rows_.Row:
    """The row of an entry of study.yaml."""
    try:
        return rows_.read(one)
    except NoRecord as error:
        raise SlopeError(f"{path}: run {one['run']}", f"must be {WHAT}: {error}") from None


class Study(NamedTuple):
    """A study, read back; about: study.yaml."""
    folder: Path
    about: Dict[str, Any]

    @classmethod
    def read(cls, folder: Union[str, Path]) -> "Study":
        """That of its folder, or the one that governs of the folder of a site; SlopeError if there is none."""
        place = Path(folder)
        found = study_in(place) or place
        return cls(found, plain(read_study(found / STUDY_FILE)))

    @property
    def runs(self) -> List[Dict[str, Any]]:
        """A row for each run: its values (set, repeat), its numbers, how it ended."""
        return self.about["runs"]

    def prefix(self, run: str) -> Path:
        """Prefix of the rasters of a finished run, for deposits.deposit.read and others."""
        for row in self.runs:
            if row["run"] == run and "summary" in row:
                return run_folders.prefix_of(run_folders.summary_of(self.folder, row["summary"]))
        raise SlopeError(self.folder, "must have a finished run of that name", run)

    def frame(self):
        """study.csv as a pandas.DataFrame: a row for each run, by its name."""
        try:
            import pandas
        except ImportError:
            raise SlopeError("pandas", "must be installed for a frame (Debian: python3-pandas)") from None
        return pandas.read_csv(self.folder / "study.csv", index_col="run")
