#!/usr/bin/python3
"""Makes terrain.asc of this case: an embankment above a road, higher at two places.

A plane face of 1 : 1.5 rises from a straight toe to a crest that is 19 m high at one place, 16 m at another, and 11 m
elsewhere; heights in metres on a grid of 2 m. x runs from the fields up, y along the road. Run it in this folder; it
overwrites terrain.asc.
"""
import numpy as np

CELL = 2.0
X, Y = 120.0, 160.0             # size of the raster, m
ROAD = (24.0, 34.0)             # level, in front of the toe
TOE = 37.0                      # foot of the face, behind a ditch's width
CREST = 11.0                    # height of the crest above the road
HIGHER = ((48.0, 8.0), (112.0, 5.0))    # y of the two places, and how much higher they are
WIDE = 18.0                     # m from such a place: a share of exp(-1) is left

x = np.arange(CELL / 2, X, CELL)
y = np.arange(CELL / 2, Y, CELL)[::-1]          # ESRI rows run north to south
fields = np.interp(x, [0.0, ROAD[0] - 4.0, ROAD[0]], [-2.0, -1.0, 0.0])
crest = CREST + sum(more * np.exp(-((y - at) / WIDE) ** 2) for at, more in HIGHER)
face = np.minimum(np.maximum(x - TOE, 0.0)[None, :] / 1.5, crest[:, None])

with open("terrain.asc", "w", encoding="ascii") as out:
    out.write(f"ncols {x.size}\nnrows {y.size}\nxllcorner 0\nyllcorner 0\ncellsize {CELL}\nNODATA_value -9999\n")
    for row in fields[None, :] + face:
        out.write(" ".join(f"{z:.3f}".rstrip("0").rstrip(".") for z in row) + "\n")
