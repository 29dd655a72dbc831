"""Meshes and decks for the tests of fix wall/gran/mesh."""

import struct

import numpy as np

from deck_helpers import read_dump, run_deck

RHO = 2500.0
STIFFNESS = 1e7


def plane(n, size=25.0, height=lambda x, y: 0.0):
    """2 n^2 triangles over a square around the origin; corners exact in float32 for n of 1, 10, 100 and size 25."""
    grid = np.linspace(-size / 2, size / 2, n + 1)
    triangles = []
    for x, x1 in zip(grid, grid[1:]):
        for y, y1 in zip(grid, grid[1:]):
            a, b, c, d = [(p, q, height(p, q)) for p, q in ((x, y), (x1, y), (x1, y1), (x, y1))]
            triangles += [(a, b, c), (a, c, d)]
    return np.array(triangles, float)


def box(low, high):
    """The twelve triangles of a box."""
    corners = np.array([[(low, high)[k >> d & 1][d] for d in range(3)] for k in range(8)], float)
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return np.array([corners[list(t)] for a, b, c, d in faces for t in ((a, b, c), (a, c, d))])


def bowl(radius, n, middle=(0.0, 0.0, 0.0)):
    """A sphere of 8 n^2 triangles."""
    triangles = []
    for sx in (1, -1):
        for sy in (1, -1):
            for sz in (1, -1):
                def corner(i, j):
                    p = np.array([sx * i, sy * j, sz * (n - i - j)], float)
                    return middle + radius * p / np.linalg.norm(p)
                for i in range(n):
                    for j in range(n - i):
                        triangles.append((corner(i, j), corner(i + 1, j), corner(i, j + 1)))
                        if i + j < n - 1:
                            triangles.append((corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)))
    return np.array(triangles)


def stl_bytes(triangles, header=b"mesh"):
    """A binary STL file."""
    data = header.ljust(80, b" ") + struct.pack("<I", len(triangles))
    for t in np.asarray(triangles, float).reshape(-1, 9):
        data += struct.pack("<12fH", 0, 0, 0, *t, 0)
    return data


def stl_text(triangles, name="mesh"):
    """The same as text, every digit written."""
    lines = [f"solid {name}"]
    for t in np.asarray(triangles, float):
        lines += ["facet normal 0 0 0", "  outer loop"]
        lines += ["    vertex " + " ".join(repr(float(x)) for x in p) for p in t]
        lines += ["  endloop", "endfacet"]
    return "\n".join(lines + [f"endsolid {name}", ""])


DECK = """
units si
newton {newton}
processors {processors}
atom_style sphere
atom_modify map array {sort}
comm_modify vel yes
boundary {boundary}
{begin}
neighbor {skin} bin
neigh_modify delay 0 {exclude}
pair_style gran/restitution {style}
pair_coeff * * stiffness {stiffness} {stiffness} {coeff}
{wall}
{balance}
fix move all nve/sphere
fix weight all gravity {g} vector {down}
timestep {dt}
thermo_style custom step time {columns}
thermo_modify format float %.17g lost error norm no
thermo {every}
dump path all custom {dump_every} {dump} id x y z vx vy vz omegax omegay omegaz
dump_modify path sort id format float %.17g
{run}
"""
WALL = "fix wall all wall/gran/mesh 2 mesh.stl {keywords}"
COLUMNS = "f_wall " + " ".join(f"f_wall[{k}]" for k in range(1, 10))


def rule_step(diameter=1.0, stiffness=STIFFNESS, share=1.0):
    """The rule's time step for the balls, or a share of it."""
    return share * 0.25 * np.sqrt(RHO * np.pi / 6 * diameter ** 3 / stiffness)


def mesh_deck(run, exclude=True, keywords="", **settings):
    values = dict(newton="on", processors="* * *", sort="", boundary="f f f", begin="read_data balls.data", skin=0.2,
                  style="", stiffness=STIFFNESS, coeff="restitution 0.5 friction 30 rolling 0.1", g=0.0, down="0 0 -1",
                  dt=rule_step(), columns=COLUMNS, every=1, dump_every=1, dump="path.txt", wall=WALL, balance="")
    values.update(settings)
    values["wall"] = values["wall"].format(keywords=keywords)
    values["exclude"] = "exclude type 1 1" if exclude else ""
    return DECK.format(run=run, **values)


def write_case(tmp_path, triangles, x, v, d=1.0, omega=None, box_size=14.0):
    """mesh.stl and balls.data; balls are of type 1, the mesh of type 2."""
    (tmp_path / "mesh.stl").write_bytes(stl_bytes(triangles))
    x = np.atleast_2d(np.asarray(x, float))
    v = np.broadcast_to(np.asarray(v, float), x.shape)
    omega = np.zeros_like(x) if omega is None else np.broadcast_to(np.asarray(omega, float), x.shape)
    d = np.broadcast_to(np.asarray(d, float), len(x))
    lines = ["balls", "", f"{len(x)} atoms", "2 atom types", ""]
    lines += [f"{-box_size} {box_size} {a}lo {a}hi" for a in "xyz"]
    lines += ["", "Atoms # sphere", ""]
    lines += [f"{k + 1} 1 {float(d[k])!r} {RHO} " + " ".join(repr(float(c)) for c in x[k]) for k in range(len(x))]
    lines += ["", "Velocities", ""]
    lines += [f"{k + 1} " + " ".join(repr(float(c)) for c in (*v[k], *omega[k])) for k in range(len(x))]
    (tmp_path / "balls.data").write_text("\n".join(lines) + "\n")


def thermo(log):
    """Rows of the thermo output of all runs: step, time, contacts, force, moment, impulse."""
    rows = []
    for line in log.splitlines():
        words = line.split()
        try:
            row = [float(word) for word in words]
        except ValueError:
            continue
        if len(row) == 12:
            rows.append(row)
    return np.array(rows)


def run_case(tmp_path, run, np=1, timeout=300, **settings):
    """Rows of the thermo output, and frames of the dump as an array [frame, ball, id x y z v omega]."""
    log = run_deck(mesh_deck(run, **settings), tmp_path, np=np, timeout=timeout)
    frames = read_dump(tmp_path / settings.get("dump", "path.txt"))
    return thermo(log), stack(frames), log


def stack(frames):
    return np.array([frames[step] for step in sorted(frames)])


def energy(frames, d=1.0, g=0.0):
    """Energy of each ball's motion, spin and height, J."""
    mass = RHO * np.pi / 6 * d ** 3
    v2 = (frames[..., 4:7] ** 2).sum(axis=-1)
    w2 = (frames[..., 7:10] ** 2).sum(axis=-1)
    return mass * (0.5 * v2 + 0.05 * d * d * w2 + g * frames[..., 3])
