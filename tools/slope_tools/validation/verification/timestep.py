"""The time-step rule holds the restitution, and a longer step does not

inputs/02_timestep: nine balls that meet the contact at different phases of a step; e from their energies.
"""
from .claims import AtLeast, Claim, Control, Near, Run, Seen

CASE = "02_timestep"
DROP = Run("02_timestep/in.timestep")(tend=0.4)
EXACT, PLAIN = DROP(scheme="exact"), DROP(scheme="plain")
RULE, BEYOND = "1.2e-4", "5.0e-4"      # s; the rule is 1.22e-4 s
TARGET = 0.445
FIGURE_6 = "paper, equation 4 and Figure 6"


def bounces(result):
    """Lowest and highest restitution of the nine balls."""
    return [result.number(name, "timestep:") for name in ("from", "to")]


def worst(result):
    """The bounce that is farthest from the target."""
    return max(bounces(result), key=lambda e: abs(e - TARGET))


def too_high(result):
    """Bounce height of the highest ball over the right one."""
    return (bounces(result)[1] / TARGET) ** 2


CLAIMS = [
    Claim("step_of_the_rule", "At 1.2e-4 s, a step of the rule: restitution of the worst of nine phases", "", FIGURE_6,
          (EXACT(dt=RULE),), worst, Near(TARGET, 0.005), Control("scheme plain", (PLAIN(dt=RULE),))),
    Claim("step_5e-5", "At 5e-5 s: restitution of the worst of nine phases", "", FIGURE_6, (EXACT(dt="5.0e-5"),), worst,
          Near(TARGET, 0.005), Control("scheme plain", (PLAIN(dt="5.0e-5"),))),
    Claim("step_beyond", "At 5e-4 s, 4.1 times the rule, plain velocity Verlet bounces too high: height of the highest "
          "over the right one", "", FIGURE_6 + ": extreme", (PLAIN(dt=BEYOND),), too_high, AtLeast(2.0),
          Control("a step of the rule", (PLAIN(dt=RULE),))),
    Claim("step_plain_5e-6", "At 5e-6 s, plain velocity Verlet too: restitution of the worst of nine phases", "",
          FIGURE_6, (PLAIN(dt="5.0e-6"),), worst, Near(TARGET, 0.003), Control("5e-4 s", (PLAIN(dt=BEYOND),))),
    Claim("step_5e-7", "At 5e-7 s: restitution of the worst of nine phases", "", FIGURE_6, (EXACT(dt="5.0e-7"),), worst,
          Near(TARGET, 0.003), Control("5e-4 s", (EXACT(dt=BEYOND),)), quick=False),
]
STEPS = {"5e-7": "5.0e-7", "5e-6": "5.0e-6", "5e-5": "5.0e-5", "1.2e-4": RULE, "5e-4": BEYOND}
SEEN = [Seen(f"{scheme}.{step}.{name}", (DROP(scheme=scheme, dt=dt),),
             lambda result, name=name: result.number(name, "timestep:"), step != "5e-7")
        for scheme in ("plain", "exact") for step, dt in STEPS.items() for name in ("observed", "from", "to")]
SEEN += [Seen(f"plain.{step}.height{which}", (PLAIN(dt=dt),),
              lambda result, name=name: 0.741 * result.number(name, "timestep:") ** 2, step != "5e-7")
         for step, dt, which, name in (("5e-7", STEPS["5e-7"], "", "observed"), ("5e-4", BEYOND, "", "observed"),
                                       ("5e-4", BEYOND, "_highest", "to"))]
LATE = ("neigh_modify    delay 0 ", "neigh_modify    delay 10 "), ("neighbor        $(0.5*v_d) bin", "")
SEEN += [Seen(f"{scheme}.late", (DROP(*LATE, scheme=scheme, dt=RULE),),
              lambda result: result.number("observed", "timestep:")) for scheme in ("plain", "exact")]
