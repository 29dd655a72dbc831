#!/usr/bin/python3
"""The paper's second Table 5 from a study of this case; and what lies on the road and beyond it.

    paper_table.py STUDY [--as NAME]

Means and ranges of the repeats at each rolling resistance (--over: of another variable), m3 of ground, by two bulk
factors: that of the runs, by which the body is released whatever the balls, and 6/pi, by which a ball of diameter d
counts d^3. By another bulk factor the same balls, as the last dump has them, make other cubes of ground, above the same
cut. Then the largest mean over the paper's estimate, and what changes from the first value to the last: the mean over
the lattices, and how often chance alone would give so much (t test of the pairs, two-sided). --as NAME: into
numbers.yaml, for tests/made_numbers.py.
"""
import argparse
import math
import sys
from pathlib import Path
from typing import Dict, List, NamedTuple, Tuple

import numpy as np
from scipy import stats

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parents[1] / "tools"), str(HERE.parents[1] / "tests")]
import make_terrain  # noqa: E402
from slope_tools.deposits import dumps, volume  # noqa: E402
from slope_tools.errors import SlopeError  # noqa: E402
from slope_tools.tables.study_file import Study  # noqa: E402

CUBE_BULK = 6 / math.pi
CUT = 30.0      # degrees
MESH = 5.0      # m
WHAT = "released", "to remove", "on the road", "beyond"
ACTUAL = 14225      # m3, the paper's estimate of the actual damage
KEYS = {"released": "released", "to remove": "remove", "on the road": "road", "beyond": "beyond"}


def thickness(prefix, raster, bulk):
    """Of the deposit by a bulk factor, m: the cubes of ground that the balls stand for, in the cells of a Raster."""
    columns, balls = dumps.frames(sorted(prefix.parent.glob(f"{prefix.name}.*.dump"))[-1])[-1]
    x, y, d = (balls[:, columns.index(name)] for name in ("x", "y", "diameter"))
    side, cell = d * (bulk * math.pi / 6) ** (1 / 3), raster.transform.a
    low = [place - side / cell / 2 for place in ~raster.transform @ (x, y)]
    first = [np.floor(one).astype(int) for one in low]
    found = np.zeros(raster.z.shape)
    for i, j in np.ndindex(2 * (math.ceil(side.max() / cell) + 1,)):
        column, row = first[0] + i, first[1] + j
        across, along = (np.clip(np.minimum(one + side / cell, k + 1) - np.maximum(one, k), 0, None)
                         for one, k in zip(low, (column, row)))
        inside = (column >= 0) & (row >= 0) & (column < found.shape[1]) & (row < found.shape[0])
        np.add.at(found, (row[inside], column[inside]), (across * along * side)[inside])
    return found


def volumes(prefix, bulk=None, cut=CUT):
    """Of a run, m3 by name of WHAT; bulk: another bulk factor than the run's."""
    found = volume.compute_removal(str(prefix), volume.Wanted(HERE / "road.csv", MESH, cut, local=True),
                                   prefix.parent / "terrain.asc", tell=lambda said: None)
    run, factor = found.run, bulk / found.run.bulk if bulk else 1.0
    raster = run.raster._replace(z=thickness(prefix, run.raster, bulk)) if bulk else run.raster
    result = volume.evaluate_removal(run._replace(raster=raster), found.road, cut, found.mesh)
    far = round(make_terrain.ROAD[0] / raster.transform.a)
    return dict(zip(WHAT, (factor * run.summary["volume"]["released"], result.total(result.volume),
                           result.total(result.road), float(raster.z[:, :far].sum()) * raster.transform.a ** 2)))


def text(values):
    """Mean and range."""
    low, high = (f"{value:,.0f}" for value in (min(values), max(values)))
    return f"{sum(values) / len(values):,.0f}" + (f" ({low} to {high})" if low != high else "")


class Table(NamedTuple):
    """Of a study by one bulk factor."""
    ball: Tuple[float, ...]         # m3 of ground that a ball counts: the least and the most
    found: Dict[str, List[Dict[str, float]]]    # {value of the variable: volumes, in the order of the lattices}


def read(study, bulk=None, variable="rolling"):
    """The Table of a study over a variable."""
    rows = [row for row in study.runs if row["status"] == "finished"]
    rows.sort(key=lambda row: [float(row["variables"][name]) for name in ("xoffset", "yoffset", "zoffset")])
    several = sorted({row["set"][variable] for row in rows}, key=float)
    found = {one: [volumes(study.prefix(row["run"]), bulk) for row in rows if row["set"][variable] == one]
             for one in several}
    ball = {round((bulk or study_bulk(study, row)) * math.pi / 6 * float(row["variables"]["d"]) ** 3, 3)
            for row in rows}
    return Table((min(ball), max(ball)), found)


def trend(found, what):
    """Change from the first value to the last, mean over the lattices, and its chance; None of one."""
    first, last = ([one[what] for one in rows] for rows in (found[min(found, key=float)], found[max(found, key=float)]))
    if len(first) < 2 or len(first) != len(last) or first == last:
        return None
    return float(np.mean(last) - np.mean(first)), float(stats.ttest_rel(last, first).pvalue)


def largest(found):
    """The largest mean of what is to be removed, m3."""
    return max(float(np.mean([one["to remove"] for one in rows])) for rows in found.values())


def numbers(table, name):
    """What numbers.yaml has of a Table."""
    kept = {f"{name}.ball": " to ".join(f"{value:.3g}" for value in sorted(set(table.ball))),
            f"{name}.largest": round(largest(table.found), 1), f"{name}.ratio": round(largest(table.found) / ACTUAL, 4)}
    for what, key in KEYS.items():
        for one, rows in table.found.items():
            values = [row[what] for row in rows]
            kept[f"{name}.{key}.{float(one):g}"] = round(float(np.mean(values)), 1)
            kept[f"{name}.{key}.{float(one):g}.all"] = text(values)
        if change := trend(table.found, what):
            kept |= {f"{name}.{key}.change": round(change[0], 1), f"{name}.{key}.chance": float(f"{change[1]:.2g}")}
    return kept


def table(made):
    """Lines of a Table, a column for each rolling resistance."""
    several, found = list(made.found), made.found
    yield f"a ball counts {' to '.join(f'{value:g}' for value in sorted(set(made.ball)))} m3"
    yield "| | " + " | ".join(several) + " |"
    yield "|---" * (1 + len(several)) + "|"
    yield "| runs | " + " | ".join(str(len(found[one])) for one in several) + " |"
    for what in WHAT:
        yield f"| {what} | " + " | ".join(text([one[what] for one in found[each]]) for each in several) + " |"
    yield f"largest {largest(found):,.0f} m3, {largest(found) / ACTUAL:.2f} times the paper's {ACTUAL:,}"
    for what in WHAT[1:]:
        if change := trend(found, what):
            yield f"{what}: {change[0]:+,.0f} m3 from the first to the last, by chance in {100 * change[1]:.2g} %"


def study_bulk(study, row):
    return volume.deposit.read_deposit(study.prefix(row["run"]), None, lambda said: None).bulk


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("study", type=Path, metavar="STUDY", help="folder of the study")
    parser.add_argument("--over", default="rolling", metavar="VARIABLE", help="of the columns (default %(default)s)")
    parser.add_argument("--as", dest="name", metavar="NAME", help="put the numbers into numbers.yaml by this name")
    args = parser.parse_args()
    try:
        study = Study.read(args.study)
        for bulk, name, key in ((None, "of the runs, the whole body", "body"),
                                (CUBE_BULK, "6/pi, a ball counts d^3", "ball")):
            made = read(study, bulk, args.over)
            print(f"bulk factor {name}:", *table(made), "", sep="\n")
            if args.name:
                import made_numbers     # of the source tree alone
                made_numbers.put(HERE / "numbers.yaml", {"seen": numbers(made, f"{args.name}.{key}")})
    except SlopeError as error:
        raise SystemExit(f"paper_table.py: {error}") from None


if __name__ == "__main__":
    main()
