"""The same scenes in other codes: bounce, slide, roll, rolling resistance, a collapse."""
import math
import re
import resource
import shutil
import sys
from pathlib import Path
from typing import Any, Dict, List, NamedTuple, Optional, Tuple

import numpy as np

from slope_tools import disk
from slope_tools.case.data_files import data_files
from slope_tools.errors import SlopeError
from . import peer_runs, peers
from .peers import Contact, Scene

INPUTS = Path(__file__).resolve().parents[2] / "inputs"
START = "start.dump"
DROPS = 10              # phases of a step at which a contact begins
NOISE = 1e-6            # diameters by which the balls of a repeated collapse are moved at the start
BULK = 6 / math.pi
PEERS = (peers.Granular, peers.Liggghts, peers.Yade)
OTHER_ROLLING = ("liggghts", "yade")
TWIN = {"granular": "plain", "liggghts": "plain", "yade": "plain_limited"}
VERDICTS = {(False, False): "stays still", (True, False): "slides without rotating",       # slides, rotates
            (False, True): "rotates without sliding", (True, True): "slides and rotates"}


class Plain(peers.Slope):
    name, title, keywords = "plain", "SLOPE, scheme plain", "mass pair scheme plain"


class PlainLimited(peers.Slope):
    name, title = "plain_limited", "SLOPE, plain, limit_damping yes"
    keywords = "mass pair scheme plain limit_damping yes"


OURS = (peers.Slope, Plain, PlainLimited)


class Check(NamedTuple):
    """One comparison: what a code gave, what it is held against, how close it must be (a verdict: equal)."""
    case: str
    quantity: str
    code: str
    value: Any                      # a number or a word
    against: str
    expected: Any
    tolerance: Optional[float]      # absolute; None: for information
    reason: str                     # for the tolerance

    @property
    def passed(self):
        if self.tolerance is None:
            return None
        if isinstance(self.value, str):
            return self.value == self.expected
        return bool(abs(self.value - self.expected) <= self.tolerance)


# --- a deck's final numbers ---

def scene_of(lmp, deck, settings, folder):
    """The Scene that a deck runs, and the keywords of its pair style: its commands up to the first run are done."""
    folder.mkdir(exist_ok=True)
    for name, source in data_files(deck, {}).items():
        shutil.copy(source, folder / name)
    text = re.sub(r"&[ \t]*\n", " ", deck.read_text(encoding="ascii"))
    before = re.split(r"^[ \t]*run\b", text, flags=re.MULTILINE)[0]
    walls = re.findall(r"^[ \t]*fix[ \t]+(\S+)[ \t]+\S+[ \t]+wall/gran/balls\b.*", before, re.MULTILINE)
    before = re.sub(r"^([ \t]*fix[ \t]+(\S+)[ \t]+\S+[ \t]+wall/gran/balls\b[^#\n]*)",
                    lambda found: f"{found[1].rstrip()} write ground.{found[2]}.xyz ", before, flags=re.MULTILINE)
    disk.write_file(folder / deck.name, before + "run 0\n" f"""
print "SCENE dt $(dt:%.17g)"
write_dump all custom {START} id {peer_runs.COLUMNS} modify sort id format float %.17g
write_dump all custom kinds.dump id type diameter mass x y z vx vy vz modify sort id format float %.17g
""")
    log = folder / peer_runs.LOG
    options = [word for pair in settings.items() for word in ("-var", *map(str, pair))]
    peer_runs.run_deck(lmp, folder, deck.name, 1, options)
    text = log.read_text(encoding="utf-8", errors="replace")
    done = [line.split() for line in text.splitlines() if line.split() and "$" not in line]
    moving = peer_runs.read_dump(folder / START)[0]
    kinds = peer_runs.read_dump(folder / "kinds.dump")[0]
    if np.ptp(kinds[:, :3], axis=0).any() or kinds[0, 0] != 1:
        raise SlopeError(deck, "must have equal balls of type 1")
    diameter, mass = kinds[0, 1:3].tolist()
    style = next(words for words in done if words[0] == "pair_style")
    laws = {int(words[2]): words[3:] for words in done if words[0] == "pair_coeff" and words[1] == "1"}
    wall = {words[1]: int(words[4]) for words in done if words[0] == "fix" and words[3] == "wall/gran/balls"}
    points: Dict[int, List[np.ndarray]] = {}
    for name in walls:
        points.setdefault(wall[name], []).append(np.loadtxt(folder / f"ground.{name}.xyz", ndmin=2))
    fixed = {kind: np.concatenate(several) for kind, several in sorted(points.items())}
    ball = style[style.index("mass") + 1] == "ball" if "mass" in style else False
    contacts = {kind: contact(laws[kind], mass / 2 if kind == 1 and not ball else mass) for kind in (1, *fixed)}
    check_printed(log, text, contacts)
    weight = next(words for words in done if words[0] == "fix" and words[3] == "gravity")
    reach = next(words for words in done if words[0] == "neighbor")
    dt = float(re.findall(r"^SCENE dt (\S+)", text, re.MULTILINE)[0])
    return Scene(diameter, mass / (math.pi / 6 * diameter ** 3), moving, fixed, contacts, dt, float(reach[1]),
                 float(weight[4]))


def contact(words, mass):
    """A Contact from the words of pair_coeff after the types; mass (kg) is that of the conversion of restitution."""
    sizes = {"stiffness": 2, "damping": 2, "restitution": 1, "friction": 1, "rolling": 1, "rolling_spring": 2}
    found = {}
    while words and words[0] in sizes:
        n = sizes[words[0]]
        found[words[0]] = [float(word) for word in words[1:1 + n]]
        words = words[1 + n:]
    kn, kt = found["stiffness"]
    if "damping" in found:
        cn, ct = found["damping"]
    else:
        logarithm = math.log(found["restitution"][0])
        zeta = -logarithm / math.hypot(math.pi, logarithm)
        cn, ct = (2 * zeta * math.sqrt(k * mass) for k in (kn, kt))
    return Contact(kn, kt, cn, ct, *found.get("friction", [0.0]), *found.get("rolling", [0.0]),
                   *found.get("rolling_spring", ()))


def check_printed(log, text, contacts):
    """Raise SlopeError unless the start-up table of the run has these coefficients."""
    for kind, c in contacts.items():
        row = re.search(rf"^ +1 +{kind} +(\S+) +(\S+) +(\S+) ", text, re.MULTILINE)
        if kind == 1 and not row:
            continue        # a single ball: no two that could touch
        printed = [float(value) for value in row.groups()] if row else None
        if printed is None or not np.allclose(printed, (c.kn, c.kt, c.cn), rtol=1e-3):
            raise SlopeError(log, f"must print kn, kt, cn of types 1 {kind} as {c.kn:g}, {c.kt:g}, {c.cn:g}", printed)


# --- the runs ---

class Work:
    """The codes that are there, their runs, and the comparisons."""

    def __init__(self, output, lmp, names, quick):
        self.output, self.lmp, self.quick = output, lmp, quick
        self.codes, self.checks, self.notes, self.versions, self.profiles = [], [], [], {}, {}
        self.seconds: Dict[str, float] = {}        # of processor time, by code
        self.about_collapse = self.about_table = self.about_laws = None
        for code in (*OURS, *(code for code in PEERS if code.name in names)):
            missing = code(lmp).missing()
            if missing:
                self.notes.append(f"{code.title}: skipped: {missing}")
            else:
                self.codes.append(code(lmp))
        self.title = {code.name: code.title for code in self.codes}

    def scene(self, name, deck, settings=None):
        self.say(f"{name}: numbers of {deck}")
        return scene_of(self.lmp, INPUTS / deck, settings or {}, self.folder(f"{name}.deck"))

    def folder(self, name):
        folder = self.output / name
        folder.mkdir(exist_ok=True)
        return folder

    @staticmethod
    def say(what):
        print(f"slope crosscheck: {what}", file=sys.stderr, flush=True)

    def run(self, name, scene, steps, every=0, codes=None):
        """{code: (final state, series or None)} of a scene in all codes."""
        found = {}
        for code in codes or self.codes:
            self.say(f"{name}: {code.title}")
            folder = self.folder(f"{name}.{code.name}")
            code.write(scene, folder, steps, every)
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            result = peer_runs.run(code, folder)
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            self.seconds[code.name] = self.seconds.get(code.name, 0.0) + after.ru_utime - before.ru_utime
            self.versions[code.name] = result.version
            found[code.name] = result.final, code.series(folder) if every else None
        return found

    def twins(self, case, quantity, values, tolerance, reason):
        """Hold every peer against its twin; ours stands there for information."""
        for name, value in values.items():
            twin = TWIN.get(name)
            bound = tolerance.get(name) if isinstance(tolerance, dict) else tolerance
            expected = values[twin] if twin else value
            self.checks.append(Check(case, quantity, name, value, self.title[twin] if twin else "", expected,
                                     bound if twin else None, reason if twin else ""))

    def theory(self, case, quantity, values, expected, tolerance, reason):
        """Hold every code against a closed form; expected may differ by code."""
        for name, value in values.items():
            self.checks.append(Check(case, quantity, name, value, "closed form",
                                     expected[name] if isinstance(expected, dict) else expected, tolerance, reason))


# --- the cases ---

def restitution(zeta, pulls):
    """e of a spring-dashpot impact that ends at zero overlap, or, if nothing pulls, at zero force (Schwager 2007)."""
    root = math.sqrt(1 - zeta ** 2)
    turn = math.pi if pulls else math.pi - math.atan2(2 * zeta * root, 1 - 2 * zeta ** 2)
    return math.exp(-zeta / root * turn)


def rebound(scene, final) -> np.ndarray:
    """Observed restitution of each ball from its energy in flight after the first bounce."""
    h1 = scene.moving[:, 2] - scene.diameter
    h2 = final[:, 2] - scene.diameter + final[:, 5] ** 2 / (2 * scene.gravity)
    return np.sqrt(h2 / h1)


def pulling(code):
    return code not in ("plain_limited", "yade")


def bounce(work, case):
    """A ball falls on a fixed one (inputs/01): small steps; steps of the rule, contacts beginning in all phases."""
    scene = work.scene(case, "01_restitution/in.restitution")
    c = scene.contacts[2]
    zeta = c.cn / (2 * math.sqrt(c.kn * scene.mass))
    fall = math.sqrt(2 * (scene.moving[0, 2] - scene.diameter) / scene.gravity)
    expected = {code.name: restitution(zeta, pulling(code.name)) for code in work.codes}
    found = work.run(case, scene, math.ceil(1.02 * fall / scene.dt))
    values = {name: float(rebound(scene, final)[0]) for name, (final, _) in found.items()}
    work.theory(case, "restitution, dt of the deck", values, expected, 0.003,
                "336 steps in a contact: velocities of half a step ago and the ball's weight change e by 0.002")

    # several columns far apart, each ball a part of a step later on its fixed ball than the one before
    n, dt = DROPS, 0.25 * math.sqrt(scene.mass / c.kn)
    speed = scene.gravity * fall
    moving = np.repeat(scene.moving[:1], n, axis=0)
    moving[:, 0] += 10 * scene.diameter * np.arange(n)
    moving[:, 2] += speed * dt * np.arange(n) / n
    ground = np.repeat(scene.fixed[2][:1], n, axis=0)
    ground[:, 0] += 10 * scene.diameter * np.arange(n)
    many = scene._replace(moving=moving, fixed={2: ground}, dt=dt)
    found = work.run(f"{case}_rule", many, math.ceil(1.02 * fall / dt))
    every = {name: rebound(many, final) for name, (final, _) in found.items()}
    mean = {name: float(value.mean()) for name, value in every.items()}
    spread = {name: float(np.ptp(value)) for name, value in every.items()}
    reason = ("velocity Verlet with the same half-step velocities gives the same bounce, drop by drop; leapfrog may "
              "differ in the step in which the contact begins")
    work.twins(case, "restitution, dt of the rule, mean", mean, {"granular": 0.002, "liggghts": 0.002, "yade": 0.01},
               reason)
    work.twins(case, "restitution, dt of the rule, spread", spread,
               {"granular": 0.004, "liggghts": 0.004, "yade": 0.02}, reason)


def path_and_rotation(scene, series, every):
    """Of one ball on a fixed ball at the origin: its way on its circle (m), its rotation (rad)."""
    states = series[:, 0]
    angle = np.arctan2(states[:, 0], states[:, 2])
    start = math.atan2(scene.moving[0, 0], scene.moving[0, 2])
    spin = states[:, 7]
    return (scene.diameter * float(angle[-1] - start),
            float(((spin[1:] + spin[:-1]) / 2).sum() * every * scene.dt))


def slide_roll(work, case):
    """A ball on a fixed one, contact at 30 degrees (inputs/03): without friction, and with 10 degrees."""
    for theta, share in ((0, 1.0), (10, 5 / 7)):
        name = f"{case}_{theta}"
        scene = work.scene(name, "03_slide_roll/in.slide_roll", {"theta": theta})
        steps, every = round(0.02 / scene.dt), 100
        expected = share * 0.5 * scene.gravity * math.sin(math.radians(30)) * 0.02 ** 2
        found = {code: path_and_rotation(scene, series, every)
                 for code, (_, series) in work.run(name, scene, steps, every).items()}
        what = f"friction {theta} degrees"
        work.theory(case, f"path m, {what}", {code: path for code, (path, _) in found.items()}, expected,
                    0.01 * expected, "1 %: the contact gets steeper on the way (0.5 %), not so in the formula")
        work.theory(case, f"rotation rad, {what}", {code: turn for code, (_, turn) in found.items()},
                    expected / (scene.diameter / 2) if theta else 0.0, 0.01 * expected / (scene.diameter / 2), "1 %")


def rolling(work, case):
    """The paper's three cases of rolling resistance (inputs/04): verdict after 0.2 s, by the deck's own limits."""
    for friction, mu, expected in ((31, 0.58, "stays still"), (29, 0.58, "slides without rotating"),
                                   (31, 0.56, "rotates without sliding")):
        name = f"{case}_{friction}_{mu}"
        scene = work.scene(name, "04_rolling_resistance/in.rolling_resistance", {"friction": friction, "rolling": mu})
        steps, every = round(0.2 / scene.dt), 100
        verdicts = {}
        for code, (_, series) in work.run(name, scene, steps, every).items():
            path, turn = path_and_rotation(scene, series, every)
            slides = abs(path - scene.diameter / 2 * turn) > 0.0005 * scene.diameter
            rotates = abs(turn) > 1e-3
            verdicts[code] = VERDICTS[slides, rotates]
        # a torque that grows with the spin holds nothing: the ball rolls, and soon where friction cannot hold it either
        work.theory(case, f"friction {friction} degrees, mu_r {mu:g}", verdicts,
                    {code: "slides and rotates" if code == "yade" else expected for code in verdicts}, 0.0,
                    "the paper's Table 3; YADE's rolling torque has no threshold")


def collapse(work, case):
    """The embankment (inputs/20) with coarse balls: the deposit after 15 s.

    It is chaotic: ours runs four times, from starts that are the same to NOISE. LIGGGHTS and YADE have another law of
    rolling: their deposit must lie within what ours gives with none and with twice the rolling resistance.
    """
    d, duration = 4.0 if work.quick else 2.5, 15.0
    settings = {"rule": "ours", "d": d, "rolling": 0.05}
    scene = work.scene(case, "20_embankment/in.embankment", settings)._replace(headroom=30.0)
    steps = round(duration / scene.dt)
    ours = work.codes[:1]
    found = {name: final for name, (final, _) in work.run(case, scene, steps).items()}
    rng = np.random.default_rng(20)
    several = [deposit(scene, found["slope"])]
    for i in range(3):
        moving = scene.moving.copy()
        moving[:, :3] += NOISE * scene.diameter * rng.uniform(-1, 1, (len(moving), 3))
        final, _ = work.run(f"{case}_start{i}", scene._replace(moving=moving), steps, codes=ours)["slope"]
        several.append(deposit(scene, final))
    range_ = []
    for factor in (0, 2):
        laws = {kind: c._replace(rolling=factor * c.rolling) for kind, c in scene.contacts.items()}
        final, _ = work.run(f"{case}_rolling{factor}", scene._replace(contacts=laws), steps, codes=ours)["slope"]
        range_.append(deposit(scene, final))
    work.profiles = {name: profile(scene, final) for name, final in found.items()}
    work.about_collapse = {"d": d, "balls": len(scene.moving), "fixed": len(scene.ground), "seconds": duration,
                           "ours": several, "ours_without_and_with_twice_the_rolling_resistance": range_}
    chance = {"run-out m": 0.10, "displacement of the centroid m": 0.03,
              "volume on the road m3": 0.30 if work.quick else 0.15}
    for quantity, share in chance.items():
        middle = float(np.mean([one[quantity] for one in several]))
        low, high = (pick(middle, *(one[quantity] for one in range_)) for pick in (min, max))
        for name, final in found.items():
            value = deposit(scene, final)[quantity]
            if name == "slope":
                check: Tuple = ("SLOPE, mean of 4", middle, None, "")
            elif name in OTHER_ROLLING:
                check = ("SLOPE, mu_r 0 to 0.1", (low + high) / 2, (high - low) / 2 + share * middle,
                         f"another law of rolling: the range of ours, and {100 * share:.0f} % for chance")
            else:
                check = ("SLOPE, mean of 4", middle, share * middle,
                         f"{100 * share:.0f} % for chance, {len(scene.moving)} balls")
            work.checks.append(Check(case, quantity, name, value, *check))


def deposit(scene, final):
    """Run-out, displacement of the centroid, volume on the road: from the centres of the balls."""
    road = road_corners()
    (xlo, ylo), (xhi, yhi) = road.min(axis=0), road.max(axis=0)     # a rectangle
    top = scene.moving[np.argmax(scene.moving[:, 2]), :2]
    x, y = final[:, 0], final[:, 1]
    on = (x >= xlo) & (x <= xhi) & (y >= ylo) & (y <= yhi)
    ball = BULK * math.pi / 6 * scene.diameter ** 3
    return {"run-out m": float(np.percentile(np.hypot(x - top[0], y - top[1]), 99)),
            "displacement of the centroid m": float(np.hypot(*(final[:, :2].mean(0) - scene.moving[:, :2].mean(0)))),
            "volume on the road m3": float(on.sum() * ball)}


def road_corners():
    return np.loadtxt(INPUTS / "20_embankment" / "road.csv", delimiter=",")


def profile(scene, final):
    """Volume of ground per metre along x (m3/m): edges, values."""
    edges = np.arange(0, 200.1, 5.0)
    count, _ = np.histogram(final[:, 0], edges)
    return edges.tolist(), (count * BULK * math.pi / 6 * scene.diameter ** 3 / 5.0).tolist()
