#!/usr/bin/python3
"""Fix wall/gran/mesh beside fix surface/global of LAMMPS' package GRANSURF (4Jul2026): one ball, the same triangles.

    tests/surface_second_opinion.py --lmp OURS --other LMP_WITH_GRANSURF [-o DIR]

Scenes: an oblique impact on a plane of many triangles; a ball that slides and rolls over their edges; an impact on the
edge of a box. Ours with scheme plain, which takes velocities as theirs does; no rolling resistance, which their models
measure otherwise. Prints velocity (m/s) and spin (rad/s) of both at the end, and the difference over the speed before;
ends with status 1 where that is above 1 %.

At a corner the two differ, and there is a judge: without friction the force goes through the corner, so the angular
momentum of the ball about it stays. Prints the change of both over radius times speed; status 1 where ours is above
1 %.
"""
import argparse
import math
import subprocess
from pathlib import Path

import numpy as np

RADIUS, DENSITY, KN, KT, CN, CT = 0.5, 2500.0, 1.0e7, 5.0e6, 6.0e3, 3.0e3
MASS = DENSITY * 4 / 3 * math.pi * RADIUS ** 3
STEP = 0.05 * math.sqrt(MASS / KN)      # s; a fifth of the rule's
TOLERANCE = 0.01

DECK = """units si
atom_style sphere
boundary f f f
newton off
comm_modify vel yes
region box block -20 20 -20 20 -20 20 units box
create_box 2 box
create_atoms 1 single {place}
set atom 1 diameter {diameter} density {density}
set atom 1 vx {v[0]} vy {v[1]} vz {v[2]} omega {w[0]} {w[1]} {w[2]}
{pair}
{wall}
neighbor 0.3 bin
neigh_modify every 1 delay 0 check yes
timestep {step!r}
fix move all nve/sphere
fix weight all gravity {g} vector {down}
compute spin all property/atom omegax omegay omegaz
compute state all reduce sum vx vy vz c_spin[1] c_spin[2] c_spin[3] x y z
thermo {steps}
thermo_style custom step c_state[1] c_state[2] c_state[3] c_state[4] c_state[5] c_state[6] &
             c_state[7] c_state[8] c_state[9]
thermo_modify lost error format float %.10g
run {steps}
"""
OURS = f"stiffness {KN} {KT} damping {CN} {CT} friction "
THEIRS = f"hooke {KN} {CN} damping velocity tangential linear_history {KT} {CT / CN} "


def styles(which, friction):
    """Commands for the pairs and for the surface; friction in degrees."""
    if which == "ours":
        return {"pair": f"pair_style gran/restitution scheme plain\npair_coeff * * {OURS}{friction}",
                "wall": "fix wall all wall/gran/mesh 2 mesh.stl"}
    model = THEIRS + repr(math.tan(math.radians(friction)))
    return {"pair": f"pair_style granular\npair_coeff * * {model}",
            "wall": f"fix wall all surface/global input stl 1 1 mesh.stl model * 1 granular {model}"}


def plane(cells=8, size=4.0):
    """Triangles (n, 3, 3) of the square -size..size at z = 0."""
    x = np.linspace(-size, size, cells + 1)
    found = []
    for a, b in zip(x, x[1:]):
        for c, d in zip(x, x[1:]):
            p = [(a, c, 0), (b, c, 0), (b, d, 0), (a, d, 0)]
            found += [(p[0], p[1], p[2]), (p[0], p[2], p[3])]
    return np.array(found, float)


def block():
    """A cube of -1..1."""
    found = []
    for axis in range(3):
        for side in (-1, 1):
            corners = []
            for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
                p = [0, 0, 0]
                p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3] = side, a, b
                corners.append(p)
            corners = corners if side > 0 else corners[::-1]
            found += [corners[:3], [corners[0], corners[2], corners[3]]]
    return np.array(found, float)


def write_stl(path, triangles):
    text = ["solid mesh"]
    for t in triangles:
        n = np.cross(t[1] - t[0], t[2] - t[0])
        n /= np.linalg.norm(n)
        text += ["facet normal {:.9g} {:.9g} {:.9g}".format(*n), "outer loop",
                 *("vertex {:.9g} {:.9g} {:.9g}".format(*p) for p in t), "endloop", "endfacet"]
    path.write_text("\n".join([*text, "endsolid mesh"]) + "\n")


def scenes():
    """Name, friction (degrees), triangles, place, velocity, spin, gravity's direction and size, seconds."""
    edge = (1 + 0.505 / math.sqrt(2), 0.1, 1 + 0.505 / math.sqrt(2))
    yield "oblique impact", 25.0, plane(), (0.1, 0.2, 0.505), (1.0, 0.3, -1.5), (0, -4, 1), "0 0 -1", 0.0, 0.04
    yield ("slides and rolls over edges", 25.0, plane(), (-2.5, 0.13, 0.5), (2.0, 0.1, 0), (0, 0, 0), "0.2 0 -1", 9.8,
           1.0)
    yield "edge", 25.0, block(), edge, (-1.2, 0.2, -0.8), (0, 0, 1), "0 0 -1", 0.0, 0.04
    corner = tuple(1 + 0.505 / math.sqrt(3) for _ in range(3))
    yield "corner", 0.0, block(), corner, (-0.9, -0.7, -1.1), (0, 0, 0), "0 0 -1", 0.0, 0.04


def run(lmp, which, folder, friction, triangles, place, v, w, down, g, seconds):
    """Velocity (3), spin (3) and place (3) at the end."""
    folder.mkdir(parents=True, exist_ok=True)
    write_stl(folder / "mesh.stl", triangles)
    steps = round(seconds / STEP)
    (folder / "in.one").write_text(DECK.format(
        place="{!r} {!r} {!r}".format(*map(float, place)), diameter=2 * RADIUS, density=DENSITY, v=v, w=w,
        step=STEP, down=down, g=g, steps=steps, **styles(which, friction)))
    subprocess.run([lmp, "-in", "in.one", "-screen", "none"], cwd=folder, check=True, stdin=subprocess.DEVNULL)
    rows = [line.split() for line in (folder / "log.lammps").read_text().splitlines()]
    return np.array([float(word) for row in rows if len(row) == 10 and row[0] == str(steps) for word in row[1:]])


def turned(place, v, final):
    """Change of the angular momentum about the cube's corner, over radius times speed."""
    corner = np.ones(3)
    change = np.cross(final[6:] - corner, final[:3]) - np.cross(np.subtract(place, corner), v)
    return np.linalg.norm(change) / (RADIUS * np.linalg.norm(v))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--lmp", required=True)
    parser.add_argument("--other", required=True)
    parser.add_argument("-o", dest="output", type=Path, default=Path("second_opinion"))
    args = parser.parse_args()
    programs = {"ours": str(Path(args.lmp).absolute()), "theirs": str(Path(args.other).absolute())}
    worst = 0.0
    for name, *scene in scenes():
        final = {which: run(lmp, which, args.output / name.replace(" ", "_") / which, *scene)
                 for which, lmp in programs.items()}
        place, v, w = scene[2:5]
        if name == "corner":
            off = turned(place, v, final["ours"])
            print(f"{name}: angular momentum about it changes by {100 * off:.3f} % in ours, "
                  f"{100 * turned(place, v, final['theirs']):.1f} % in theirs")
        else:
            speed = max(np.linalg.norm(v), RADIUS * np.linalg.norm(w))
            difference = final["ours"] - final["theirs"]
            off = max(np.linalg.norm(difference[:3]), RADIUS * np.linalg.norm(difference[3:6])) / speed
            print(f"{name}: {100 * off:.3f} %")
        worst = max(worst, off)
        for which, values in final.items():
            print(f"  {which:7}" + " ".join(f"{value:10.5f}" for value in values[:6]))
    return int(worst > TOLERANCE)


if __name__ == "__main__":
    raise SystemExit(main())
