"""A ball rolls, slides and spins down on a plane

inputs/07_rolling: a ball on a level or inclined plane. Closed forms of a rigid sphere; the rolling torque is at most
mu_r R N.
"""
import math

import numpy as np

from .claims import AtMost, Claim, Control, Near, Run

CASE = "07_rolling"
BALL = Run("07_rolling/in.rolling")
G, R, T = 9.81, 0.03, 0.5       # m/s2, m, s
SPHERE = "rigid sphere"


def final(result):
    return result.curve("rolling.csv")[-1]


def acceleration(result):
    """Mean, m/s2."""
    curve = result.curve("rolling.csv")
    return (curve["speed"][-1] - curve["speed"][0]) / curve["time"][-1]


def spin_rate(result):
    """Mean, rad/s2."""
    curve = result.curve("rolling.csv")
    return (curve["spin"][-1] - curve["spin"][0]) / curve["time"][-1]


def rolled(result):
    """Speed of the contact point over that of the centre."""
    end = final(result)
    return abs(end["speed"] - R * end["spin"]) / abs(end["speed"])


def stopped(result):
    """Way from the start to where the ball stands still, m."""
    curve = result.curve("rolling.csv")
    return curve["path"][-1] if np.abs(curve["speed"][-10:]).max() < 1e-3 else math.inf


def _incline(angle):
    return math.sin(math.radians(angle)), math.cos(math.radians(angle))


def _accelerates(name, text, expected, run, broken, wrong):
    return Claim(name, text, "m/s2", SPHERE, (run,), acceleration, Near(expected, 0.005, True),
                 Control(broken, (wrong,)))


SIN, COS = _incline(20)
DOWN = BALL(slope=20, v0=0)
SIN_40, COS_40 = _incline(40)
SLIDE = BALL(slope=40, v0=0, friction=10)
MU_10 = math.tan(math.radians(10))
PRESSED = BALL(friction=0, v0=0, slip=1.5)
LIMIT = math.degrees(math.atan(3.5 * MU_10 - 2.5 * 0.05))       # of rolling, friction 10, mu_r 0.05: 26.2 degrees

CLAIMS = [
    _accelerates("roll_level", "Level plane, mu_r 0.05: a rolling ball loses (5/7) mu_r g", -5 / 7 * 0.05 * G, BALL,
                 "rolling_radius ball, 2 R on a plane", BALL(radius="ball")),
    Claim("roll_stop", "Level plane, mu_r 0.1, 0.3 m/s: way until it stands, v^2/(2 (5/7) mu_r g)", "m", SPHERE,
          (BALL(rolling=0.1, v0=0.3, tend=1),), stopped, Near(0.3 ** 2 / (2 * 5 / 7 * 0.1 * G), 0.01, True),
          Control("no rolling spring, and a dashpot of 0.1 N s/m",
                  (BALL(("rolling ${rolling}", "rolling ${rolling} rolling_spring 0 0.1"), rolling=0.1, v0=0.3,
                        tend=1),))),
    _accelerates("roll_incline", "Incline of 20 degrees, mu_r 0.05: (5/7) g (sin f - mu_r cos f)",
                 5 / 7 * G * (SIN - 0.05 * COS), DOWN, "without rolling resistance", DOWN(rolling=0)),
    _accelerates("slide_incline", "Incline of 40 degrees, friction 10 degrees: slides with g (sin f - mu cos f)",
                 G * (SIN_40 - MU_10 * COS_40), SLIDE, "friction 30 degrees", SLIDE(friction=30)),
    Claim("slide_incline_spin", "The same: the spin grows by 2.5 (mu - mu_r) g cos f/R", "rad/s2", SPHERE, (SLIDE,),
          spin_rate, Near(2.5 * (MU_10 - 0.05) * G * COS_40 / R, 0.005, True),
          Control("without rolling resistance", (SLIDE(rolling=0),))),
    Claim("incline_threshold", f"Rolls without sliding up to tan f = 3.5 mu - 2.5 mu_r, {LIMIT:.2f} degrees for "
          "friction 10: speed of the contact point over that of the centre, 0.5 degrees below", "", SPHERE,
          (SLIDE(slope=round(LIMIT - 0.5, 3)),), rolled, AtMost(1e-3),
          Control("0.5 degrees above", (SLIDE(slope=round(LIMIT + 0.5, 3)),))),
    _accelerates("block_incline", "Incline of 40 degrees, friction 10 degrees, mu_r 1: a body that cannot roll slides "
                 "with g (sin f - mu cos f)", G * (SIN_40 - MU_10 * COS_40), SLIDE(rolling=1), "friction 12 degrees",
                 SLIDE(rolling=1, friction=12)),
    Claim("spin_down", "A pressed ball without friction loses spin by 5 mu_r g/(2 R)", "rad/s2", SPHERE, (PRESSED,),
          spin_rate, Near(-2.5 * 0.05 * G / R, 0.005, True),
          Control("rolling_radius ball, 2 R on a plane", (PRESSED(radius="ball"),))),
]
