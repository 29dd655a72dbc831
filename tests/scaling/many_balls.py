#!/usr/bin/python3
"""Millions of balls on one machine: memory and time per ball-step of a sheet of balls that begins to slide.

    tests/scaling/many_balls.py [--balls 1e6,1e7] [--np 2] [--steps 200] [--lmp FILE] [-o DIR]

The sheet is 250 m long and 20 m thick, on a slope of 30 degrees, balls of 1 m; its width makes their number. The
deposit is sampled and written at the last step. Prints for each number: balls, peak memory of all ranks together (GB,
ranks times that of the largest), seconds of the set-up and of the loop, ns per ball-step, that over the first one's.
"""
import argparse
import re
import resource
import subprocess
import time
from pathlib import Path

from slope_scene import BODY, START, write_slopes

DECK = f"""# a sheet of balls on a slope of 30 degrees
{START}region all block 0 400 0 ${{width}} -40 340 units box
region under terrain bed.asc depth 100
region above terrain bed.asc depth 100 side out
region sheet terrain top.asc depth 100
region plan block 100 350 10 $(v_width-10) -40 340 units box
region body intersect 3 plan sheet above
{BODY}fix spread all balance 1000 1.01 shift xy 10 1.01
fix deposit soil deposit/grid ${{half}} ${{steps}} cell 2.5 terrain ground output sheet bulk 1.9
thermo ${{steps}}
thermo_modify lost ignore
run ${{steps}}
"""


def run(lmp, folder, balls, ranks, steps):
    width = 10 * round(balls / (250 * 20) / 10) + 20
    write_slopes(folder, width, cell=10, columns=41, top=21.5)
    (folder / "in.sheet").write_text(DECK)
    command = [lmp, "-in", "in.sheet", "-screen", "none"]
    for name, value in {"width": width, "steps": steps, "half": steps // 2}.items():
        command += ["-var", name, str(value)]
    if ranks > 1:
        command = ["mpirun", "--oversubscribe", "--bind-to", "none", "-np", str(ranks)] + command
    began = time.monotonic()
    subprocess.run(command, cwd=folder, check=True, stdin=subprocess.DEVNULL)
    seconds = time.monotonic() - began
    log = (folder / "log.lammps").read_text()
    loop = re.findall(r"^Loop time of (\S+) on \d+ procs for \d+ steps with (\d+) atoms", log, re.MULTILINE)[-1]
    if not (folder / "sheet.thickness.asc").is_file():
        raise SystemExit("the deposit was not written")
    return int(loop[1]), float(loop[0]), seconds - float(loop[0])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--balls", default="1e6,1e7")
    parser.add_argument("--np", type=int, default=2)
    parser.add_argument("--steps", type=int, default=200)
    parser.add_argument("--lmp", default=str(Path(__file__).resolve().parents[2] / "build" / "lmp"))
    parser.add_argument("-o", dest="output", type=Path, default=Path("many_balls"))
    args = parser.parse_args()
    args.output.mkdir(exist_ok=True)
    lmp, first = str(Path(args.lmp).absolute()), None
    print(f"{'balls':>12} {'memory, GB':>11} {'set-up, s':>10} {'loop, s':>9} {'ns/ball/step':>13} {'over first':>11}")
    for word in args.balls.split(","):
        balls, loop, setup = run(lmp, args.output, float(word), args.np, args.steps)
        peak = args.np * resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024 / 1e9
        each = 1e9 * loop / balls / args.steps
        first = first or each
        print(f"{balls:12,} {peak:11.2f} {setup:10.1f} {loop:9.2f} {each:13.1f} {each / first:11.2f}", flush=True)


if __name__ == "__main__":
    main()
