"""What two codes may do otherwise, tried in ours: laws of rolling, time integration, and how the volume is counted.

The paper's two codes differ by 8, 30 and 35 % in what is to be removed. Each variant runs from the starts of the table,
at its two rolling resistances above 0, and is compared with ours start by start.
"""
import math
from itertools import zip_longest
from typing import Callable, Dict, List

import numpy as np
from shapely.geometry import Point
from shapely.prepared import prep

from slope_tools import disk, geometry
from slope_tools.deposits import cut, volume
from .crosscheck_cases import Plain
from .crosscheck_table import CUT, DECK_NAME, QUANTITIES, ROLLING, SECONDS, STARTS, differences, evaluated, numbers_of
from .peers import Contact, Scene

Contacts = Dict[int, Contact]
SLIP = 2        # type of the slip surface
FILE = "laws.csv"
OURS = "ours"
# another scene of our code
LAWS: Dict[str, Callable[[Contacts], Contacts]] = {
    "rolling without a spring": lambda laws: {kind: one._replace(kr=0.0) for kind, one in laws.items()},
    "rolling with half the coefficient": lambda laws: times(laws, 0.5),
    "rolling with twice the coefficient": lambda laws: times(laws, 2.0),
    "rolling on the slip surface, too": lambda laws: {**laws, SLIP: laws[SLIP]._replace(rolling=laws[1].rolling)}}
BY_CENTRES = "balls whose centres are above the cut"


def times(laws: Contacts, factor: float) -> Contacts:
    return {kind: one._replace(rolling=factor * one.rolling) for kind, one in laws.items()}


def variants(scene: Scene) -> Dict[str, Scene]:
    """By what is different in them."""
    return {**{name: scene._replace(contacts=change(scene.contacts)) for name, change in LAWS.items()},
            "half the time step": scene._replace(dt=scene.dt / 2)}


def laws(work, case):
    """All variants of our code, and other ways to count the volume; for information."""
    d, ours, plain = 4.0 if work.quick else 2.5, work.codes[0], Plain(work.lmp)
    found: Dict[str, List[List[Dict[str, float]]]] = {}
    for i, rolling in enumerate(ROLLING[1:]):
        for start in STARTS:
            name = f"{case}_{rolling:g}_{start:g}"
            settings = {"rule": "ours", "d": d, "rolling": rolling, "xoffset": start, "yoffset": start}
            scene = work.scene(name, DECK_NAME, settings)._replace(headroom=30.0)
            tried = [(OURS, scene, ours), *((what, other, ours) for what, other in variants(scene).items()),
                     ("velocities of half a step ago", scene, plain)]
            for k, (what, other, code) in enumerate(tried):
                final, _ = work.run(f"{name}_{k}", other, round(SECONDS / other.dt), codes=[code])[code.name]
                numbers = numbers_of(work, f"{name}.deck", settings, scene, final)
                several = {what: numbers}
                if what == OURS:
                    several[BY_CENTRES] = {"to remove": by_centres(evaluated(work, f"{name}.deck"), final, d)}
                for each, values in several.items():
                    found.setdefault(each, [[] for _ in ROLLING[1:]])[i].append(values)
    rows = list(rows_of(found))
    disk.write_file(work.output / FILE, csv_of(rows))
    work.about_laws = {"d": d, "starts": list(STARTS), "rows": rows}


def rows_of(found):
    """Of each variant the mean of each quantity at each rolling resistance, and its difference from ours."""
    for what, each in found.items():
        for quantity in QUANTITIES if what != BY_CENTRES else ["to remove"]:
            mine, base = ([[one[quantity] for one in row] for row in several] for several in (each, found[OURS]))
            compared = differences(mine, base) if what != OURS else []
            for rolling, row, one in zip_longest(ROLLING[1:], mine, compared):
                yield {"what": what, "quantity": quantity, "rolling": rolling, "mean": float(np.mean(row)),
                       "difference": one and one.share, "low": one and one.low, "high": one and one.high, "runs": row}


def csv_of(rows) -> str:
    heads = ["what", "quantity", "rolling", "mean", "difference", "low", "high"]
    return disk.csv_text([*heads, *(f"start_{start:g}" for start in STARTS)],
                         ([*(row[head] for head in heads), *row["runs"]] for row in rows))


def by_centres(removal: volume.Removal, final, d: float) -> float:
    """What is to be removed, m3: the ground of each ball whose centre is above the cut."""
    run = removal.run
    ground, road = cut.Ground(run.base), geometry.to_index(removal.road, run.raster)
    edge, on = cut.Edge(road, ground, math.tan(math.radians(CUT)) * run.cell), prep(road)

    def level(x, y):
        """Of the cut, or of the ground above it, at index coordinates."""
        inside = np.array([on.contains(Point(*one)) for one in zip(x, y)])
        height = ground.height(x, y)
        return np.where(inside, height, np.maximum(height, edge.cut(x, y)))

    x, y = ~run.raster.transform @ final[:, :2].T
    return float((final[:, 2] > level(x, y)).sum()) * run.bulk * math.pi / 6 * d ** 3
