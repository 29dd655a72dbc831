"""Sticking and micro-slip impacts against the law in continuous time

inputs/06_oblique_impact, in.sticking_impact: impacts at 5 to 85 degrees from the normal, 20 times within a step at
which a contact begins; friction 5 to 80 degrees, restitution 0.1 to 1, kt/kn 2/7, 0.5 and 1, on a fixed ball, between
equal balls, and on one of eight times the mass. The law is solved by an integrator of its own, which knows nothing of
time steps and of src/.
"""
import re

import numpy as np

from .claims import Run
from .continuous_law import Case, impacts

CASE = "06_oblique_impact"
STICKING = Run("06_oblique_impact/in.sticking_impact")
MATRIX = STICKING(laws=36)
PARTNERS = {"fixed": (np.inf, 1.0), "equal": (1.0, 1.0), "heavy": (8.0, 2.0)}       # mass, radius
RATIOS = {"2/7": 2 / 7, "0.5": 0.5, "1": 1.0}                                       # kt/kn
PHASES, ANGLES = 20, 7

COEFFICIENTS = re.compile(r"^pair_coeff +(\S+) +\1 +stiffness (\S+) (\S+) "
                          r"restitution (\S+) +friction (\S+) +rolling (\S+)", re.MULTILINE)
NORMAL, TANGENT, AXIS = np.array([(2, 1, 2), (1, 2, -2), (-2, 2, 1)]) / 3


def laws_of(log, kinds):
    """kt/kn, e, friction, rolling of each type, from the commands that LAMMPS has seen."""
    found = {}
    for kind, *numbers in COEFFICIENTS.findall(log):
        try:
            kn, kt, e, friction, rolling = map(float, numbers)
        except ValueError:      # before variables were put in
            continue
        found[kind] = kt / kn, e, friction, rolling
    return np.array([found.get(str(kind), found["*"]) for kind in range(1, kinds + 1)]).T


def observed(result, name="sticking_impact.dump"):
    """What the balls did: arrays of laws by angles by phases, and the Case of each."""
    balls = result.frames(name)
    half = balls["id"].shape[1] // 2
    # partner and ball of a cell stand side by side
    cell = 6 * 2 * balls["radius"][0, -1]
    order = np.lexsort((balls["id"][0], *(np.floor(balls[axis][0] / cell + 0.5) for axis in "xyz")))
    balls = {name: values[:, order].reshape(2, half // ANGLES // PHASES, ANGLES, PHASES, 2)
             for name, values in balls.items()}

    def along(direction, *names):
        return sum(share * balls[name] for share, name in zip(direction, names))

    velocities, spins = ("vx", "vy", "vz"), ("omegax", "omegay", "omegaz")
    relative = [np.diff(along(direction, *velocities), axis=-1)[..., 0] for direction in (NORMAL, TANGENT)]
    surface = balls["radius"] * along(AXIS, *spins)
    contact = relative[1] - surface.sum(axis=-1)
    energy = (balls["mass"] * (sum(balls[name] ** 2 for name in velocities)
                               + 0.4 * balls["radius"] ** 2 * sum(balls[name] ** 2 for name in spins)))
    fixed = (balls["vx"][1, ..., 0] == 0) & (balls["omegax"][1, ..., 0] == 0)
    reach = balls["radius"][1].sum(axis=-1)
    distance = np.sqrt(sum(np.diff(balls[axis][1], axis=-1)[..., 0] ** 2 for axis in "xyz"))
    size = np.abs(contact[0])
    speed = np.hypot(relative[0][0], relative[1][0])
    ratio, e, friction, rolling = (x[:, None] for x in laws_of(result.log, half // ANGLES // PHASES))
    first = (0, slice(None), slice(None), 0)
    case = Case(balls["v_theta"][first][..., 1], friction, e, ratio,
                np.where(fixed[..., 0], np.inf, balls["mass"][first][..., 0] / balls["mass"][first][..., 1]),
                balls["radius"][first][..., 0] / balls["radius"][first][..., 1],
                (surface[0, ..., 1] / speed)[..., 0], rolling)
    return case, {"beta": contact[1] / contact[0], "spin": surface[1, ..., 1] / size,
                  "partner_spin": surface[1, ..., 0] / size, "restitution": -relative[0][1] / relative[0][0],
                  "energy": energy[1].sum(axis=-1) / energy[0].sum(axis=-1), "apart": distance > reach}


class Errors:
    """Of one run, against the law in continuous time; each an array of laws by angles."""

    def __init__(self, result):
        self.case, self.got = observed(result)
        self.wanted = impacts(self.case)
        self.together = int((~self.got["apart"]).sum())         # impacts that have not ended
        self.mean, self.largest = {}, {}
        for name in ("beta", "spin", "partner_spin", "restitution"):
            off = self.got[name] - np.asarray(getattr(self.wanted, name))[..., None]
            self.mean[name] = np.abs(off.mean(axis=-1))
            self.largest[name] = np.abs(off).max(axis=-1)
        self.gain = self.got["energy"].max(axis=-1) - 1
