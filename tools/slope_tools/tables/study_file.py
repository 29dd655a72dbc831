"""study.yaml, read by those who work on with it."""
from dataclasses import replace
from pathlib import Path
from typing import Any, Dict, List, Mapping, NamedTuple, Union

from .. import records, schemas
from ..case import run_folders
from ..errors import SlopeError
from ..findings import OTHER
from ..records import NoRecord
from ..schemas import TEXT, list_of, mapping
from . import rows as rows_, study_types
from .answered import STUDY as STUDY_FILE, study_in
from .rows import finished_of

WHAT = "what `slope study` wrote, of this version (the same command rewrites it, and keeps the runs)"
SCHEMA = mapping({"runs": list_of(mapping({"run": TEXT, "status": TEXT}))})


def load_study(path: Path) -> study_types.Study:
    """The study of a study.yaml; SlopeError if it is none of this version."""
    held = schemas.load_checked(path, WHAT, SCHEMA)
    try:
        study = records.read_record(study_types.Study, {**held, "runs": []})
    except NoRecord as error:
        raise SlopeError(path, f"must be {WHAT}: {error}") from None
    study = replace(study, runs=[row_of(path, one) for one in held["runs"]])
    rows, finished = study.runs, finished_of(study.runs)
    if not finished:
        raise SlopeError(path, "must have a finished run", f"{len(rows)} that failed")
    content, best, farthest = study.study, study.conservative, study.largest.get("front_m")
    if any(row.set.keys() != content.set.keys() for row in rows) or not (
            farthest and all(name in [row.run for row in finished] for name in ((best or farthest).run, farthest.run))):
        raise SlopeError(path, f"must be {WHAT}: runs, set, conservative and largest must be of one study")
    of_runs = study.ensemble.withheld if study.ensemble else []
    if any(one.kind == OTHER for one in (*(best.withheld if best else ()), *of_runs)):
        raise SlopeError(path, f"must be {WHAT}: withheld must have reasons of this version")
    if best and (not content.road or best.volume_m3 is None and not best.withheld
                 or not all(row.road for row in finished)):
        raise SlopeError(path, f"must be {WHAT}: conservative must have a volume, or why it is withheld, and a road")
    return study


def read_study(path: Path) -> Dict[str, Any]:
    """The same for scripts: of values that YAML knows."""
    return encode_study(load_study(path))


def encode_study(study: study_types.Study) -> Dict[str, Any]:
    """What study.yaml has of a study: values that YAML and JSON know."""
    return {**records.encode_record(study), "runs": [rows_.encode_row(row) for row in study.runs]}


def row_of(path: Path, entry: Mapping[str, Any]) -> rows_.Row:
    """The row of an entry of study.yaml."""
    try:
        return rows_.read_row(entry)
    except NoRecord as error:
        raise SlopeError(f"{path}: run {entry['run']}", f"must be {WHAT}: {error}") from None


class Study(NamedTuple):
    """A study, read back; about: study.yaml."""
    folder: Path
    about: Dict[str, Any]

    @classmethod
    def read(cls, folder: Union[str, Path]) -> "Study":
        """That of its folder, or the one that governs of the folder of a site; SlopeError if there is none."""
        place = Path(folder)
        found = study_in(place) or place
        return cls(found, read_study(found / STUDY_FILE))

    @property
    def runs(self) -> List[Dict[str, Any]]:
        """A row for each run: its values (set, repeat), its numbers, how it ended."""
        return self.about["runs"]

    def prefix(self, run: str) -> Path:
        """Prefix of the rasters of a finished run, for deposits.deposit.read_deposit and others."""
        for row in self.runs:
            if row["run"] == run and "summary" in row:
                return run_folders.prefix_of(run_folders.summary_of(self.folder, row["summary"]))
        raise SlopeError(self.folder, "must have a finished run of that name", run)

    def frame(self) -> Any:
        """study.csv as a pandas.DataFrame: a row for each run, by its name."""
        try:
            import pandas
        except ImportError:
            raise SlopeError("pandas", "must be installed for a frame (Debian: python3-pandas)") from None
        return pandas.read_csv(self.folder / "study.csv", index_col="run")
