"""Which balls of a run left its terrain and did not return, and where: of PREFIX.left.csv, or of the run's dumps."""
from pathlib import Path
from typing import Any, Dict, List, Mapping, NamedTuple, Optional

import numpy as np
from scipy import ndimage

from ..case import run_folders
from ..errors import SlopeError
from ..geometry import extent
from ..heads import GRAVITY
from ..survey.rasters import Raster
from . import dumps
from .deposit import Deposit
from .flow_path import snapshots

HEAD = "ball,volume,time,x,y,from_x,from_y"
FILE, DUMPS, NOTHING = "table", "dumps", "nothing left"      # where it is known from
HALVINGS = 40           # of a ball's way, to where it left
FLATTEST = 0.05         # fall over length: no mass is taken to run out flatter
LEAST = 10.0            # m of terrain that are added, or a multiple of it
AROUND = 1              # cells, of the place where a ball left: its speed there
HOLE = "a hole"
WINDS = ("east", "north", "west", "south")


class Gone(NamedTuple):
    """Balls that left, rows of arrays.

    volume: m3; place: local x y, where it left; start: where it started; within: m, how far it went between two
    looks at it, by which place may be off; source: FILE, DUMPS or NOTHING.
    """
    volume: np.ndarray
    place: np.ndarray
    start: np.ndarray
    within: np.ndarray
    source: str


class Ground(NamedTuple):
    """What is known of a run: thickness (m) on the raster, height of the ground, cells that the mass came from."""
    raster: Raster
    base: np.ndarray        # m, NaN without ground
    released: np.ndarray    # mask
    max_speed: np.ndarray   # m/s
    summary: Mapping[str, Any]

    @classmethod
    def of(cls, run: Deposit) -> Optional["Ground"]:
        """None of a run that has not all of it, as of an older version."""
        if not all(Path(f"{run.prefix}.{kind}.asc").is_file() for kind in ("arrival", "max_speed")) or \
                "travel" not in run.summary:
            return None
        arrival, speed = (run_folders.load_raster(run.prefix, kind, heights=False).z
                          for kind in ("arrival", "max_speed"))
        released = arrival == 0
        return cls(run.raster, run.base, released, speed, run.summary) if released.any() else None

    @property
    def known(self) -> np.ndarray:
        """Mask of the cells with ground."""
        return np.isfinite(self.base)

    @property
    def cell(self) -> float:
        return float(self.raster.transform.a)

    @property
    def middle(self) -> np.ndarray:
        """Of the mass that was released, local x y."""
        rows, columns = np.nonzero(self.released)
        return np.array(self.raster.transform @ (columns.mean() + 0.5, rows.mean() + 0.5))

    @property
    def gone(self) -> float:
        """m3 that are not above ground any more: beyond the edge, in a hole, or lost."""
        there = float(self.raster.z[self.known].sum()) * self.cell ** 2
        return float(self.summary["volume"]["released"]) - there


def read_balls_gone(prefix: Path, ground: Ground) -> Optional[Gone]:
    """The balls that left; None where nobody knows: a run of an older version without dumps.

    Raises SlopeError, which names the file, on a table that is not one.
    """
    path = Path(f"{prefix}.left.csv")
    if path.name in (ground.summary.get("files") or ()):
        return of_file(path)
    volume = ground.summary["volume"]
    if volume["off_grid"] + volume["lost"] == 0 and not ground.raster.z[~ground.known].any():
        return Gone(np.empty(0), np.empty((0, 2)), np.empty((0, 2)), np.empty(0), NOTHING)
    paths = snapshots(path.parent, ground.summary.get("stop", {}).get("step", -1))
    return of_dumps(paths, ground) if len(paths) > 1 else None


def of_file(path: Path) -> Gone:
    """Of fix deposit/grid."""
    try:
        head, *lines = path.read_text(encoding="ascii").splitlines()
    except (OSError, UnicodeDecodeError, ValueError) as error:
        raise SlopeError(path, f"must be the table of balls that fix deposit/grid writes, {HEAD}: "
                         f"{getattr(error, 'strerror', None) or 'it is none'}") from None
    columns = HEAD.count(",") + 1
    if head != HEAD:
        raise SlopeError(f"{path}: line 1", f"must be {HEAD}", head)
    table = np.empty((len(lines), columns))
    for number, line in enumerate(lines):
        try:
            table[number] = np.array(line.split(","), float)
        except ValueError:
            table[number] = np.nan
        if not np.isfinite(table[number]).all() or not table[number, 1] > 0:
            raise SlopeError(f"{path}: line {number + 2}", f"must be {columns} numbers, the volume > 0", line)
    return Gone(table[:, 1], table[:, 3:5], table[:, 5:7], np.zeros(len(table)), FILE)


# --- of dumps ---

def of_dumps(paths: List[Path], ground: Ground) -> Optional[Gone]:
    """To within a frame; None where they are no dumps of all of the mass, and of it alone."""
    summary, seen = ground.summary, np.empty(0)
    start = last = beyond = speed = np.empty((0, 2))
    size, out, there, steps = np.empty(0), np.empty(0, bool), np.empty(0, bool), []
    for path in paths:
        try:
            shot = dumps.last(path, ("diameter", "radius", "vx", "vy"))
        except SlopeError:
            return None
        ids, place = shot.of["id"], shot.place[:, :2]
        steps.append(shot.step)
        new = np.setdiff1d(ids, seen)
        if len(new):
            count = len(new)
            order = np.argsort(np.concatenate([seen, new]), kind="stable")
            seen = np.concatenate([seen, new])[order]
            start, last, beyond, speed = (np.concatenate([one, np.full((count, 2), np.nan)])[order]
                                          for one in (start, last, beyond, speed))
            size = np.concatenate([size, np.ones(count)])[order]
            out = np.concatenate([out, np.zeros(count, bool)])[order]
        at = np.searchsorted(seen, ids)
        there = np.isin(seen, ids)
        fresh = np.isnan(start[at, 0])
        start[at[fresh]] = place[fresh]
        above = over_ground(place, ground)
        last[at[above]], out[at[above]] = place[above], False
        left = ~above & ~out[at]
        beyond[at[left]], out[at[left]] = place[left], True
        if {"vx", "vy"} <= shot.of.keys():
            speed[at] = np.column_stack([shot.of["vx"], shot.of["vy"]])
        for key in ("diameter", "radius"):
            if key in shot.of:
                size[at] = shot.of[key] ** 3
    if len(seen) != summary["balls"]["released"]:
        return None
    interval = np.diff(steps).max() * summary["dt"]
    unseen = ~there & ~out      # gone between two looks: as far as it was fast
    beyond[unseen] = last[unseen] + np.nan_to_num(speed[unseen]) * interval
    mine = out | ~there
    last = np.where(np.isnan(last), beyond, last)
    place = edge(last[mine], beyond[mine], ground)
    volume = summary["volume"]["released"] * size / size.sum()
    return Gone(volume[mine], place, start[mine], np.hypot(*(beyond - last)[mine].T), DUMPS)


def over_ground(place: np.ndarray, ground: Ground) -> np.ndarray:
    """Whether places (n, 2) are above ground."""
    column, row = np.floor(~ground.raster.transform @ place.T).astype(int)
    rows, columns = ground.known.shape
    inside = (row >= 0) & (row < rows) & (column >= 0) & (column < columns)
    inside[inside] = ground.known[row[inside], column[inside]]
    return inside


def edge(above: np.ndarray, beyond: np.ndarray, ground: Ground) -> np.ndarray:
    """The last places above ground on straight ways from there."""
    low, high = np.zeros(len(above)), np.ones(len(above))
    for _ in range(HALVINGS):
        half = (low + high) / 2
        still = over_ground(above + half[:, None] * (beyond - above), ground)
        low, high = np.where(still, half, low), np.where(still, high, half)
    return above + low[:, None] * (beyond - above)


# --- where ---

def find_holes(known: np.ndarray) -> np.ndarray:
    """Cells without ground that do not lead to the edge, a mask with one cell more on each side."""
    unknown = ~np.pad(known, 1)
    parts, _ = ndimage.label(unknown, np.ones((3, 3)))
    return unknown & (parts != parts[0, 0])


def is_in_hole(x: float, y: float, known: np.ndarray, raster: Raster) -> bool:
    """Whether the cell without ground that is nearest to a place is one of a hole."""
    column, row = np.floor(~raster.transform @ np.array([x, y])).astype(int) + 1
    near = ndimage.distance_transform_edt(np.pad(known, 1), return_distances=False, return_indices=True)
    rows, columns = near.shape[1:]
    nearest = near[:, np.clip(row, 0, rows - 1), np.clip(column, 0, columns - 1)]
    return bool(find_holes(known)[tuple(nearest)])


def sides(gone: Gone, ground: Ground) -> np.ndarray:
    """Of each ball, the side on which it left: of WINDS, or HOLE."""
    holes = find_holes(ground.known)
    column, row = np.floor(~ground.raster.transform @ gone.place.T).astype(int) + 1
    near = ndimage.binary_dilation(holes, np.ones((3, 3)))
    rows, columns = holes.shape
    row, column = np.clip(row, 1, rows - 2), np.clip(column, 1, columns - 2)
    xlo, ylo, xhi, yhi = extent(ground.raster)
    x, y = gone.place.T
    to_edge = np.stack([xhi - x, yhi - y, x - xlo, y - ylo])
    wind = np.argmin(to_edge, axis=0)
    inner = to_edge.min(axis=0, initial=np.inf) > 1.5 * ground.cell       # of a terrain that is no rectangle
    dx, dy = (gone.place - ground.middle).T
    seen = np.where(np.abs(dx) >= np.abs(dy), np.where(dx > 0, 0, 2), np.where(dy > 0, 1, 3))
    names = np.array(WINDS, object)[np.where(inner, seen, wind)]
    return np.where(near[row, column] & inner, HOLE, names)


def terrain_to_add(places: np.ndarray, ground: Ground) -> float:
    """m of terrain beyond places (n, 2) of the edge, for the mass that leaves there to come to rest on it.

    As far as its largest speed there carries it over level ground, at the reach angle of the run; rounded up.
    """
    fastest = ndimage.maximum_filter(np.nan_to_num(ground.max_speed), 2 * AROUND + 1)
    column, row = np.floor(~ground.raster.transform @ places.T).astype(int)
    rows, columns = fastest.shape
    speed = fastest[np.clip(row, 0, rows - 1), np.clip(column, 0, columns - 1)].max()
    fall = max(FLATTEST, np.tan(np.radians(ground.summary["travel"]["reach_angle"])))
    return float(LEAST * np.ceil(max(1.0, speed ** 2 / (2 * GRAVITY * fall) / LEAST)))


def groups(gone: Gone, ground: Ground, where: Optional[np.ndarray] = None,
           distance: Optional[np.ndarray] = None) -> List[Dict[str, Any]]:
    """What left on each side, the most first.

    where, distance: of each ball, on which side of the road it was, and m to it. An entry has side, volume (m3), balls,
    where and distance (the mean), and add: m of terrain, None of a hole.
    """
    side = sides(gone, ground)
    part = np.full(len(side), "") if where is None else where
    sums: List[Dict[str, Any]] = []
    for name, beside in sorted(set(zip(side.tolist(), part.tolist()))):
        mine = (side == name) & (part == beside)
        one: Dict[str, Any] = {"side": name, "volume": float(gone.volume[mine].sum()), "balls": int(mine.sum())}
        if where is not None and distance is not None:
            one.update(where=beside, distance=float(np.average(distance[mine], weights=gone.volume[mine])))
        one["add"] = None if name == HOLE else terrain_to_add(gone.place[mine], ground)
        sums.append(one)
    return sorted(sums, key=lambda group: -group["volume"])


def list_gone_groups(run: Deposit) -> Optional[List[Dict[str, Any]]]:
    """groups() of a run without a road; None where it is not known what left."""
    ground = Ground.of(run)
    left = ground and read_balls_gone(Path(run.prefix), ground)
    return groups(left, ground) if ground and left else None
