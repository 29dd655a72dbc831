#!/usr/bin/python3
"""What balls of several sizes cost: a dense layer of 20,480 balls that begins to flow, in.mixed beside this script.

    tests/scaling/mixed_radii.py [--repeat 3] [--lmp FILE ...] [-o DIR]

Sizes: equal, uniform to 1:2, lognormal to 1:4. Prints for each program ns per ball and step of pair gran/restitution,
and with --granular how many times as long LAMMPS' pair granular takes; medians of runs in alternation.
"""
import argparse
import os
import re
import subprocess
from pathlib import Path
from statistics import median

DECK = Path(__file__).resolve().parent / "in.mixed"
SIZES = "equal", "uniform", "lognormal"


def run(lmp, folder, sizes, law):
    """ns per ball and step of the deck's second run"""
    folder.mkdir(parents=True, exist_ok=True)
    subprocess.run([lmp, "-in", DECK, "-screen", "none", "-var", "sizes", sizes, "-var", "law", law], cwd=folder,
                   check=True, stdin=subprocess.DEVNULL)
    loops = re.findall(r"^Loop time of (\S+) on \d+ procs for (\d+) steps", (folder / "log.lammps").read_text(),
                       re.MULTILINE)
    seconds, steps = loops[-1]
    return 1e9 * float(seconds) / int(steps) / 20480


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--lmp", type=Path, nargs="+", default=[Path(os.environ.get("LMP", "build/lmp"))])
    parser.add_argument("--granular", action="store_true", help="pair granular, too")
    parser.add_argument("-o", dest="output", type=Path, default=Path("mixed_radii"))
    args = parser.parse_args()
    laws = ["slope", "granular"] if args.granular else ["slope"]
    programs = [lmp.resolve() for lmp in args.lmp]
    for sizes in SIZES:
        times = {(lmp, law): [] for lmp in programs for law in laws}
        for _ in range(args.repeat):
            for (lmp, law), seen in times.items():
                seen.append(run(lmp, args.output / f"{sizes}_{law}", sizes, law))
        for lmp in programs:
            ours = times[lmp, "slope"]
            line = f"{sizes:10} {lmp}: {median(ours):6.1f} ns ({min(ours):.1f} to {max(ours):.1f})"
            if args.granular:
                ratios = sorted(theirs / own for theirs, own in zip(times[lmp, "granular"], ours))
                line += f"; granular {median(ratios):.2f} times ({ratios[0]:.2f} to {ratios[-1]:.2f})"
            print(line, flush=True)


if __name__ == "__main__":
    main()
