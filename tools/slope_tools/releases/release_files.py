"""The files of a release: rasters with their sidecars, picture, numbers, lines of the deck; all of them or none."""
import os
from pathlib import Path
from typing import Iterable, List

import numpy as np
from scipy.ndimage import binary_dilation

from ..digits import rounded
from ..disk import complete, write_yaml
from ..errors import SlopeError
from ..findings import encode_findings
from ..provenance import version
from ..survey import rasters
from ..survey.rasters import Raster, crs_name
from . import release_deck, release_solve
from .release import Body, Wanted
from .release_area import Area

ROOM = 1.0      # m, of the box below and above the body
GROUND = ".ground.asc", ".ground.yaml"      # before the collapse, where that is not the terrain that was given
SUFFIXES = (".slip.asc", ".slip.yaml", ".depth.asc", ".depth.yaml", ".png", ".yaml", ".deck.txt")


def paths(name: Path, raised: bool = False) -> List[Path]:
    """All files of a body; raised: the ground before is one of them, which is the terrain with the mass on it."""
    return [name.with_name(name.name + suffix) for suffix in (*SUFFIXES, *GROUND[:2 * raised])]


def check_release_files(name: Path, inputs: Iterable[str]) -> None:
    """Raise SlopeError if the files cannot be written to NAME, or would take the place of an input."""
    if name.name in ("", ".", "..") or name.is_dir():
        raise SlopeError("-o", "must be the first part of the files' names, not a folder", name)
    if not name.parent.is_dir():
        raise SlopeError("-o", "must be in an existing folder", name)
    for source in inputs:
        sidecar = [Path(source).with_suffix(".yaml")] if Path(source).suffix == ".asc" else []
        for path in (Path(source), *sidecar):
            for made in paths(name, raised=True):
                if made.exists() and path.exists() and made.samefile(path):
                    raise SlopeError("-o", f"must be another name: {made} belongs to an input", name)


def part_of(area: Area, slip: np.ndarray):
    """Where the nodes of an area are in its raster."""
    return tuple(slice(first, first + size) for first, size in zip(area.corner, slip.shape))


def ground_without(raster: Raster, area: Area, slip: np.ndarray) -> np.ndarray:
    """The heights (m) of a raster without a body; slip: those on the nodes of the area."""
    whole = raster.z.copy()
    whole[part_of(area, slip)] = slip
    return whole


def write_release_files(name: Path, terrain: str, raster: Raster, area: Area, slip: np.ndarray, summary: dict, geometry,
                        title: str) -> None:
    """Write all files of a body beside their names and then rename them.

    slip: the ground without the body (m) on the nodes of the area; summary: what NAME.yaml says; geometry: the release
    polygon or None.
    """
    from . import release_chart     # matplotlib: only once the body is there

    whole, depth = ground_without(raster, area, slip), np.full(raster.z.shape, np.nan)
    part = part_of(area, slip)
    depth[part] = np.where(slip < area.z, area.z - slip, np.nan)
    sidecar = {"terrain": str(terrain), "release": name.name + ".yaml"}
    with complete(name.parent, name.name + ".yaml", name) as folder:
        made = dict(zip(SUFFIXES, paths(folder / name.name)))
        rasters.write_asc_local(made[".slip.asc"], raster._replace(z=whole), sidecar, exact=True)
        rasters.write_asc_local(made[".depth.asc"], raster._replace(z=depth), sidecar, exact=True)
        release_chart.draw_release(made[".png"], raster, area, slip, geometry, title)
        write_yaml(made[".yaml"], summary, "slope release: lengths in m, local x y, volumes in m3, angles in degrees")
        made[".deck.txt"].write_text(release_deck.make_deck_lines(deck_body(name, terrain, raster, area, slip)),
                                     encoding="utf-8")


def write_body(name: Path, wanted: Wanted, body: Body, raised: bool = False) -> None:
    """Write all files of what release.body_of() gave; raised: the ground before, too."""
    given, ground = wanted, name.with_name(name.name + GROUND[0])
    if raised:
        wanted = wanted._replace(terrain=str(ground))
    about = {"slope_version": version(), "terrain": wanted.terrain, "polygon": wanted.polygon, **body.choices,
             "body": body.measures._asdict(), "cell": body.area.cell, "crs": crs_name(body.raster.crs),
             "origin": {"east": float(body.raster.offset[0]), "north": float(body.raster.offset[1])},
             "warnings": encode_findings(body.warnings)}
    write_release_files(name, wanted.terrain, body.raster, body.area, body.slip, about, body.geometry,
                        f"{name.name}: {body.measures.volume:,.0f} m\u00b3, up to "
                        f"{rounded(body.measures.largest_depth, 3)} m deep")
    if raised:      # the mass lies on top of the terrain that was given
        rasters.write_asc_local(ground, body.raster, {"sources": [given.terrain, given.scar], "steps": [
            "terrain and the height of the mass on it"]}, exact=True)


def deck_body(name: Path, terrain: str, raster: Raster, area: Area, slip: np.ndarray) -> release_deck.Body:
    """What the lines of the deck need to know; its paths are those from the folder of NAME."""
    depth = area.z - slip
    reached = binary_dilation(depth > 0, np.ones((3, 3)))    # the body ends at the nodes around those that are in it
    row, column = np.nonzero(reached)
    box = (area.x[column.min()], area.x[column.max()], area.y[row.max()], area.y[row.min()],
           float(slip[reached].min()) - ROOM, float(area.z[reached].max()) + ROOM)
    return release_deck.Body(os.path.relpath(terrain, name.parent), name.name + ".slip.asc", name.name,
                             release_solve.compute_volume(depth, area.cell), area.cell,
                             max(0.0, float(np.nanmin(raster.z)) - float(np.nanmin(slip))), box,
                             float(np.nanmax(depth)))
