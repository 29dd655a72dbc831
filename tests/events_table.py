#!/usr/bin/python3
"""Length and area of runs, a line each: tests/events_table.py SUMMARY.yaml ...

Length: plan distance from the highest released ball that 99 % of the volume stays within. Area: cells that were ever
thicker than 0.1 and 1 m; cells that are in the end.
"""
import math
import sys
from pathlib import Path

import numpy as np
import yaml


def covered(prefix, name, threshold, cell):
    """Area (km2) of the cells of a raster above a threshold (m)."""
    values = np.loadtxt(f"{prefix}.{name}.asc", skiprows=6)
    return (values > threshold).sum() * cell ** 2 / 1e6


def main():
    if len(sys.argv) < 2:
        raise SystemExit(__doc__)
    print(f"{'length, m':>10} {'farthest':>9} {'reach, deg':>10} {'ever, km2':>10} {'> 1 m':>7} {'in the end':>10} "
          f"{'lost, %':>8} {'end, s':>7} {'at rest':>8} {'overlap':>8}  run")
    for path in sys.argv[1:]:
        about = yaml.safe_load(Path(path).read_text())
        prefix, cell = path[:-len(".summary.yaml")], about["grid"]["cell"]
        last = {key: math.nan if value is None else value for key, value in about["travel"]["quantiles"][-1].items()}
        volume = about["volume"]
        print(f"{last['distance']:10.0f} {about['travel']['front']:9.0f} {last['reach_angle']:10.1f} "
              f"{covered(prefix, 'max_thickness', 0.1, cell):10.3f} {covered(prefix, 'max_thickness', 1, cell):7.3f} "
              f"{covered(prefix, 'thickness', 0.1, cell):10.3f} {100 * volume['lost'] / volume['released']:8.2f} "
              f"{about['time']:7.1f} {str(about['at_rest']).lower():>8} {about['guards']['largest_overlap']:8.3f}  "
              f"{prefix}")


if __name__ == "__main__":
    main()
