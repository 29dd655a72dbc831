#!/usr/bin/python3
"""How the volume to remove from a road changes with the angle of the cut, over all runs of a study; and a map.

    clear_the_road.py STUDY ROAD MAP.png        STUDY: folder of `slope study`; ROAD: its road, in local metres

The tools lie beside this page in a checkout and in an installation; elsewhere, put the folder tools on PYTHONPATH.
"""
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[3] / "tools"))

from slope_tools.case import run_folders  # noqa: E402  (after the path is set)
from slope_tools.deposits import volume  # noqa: E402
from slope_tools.drawing import maps, pictures  # noqa: E402
from slope_tools.errors import SlopeError  # noqa: E402
from slope_tools.tables.study_file import read_study  # noqa: E402

ANGLES = 20.0, 30.0, 40.0       # degrees


def main(folder, road, picture):
    study = read_study(folder / "study.yaml")
    worst = None
    for row in study["runs"]:
        if row["status"] != "finished":
            continue
        prefix = run_folders.prefix_of(folder / row["summary"])
        for angle in ANGLES:
            found = volume.compute_removal(prefix, volume.Wanted(road, mesh=10.0, cut_angle=angle, local=True))
            print(f"{row['run']}: cut of {angle:g} degrees, {found.about['volume']['remove']:.1f} m3 to remove")
            if worst is None or found.about["volume"]["remove"] > worst.about["volume"]["remove"]:
                worst = found
    run = worst.run
    shown = maps.window(run.raster, worst.road.bounds)
    with pictures.settings():       # whatever this user's matplotlibrc says
        figure, axes = maps.relief(run.raster, run.base, shown, f"{run.prefix}: most to remove")
        maps.values_on(axes, run.raster, worst.result.removed, shown, "thickness to remove (m)")
        maps.outline(axes, worst.road, color="tab:blue", label="road")
        maps.save(figure, picture)


if __name__ == "__main__":
    try:
        main(*map(Path, sys.argv[1:]))
    except SlopeError as error:     # bad input: one line
        sys.exit(f"clear_the_road.py: {error}")
