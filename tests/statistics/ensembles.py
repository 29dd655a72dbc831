"""The long statistics of ensembles and calibrations, on stand-ins that cost nothing: not a part of the test suite.

    /usr/bin/python3 tests/statistics/ensembles.py [indices] [bands] [intervals] [ideal] [twins]

Some minutes on one core. What came out is in doc/src/ensembles.rst and doc/src/tool_calibrate.rst.
"""
import sys
from pathlib import Path

import numpy as np

TOP = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(TOP / "tests" / "tools"), str(TOP / "tools")]

import twins  # noqa: E402  (after the path is set)
from test_ensemble import ishigami, ishigami_indices, noisy  # noqa: E402
from slope_tools.statistics import backanalysis, designs, emulator, hazard  # noqa: E402


def indices(seeds=5):
    """Largest error of the Sobol indices of Ishigami's function by 256 points."""
    exact = np.concatenate(ishigami_indices())
    for seed in range(seeds):
        points = designs.points(designs.SOBOL, 3, 256, seed)
        found = emulator.analyse("abc", points, ishigami(points), range(256))
        each = found.variables.values()
        mine = np.array([one.first for one in each] + [one.total for one in each])
        print(f"indices, seed {seed}: largest error {np.abs(mine - exact).max():.4f}; {found.text}", flush=True)


def bands(repetitions=40, rounds=10):
    """How many of 40 ensembles cover a reference of 400 runs at its 50, 75 and 90 %, in 10 rounds."""
    for points, several in ((32, 1), (64, 1), (128, 1), (32, 3)):
        covered = np.zeros((rounds, 3), int)
        for turn in range(rounds):
            rng = np.random.default_rng(1000 + turn)
            reference = noisy(rng.random((400, 3)), rng)
            levels = np.quantile(reference, [0.5, 0.75, 0.9], method="inverted_cdf")
            for k in range(repetitions):
                place = np.repeat(designs.points(designs.SOBOL, 3, points, 100 * turn + k), several, axis=0)
                curve = hazard.compute_hazard_curve(noisy(place, rng), np.repeat(range(points), several))
                for i, level in enumerate(levels):
                    band = curve.at(level)
                    covered[turn, i] += band.low <= (reference > level).mean() <= band.high
        print(f"bands, {points} points of {several} runs: {covered.min()} to {covered.max()} of {repetitions} cover, "
              f"mean {covered.mean():.1f}; {np.mean((covered >= 32)) * 100:.0f} % of the rounds have 32 or more",
              flush=True)


def intervals(seeds=20, chance=0.1):
    """How many 90 % intervals of calibrations hold the hidden values, by the first points alone and by a few more."""
    for d, number in ((2, 20), (3, 14), (3, 24)):
        held, pairs = [], 0
        for seed in range(seeds):
            rng = np.random.default_rng(seed)
            noise = chance * smooth(rng.random((2000, d))).std(axis=0)
            points = designs.points(designs.SOBOL, d, number, seed)
            outputs = smooth(points)
            outputs = outputs + noise * rng.normal(size=outputs.shape)
            hidden = 0.1 + 0.8 * rng.random(d)
            observed = smooth(hidden[None])[0] + noise * rng.normal(size=len(noise))
            found = backanalysis.posterior(points, outputs, [backanalysis.Target("", "", float(value), 0.0)
                                                             for value in observed])
            held += [low <= x <= high for (low, high), x in zip(map(found.interval, range(d)), hidden)]
            pairs += found.pair(0, 1).holds(hidden)
        print(f"intervals, {number} runs of {d} variables: {np.mean(held):.2f} hold the hidden values, of the regions "
              f"over a pair {pairs / seeds:.2f}", flush=True)


def smooth(u):
    """As many numbers as there are variables, two or three."""
    found = [100 * (1 - 0.6 * u[:, 0]) * (1 - 0.3 * u[:, 1]), 20 + 15 * u[:, 1] - 5 * u[:, 0] ** 2]
    if u.shape[1] > 2:
        found.append(10 * u[:, 2] + 4 * u[:, 0] * u[:, 1])
    return np.column_stack(found)


def ideal(seeds=10, draws=3_000_000):
    """What the observed numbers allow at most: the posterior if the stand-in and its chance are known exactly."""
    place = twins.LOW + twins.WIDTH * np.random.default_rng(1).random((draws, 3))
    outputs = twins.expected(place)
    good = 0
    for seed in range(seeds):
        hidden, observed, _ = twins.observation(seed)
        weight = np.exp(-0.5 * (((outputs - observed) / twins.CHANCE) ** 2).sum(axis=1))
        weight /= weight.sum()
        error = weight @ place - hidden
        half = []
        for column in place.T:
            order = np.argsort(column)
            low, high = np.interp([0.05, 0.95], np.cumsum(weight[order]), column[order])
            half.append((high - low) / 2)
        hit = bool((np.abs(error) <= twins.CLOSE).all())
        good += hit
        print(f"ideal, seed {seed}: error {error.round(3)}, 90 % intervals +- {np.round(half, 3)}, "
              f"{'recovered' if hit else 'not recovered'}"
              f"{', identifiable' * bool((half <= twins.CLOSE).all())}", flush=True)
    print(f"ideal: {good} of {seeds} recovered to 2 degrees, 0.02 and 0.1 d", flush=True)


def twin_experiments(seeds=10, runs=60):
    """Hidden values that can be told apart, and those that cannot."""
    good = 0
    for seed in range(seeds):
        one = twins.Twin(seed, runs)
        widths = [one.found.interval(i)[1] - one.found.interval(i)[0] for i in range(3)] * twins.WIDTH
        hit = bool((np.abs(one.error) <= twins.CLOSE).all())
        good += hit
        print(f"twin, seed {seed}: error {one.error.round(3)}, 90 % intervals {np.round(widths, 3)} wide, pairs hold "
              f"{one.holds}, {'recovered' if hit else 'not recovered'}", flush=True)
    print(f"twins: {good} of {seeds} recovered to 2 degrees, 0.02 and 0.1 d by {runs} runs", flush=True)
    held = 0
    for seed in range(seeds):
        one = twins.Twin(seed, 40, outputs=(0,))
        held += sum(one.holds)
        said = any("not identifiable" in text for text in one.words)
        print(f"run-out alone, seed {seed}: pairs hold {one.holds}, {'said' if said else 'not said'}", flush=True)
    print(f"run-out alone: {held} of {3 * seeds} regions hold the hidden values", flush=True)


if __name__ == "__main__":
    wanted = sys.argv[1:] or ["indices", "bands", "intervals", "ideal", "twins"]
    for name, what in (("indices", indices), ("bands", bands), ("intervals", intervals),
                       ("ideal", ideal), ("twins", twin_experiments)):
        if name in wanted:
            what()
