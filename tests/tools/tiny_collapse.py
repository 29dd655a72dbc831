"""A collapse of 350 balls that runs in a second: deck, terrain and road for the tests of study and report."""
import csv
import functools
import os
import subprocess
from pathlib import Path

import numpy as np
import yaml

TOP = Path(__file__).resolve().parents[2]
LMP = os.environ.get("LMP", str(TOP / "build" / "lmp"))

COLUMNS, ROWS = 40, 24          # terrain, 1 m cells
TOE, SHOULDER, HEIGHT = 16.0, 28.0, 8.0

DECK = """\
# A small collapse for tests; second line of the head.
# Expected: nothing in particular.

variable  rolling  index 0.0   # rolling resistance
variable  friction index 30    # degrees
variable  cell     index 1.0   # m
variable  steps    index 150
variable  out      index tiny
variable  terrain  index terrain.asc
variable  kn       equal 2.0e7

units       si
atom_style  sphere
boundary    f f f
comm_modify vel yes
region      ground terrain ${terrain} depth 8 headroom 8
region      sphere sphere 18 12 12 13 units box
region      around sphere 18 12 12 13 units box side out
region      slip   intersect 2 ground sphere
region      base   intersect 2 ground around
create_box  3 ground
lattice     sc 1.0
create_atoms 1 region slip
group       soil type 1
set         group soil diameter 1.0 density 3411.4
pair_style  gran/restitution
pair_coeff  1 1 stiffness ${kn} ${kn} restitution 0.4 friction ${friction} rolling ${rolling}
pair_coeff  1 2 stiffness ${kn} ${kn} restitution 0.4 friction 0
pair_coeff  1 3 stiffness ${kn} ${kn} restitution 0.1 friction ${friction} rolling ${rolling}
fix         slip  soil wall/gran/balls 2 1.0 surface slip lower spacing 0.5
fix         field soil wall/gran/balls 3 1.0 surface ground upper spacing 1.0 outside slip
delete_balls soil overlap 0.0
neighbor    0.2 bin
neigh_modify every 1 delay 0 check yes
timestep    0.002
fix         move soil nve/sphere
fix         weight soil gravity 9.80665 vector 0 0 -1
fix         deposit soil deposit/grid 10 50 cell ${cell} terrain base output ${out}
thermo      50
thermo_style custom step time atoms ke
thermo_modify lost ignore flush yes
run         ${steps}
"""


@functools.lru_cache
def serial():
    """Whether LMP was built with LAMMPS' stand-in for MPI, which knows one rank."""
    help = subprocess.run([LMP, "-h"], stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)
    return "LAMMPS MPI STUBS" in help.stdout


def height(x):
    """Of the terrain, m: level, a face, a plateau; the same for all y."""
    return np.interp(x, [0.0, TOE, SHOULDER, COLUMNS], [0.0, 0.0, HEIGHT, HEIGHT])


def write_stl(path, low, high):
    """The twelve triangles of a box."""
    corners = np.array([[(low, high)[k >> d & 1][d] for d in range(3)] for k in range(8)], float)
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    with open(path, "w", encoding="ascii") as out:
        out.write("solid box\n")
        for a, b, c, d in faces:
            for triangle in ((a, b, c), (a, c, d)):
                out.write("facet normal 0 0 0\nouter loop\n" + "".join(
                    "vertex {:g} {:g} {:g}\n".format(*corners[k]) for k in triangle) + "endloop\nendfacet\n")
        out.write("endsolid box\n")


def write_case(folder):
    """in.tiny, terrain.asc and road.csv in that folder; the path of the deck."""
    folder = Path(folder)
    folder.mkdir(exist_ok=True)
    row = " ".join(f"{z:.4f}" for z in height(np.arange(COLUMNS) + 0.5))
    (folder / "terrain.asc").write_text(
        f"ncols {COLUMNS}\nnrows {ROWS}\nxllcorner 0\nyllcorner 0\ncellsize 1\nNODATA_value -9999\n"
        + f"{row}\n" * ROWS)
    (folder / "road.csv").write_text("8,0\n13,0\n13,24\n8,24\n")
    (folder / "in.tiny").write_text(DECK)
    return folder / "in.tiny"


def read_asc(path):
    """Values of an ESRI ASCII grid, rows from the north, NODATA as NaN."""
    lines = Path(path).read_text().splitlines()
    values = np.array([line.split() for line in lines[6:]], float)
    return np.where(values == -9999, np.nan, values)


def processes_in(folder):
    """Process ids whose working folder is below a folder."""
    found = []
    for link in Path("/proc").glob("[0-9]*/cwd"):
        try:
            if os.readlink(link).startswith(str(folder)):
                found.append(int(link.parent.name))
        except OSError:
            continue
    return found


def edit(path, *texts):
    """Replace texts of a file, which it must have: old, new, old, new, ..."""
    text = Path(path).read_text()
    for old, new in zip(texts[::2], texts[1::2]):
        assert old in text, (path, old)
        text = text.replace(old, new)
    Path(path).write_text(text)


def rows_of(path, kind=str):
    """Rows of a CSV file, {column: value}."""
    with open(path, newline="", encoding="utf-8") as lines:
        return [{key: kind(value) for key, value in row.items()} for row in csv.DictReader(lines)]


def loaded(name="study"):
    """What out/NAME.yaml has, and the rows of out/NAME.csv."""
    return yaml.safe_load(Path(f"out/{name}.yaml").read_text()), rows_of(f"out/{name}.csv")
