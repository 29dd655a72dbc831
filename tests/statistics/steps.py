"""Calibrations whose response jumps, on a stand-in that costs nothing: not a part of the test suite.

    /usr/bin/python3 tests/statistics/steps.py [SEEDS]

A mass that gets over a step of the valley goes on to its foot: between the two no run stops. Says how many regions of
90 % hold the hidden values, and in how many calibrations the gap is named, with a step and without. Some minutes on one
core; what came out is in doc/src/tool_calibrate.rst.
"""
import sys
from pathlib import Path

TOP = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(TOP / "tests" / "tools"), str(TOP / "tools")]

import twins  # noqa: E402  (after the path is set)


def count(seeds, fall):
    held, named, edge = 0, 0, 0
    for seed in range(seeds):
        one = twins.Steep(seed, fall)
        held += one.holds
        edge += one.near
        named += bool(one.gaps)
        print(f"fall {fall:g} m, seed {seed}: {'holds' if one.holds else 'misses'}{', near the step' * one.near}; "
              f"gaps {[tuple(round(x) for x in gap) for gap in one.gaps]}", flush=True)
    print(f"fall {fall:g} m: {held} of {seeds} regions hold the hidden values; a gap is named in {named}; "
          f"{edge} lie near the step")


if __name__ == "__main__":
    for height in (550.0, 0.0):
        count(int(sys.argv[1]) if len(sys.argv) > 1 else 40, height)
