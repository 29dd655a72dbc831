#!/usr/bin/python3
"""The force at rest on mesh walls: a bin of balls, whose walls stand, give way and are pushed in.

    tests/wall_at_rest.py [--lmp FILE] [--repeat 5] [--width 12] [-o DIR]

Balls of 0.8 to 1.2 m come to rest in a bin with smooth side walls: sunk slowly, or dropped, or at rest before most of
their weight comes, slowly. Prints for each repeat (another seed): what walls and floor carry over the weight; K, a
wall's force over that of a fluid of the same weight at each height, for balls without and with friction; K while one
wall is moved away by 0.1 m and pushed in by 1 m, means of the last third of that.

Then without walls, in a periodic box: K of the same balls that are squeezed in one direction from 20 kPa on, and their
bulk friction angle in plane strain: shortened in z, kept in y, at 100 kPa in x.
"""
import argparse
import math
import os
import subprocess
from pathlib import Path
from statistics import mean, stdev

GRAVITY = 9.80665
START = """
variable kn equal 2e8
units si
suffix slope
atom_style sphere
boundary {boundary}
comm_modify vel yes
newton off
region box block 0 {xhi} 0 {width} {bottom} {top} units box
create_box 2 box
region fill block 0 $({width}-0.01) 0 $({width}-0.01) 0 {high} units box
lattice sc 1.5 origin 0.5 0.5 0.5
create_atoms 1 region fill
variable size atom random(0.8,1.2,{seed})
set group all diameter v_size
set group all density 2600
displace_atoms all random 0.13 0.13 0.13 {seed} units box    # a lattice would stand as columns
pair_style gran/restitution
pair_coeff 1 1 stiffness ${{kn}} ${{kn}} restitution 0.2 friction {friction} rolling {rolling}
pair_coeff 1 2 stiffness ${{kn}} ${{kn}} restitution 0.2 friction {floor} rolling 0
neighbor 0.2 bin
neigh_modify every 1 delay 0 check yes
timestep $(0.25*sqrt(2600*PI/6*0.8^3/v_kn))
fix move all nve/sphere
variable second equal ceil(1/dt)
"""
BIN = START + """
fix weight all gravity $(9.80665*{share}) vector 0 0 -1
fix floor all wall/gran/mesh 2 floor.stl
fix x0 all wall/gran/mesh 2 x0.stl
fix x1 all wall/gran/mesh 2 x1_0.stl
fix y0 all wall/gran/mesh 2 y0.stl
fix y1 all wall/gran/mesh 2 y1.stl
variable moment equal mass(all)*xcm(all,z)
variable weight equal 9.80665*mass(all)
variable fx0 equal -f_x0[1]
variable fx1 equal f_x1[1]
variable fy0 equal -f_y0[2]
variable fy1 equal f_y1[2]
variable down equal -f_floor[3]-f_x0[3]-f_x1[3]-f_y0[3]-f_y1[3]
thermo 100000
if {gently} then "fix slow all viscous $(13000*{share})"
run $(v_second*{settle})
if {gently} then "unfix slow" "run $(v_second*8)"
variable grows equal ramp($(9.80665*{share}),9.80665)
if "{share} < 1" then "unfix weight" "fix weight all gravity v_grows vector 0 0 -1" "run $(v_second*8)" &
  "unfix weight" "fix weight all gravity 9.80665 vector 0 0 -1" "run $(v_second*4)"
print "REST ${{weight}} ${{moment}} ${{down}} ${{fx0}} ${{fx1}} ${{fy0}} ${{fy1}} $(f_x0) $(f_x1) $(f_y0) $(f_y1)"
"""
MOVE = """
label again
variable k loop {moves}
unfix x1
fix x1 all wall/gran/mesh 2 x1_{sign}$k.stl
run $(ceil(v_second*{wait})) post no
print "MOVED $k ${{moment}} ${{fx1}} $(f_x1)"
next k
jump SELF again
"""
BULK = START + """
fix slow all viscous 1300
compute p all pressure NULL virial
variable p equal c_p
variable px equal c_p[1]
variable pz equal c_p[3]
variable solid equal mass(all)/2600/vol
thermo 100000
fix shrink all deform 1 x trate -0.02 y trate -0.02 z trate -0.02 remap x
fix stop all halt 10 v_p > {pressure} error continue
run $(v_second*60)
unfix shrink
unfix stop
fix confine all press/berendsen aniso {pressure} {pressure} 0.2 modulus 1e7
fix_modify confine press p
run $(v_second*6)
unfix slow
run $(v_second*3)
unfix confine
fix mean all ave/time 10 100 1000 v_px v_pz v_solid file mean.txt
fix shorten all deform 1 z trate -{rate} remap x
if {hold} then "fix hold all press/berendsen x {pressure} {pressure} 0.15 modulus 1e6" "fix_modify hold press p"
run $(ceil(v_second*{strain}/{rate}))
"""


def stl(path, corners):
    """two triangles of a rectangle"""
    a, b, c, d = corners
    lines = ["solid wall"]
    for triangle in (a, b, c), (a, c, d):
        lines += ["facet normal 0 0 0", "outer loop", *("vertex {:.9g} {:.9g} {:.9g}".format(*p) for p in triangle),
                  "endloop", "endfacet"]
    path.write_text("\n".join([*lines, "endsolid wall", ""]))


def walls(folder, width, top, shifts):
    """the floor, four side walls, and the wall at x = width moved by each of the shifts"""
    folder.mkdir(parents=True, exist_ok=True)
    w = width
    stl(folder / "floor.stl", [(0, 0, 0), (w + 1, 0, 0), (w + 1, w, 0), (0, w, 0)])
    stl(folder / "x0.stl", [(0, 0, 0), (0, w, 0), (0, w, top), (0, 0, top)])
    stl(folder / "y0.stl", [(0, 0, 0), (0, 0, top), (w + 1, 0, top), (w + 1, 0, 0)])
    stl(folder / "y1.stl", [(0, w, 0), (w + 1, w, 0), (w + 1, w, top), (0, w, top)])
    for name, shift in shifts.items():
        x = w + shift
        stl(folder / f"x1_{name}.stl", [(x, 0, 0), (x, w, 0), (x, w, top), (x, 0, top)])


def run(lmp, folder, deck, words, **values):
    """the numbers behind each of the words in what the deck prints, in order"""
    (folder / "in.bin").write_text(deck.format(**values))
    subprocess.run([lmp, "-in", "in.bin", "-screen", "none"], cwd=folder, check=True, stdin=subprocess.DEVNULL)
    lines = [line.split() for line in (folder / "log.lammps").read_text().splitlines()]
    return [[float(x) for x in line[1:]] for line in lines if line and line[0] in words]


def bin_of(args, folder, seed, friction, rolling, gently, sign=None, step=0.0, moves=0, share=1):
    """share: of the weight under which the balls settle; the rest of it comes slowly"""
    shifts = {"0": 0.0}
    shifts.update({f"{sign}{k}": (step if sign == "out" else -step) * k for k in range(1, moves + 1)})
    high = args.height
    walls(folder, args.width, 2 * high, shifts)
    deck = BIN + (MOVE if moves else "")
    rows = run(args.lmp, folder, deck, ("REST", "MOVED"), boundary="f f f", xhi=args.width + 1, width=args.width,
               bottom=-1, top=2 * high, high=high, seed=seed, friction=friction, rolling=rolling, floor=0,
               gently=int(gently), settle=args.settle, sign=sign, moves=moves, wait=0.03, share=share)
    weight, moment, down, *rest = rows[0]
    fluid = GRAVITY * moment / args.width    # of a wall: the weight above each height over the area, times its width
    return {"carried": down / weight, "K": [f / fluid for f in rest[:4]], "contacts": rest[4:8],
            "moved": [(row[2] / (GRAVITY * row[1] / args.width), row[3]) for row in rows[1:]]}


def bulk_of(args, folder, seed, pressure, hold, rate, strain):
    """(pressure in x, pressure in z, share of balls in the volume) while a periodic box is shortened in z"""
    folder.mkdir(parents=True, exist_ok=True)
    run(args.lmp, folder, BULK, (), boundary="p p p", xhi=18, width=18, bottom=0, top=18, high=18, seed=seed,
        friction=args.friction, rolling=args.rolling, floor=0, pressure=pressure, hold=int(hold), rate=rate,
        strain=strain)
    lines = (folder / "mean.txt").read_text().splitlines()
    return [[float(x) for x in line.split()[1:]] for line in lines if not line.startswith("#")]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--lmp", default=os.environ.get("LMP", "build/lmp"))
    parser.add_argument("--repeat", type=int, default=5)
    parser.add_argument("--width", type=float, default=12, help="of the bin, m, a multiple of 1.5")
    parser.add_argument("--height", type=float, default=24, help="of the filling before it settles, m")
    parser.add_argument("--settle", type=float, default=20, help="s")
    parser.add_argument("--friction", type=float, default=25)
    parser.add_argument("--rolling", type=float, default=0.05)
    parser.add_argument("--only", choices=["fluid", "dropped", "rest", "grown", "away", "pushed", "bulk"])
    parser.add_argument("-o", dest="output", type=Path, default=Path("wall_at_rest"))
    args = parser.parse_args()
    args.lmp = Path(args.lmp).resolve()
    seeds = [7919 + 100 * k for k in range(args.repeat)]
    soil = args.friction, args.rolling
    for name, (friction, rolling), gently, share in (("fluid", (0, 0), True, 1), ("dropped", soil, False, 1),
                                                     ("rest", soil, True, 1), ("grown", soil, True, 0.02)):
        if args.only in (None, name):
            all_k, all_n = [], []
            for seed in seeds:
                r = bin_of(args, args.output / name, seed, friction, rolling, gently, share=share)
                all_k += r["K"]
                all_n += r["contacts"]
                print(f"{name}: carried {r['carried']:.5f}, K", *(f"{k:.3f}" for k in r["K"]), "contacts",
                      *(f"{n:.0f}" for n in r["contacts"]), flush=True)
            scatter = stdev(all_k) / mean(all_k)
            n = mean(all_n)
            print(f"{name}: K {mean(all_k):.3f}, scatter of a wall {100 * scatter:.1f} % on {n:.0f} contacts: "
                  f"10 % on {n * (scatter / 0.1) ** 2:.0f}", flush=True)
    for name, sign, step, moves in ("away", "out", 0.0005, 200), ("pushed", "in", 0.002, 500):
        if args.only in (None, name):
            ends = []
            for seed in seeds:
                r = bin_of(args, args.output / name, seed, args.friction, args.rolling, True, sign, step, moves)
                ends.append(mean(k for k, _ in r["moved"][-moves // 3:]))
                tenths = [f"{k:.3f}" for k, _ in r["moved"]][moves // 10 - 1::moves // 10]
                print(f"{name}: K at rest {r['K'][1]:.3f}, then", *tenths, flush=True)
            print(f"{name}: K {mean(ends):.3f} ({min(ends):.3f} to {max(ends):.3f})", flush=True)
    if args.only in (None, "bulk"):
        ratios = []
        for seed in seeds:
            squeezed = bulk_of(args, args.output / "squeezed", seed, 2e4, False, 0.01, 0.02)
            print("squeezed: K", *(f"{px / pz:.2f} at {pz / 1e3:.0f} kPa" for px, pz, _ in squeezed))
            sheared = bulk_of(args, args.output / "sheared", seed, 1e5, True, 0.02, 0.2)
            each = [pz / px for px, pz, _ in sheared]
            ratios.append((max(each), mean(each[-4:])))
            print(f"sheared: largest ratio of pressures {max(each):.2f}, of the last fifth {mean(each[-4:]):.2f}",
                  flush=True)
        for what, several in zip(("largest", "at the end"), zip(*ratios)):
            each = [(one - 1) / (one + 1) for one in several]
            sine = mean(each)
            print(f"bulk friction angle, {what}: {math.degrees(math.asin(sine)):.1f} degrees "
                  f"({math.degrees(math.asin(min(each))):.1f} to {math.degrees(math.asin(max(each))):.1f}): "
                  f"K0 = 1 - sin phi {1 - sine:.3f}, Ka {(1 - sine) / (1 + sine):.3f}, Kp "
                  f"{(1 + sine) / (1 - sine):.2f}")


if __name__ == "__main__":
    main()
