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
                "With Table 4's dashpot, 1.19e6, \"the restitution coefficients both between soil/soil balls (blue) "
                "and between soil/slip surface balls (red) are 0.48\".",
                f"The dashpot follows from 0.48 with the mass of one ball ({soil:.3g} N s/m), so it holds for a ball "
                f"on a fixed ball. Two moving balls have half of that mass: {moving:.3f}. A true 0.48 between them "
                f"needs {true:.3g} N s/m. Pair gran/restitution takes the right mass for each pair (mass pair); mass "
                "ball gives the paper's dashpots.",
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
        Erratum("In Table 3's case 3 the ball rotates without sliding",
                "\"The element slides in cases 2 and 3\".",
                "Case 3 of Table 3 rotates without sliding, as the simulation here does.", ()),
        Erratum("There are two Tables 5, and Tables 4 and 5 are named in reverse",
                "\"Table 4 and 5 show the parameters for the balls and their contact\".",
                "Table 4 has the contacts, Table 5 the balls; the volumes to be removed are a Table 5, too, which "
                "these pages call the second.", ()),
        Erratum("Table 3 does not have the rolling coefficients of the parameter study",
                "\"Using the rolling resistance coefficients in Table 3\".",
                "Table 3 has 0.58 and 0.56, of the ball at rest on another; those of the study, 0.0, 0.05 and 0.10, "
                "are in the second Table 5.", ()),
        Erratum("The runs on restitution are in Figure 5, not in Fig. 8",
                "\"With a restitution coefficient of 0.45, as in Fig. 8\"; \"the analysis shown in Fig. 8 was "
                "conducted with dt = 1.2 x 10-4\".",
                "Figure 8 shows sliding and rolling. The coefficient is Table 2's 0.445.", ()),
        Erratum("Two headings are alike",
                "\"numerical simulation of the restitution experiment\", in the headings of parts 1 and 2.",
                "Part 2 is on the time step.", ()),
    ]
