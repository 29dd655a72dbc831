"""The run that a name on the command line stands for; of a study or a site the one whose maps are on the first page."""
import re
from pathlib import Path
from typing import Any, Mapping, NamedTuple, Optional

from ..case.run_folders import OF_RUN, RASTERS, governing_run, prefix_of, summaries
from ..deposits import travel_shares
from ..errors import SlopeError
from . import answered

STUDY = "study.yaml"
INSIDE = "study", "ensemble"        # folders of a site: the paper's study, and the one of known events


class Named(NamedTuple):
    """A run; run, study: its name in the study that was named, None if another thing was."""
    prefix: str
    folder: Optional[Path]      # that was named, None if a prefix or a file was
    run: Optional[str] = None
    study: Optional[Path] = None


def study_in(folder: Path) -> Optional[Path]:
    """The folder of the study that a page on a folder shows: its own, else the one of a site that governs; or None."""
    if (folder / STUDY).is_file():
        return folder
    found = answered.governing(*(folder / name for name in INSIDE))
    return found if (found / STUDY).is_file() else None


def farthest(about: Mapping[str, Any]) -> Optional[str]:
    """The run of a study.yaml that went farthest; None where its rows do not say how far they went."""
    rows = [row for row in about.get("runs") or () if row.get("status") == "finished"]
    told = rows and all({"lost_m3", "released_m3", "front_m"} <= row.keys() for row in rows)
    return travel_shares.farthest(rows)["run"] if told else None


def read(name: str) -> Named:
    """The run of a prefix, of one of its rasters or its summary, of its folder, or the governing run of a study's or a
    site's folder; SlopeError if there is none, or several.
    """
    path = Path(name)
    if Path(f"{name}.thickness.asc").is_file() or not path.exists():
        return Named(name, None)
    if path.is_file():
        match = re.fullmatch(rf"(.+?)(?:\.\d+)?\.(?:{'|'.join(RASTERS)})\.asc|(.+)\.summary\.yaml", path.name)
        if not match:
            raise SlopeError(path, f"must be {OF_RUN}")
        return Named(str(path.with_name(match[1] or match[2])), None)
    study = study_in(path)
    if study:
        run, folder = governing_run(study / STUDY, farthest)
        inside = summaries(folder)
        if len(inside) != 1:
            raise SlopeError(folder, "must hold the governing run of the study, with its summary")
        return Named(str(prefix_of(inside[0])), path, run, study)
    here = summaries(path)
    if len(here) > 1:
        raise SlopeError(path, "must hold one run, or name one of them by its prefix",
                         ", ".join(str(prefix_of(one)) for one in here[:3]) + ", ..." * (len(here) > 3))
    if not here:
        raise SlopeError(path, f"must be {OF_RUN}: it holds neither a PREFIX.summary.yaml nor a study.yaml")
    return Named(str(prefix_of(here[0])), path)
