"""Beds of sand and of glass beads behind a gate: where the deposit ends, and how high it is

inputs/16_flume: dam-breaks of sand, 0.2 and 0.4 m deep, and a column of glass beads. Thickness: balls within 0.02 m of
a place, over those per length of the bed before, times its height. Front: the first slice of a diameter with less than
half a layer, so that single balls that roll ahead do not count. The beads' numbers are means of three fillings.
"""
import numpy as np

from .claims import Between, Claim, Control, Near, Run, Seen

CASE = "16_flume"
SAND = Run("16_flume/in.flume")
BEADS = SAND(length=0.2, height=0.14, gate=0, friction=21.8, rolling=0.05, density=2500, d=0.01)
DEEP = SAND(height=0.4)
SLOW, SLIDING = {"friction": 60, "rolling": 1}, {"friction": 5, "rolling": 0}
NEAR = 0.02             # m
EVANGELISTA, MANGENEY = "Evangelista et al. (2014)", "Mangeney et al. (2010), experiment 1"


def states(result):
    """The balls before and after, and length, height, diameter and width of the bed, m."""
    *size, _ = (result.number(name, "flume: length") for name in ("length", "height", "d", "w", "balls"))
    return (*(result.frames(f"flume.{when}.dump") for when in ("start", "end")), *size)


def thickness_of(start, end, length, height, x):
    """Of the deposit, m."""
    before, after = (np.count_nonzero(np.abs(balls["x"] - x) < NEAR) for balls in (start, end))
    if x + NEAR > length:
        before = start["x"].size / length * 2 * NEAR
    return height * after / before


def thickness(x):
    """Of the deposit at x, of a run."""
    def got(result):
        start, end, length, height, *_ = states(result)
        return thickness_of(start, end, length, height, x)
    return got


def front(result):
    """Of the deposit, m from the back wall."""
    _, end, length, _, d, w = states(result)
    layers = np.histogram(end["x"] / d, np.arange(0, end["x"].max() / d + 2))[0] / (w / d)
    return d * np.argmax(layers < 0.5)


def measure_flume_runout(result):
    """The same from the gate."""
    return front(result) - states(result)[2]


def mean(of):
    """Of several runs."""
    return lambda *results: float(np.mean([of(result) for result in results]))


def fillings(run, number=3):
    """The same with other places of the balls."""
    return tuple(run(seed=seed) for seed in range(1, number + 1))


SLIPPERY, STIFF = "friction 5 degrees, mu_r 0", "friction 60 degrees, mu_r 1"
CLAIMS = [
    Claim("dam_break_04", "Sand 0.2 m deep, balls of 20 mm: thickness 0.4 m from the back", "m", EVANGELISTA, (SAND,),
          thickness(0.4), Near(0.2, 0.02), Control(SLIPPERY, (SAND(**SLIDING),))),
    Claim("dam_break_08", "The same: thickness 0.8 m from the back, 0.2 m beyond the gate", "m", EVANGELISTA,
          fillings(SAND, 6), mean(thickness(0.8)), Near(0.025, 0.02), Control(STIFF, (SAND(**SLOW),)),
          remark="Mean of six fillings, of which one ball more or less is 0.002 m."),
    Claim("dam_break_toe", "Sand 0.4 m deep, balls of 20 mm: front, from the back", "m", EVANGELISTA, (DEEP,), front,
          Near(1.1, 0.1), Control(STIFF, (DEEP(**SLOW),)), quick=False),
    Claim("glass_front", "Column of glass beads 0.2 m long, 0.14 m high, balls of 10 mm: front beyond the gate", "m",
          "Lube et al. (2005), Lajeunesse et al. (2005)", fillings(BEADS), mean(measure_flume_runout),
          Between(1.2 * 0.14, 1.8 * 0.14, 0.25), Control(STIFF, (BEADS(**SLOW),)),
          remark="Mangeney et al. (2010) measured 0.275 m: not met, 0.160 to 0.190 m in the three fillings, 0.215 m "
                 "with balls of 5 mm. Margin of small columns, as in inputs/11."),
    Claim("glass_height", "The same: thickness at the back", "m", MANGENEY, fillings(BEADS), mean(thickness(NEAR)),
          Near(0.14, 0.01), Control(SLIPPERY, (BEADS(**SLIDING),))),
]
SEEN = [Seen(f"glass.{name}.{what}", fillings(BEADS), lambda *results, of=of, end=end: end(map(of, results)))
        for name, of in (("front", measure_flume_runout), ("height", thickness(NEAR))) for what, end
        in (("low", min), ("high", max))]
SEEN.append(Seen("sand.sliding_08", (SAND(**SLIDING),), thickness(0.8)))
