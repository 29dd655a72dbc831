"""Impacts on a plane, straight and oblique

inputs/06_oblique_impact: 18 balls hit a plane at 0 to 85 degrees from its normal. Chung and Ooi (2011), tests 3 and 4;
the spin of the impacts of Kharaz et al. (2001) against another code's, 610 rad/s.
"""
import math

import numpy as np

from .claims import AtMost, Claim, Control, Near, Run, Seen
from .restitution import damping_ratio

CASE = "06_oblique_impact"
IMPACT = Run("06_oblique_impact/in.oblique_impact")
E, MU, SPEED, RADIUS, KN = 0.98, 0.092, 3.9, 0.0025, 1e7
MASS = 4000 * math.pi / 6 * 0.005 ** 3
# alumina on glass; kn has Hertz' overlap with E* 63 GPa, kt/kn is 4 G*/E*; the spin is largest near 27 degrees
ALUMINA = IMPACT(speed=3.85, kn=1.38e7, ktkn=0.857, first=24, each=1)
TEST_3, TEST_4 = "Chung and Ooi (2011), test 3", "Chung and Ooi (2011), test 4"
OSCILLATION = "damped oscillation"


def frames(result):
    return result.frames("oblique_impact.dump")


def restitution(result):
    """Of the ball whose normal restitution is farthest from that of all."""
    balls = frames(result)
    e = -balls["vz"][-1] / balls["vz"][0]
    return e[np.argmax(np.abs(e - np.median(e)))]


def sliding(balls):
    """Which balls slide throughout, and tan(theta) of these."""
    tangent = np.tan(np.radians(balls["v_theta"][0]))
    slides = tangent > 3.5 * MU * (1 + E) * 1.25       # 40 degrees and more
    return slides, tangent[slides]


def tangential(result):
    """Largest error of the tangential restitution of balls that slide."""
    balls = frames(result)
    slides, tangent = sliding(balls)
    got = balls["vx"][-1][slides] / balls["vx"][0][slides]
    return np.abs(got - (1 - MU * (1 + E) / tangent)).max()


def spin(result):
    """Largest error of R times the spin over the normal speed, of balls that slide."""
    balls = frames(result)
    slides, _ = sliding(balls)
    got = RADIUS * balls["omegay"][-1][slides] / -balls["vz"][0][slides]
    return np.abs(got - 2.5 * MU * (1 + E)).max()


def largest_spin(result):
    """Of all balls, rad/s."""
    return frames(result)["omegay"][-1].max()


def contact_time(result):
    """Of the straight impact, from its straight paths before and after, over the undamped one."""
    balls = frames(result)
    gap, vz = (balls[name][:, 0] for name in ("v_gap", "vz"))
    steps = len(gap) - 1
    dt = (gap[1] - gap[0]) / vz[0]
    return (steps * dt + gap[0] / vz[0] - gap[-1] / vz[-1]) / (math.pi * math.sqrt(MASS / KN))


def overlap(result):
    """Largest one of the straight impact, over that of an undamped one."""
    return -frames(result)["v_gap"][:, 0].min() / (SPEED * math.sqrt(MASS / KN))


def largest_overlap(e):
    """Over that of an undamped impact: exp(-z/sqrt(1-z^2) acos z)."""
    zeta = damping_ratio(e)
    return math.exp(-zeta / math.sqrt(1 - zeta ** 2) * math.acos(zeta))


def _sweep(e):
    return Claim(f"impact_e_{e}", f"Restitution {e} at the rule's time step: normal restitution, worst of 18 angles",
                 "", TEST_3, (IMPACT(e=e, part=1),), restitution, Near(e, 0.005),
                 Control("the dashpot of restitution sqrt(e)", (IMPACT(e=round(math.sqrt(e), 6), part=1),))
                 if e < 1 else Control("e 0.98", (IMPACT(e=0.98, part=1),)))


FASTER = ("At this step the contact is 0.2 % faster than the continuous one, so that the overlap at rest is m g/kn "
          "(theory, Time step).")
CLAIMS = [
    *(_sweep(e) for e in (0.2, 0.4, 0.6, 0.8, 1.0)),
    Claim("impact_tangential", "Impacts at 40 to 85 degrees slide: largest error of the tangential restitution "
          "1 - mu (1+e)/tan(theta)", "", TEST_4, (IMPACT,), tangential, AtMost(0.005),
          Control("friction coefficient 0.1", (IMPACT(mu=0.1),))),
    Claim("impact_spin", "The same: largest error of R w/v_n, 2.5 mu (1+e)", "", TEST_4, (IMPACT,), spin, AtMost(0.005),
          Control("friction coefficient 0.1", (IMPACT(mu=0.1),))),
    Claim("impact_tangential_rule", "Tangential restitution at the rule's time step: largest error", "", TEST_4,
          (IMPACT(part=1),), tangential, AtMost(0.005), Control("friction coefficient 0.1", (IMPACT(part=1, mu=0.1),))),
    Claim("impact_alumina", "Alumina on glass, 3.85 m/s, 24 to 41 degrees: largest spin after the impact", "rad/s",
          "another code, of the impacts of Kharaz et al. (2001)", (ALUMINA,), largest_spin, Near(610, 0.05, True),
          Control("friction coefficient 0.1", (ALUMINA(mu=0.1),)),
          remark="No measured rebound is at hand. The other code's contacts are Hertz' and Mindlin's; bound set after "
                 "the first run."),
    Claim("impact_time", "Restitution 0.25: contact time over pi sqrt(m/k), 1/sqrt(1-z^2)", "", OSCILLATION,
          (IMPACT(e=0.25),), contact_time, Near(1 / math.sqrt(1 - damping_ratio(0.25) ** 2), 0.01, True),
          Control("restitution 0.445", (IMPACT(e=0.445),)), remark=FASTER),
    Claim("impact_overlap", "Restitution 0.25: largest overlap over v sqrt(m/k), exp(-z/sqrt(1-z^2) acos z)", "",
          OSCILLATION, (IMPACT(e=0.25),), overlap, Near(largest_overlap(0.25), 0.01, True),
          Control("restitution 0.445", (IMPACT(e=0.445),)), remark=FASTER),
]


def at(angle, what):
    """What became of the ball that came in at an angle (degrees): e_n, e_t or spin, R w/v_n."""
    def got(result):
        balls = frames(result)
        k = int(np.argmin(np.abs(balls["v_theta"][0] - angle)))
        return {"e_n": lambda: -balls["vz"][-1][k] / balls["vz"][0][k],
                "e_t": lambda: balls["vx"][-1][k] / balls["vx"][0][k],
                "spin": lambda: abs(RADIUS * balls["omegay"][-1][k] / balls["vz"][0][k])}[what]()
    return got


SEEN = [Seen(f"{what}.{angle}", (IMPACT,), at(angle, what)) for angle in (0, 20, 40, 60, 85)
        for what in ("e_n", "e_t", "spin") if (angle, what) != (0, "e_t")]


def alumina(what):
    """Of the alumina: angle of the largest spin, degrees; velocity at the contact at an angle, after over before."""
    def got(result):
        balls = frames(result)
        theta, spin, vx = balls["v_theta"][0], balls["omegay"], balls["vx"]
        if what == "angle":
            return theta[np.argmax(spin[-1])]
        k = int(np.argmin(np.abs(theta - what)))
        return (vx[-1][k] - RADIUS * spin[-1][k]) / vx[0][k]
    return got


def slides_from(result):
    """Degrees, from which on the spin is that of sliding throughout, within 0.1 rad/s."""
    balls = frames(result)
    slides = 2.5 * MU * (1 + E) * -balls["vz"][0] / RADIUS
    return balls["v_theta"][0][np.abs(balls["omegay"][-1] - slides) > 0.1].max() + 1


SOFTER = {"kt_1": ALUMINA(ktkn=1), "kt_2_3": ALUMINA(ktkn=0.6667)}
WIDE = ALUMINA(first=0, each=5)
SEEN += [Seen("alumina.angle", (ALUMINA,), alumina("angle")), Seen("alumina.slides_from", (ALUMINA,), slides_from)]
SEEN += [Seen(f"alumina.{name}.{what}", (run,), got) for name, run in SOFTER.items()
         for what, got in (("spin", largest_spin), ("angle", alumina("angle")))]
SEEN += [Seen(f"alumina.contact.{angle}", (ALUMINA if angle == 31 else WIDE,), alumina(angle))
         for angle in (5, 10, 20, 31)]
