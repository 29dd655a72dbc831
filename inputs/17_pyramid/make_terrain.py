#!/usr/bin/python3
"""Makes pyramid.0.asc and pyramid.45.asc: four faces of 35 degrees, 500 m wide, on a flat; turned by 0 and 45 degrees.

Heights in metres on a 5 m grid with a node at the summit, 0,0. Run it in this folder; it overwrites both files.
"""
import numpy as np

CELL, HALF, SLOPE, WIDTH = 5.0, 600.0, 35.0, 500.0

axis = np.arange(-HALF, HALF + CELL / 2, CELL)
x, y = np.meshgrid(axis, axis[::-1])            # ESRI rows run north to south
for azimuth in 0, 45:
    c, s = np.cos(np.radians(azimuth)), np.sin(np.radians(azimuth))
    from_summit = np.maximum(np.abs(c * x + s * y), np.abs(c * y - s * x))
    height = np.tan(np.radians(SLOPE)) * np.maximum(WIDTH / 2 - from_summit, 0)
    with open(f"pyramid.{azimuth}.asc", "w") as out:
        out.write(f"ncols {axis.size}\nnrows {axis.size}\nxllcorner {-HALF - CELL / 2}\nyllcorner {-HALF - CELL / 2}\n"
                  f"cellsize {CELL}\nNODATA_value -9999\n")
        for row in height:
            out.write(" ".join(f"{z:.3f}".rstrip("0").rstrip(".") for z in row) + "\n")
