"""The trial run of a site, which is kept: it is not repeated as long as nothing that it depends on has changed."""
import hashlib
from pathlib import Path
from typing import Any, Dict, List, Mapping, NamedTuple, Optional

from rasterio.transform import Affine

from .. import disk, provenance
from ..case import decks
from ..errors import SlopeError
from ..survey import rasters
from ..survey.rasters import Raster
from . import site_choices
from .site_budget import Trial

REACHED = "trial.tif"       # largest thickness of the trial run, m


class Tried(NamedTuple):
    """What a trial run measured, where its mass went, and of what it was."""
    trial: Trial
    reached: Raster             # largest thickness, m, in local metres
    about: Mapping[str, Any]    # digest of deck, data and machine; the rolling resistances, which those do not hold


def summarise_trial(folder: Path, deck: str, lmp: Path, rolling: List[float]) -> Dict[str, Any]:
    """Of a trial run whose files are in a folder."""
    named, _ = decks.named_files(folder / deck)     # a road or a mapped deposit is no matter
    parts = [repr(decks.without_comments(folder / deck)), disk.sha256(lmp), provenance.machine()["processor"]]
    parts += [path.name + disk.sha256(path) for path in sorted(folder.iterdir()) if path.name in named - {deck}]
    return {"sha256": hashlib.sha256("\n".join(parts).encode("utf-8", "surrogateescape")).hexdigest(),
            "rolling": rolling}


def kept(folder: Path, wanted: Dict[str, Any], settled: bool) -> Optional[Tried]:
    """What a site's folder has of such a trial run; None: nothing.

    settled: nothing is to be determined from it, so that its rolling resistances do not matter.
    """
    if not (folder / site_choices.NAME).is_file():
        return None
    site_found = site_choices.found(folder)
    had = site_found.trial_of
    if had.get("sha256") != wanted["sha256"] or not (settled or had.get("rolling") == wanted["rolling"]) or \
            site_found.trial is None:
        return None
    try:
        raster = rasters.read_raster(folder / REACHED, heights=False)
    except SlopeError:
        return None
    to_local = Affine.translation(-site_found.origin.east, -site_found.origin.north)
    return Tried(site_found.trial, raster._replace(transform=to_local @ raster.transform, crs=None), had)


def write_trial(folder: Path, tried: Tried, terrain: Raster) -> None:
    """Write where the mass went into a site's folder, in the terrain's CRS."""
    rasters.write_geotiff(folder / REACHED, {"largest thickness of the trial run, m": tried.reached.z},
                          tried.reached._replace(crs=terrain.crs, offset=terrain.offset))
