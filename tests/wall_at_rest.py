#!/usr/bin/python3
"""The force at rest on mesh walls: a bin of balls, whose walls stand, give way and are pushed in.

    tests/wall_at_rest.py [--lmp FILE] [--repeat 5] [--width 12] [-o DIR]

Balls of 0.8 to 1.2 m come to rest in a bin with smooth side walls: sunk slowly, or dropped. Prints for each repeat
(another seed): what walls and floor carry over the weight; K, a wall's force over that of a fluid of the same weight
at each height, for balls without and with friction; K while one wall is moved away by 0.1 m and pushed in by 1 m,
means of the last third of that. Then the bulk friction angle of the same balls: the inclination at which a layer of
them on frozen ones begins to flow.
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
region box block 0 {xhi} 0 {width} -1 {top} units box
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
TILT = START + """
fix weight all gravity 9.80665 chute 0
region low block INF INF INF INF -1 2.0 units box
fix floor all wall/gran/mesh 2 floor.stl
fix slow all viscous 13000
run $(v_second*{settle})
unfix slow
run $(v_second*3)
group low region low
group high subtract all low
unfix move
fix move high nve/sphere
fix hold low freeze
reset_timestep 0
variable angle equal step*dt*{rate}
unfix weight
fix weight all gravity 9.80665 chute v_angle
variable speed equal vcm(high,x)
thermo_style custom step v_angle v_speed
fix stop all halt 100 v_speed > 0.2 error continue
thermo 100000
run $(v_second*{tilt})
print "FLOWS ${{angle}} ${{speed}}"
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


def bin_of(args, folder, seed, friction, rolling, gently, sign=None, step=0.0, moves=0, share=1.0, wait=0.03):
    """share: of the weight under which the balls settle; the rest of it comes slowly"""
    shifts = {"0": 0.0}
    shifts.update({f"{sign}{k}": (step if sign == "out" else -step) * k for k in range(1, moves + 1)})
    high = args.height
    walls(folder, args.width, 2 * high, shifts)
    deck = BIN + (MOVE if moves else "")
    rows = run(args.lmp, folder, deck, ("REST", "MOVED"), boundary="f f f", xhi=args.width + 1, width=args.width,
               top=2 * high, high=high, seed=seed, friction=friction, rolling=rolling, floor=0, gently=int(gently),
               settle=args.settle, sign=sign, moves=moves, wait=wait, share=share)
    weight, moment, down, *rest = rows[0]
    fluid = GRAVITY * moment / args.width    # of a wall: the weight above each height over the area, times its width
    return {"carried": down / weight, "K": [f / fluid for f in rest[:4]], "contacts": rest[4:8],
            "moved": [(row[2] / (GRAVITY * row[1] / args.width), row[3]) for row in rows[1:]]}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--lmp", default=os.environ.get("LMP", "build/lmp"))
    parser.add_argument("--repeat", type=int, default=5)
    parser.add_argument("--width", type=float, default=12, help="of the bin, m, a multiple of 1.5")
    parser.add_argument("--height", type=float, default=24, help="of the filling before it settles, m")
    parser.add_argument("--settle", type=float, default=20, help="s")
    parser.add_argument("--friction", type=float, default=25)
    parser.add_argument("--rolling", type=float, default=0.05)
    parser.add_argument("--only", choices=["fluid", "dropped", "rest", "away", "pushed", "tilt"])
    parser.add_argument("-o", dest="output", type=Path, default=Path("wall_at_rest"))
    args = parser.parse_args()
    args.lmp = Path(args.lmp).resolve()
    seeds = [7919 + 100 * k for k in range(args.repeat)]
    for name, friction, rolling, gently in (("fluid", 0, 0, True), ("dropped", args.friction, args.rolling, False),
                                            ("rest", args.friction, args.rolling, True)):
        if args.only in (None, name):
            all_k, all_n = [], []
            for seed in seeds:
                r = bin_of(args, args.output / name, seed, friction, rolling, gently)
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
    if args.only in (None, "tilt"):
        angles = []
        for seed in seeds:
            folder = args.output / "tilt"
            walls(folder, args.width, 2 * args.height, {})
            stl(folder / "floor.stl", [(-1, -1, 0), (args.width + 1, -1, 0), (args.width + 1, args.width + 1, 0),
                                       (-1, args.width + 1, 0)])
            rows = run(args.lmp, folder, TILT, ("FLOWS",), boundary="p p f", xhi=args.width, width=args.width,
                       top=2 * args.height, high=args.height, seed=seed, friction=args.friction, rolling=args.rolling,
                       floor=args.friction, settle=args.settle, rate=1.5, tilt=32)
            angles.append(rows[0][0])
            print(f"tilt: flows at {rows[0][0]:.1f} degrees", flush=True)
        phi = math.radians(mean(angles))
        print(f"tilt: {math.degrees(phi):.1f} degrees: K0 = 1 - sin phi {1 - math.sin(phi):.3f}, "
              f"Ka {(1 - math.sin(phi)) / (1 + math.sin(phi)):.3f}, Kp {(1 + math.sin(phi)) / (1 - math.sin(phi)):.2f}")


if __name__ == "__main__":
    main()
