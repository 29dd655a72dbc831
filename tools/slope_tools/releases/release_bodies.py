"""Slip surfaces below a polygon: sphere, ellipsoid, plane, sloping local base level; pure geometry.

A slip surface is an array of heights (m) on the nodes of an Area, NaN where there is none; a Shape is a family of them
with one free number, which release_solve finds for a depth or a volume.
"""
import math
from typing import Callable, NamedTuple, Tuple

import numpy as np
from scipy.ndimage import binary_erosion
from shapely.geometry.base import BaseGeometry

from . import release_area
from .release_area import Area, FallLine
from .release_slbl import base_level

STRAIGHT = 1e-7     # of the chord: with a smaller sagitta the sphere is a plane
STEEPEST = 16.0     # curvature of a base level times the length of its fall line: far deeper than it is long


class Shape(NamedTuple):
    """A family of slip surfaces."""
    name: str
    number: str                                 # what the free number is, with its unit
    surface: Callable[[float], np.ndarray]      # of the free number: heights on the nodes
    least: float                                # of the free number: there is no body
    most: float                                 # ... and the largest body
    limit: str                                  # what `most` is, for messages
    about: dict                                 # what was read off the ground, for the files
    steady: bool = True                         # the body only grows with the free number


def cap(area: Area, line: FallLine, sagitta: float, stretch: float = 1.0, aside: float = 0.0) -> np.ndarray:
    """The sphere through toe and shoulder that lies `sagitta` (m) below the middle of the chord, normal to it.

    sagitta < 0: above it, the upper side of a sphere, for ground that bulges above the chord. stretch: factor across
    the fall line, which makes it an ellipsoid; aside: its centre is so far (m) to the left of the fall line. NaN beyond
    the sphere in plan. On a plane slope the body is a spherical cap of the volume pi sagitta^2 (3 r - sagitta) / 3,
    times stretch, with the radius r = (chord^2/4 + sagitta^2) / (2 sagitta).
    """
    side, radius, centre, east = sphere(line, sagitta)
    left = np.array([-east[1], east[0]])
    centre[:2] += aside * left
    dx, dy = area.x[None, :] - centre[0], area.y[:, None] - centre[1]
    # the circle of the vertical plane through the chord looks the same however it is turned: only `left` is stretched
    squared = radius ** 2 - (dx * east[0] + dy * east[1]) ** 2 - ((dx * left[0] + dy * left[1]) / stretch) ** 2
    return np.where(squared >= 0, centre[2] - side * np.sqrt(np.maximum(squared, 0)), np.nan)


def sphere(line: FallLine, sagitta: float) -> Tuple[int, float, np.ndarray, np.ndarray]:
    """The sphere through toe and shoulder: 1 for its lower side, -1 for its upper one; radius, centre (m); way up."""
    side, sagitta = (1, sagitta) if sagitta > 0 else (-1, -sagitta)
    sagitta = max(sagitta, STRAIGHT * line.chord)
    way = line.shoulder - line.toe
    run = math.hypot(way[0], way[1])
    east = way[:2] / run
    radius = (line.chord ** 2 / 4 + sagitta ** 2) / (2 * sagitta)
    normal = np.array([*(-way[2] * east), run]) / line.chord
    return side, radius, (line.toe + line.shoulder) / 2 + side * (radius - sagitta) * normal, east


def compute_cap_section(line: FallLine, sagitta: float, share: np.ndarray) -> np.ndarray:
    """Heights (m) of cap() between toe and shoulder: at shares of the way in plan, 0 at the toe."""
    side, radius, centre, east = sphere(line, sagitta)
    along = share * ((line.shoulder - line.toe)[:2] @ east) - (centre - line.toe)[:2] @ east
    return centre[2] - side * np.sqrt(np.maximum(radius ** 2 - along ** 2, 0))


def plane(area: Area, dip: float, direction: float, level: float) -> np.ndarray:
    """The plane that dips by `dip` degrees towards the compass bearing `direction`; level: its height at x = y = 0."""
    fall = math.tan(math.radians(dip))
    east, north = math.sin(math.radians(direction)), math.cos(math.radians(direction))
    return level - fall * (area.x[None, :] * east + area.y[:, None] * north)


def bearing(vector: np.ndarray) -> float:
    """Compass bearing of a vector (x east, y north), degrees clockwise from north, 0 to 360."""
    return math.degrees(math.atan2(vector[0], vector[1])) % 360.0


# --- the families ---

def sphere_shape(area: Area, geometry: BaseGeometry, where: str) -> Shape:
    """Spheres through the toe and the shoulder of the polygon's fall line."""
    line = release_area.fall_line(area, geometry, where)
    return Shape("sphere", "sagitta_m", lambda sagitta: cap(area, line, sagitta), -line.chord / 2, line.chord / 2,
                 "a half sphere", _ends(line), steady=False)


def ellipsoid_shape(area: Area, geometry: BaseGeometry, where: str) -> Shape:
    """The same, stretched across the fall line so that they come out of the ground where the polygon ends there."""
    line = release_area.fall_line(area, geometry, where)
    right, left = release_area.across(geometry, line)
    stretch, aside = (left - right) / line.chord, (left + right) / 2
    return Shape("ellipsoid", "sagitta_m", lambda sagitta: cap(area, line, sagitta, stretch, aside),
                 -line.chord / 2, line.chord / 2, "half an ellipsoid",
                 {**_ends(line), "width_m": left - right, "stretch": stretch}, steady=False)


def plane_shape(area: Area, dip: float, direction: float) -> Shape:
    """Planes of a dip; free is how far (m) they lie below the one that touches the highest ground.

    The lowest is the one through the toe: through the point of the polygon's rim that lies lowest above the plane. A
    lower one would come out of the ground nowhere, and its body could not slide out of the pit.
    """
    above = area.z - plane(area, dip, direction, 0.0)
    rim = area.inside & ~binary_erosion(area.inside)
    highest, toe = float(above[area.inside].max()), float(above[rim].min())
    row, column = np.argwhere(rim & (above == toe))[0]
    return Shape("plane", "drop_m", lambda drop: plane(area, dip, direction, highest - drop), 0.0, highest - toe,
                 "the plane through the toe",
                 {"dip_degrees": dip, "direction_degrees": direction,
                  "toe": [float(area.x[column]), float(area.y[row]), float(area.z[row, column])]})


def slbl_shape(area: Area) -> Shape:
    """Sloping local base levels of the polygon; free is the curvature, 1/m."""
    up, _ = area.along()
    length = float(np.ptp(up[area.inside])) + 2 * area.cell
    most = STEEPEST / length
    return Shape("slbl", "curvature_per_m", lambda curvature: base_level(area.z, area.inside, area.cell, curvature),
                 -most, most, f"a curvature of {most:.3g} /m", {"length_m": length})


def _ends(line: FallLine) -> dict:
    return {"toe": line.toe.tolist(), "shoulder": line.shoulder.tolist(), "chord_m": line.chord}
