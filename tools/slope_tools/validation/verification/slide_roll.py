"""Sliding and rolling on a sphere follow theory

inputs/03_slide_roll: a ball starts from rest on a fixed ball, contact at 30 degrees from the top.
"""
import math

import numpy as np

from .claims import AtMost, Claim, Control, Near, Run, Seen

CASE = "03_slide_roll"
START = Run("03_slide_roll/in.slide_roll")
G, D = 9.81, 0.06       # m/s2, m: of the deck, and of 04
FIGURES = "paper, Figures 7 and 8"


def on_a_sphere(time, phi=30.0, spin=False, mu=0.0, mu_r=0.0):
    """Path of a ball from rest on a fixed one, by Runge-Kutta on d psi'' = f (g sin psi - mu N/m).

    N/m = g cos psi - d psi'^2; sliding: f = 1, mu the friction; rolling: f = 5/7, mu the rolling
    resistance. Returns the path d (psi - phi), psi in degrees, and F/N at the end, all at time.
    """
    factor, brake = (5 / 7, mu_r) if spin else (1.0, mu)

    def rate(state):
        psi, w = state
        normal = G * math.cos(psi) - D * w * w
        return np.array([w, factor * (G * math.sin(psi) - brake * normal) / D])

    state = np.array([math.radians(phi), 0.0])
    steps = 2000
    h = time / steps
    for _ in range(steps):
        a = rate(state)
        b = rate(state + h / 2 * a)
        c = rate(state + h / 2 * b)
        d = rate(state + h * c)
        state = state + h / 6 * (a + 2 * b + 2 * c + d)
    psi, w = state
    force = G * math.sin(psi) - D * rate(state)[1]
    return D * (psi - math.radians(phi)), math.degrees(psi), force / (G * math.cos(psi) - D * w * w)


def path(result):
    return result.curve("slide_roll.csv")["path"][-1]


def slipping(result):
    """Share of the path that is not rolled."""
    curve = result.curve("slide_roll.csv")
    return abs(curve["sliding"][-1] / curve["path"][-1])


def measure_rolled_share(result):
    """Share of the path that is rolled."""
    curve = result.curve("slide_roll.csv")
    return abs(0.5 * D * curve["rotation"][-1] / curve["path"][-1])


def _path(name, text, source, expected, right, wrong, **values):
    return Claim(name, text, "m", source, (START(theta=right, **values),), path, Near(expected, 0.01, True),
                 Control(f"friction {wrong} degrees", (START(theta=wrong, **values),)))


SLIDE = 0.5 * G * math.sin(math.radians(30)) * 0.02 ** 2
CLAIMS = [
    _path("slide", "Without friction: path after 0.02 s, 0.5 g sin(phi) t^2", "uniform acceleration", SLIDE, 0, 10),
    _path("roll", "Friction 10 degrees: path after 0.02 s, 5/7 of that", "uniform acceleration", 5 / 7 * SLIDE, 10, 0),
    Claim("slide_only", "Without friction: share of the path that is rolled", "", FIGURES, (START(theta=0),),
          measure_rolled_share, AtMost(1e-9), Control("friction 10 degrees", (START(theta=10),))),
    Claim("roll_only", "Friction 10 degrees: share of the path that is slid", "", FIGURES, (START(theta=10),), slipping,
          AtMost(1e-3), Control("friction 9 degrees, below the threshold of 9.37", (START(theta=9),)),
          remark="3 tan(10) > tan(30), the paper's condition, is not met; 3.5 tan(10) > tan(30), a sphere's, is."),
    Claim("roll_threshold", "Friction 9.7 degrees, between the thresholds of a sphere (9.37) and a disc (10.89): share "
          "of the path that is slid", "", "rigid sphere: 3.5 tan(theta) > tan(phi)", (START(theta=9.7),), slipping,
          AtMost(1e-3), Control("friction 9.2 degrees", (START(theta=9.2),))),
    _path("slide_long", "Without friction: path after 0.08 s, sphere on sphere", "equation of motion, Runge-Kutta",
          on_a_sphere(0.08)[0], 0, 10, tend=0.08),
    _path("roll_long", "Friction 60 degrees: path after 0.08 s, sphere on sphere", "equation of motion, Runge-Kutta",
          on_a_sphere(0.08, spin=True)[0], 60, 0, tend=0.08),
]
SEEN = [Seen(f"{theta}.{name}", (START(theta=theta),), lambda result, name=name: result.number(name, "slide_roll:"))
        for theta in (0, 10) for name in ("rotation", "sliding")]
SEEN += [Seen(f"velocity.{theta}", (START(theta=theta, tend=0.005),),
              lambda result: result.number("velocity", "slide_roll:")) for theta in ("9.0", "9.2", "9.5", "9.7")]
SEEN += [Seen(f"{theta}.ratio", (START(theta=theta),),
              lambda result, law=law: result.number(f"of {law} theory", "slide_roll:"))
         for theta, law in ((0, "slide"), (10, "roll"))]
SEEN += [Seen(f"velocity_later.{theta}", (START(theta=theta),),
              lambda result: result.number("velocity", "slide_roll:")) for theta in ("9.5", "9.7")]
