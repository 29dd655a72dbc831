"""One scene of balls, written for several codes: SLOPE, two pair styles of stock LAMMPS, LIGGGHTS, YADE.

A Code writes its input into a folder, tells the command, and reads back what its run left. Coefficients are those of
pair gran/restitution as its start-up table prints them; how a peer differs from it is said in `differs`.
"""
import math
import re
import shutil
from typing import Dict, NamedTuple, Optional, Sequence

import numpy as np

from slope_tools import disk
from slope_tools.errors import SlopeError
from .peer_runs import COLUMNS, DATA, DECK, FINAL, LOG, LOOP, SCREEN, SERIES, failure, read_dump, read_text

MANY = 100          # moving balls from which on the box follows them


class Contact(NamedTuple):
    """Coefficients of one pair of types: N/m, N s/m, degrees. cn and ct are the dashpots themselves."""
    kn: float
    kt: float
    cn: float
    ct: float
    friction: float
    rolling: float = 0.0
    kr: Optional[float] = None      # None: kt
    cr: Optional[float] = None      # None: ct


class Scene(NamedTuple):
    """Equal balls: moving ones, of type 1, and fixed ones of type 2, 3, ..."""
    diameter: float                     # m
    density: float                      # kg/m3
    moving: np.ndarray                  # one row per ball: position (m), velocity (m/s), spin (rad/s)
    fixed: Dict[int, np.ndarray]        # type -> positions, m
    contacts: Dict[int, Contact]        # type -> contact of a moving ball with one of that type
    dt: float                           # s
    skin: float                         # m, of the neighbour lists
    gravity: float = 9.80665            # m/s2, downwards
    headroom: float = 0.0               # m that a fixed box reaches beyond all balls

    @property
    def mass(self):
        return self.density * math.pi / 6 * self.diameter ** 3

    @property
    def ground(self):
        """Positions of all fixed balls."""
        return np.concatenate(list(self.fixed.values()))

    def box(self):
        """Corners of a box around all balls."""
        every = np.concatenate([self.moving[:, :3], self.ground])
        room = self.diameter + self.headroom
        return every.min(axis=0) - room, every.max(axis=0) + room


class Result(NamedTuple):
    """What a run of a scene left."""
    seconds: float                  # of the run loop alone
    version: str
    final: np.ndarray               # as Scene.moving, ordered by ball; a lost ball is missing
    breakdown: Dict[str, float]     # part of the loop -> s; empty if the code does not tell
    peak: int                       # bytes, largest resident memory of the process
    reported: Optional[float] = None    # bytes per rank that LAMMPS itself counts


# --- the codes ---

class Code:
    """A program that can run a scene."""
    name = title = ""
    is_lammps = True
    differs: Sequence[str] = ()     # sentences: in what its physics is not that of pair gran/restitution

    def __init__(self, lmp):
        self.lmp = lmp

    def missing(self):
        """What is not installed, None if all is there."""

    def program(self):
        return [str(self.lmp)]

    def command(self):
        return [*self.program(), "-in", DECK, "-log", LOG, "-screen", "none"]

    def write(self, scene, folder, steps, every=0):
        """Write the input: `steps` steps; every so many the balls go to the series (0: never)."""
        raise NotImplementedError

    def read(self, folder, peak):
        """The Result of a run; raises SlopeError if it did not end well."""
        text = read_text(folder / LOG)
        loop = re.findall(LOOP, text, re.MULTILINE)
        if not loop or not (folder / FINAL).is_file():
            raise SlopeError(folder / LOG, f"{self.title} did not end well", failure(text, folder))
        breakdown = {name: float(seconds) for name, seconds in
                     re.findall(r"^(Pair|Neigh|Comm|Output|Modify|Other) +\|[^|]*\| (\S+) +\|", text, re.MULTILINE)}
        memory = re.search(r"Per MPI rank memory allocation \(min/avg/max\) = \S+ \| \S+ \| (\S+) Mbytes", text)
        version = re.search(r"^(LAMMPS|LIGGGHTS) \((.*)\)", text, re.MULTILINE)
        return Result(float(loop[0][0]), version[2] if version else "unknown", read_dump(folder / FINAL)[-1],
                      breakdown, peak, float(memory[1]) * 2**20 if memory else None)

    def series(self, folder):
        """States at the steps 0, every, 2 every, ...: an array (step, ball, column)."""
        return np.array(read_dump(folder / SERIES))


class Slope(Code):
    """Pair gran/restitution; the fixed balls belong to fix wall/gran/balls."""
    name, title = "slope", "SLOPE"
    keywords = "mass pair"

    def write(self, scene, folder, steps, every=0):
        write_data(folder / DATA, scene, {})
        lines = ["suffix slope", "processors 1 * 1", *head(scene, "s s fs" if len(scene.moving) > MANY else "f f f"),
                 f"pair_style gran/restitution {self.keywords}"]
        for kind, c in scene.contacts.items():
            lines.append(f"pair_coeff 1 {kind} stiffness {c.kn!r} {c.kt!r} damping {c.cn!r} {c.ct!r} "
                         f"friction {c.friction!r} rolling {c.rolling!r} rolling_spring {spring(c)} {dashpot(c)}")
        for kind, points in scene.fixed.items():
            write_rows(folder / f"fixed.{kind}.xyz", points)
            lines.append(f"fix ground{kind} all wall/gran/balls {kind} {scene.diameter!r} file fixed.{kind}.xyz")
        lines += ["group soil type 1", *loading(scene)]
        if len(scene.moving) > MANY:
            lines += self.tuned(scene)
        disk.write_file(folder / DECK, "\n".join([*lines, *output(steps, every)]) + "\n")

    @staticmethod
    def tuned(scene):
        """As in inputs/20_embankment."""
        yield f"neigh_modify binsize {scene.diameter + scene.skin!r}"
        yield f"atom_modify sort 1000 {20 * scene.diameter!r}"
        yield "fix spread all balance 1000 1.01 shift xy 10 1.01"


class Build(Slope):
    """The same in another build of ours."""
    name, title = "build", "SLOPE, another build"


class Frozen(Code):
    """A pair style of stock LAMMPS in the same program; the fixed balls are frozen atoms."""

    def write(self, scene, folder, steps, every=0):
        write_data(folder / DATA, scene, scene.fixed)
        lines = ["newton off", *head(scene, "f f f"), *self.law(scene),
                 "group soil type 1", "group ground subtract all soil",
                 "neigh_modify exclude group ground ground", "fix ground ground freeze",
                 *loading(scene), *output(steps, every)]
        disk.write_file(folder / DECK, "\n".join(lines) + "\n")

    def law(self, scene):
        """The commands of the contact law."""
        raise NotImplementedError


class Granular(Frozen):
    name, title = "granular", "pair granular, rolling sds"
    differs = ("the dashpots see the velocity of half a step ago, so that restitution depends on where in a step a "
               "contact begins (scheme plain of ours)",
               "rolling sds measures with R/2: mu_r is doubled to give the same torque, spring and dashpot of rolling "
               "are multiplied by 4")

    def law(self, scene):
        yield "pair_style granular"
        for kind, c in scene.contacts.items():
            yield (f"pair_coeff 1 {kind} hooke {c.kn!r} {c.cn!r} damping velocity tangential linear_history {c.kt!r} "
                   f"{c.ct / c.cn if c.cn else 0.0!r} {friction(c)} "
                   f"rolling sds {4 * spring(c)!r} {4 * dashpot(c)!r} {2 * c.rolling!r}")
        if len(scene.contacts) > 1:     # never used: they do not touch
            yield "pair_coeff 2* 2* hooke 1 0 damping velocity tangential linear_history 1 0 0"


class Hooke(Frozen):
    name, title = "hooke", "gran/hooke/history, no rolling"
    differs = ("one set of coefficients for all pairs, that of two moving balls: the slip surface has their friction, "
               "the field their dashpots",
               "the dashpot grows with the mass of the contact: on a fixed ball it is twice that of two moving ones",
               "no rolling resistance; dashpots see the velocity of half a step ago")

    def law(self, scene):
        c = scene.contacts[1]
        yield (f"pair_style gran/hooke/history {c.kn!r} {c.kt!r} {2 * c.cn / scene.mass!r} {2 * c.ct / scene.mass!r} "
               f"{friction(c)} 1")
        yield "pair_coeff * *"


class Liggghts(Code):
    name, title = "liggghts", "LIGGGHTS, epsd2"
    is_lammps = False
    differs = ("epsd2 measures with R/2: mu_r is doubled to give the same torque; its spring is kt R^2/4, a quarter of "
               "ours, and has no dashpot",
               "the tangential dashpot is not limited by friction, and none acts on a sliding contact",
               "torques act at the middle of the overlap; dashpots see the velocity of half a step ago")

    def missing(self):
        return None if shutil.which("liggghts") else "liggghts is not on the PATH (Debian package liggghts)"

    def program(self):
        return ["liggghts"]

    def write(self, scene, folder, steps, every=0):
        write_data(folder / DATA, scene, scene.fixed)
        kinds = list(scene.contacts)

        def matrix(value):
            return " ".join(repr(value(scene.contacts[max(i, j)])) for i in kinds for j in kinds)

        properties = {"kn": lambda c: c.kn, "kt": lambda c: c.kt, "gamman_abs": lambda c: c.cn,
                      "gammat_abs": lambda c: c.ct, "coefficientFriction": friction,
                      "coefficientRollingFriction": lambda c: 2 * c.rolling}
        lines = ["newton off", *(line.replace("comm_modify vel", "communicate single vel").replace(
                     "atom_style sphere", "atom_style granular") for line in head(scene, "f f f")),
                 *(f"fix {name} all property/global {name} peratomtypepair {len(kinds)} {matrix(value)}"
                   for name, value in properties.items()),
                 "pair_style gran model hooke/stiffness tangential history rolling_friction epsd2 "
                 "tangential_damping on absolute_damping on limitForce off",
                 "pair_coeff * *", "group soil type 1", "group ground subtract all soil",
                 "neigh_modify exclude group ground ground", "fix ground ground freeze",
                 *loading(scene), *output(steps, every, "format \"%d" + 9 * " %.12g" + "\"")]
        disk.write_file(folder / DECK, "\n".join(lines) + "\n")


YADE = """\
# Written by SLOPE for YADE: ViscElPhys, fixed bodies non-dynamic
import math, time
import numpy as np
from yade import *

moving = np.loadtxt("moving.txt", ndmin=2)
R, DENSITY, STEPS, EVERY = {radius!r}, {density!r}, {steps}, {every}
# a contact has a b/(a + b) of the values a, b of its two materials, and the smaller friction
MATERIALS = {materials!r}
stuff = {{kind: O.materials.append(ViscElMat(density=DENSITY, **values)) for kind, values in MATERIALS.items()}}
ids = []
for row in moving:
    body = sphere(row[:3], R, material=stuff[1], mask=1)
    body.state.vel = Vector3(*row[3:6])
    body.state.angVel = Vector3(*row[6:9])
    body.state.angMom = body.state.inertia[0] * body.state.angVel
    ids.append(O.bodies.append(body))
for kind in sorted(MATERIALS):
    if kind > 1:
        for row in np.loadtxt("fixed.%d.xyz" % kind, ndmin=2):
            O.bodies.append(sphere(row, R, material=stuff[kind], fixed=True, mask=3))

def state():
    return np.array([[*body.state.pos, *body.state.vel, *body.state.angVel] for body in (O.bodies[i] for i in ids)])

series = []
O.engines = [
    ForceResetter(),
    InsertionSortCollider([Bo1_Sphere_Aabb()], avoidSelfInteractionMask=2,
                          verletDist={reach!r}, targetInterv=0),
    InteractionLoop([Ig2_Sphere_Sphere_ScGeom()], [Ip2_ViscElMat_ViscElMat_ViscElPhys()],
                    [Law2_ScGeom_ViscElPhys_Basic()]),
    NewtonIntegrator(damping=0, gravity=(0, 0, -{gravity!r})),
] + ([PyRunner(command="series.append(state())", iterPeriod=EVERY)] if EVERY else [])
O.dt = {dt!r}
O.run(1, True)      # sorts all bodies; the other codes do that before their clock starts
began = time.perf_counter()
O.run(STEPS - 1, True)
seconds = (time.perf_counter() - began) * STEPS / (STEPS - 1)
np.savetxt("final.txt", state())
if EVERY:
    np.save("series.npy", np.array(series + [state()]))
from yade import config
print("SLOPE-YADE", config.version.strip(), seconds, flush=True)
"""


class Yade(Code):
    name, title = "yade", "YADE, ViscElPhys"
    is_lammps = False
    differs = ("the normal force never pulls (our limit_damping yes)",
               "the rolling torque grows with the spin, to mu_r R Fn, the limit of ours, at 1 rad/s: no threshold",
               "leapfrog: velocities are those of half a step ago; torques act at the middle of the overlap")

    def missing(self):
        return None if shutil.which("yade") else "yade is not on the PATH (Debian package yade)"

    def command(self):
        return ["yade", "-n", "-x", "-j1", "scene.py"]

    def write(self, scene, folder, steps, every=0):
        first = scene.contacts[1]
        materials = {}
        for kind, c in scene.contacts.items():
            materials[kind] = {
                **{name: partner(getattr(first, of), getattr(c, of))
                   for name, of in (("kn", "kn"), ("ks", "kt"), ("cn", "cn"), ("cs", "ct"))},
                "frictionAngle": math.radians(c.friction), "mRtype": 1,
                "mR": 0.5 * scene.diameter * c.rolling}
            if kind > 1 and c.friction > first.friction:
                raise SlopeError("YADE", "takes the smaller friction of two materials: that of a fixed ball must not "
                                 "be above that of the moving balls", c.friction)
        write_rows(folder / "moving.txt", scene.moving)
        for kind, points in scene.fixed.items():
            write_rows(folder / f"fixed.{kind}.xyz", points)
        disk.write_file(folder / "scene.py", YADE.format(
            radius=scene.diameter / 2, density=scene.density, steps=steps, every=every, materials=materials,
            reach=scene.skin / 2, gravity=scene.gravity, dt=scene.dt))

    def read(self, folder, peak):
        text = read_text(folder / SCREEN)
        timing = re.search(r"^SLOPE-YADE (\S+) (\S+)$", text, re.MULTILINE)
        if not timing:
            raise SlopeError(folder / SCREEN, f"{self.title} did not end well", failure(text, folder))
        return Result(float(timing[2]), timing[1], np.loadtxt(folder / FINAL, ndmin=2), {}, peak)

    def series(self, folder):
        return np.load(folder / "series.npy")


ALL = (Slope, Build, Granular, Hooke, Liggghts, Yade)


# --- pieces of the inputs ---

def friction(contact):
    return math.tan(math.radians(contact.friction))


def spring(contact):
    return contact.kt if contact.kr is None else contact.kr


def dashpot(contact):
    return contact.ct if contact.cr is None else contact.cr


def partner(own, wanted):
    """The value b of a material such that a b/(a + b) is `wanted`, where a b/(a + b) of two moving balls is `own`."""
    a = 2 * own
    return a if wanted == own else a * wanted / (a - wanted) if a != wanted else 1e30


def head(scene, boundary):
    return ["units si", "atom_style sphere", f"boundary {boundary}", "comm_modify vel yes", f"read_data {DATA}",
            f"neighbor {scene.skin!r} bin", "neigh_modify every 1 delay 0 check yes", f"timestep {scene.dt!r}"]


def loading(scene):
    return ["fix move soil nve/sphere", f"fix weight soil gravity {scene.gravity!r} vector 0 0 -1",
            "thermo 1000000", "thermo_modify lost ignore"]


def output(steps, every, form="format float %.12g"):
    """The run, and the final state by balls."""
    lines = []
    if every:
        lines = [f"dump series soil custom {every} {SERIES} id {COLUMNS}", f"dump_modify series sort id {form}"]
    return [*lines, f"run {steps}", f"write_dump soil custom {FINAL} id {COLUMNS} modify sort id {form}"]


def write_data(path, scene, fixed):
    """A LAMMPS data file of the moving balls and of those of `fixed`; LIGGGHTS reads it too."""
    low, high = scene.box()
    points = [scene.moving[:, :3], *fixed.values()]
    kinds = np.repeat([1, *fixed], [len(part) for part in points])
    every = np.concatenate(points)
    lines = ["SLOPE scene", "", f"{len(every)} atoms", f"{len(scene.contacts)} atom types", ""]
    lines += [f"{a!r} {b!r} {axis}lo {axis}hi" for a, b, axis in zip(low.tolist(), high.tolist(), "xyz")]
    lines += ["", "Atoms", ""]
    lines += [f"{i} {kind} {scene.diameter!r} {scene.density!r} {x:.12g} {y:.12g} {z:.12g}"
              for i, (kind, (x, y, z)) in enumerate(zip(kinds.tolist(), every.tolist()), 1)]
    lines += ["", "Velocities", ""]
    still = np.zeros((len(every) - len(scene.moving), 6))
    lines += [f"{i} " + " ".join(f"{value:.12g}" for value in row)
              for i, row in enumerate(np.concatenate([scene.moving[:, 3:], still]).tolist(), 1)]
    disk.write_file(path, "\n".join(lines) + "\n")


def write_rows(path, rows):
    disk.write_file(path, "".join(" ".join(f"{value:.12g}" for value in row) + "\n" for row in rows.tolist()))


def chosen(option, text, known):
    """The words of an option that names some of the known ones; all without it."""
    words = text.split(",") if text else list(known)
    for word in words:
        if word not in known:
            raise SlopeError(option, f"must be of {', '.join(known)}", word)
    return words
