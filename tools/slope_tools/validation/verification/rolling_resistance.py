"""Still, sliding, rolling: what friction and rolling resistance hold

inputs/04_rolling_resistance: a ball on a fixed ball, contact at 30 degrees; the deck judges by rotation and sliding.
"""
import math

from .claims import Claim, Control, Near, Run, Seen, Verdict
from .slide_roll import on_a_sphere

CASE = "04_rolling_resistance"
BALL = Run("04_rolling_resistance/in.rolling_resistance")
SOFT = BALL(zeta=8, dt="2e-7")      # dashpots far above critical: the load comes on softly
STILL, SLIDES, ROLLS = (31, 0.58), (29, 0.58), (31, 0.56)
HALF = ("gran/restitution\n", "gran/restitution rolling_radius reduced\n")
NO_SPRING = ("rolling_spring $k $c", "rolling_spring 0 $(v_c/100)")
TABLE_3 = "paper, Table 3 and Figure 9"


def verdict(result):
    return result.printed("rolling_resistance:")[0].split(": ")[2]


def path(result):
    return result.number("path", "rolling_resistance:")


def _run(case, deck=BALL):
    return deck(friction=case[0], rolling=case[1])


def _claim(name, case, word, broken, wrong, more=""):
    return Claim(name, f"Friction {case[0]} degrees, mu_r {case[1]}{more}", "", TABLE_3, (_run(case),), verdict,
                 Verdict(word), Control(broken, (wrong,)))


def _path(name, text, case, other, **law):
    return Claim(name, text, "m", "equation of motion, Runge-Kutta", (_run(case, SOFT),), path,
                 Near(on_a_sphere(0.2, **law)[0], 0.01, True),
                 Control(f"friction {other[0]} degrees, mu_r {other[1]}", (_run(other, SOFT),)))


CLAIMS = [
    _claim("still", STILL, "stays still", "half the torque arm, as sds and epsd2 have it", _run(STILL)(HALF),
           ", torque limit mu_r R Fn"),
    _claim("still_spring", STILL, "stays still", "no rolling spring, a dashpot only", _run(STILL)(NO_SPRING),
           ", on a rolling spring"),
    _claim("slides", SLIDES, "slides without rotating", "mu_r 0.50", _run((29, 0.50))),
    _claim("rolls", ROLLS, "rotates without sliding", "friction 25 degrees", _run((25, 0.56))),
    _path("slides_path", "Friction 29 degrees, mu_r 0.58: path after 0.2 s, sliding on a sphere", SLIDES, ROLLS,
          mu=math.tan(math.radians(29))),
    _path("rolls_path", "Friction 31 degrees, mu_r 0.56: path after 0.2 s, rolling on a sphere", ROLLS, SLIDES,
          spin=True, mu_r=0.56),
]
SEEN = [Seen(f"{name}.{what}", (_run(case),), lambda result, what=what: result.number(what, "rolling_resistance:"))
        for name, case in (("still", STILL), ("slides", SLIDES), ("rolls", ROLLS))
        for what in ("path", "rotation", "sliding")]
SEEN += [Seen(f"still_zeta_{zeta:g}", (_run(STILL, BALL(zeta=zeta)),), path) for zeta in (0.1, 0.5, 1.5, 8)]
SEEN.append(Seen("half.rotation", (_run(STILL)(HALF),),
                 lambda result: result.number("rotation", "rolling_resistance:")))


def at_fall(result):
    """When the centre has fallen by 0.18 m, the end of the axis of Figure 9 read in m, s."""
    curve = result.curve("rolling_resistance.csv")
    return curve["time"][curve["fall"] >= 0.18][0]


SEEN += [Seen(f"{name}.at_0.18", (_run(case, BALL(tend=1)),), at_fall) for name, case in (
    ("slides", SLIDES), ("rolls", ROLLS))]
