#!/usr/bin/python3
"""The stop angle of a ground of fixed balls, and the table of them that the package has.

    tests/stop_angles.py [--only scattered,0.8,30,0.05,0.3,3 ...] [--seeds 2] [--size 24,8] [--set NAME=VALUE ...]
                         [--table FILE] [--jobs 1] [--lmp FILE] -o DIR
    tests/stop_angles.py --sheet scattered,0.8,30,0.05,0.3,3 --angle 22.5 -o DIR

Makes what runs are missing in DIR. The stop angle is midway between the greatest whole degree at which a sheet three
balls thick, started at sqrt(g d), comes to rest within 40 s in a periodic strip of fixed balls, and the next. Balls
are of 1 m; with others the time grows with the root of the diameter. A run ends at rest (hardly a ball moves), or
once the sheet is half as fast again as at the start and faster than before; one that moves after 40 s has not stopped.

A ground is pattern, spacing (diameters), friction (degrees), rolling resistance, restitution on it (0.48 within the
sheet) and balls that the sheet is thick. Without --only: all of the table. --table: written once all are there.

--sheet: a sheet of some 2,000 balls, 28 m long and 22 wide, with open sides instead, started at sqrt(g d): what share
stays on the slope, whose foot is 45 m below it, 2 degrees below the stop angle (bound: at least 90 %) and 8 above it
(at most 40 %). Status 1 otherwise. Nothing lies below the foot: a heap there would hold back what follows.
"""
import argparse
import csv
import os
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

import numpy as np

TOP = Path(__file__).resolve().parents[1]
START = """
variable th index 20
variable kn index 1e8
variable speed index $(sqrt(9.80665))
units si
suffix slope
atom_style sphere
boundary {boundary}
comm_modify vel yes
read_data {data}
group soil type 1
pair_style gran/restitution
pair_coeff 1 1 stiffness ${{kn}} ${{kn}} restitution 0.48 friction {friction} rolling {rolling}
pair_coeff 1 2 stiffness ${{kn}} ${{kn}} restitution {restitution} friction {friction} rolling {rolling}
pair_coeff 2 2 stiffness ${{kn}} ${{kn}} restitution {restitution} friction {friction} rolling {rolling}
neighbor 0.2 bin
neigh_modify every 1 delay 0 check yes exclude type 2 2 binsize {bins}
timestep $(0.25*sqrt({density}*PI/6/v_kn))
fix move soil nve/sphere
fix weight soil gravity 9.80665 vector $(sin(v_th*PI/180)) 0 $(-cos(v_th*PI/180))
velocity soil set ${{speed}} 0 0
variable second equal ceil(1/dt)
variable fast atom "vx*vx+vy*vy+vz*vz > 0.01"
compute moving soil reduce sum v_fast
variable rest equal "c_moving < 0.003*{number}"
"""
DECK = START + """
variable tend index 40
group ground type 2
fix still ground freeze
compute vx soil reduce ave vx
fix mean all ave/time 10 $(floor(v_second/10)) $(10*floor(v_second/10)) c_vx ave running
variable flows equal "step*dt > 5 && c_vx > 1.5*v_speed && c_vx > f_mean"
variable ended equal v_rest||v_flows
fix ended all halt $(10*floor(v_second/10)) v_ended == 1 error continue
thermo $(10*floor(v_second/10))
thermo_style custom step time atoms c_moving c_vx f_mean
run $(ceil(v_tend/dt))
print "RESULT $(v_rest) $(step*dt) $(c_vx) $(c_moving)"
"""
SHEET = START + """
variable tend index 200
region ground block -40 200 -80 80 -3 0
fix field soil wall/gran/balls 2 1 surface ground upper spacing {spacing} pattern {words}
fix ended all halt ${{second}} v_rest == 1 error continue
thermo ${{second}}
thermo_style custom step time atoms c_moving
thermo_modify lost ignore
run $(ceil(v_tend/dt))
print "LEFT $(100*count(soil)/{number}) $(step*dt) $(c_moving)"
"""
DENSITY = 3411.4
RESULT = re.compile(r"^RESULT (\S+) (\S+) (\S+) (\S+)$", re.M)
LEFT = re.compile(r"^LEFT (\S+) (\S+) (\S+)$", re.M)
SHEET_SIZE, FOOT = (64.0, 10.0), 45.0       # m
FINER, NEAREST = 6, 0.795       # as src/ground/scattered_sampler.cpp
SOLID = 0.55                    # share of the sheet's volume
STEEPEST = 60


class Ground(NamedTuple):
    pattern: str
    spacing: float
    friction: float
    rolling: float
    restitution: float = 0.3
    layers: float = 3

    @property
    def name(self):
        return "_".join(map("{:g}".format, self[1:])).join((f"{self.pattern}_", ""))


def grounds_of_the_table():
    every = [Ground("scattered", spacing, 30, rolling) for rolling in (0.05, 0.0, 0.1)
             for spacing in (0.8, 0.5, 0.95, 0.7, 0.6, 0.9, 0.35)]
    for friction in (20, 10):
        every += [Ground("scattered", spacing, friction, 0.05) for spacing in (0.8, 0.5, 0.95)]
    every += [Ground("scattered", 0.8, 30, 0.05, e) for e in (0.1, 0.5)]
    every += [Ground("scattered", 0.8, 30, 0.05, 0.3, layers) for layers in (1, 5)]
    every += [Ground("grid", spacing, 30, 0.05) for spacing in (0.5, 0.8, 1.0)]
    # the corners
    every += [Ground("scattered", 0.8, 30, rolling, 0.1) for rolling in (0.0, 0.1)]
    every += [Ground("scattered", spacing, friction, rolling) for friction in (20, 10) for rolling in (0.0, 0.1)
              for spacing in (0.8, 0.5, 0.95)]
    every += [Ground("scattered", spacing, 30, 0.05, 0.1) for spacing in (0.5, 0.95)]
    every += [Ground("scattered", spacing, 40, 0.05) for spacing in (0.8, 0.5, 0.95)]
    every += [Ground("scattered", spacing, 30, 0.2) for spacing in (0.8, 0.5, 0.95)]
    every += [Ground("grid", 0.8, 30, rolling) for rolling in (0.0, 0.1)]
    return every + [Ground("grid", 0.8, 30, 0.05, 0.1), Ground("grid", 1.0, 20, 0.05),
                    Ground("scattered", 0.35, 10, 0.0), Ground("scattered", 0.95, 10, 0.0, 0.5),
                    *(ground._replace(layers=0.3) for ground in every[:21])]      # hardly a ball touches another one


def ground_of(text):
    words = text.split(",")
    if words[0] not in ("scattered", "grid") or not 4 <= len(words) <= 6:
        raise argparse.ArgumentTypeError("PATTERN,SPACING,FRICTION,ROLLING[,RESTITUTION[,LAYERS]]")
    return Ground(words[0], *map(float, words[1:]))


# --- the strip ---

def scattered(nx, ny, spacing, rng):
    """Places on a torus of nx by ny spacings: a candidate in each cell of a finer lattice; in random order each is a
    ball unless one is nearer than NEAREST spacings."""
    i, j = np.meshgrid(np.arange(nx * FINER), np.arange(ny * FINER))
    candidates = (np.column_stack([i.ravel(), j.ravel()]) + rng.random((i.size, 2))) / FINER
    kept = np.empty((4 * nx * ny, 2))
    number = 0
    for one in rng.permutation(candidates):
        apart = kept[:number] - one
        apart -= np.rint(apart / (nx, ny)) * (nx, ny)
        if not number or (apart ** 2).sum(axis=1).min() >= NEAREST ** 2:
            kept[number] = one
            number += 1
    return kept[:number] * spacing


def sheet_of(layers, lx, ly, rng):
    """Centers of loose balls of 1 m above a ground at z = 0, over all of a rectangle."""
    number = round(layers * SOLID / (np.pi / 6) * lx * ly)
    kx, ky = int(lx / 1.03), int(ly / 1.03)
    levels = np.arange(number) // (kx * ky)
    nodes = np.concatenate([rng.permutation(kx * ky) for _ in range(levels[-1] + 1)])[:number]
    soil = np.column_stack([(nodes % kx + 0.5) * lx / kx, (nodes // kx + 0.5) * ly / ky, 1.13 + 1.03 * levels])
    return soil + rng.uniform(-0.01, 0.01, soil.shape)


@lru_cache(maxsize=1)       # for all angles
def strip(ground, size, seed):
    """Of a strip of whole spacings, of about a size along and across: its box, the sheet, the fixed balls."""
    rng = np.random.default_rng(seed)
    nx, ny = (max(1, round(length / ground.spacing)) for length in size)
    lx, ly = nx * ground.spacing, ny * ground.spacing
    if ground.pattern == "scattered":
        fixed = scattered(nx, ny, ground.spacing, rng)
    else:
        i, j = np.meshgrid(np.arange(nx), np.arange(ny))
        fixed = ground.spacing * np.column_stack([i.ravel(), j.ravel()])
    return (0, lx, 0, ly), sheet_of(ground.layers, lx, ly, rng), fixed % (lx, ly)


def write_data(path, box, soil, fixed):
    """box: least and greatest x, least and greatest y."""
    rows = [(1, *at) for at in soil] + [(2, *at, 0.0) for at in fixed]
    xlo, xhi, ylo, yhi = box
    path.write_text(f"strip\n\n{len(rows)} atoms\n2 atom types\n"
                    f"{xlo:.9g} {xhi:.9g} xlo xhi\n{ylo:.9g} {yhi:.9g} ylo yhi\n-3 60 zlo zhi\n\nAtoms # sphere\n\n"
                    + "".join(f"{k} {kind} 1 {DENSITY} {x:.6f} {y:.6f} {z:.6f}\n"
                              for k, (kind, x, y, z) in enumerate(rows, 1)))


def lammps(options, folder, deck, log, values):
    words = [word for key, value in values.items() for word in ("-var", key, str(value))]
    subprocess.run([options.lmp, "-in", deck, "-log", log, "-screen", "none", *words], check=True, cwd=folder,
                   env=dict(os.environ, OMP_NUM_THREADS="1"), stdin=subprocess.DEVNULL)


def result(options, name, angle, pattern, write):
    """The match of a pattern in the log of a run, made unless it is there; write(data): its data, returns its deck."""
    log = options.out / f"{name}_{angle:g}.log"
    if not (log.is_file() and pattern.search(log.read_text())):
        data, deck = options.out / f"{name}.data", options.out / f"in.{name}"
        deck.write_text(write(data))
        lammps(options, options.out, deck.name, log.name, {"th": angle, **options.values})
        data.unlink()
        deck.unlink()
    found = pattern.search(log.read_text())
    if not found:
        raise SystemExit(f"{log}: no result")
    return found


def stops(options, ground, seed, angle):
    """Whether the sheet comes to rest."""
    size = "" if options.size == [24, 8] else "_{:g}x{:g}".format(*options.size)
    more = "".join(f"_{word}" for word in options.set)
    name = f"{ground.name}{size}{more}_seed{seed}"

    def write(data):
        box, soil, fixed = strip(ground, tuple(options.size), seed)
        write_data(data, box, soil, fixed)
        return DECK.format(boundary="p p f", data=data.name, number=len(soil), density=DENSITY, bins=0.6,
                           **ground._asdict())

    found = result(options, name, angle, RESULT, write)
    return found[1] == "1"


def last_stop(rests, guess):
    """The greatest whole degree at which rests(degree), 0 for none, searched from a guess outwards."""
    low, high, step = 0, STEEPEST, 1
    at = min(max(guess, 1), STEEPEST - 1)
    while high - low > 1:
        if rests(at):
            low = at
        else:
            high = at
        if low == 0 or high == STEEPEST:
            at = max(high - step, 1) if low == 0 else min(low + step, STEEPEST - 1)
            step *= 2
        else:
            at = (low + high) // 2
        if low == STEEPEST - 1:
            raise SystemExit(f"no stop angle up to {STEEPEST} degrees")
    return low


def measure(options, ground, seed, guess):
    return last_stop(lambda angle: stops(options, ground, seed, angle), guess) + 0.5


# --- the table ---

def guess_of(found, ground):
    """From the ground most like it that is measured; found: {ground: angles}."""
    def far(other):
        return sum(abs(a - b) / scale for a, b, scale in zip(ground[1:], other[1:], (0.1, 4, 0.02, 0.2, 1)))
    return int(np.mean(found[min(found, key=far)])) if found else 20


def write_table(path, found):
    lines = [["pattern", "spacing_d", "friction_deg", "rolling", "restitution", "layers", "stop_angle_deg", "least_deg",
              "greatest_deg", "seeds"]]
    for ground, angles in sorted(found.items()):
        lines.append([ground.pattern, *map("{:g}".format, (*ground[1:], np.mean(angles), min(angles), max(angles))),
                      len(angles)])
    beside = path.with_name(path.name + ".new")
    with open(beside, "w", encoding="utf-8", newline="") as out:
        csv.writer(out, lineterminator="\n").writerows(lines)
    beside.replace(path)


def make_table(options):
    found = {}
    with ThreadPoolExecutor(options.jobs) as pool:
        for seed in range(1, options.seeds + 1):
            def one(ground):
                angle = measure(options, ground, seed, guess_of(found, ground))
                found.setdefault(ground, []).append(angle)
                print(f"{ground.name} seed {seed}: {angle}", flush=True)
            list(pool.map(one, options.only or grounds_of_the_table()))
    for ground, angles in sorted(found.items()):
        print(f"{ground.name}: {np.mean(angles):.2f} ({min(angles)} to {max(angles)})")
    if options.table:
        write_table(options.table, found)


# --- a sheet that is not periodic ---

def left(options, ground, seed, angle):
    """Percent of the sheet that stay on the slope, seconds until hardly a ball moves, how many move."""
    name = f"sheet_{ground.name}{''.join(f'_{word}' for word in options.set)}_seed{seed}"

    def write(data):
        lx, ly = SHEET_SIZE
        soil = sheet_of(ground.layers, lx, ly, np.random.default_rng(seed))
        write_data(data, (-20, lx + FOOT, -30, ly + 30), soil, [])
        words = f"scattered {seed}" if ground.pattern == "scattered" else "grid"
        return SHEET.format(boundary="f f f", data=data.name, number=len(soil), density=DENSITY, words=words,
                            bins=2.4, **ground._asdict())

    found = result(options, name, angle, LEFT, write)
    return [float(word) for word in found.groups()]


def check_sheet(options):
    good = True
    for ground in options.sheet:
        for more, bound in ((-2, 90), (8, 40)):
            angle = options.angle + more
            each = [left(options, ground, seed, angle) for seed in range(1, options.seeds + 1)]
            stay = [percent for percent, _, _ in each]
            holds = min(stay) >= bound if more < 0 else max(stay) <= bound
            good &= holds
            print(f"{ground.name}: on {angle:g} degrees, {more:+d} from the stop angle, "
                  f"{', '.join(f'{percent:.1f}' for percent in stay)} % stay, bound {bound} % "
                  f"(at rest after {', '.join(f'{time:.0f}' for _, time, _ in each)} s){'' if holds else '   NOT'}",
                  flush=True)
    sys.exit(not good)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", type=ground_of, action="append", help="a ground; may be given again")
    parser.add_argument("--seeds", type=int, default=2)
    parser.add_argument("--size", type=lambda text: [float(word) for word in text.split(",")], default=[24, 8],
                        help="of the strip along and across, m (24,8)")
    parser.add_argument("--set", action="append", default=[], help="speed, kn or tend of the runs, NAME=VALUE")
    parser.add_argument("--table", type=Path, help="CSV to write")
    parser.add_argument("--sheet", type=ground_of, action="append", help="a ground; may be given again")
    parser.add_argument("--angle", type=float, help="the stop angle of --sheet, degrees")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--lmp", type=Path, default=TOP / "build" / "lmp")
    parser.add_argument("-o", dest="out", type=Path, required=True)
    options = parser.parse_args()
    options.values = dict(word.split("=", 1) for word in options.set)
    options.out = options.out.resolve()
    options.out.mkdir(parents=True, exist_ok=True)
    options.lmp = options.lmp.resolve()
    if options.sheet:
        if options.angle is None:
            parser.error("--sheet needs --angle")
        check_sheet(options)
    make_table(options)


if __name__ == "__main__":
    main()
