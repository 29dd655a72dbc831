#!/usr/bin/python3
"""Erosion and deposit of a run per zone, measured and predicted, m3.

    zones.py PREFIX --before BEFORE.asc --change DEM_of_Difference.asc [--band 100] [-o ZONES.csv]

PREFIX is what fix deposit/grid was given as output. The change of a run is its surface less BEFORE.asc, cell by cell;
CHANGE has the same cells. Zones: the released area (where the run's base is below BEFORE.asc), and outside of it bands
of the distance in plan from the highest released ball.
"""
import argparse
import csv
import sys
from pathlib import Path

import numpy as np
import yaml

FILES = ("surface.asc", "base.asc", "summary.yaml")     # of fix deposit/grid, that are read


def read(path):
    """Header and values of an ESRI ASCII grid, NODATA as NaN."""
    lines = path.read_text().splitlines()
    header = {key.lower(): float(value) for key, value in (line.split() for line in lines[:6])}
    values = np.array([line.split() for line in lines[6:] if line.strip()], float)
    return header, np.where(values == header["nodata_value"], np.nan, values)


def change_of(prefix, before):
    """Change of the ground by a run (m), where it was released, and the distance of cells from its top (m)."""
    header, surface = read(Path(f"{prefix}.surface.asc"))
    _, base = read(Path(f"{prefix}.base.asc"))
    x, y, _ = yaml.safe_load(Path(f"{prefix}.summary.yaml").read_text())["travel"]["top"]
    rows, columns = np.indices(surface.shape)
    cell = header["cellsize"]
    east = header["xllcorner"] + (columns + 0.5) * cell
    north = header["yllcorner"] + (surface.shape[0] - rows - 0.5) * cell
    return np.nan_to_num(surface - before), np.nan_to_num(before - base) > 1e-3, np.hypot(east - x, north - y), cell


def table(measured, predicted, released, distance, cell, band):
    """Rows: zone, measured erosion and deposit, predicted erosion and deposit (m3)."""
    farthest = distance[(measured != 0) | (predicted != 0)].max()
    zones = [("released area", released)]
    for near in np.arange(0.0, farthest, band):
        zones.append((f"{near:g} to {near + band:g} m", ~released & (distance >= near) & (distance < near + band)))
    zones.append(("all", np.ones_like(released)))
    return [[name, *(cell ** 2 * float(part[inside].sum()) for change in (measured, predicted)
                     for part in (np.maximum(-change, 0.0), np.maximum(change, 0.0)))] for name, inside in zones]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("prefix", metavar="PREFIX")
    parser.add_argument("--before", type=Path, required=True, metavar="BEFORE.asc")
    parser.add_argument("--change", type=Path, required=True, metavar="CHANGE.asc")
    parser.add_argument("--band", type=float, default=100.0, metavar="M", help="width of a zone, m (default 100)")
    parser.add_argument("-o", dest="output", type=Path, metavar="ZONES.csv", help="(default PREFIX.zones.csv)")
    args = parser.parse_args()
    for path in (args.before, args.change, *(Path(f"{args.prefix}.{name}") for name in FILES)):
        if not path.is_file():
            parser.error(f"{path}: must be an existing file")
    _, before = read(args.before)
    _, measured = read(args.change)
    if measured.shape != before.shape:
        parser.error(f"{args.change}: must have the cells of {args.before}, {before.shape}, got {measured.shape}")
    predicted, released, distance, cell = change_of(args.prefix, before)
    if predicted.shape != before.shape:
        parser.error(f"{args.prefix}.surface.asc: must have the cells of {args.before}, {before.shape}, "
                     f"got {predicted.shape}")
    rows = table(np.nan_to_num(measured), predicted, released, distance, cell, args.band)
    heads = ["zone", "measured_erosion_m3", "measured_deposit_m3", "predicted_erosion_m3", "predicted_deposit_m3"]
    with open(args.output or f"{args.prefix}.zones.csv", "w", encoding="ascii", newline="") as out:
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(heads)
        writer.writerows([name, *(f"{value:.1f}" for value in values)] for name, *values in rows)
    print(f"{'zone':>15} {'measured: eroded':>18} {'deposited':>10} {'predicted: eroded':>18} {'deposited':>10}")
    for name, *values in rows:
        print(f"{name:>15} {values[0]:18,.0f} {values[1]:10,.0f} {values[2]:18,.0f} {values[3]:10,.0f}")


if __name__ == "__main__":
    sys.exit(main())
