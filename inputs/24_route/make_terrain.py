#!/usr/bin/python3
"""Makes terrain.asc, axis.csv and slopes.csv of this case: a road of 2 km below six slopes.

A floor falls gently from the north to the road. Six bluffs stand on it, steep on one side, each with its foot at a
given place; four of them stand at the road, one far from it, and one faces the hollow behind it. Heights in metres on a
grid of 4 m, x along the road. Run it in this folder; it overwrites the three files.
"""
import numpy as np

CELL = 4.0
X, Y = 2160.0, 360.0            # size of the raster, m
ROAD = 70.0                     # mean y of the road's axis, m
BEND = 6.0                      # how far it swings to either side, m
FALL = 0.03                     # of the floor towards the road
# x of the middle, y of the foot, height (m), half a width (m), and whether it faces the road
BLUFFS = ((210.0, 92.0, 32.0, 60.0, True), (560.0, 90.0, 29.0, 58.0, True), (900.0, 204.0, 31.0, 60.0, True),
          (1240.0, 94.0, 34.0, 62.0, True), (1580.0, 236.0, 32.0, 60.0, False), (1900.0, 91.0, 30.0, 58.0, True))
STEEP = 1.25                    # m in plan for a metre of height, of a face
BACK = 0.12                     # fall of the top behind the shoulder

x = np.arange(CELL / 2, X, CELL)[None, :]
y = np.arange(CELL / 2, Y, CELL)[::-1][:, None]         # ESRI rows run north to south
axis = ROAD + BEND * np.sin(2 * np.pi * x / 1000.0)
z = FALL * np.maximum(y - axis - 8.0, 0.0)
for middle, foot, height, half, south in BLUFFS:
    share = np.exp(-((x - middle) / half) ** 2)
    above = (y - foot if south else foot - y)           # from the foot backwards
    top = np.maximum(above - STEEP * height, 0.0) * BACK
    bluff = np.clip(above / STEEP, 0.0, height) - np.minimum(top, height)
    z = z + share * np.maximum(bluff, 0.0)
    if not south:
        z = z - np.exp(-((x - middle) / 160.0) ** 2) * 2 * FALL * np.maximum(y - foot, 0.0)

with open("terrain.asc", "w", encoding="ascii") as out:
    out.write(f"ncols {x.size}\nnrows {y.size}\nxllcorner 0\nyllcorner 0\ncellsize {CELL}\nNODATA_value -9999\n")
    for row in z:
        out.write(" ".join(f"{one:.2f}".rstrip("0").rstrip(".") for one in row) + "\n")
with open("axis.csv", "w", encoding="ascii") as out:
    out.write("# the road's axis, local x,y in m\n")
    for at in np.arange(80.0, 2081.0, 20.0):
        out.write(f"{at:g},{ROAD + BEND * np.sin(2 * np.pi * at / 1000.0):.3f}\n")
with open("slopes.csv", "w", encoding="ascii") as out:
    out.write("x_m,foot_y_m,height_m,half_width_m,faces_road\n")
    for middle, foot, height, half, south in BLUFFS:
        out.write(f"{middle:g},{foot:g},{height:g},{half:g},{'yes' if south else 'no'}\n")
