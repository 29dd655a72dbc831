"""What ensembles gain by the runs that they add, on the stand-in of tests/tools/test_farther.py: not in the suite.

    /usr/bin/python3 tests/statistics/farther.py [repetitions]

Of so many (40) ensembles of 64 runs, without and with the added ones: how many bounds of 90 % hold the reference of
40,000 runs at four volumes, the mean width of the bounds, and means of the share beyond the longest run, of the
effective number, and of the errors of the weighted mean of log10 L and of the shares above the volumes. Less than a
minute on one core. What came out is in doc/src/ensembles.rst, "Runs towards longer ones".
"""
import sys
from pathlib import Path

import numpy as np

TOP = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(TOP / "tests" / "tools"), str(TOP / "tools")]

import known_twins as twins  # noqa: E402  (after the path is set)
import test_farther as stand_in  # noqa: E402
from slope_tools.ensembles import conditioned  # noqa: E402
from slope_tools.statistics import designs  # noqa: E402


def error(one, found):
    """Of the weighted mean of log10 L, against the known events between the shortest and the longest run."""
    lengths = one.lengths[:len(found.weights)]
    at = np.linspace(lengths.min(), lengths.max(), 4000)
    share = -np.diff(twins.exceedance(at))
    wanted = share @ np.log10((at[1:] + at[:-1]) / 2) / share.sum()
    return found.weights @ np.log10(lengths) / found.reached - wanted


def main(repetitions=40):
    lengths, volumes = stand_in.response(designs.points(designs.SOBOL, 3, 40000, 10), np.random.default_rng(1))
    mass = conditioned.masses(conditioned.compute_weights(lengths, twins.exceedance(lengths)))
    truth = mass.share @ conditioned.are_above_levels(volumes, stand_in.LEVELS) + mass.far
    held = {True: [], False: []}
    for seed in range(repetitions):
        one = stand_in.Ensemble(seed)
        for first in held:
            found = one.weights(not first, first)
            curve = conditioned.compute_known_curve(one.volumes[:len(found.weights)], conditioned.masses(found))
            share, low, high = np.transpose([curve.at(level) for level in stand_in.LEVELS])
            held[first].append([*((low <= truth) & (truth <= high)), *(high - low), found.far, found.effective,
                                error(one, found), *(share - truth)])
    for first, several in held.items():
        found = np.array(several)
        print(f"{'design alone' if first else 'with added points'}: {found[:, :4].sum(axis=0).astype(int)} of "
              f"{repetitions} hold {truth.round(3)}, width {found[:, 4:8].mean(axis=0).round(3)}; beyond "
              f"{found[:, 8].mean():.3f}, effective {found[:, 9].mean():.1f}, mean of log10 L "
              f"{found[:, 10].mean():+.4f}, shares above too large by {found[:, 11:].mean(axis=0).round(3)}")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
