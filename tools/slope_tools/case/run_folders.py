"""The files of a run: its summary and the rasters that fix deposit/grid wrote."""
import hashlib
import os
from pathlib import Path
from typing import Any, Iterable, List, Mapping, Optional, Tuple, Union

from .. import disk, schemas
from ..errors import SlopeError
from ..schemas import ABOVE_0, ANY, COUNT, FLAG, MAYBE, NUMBER, OBJECT, TEXT, list_of, mapping, dict_of, number_keys
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
OF_STUDY = "what `slope study` wrote"
MAYBE_TEXT = {"type": ["string", "null"]}
DIGESTS = {"type": ["object", "null"], "additionalProperties": TEXT}   # {what: SHA-256}
# of VARIABLES and MARKER, also of older versions
BEGUN = mapping({}, set=dict_of(TEXT), variables=dict_of(TEXT), program=DIGESTS, environment=DIGESTS, inputs=DIGESTS,
                continued=list_of(OBJECT), ranks=COUNT, package=MAYBE_TEXT, lmp_sha256=MAYBE_TEXT)
ENDED = mapping({"summary": TEXT}, wall_seconds=NUMBER, environment=DIGESTS, inputs=DIGESTS)
WHAT = "a summary that fix deposit/grid wrote"
# what `slope volume`, `score` and `export` need of one, and what the others do
OF_DEPOSIT = mapping({"volume": mapping(number_keys("on_grid", "off_grid", "lost")), "time": NUMBER, "moving": FLAG,
                      "bulk_factor": ABOVE_0})
SUMMARY = mapping(
    {"volume": mapping({"released": ABOVE_0, **number_keys("on_grid", "off_grid", "lost", "residual")}),
     "travel": mapping(number_keys("front", "front_at_release", "centroid", "reach_angle"), quantiles=list_of(mapping(
         {"share": NUMBER, "distance": MAYBE, "reach_angle": MAYBE}), null=True)),
     "largest": mapping(number_keys("thickness", "max_thickness", "max_speed", "max_energy")),
     "stop": mapping({"step": NUMBER, "time": NUMBER, "reason": TEXT}),
     "grid": mapping({"cell": ABOVE_0, "extent": ANY}), "balls": mapping({"released": ABOVE_0, "lost": NUMBER}),
     "motion": {**mapping(number_keys("moving_share", "threshold"),
                          **number_keys("fast_share", "fast_volume", "fast_speed", "rest_share")),
                "dependentRequired": {"fast_share": ["fast_volume", "fast_speed"]}},
     "moving": FLAG, "ranks": NUMBER, "dt": ABOVE_0, "bulk_factor": ABOVE_0, "slope_version": ANY,
     "lammps_version": ANY},
    change_rate=NUMBER,     # older summaries, and other pair styles, have neither this nor the next two
    release=mapping({}, stiffness_number=MAYBE),
    guards=mapping(number_keys("largest_overlap", "deep_contacts", "energy_growth", "dangerous_builds")))


def summaries(folder):
    """The summaries of fix deposit/grid in a folder."""
    return sorted(Path(folder).glob("*.summary.yaml"))


def prefix_of(summary: Union[str, Path]) -> Path:
    """PREFIX of the rasters that belong to a summary."""
    return Path(str(summary).removesuffix(".summary.yaml"))


def summary_of(output: Path, summary: str) -> Path:
    """The summary that the row of a run names, in a study's folder; the runs may be in another one, that of a site."""
    return Path(os.path.normpath(output / summary))


def begun(folder: Path) -> Mapping[str, Any]:
    """What a study wrote before it made the run in a folder: its values, and the digests of what it depends on."""
    return _load(Path(folder) / VARIABLES)


def ended(folder: Path) -> Mapping[str, Any]:
    """What it wrote when the run was complete; empty while it is not."""
    path = Path(folder) / MARKER
    return _load(path) if path.exists() else {}


def _load(path: Path) -> Mapping[str, Any]:
    """One of both, which a command asks for many times."""
    def loaded() -> Mapping[str, Any]:
        return schemas.load_checked(path, OF_STUDY, BEGUN if path.name == VARIABLES else ENDED)
    return disk.read_once("run", path, loaded) if path.is_file() else loaded()


def load_summary(path, schema=SUMMARY):
    """The summary of fix deposit/grid as a dict, with all that the tools need of it."""
    return schemas.load_checked(path, WHAT, schema)


def state(folder: Path) -> str:
    """Digest that tells whether a run is the same: what was written at its end, and sizes and times of its files."""
    marker = folder / MARKER
    files = sorted((one.name, one.stat().st_size, one.stat().st_mtime_ns) for one in os.scandir(folder)
                   if one.is_file() and not one.name.startswith("."))
    return hashlib.sha256(repr([disk.sha256(marker) if marker.is_file() else None, files]).encode(
        "utf-8", "surrogateescape")).hexdigest()


def stamps(prefix: Path, names: Iterable[str]) -> List[Optional[Tuple[int, int]]]:
    """What tells whether rasters of a run are the same: sizes and times."""
    found = [Path(f"{prefix}.{name}.asc") for name in names]
    return [(one.stat().st_size, one.stat().st_mtime_ns) if one.is_file() else None for one in found]


def load_raster(prefix, name, heights=True):
    """One of the rasters of fix deposit/grid; heights: whether its values are checked as such."""
    path = Path(f"{prefix}.{name}.asc")
    if not path.is_file():
        raise SlopeError(path, "must be there: fix deposit/grid writes it beside its summary")
    return rasters.read_raster(path, heights)
