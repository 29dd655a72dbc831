"""study.yaml, and which of a site's is the one: read by those who work on with it."""
import datetime
from dataclasses import replace
from pathlib import Path
from shlex import quote
from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Union

from .. import records, schemas
from ..case import run_folders
from ..errors import SlopeError
from ..findings import OTHER
from ..records import NoRecord
from ..schemas import OBJECT, TEXT, list_of, mapping
from . import rows as rows_, study_types
from .rows import finished_of

STUDY = "study.yaml"
INSIDE = "study", "ensemble"        # folders of a site: the sweep, and the ensemble of known events
TITLE = "slope study: volumes in m3 of ground (bulk), lengths in m, times in s"
WHAT = "what `slope study` wrote, of this version (the same command rewrites it, and keeps the runs)"
SCHEMA = mapping({"runs": list_of(mapping({"run": TEXT, "status": TEXT}))})
# of one that may be of an older version
ANY = mapping({}, ensemble=mapping({}, null=True), study=OBJECT)


def find_governing_study(sweep: Path, ensemble: Path) -> Path:
    """Of the folders of both studies of a site that whose number it is; the one that there is, if it is one.

    What both files say of it where one command made them; else the study that was made last, as the files say.
    """
    there = [one for one in (ensemble, sweep) if (one / STUDY).is_file()]
    if len(there) < 2:
        return there[0] if there else sweep
    studies = {one: schemas.load_checked(one / STUDY, "what `slope study` wrote", ANY) for one in there}
    names = {(about.get("study") or {}).get("governs") for about in studies.values()}
    if len(names) == 1 and (named := [one for one in there if one.name in names]):
        return named[0]
    return max(there, key=lambda folder: made(studies[folder]))


def study_in(folder: Path, weighted: bool = False) -> Optional[Path]:
    """The folder of the study that a folder names: its own, else the one of a site that governs; None: there is none.

    weighted: of a site, rather the one whose runs known events weigh.
    """
    if (folder / STUDY).is_file():
        return folder
    sweep, ensemble = (folder / name for name in INSIDE)
    found = ensemble if weighted and weighs(ensemble) else find_governing_study(sweep, ensemble)
    return found if (found / STUDY).is_file() else None


def weighs(study: Path) -> bool:
    """Whether a folder has a study whose runs known events weigh."""
    if not (study / STUDY).is_file():
        return False
    about = schemas.load_checked(study / STUDY, "what `slope study` wrote", ANY).get("ensemble") or {}
    return bool((about.get("known_events") or {}).get("weights"))


def without_study(site: Path) -> SlopeError:
    """Of the folder of a site whose study is asked for and not made yet."""
    return SlopeError(site, f"must hold the study of this site: `slope study {quote(str(site))}` makes it and the "
                      "report", f"no {site / INSIDE[0] / STUDY}")


def made(study: Mapping[str, Any]) -> datetime.datetime:
    """When a study was, by its study.yaml; the beginning of time where that does not say it."""
    text = str((study.get("study") or {}).get("collected"))
    try:
        return datetime.datetime.fromisoformat(text).astimezone(datetime.timezone.utc)
    except ValueError:
        return datetime.datetime.min.replace(tzinfo=datetime.timezone.utc)


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
        return cls(found, read_study(found / STUDY))

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
