#!/usr/bin/python3
"""What the paper's text leaves open: bodies of other faces and slip depths, cuts and bulk factors, against its table.

    open_geometry.py -o DIR [--d 2.5] [--jobs 2]

Each body (height and slope of the face, depth of the slip sphere through toe and shoulder) runs at the three rolling
resistances of the paper; cuts and bulk factors need no run of their own. Writes DIR/geometry.csv, a line for each body,
cut and bulk factor, and DIR/geometry.png; prints which of them give the numbers of company J and of company I. Runs
that are there are not made again. A fit to one number is no validation.
"""
import argparse
import csv
import itertools
import math
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parents[1] / "tools")]
import make_terrain  # noqa: E402
from slope_tools import programs  # noqa: E402
from slope_tools.case import run_folders  # noqa: E402
from slope_tools.deposits import volume  # noqa: E402

HEIGHTS = 33.0, 36.0, 39.0, 42.0        # m
SLOPES = 1.8, 2.0, 2.2                  # run of the face over its height
DEPTHS = 10.0, 14.0, 18.0, 22.0, 28.0   # m
ROLLING = 0.0, 0.05, 0.10
CUTS = 25.0, 30.0, 35.0                 # degrees; the paper has 30
PAPER = {"J": (24048, 26009, 22340), "I": (22114, 18262, 14490)}
NEAR = 0.1                              # of each of the three volumes: a body gives the table
HARDLY = 0.01                           # of the released volume, that passes the road at 0.10: "almost did not arrive"
COLUMNS = ("height_m", "slope", "depth_m", "cut_deg", "bulk", "released_m3", "in_place_m3",
           *(f"{what}_{rolling:g}_m3" for what in ("remove", "on_road", "beyond") for rolling in ROLLING),
           *(f"within_99_{rolling:g}_m" for rolling in ROLLING), "gives", "falls_with_rolling", "hardly_beyond")


def bodies():
    return list(itertools.product(HEIGHTS, SLOPES, DEPTHS))


def run(body, rolling, d, out, lmp):
    """A run, unless it is there; its folder."""
    height, slope, depth = body
    folder = out / f"height_{height:g}_slope_{slope:g}_depth_{depth:g}" / f"rolling_{rolling:g}_d_{d:g}"
    if (folder / "done").exists():
        return folder
    folder.mkdir(parents=True, exist_ok=True)
    shoulder = make_terrain.TOE + slope * height
    make_terrain.write(folder / "terrain.asc", make_terrain.heights(height, shoulder))
    shutil.copy(HERE / "in.embankment", folder)
    words = {"rule": "ours", "d": d, "rolling": rolling, "depth": depth, "rise": height, "shoulder": shoulder}
    options = [word for name, value in words.items() for word in ("-var", name, f"{value}")]
    done = subprocess.run([str(lmp), "-in", "in.embankment", "-screen", "none", *options], cwd=folder, check=False,
                          stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    if done.returncode:
        raise SystemExit(f"{folder}: the run failed, see log.lammps")
    for path in (*folder.glob("*.dump"), *folder.glob("*.restart")):
        path.unlink()
    (folder / "done").touch()
    return folder


def numbers(folder):
    """Of a run: released, m3; 99 % within, m; beyond the road, m3; {cut: (to remove, on the road)}; bulk factor."""
    prefix = folder / "embankment"
    summary = run_folders.load_summary(f"{prefix}.summary.yaml")
    found = {cut: volume.compute_removal(str(prefix), volume.Wanted(HERE / "road.csv", 5.0, cut, True), folder /
                                         "terrain.asc")
             for cut in CUTS}
    raster = found[CUTS[0]].run.raster
    beyond = raster.z[:, :round(make_terrain.ROAD[0] / make_terrain.CELL)].sum() * make_terrain.CELL ** 2
    share = next(one["distance"] for one in summary["travel"]["quantiles"] if round(100 * one["share"]) == 99)
    volumes = {cut: tuple(float(one.about["volume"][key]) for key in ("remove", "remove_on_road"))
               for cut, one in found.items()}
    return summary["volume"]["released"], share, float(beyond), volumes, summary["bulk_factor"]


def rows_of(body, runs):
    """The lines of a body: by cut and by bulk factor (that of the body, and 6/pi, a cube as wide as the ball)."""
    for cut in CUTS:
        for bulk in ("body", "ball"):
            factor = [1.0 if bulk == "body" else 6 / math.pi / one[4] for one in runs]
            removed = [one[3][cut][0] * f for one, f in zip(runs, factor)]
            beyond = [one[2] * f for one, f in zip(runs, factor)]
            gives = [name for name, paper in PAPER.items()
                     if all(abs(ours - theirs) <= NEAR * theirs for ours, theirs in zip(removed, paper))]
            yield dict(zip(COLUMNS, (
                *body, cut, bulk, runs[0][0] * factor[0], runs[0][0], *removed,
                *(one[3][cut][1] * f for one, f in zip(runs, factor)), *beyond, *(one[1] for one in runs),
                " ".join(gives), removed[0] > removed[1] > removed[2],
                beyond[-1] < HARDLY * runs[-1][0] * factor[-1])))


def draw(rows, path):
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot as plt
    figure, axes = plt.subplots(figsize=(6.3, 3.4), constrained_layout=True)
    for i, height in enumerate(HEIGHTS):
        mine = [row for row in rows if row["height_m"] == height and row["cut_deg"] == 30 and row["bulk"] == "body"]
        axes.plot([row["released_m3"] for row in mine], [row["remove_0_m3"] for row in mine], "o", ms=3, color=f"C{i}",
                  label=f"face of {height:g} m")
    for name, values in PAPER.items():
        axes.axhline(values[0], color="k", lw=0.8, ls="--" if name == "J" else ":", label=f"company {name}")
    axes.axhline(14225, color="gray", lw=0.8, label="actual damage")
    axes.set(xlabel="released, m3", ylabel="to remove at rolling resistance 0, m3", xlim=(0, None), ylim=(0, None))
    axes.legend(frameon=False, fontsize=7)
    figure.savefig(path, dpi=140)


def tell(rows):
    base = [row for row in rows if row["cut_deg"] == 30 and row["bulk"] == "body"]
    removed = [row["remove_0_m3"] for row in base]
    print(f"{len(base)} bodies of {min(row['released_m3'] for row in base):,.0f} to "
          f"{max(row['released_m3'] for row in base):,.0f} m3: {min(removed):,.0f} to {max(removed):,.0f} m3 to remove "
          "at rolling resistance 0, cut 30 degrees")
    for name in PAPER:
        mine = [row for row in rows if name in row["gives"].split()]
        print(f"within {100 * NEAR:g} % of company {name}'s three volumes: {len(mine)} of {len(rows)} "
              f"(body, cut, bulk factor), of {len({tuple(row[key] for key in COLUMNS[:3]) for row in mine})} bodies")
        for row in mine:
            print(f"  face {row['height_m']:g} m at 1 : {row['slope']:g}, depth {row['depth_m']:g} m, cut "
                  f"{row['cut_deg']:g} degrees, bulk factor of the {row['bulk']}: "
                  + ", ".join(f"{row[f'remove_{rolling:g}_m3']:,.0f}" for rolling in ROLLING))
    print(f"volume falls with rolling resistance: {sum(row['falls_with_rolling'] for row in base)} bodies; hardly "
          f"beyond the road at 0.10: {sum(row['hardly_beyond'] for row in base)}")
    print("a fit to one number is no validation")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="DIR", help="folder of the runs")
    parser.add_argument("--d", type=float, default=4.0, help="diameter of the balls, m (default %(default)g)")
    parser.add_argument("--jobs", type=int, default=2, help="runs at a time (default %(default)d)")
    parser.add_argument("--lmp", help="LAMMPS program with SLOPE (default: LMP, or build/lmp)")
    args = parser.parse_args()
    lmp = programs.find_lmp(Path(args.lmp) if args.lmp else None)
    with ThreadPoolExecutor(args.jobs) as pool:
        folders = {key: pool.submit(run, *key, args.d, args.output, lmp)
                   for key in itertools.product(bodies(), ROLLING)}
        rows = [row for body in bodies()
                for row in rows_of(body, [numbers(folders[body, rolling].result()) for rolling in ROLLING])]
    with open(args.output / "geometry.csv", "w", newline="", encoding="ascii") as out:
        writer = csv.DictWriter(out, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    draw(rows, args.output / "geometry.png")
    tell(rows)


if __name__ == "__main__":
    main()
