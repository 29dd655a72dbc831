"""What a site may have beside terrain, body and road: structures, control lines, the motion of an earthquake.

Each is read, checked, brought to the terrain's local metres, and written into the site's folder for the deck.
"""
import re
import shutil
from pathlib import Path
from typing import Iterable, List, NamedTuple, Optional, Set, Tuple

import numpy as np
from rasterio.crs import CRS
from scipy.ndimage import binary_erosion

from .. import disk
from ..errors import SlopeError
from ..geometry import extent
from ..quakes import motion_file
from ..survey import lines, polygons, vectors
from ..survey.rasters import Raster, crs_name
from ..survey.resampling import sample
from . import site_walls

# names of the deck's own fixes and groups, and of files that a run writes beside them
WITHOUT_HEIGHT = "must be given with --wall: of the wall above the ground, m"
TAKEN = {"all", "soil", "slip", "beyond", "field", "spread", "move", "weight", "deposit", "rest", "shake", "drag",
         "stands", "fails", "balls", "road", "release", "observed", "terrain", "body", "ground", "base", "summary",
         "calm"}
MOTION = "motion.txt"


class Structure(NamedTuple):
    """A mesh for fix wall/gran/mesh."""
    name: str               # ID of its fix
    file: str               # in the site's folder
    move: Tuple[float, float, float]        # from its coordinates to local metres
    point: Tuple[float, float, float]       # middle of its foot, local metres
    low: np.ndarray         # its box, local metres
    high: np.ndarray
    triangles: int
    above: float            # m, its highest point above the ground there; of a wall along a line its height
    given: str = ""         # the option that it is of

    @property
    def summary(self) -> str:
        where = "local metres" if not any(self.move) else "coordinates of the terrain's CRS"
        size = " x ".join(f"{side:.4g}" for side in self.high - self.low)
        return f"{self.file}: {self.triangles} triangles in {where}, {size} m"


class Line(NamedTuple):
    """A control line."""
    name: str
    file: str
    points: np.ndarray      # local x, y


class Motion(NamedTuple):
    """An acceleration of the ground."""
    file: str
    length: float           # s
    peak: float             # largest horizontal acceleration, m/s2
    values: np.ndarray      # rows t ax ay az


def unused(stem: str, taken: Set[str]) -> str:
    """A name for a fix that no other has, from that of a file; it is then taken."""
    name = re.sub(r"\W", "_", stem, flags=re.ASCII) or "one"
    if name in taken:
        name = next(f"{name}_{k}" for k in range(2, 10 ** 6) if f"{name}_{k}" not in taken)
    taken.add(name)
    return name


def stem(name: str) -> str:
    """Of a file, or of the layer of it that a name has: what its fix may be called."""
    where = vectors.source(name)
    return where.layer or Path(where.path).stem


# --- structures ---

def corners(path: str) -> np.ndarray:
    """The corners of the triangles of an STL file, text or binary: an array (triangles, 3, 3)."""
    try:
        data = Path(path).read_bytes()
    except OSError as error:
        raise SlopeError(path, f"must be an STL file ({error.strerror})") from None
    if len(data) >= 84 and len(data) == 84 + 50 * int.from_bytes(data[80:84], "little"):
        records = np.frombuffer(data, np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")]),
                                offset=84)
        points = records["corners"].astype(float)
    else:
        found = re.findall(rb"^\s*vertex\s+(\S+)\s+(\S+)\s+(\S+)\s*$", data, re.MULTILINE | re.IGNORECASE)
        try:
            points = np.array([[float(value) for value in point] for point in found]).reshape(-1, 3, 3)
        except ValueError:
            points = np.empty((0, 3, 3))
    if not len(points) or not np.isfinite(points).all():
        raise SlopeError(path, "must be an STL file of triangles, text or binary")
    return points


def structures(paths: Iterable[str], raster: Raster, folder: Path, taken: Set[str]) -> List[Structure]:
    """Copy STL files into a folder. Coordinates: local metres, or the terrain's CRS, as they fit."""
    return [structure(path, raster, folder, taken) for path in paths]


def structure(path: str, raster: Raster, folder: Path, taken: Set[str]) -> Structure:
    points = corners(path)
    low, high = points.min(axis=(0, 1)), points.max(axis=(0, 1))
    xlo, ylo, xhi, yhi = extent(raster)
    for move in ((0.0, 0.0, 0.0), (-float(raster.offset[0]), -float(raster.offset[1]), 0.0)):
        a, b = low + move, high + move
        if xlo <= a[0] and ylo <= a[1] and b[0] <= xhi and b[1] <= yhi:
            break
    else:
        raise SlopeError(path, "must lie within the terrain, in m, x east and y north: local "
                         f"{polygons.format_numbers((xlo, ylo, xhi, yhi))}, or that plus "
                         f"{polygons.format_numbers(raster.offset)} in " f"{crs_name(raster.crs)}",
                         polygons.format_numbers((*low[:2], *high[:2])))
    bottom, top = np.nanmin(raster.z), np.nanmax(raster.z)
    if not (a[2] <= top and b[2] >= bottom):
        raise SlopeError(path, f"must have heights (m) of the terrain, {bottom:.6g} to {top:.6g}",
                         f"{a[2]:.6g} to {b[2]:.6g}")
    name = unused(Path(path).stem, taken)
    copy(path, folder / f"{name}.stl")
    x, y, z = (points + move).reshape(-1, 3).T
    above = z - sample(raster, x, y)
    return placed(name, points + move, float(above[np.isfinite(above)].max(initial=0.0)))._replace(
        move=move, given=f"--structure {path}")


def placed(name: str, points: np.ndarray, above: float) -> Structure:
    """A mesh of triangles (n, 3, 3) in local metres."""
    low, high = points.min(axis=(0, 1)), points.max(axis=(0, 1))
    point = float(low[0] + high[0]) / 2, float(low[1] + high[1]) / 2, float(low[2])
    return Structure(name, f"{name}.stl", (0.0, 0.0, 0.0), point, low, high, len(points), above)


def walls(drawn: Iterable["Drawn"], raster: Raster, height: Optional[float], width: Optional[float], folder: Path,
          taken: Set[str], warn) -> List[Structure]:
    """Walls of a height and a width (m) along lines, which are written into a folder."""
    walls_ = []
    for path, crs, advice in drawn:
        if height is None:
            raise SlopeError("--height", WITHOUT_HEIGHT)
        line = one_line(lines.read_local(path, raster, False, advice=advice, crs=crs, warn=warn), path)
        wall = np.round(site_walls.triangles(path, line, raster, height, width or site_walls.WIDTH), 4)
        name = unused(stem(path), taken)
        disk.write_file(folder / f"{name}.stl", site_walls.stl(name, wall))
        walls_.append(placed(name, wall, height)._replace(given=f"--wall {path}"))
    return walls_


def check_beside_body(structures_: Iterable[Structure], folder: Path, raster: Raster, depth: np.ndarray) -> None:
    """SlopeError, which names the option, where one stands in a body of a depth (m) on the ground before; its rim, a
    cell, does not count.
    """
    body = binary_erosion(depth > 0)
    if not body.any():
        return
    rows, columns = np.nonzero(body)
    x, y = raster.transform @ (np.array([columns.min(), columns.max() + 1]), np.array([rows.max() + 1, rows.min()]))
    for structure_ in structures_:
        mesh = corners(str(folder / structure_.file)) + structure_.move
        low, high = mesh[..., :2].min(axis=1), mesh[..., :2].max(axis=1)
        near = ((high >= (x[0], y[0])) & (low <= (x[1], y[1]))).all(axis=1)
        low, high = site_walls.heights_of(mesh[near], raster)
        if len(hit := np.argwhere(body & (low < raster.z) & (high > raster.z - depth))):
            row, column = hit[len(hit) // 2]
            place = polygons.decimetres(raster.transform @ (column + 0.5, row + 0.5))
            raise SlopeError(structure_.given, "must not stand in the release area, where it would be in the balls",
                             f"local x y {place}")


def one_line(geometry, path: str):
    """The one line that a file holds; SlopeError if it holds several."""
    if len(geometry.geoms) != 1:
        raise SlopeError(path, "must hold one line", f"{len(geometry.geoms)}, which are not joined end to end")
    return geometry.geoms[0]


# --- lines ---

class Drawn(NamedTuple):
    """A file with a control line."""
    path: str
    crs: Optional[CRS]          # assigned to it
    advice: polygons.Advice


def control_lines(files: Iterable[Drawn], raster: Raster, folder: Path, taken: Set[str], warn) -> List[Line]:
    """Write control lines in local metres into a folder."""
    written = []
    for path, crs, advice in files:
        line = one_line(lines.read_local(path, raster, False, advice=advice, crs=crs, warn=warn), path)
        points = np.round(np.asarray(line.coords)[:, :2], 4) + 0.0
        xlo, ylo, xhi, yhi = extent(raster)
        if not ((points >= (xlo, ylo)) & (points <= (xhi, yhi))).all():
            raise SlopeError(path, "must lie within the terrain, local x y "
                             f"{polygons.format_numbers((xlo, ylo, xhi, yhi))}",
                             polygons.format_numbers((*points.min(axis=0), *points.max(axis=0))))
        name = unused(stem(path), taken)
        rows = "".join(f"{x:.10g},{y:.10g}\n" for x, y in points.tolist())
        head = "# control line, local x,y in m; forward is from its left to its right\n"
        (folder / f"{name}.csv").write_text(head + rows, encoding="ascii")
        written.append(Line(name, f"{name}.csv", points))
    return written


# --- motion ---

def motion(path: str, folder: Path) -> Motion:
    """Copy the motion of the ground, lines "t ax ay az" in s and m/s2, into a folder."""
    values = motion_file.read_motion(path)
    copy(path, folder / MOTION)
    return Motion(MOTION, float(values[-1, 0]), motion_file.peak(values), values)


def copy(source: str, target: Path) -> None:
    try:
        shutil.copyfile(source, target)
    except OSError as error:
        raise SlopeError(error.filename2 or source, f"cannot be copied: {error.strerror}") from None
