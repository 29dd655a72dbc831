#!/usr/bin/python3
"""Restitution against the time step: impacts at 1, 1.5 and 2 times the rule's step, and at a twentieth of it.

    tests/step_restitution.py [--factors 1,1.5,2] [--e 0.48,0.1] [-o DIR]

A ball hits others at 20 moments within a step, without friction: one that is fixed or free, polygons of fixed ones,
half and twice as large ones, a row, three that lie on fixed ones, a heap; a plane and a groove of triangles; scattered
ground; fixed balls that are shaken.  Prints the velocity after the impact over that before at a twentieth of the step,
and for each factor the mean difference from it, the least and the largest one.  LMP: the program.
"""
import argparse
import sys
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE / "decks"), str(HERE)]

import mesh_helpers as meshes       # noqa: E402
from deck_helpers import run_deck       # noqa: E402
from test_company import PHASES, SPEED, phase, velocities       # noqa: E402

FINE = 0.05
ALONE = [(1.0, 1.0), (1.0, 2.0), (2.0, 1.0)]        # diameters of the ball and of its partner
RINGS = [(n, spacing) for spacing in (0.35, 0.4, 0.5, 0.65, 0.8, 0.95) for n in (3, 4)] + [
    (6, 0.35), (6, 0.4), (5, 0.5), (6, 0.65), (6, 0.87)]
ON_GROUND = """
units si
atom_style sphere
atom_modify map array
boundary f f f
comm_modify vel yes
region box block -4 84 -4 84 -4 4
region base block -3 83 -3 83 -2 0
create_box 2 box
{balls}
set group all diameter 1.0
set group all density {density}
pair_style gran/restitution
pair_coeff * * stiffness {stiffness} {stiffness} restitution {e} friction 0
neighbor 0.2 bin
neigh_modify every 1 delay 0 check yes
timestep {dt}
velocity all set {across} 0 -1
fix ground all wall/gran/balls 2 1.0 {ground}
fix move all nve/sphere
run {steps}
write_dump all custom out.dump id vx vy vz modify sort id format float %.17g
"""
SHAKE = "file places.txt\nfix shake all ground/motion motion.txt"


def ring(n, spacing, partner=1.0):
    """Places of n balls in a polygon with sides of spacing partners; height of a ball of 1 m that touches them."""
    far = spacing * partner / 2 / np.sin(np.pi / n)
    angles = 2 * np.pi * np.arange(n) / n + 0.2
    return far * np.transpose([np.cos(angles), np.sin(angles)]), np.sqrt(((1 + partner) / 2) ** 2 - far ** 2)


def alone(partner_type, d, partner):
    """The velocity at which they part."""
    def balls(k):
        return [(1, d, 0, 0, (d + partner) / 2 + phase(k), 0, 0, -SPEED), (partner_type, partner, 0, 0, 0, 0, 0, 0)]
    return lambda folder, e, part: np.subtract(*velocities(folder, PHASES, balls, e, part=part, steps=400)[:, :, 2].T)


def on_ring(n, spacing, partner=1.0):
    places, high = ring(n, spacing, partner)

    def balls(k):
        return [(1, 1.0, 0, 0, high + phase(k) * (1 + partner) / 2 / high, 0, 0, -SPEED),
                *((2, partner, x, y, 0, 0, 0, 0) for x, y in places)]
    return lambda folder, e, part: velocities(folder, PHASES, balls, e, part=part, steps=400)[:, 0, 2]


def row(folder, e, part):
    """The root of the energy of five."""
    def balls(k):
        return [(1, 1.0, -phase(k), 0, 0, SPEED, 0, 0), *((1, 1.0, q, 0, 0, 0, 0, 0) for q in range(1, 5))]
    return np.linalg.norm(velocities(folder, PHASES, balls, e, part=part, steps=400)[:, :, 0], axis=1)


def on_three(folder, e, part):
    """On three free ones, each on a fixed one."""
    places, high = ring(3, 1.0)

    def balls(k):
        return [(1, 1.0, 0, 0, high + phase(k) / high, 0, 0, -SPEED), *((1, 1.0, x, y, 0, 0, 0, 0) for x, y in places),
                *((2, 1.0, x, y, -1.0, 0, 0, 0) for x, y in places)]
    return velocities(folder, PHASES, balls, e, part=part, steps=400)[:, 0, 2]


def on_mesh(slope):
    """On a groove of two planes of a slope (degrees)."""
    triangles = meshes.plane(10, height=lambda x, y: np.tan(np.radians(slope)) * abs(x))

    def measured(folder, e, part):
        step = meshes.rule_step()
        high = 0.5 / np.cos(np.radians(slope))
        meshes.write_case(folder, triangles, [(0, 0.3, high + step * (2 + (k + 0.5) / PHASES)) for k in range(PHASES)],
                          (0, 0, -1))
        steps = round(300 / part)
        _, frames, _ = meshes.run_case(folder, f"run {steps}", coeff=f"restitution {e} friction 0", dt=part * step,
                                       every=steps, dump_every=steps)
        return frames[-1][:, 6]
    return measured


def shaken(n, spacing):
    """Ground that moves by up to 20 m/s2."""
    places, high = ring(n, spacing)

    def measured(folder, e, part):
        step = meshes.rule_step()
        (folder / "places.txt").write_text("".join(f"{4 * k + x:.15g} {y:.15g} 0\n" for k in range(PHASES)
                                                   for x, y in places))
        times = np.arange(0, 3, 0.01)
        (folder / "motion.txt").write_text("# t ax ay az\n" + "".join(
            f"{t:.2f} {5 * np.sin(30 * t):.6f} 0 {20 * np.sin(40 * t):.6f}\n" for t in times))
        starts = [(4 * k, 0, high + step * (2 + (k + 0.5) / PHASES) / high) for k in range(PHASES)]
        return after(folder, starts, SHAKE, e, part)[:, 2]
    return measured


def after(folder, starts, ground, e, part, across=0):
    """Velocities after balls have hit the ground at 1 m/s down."""
    balls = "\n".join("create_atoms 1 single {:.15g} {:.15g} {:.15g}".format(*start) for start in starts)
    run_deck(ON_GROUND.format(balls=balls, density=meshes.RHO, stiffness=meshes.STIFFNESS, e=e, ground=ground,
                              across=across, dt=part * meshes.rule_step(), steps=round(200 / part)), folder)
    return np.loadtxt(folder / "out.dump", skiprows=9)[:, 1:]


def scattered(spacing, across):
    """Speeds of 400 balls after they have hit scattered ground, aslant if they move across; one to six contacts."""
    places = 4.0 * np.stack(np.meshgrid(np.arange(20), np.arange(20)), -1).reshape(-1, 2)
    places = places + np.random.default_rng(1).uniform(0, 1, places.shape)
    ground = f"surface base upper spacing {spacing} pattern scattered 7"
    return lambda folder, e, part: np.linalg.norm(after(folder, [(*place, 1.0) for place in places], ground, e, part,
                                                        across), axis=1)


def on_packing(folder, e, part):
    """The root of the energy: a ball that hits the top of a heap of free ones in three layers, on fixed ones."""
    def layer(k):
        x, y = np.transpose([(i + 0.5 * j, np.sqrt(0.75) * j) for j in range(k + 1) for i in range(k + 1 - j)])
        return np.transpose([x - x.mean(), y - y.mean(), np.full(x.size, -k * np.sqrt(2 / 3))])

    def balls(k):
        free = [place for depth in (1, 2, 3) for place in layer(depth)]
        return [(1, 1.0, 0, 0, phase(k), 0, 0, -SPEED), *((1, 1.0, *place, 0, 0, 0) for place in free),
                *((2, 1.0, *place, 0, 0, 0) for place in layer(4))]
    v = velocities(folder, PHASES, balls, e, part=part, steps=400)
    return np.linalg.norm(v.reshape(PHASES, -1), axis=1)


CASES = {
    **{f"{d:g} on {kind} {partner:g}": alone(number, d, partner) for kind, number in (("fixed", 2), ("free", 3))
       for d, partner in ALONE},
    **{f"on {n} fixed, spacing {spacing:g}": on_ring(n, spacing) for n, spacing in RINGS},
    "on 3 fixed 2, spacing 0.5": on_ring(3, 0.5, 2.0), "row of five": row, "on three free": on_three,
    "mesh, plane": on_mesh(0), "mesh, groove of 120 degrees": on_mesh(30),
    "on a packing": on_packing, **{
        f"scattered ground, spacing {spacing:g}{', aslant' * across}": scattered(spacing, across)
        for spacing in (0.35, 0.5, 0.9) for across in (0, 1)},
    **{f"shaken, on {n}, spacing {spacing:g}": shaken(n, spacing) for n, spacing in ((4, 0.5), (3, 0.95))}}


def main():
    def numbers(text):
        return [float(word) for word in text.split(",")]

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--factors", type=numbers, default="1,1.5,2", help="of the rule's step")
    parser.add_argument("--e", type=numbers, default="0.48,0.1", help="restitution")
    parser.add_argument("-o", dest="output", type=Path, default=Path("step_restitution"))
    args = parser.parse_args()
    args.output.mkdir(parents=True, exist_ok=True)
    for name, measured in CASES.items():
        for e in args.e:
            law = measured(args.output, e, FINE)
            several = [(factor, measured(args.output, e, factor) - law) for factor in args.factors]
            words = (f"step {factor:g}: {off.mean():+.3f} ({off.min():+.3f} to {off.max():+.3f})"
                     for factor, off in several)
            print(f"{name}, e {e:g}: {law.mean():.3f};", ", ".join(words), flush=True)


if __name__ == "__main__":
    main()
