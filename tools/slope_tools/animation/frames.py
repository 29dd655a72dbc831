"""The balls of a run at several times, as its dumps have them, thinned out to what a page or a film can hold."""
import re
from typing import List, NamedTuple, Optional, Tuple

import numpy as np

from ..deposits import dumps
from ..deposits.flow_path import snapshots
from ..errors import SlopeError

MOST_FRAMES = 60        # snapshots that are taken, evenly spaced
FEWEST_FRAMES = 24      # before that many are left, snapshots are left out rather than balls
ENOUGH_BALLS = 15_000
MOST_PLACES = 600_000   # balls x snapshots; 8 bytes each, 6.4 MB in a page
MOST_BYTES = 1e9        # of dumps that are read, half a minute; but FEW of them, however large
FEW = 12
SECONDS = 0.5           # between the dumps that the page asks for
SEED = 20               # of the choice of the balls that are shown


class Frames(NamedTuple):
    """Balls at several times; rows of the arrays are times, columns are balls.

    time: s; place: x y z, m, NaN for a ball that is not there (yet, or any more); speed: m/s; diameter: m, of each
    ball as it is drawn; balls, dumped: how many of them the run has, and how many snapshots; factor: each drawn ball
    stands for so many.
    """
    time: np.ndarray
    place: np.ndarray
    speed: np.ndarray
    diameter: np.ndarray
    balls: int
    dumped: int
    factor: float


def read_frames(result) -> Tuple[Optional[Frames], str]:
    """The Frames of a run, or None and the reason: a sentence, and lines for a deck below it."""
    paths = snapshots(result.folder, result.summary["stop"]["step"])
    if len(paths) < 2:
        return None, "The run wrote no series of dumps of its balls. " + advice(result)
    try:
        first = shot_of(paths[0])
        chosen, most = budget(len(paths), len(first.of["id"]), paths[-1].stat().st_size)
        shots = [first] + [shot_of(paths[k]) for k in chosen[1:]]
    except SlopeError as error:
        return None, f"The dumps cannot be read: {error}."
    ids = np.unique(np.concatenate([shot.of["id"] for shot in shots]))
    places = np.full((len(shots), len(ids), 3), np.nan, np.float32)
    speeds = np.full((len(shots), len(ids)), np.nan, np.float32)
    size = np.zeros(len(ids), np.float32)
    for place, speed, shot in zip(places, speeds, shots):
        at = np.searchsorted(ids, shot.of["id"])
        place[at] = shot.place
        if {"vx", "vy", "vz"} <= shot.of.keys():
            speed[at] = np.sqrt(sum(shot.of[key] ** 2 for key in ("vx", "vy", "vz")))
        size[at] = find_ball_diameters(shot, result)
    time = np.array([shot.step for shot in shots]) * result.summary["dt"]
    if np.isnan(speeds).all():
        speeds = mean_speeds(places, time)
    moving = np.arange(len(ids))
    if len(ids) > result.summary["balls"]["released"]:      # fixed balls among them: they are ground
        with np.errstate(invalid="ignore"):
            moving = np.flatnonzero((np.abs(places - places[0]) > 0).any(axis=(0, 2)) | np.isnan(places).any((0, 2)))
    if not len(moving):
        return None, "No ball moves in the dumps."
    kept, factor = moving, 1.0
    if len(moving) > most:
        kept = np.sort(np.random.default_rng(SEED).choice(moving, most, replace=False))
        factor = len(moving) / most
    return Frames(time, places[:, kept], speeds[:, kept], size[kept] * factor ** (1 / 3), len(moving), len(paths),
                  factor), ""


def shot_of(path):
    return dumps.last(path, ("diameter", "radius", "vx", "vy", "vz"))


def find_ball_diameters(shot, result):
    """Of each ball; where the dump does not have it, all are as large as one that stands for its share of the mass."""
    if "diameter" in shot.of:
        return shot.of["diameter"]
    if "radius" in shot.of:
        return 2 * shot.of["radius"]
    about = result.summary
    solid = about["volume"]["released"] / about["bulk_factor"] / about["balls"]["released"]
    return (6 / np.pi * solid) ** (1 / 3)


def mean_speeds(places, time):
    """Speeds by the way from snapshot to snapshot, for dumps without velocities; the first ones are at rest."""
    way = np.linalg.norm(np.diff(places, axis=0), axis=2) / np.diff(time)[:, None]
    return np.concatenate([np.zeros_like(way[:1]), way])


def budget(dumped: int, balls: int, size: float = 0) -> Tuple[List[int], int]:
    """Which of so many snapshots, of so many bytes each, are taken, and at most how many balls of each."""
    frames = min(dumped, MOST_FRAMES, max(FEW, int(MOST_BYTES / max(size, 1))))
    while frames > FEWEST_FRAMES and MOST_PLACES // frames < min(balls, ENOUGH_BALLS):
        frames -= 1
    chosen = np.unique(np.round(np.linspace(0, dumped - 1, frames)).astype(int))
    return chosen.tolist(), MOST_PLACES // frames


def advice(result) -> str:
    """What to add to the deck, word by word, so that the next report has a view."""
    words = next((line.split() for line in result.log.settings
                  if re.match(r"fix \S+ \S+ deposit/grid ", line)), ("fix", "deposit", "soil"))
    steps = max(1, round(SECONDS / result.summary["dt"]))
    digits = 1 - len(str(steps))
    return ("These lines in the deck, before its run command, give the next report one:\n"
            f"dump view {words[2]} custom {max(1, round(steps, digits))} view.*.dump id diameter x y z vx vy vz\n"
            "dump_modify view pad 9")
