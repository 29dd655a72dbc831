#!/usr/bin/python3
"""Makes wall.stl, building.stl and pier.stl of this case: closed surfaces below the embankment of 20.

A retaining wall on the verge between the toe and the road, a building beyond the road, and a round pier of a bridge in
the road. All begin 2 m and more below the ground, so that nothing passes under them. Faces are divided into panels of
about 2.5 m, so that the pressure is known by place; panels of neighbouring faces share their corners. Text STL, in the
metres of terrain.asc. Run it in this folder; it overwrites the three files.
"""
import math

import numpy as np

PANEL = 2.5                                                     # m, most that a side of a panel has
WALL = (80.5, 40.0, -2.0), (82.0, 120.0, 4.0)                   # lowest and highest corner, m
BUILDING = (48.0, 72.0, -5.0), (58.0, 88.0, 6.0)
PIER, RADIUS, SIDES = (70.0, 60.0, -3.0, 9.0), 1.5, 16          # x, y of its axis, lower and upper end, m


def steps(low, high):
    """Corners of panels along a side."""
    return np.linspace(low, high, math.ceil((high - low) / PANEL) + 1)


def panels(grid):
    """Two triangles for each panel of a grid of corners, (n, m, 3)."""
    found = []
    for row, above in zip(grid[:-1], grid[1:]):
        for a, b, c, d in zip(row[:-1], row[1:], above[1:], above[:-1]):
            found += [(a, b, c), (a, c, d)]
    return found


def box(low, high):
    """The six faces of a box; their normals point outwards."""
    sides = [steps(*ends) for ends in zip(low, high)]
    found = []
    for axis in range(3):
        one, two = (axis + 1) % 3, (axis + 2) % 3
        for end in (low, high):
            grid = np.empty((len(sides[two]), len(sides[one]), 3))
            grid[..., axis] = end[axis]
            grid[..., one], grid[..., two] = np.meshgrid(sides[one], sides[two])
            found += panels(grid if end is high else grid[:, ::-1])
    return found


def cylinder(x, y, low, high):
    """The side and the two ends of an upright cylinder with SIDES faces."""
    angles = 2 * np.pi * np.arange(SIDES + 1) / SIDES
    ring = np.stack([x + RADIUS * np.cos(angles), y + RADIUS * np.sin(angles)], axis=-1)
    ring[-1] = ring[0]
    rings = [np.column_stack([ring, np.full(len(ring), z)]) for z in steps(low, high)]
    found = panels(np.array(rings))
    for end, turn in ((rings[0], -1), (rings[-1], 1)):
        middle = np.array([x, y, end[0, 2]])
        found += [(middle, a, b)[::turn] for a, b in zip(end[:-1], end[1:])]
    return found


def write(name, triangles):
    with open(f"{name}.stl", "w", encoding="ascii") as out:
        out.write(f"solid {name}\n")
        for a, b, c in triangles:
            normal = np.cross(b - a, c - a)
            normal = normal / np.linalg.norm(normal) + 0.0
            out.write("facet normal {:.6g} {:.6g} {:.6g}\nouter loop\n".format(*normal))
            for corner in (a, b, c):
                out.write("vertex {:.6g} {:.6g} {:.6g}\n".format(*corner))
            out.write("endloop\nendfacet\n")
        out.write(f"endsolid {name}\n")


write("wall", box(*WALL))
write("building", box(*BUILDING))
write("pier", cylinder(*PIER))
