#!/usr/bin/python3
"""The paper's second Table 5 from a study of this case: what is to be removed, lies on the road and beyond it.

    paper_table.py STUDY

Means and ranges of the repeats at each rolling resistance, m3 of ground, by two bulk factors: that of the runs, by
which the body is released whatever the balls, and the paper's, 6/pi, by which a ball of diameter d counts d^3. By
another bulk factor the same balls, as the last dump has them, make other cubes of ground, above the same cut.
"""
import argparse
import math
import sys
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parents[1] / "tools")]
import make_terrain  # noqa: E402
from slope_tools.deposits import dumps, volume  # noqa: E402
from slope_tools.errors import SlopeError  # noqa: E402
from slope_tools.tables.study_file import Study  # noqa: E402

PAPER_BULK = 6 / math.pi
CUT = 30.0      # degrees
MESH = 5.0      # m
WHAT = "released", "to remove", "on the road", "beyond"


def thickness(prefix, raster, bulk):
    """Of the deposit by a bulk factor, m: the cubes of ground that the balls stand for, in the cells of a Raster."""
    columns, balls = dumps.frames(sorted(prefix.parent.glob(f"{prefix.name}.*.dump"))[-1])[-1]
    x, y, d = (balls[:, columns.index(name)] for name in ("x", "y", "diameter"))
    side, cell = d * (bulk * math.pi / 6) ** (1 / 3), raster.transform.a
    low = [place - side / cell / 2 for place in ~raster.transform * (x, y)]
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
    found = volume.of_run(str(prefix), volume.Wanted(HERE / "road.csv", MESH, cut, local=True),
                          prefix.parent / "terrain.asc", tell=lambda said: None)
    run, factor = found.run, bulk / found.run.bulk if bulk else 1.0
    raster = run.raster._replace(z=thickness(prefix, run.raster, bulk)) if bulk else run.raster
    result = volume.evaluate(run._replace(raster=raster), found.road, cut, found.mesh)
    far = round(make_terrain.ROAD[0] / raster.transform.a)
    return dict(zip(WHAT, (factor * run.summary["volume"]["released"], result.total(result.volume),
                           result.total(result.road), float(raster.z[:, :far].sum()) * raster.transform.a ** 2)))


def text(values):
    """Mean and range."""
    low, high = (f"{value:,.0f}" for value in (min(values), max(values)))
    return f"{sum(values) / len(values):,.0f}" + (f" ({low} to {high})" if low != high else "")


def table(study, bulk=None):
    """Lines of it, a column for each rolling resistance."""
    rows = [row for row in study.runs if row["status"] == "finished"]
    several = sorted({row["set"]["rolling"] for row in rows}, key=float)
    found = {one: [volumes(study.prefix(row["run"]), bulk) for row in rows if row["set"]["rolling"] == one]
             for one in several}
    ball = {round((bulk or study_bulk(study, row)) * math.pi / 6 * float(row["variables"]["d"]) ** 3, 3)
            for row in rows}
    yield f"a ball counts {' to '.join(f'{value:g}' for value in sorted({min(ball), max(ball)}))} m3"
    yield "| rolling resistance | " + " | ".join(several) + " |"
    yield "|---" * (1 + len(several)) + "|"
    yield "| runs | " + " | ".join(str(len(found[one])) for one in several) + " |"
    for what in WHAT:
        yield f"| {what} | " + " | ".join(text([one[what] for one in found[each]]) for each in several) + " |"


def study_bulk(study, row):
    return volume.deposit.read(study.prefix(row["run"]), None, lambda said: None).bulk


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("study", type=Path, metavar="STUDY", help="folder of the study")
    args = parser.parse_args()
    try:
        study = Study.read(args.study)
        for bulk, name in ((None, "of the runs"), (PAPER_BULK, "of the paper, 6/pi")):
            print(f"bulk factor {name}:", *table(study, bulk), "", sep="\n")
    except SlopeError as error:
        raise SystemExit(f"paper_table.py: {error}") from None


if __name__ == "__main__":
    main()
