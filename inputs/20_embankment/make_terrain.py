#!/usr/bin/python3
"""Makes terrain.asc of this case, an embankment above a road, and terrain_long.asc, with more ground around the same.

The elevation data of the site (Geospatial Information Authority of Japan, free after
registration) are not shipped, and the paper's text has no dimensions of the face: these are ours.
Plane faces and a gentle valley, heights in metres on a 2.5 m grid. x runs from the fields up to the
plateau, y along the road. Run it in this folder; it overwrites both.
"""
import numpy as np

CELL = 2.5
X, Y = 240.0, 160.0             # size of the raster, m
FAR = -400.0                    # x where the long one begins: farther than known events of this size go
ASIDE = 80.0                    # m more of it at either end of the road, for what spreads on the fields
ROAD = (60.0, 80.0)             # Route 4: level, at the toe
TOE, SHOULDER = 84.0, 156.0     # foot and edge of the embankment's face
HEIGHT = 36.0                   # of the shoulder above the toe: a face of 1 : 2


def heights(rise=HEIGHT, shoulder=SHOULDER, west=0.0, more=0.0):
    """The rows of the raster, from north to south; x begins at west, y is from -more to Y + more."""
    x = np.arange(west + CELL / 2, X, CELL)
    y = np.arange(CELL / 2 - more, Y + more, CELL)[::-1]        # ESRI rows run north to south

    # along x: fields falling away from the road (level before x = 0), road, verge and ditch, face, plateau
    profile = np.interp(x, [0.0, 50.0, ROAD[0], ROAD[1], TOE, shoulder, X],
                        [-4.0, -1.5, 0.0, 0.0, 0.0, rise, rise + 1.0])

    # the embankment fills a shallow valley: natural ground rises on both sides of it
    aside = np.clip(np.abs(y - Y / 2) - 45.0, 0.0, None)
    share = np.clip((x - TOE) / (shoulder - TOE), 0.0, 1.0)
    return profile[None, :] + 0.15 * aside[:, None] * share[None, :]


def write(path, height, west=0.0, south=0.0):
    """An ESRI ASCII grid."""
    with open(path, "w", encoding="ascii") as out:
        out.write(f"ncols {height.shape[1]}\nnrows {height.shape[0]}\nxllcorner {west:g}\nyllcorner {south:g}\n"
                  f"cellsize {CELL}\nNODATA_value -9999\n")
        for row in height:
            out.write(" ".join(f"{z:.3f}".rstrip("0").rstrip(".") for z in row) + "\n")


if __name__ == "__main__":
    write("terrain.asc", heights())
    write("terrain_long.asc", heights(west=FAR, more=ASIDE), FAR, -ASIDE)
