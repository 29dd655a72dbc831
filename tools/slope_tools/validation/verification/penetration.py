"""A steel ball goes as deep into a bed by this package's law as by LAMMPS' pair granular

inputs/18_penetration: 7,105 balls of 2 mm, 2 ms. Same springs, dashpots and friction; pair granular's dashpots see the
velocity of half a step ago, and single contacts differ from the first on.
"""
from .claims import Claim, Control, Near, Run, Seen

CASE = "18_penetration"
SMALL = Run("18_penetration/in.penetration")(balls=7105, time=0.002, settle=0.04)
GRANULAR = SMALL(law="granular")


def ratio(ours, theirs):
    """Of the ways of the steel ball."""
    return ours.number("way", "penetration:") / theirs.number("way", "penetration:")


CLAIMS = [
    Claim("penetration", "Steel ball after 2 ms: way in the bed over that with pair granular", "",
          "pair granular of LAMMPS, the same springs", (SMALL, GRANULAR), ratio, Near(1, 0.02),
          Control("half the friction and restitution 0.1", (SMALL(friction=8, steel_friction=5, e=0.1), GRANULAR)),
          quick=False),
]
SEEN = [Seen(f"way.{name}", (run,), lambda result: result.number("way", "penetration:"), False, 0.01)
        for name, run in (("ours", SMALL), ("granular", GRANULAR))]
