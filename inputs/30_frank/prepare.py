#!/usr/bin/python3
"""The ground before the Frank slide: the ground without the body plus the body's thickness, as ESRI ASCII grids.

    prepare.py FOLDER -o BEFORE.asc

FOLDER holds Frankslide_topography.asc and Frankslide_pile.asc (README.md says where they are from).
"""
import argparse
import sys
from pathlib import Path

import numpy as np


def read(path):
    """Lines of the header, and the values, of an ESRI ASCII grid."""
    lines = path.read_text().splitlines()
    return lines[:6], np.array([line.split() for line in lines[6:] if line.strip()], float)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, metavar="FOLDER")
    parser.add_argument("-o", dest="output", type=Path, required=True, metavar="BEFORE.asc")
    args = parser.parse_args()
    for name in ("Frankslide_topography.asc", "Frankslide_pile.asc"):
        if not (args.folder / name).is_file():
            parser.error(f"{args.folder / name}: must be an existing file: README.md says where it is from")
    header, slip = read(args.folder / "Frankslide_topography.asc")
    place, pile = read(args.folder / "Frankslide_pile.asc")
    if [line.split() for line in header] != [line.split() for line in place]:
        parser.error(f"{args.folder}: both rasters must have the same grid")
    rows = (" ".join(f"{z:.3f}" for z in row) for row in slip + pile)
    args.output.write_text("\n".join([*(" ".join(line.split()) for line in header), *rows]) + "\n", encoding="ascii")


if __name__ == "__main__":
    sys.exit(main())
