"""What in the paper's text disagrees with its own numbers or with mechanics, and what the package does about it."""
import math
from typing import NamedTuple, Tuple

from .restitution import dashpot, restitution

MASS = 3411.4 * math.pi / 6 * 1.25 ** 3     # kg, of Table 5's ball
STIFFNESS = 1.96e9                          # N/m, Table 4


class Erratum(NamedTuple):
    title: str
    printed: str
    right: str
    claims: Tuple[str, ...]     # names: what shows it


def errata():
    """The list; its numbers are computed here."""
    soil, field = (dashpot(e, STIFFNESS, MASS) for e in (0.48, 0.1))
    moving = restitution(1.19e6 / (2 * math.sqrt(STIFFNESS * MASS / 2)))
    true = dashpot(0.48, STIFFNESS, MASS / 2)
    return [
        Erratum("Restitution between soil balls: 0.344, not 0.48",
                "With Table 4's dashpot, 1.19e6, \"the restitution coefficients both between soil/soil balls and "
                "between soil/slip surface balls are 0.48\".",
                f"The dashpot follows from 0.48 with the mass of one ball ({soil:.3g} N s/m), so it holds for a ball "
                f"on a fixed ball. Two moving balls have half of that mass: {moving:.3f}. A true 0.48 between them "
                f"needs {true:.3g} N s/m. Pair gran/restitution takes the right mass for each pair (mass pair); the "
                "paper's convention is mass ball.",
                ("table_4_moving", "true_0.48")),
        Erratum("Condition for rolling: 3.5 tan(theta) > tan(phi), not 3",
                "A ball rolls without sliding if 3 tan(theta) > tan(phi).",
                "3 is a disc's factor; a solid sphere has 3.5. The paper's own case, theta 10 and phi 30 degrees, "
                f"rolls although 3 tan(10) = {3 * math.tan(math.radians(10)):.3f} < tan(30) = "
                f"{math.tan(math.radians(30)):.3f}: 3.5 tan(10) = {3.5 * math.tan(math.radians(10)):.3f}.",
                ("roll_only", "roll_threshold")),
        Erratum("Units of Table 4: N/m and N s/m",
                "Spring coefficients in m/N, dashpots in m/N/s.",
                f"They are 1.96e9 N/m, and 1.19e6 and 3.09e6 N s/m: with Table 5's ball ({MASS:.1f} kg) the formula "
                f"gives {soil:.3g} N s/m for 0.48 and {field:.3g} N s/m for 0.1.",
                ("table_4_moving",)),
    ]
