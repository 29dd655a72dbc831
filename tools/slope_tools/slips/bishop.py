"""Bishop's factor of safety and yield coefficient in three dimensions, of many strengths at once.

The equations are those of doc/src/slip_analysis.rst. With t = tan phi / F, the resisting moment over F is

    c / F a(t) + (1 - kv) b(t) + q w(t)

less the driving moment of the normal forces, where a, b and w are sums over the columns that depend on t alone; q is
the ratio of pore pressure, or 1 with a water table. Strengths: cohesion (Pa), tangent of the friction angle, ratio of
pore pressure; each a number or an array.
"""
from typing import NamedTuple, Tuple, Union

import numpy as np

from .columns import Columns

Values = Union[float, np.ndarray]
LEAST_M = 0.2           # of m_alpha (Whitman and Bailey 1967)
TOLERANCE = 1e-10
MOST_STEPS = 200
MOST = 1e9              # F, beyond which nothing drives a body
CHUNK = 4_000_000       # columns times strengths that are held in memory


class Strengths(NamedTuple):
    cohesion: Values        # Pa
    tangent: Values         # of the friction angle
    water: Values = 0.0     # pore pressure over the weight per area; without effect where the columns have a table

    def arrays(self) -> Tuple[np.ndarray, ...]:
        """All of the same shape, one-dimensional."""
        return tuple(np.broadcast_arrays(*(np.atleast_1d(np.asarray(one, float)) for one in self)))


def sums(body: Columns, t: np.ndarray) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The sums a, b and w at each t: of cohesion, weight and water."""
    force = body.weight * (body.base / body.area) if body.pressure is None else body.pressure * body.base
    levers = [body.lever] if body.normal is None else [body.lever, body.normal]
    right = np.concatenate([np.stack([lever * body.base * body.sine, lever * body.weight, lever * force * body.sine])
                            for lever in levers]).T
    shear = float(body.lever @ body.base), float(body.lever @ force)
    found = np.zeros((len(t), 6))
    step = max(1, CHUNK // len(body.area))
    for start in range(0, len(t), step):
        part = t[start:start + step, None]
        found[start:start + step, :right.shape[1]] = (1 / np.maximum(body.cosine + body.sine * part, LEAST_M)) @ right
    cohesion, weight, water, *of_normal = found.T
    return (shear[0] - t * cohesion + of_normal[0], t * weight - of_normal[1],
            t * (t * water - of_normal[2] - shear[1]))


def driving(body: Columns, horizontal: Values = 0.0, vertical: float = 0.0) -> Values:
    """Moment of the weight and of the inertia, N m; horizontal and vertical (upwards) in parts of the weight."""
    return (1 - vertical) * float(body.weight @ body.u) + np.asarray(horizontal) * float(body.weight @ body.depth)


def resistance(body: Columns, strengths: Strengths, factor: np.ndarray, vertical: float = 0.0) -> np.ndarray:
    """Resisting moment over F, less that of the normal forces, N m, at these F."""
    cohesion, tangent, water = strengths.arrays()
    a, b, w = sums(body, tangent / factor)
    return cohesion / factor * a + (1 - vertical) * b + (1.0 if body.pressure is not None else water) * w


def yield_coefficient(body: Columns, strengths: Strengths, vertical: float = 0.0) -> np.ndarray:
    """The horizontal k at which F is 1; negative for a body that slides without an earthquake."""
    cohesion = strengths.arrays()[0]
    left = resistance(body, strengths, np.ones(len(cohesion)), vertical) - driving(body, 0.0, vertical)
    return left / float(body.weight @ body.depth)


def factor_of_safety(body: Columns, strengths: Strengths, horizontal: float = 0.0, vertical: float = 0.0) -> np.ndarray:
    """F of each strength; infinite where nothing drives the body, NaN where the steps found none."""
    load, along = float(driving(body, horizontal, vertical)), body._replace(normal=None)

    def find_next(factor: np.ndarray) -> np.ndarray:
        shear = resistance(along, strengths, factor, vertical)
        drives = load + (0.0 if body.normal is None else shear - resistance(body, strengths, factor, vertical))
        # normal forces that outweigh the load at one F may not do so at a larger one
        return np.minimum(np.where(drives > 0, np.maximum(factor * shear / drives, 1 / MOST), 10 * factor), MOST)
    factor = np.ones(len(strengths.arrays()[0]))
    with np.errstate(divide="ignore", invalid="ignore"):
        for _ in range(MOST_STEPS):
            first = find_next(factor)
            second = find_next(first)
            done = np.abs(second - first) <= TOLERANCE * second
            guess = factor - (first - factor) ** 2 / (second - 2 * first + factor)      # by Aitken's rule
            factor = np.where(~done & (guess > 0.5 * second) & (guess < 2 * second), guess, second)
            if done.all():
                break
    return np.where(done, np.where(factor < MOST, factor, np.inf), np.nan)
