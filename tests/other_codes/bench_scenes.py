"""The scenes of the benchmark: a collapse on a terrain, in copies."""
import math
from pathlib import Path

import numpy as np

from slope_tools import disk
from . import peers
from .peers import Contact

# balls of 1.25 m on an embankment such as that of inputs/20_embankment, coefficients of the paper's Table 4
D, DENSITY, KN, C_SOIL, C_FIELD = 1.25, 3411.4, 1.96e9, 1.19e6, 3.09e6
FRICTION, ROLLING = 30.0, 0.05
BALLS = 21000
TOE, SHOULDER, RISE, DEPTH, MIDDLE = 84.0, 156.0, 36.0, 18.0, 80.0      # m; see its deck
WEST, EAST, SOUTH, NORTH = 22.0, 222.0, 5.0, 155.0      # edges of the terrain, m
PREPARED = 2.0          # s of collapse before the clock starts
SKIN = 0.2              # of the neighbour lists, diameters
CASE = Path(__file__).resolve().parents[2] / "inputs" / "20_embankment" / "in.embankment"


def terrain(size, factor):
    """Rows from the north, x and y of the south-west corner, cell: the embankment, `size` times as large."""
    cell = 2.5
    centre = np.array([(WEST + EAST) / 2, (SOUTH + NORTH) / 2])
    half = np.array([EAST - WEST, NORTH - SOUTH]) / 2 * math.sqrt(factor)
    low, high = (np.floor(size * edge / cell).astype(int) for edge in (centre - half, centre + half))
    x, y = ((np.arange(a, b) + 0.5) * cell / size for a, b in zip(low, high))
    profile = np.interp(x, [0, 50, 60, 80, TOE, SHOULDER, 240], [-4, -1.5, 0, 0, 0, RISE, RISE + 1])
    aside = np.clip(np.abs(y[::-1] - MIDDLE) - 45, 0, None)
    share = np.clip((x - TOE) / (SHOULDER - TOE), 0, 1)
    return size * (profile + 0.15 * aside[:, None] * share), low * cell, cell


def write_terrain(path, size, factor):
    z, (x, y), cell = terrain(size, factor)
    disk.write_file(path, f"ncols {z.shape[1]}\nnrows {z.shape[0]}\nxllcorner {x:g}\nyllcorner {y:g}\ncellsize "
                    f"{cell:g}\n"
                    "NODATA_value -9999\n" + "".join(" ".join(f"{value:.3f}" for value in row) + "\n" for row
                                                     in z.tolist()))


def contacts():
    return {1: Contact(KN, KN, C_SOIL, C_SOIL, FRICTION, ROLLING), 2: Contact(KN, KN, C_SOIL, C_SOIL, 0.0),
            3: Contact(KN, KN, C_FIELD, C_FIELD, FRICTION, ROLLING)}


def time_step():
    return 0.25 * math.sqrt(DENSITY * math.pi / 6 * D ** 3 / KN)


def collapse(size, steps):
    """The deck that releases the mass and runs it for some steps."""
    chord = math.hypot(SHOULDER - TOE, RISE)
    radius = (chord ** 2 / 4 + DEPTH ** 2) / (2 * DEPTH)
    sphere = " ".join(repr(size * value) for value in (
        (TOE + SHOULDER) / 2 - (radius - DEPTH) * RISE / chord, MIDDLE,
        RISE / 2 + (radius - DEPTH) * (SHOULDER - TOE) / chord, radius))
    laws = "\n".join(f"pair_coeff 1 {kind} stiffness {c.kn!r} {c.kt!r} damping {c.cn!r} {c.ct!r} "
                     f"friction {c.friction!r} rolling {c.rolling!r}" for kind, c in contacts().items())
    return f"""\
# the scene of slope bench: a collapse that runs until the mass is dense and moves
units si
atom_style sphere
boundary s s fs
comm_modify vel yes
region ground terrain terrain.asc depth {20 * size!r} headroom {20 * size!r}
region sphere sphere {sphere} units box
region around sphere {sphere} units box side out
region slip intersect 2 ground sphere
create_box 3 ground
lattice sc {D!r}
create_atoms 1 region slip
group soil type 1
set group soil diameter {D!r} density {DENSITY!r}
pair_style gran/restitution
{laws}
fix slip soil wall/gran/balls 2 {D!r} surface slip lower spacing {D / 2!r} write fixed.2.xyz
fix field soil wall/gran/balls 3 {D!r} surface ground upper spacing {D!r} outside slip write fixed.3.xyz
delete_balls soil overlap 0.0
neighbor {SKIN * D!r} bin
neigh_modify every 1 delay 0 check yes
timestep {time_step()!r}
fix move soil nve/sphere
fix weight soil gravity 9.80665 vector 0 0 -1
thermo 1000
thermo_modify lost ignore flush yes
""" + "\n".join(peers.output(steps, 0)) + "\n"


def copies(scene, n, ground):
    """The scene n times, side by side along y, each on its own ground of that width (m)."""
    shifts = ground * np.arange(n)[:, None, None] * np.array([0.0, 1.0, 0.0])
    moving = np.tile(scene.moving, (n, 1, 1))
    moving[:, :, :3] += shifts
    return scene._replace(moving=moving.reshape(-1, 9),
                          fixed={kind: (points + shifts).reshape(-1, 3) for kind, points in scene.fixed.items()})
