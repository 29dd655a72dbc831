#!/usr/bin/python3
"""What a terrain ten times larger costs under the same mass: memory of each rank, set-up and steps.

    tests/scaling/terrain_size.py [--np 4] [--steps 500] [--repeat 5] [--lmp FILE ...] [-o DIR]

A body of 20,000 balls of 1 m on a slope of 30 degrees, one ball of the ground every metre; terrains of 0.3 and 3 km2
in cells of 5 m, runs in alternation. Prints for each program: PSS per rank (MB, /proc/PID/smaps_rollup in the first
steps, mean over the ranks) on both, and its growth; CPU of the set-up and of a step on one rank, larger over smaller.
"""
import argparse
import os
import re
import resource
import subprocess
import time
from pathlib import Path
from statistics import mean, median

from slope_scene import BODY, START, write_slopes

DECK = f"""# a body on a slope, on a terrain of any width
{START}region all block 0 590 0 ${{width}} -40 400 units box
region bed terrain bed.asc depth 100 side out
region sheet terrain top.asc depth 100
region plan block 300 500 220 270 -40 400 units box
region body intersect 3 plan sheet bed
{BODY}thermo ${{steps}}
thermo_modify flush yes lost ignore
run ${{steps}}
"""


def pss(folder):
    """MB of each process of the run."""
    found = []
    for pid in filter(str.isdigit, os.listdir("/proc")):
        try:
            if os.path.realpath(f"/proc/{pid}/cwd") != str(folder.resolve()):
                continue
            if Path(f"/proc/{pid}/comm").read_text().startswith(("mpirun", "orted")):
                continue
            text = Path(f"/proc/{pid}/smaps_rollup").read_text()
        except OSError:
            continue
        if match := re.search(r"^Pss: +(\d+) kB", text, re.MULTILINE):
            found.append(int(match[1]) / 1024)
    return found


def run(lmp, folder, ranks, steps):
    """(MB per rank, CPU seconds of all ranks, seconds of the loop)"""
    command = ["mpirun", "--oversubscribe", "--bind-to", "none", "-np", str(ranks), lmp, "-in", "in.slope",
               "-screen", "none", "-var", "width", (folder / "width").read_text(), "-var", "steps", str(steps)]
    log = folder / "log.lammps"
    log.unlink(missing_ok=True)
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    with subprocess.Popen(command, cwd=folder, stdin=subprocess.DEVNULL) as process:
        megabytes = []
        while process.poll() is None:
            if not megabytes and log.exists() and re.search(r"^ +0 +\S+ +\S", log.read_text(), re.MULTILINE):
                megabytes = pss(folder)
            time.sleep(0.02)
    if process.returncode:
        raise SystemExit(f"the run in {folder} failed")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    loop = float(re.findall(r"^Loop time of (\S+)", log.read_text(), re.MULTILINE)[-1])
    return megabytes, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, loop


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--np", type=int, default=4)
    parser.add_argument("--steps", type=int, default=500)
    parser.add_argument("--repeat", type=int, default=5)
    parser.add_argument("--lmp", nargs="+", default=[str(Path(__file__).resolve().parents[2] / "build" / "lmp")])
    parser.add_argument("-o", dest="output", type=Path, default=Path("terrain_size"))
    args = parser.parse_args()
    folders = {}
    for width in 500, 5000:
        folders[width] = args.output / str(width)
        folders[width].mkdir(parents=True, exist_ok=True)
        (folders[width] / "in.slope").write_text(DECK)
        (folders[width] / "width").write_text(str(width))
        write_slopes(folders[width], width, cell=5, columns=120, top=3.5)
    for program in args.lmp:
        lmp = str(Path(program).absolute())
        memory, setup, step = ({width: [] for width in folders} for _ in range(3))
        for _ in range(args.repeat):
            for width, folder in folders.items():
                megabytes, _, _ = run(lmp, folder, args.np, args.steps // 2)
                memory[width] += megabytes
                _, short, _ = run(lmp, folder, 1, 1)
                _, full, _ = run(lmp, folder, 1, args.steps)
                setup[width].append(short)
                step[width].append((full - short) / (args.steps - 1))
        small, large = folders
        print(f"{program}\n  PSS per rank: {mean(memory[small]):.2f} and {mean(memory[large]):.2f} MB, "
              f"{mean(memory[large]) - mean(memory[small]):+.2f} MB, {args.np} ranks")
        for name, values in (("set-up", setup), ("step", step)):
            ratios = [b / a for a, b in zip(values[small], values[large])]
            print(f"  {name}: {median(values[small]):.4f} and {median(values[large]):.4f} s of CPU, one rank, "
                  f"ratio {median(ratios):.3f} ({min(ratios):.3f} to {max(ratios):.3f})", flush=True)


if __name__ == "__main__":
    main()
