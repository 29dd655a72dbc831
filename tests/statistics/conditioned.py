"""The bounds of conditioned ensembles, on stand-ins that cost nothing: not a part of the test suite.

    /usr/bin/python3 tests/statistics/conditioned.py [repetitions]

Each of so many (40) ensembles of 100 runs has the share of known events whose volume on the road is above four
levels, with bounds of 90 %. Printed: how many of them hold that of 4000 runs of a Sobol design (that of as many
independent runs scatters itself, by up to 0.014, where a band is 0.06 wide); their mean width over the 90 % range of
the estimates of 400 ensembles, of each level and of all. Some minutes on one core. What came out is in
doc/src/ensembles.rst.
"""
import sys
from pathlib import Path

import numpy as np

TOP = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(TOP / "tests" / "tools"), str(TOP / "tools")]

import known_twins as twins  # noqa: E402  (after the path is set)
from slope_tools.ensembles import conditioned  # noqa: E402
from slope_tools.statistics import designs  # noqa: E402

RUNS, REFERENCE, MANY = 100, 4000, 400
LEVELS = np.array([5e3, 2e4, 4e4, 7e4])     # m3


def mass_of(lengths):
    return conditioned.masses(conditioned.compute_weights(lengths, twins.exceedance(lengths)))


def shares(lengths, volumes):
    mass = mass_of(lengths)
    return mass.share @ conditioned.are_above_levels(volumes, LEVELS) + mass.far


def ensemble(kind, seed, jump, chance, number=RUNS):
    """Points, lengths and volumes; kind: of designs, or independent points."""
    rng = np.random.default_rng(seed)
    noise = rng if chance else None
    if kind == "independent":
        u = rng.random((number, 3))
        return (u, *twins.response(u, jump, noise))
    return twins.runs(kind, number, seed, jump, noise)


def bands(kind, jump, chance, repetitions, first=1000):
    """Of each level: its reference, how many repetitions hold it, its mean width, and that of repeated ensembles."""
    reference = shares(*ensemble(designs.SOBOL, 10, jump, chance, REFERENCE)[1:])
    low, high = np.empty((2, repetitions, len(LEVELS)))
    for k in range(repetitions):
        u, lengths, volumes = ensemble(kind, first + k, jump, chance)
        effect = None
        if kind != "independent":
            effect = conditioned.Design(kind, u, lengths, twins.exceedance).effect(volumes)
        curve = conditioned.compute_known_curve(volumes, mass_of(lengths), effect)
        _, low[k], high[k] = np.transpose([curve.at(level) for level in LEVELS])
    many = np.array([shares(*ensemble(kind, 10_000 + k, jump, chance)[1:]) for k in range(MANY)])
    width = np.diff(np.quantile(many, [0.05, 0.95], axis=0), axis=0)[0]
    held = ((low <= reference) & (reference <= high)).sum(axis=0)
    return reference, held, (high - low).mean(axis=0), width


def main(repetitions=40):
    for chance in (False, True):
        for jump in (False, True):
            for kind in ("independent", *designs.KINDS):
                reference, held, mine, width = bands(kind, jump, chance, repetitions)
                print(f"{'jump' if jump else 'smooth'}, {'with' if chance else 'without'} chance, {kind}: shares "
                      f"{reference.round(3)}; {held} of {repetitions} hold it, {held.mean():.1f} on average; "
                      f"width {(mine / width).round(2)}, {mine.sum() / width.sum():.2f} of all", flush=True)


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
