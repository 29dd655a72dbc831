"""The scene of a report's 3-D view: ground, lines on it and balls, as numbers that a page can carry.

Heights and places are 16-bit shares of the box that they lie in, in base64: a site of a kilometre is known to 2 cm.
"""
import base64
import math
from typing import Any, Dict

import contourpy
import numpy as np
from matplotlib import colormaps
from matplotlib.colors import to_hex

from ..drawing import figures, palettes
from ..geometry import extent_of, polygons_of
from ..survey import rasters
from ..survey.resampling import sample
from .frames import Frames

MOST_NODES = 60_000     # of the ground
MOST_TRIANGLES = 20_000     # of one structure: 1 MB
ROOM = 0.3              # of what the mass touched, shown around it
FULL = 65_534           # the largest number of a place or a height; one more: nothing there
COLOURS = {"speed": palettes.SPEED, "height": palettes.HEIGHT}
STRUCTURE = "#7d8fa3"
TONES = 9               # of a scale of colours
FASTEST = 99.5          # percentile of the speeds of moving balls that the scale ends at
MOVES = 0.1             # m/s


def scene(data, ground, section, frames: Frames) -> Dict[str, Any]:
    """What the viewer takes, ready for JSON; lengths in m, relative to x y of `centre` and to height 0."""
    walls = ground.obstacles.walls
    box = frame_scene(ground, walls)
    places, low, span = quantised(frames.place)
    top = fastest(frames.speed)
    with np.errstate(invalid="ignore"):
        speeds = np.round(np.clip(frames.speed / top, 0, 1) * FULL)
    balls = np.concatenate([places, np.where(np.isfinite(speeds), speeds, 0)[..., None]], axis=2)
    start = first_heights(frames.place)
    sizes = np.unique(frames.diameter)
    return {
        "ground": ground_of(data, ground, box), "section": np.round(section.points, 2).tolist(),
        "falls": falls(section),
        "road": [np.round(ring, 2).tolist() for ring in rings(data.road)],
        "release": [np.round(line, 2).tolist() for line in outlines(ground)],
        "structures": [packed_structure(name, corners)
                       for name, corners in walls.items() if meets(corners, box)],
        "balls": {"count": frames.place.shape[1], "places": packed(balls, "<u2"), "low": low.tolist(),
                  "span": span.tolist(),
                  "diameter": float(sizes[0]) if len(sizes) == 1 else packed(frames.diameter, "<f4")},
        "times": np.round(frames.time, 4).tolist(),
        "speed": {"top": top, "colours": tones("speed")},
        "height": {"low": float(start.min()), "top": float(start.max()), "colours": tones("height")},
        "colours": {"road": figures.ROAD, "release": figures.RELEASE, "section": figures.SECTION,
                    "structure": STRUCTURE}}


# --- balls ---

def quantised(places):
    """Places as whole numbers up to FULL, FULL + 1 where there is no ball, and the box that they are shares of."""
    low, high = np.nanmin(places, axis=(0, 1)), np.nanmax(places, axis=(0, 1))
    span = np.maximum(high - low, 1e-3)
    shares = np.round((places - low) / span * FULL)
    return np.where(np.isfinite(shares), shares, FULL + 1), low.astype(float), span.astype(float)


def first_heights(places):
    """Height of each ball where it is first seen."""
    first = np.isfinite(places[..., 2]).argmax(axis=0)
    return places[first, np.arange(places.shape[1]), 2]


def fastest(speeds):
    """The speed (m/s) that the scale ends at, a round number that few balls exceed."""
    moving = speeds[np.isfinite(speeds) & (speeds > MOVES)]
    return figures.round_up_nicely(float(np.percentile(moving, FASTEST))) if moving.size else 1.0


def tones(what):
    """Colours of a scale, from its low end; the palest yellows are not seen on the pale ground."""
    low, high = (0.25, 1.0) if what == "speed" else (0.0, 1.0)
    return [to_hex(colour) for colour in colormaps[COLOURS[what]](np.linspace(low, high, TONES))]


def packed(values, kind):
    return base64.b64encode(np.ascontiguousarray(values, kind).tobytes()).decode("ascii")


# --- structures ---

def meets(corners, box):
    """Whether a structure reaches into the box."""
    places = corners[..., :2].reshape(-1, 2)
    return bool((places.max(axis=0) >= box[:2]).all() and (places.min(axis=0) <= box[2:]).all())


def packed_structure(name, corners):
    """Name and triangles; none of one that has too many."""
    corners = corners if len(corners) <= MOST_TRIANGLES else corners[:0]
    return {"name": name, "triangles": len(corners), "corners": packed(corners, "<f4")}


# --- ground ---

def frame_scene(ground, walls):
    """Local xlo, ylo, xhi, yhi of the ground that is shown: what the mass touched, the road beside it, structures that
    are no farther from that than it is long, and room."""
    box = np.array(extent_of(ground.raster.transform, ground.touched | ground.source))
    size = max(box[2:] - box[:2])
    for corners in walls.values():
        places = corners[..., :2].reshape(-1, 2)
        near = places[((places >= box[:2] - size) & (places <= box[2:] + size)).all(axis=1)]
        if len(near):
            box = np.concatenate([np.minimum(box[:2], near.min(axis=0)), np.maximum(box[2:], near.max(axis=0))])
    room = ROOM * max(box[2:] - box[:2])
    half = ground.cell / 2      # heights are known up to the middles of the outermost cells
    low, high = (np.array(side) for side in (ground.extent[:2], ground.extent[2:]))
    return np.concatenate([np.maximum(box[:2] - room, low + half), np.minimum(box[2:] + room, high - half)])


def ground_of(data, ground, box):
    """Heights on a grid, without the body and before, rows from the south."""
    width, depth = box[2] - box[0], box[3] - box[1]
    path = data.result.terrain_path
    terrain = rasters.read_asc_local(path) if path else None
    finest = min(ground.cell, terrain.transform.a if terrain else ground.cell)
    step = max(finest, math.sqrt(width * depth / MOST_NODES))
    columns, rows = (max(2, math.floor(side / step) + 1) for side in (width, depth))
    x, y = np.meshgrid(np.linspace(box[0], box[2], columns), np.linspace(box[1], box[3], rows))
    before = ground.along(ground.before, x, y)
    if terrain:
        before = np.where(np.isfinite(before), sample(terrain, x, y), np.nan)
    base = before - np.nan_to_num(ground.along(ground.slip_depth, x, y))
    known = base[np.isfinite(base)]
    low, top = float(known.min()), float(np.nanmax(before))
    interval = figures.contour_interval(before)

    def heights(z):
        shares = np.round((z - low) / max(top - low, 1e-3) * FULL)
        return packed(np.where(np.isfinite(shares), shares, FULL + 1), "<u2")

    return {"columns": columns, "rows": rows, "box": [float(side) for side in box], "low": low,
            "span": max(top - low, 1e-3), "base": heights(base), "before": heights(before),
            "interval": interval, "grid": figures.nice(max(width, depth) / 4)}


def rings(geometry):
    """Edges of polygons, rows of x y."""
    if geometry is None:
        return []
    return [np.asarray(ring.coords)[:, :2] for polygon in polygons_of(geometry)
            for ring in (polygon.exterior, *polygon.interiors)]


def falls(section):
    """Whether the line of the section leads down, from its first end to its last."""
    known = section.before[np.isfinite(section.before)]
    return bool(known.size and known[0] > known[-1])


def outlines(ground):
    """Lines around the cells that held the mass at the start."""
    if min(ground.release.shape) < 2 or not ground.release.any():
        return []
    mask = np.pad(ground.release.astype(float), 1)
    x = ground.x[0, 0] + ground.cell * (np.arange(mask.shape[1]) - 1)
    y = ground.y[0, 0] - ground.cell * (np.arange(mask.shape[0]) - 1)
    return contourpy.contour_generator(x, y, mask).lines(0.5)
