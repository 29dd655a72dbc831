#!/usr/bin/python3
"""Time of 60 s of two-directional motion on inputs/20_embankment, over that of 60 s without it; the halt is off.

Pairs of runs in turn, one core, user time of the processor: at most 1.3 times. No test: a timing, to be made on a quiet
machine. Usage: LMP=build/lmp tests/time_motion.py [PAIRS [D]], by default 3 pairs with balls of 2.5 m.
"""
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

TOP = Path(__file__).resolve().parents[1]
CASES = TOP / "inputs"
LMP = os.path.abspath(os.environ.get("LMP", TOP / "build" / "lmp"))
SECONDS, RECORD = 60.0, 20.0    # s, of a run and of the record of inputs/21_earthquake


def write_motion(folder):
    """The record of inputs/21_earthquake without its vertical part, three times one after the other."""
    rows = [line.split() for line in (CASES / "21_earthquake" / "motion.txt").read_text().splitlines()[1:]]
    with open(folder / "motion.txt", "w", encoding="ascii") as out:
        for k in range(round(SECONDS / RECORD)):
            for t, ax, ay, _ in rows[k > 0:]:
                out.write(f"{float(t) + k * RECORD:.2f} {ax} {ay} 0\n")


def seconds(folder, deck, size):
    """User time of a run of a deck, s."""
    command = [LMP, "-in", deck, "-log", "none", "-screen", "none", "-var", "d", size, "-var", "quiet", "0",
               "-var", "duration", f"{SECONDS:g}"]
    process = subprocess.Popen(command, cwd=folder, env={**os.environ, "OMP_NUM_THREADS": "1"})
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = status
    if status:
        sys.exit(f"{deck} failed")
    return usage.ru_utime


def main():
    pairs, size = int(sys.argv[1]) if len(sys.argv) > 1 else 3, sys.argv[2] if len(sys.argv) > 2 else "2.5"
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        shutil.copy(CASES / "20_embankment" / "terrain.asc", folder)
        write_motion(folder)
        deck = (CASES / "20_embankment" / "in.embankment").read_text()
        deck = deck.replace("rule        index paper", "rule        index ours")
        (folder / "in.still").write_text(deck)
        place = "# --- output ---"
        assert place in deck
        (folder / "in.shaken").write_text(deck.replace(place, f"fix shake soil ground/motion motion.txt\n{place}"))
        ratios = []
        for _ in range(pairs):
            still, shaken = (seconds(folder, f"in.{what}", size) for what in ("still", "shaken"))
            ratios.append(shaken / still)
            print(f"without {still:.1f} s, with motion {shaken:.1f} s: {ratios[-1]:.3f}", flush=True)
    print(f"median of {pairs} pairs: {statistics.median(ratios):.3f}")


if __name__ == "__main__":
    main()
