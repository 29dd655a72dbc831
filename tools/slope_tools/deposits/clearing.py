"""How a road is cleared (how much: volume.py): blocked stretches, what each takes, a lane through all, and the hours.

What must be removed anywhere belongs to the stretch that is nearest along the axis, so that the stretches add up to the
whole. The lanes of several stretches may cut the same ground, which counts once in their total.
"""
from typing import Any, Dict, List, NamedTuple, Optional, Sequence

import numpy as np
from shapely.geometry.base import BaseGeometry

from ..geometry import Mesh
from ..survey.roads import Asked
from . import lanes
from .axis import Axis
from .lanes import Stretch

DIGITS = 6                  # of lengths in m and of hours


class Clearing(NamedTuple):
    """What a road takes, for volume.yaml, tables and maps."""
    stretches: List[Stretch]
    entries: List[Dict[str, Any]]       # of each stretch: lengths in m, volumes in m3 of ground, hours
    totals: Dict[str, Any]
    lanes: List[BaseGeometry]           # of each stretch, local metres; none where no lane is asked for
    mesh: Optional[np.ndarray]          # m3 of the lanes together in each mesh cell


def evaluate_clearing(run_, result, profile, axes: Sequence[Axis], width: float, road: Optional[BaseGeometry],
                      asked: Asked, mesh: Mesh, angle: float, samples: int) -> Clearing:
    """The Clearing of a Deposit's road.

    result: volume.Result; profile: along the axis; width: of the road, m; road: see lanes.find_lane_stretches; angle:
    of the cut, degrees.
    """
    stretches = lanes.find_lane_stretches(run_.raster, axes, width, asked.blocked, road)
    entries = [{"from": round(one.along.low, DIGITS), "to": round(one.along.high, DIGITS),
                "largest_thickness_on_axis": thickest(profile, one), "passable_width": round(one.passable, DIGITS),
                "remove": result.rounded(volume)} for one, volume in zip(stretches,
                                                                         compute_stretch_volumes(run_, result,
                                                                                                 stretches))]
    totals = {"road_width": round(width, DIGITS), "blocked_above": asked.blocked,
              "blocked_length": round(sum(one.along.high - one.along.low for one in stretches), DIGITS),
              "remove": result.total(result.volume)}
    areas, by_mesh = [], None
    if asked.lane is not None:
        lane = min(asked.lane, width)
        cutter = lanes.Cutter(run_.raster, run_.base, angle, samples)
        for stretch, entry in zip(stretches, entries):
            place = cutter.least(stretch, width, lane)
            areas.append(cutter.area(stretch, place.offset, lane))
            steep = cutter.removed(areas[-1:]).steep * run_.cell ** 2
            entry.update(lane_offset=round(place.offset, DIGITS), remove_lane=result.rounded(place.volume),
                         remove_lane_where_cut_below_ground=result.rounded(steep))
        together = cutter.removed(areas, mesh)
        by_mesh = result.rounded((together.mesh_road + together.mesh_beside) * run_.cell ** 2)
        totals.update(lane=asked.lane, remove_lane=result.total(by_mesh))
        totals["remove_lane_twice"] = max(0.0, result.rounded(sum(one["remove_lane"] for one in entries)
                                                              - totals["remove_lane"]))
    if asked.hours is not None:
        totals.update(clearing=asked.clearing, loosening=asked.loosening)
        for entry in (*entries, totals):
            entry.update({hours: round(entry[volume] * asked.hours, DIGITS) for hours, volume in
                          (("hours", "remove"), ("hours_lane", "remove_lane")) if volume in entry})
    return Clearing(stretches, entries, totals, areas, by_mesh)


def thickest(profile, stretch: Stretch) -> float:
    """The largest thickness on the axis within a stretch, m."""
    inside = (profile["to"] > stretch.along.low) & (profile["from"] < stretch.along.high)
    return round(float(profile["thickness"][inside].max(initial=0.0)), DIGITS)


def compute_stretch_volumes(run_, result, stretches: Sequence[Stretch]) -> np.ndarray:
    """What must be removed of each stretch, m3; together all of it."""
    row, column = np.nonzero(result.removed > 0)
    if not (stretches and len(row)):
        return np.zeros(len(stretches))
    mine = lanes.nearest(stretches, *(run_.raster.transform @ (column + 0.5, row + 0.5)))
    return np.bincount(mine, result.removed[row, column], len(stretches)) * run_.cell ** 2
