#!/usr/bin/python3
"""The deposit of the S-1000 landslide: what the change of the ground has above 0, as an ESRI ASCII grid.

    prepare.py FOLDER -o DEPOSIT.asc

FOLDER holds DEM_of_Difference.asc (README.md says where it is from).
"""
import argparse
import sys
from pathlib import Path

import numpy as np

NODATA = -9999.0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, metavar="FOLDER")
    parser.add_argument("-o", dest="output", type=Path, required=True, metavar="DEPOSIT.asc")
    args = parser.parse_args()
    for name in ("DEM_of_Difference.asc",):
        if not (args.folder / name).is_file():
            parser.error(f"{args.folder / name}: must be an existing file: README.md says where it is from")
    lines = (args.folder / "DEM_of_Difference.asc").read_text().splitlines()
    change = np.array([line.split() for line in lines[6:] if line.strip()], float)
    rows = (" ".join(f"{z:.6g}" for z in row) for row in np.where(change == NODATA, 0.0, np.maximum(change, 0.0)))
    args.output.write_text("\n".join([*lines[:6], *rows]) + "\n", encoding="ascii")


if __name__ == "__main__":
    sys.exit(main())
