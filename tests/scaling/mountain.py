#!/usr/bin/python3
"""Seconds of CPU of the set-up on a mountain, on one rank: the body of the Frank slide of 1903, 36 Mm3 on 4 x 4 km.

    tests/scaling/mountain.py FOLDER [--lmp FILE] [--diameters 10,5,2.5] [--steps N] [-o DIR]

FOLDER holds Frankslide_topography.asc and Frankslide_pile.asc (the tilupy project, data/frankslide/rasters): the
ground without the body, and the body's thickness, m. Prints a line per diameter: balls, and user + system time of
create_atoms, of all that comes before the first step, and with --steps of these steps.
"""
import argparse
import re
import resource
import subprocess
import sys
from pathlib import Path

import numpy as np

DECK = """# set-up of a body between two terrains on a mountain
units si
atom_style sphere
boundary s s fs
comm_modify vel yes
region ground terrain ground.asc depth 50 headroom 50
region above terrain slip.asc depth 50 side out
region body intersect 2 ground above
region plan block 280 1280 1000 2020 1181 2300 units box
region box block 0 4020 0 4020 1181 2300 units box
region release intersect 2 plan body
create_box 3 box
lattice sc ${d}
create_atoms 1 region release
group soil type 1
set group soil diameter ${d} density 2700
variable kn equal 1e7*v_d
pair_style gran/restitution
pair_coeff * * stiffness ${kn} ${kn} restitution 0.5 friction 30
variable half equal v_d/2
if "${stage} == 0" then quit
fix slip soil wall/gran/balls 2 ${d} surface body lower spacing ${half} inside body
fix field soil wall/gran/balls 3 ${d} surface ground upper spacing ${d} outside body
delete_balls soil overlap 0.0
variable skin equal 0.2*v_d
neighbor ${skin} bin
atom_modify sort 1000 $(20*v_d)
variable mass equal 2700*PI/6*v_d^3
variable dt equal 0.25*sqrt(v_mass/v_kn)
timestep ${dt}
fix move soil nve/sphere
fix weight soil gravity 9.80665 vector 0 0 -1
thermo_modify lost ignore
run ${steps}
"""


def read(path):
    """(header lines, values) of an ESRI ASCII grid."""
    lines = path.read_text().splitlines()
    return lines[:6], np.array([[float(word) for word in line.split()] for line in lines[6:] if line.strip()])


def write_surfaces(source, folder):
    """ground.asc and slip.asc: before the slide, and below the body."""
    header, slip = read(source / "Frankslide_topography.asc")
    header = [re.sub("(?i)^([xy]llcorner).*", r"\1 0", line) for line in header]
    _, pile = read(source / "Frankslide_pile.asc")
    for name, values in (("slip", slip), ("ground", slip + pile)):
        rows = "\n".join(" ".join(f"{z:.3f}" for z in row) for row in values)
        (folder / f"{name}.asc").write_text("\n".join(header) + "\n" + rows + "\n")


def cpu(lmp, folder, **variables):
    """User and system time (s) of a run, and its log."""
    command = [lmp, "-in", "in.mountain", "-screen", "none"]
    for name, value in variables.items():
        command += ["-var", name, str(value)]
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, cwd=folder, check=True, stdin=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return (after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, (folder / "log.lammps").read_text())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("source", type=Path, metavar="FOLDER")
    parser.add_argument("--lmp", default=str(Path(__file__).resolve().parents[2] / "build" / "lmp"))
    parser.add_argument("--diameters", default="10,5,2.5")
    parser.add_argument("--steps", type=int, default=0)
    parser.add_argument("-o", dest="output", type=Path, default=Path("mountain"))
    args = parser.parse_args()
    lmp = str(Path(args.lmp).absolute())
    args.output.mkdir(exist_ok=True)
    (args.output / "in.mountain").write_text(DECK)
    write_surfaces(args.source, args.output)
    print(f"{'d, m':>6} {'soil balls':>12} {'atoms, s':>10} {'set-up, s':>10}"
          + (f" {args.steps:>8} steps, s" if args.steps else ""))
    for d in args.diameters.split(","):
        atoms, _ = cpu(lmp, args.output, d=d, stage=0, steps=0)
        setup, log = cpu(lmp, args.output, d=d, stage=1, steps=0)
        line = f"{d:>6} {int(re.search('Created ([0-9]+) atoms', log)[1]):12,} {atoms:10.2f} {setup:10.2f}"
        if args.steps:
            more, _ = cpu(lmp, args.output, d=d, stage=1, steps=args.steps)
            line += f" {more - setup:14.2f}"
        print(line, flush=True)


if __name__ == "__main__":
    sys.exit(main())
