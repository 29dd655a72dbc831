"""Energy of the balls of a dump: of motion, of spin, and in the normal springs of what touches."""
import re

import numpy as np


def of_motion(balls):
    """J, of each ball in each frame: motion and spin."""
    linear = sum(balls[name] ** 2 for name in ("vx", "vy", "vz") if name in balls)
    spin = sum(balls[name] ** 2 for name in ("omegax", "omegay", "omegaz") if name in balls)
    return 0.5 * balls["mass"] * (linear + 0.4 * balls["radius"] ** 2 * spin)


def of_springs(places, radii, kn, edge):
    """J, in the normal springs of all pairs of balls of one frame, in a periodic cube."""
    from scipy.spatial import cKDTree
    tree = cKDTree(places % edge, boxsize=edge)
    i, j = tree.query_pairs(2 * radii.max(), output_type="ndarray").T
    delta = places[i] - places[j]
    distance = np.linalg.norm(delta - edge * np.round(delta / edge), axis=1)
    return 0.5 * kn * (np.maximum(radii[i] + radii[j] - distance, 0) ** 2).sum()


def gas(result):
    """Of a run of in.rough_gas, frame by frame: motion and springs together, over that at the start."""
    balls = result.frames("rough_gas.dump")
    line, = result.printed("rough gas:")
    edge, kn = (float(re.findall(rf"{name} (\S+)", line)[0]) for name in ("edge", "kn"))
    places = np.stack([balls[name] for name in ("xu", "yu", "zu")], axis=2)
    total = of_motion(balls).sum(axis=1) + [of_springs(x, r, kn, edge) for x, r in zip(places, balls["radius"])]
    return total / total[0]


def measure_gap_ratio(result):
    """Of the balls of a run of in.slot, over the overlap at which an impact of their speed ends."""
    balls = result.frames("slot.dump")
    line, = result.printed("slot:")
    kn = float(re.findall(r"kn (\S+)", line)[0])
    return 2 * balls["v_half"][0] / (balls["vx"][0] * np.sqrt(balls["mass"][0] / kn))


def slot(result):
    """Of a run of in.slot: frames by balls, motion and springs together, over that at the start."""
    balls = result.frames("slot.dump")
    line, = result.printed("slot:")
    kn = float(re.findall(r"kn (\S+)", line)[0])
    total = of_motion(balls) + sum(0.5 * kn * np.maximum(side * balls["x"] - balls["v_half"], 0) ** 2
                                   for side in (1, -1))
    return total / total[0]
