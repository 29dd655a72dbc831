#!/usr/bin/python3
"""Run-out against the time step: the same masses at the rule's step and at a part of it.

    tests/runout_step.py [--lmp FILE] [--part 0.1] [--spacing 0.25,0.35,0.5,0.8,1] [--e 0.1,0.3,0.5] [-o DIR]

2,400 balls of 1 m that do not touch each other, or a mass of 400 that do (friction 12), on a field of fixed balls of
1 m: 6 s down 32 degrees, then level until they rest. Prints for each field the mean of the distances and the
distance of 99 % of the balls at the rule's step, each less that at the part of it, in % of the latter, with the
standard error of this difference: of single balls by bootstrap, of the mass over its seeds (pairs of runs from the
same start).
"""
import argparse
import os
import subprocess
from pathlib import Path

import numpy as np

DECK = """
units si
atom_style sphere
boundary f f f
comm_modify vel yes
region box block -2 900 -60 104 -2 40
create_box 2 box
lattice sc {lattice}
region mass block {mass} units box
create_atoms 1 region mass
displace_atoms all random {random} {random} {random} {seed}
set group all diameter 1.0
set group all density 2650
region ground block -20 2000 -100 200 -1.5 0
neighbor 0.3 bin
neigh_modify every 1 delay 0 check yes binsize 8 {exclude}
pair_style gran/restitution
pair_coeff * * stiffness 5e7 5e7 restitution {e} friction {friction} rolling 0.05
timestep $({part}*0.25*sqrt(2650*PI/6/5e7))
fix field all wall/gran/balls 2 1.0 surface ground upper spacing {spacing}
fix weight all gravity 9.81 vector $(sin(32*PI/180)) 0 $(-cos(32*PI/180))
fix move all nve/sphere
variable x0 atom x
fix start all store/state 0 x
variable far atom x-f_start
thermo_modify lost warn
thermo 100000
run $(round(6/dt))
unfix weight
fix weight all gravity 9.81 vector 0 0 -1
variable speed atom sqrt(vx^2+vy^2+vz^2)
compute fastest all reduce max v_speed
variable fastest equal c_fastest
fix rest all halt 1000 v_fastest < 0.05 error continue
run $(round(60/dt))
write_dump all custom end.dump id v_far v_speed modify sort id
"""
SINGLE = dict(lattice=1.3, random=0.1, exclude="exclude type 1 1", friction=30)
MASS = dict(mass="2 10 15 25.3 1.6 6.5", lattice=1.05, random=0.02, exclude="", friction=12)


def distances(args, name, **values):
    """distance of each ball (m), and how many still move"""
    folder = args.output / name
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "in.runout").write_text(DECK.format(**values))
    subprocess.run([args.lmp, "-in", "in.runout", "-screen", "none"], cwd=folder, check=True, stdin=subprocess.DEVNULL)
    table = np.loadtxt(folder / "end.dump", skiprows=9)
    return table[:, 1], np.count_nonzero(table[:, 2] > 0.05)


def measures(far):
    return np.array([far.mean(), np.quantile(far, 0.99)])


def single(args, spacing, e):
    rng = np.random.default_rng(1)
    block = f"2 12 2 {2 + 1.3 * (args.balls // 40)} 1.6 8"
    runs = []
    for part in (1, args.part):
        starts = [distances(args, f"single_{spacing}_{e}_{seed}_{part}", mass=block, spacing=spacing, e=e, part=part,
                            seed=seed, **SINGLE) for seed in range(42, 42 + args.starts)]
        runs.append((np.concatenate([far for far, _ in starts]), sum(moving for _, moving in starts)))
    drawn = [[measures(rng.choice(far, far.size)) for _ in range(500)] for far, _ in runs]
    change = 100 * (np.divide(*drawn) - 1)
    return [measures(far) for far, _ in runs], change.std(axis=0), runs


def mass(args, spacing, e):
    runs = [[distances(args, f"mass_{spacing}_{e}_{seed}_{part}", spacing=spacing, e=e, part=part, seed=seed, **MASS)
             for seed in range(1, args.seeds + 1)] for part in (1, args.part)]
    each = np.array([[measures(far) for far, _ in row] for row in runs])
    change = 100 * (each[0] - each[1]) / each[1].mean(axis=0)
    return each.mean(axis=1), change.std(axis=0, ddof=1) / np.sqrt(args.seeds), [run for row in runs for run in row]


def main():
    def numbers(text):
        return [float(word) for word in text.split(",")]

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--lmp", default=os.environ.get("LMP", "build/lmp"))
    parser.add_argument("--part", type=float, default=0.1, help="of the rule's step, to compare with")
    parser.add_argument("--spacing", type=numbers, default="0.25,0.35,0.5,0.8,1", help="of the field, diameters")
    parser.add_argument("--e", type=numbers, default="0.1,0.3,0.5", help="restitution")
    parser.add_argument("--balls", type=int, default=2400, help="that do not touch each other, a multiple of 40")
    parser.add_argument("--starts", type=int, default=1, help="of these, all taken together")
    parser.add_argument("--seeds", type=int, default=8, help="of the mass of 400")
    parser.add_argument("--only", choices=["single", "mass"])
    parser.add_argument("-o", dest="output", type=Path, default=Path("runout_step"))
    args = parser.parse_args()
    args.lmp = Path(args.lmp).resolve()
    for name, case in (("single", single), ("mass", mass)):
        for spacing in args.spacing if args.only in (None, name) else []:
            for e in args.e:
                (rule, part), error, runs = case(args, spacing, e)
                change = 100 * (rule / part - 1)
                balls, moving = [sum(row) for row in zip(*((far.size, still) for far, still in runs))]
                print(f"{name} spacing {spacing:g} e {e:g}: mean {rule[0]:.1f} m {change[0]:+.1f} +- {error[0]:.1f} %, "
                      f"99 % {rule[1]:.1f} m {change[1]:+.1f} +- {error[1]:.1f} % ({balls} balls, {moving} move)",
                      flush=True)


if __name__ == "__main__":
    main()
