"""A dropped ball rebounds with the target restitution

inputs/01_restitution: a ball falls on a fixed ball; e = sqrt(h2/h1). The dashpot follows from the target.
"""
import math

from .claims import Claim, Control, Near, Run, Seen

CASE = "01_restitution"
DROP = Run("01_restitution/in.restitution")(tend=0.45)
TABLE_2 = "paper, Tables 1 and 2"


def observed(result):
    return result.number("observed", "restitution:")


def damping_ratio(e):
    """Of a spring and dashpot that rebounds with e at zero overlap."""
    return -math.log(e) / math.hypot(math.pi, math.log(e))


def restitution(zeta):
    """Inverse of damping_ratio."""
    return math.exp(-math.pi * zeta / math.sqrt(1 - zeta ** 2))


def dashpot(e, k, mass):
    """N s/m, of a stiffness (N/m) and a mass (kg)."""
    return 2 * damping_ratio(e) * math.sqrt(k * mass)


def _claim(name, text, run, expected, wrong):
    return Claim(name, text, "", TABLE_2, (run,), observed, Near(expected, 0.003),
                 Control("dashpot with half the mass under the root, that of two moving balls", (wrong,)))


CLAIMS = [
    _claim("restitution_0.25", "Target restitution 0.25: observed", DROP(e=0.25), 0.249,
           DROP(cn=dashpot(0.25, 3.67e7, 8.78 / 2))),
    _claim("restitution_0.25_dashpot", "Table 1's 1.45e4 N s/m: observed restitution", DROP(cn=1.45e4), 0.249,
           DROP(cn=1.45e4 / math.sqrt(2))),
    _claim("restitution_0.445", "Target restitution 0.445: observed", DROP(e=0.445), 0.445,
           DROP(cn=dashpot(0.445, 3.67e7, 8.78 / 2))),
    _claim("restitution_0.445_dashpot", "Table 1's 8.96e3 N s/m: observed restitution", DROP(cn=8.96e3), 0.445,
           DROP(cn=8.96e3 / math.sqrt(2))),
]
RUNS = {"e_0.25": DROP(e=0.25), "cn_1.45e4": DROP(cn=1.45e4), "e_0.445": DROP(e=0.445), "cn_8.96e3": DROP(cn=8.96e3)}
SEEN = [Seen(f"h2_{name}", (deck,), lambda result: result.number("h2", "restitution:")) for name, deck in RUNS.items()]
SEEN += [Seen(f"plain_{name}", (deck(scheme="plain"),), observed) for name, deck in RUNS.items()]
SEEN.append(Seen("plain_e_0.445_g", (DROP(e=0.445, scheme="plain", g=9.80665),), observed))


def with_overlap(result):
    """The restitution as Table 2 has it: both heights from the deepest point, not from first touch."""
    deep = -result.curve("restitution.csv")["height"].min()
    return math.sqrt((result.number("h2", "restitution:") + deep) / (0.740 + deep))


SEEN += [Seen(f"overlap_added_{e}", (DROP(e=e, h1=0.740),), with_overlap) for e in (0.25, 0.445)]
SEEN.append(Seen("moving_1.45e4", (RUNS["cn_1.45e4"],),
                 lambda result: float(result.printed("  1   1 ")[0].split()[6])))      # of the start-up table
