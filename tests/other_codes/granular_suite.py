"""LAMMPS' own verifications of granular models, unittest/granular of a tree of 4Jul2026 or later, with our styles.

    PYTHONPATH=tools:tests LMP=build/lmp python3 -m other_codes.granular_suite TREE > doc/src/granular_suite.rst

A case file has its deck, the numbers that the stock styles left after each run, and the name of a closed form. The
deck is run once more with pair gran/restitution and fix wall/gran/mesh, by the coefficients of the file. The tree is
not shipped: the folder unittest of the upstream archive of Debian's source package lammps, see upstream_source.sh.
"""
import datetime
import itertools
import math
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Dict, List, NamedTuple, Optional, Tuple

import numpy as np
import yaml

from slope_tools import disk
from slope_tools.deposits import dumps

COLUMNS = "x y z vx vy vz omegax omegay omegaz"
X, Y, Z, VX, VY, VZ, WX, WY, WZ = range(9)
FAR = 20.0              # how far a wall goes, in widths of the box
REASONS = (             # why a case does not apply: a word of its deck, the reason
    (r"superellipsoid", "no spheres"), (r"rigid", "rigid clumps"), (r"dimension 2", "discs in two dimensions"),
    (r"\b(dmt|jkr)\b", "cohesion"), (r"hertz", "springs of Hertz and Mindlin, ours are linear"),
    (r"pair_style none", "no contact: a drag that is LAMMPS' own"))


PAGE = """.. index:: LAMMPS' granular verifications, unittest/granular

LAMMPS' own granular verifications
==================================

*For reviewers.*  The cases of *unittest/granular* of LAMMPS {source}, run with :doc:`pair gran/restitution
<pair_gran_restitution>` and flat walls of :doc:`fix wall/gran/mesh <fix_wall_gran_mesh>` in LAMMPS {version}, {date}.
*Stock* are the numbers in the files, of the stock styles in LAMMPS {stock}.  Coefficients are the files', as
numbers.

In LAMMPS the dashpots see the velocity of half a step earlier; so do ours with *scheme plain* (*plain*), which
therefore compares the laws.  *Ours* are those with the default scheme, whose steps have the law's restitution: in
central impacts they are nearer to the closed form, and after several impacts (dem02) the rest adds up.  Where
the dashpot pulls, just before balls part, the stock limit of friction is that of a pressing force of the same size,
ours is zero: a sliding ball of dem05 loses 0.1 % less.  The heaps (dem10-aor) are one run each: their angles
differ by chance.

*Difference* is that of ours from the closed form, or from the stock number where the file names no form, as a share.

``tests/other_codes/granular_suite.py`` writes this page.
"""


class Value(NamedTuple):
    """A number of a case: the closed form's (None: there is none), the stock styles', ours with both schemes."""
    name: str
    exact: Optional[float]
    stock: Optional[float]
    plain: float
    ours: float

    @property
    def difference(self) -> float:
        """Of ours from the closed form, or else from the stock styles, as a share of it where it is not 0."""
        true = self.exact if self.exact is not None else self.stock
        return math.nan if true is None else (self.ours - true) / (abs(true) or 1.0)


class Case:
    """A file of the suite."""

    def __init__(self, path: Path):
        self.name = path.stem
        self.about = yaml.load(path.read_text(encoding="utf-8"), Loader)
        self.variables = dict(line.split(None, 1) for line in self.about["variables"].splitlines() if line.strip())
        self.segments = [int(word) for word in str(self.about["run_segments"]).split()]
        self.deck = "\n".join(self.about[name] for name in ("pre_commands", "post_commands"))
        self.words = f"{self.deck}\npair_style {self.about['pair_style']}\n{self.about['pair_coeff']}"

    def number(self, name: str, default: float = 0.0) -> float:
        return float(self.variables.get(name, default))

    def reason(self) -> str:
        """Why it does not apply; "" if it does."""
        for word, reason in REASONS:
            if re.search(word, self.words):
                return reason
        return ""

    def filled(self, text: str) -> str:
        """A text with the values of the variables."""
        return re.sub(r"\$\{(\w+)\}", lambda found: self.variables.get(found[1], found[0]), text)

    def stock(self, segment: int) -> Optional[np.ndarray]:
        """The stock styles' state after a run, from the file: a row per ball; None if the file has none."""
        parts = [self.about.get(f"run_{name}", "") for name in ("pos", "vel", "omega")]
        tables = [np.array([line.split() for line in part.splitlines() if line.strip()], float) for part in parts]
        if not len(tables[0]) or not len(tables[1]):
            return None
        if not len(tables[2]):
            tables[2] = tables[0] * [1, 1, 0, 0, 0]
        tables = [table[table[:, 0] == segment] for table in tables]
        return np.hstack([table[table[:, 1].argsort()][:, 2:] for table in tables])


class Loader(yaml.SafeLoader):
    """YAML with texts that have the tag "!"."""


def text_of(loader: Loader, node: yaml.ScalarNode) -> str:
    return str(loader.construct_scalar(node))


Loader.add_constructor("!", text_of)


def found_in(pattern: str, text: str) -> str:
    """The pattern's group in a text that must have it."""
    found = re.search(pattern, text)
    if not found:
        raise ValueError(f"must have {pattern}")
    return found[1]


# --- the translation ---

class Contact(NamedTuple):
    """Coefficients of the stock styles as pair gran/restitution has them, for one mass of the contact."""
    kn: float
    kt: float
    cn: float
    ct: float
    friction: float         # tan
    rolling: Tuple[float, ...] = ()     # kr, cr, mu_r

    def words(self) -> str:
        roll = "rolling {2} rolling_spring {0} {1}".format(*self.rolling) if self.rolling else ""
        return (f"stiffness {self.kn!r} {self.kt!r} damping {self.cn!r} {self.ct!r} "
                f"friction {math.degrees(math.atan(self.friction))!r} {roll}")


def contact(case: Case, mass: float) -> Contact:
    """Of pair gran/hooke and gran/hooke/history by the style's words, of pair granular by pair_coeff's."""
    words = case.filled(case.about["pair_style"]).split()
    if words[0].startswith("gran/hooke"):
        kn, kt, cn, ct, friction, damped = (math.nan if word == "NULL" else float(word) for word in words[1:7])
        kt = kn * 2 / 7 if math.isnan(kt) else kt
        ct = (cn / 2 if math.isnan(ct) else ct) * damped
        return Contact(kn, kt, cn * mass, ct * mass, friction)
    words = case.filled(case.about["pair_coeff"]).split()
    kn, e = (float(words[words.index("hooke") + i]) for i in (1, 2))
    damping = -math.log(e) / math.hypot(math.pi, math.log(e)) if e < 1 else 0.0
    cn = 2 * damping * math.sqrt(kn * mass)
    at = words.index("tangential")
    numbers = [float(word) for word in words[at + 2:at + 5 - (words[at + 1] == "linear_nohistory")]]
    kt, ct, friction = numbers if len(numbers) == 3 else (0.0, *numbers)
    rolling = tuple(map(float, words[words.index("sds") + 1:][:3])) if "sds" in words else ()
    return Contact(kn, kt, cn, ct * cn, friction, rolling)


def plane(axis: int, at: float, box: np.ndarray) -> str:
    """Two triangles, as a text STL, across the box and beyond."""
    low, high = box - FAR * (box[1] - box[0]) * [[1], [-1]]
    others = [i for i in range(3) if i != axis]
    corners = []
    for a, b in ((low, low), (high, low), (high, high), (low, high)):
        corner = [0.0, 0.0, 0.0]
        corner[axis], corner[others[0]], corner[others[1]] = at, a[others[0]], b[others[1]]
        corners.append("vertex {!r} {!r} {!r}".format(*map(float, corner)))
    return "".join("facet normal 0 0 0\nouter loop\n" + "\n".join(corners[i] for i in one) + "\nendloop\nendfacet\n"
                   for one in ((0, 1, 2), (0, 2, 3)))


def masses(case: Case) -> List[float]:
    """Of the balls as the deck sets them: one, or that of each `set` of a density."""
    found = []
    for line in case.filled(case.deck).splitlines():
        if one := re.match(r"(?:set .* diameter|fix .* diam one) (\S+) dens(?:ity)? (\S+)", line):
            found.append(math.pi / 6 * float(one[1]) ** 3 * float(one[2]))
    return found


def translate(case: Case, folder: Path, scheme: str) -> str:
    """Our deck of a case; writes its walls into the folder."""
    box = np.array(found_in(r"region \w+ block((?: \S+){6}) units box", case.deck).split(), float).reshape(3, 2).T
    weights = masses(case)
    pair = contact(case, weights[0] * weights[-1] / (weights[0] + weights[-1]))
    lines, walls, types = [f"variable {name} index {value}" for name, value in case.variables.items()], 0, 0
    for line in case.about["pre_commands"].splitlines():
        found = re.match(r"create_box (\d+)", line)
        if found:
            types = int(found[1])
            line = line.replace(f"create_box {types}", f"create_box {types + 1}")
        lines.append(re.sub(r"^boundary .*", "boundary f f f", line))       # no ball leaves; walls do not repeat
    lines += [f"pair_style gran/restitution scheme {scheme} {'rolling_radius reduced' if pair.rolling else ''}",
              f"pair_coeff 1*{types} 1*{types} {pair.words()}",
              f"pair_coeff 1*{types} {types + 1} {contact(case, weights[0]).words()}"]
    for line in case.filled(case.about["post_commands"]).splitlines():
        found = re.match(r"fix (\w+) all wall/gran .* ([xyz])plane (\S+) (\S+)", line)
        if not found:
            lines.append(line)
            continue
        text = "".join(plane("xyz".index(found[2]), float(at), box) for at in found.groups()[2:] if at != "NULL")
        (folder / f"wall{walls}.stl").write_text(f"solid wall\n{text}endsolid wall\n", encoding="ascii")
        lines.append(f"fix {found[1]} all wall/gran/mesh {types + 1} wall{walls}.stl")
        walls += 1
    for segment, steps in enumerate(case.segments):
        lines += [f"run {steps}", f"write_dump all custom state.{segment} id {COLUMNS} modify sort id "
                  "format float %.15g"]
    return "\n".join(lines) + "\n"


def run(case: Case, lmp: str, scheme: str) -> List[np.ndarray]:
    """Our state after each run of a case; ValueError with LAMMPS' words if it does not end well."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "in.case").write_text(translate(case, folder, scheme), encoding="ascii")
        done = subprocess.run([lmp, "-in", "in.case", "-log", "none"], cwd=folder, capture_output=True, text=True,
                              check=False)
        error = re.search(r"ERROR.*?: (.*?)(?: \(\S+:\d+\))?$", done.stdout + done.stderr, re.MULTILINE)
        if done.returncode or error:
            raise ValueError(error[1] if error else "does not end well")
        return [values[:, 1:] for i in range(len(case.segments)) for _, values in dumps.frames(folder / f"state.{i}")]


# --- what is compared ---

def closed_form(case: Case, time: float) -> Dict[str, float]:
    """The values of a case's model, by the names of measured()."""
    n = case.number
    model, e, g = case.about.get("analytic_model"), n("en", 1.0), n("grav")
    if model == "freefall":
        return {"height": n("z0") - g * time ** 2 / 2, "vz": -g * time}
    if model == "bounce_height":
        return {"apex": n("radius") + e ** (2 * n("bounce_k", 1)) * (n("h0") - n("radius"))}
    if model == "slip_cessation":
        return {"vx": 5 / 7 * n("u0"), "spin": 5 / 7 * n("u0") / n("radius")}
    if model == "oblique_impact":
        lost = n("xmu") * (1 + e) * n("vz_in")
        return {"vz": e * n("vz_in"), "vx": n("vx_in") - lost, "spin": 2.5 * lost / n("radius")}
    if model == "spin_impact":
        gained = n("xmu") * (1 + e) * n("vin")
        return {"vz": e * n("vin"), "vx": gained, "spin": n("omega0") - 2.5 * gained / n("radius")}
    if model == "rolling_decay":
        return {"spin": n("omega0") - 5 * n("mur") * g / n("diam") * time}
    if model == "collision_restitution":
        return {"restitution": e}
    if model == "spin_no_friction":
        return {"spin": n("omega0"), "vx": 0.0}
    return {}


def measured(case: Case, state: np.ndarray) -> Dict[str, float]:
    """What a state has, of ball 1 where nothing else is said."""
    ball, n = state[0], case.number
    found = {"height": ball[Z], "vx": ball[VX], "vz": ball[VZ], "spin": ball[WY], "spin z": ball[WZ],
             "mean height": float(np.mean(state[:, Z]))}
    if n("grav"):
        found["apex"] = ball[Z] + ball[VZ] ** 2 / (2 * n("grav"))
    if len(state) == 2 and n("vin"):
        found["restitution"] = (state[1, VX] - ball[VX]) / (2 * n("vin"))
    moment = 0.4 * (n("diam") / 2) ** 2         # of inertia, per mass
    started = n("vx_in") ** 2 + n("vz_in") ** 2
    if started:
        found["energy left, at most 1"] = float(ball[VX:WX] @ ball[VX:WX] + moment * ball[WX:] @ ball[WX:]) / started
    reach = np.hypot(*(state[:, :Z] - state[:, :Z].mean(axis=0)).T).max()
    found["repose, 15 to 55 degrees"] = math.degrees(math.atan2(state[:, Z].max() - n("floor"), reach))
    return found


# what is compared where the file names no closed form, or one of no single value
OTHERWISE = {"dem01": ["height", "vz"], "dem02": ["apex"], "dem05": ["energy left, at most 1"],
             "dem09-shear": ["vx", "spin z"], "dem09": ["vz", "vx", "spin"], "dem10-aor": ["repose, 15 to 55 degrees"],
             "dem10": ["mean height"]}


def compare(case: Case, lmp: str, step: float) -> List[Value]:
    """The Values of a case."""
    plain, states = (run(case, lmp, scheme) for scheme in ("plain", "exact"))
    at = int(case.about.get("analytic_segment", -1)) % len(states)
    exact = closed_form(case, sum(case.segments[:at + 1]) * step)
    names = list(exact) or next(names for prefix, names in OTHERWISE.items() if case.name.startswith(prefix))
    stock = case.stock(at)
    theirs = measured(case, stock) if stock is not None else {}
    half, ours = measured(case, plain[at]), measured(case, states[at])
    return [Value(name, exact.get(name), theirs.get(name), half[name], ours[name]) for name in names]


def number(value: Optional[float]) -> str:
    return "" if value is None or math.isnan(value) else f"{value:.6g}"


def rows(case: Case, lmp: str) -> List[List[str]]:
    """The rows of the table."""
    reason = case.reason()
    if not reason:
        step = float(found_in(r"timestep (\S+)", case.deck))
        try:
            return [[case.name if i == 0 else "", one.name, number(one.exact), number(one.stock),
                     number(one.plain), number(one.ours),
                     f"{one.difference:.1e}" if not math.isnan(one.difference) else ""]
                    for i, one in enumerate(compare(case, lmp, step))]
        except ValueError as error:
            overlap = re.search(r"overlap at the start .* worst (\d+ %)", str(error))
            reason = f"starts with overlaps of {overlap[1]} of the radius, an error here" if overlap else str(error)
    return [[case.name, f"does not apply: {reason}", "", "", "", "", ""]]


def main(tree: str, source: str = "4Jul2026", *names: str) -> None:
    """Print the page; source: the tree's version, names: of cases, default all."""
    lmp = os.environ["LMP"]
    paths = sorted(Path(tree, "unittest", "granular", "tests").glob("dem*.yaml"))
    version = subprocess.run([lmp, "-help"], capture_output=True, text=True, check=False).stdout
    stock = sorted({Case(path).about["lammps_version"] for path in paths})
    print(PAGE.format(source=source, version=found_in(r"Simulator - (.*\w)", version), stock=", ".join(stock),
                      date=datetime.date.today()))
    print(".. csv-table::\n   :header-rows: 1\n   :widths: 26 18 11 11 11 11 12\n")
    head = ["case", "quantity", "closed form", "stock", "plain", "ours", "difference"]
    found = (row for path in paths if not names or path.stem in names for row in rows(Case(path), lmp))
    for row in itertools.chain([head], found):
        print("   " + disk.csv_text(row, []), end="", flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
