"""A column of balls collapses: run-out against the published laws

inputs/11_column_collapse: a column of length l0 and height a l0 between a wall and a gate, planar (periodic across).
The run-out is (l - l0)/l0; l ends where a slice of one diameter first holds less than half a layer of balls, so that
single balls that roll ahead do not count. Published: sand, rice, sugar, glass beads on rough floors.
"""
import numpy as np

from .claims import Between, Claim, Control, Near, Run

CASE = "11_column_collapse"
DECK = Run("11_column_collapse/in.column_collapse")
D = 0.01                # m
LENGTHS = {0.5: 40, 1: 30, 2: 22, 4: 16, 8: 11}     # l0 in diameters, for about 5,000 balls each
COLUMNS = {a: DECK(a=a, length=length) for a, length in LENGTHS.items()}
# one filling scatters by a diameter or two, which moves the exponent by 0.1
FILLINGS = {a: (COLUMNS[a], *(COLUMNS[a](seed=seed) for seed in (2, 3, 4))) for a in (4, 8)}
SMALL = DECK(a=1, length=16, width=4)
STEEP = 3.0             # a from which run-outs grow with a^(2/3)
LUBE, LAJEUNESSE = (1.2, 1.9), (1.8, 2.3)           # factors of a, and of a^(2/3)
SOURCE = "Lube et al. (2005), Lajeunesse et al. (2005)"
MARGIN = 0.1            # the front is known to a diameter, l0/11 for the highest column
MARGIN_SMALL = 0.25     # and a column of few balls runs less far


def law(a, factors):
    """Published run-out over length."""
    return factors[0] * a if a < STEEP else factors[1] * a ** (2 / 3)


def size(start):
    """Length and height of a column before it collapses, in diameters; centres are half of one inside."""
    return np.ceil(start["x"].max() / D), np.floor(start["z"].max() / D)


def runout_of(start, end):
    """(l - l0)/l0, from the balls before and after."""
    layers = np.histogram(end["x"] / D, np.arange(0, end["x"].max() / D + 2))[0] / np.ceil(start["y"].max() / D)
    length, _ = size(start)
    return (np.argmax(layers < 0.5) - length) / length


def measure_column_runout(result):
    """The same, of a run."""
    return runout_of(*(result.frames(f"column.{when}.dump") for when in ("start", "end")))


def exponent(*results):
    """Of run-out against a, from a first half of runs to a second one of columns twice as slender."""
    first, second = np.reshape([measure_column_runout(result) for result in results], (2, -1)).mean(axis=1)
    return np.log2(second / first)


def _claim(a, run, control, quick=False):
    which = f"a = {a:g}" + (", small" if quick else "")
    return Claim(f"runout_{a:g}" + "_small" * quick, f"Height over length {which}: run-out over length", "", SOURCE,
                 (run,), measure_column_runout, Between(law(a, LUBE), law(a, LAJEUNESSE), MARGIN_SMALL if quick
                                                        else MARGIN), control,
                 quick)


CLAIMS = [
    _claim(1, SMALL, Control("friction 60 degrees, mu_r 1", (SMALL(friction=60, rolling=1),)), quick=True),
    *(_claim(a, COLUMNS[a], Control(f"the column of a = {other:g}", (COLUMNS[other],)))
      for a, other in ((0.5, 1), (1, 2), (2, 1), (4, 2), (8, 4))),
    Claim("runout_exponent", "Exponent of the run-out between a = 4 and a = 8, means of four fillings", "", SOURCE,
          FILLINGS[4] + FILLINGS[8],
          exponent, Near(2 / 3, 0.15), Control("between a = 0.5 and a = 1", (COLUMNS[0.5], COLUMNS[1])), quick=False),
]
