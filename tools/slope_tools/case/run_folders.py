"""The files of a run: its summary and the rasters that fix deposit/grid wrote."""
import re
from pathlib import Path
from typing import NamedTuple, Optional

from ..disk import is_number, load_yaml
from ..errors import SlopeError
from ..survey import rasters

RASTERS = {     # what fix deposit/grid writes, PREFIX.KIND.asc: quantity, unit
    "base": ("ground without the body", "m"),
    "surface": ("ground and deposit", "m"),
    "thickness": ("thickness of the deposit", "m"),
    "max_thickness": ("largest thickness so far", "m"),
    "max_speed": ("largest speed of a ball so far", "m/s"),
    "max_energy": ("largest kinetic energy of a ball so far", "J"),
    "arrival": ("time when the first ball came", "s"),
    "last_motion": ("time when a ball last moved", "s"),
}
OF_RUN = "output of fix deposit/grid: its prefix, one of its files, or the folder of a run, a study or a site"
VARIABLES = "variables.yaml"       # what `slope study` runs, written before the run
MARKER = "finished.yaml"           # written when the run is complete
SUMMARY_KEYS = {"volume": ("released", "on_grid", "off_grid", "lost", "residual"),
                "travel": ("front", "front_at_release", "centroid", "reach_angle"),
                "largest": ("thickness", "max_thickness", "max_speed", "max_energy"),
                "stop": ("step", "time", "reason"), "grid": ("cell", "extent"), "balls": ("released", "lost"),
                "motion": ("moving_share", "threshold"), "moving": (), "ranks": (), "dt": (), "bulk_factor": (),
                "slope_version": (), "lammps_version": (), "change_rate": (),
                "guards": ("largest_overlap", "deep_contacts", "energy_growth", "dangerous_builds")}
OPTIONAL = {"change_rate", "guards"}        # among them: older summaries, and other pair styles, have none
NO_NUMBERS = {"reason", "extent", "moving", "slope_version", "lammps_version"}    # among them
ABOVE_ZERO = {("volume", "released"), ("balls", "released"), ("grid", "cell"), ("dt", None), ("bulk_factor", None)}


def summaries(folder):
    """The summaries of fix deposit/grid in a folder."""
    return sorted(Path(folder).glob("*.summary.yaml"))


def prefix_of(summary):
    """PREFIX of the rasters that belong to a summary."""
    return Path(str(summary).removesuffix(".summary.yaml"))


class Named(NamedTuple):
    """The run that a name on the command line stands for."""
    prefix: str
    folder: Optional[Path]      # that was named, None if a prefix or a file was
    note: Optional[str]         # which run of several it is


def named_run(name: str) -> Named:
    """The run of a prefix, of one of its rasters or its summary, of its folder, or the governing run of a study's or a
    site's folder; SlopeError if there is none, or several.
    """
    path = Path(name)
    if Path(f"{name}.thickness.asc").is_file() or not path.exists():
        return Named(name, None, None)
    if path.is_file():
        match = re.fullmatch(rf"(.+?)(?:\.\d+)?\.(?:{'|'.join(RASTERS)})\.asc|(.+)\.summary\.yaml", path.name)
        if not match:
            raise SlopeError(path, f"must be {OF_RUN}")
        return Named(str(path.with_name(match[1] or match[2])), None, None)
    here = summaries(path)
    if len(here) > 1:
        raise SlopeError(path, "must hold one run, or name one of them by its prefix",
                         ", ".join(str(prefix_of(one)) for one in here[:3]) + ", ..." * (len(here) > 3))
    if here:
        return Named(str(prefix_of(here[0])), path, None)
    for study in (path / "study.yaml", path / "study" / "study.yaml"):
        if study.is_file():
            run = governing_run(study)
            inside = summaries(study.parent / run)
            if len(inside) != 1:
                raise SlopeError(study.parent / run, "must hold the governing run of the study, with its summary")
            return Named(str(prefix_of(inside[0])), path, f"{run}, the governing run of {study.parent}")
    raise SlopeError(path, f"must be {OF_RUN}: it holds neither a PREFIX.summary.yaml nor a study.yaml")


def governing_run(study: Path) -> str:
    """The folder of the run on which a study's answer rests, or which went farthest where it has none."""
    what = "what `slope study` wrote"
    about = load_yaml(study, what)
    try:
        best = about["conservative"]
        # studies of older versions have no farthest
        return str(best["run"] if best else about.get("farthest") or about["largest"]["front_m"]["run"])
    except (KeyError, TypeError) as error:
        raise SlopeError(study, f"must be {what} ({error!r})") from error


def load_summary(path):
    """The summary of fix deposit/grid as a dict, with all that the tools need of it."""
    about = load_yaml(path, "a summary that fix deposit/grid wrote")
    for key, entries in SUMMARY_KEYS.items():
        if key in OPTIONAL and key not in about:
            continue
        for entry in entries or (None,):
            if key not in about or (entry and (not isinstance(about[key], dict) or entry not in about[key])):
                raise SlopeError(path, "must be a summary that fix deposit/grid wrote, with "
                                 + (f"{key}: {entry}" if entry else key))
            value = about[key][entry] if entry else about[key]
            name = f"{key}: {entry}" if entry else key
            if (entry or key) not in NO_NUMBERS and not is_number(value):
                raise SlopeError(path, f"{name} must be a finite number", repr(value)[:60])
            if (key, entry) in ABOVE_ZERO and not value > 0:
                raise SlopeError(path, f"{name} must be > 0", value)
    if not isinstance(about["moving"], bool):
        raise SlopeError(path, "moving must be true or false", repr(about["moving"])[:60])
    return about


def load_raster(prefix, name, heights=True):
    """One of the rasters of fix deposit/grid; heights: whether its values are checked as such."""
    path = Path(f"{prefix}.{name}.asc")
    if not path.is_file():
        raise SlopeError(path, "must be there: fix deposit/grid writes it beside its summary")
    return rasters.read(path, heights)
