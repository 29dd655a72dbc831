"""slope bench: how fast a collapse runs, against the codes that are installed, and how that scales.

Order of the work: make the scene (a collapse, run until the mass is dense and moves), run each part of the benchmark in
alternation, evaluate (medians of the ratios of neighbouring runs), write.
"""
import argparse
import csv
import io
import math
import os
import shutil
import sys
from pathlib import Path
from statistics import median
from typing import NamedTuple

import numpy as np
import yaml
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table

from . import jobs, peers, runs
from .cli import number
from .errors import SlopeError
from .peers import Contact, Scene
from .programs import lmp_of_each
from .study import count

PARTS = {"peers": "against the other codes, one core",
         "terrain": "terrain ten times larger, the same moving mass",
         "ranks": "MPI ranks against one",
         "throughput": "two single-rank runs side by side against one",
         "weak": "many copies of the scene: 1e6 moving balls"}

# balls of 1.25 m on an embankment such as that of inputs/20_embankment, coefficients of the paper's Table 4
D, DENSITY, KN, C_SOIL, C_FIELD = 1.25, 3411.4, 1.96e9, 1.19e6, 3.09e6
FRICTION, ROLLING = 30.0, 0.05
BALLS = 21000
TOE, SHOULDER, RISE, DEPTH, MIDDLE = 84.0, 156.0, 36.0, 18.0, 80.0      # m; see its deck
WEST, EAST, SOUTH, NORTH = 22.0, 222.0, 5.0, 155.0      # edges of the terrain, m
PREPARED = 2.0          # s of collapse before the clock starts
SKIN = 0.2              # of the neighbour lists, diameters
LARGER = 10.0           # terrain of the part terrain
MANY = 1_000_000        # moving balls of the part weak

TARGETS = {"build": (">=", 0.95), "granular": (">=", 4.0), "hooke": (">=", 2.5), "liggghts": (">=", 4.0),
           "yade": (">=", 25.0), "terrain_time": ("<=", 1.05), "terrain_bytes": ("<=", 60.0), "ranks_2": (">=", 1.85),
           "rest_2": (">=", 1.85), "throughput": (">=", 1.9), "weak_time": ("<=", 1.3), "weak_time_2": ("<=", 1.3)}
CASE = Path(__file__).resolve().parents[2] / "inputs" / "20_embankment" / "in.embankment"
BUSY = 0.5              # load of the machine, from which on the numbers are doubtful
SAME_ENERGY, SAME_WAY = 0.05, 0.02      # peers with the same coefficients: kinetic energy, way of the centroid
LOOSE = {"hooke": 10.0}                 # times that for a peer without a smooth slip surface

EPILOG = """\
units: metres, seconds, bytes; time per ball and step in ns.

example: a first look in two minutes; all of it on a machine with nothing else to do; one part, four ranks too:
  tools/slope bench --quick
  tools/slope bench -o bench
  tools/slope bench --only ranks --np 2,4 -o ranks

Writes DIR/bench.csv (every run), DIR/bench.yaml, DIR/bench.png, and the input of every code in a folder of its own.
"""


class Run(NamedTuple):
    """One timed run."""
    part: str
    code: str
    ranks: int
    moving: int
    fixed: int
    steps: int
    result: peers.Result

    @property
    def per_ball(self):
        """s per moving ball and step."""
        return self.result.seconds / self.moving / self.steps


def add_parser(commands, **kwargs):
    """Add `bench` and its arguments to argparse's commands; return its parser."""
    parser = commands.add_parser(
        "bench", formatter_class=argparse.RawDescriptionHelpFormatter, epilog=EPILOG,
        description="How fast a collapse runs: against other codes, on larger terrains, on ranks, with more balls.",
        **kwargs)
    parser.add_argument("--quick", action="store_true",
                        help="a small scene, few steps and repeats, without 1e6 balls and runs to rest; two minutes")
    parser.add_argument("--balls", type=count, metavar="N", help=f"moving balls, about (default {BALLS}; --quick 8000)")
    parser.add_argument("--field-factor", type=number, default=1.0, metavar="F",
                        help="area of the terrain, times that of the scene (default 1: about 27,000 fixed balls)")
    parser.add_argument("--steps", type=count, metavar="N", help="timed steps of a run (default 1000; --quick 300)")
    parser.add_argument("--repeat", type=count, metavar="N", help="runs of each kind (default 5; --quick 3)")
    parser.add_argument("--np", default="2", metavar="N1,N2,...",
                        help="ranks of the parts ranks and weak, besides one (default 2)")
    parser.add_argument("--only", metavar="PART,...", help=f"these parts: {', '.join(PARTS)} (default all)")
    parser.add_argument("--peers", metavar="CODE,...",
                        help="these codes: " + ", ".join(code.name for code in peers.ALL[1:])
                        + " (default all; build: the one of --lmp build=FILE)")
    parser.add_argument("--lmp", metavar="[CODE=]FILE", action="append",
                        help="the LAMMPS program (default: LMP of the environment, then build/lmp beside tools/); "
                        "with CODE= that of one code: granular, hooke, or build for another build of ours")
    parser.add_argument("-o", dest="output", metavar="DIR", type=Path, default=Path("bench"),
                        help="folder of the results (default bench)")
    return parser


def run(args):
    """Do the command; raises SlopeError on bad input. Prints the tables."""
    if args.field_factor < 1:
        raise SlopeError("--field-factor", "must be >= 1", f"{args.field_factor:g}")
    parts = peers.chosen("--only", args.only, PARTS)
    lmp, programs = lmp_of_each(args.lmp, [code.name for code in peers.ALL[1:] if code.is_lammps])
    names = peers.chosen("--peers", args.peers, [code.name for code in peers.ALL[1:]
                                                 if code is not peers.Build or code.name in programs])
    ranks = [rank for rank in whole_numbers("--np", args.np) if rank > 1]
    if ranks and {"ranks", "weak"} & set(parts) and not shutil.which("mpirun"):
        raise SlopeError("--np", "needs mpirun, which is not on the PATH", args.np)
    balls = args.balls or (8000 if args.quick else BALLS)
    if balls < 100:
        raise SlopeError("--balls", "must be >= 100", balls)
    if args.output.exists() and not args.output.is_dir():
        raise SlopeError("-o", "must be a folder", args.output)
    plan = Plan(args.output, lmp, programs, args.steps or (300 if args.quick else 1000),
                args.repeat or (3 if args.quick else 5), balls, args.field_factor, args.quick)
    try:
        args.output.mkdir(parents=True, exist_ok=True)
        with jobs.alone_in(args.output), jobs.signals_interrupt(), plan:
            plan.do(parts, names, ranks)
    except OSError as error:
        raise SlopeError(error.filename or args.output, f"cannot be used: {error.strerror}") from error


def whole_numbers(option, text):
    try:
        return [count(word) for word in text.split(",")]
    except argparse.ArgumentTypeError as error:
        raise SlopeError(option, str(error)) from error


# --- the scene ---

def terrain(size, factor):
    """Rows from the north, x and y of the south-west corner, cell: the embankment, `size` times as large."""
    cell = 2.5
    centre = np.array([(WEST + EAST) / 2, (SOUTH + NORTH) / 2])
    half = np.array([EAST - WEST, NORTH - SOUTH]) / 2 * math.sqrt(factor)
    low, high = (np.floor(size * edge / cell).astype(int) for edge in (centre - half, centre + half))
    x, y = ((np.arange(a, b) + 0.5) * cell / size for a, b in zip(low, high))
    profile = np.interp(x, [0, 50, 60, 80, TOE, SHOULDER, 240], [-4, -1.5, 0, 0, 0, RISE, RISE + 1])
    aside = np.clip(np.abs(y[::-1] - MIDDLE) - 45, 0, None)
    share = np.clip((x - TOE) / (SHOULDER - TOE), 0, 1)
    return size * (profile + 0.15 * aside[:, None] * share), low * cell, cell


def write_terrain(path, size, factor):
    z, (x, y), cell = terrain(size, factor)
    runs.write(path, f"ncols {z.shape[1]}\nnrows {z.shape[0]}\nxllcorner {x:g}\nyllcorner {y:g}\ncellsize {cell:g}\n"
               "NODATA_value -9999\n" + "".join(" ".join(f"{value:.3f}" for value in row) + "\n" for row in z.tolist()))


def contacts():
    return {1: Contact(KN, KN, C_SOIL, C_SOIL, FRICTION, ROLLING), 2: Contact(KN, KN, C_SOIL, C_SOIL, 0.0),
            3: Contact(KN, KN, C_FIELD, C_FIELD, FRICTION, ROLLING)}


def time_step():
    return 0.25 * math.sqrt(DENSITY * math.pi / 6 * D ** 3 / KN)


def collapse(size, steps):
    """The deck that lets the mass go and runs it for some steps."""
    chord = math.hypot(SHOULDER - TOE, RISE)
    radius = (chord ** 2 / 4 + DEPTH ** 2) / (2 * DEPTH)
    sphere = " ".join(repr(size * value) for value in (
        (TOE + SHOULDER) / 2 - (radius - DEPTH) * RISE / chord, MIDDLE,
        RISE / 2 + (radius - DEPTH) * (SHOULDER - TOE) / chord, radius))
    laws = "\n".join(f"pair_coeff 1 {kind} stiffness {c.kn!r} {c.kt!r} damping {c.cn!r} {c.ct!r} "
                     f"friction {c.friction!r} rolling {c.rolling!r}" for kind, c in contacts().items())
    return f"""\
# the scene of slope bench: a collapse that runs until the mass is dense and moves
units si
atom_style sphere
boundary s s fs
comm_modify vel yes
region ground terrain terrain.asc depth {20 * size!r} headroom {20 * size!r}
region sphere sphere {sphere} units box
region around sphere {sphere} units box side out
region slip intersect 2 ground sphere
create_box 3 ground
lattice sc {D!r}
create_atoms 1 region slip
group soil type 1
set group soil diameter {D!r} density {DENSITY!r}
pair_style gran/restitution
{laws}
fix slip soil wall/gran/balls 2 {D!r} surface slip lower spacing {D / 2!r} write fixed.2.xyz
fix field soil wall/gran/balls 3 {D!r} surface ground upper spacing {D!r} outside slip write fixed.3.xyz
delete_balls soil overlap 0.0
neighbor {SKIN * D!r} bin
neigh_modify every 1 delay 0 check yes
timestep {time_step()!r}
fix move soil nve/sphere
fix weight soil gravity 9.80665 vector 0 0 -1
thermo 1000
thermo_modify lost ignore flush yes
""" + "\n".join(peers.output(steps, 0)) + "\n"


def copies(scene, n, ground):
    """The scene n times, side by side along y, each on its own ground of that width (m)."""
    shifts = ground * np.arange(n)[:, None, None] * np.array([0.0, 1.0, 0.0])
    moving = np.tile(scene.moving, (n, 1, 1))
    moving[:, :, :3] += shifts
    return scene._replace(moving=moving.reshape(-1, 9),
                          fixed={kind: (points + shifts).reshape(-1, 3) for kind, points in scene.fixed.items()})


# --- the runs ---

class Plan:
    """All runs of a benchmark, and what came of them."""

    def __init__(self, output, lmp, programs, steps, repeat, balls, factor, quick):
        self.output, self.lmp, self.steps, self.repeat = output, lmp, steps, repeat
        self.size = (balls / BALLS) ** (1 / 3)
        self.factor, self.quick = factor, quick
        self.ours = peers.Slope(lmp)
        self.programs = programs    # of codes that have one of their own
        self.runs, self.values, self.notes, self.cases = [], {}, [], []
        self.states, self.versions = {}, {}
        self.live = sys.stderr.isatty()
        # without auto_refresh there is no thread, which would take time from the runs
        self.bar = Progress(TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn(),
                            console=Console(stderr=True), transient=True, auto_refresh=False)

    def __enter__(self):
        if self.live:
            self.bar.start()
        self.task = self.bar.add_task("setting up", total=None)
        return self

    def __exit__(self, *_):
        if self.live:
            self.bar.stop()

    def say(self, what):
        self.bar.update(self.task, description=what, refresh=self.live)
        if not self.live:
            print(f"slope bench: {what}", file=sys.stderr, flush=True)

    def do(self, parts, names, ranks):
        load = os.getloadavg()[0]
        if load > BUSY:
            self.notes.append(f"the machine was busy: load {load:.1f} in the minute before")
        self.scene = self.prepare("scene", self.factor, round(PREPARED * math.sqrt(self.size) / time_step()))
        self.bar.update(self.task, completed=0, total=self.expected(parts, names, ranks))
        if "peers" in parts:
            self.peers(names)
        if "terrain" in parts:
            self.terrain()
        if "ranks" in parts:
            self.ranks(ranks)
        if "throughput" in parts:
            self.throughput()
        if "weak" in parts and not self.quick:
            self.weak(ranks)
        report(self)

    def expected(self, parts, names, ranks):
        """Number of timed runs, at most."""
        each = {"peers": 2 * len(names) * self.repeat, "terrain": 4 * self.repeat, "throughput": 3 * self.repeat,
                "ranks": len(ranks) * self.repeat * (2 if self.quick else 4),
                "weak": 0 if self.quick else 2 * (1 + len(ranks)) * self.repeat}
        return sum(each[part] for part in parts)

    def prepare(self, name, factor, steps):
        """Let the mass go and run it; the scene that it has become."""
        self.say(f"making the {name}")
        folder = self.folder(name)
        write_terrain(folder / "terrain.asc", self.size, factor)
        runs.write(folder / peers.DECK, collapse(self.size, steps))
        result = peers.run(self.ours, folder)
        self.versions["slope"] = f"LAMMPS {result.version}"
        fixed = {kind: np.loadtxt(folder / f"fixed.{kind}.xyz") for kind in (2, 3)}
        return Scene(D, DENSITY, result.final, fixed, contacts(), time_step(), SKIN * D)

    def folder(self, name):
        folder = self.output / name
        folder.mkdir(exist_ok=True)
        return folder

    def measure(self, part, code, folder, scene, steps, ranks=1):
        """A timed run of a scene that is written in a folder."""
        self.say(f"{part}: {code.title}" + (f", {ranks} ranks" if ranks > 1 else "")
                 + f", {len(scene.moving):,} moving balls")
        result = peers.run(code, folder, ranks)
        return self.keep(part, code, scene, steps, ranks, result)

    def keep(self, part, code, scene, steps, ranks, result):
        one = Run(part, code.name, ranks, len(scene.moving), len(scene.ground), steps, result)
        self.runs.append(one)
        self.bar.update(self.task, advance=1, refresh=self.live)
        return one

    def write(self, code, name, scene, steps):
        folder = self.folder(name)
        code.write(scene, folder, steps)
        return folder

    # --- parts ---

    def peers(self, names):
        """Ours, a peer, ours, the next peer, and so on: the ratios of neighbouring runs."""
        codes = []
        for code in peers.ALL[1:]:
            if code.name in names:
                one = code(self.programs.get(code.name, self.lmp))
                missing = one.missing()
                if missing:
                    self.notes.append(f"{code.title}: not measured: {missing}")
                else:
                    codes.append(one)
        ours = self.write(self.ours, "slope", self.scene, self.steps)
        folders = {code.name: self.write(code, code.name, self.scene, self.steps) for code in codes}
        ratios = {code.name: [] for code in codes}
        for _ in range(self.repeat):
            for code in codes:
                mine = self.measure("peers", self.ours, ours, self.scene, self.steps)
                theirs = self.measure("peers", code, folders[code.name], self.scene, self.steps)
                ratios[code.name].append(theirs.result.seconds / mine.result.seconds)
                self.states["slope"], self.states[code.name] = mine.result.final, theirs.result.final
                self.versions[code.name] = theirs.result.version
        for code in codes:
            self.set(code.name, f"time of {code.title} / ours", ratios[code.name])
        if not codes:
            self.notes.append("no other code to measure against")
            self.measure("peers", self.ours, ours, self.scene, self.steps)

    def terrain(self):
        """The same mass on a larger terrain."""
        wide = self.prepare("wide terrain", self.factor * LARGER, 0)
        wide = self.scene._replace(fixed={2: self.scene.fixed[2], 3: wide.fixed[3]})
        here = self.write(self.ours, "slope", self.scene, self.steps)
        there = self.write(self.ours, "slope_wide", wide, self.steps)
        ratios, extra, told = [], [], []
        for _ in range(2 * self.repeat):
            one = self.measure("terrain", self.ours, here, self.scene, self.steps)
            other = self.measure("terrain", self.ours, there, wide, self.steps)
            ratios.append(other.result.seconds / one.result.seconds)
            more = other.fixed - one.fixed
            extra.append((other.result.peak - one.result.peak) / more)
            told.append((other.result.told - one.result.told) / more)
        self.set("terrain_time", "time per step, terrain ten times larger / as it is", ratios)
        self.set("terrain_bytes", "bytes per extra fixed ball and rank, largest resident", extra)
        self.set("terrain_bytes_told", "bytes per extra fixed ball and rank, as LAMMPS counts", told)

    def ranks(self, several):
        """The moving mass, and without --quick case 20 from start to rest, as its deck balances it."""
        here = self.write(self.ours, "slope", self.scene, self.steps)
        for ranks in several:
            ratios = []
            for _ in range(self.repeat):
                one = self.measure("ranks", self.ours, here, self.scene, self.steps)
                other = self.measure("ranks", self.ours, here, self.scene, self.steps, ranks)
                ratios.append(one.result.seconds / other.result.seconds)
            self.set(f"ranks_{ranks}", f"speed-up of {ranks} ranks, the moving mass", ratios)
            if not self.quick:
                self.set(f"rest_{ranks}", f"speed-up of {ranks} ranks, {CASE.parent.name} from start to rest",
                         [self.case(1) / self.case(ranks) for _ in range(self.repeat)])

    def case(self, ranks):
        """s per step of case 20 from start to rest."""
        self.say(f"ranks: {CASE.parent.name} from start to rest, {ranks} rank" + "s" * (ranks > 1))
        folder = self.folder(f"rest_{ranks}")
        for path in (CASE, CASE.with_name("terrain.asc")):
            shutil.copy(path, folder)
        steps, seconds = peers.run_deck(self.lmp, folder, CASE.name, ranks)
        self.cases.append({"ranks": ranks, "steps": steps, "seconds": seconds})
        self.bar.update(self.task, advance=1, refresh=self.live)
        return seconds / steps

    def throughput(self):
        """Two runs at a time, each on one rank."""
        here, there = (self.write(self.ours, name, self.scene, self.steps) for name in ("slope", "slope_beside"))
        ratios = []
        for _ in range(self.repeat):
            alone = self.measure("throughput", self.ours, here, self.scene, self.steps)
            self.say("throughput: two runs side by side")
            both = [self.keep("throughput", self.ours, self.scene, self.steps, 1, result)
                    for result in peers.run_together(self.ours, [here, there])]
            ratios.append(2 * alone.result.seconds / (sum(one.result.seconds for one in both) / 2))
        self.set("throughput", "throughput of two runs side by side / one", ratios)

    def weak(self, several):
        """Copies of the scene side by side, so that every ball has the same to do; on one rank and on several."""
        n = math.ceil(MANY / len(self.scene.moving))
        points = self.scene.fixed[3]
        width = D * math.ceil((np.ptp(points[:, 1]) + D) / D)
        many = copies(self.scene, n, width)
        steps = max(100, self.steps // 5)
        here = self.write(self.ours, "slope_short", self.scene, steps)
        there = self.write(self.ours, "slope_many", many, steps)
        ratios = {ranks: [] for ranks in (1, *several)}
        extra, told = [], []
        for _ in range(self.repeat):
            for ranks, ratio in ratios.items():
                one = self.measure("weak", self.ours, here, self.scene, steps, ranks)
                other = self.measure("weak", self.ours, there, many, steps, ranks)
                ratio.append(other.per_ball / one.per_ball)
                if ranks == 1:
                    more = other.moving - one.moving
                    extra.append((other.result.peak - one.result.peak) / more)
                    told.append((other.result.told - one.result.told) / more)
        what = f"time per ball-step, {len(many.moving):,} moving balls / {len(self.scene.moving):,}"
        self.set("weak_time", what, ratios.pop(1))
        for ranks, ratio in ratios.items():
            self.set(f"weak_time_{ranks}", f"{what}, both on {ranks} ranks", ratio)
        self.set("weak_bytes", "bytes per moving ball with its fixed ones, largest resident", extra)
        self.set("weak_bytes_told", "bytes per moving ball with its fixed ones, as LAMMPS counts", told)

    def set(self, name, what, several):
        """Keep the median of some values, and whether it meets its target."""
        about = {"what": what, "value": median(several), "low": min(several), "high": max(several),
                 "runs": len(several)}
        if name in TARGETS:
            sense, bound = TARGETS[name]
            met = about["value"] >= bound if sense == ">=" else about["value"] <= bound
            about.update(target=f"{sense} {bound:g}", met=met)
        self.values[name] = about


# --- what came of it ---

def same_scene(plan):
    """{code: kinetic energy and way of the centroid against ours, and whether it is the same scene}."""
    found = {}
    if not plan.states:
        return found
    mass = plan.scene.mass

    def energy(balls):
        return 0.5 * mass * float((balls[:, 3:6] ** 2).sum())

    def way(balls):
        return balls[:, :3].mean(axis=0) - plan.scene.moving[:, :3].mean(axis=0)

    ours = plan.states["slope"]
    for name, balls in plan.states.items():
        other = energy(balls) / energy(ours)
        off = float(np.linalg.norm(way(balls) - way(ours)) / np.linalg.norm(way(ours)))
        loose = LOOSE.get(name, 1.0)
        found[name] = {"kinetic_energy": energy(balls), "kinetic_energy_to_ours": other,
                       "way_of_centroid": [round(value, 6) for value in way(balls).tolist()], "way_off": off,
                       "same": len(balls) == len(ours) and abs(other - 1) <= loose * SAME_ENERGY
                       and off <= loose * SAME_WAY}
    return found


def report(plan):
    """Write the results, and print them."""
    ours = [one for one in plan.runs if one.code == "slope" and one.ranks == 1 and one.part == plan.runs[0].part
            and one.fixed == len(plan.scene.ground)]
    parts = {name: median(one.result.breakdown[name] for one in ours) for name in ours[0].result.breakdown}
    codes = {}
    for code in peers.ALL:
        own = [one for one in plan.runs if one.code == code.name and one.part == "peers"]
        if own:
            codes[code.name] = {"title": code.title, "version": plan.versions[code.name],
                                "loop_seconds": median(one.result.seconds for one in own),
                                "ns_per_ball_step": 1e9 * median(one.per_ball for one in own),
                                "differs": list(code.differs)}
    scene = plan.scene
    about = {"bench": {"finished": runs.now(), "machine": runs.machine(), "package": runs.package_version(),
                       "lmp_sha256": jobs.sha256(plan.lmp),
                       "programs_sha256": {name: jobs.sha256(path) for name, path in plan.programs.items()},
                       "versions": plan.versions, "quick": plan.quick,
                       "steps": plan.steps, "repeat": plan.repeat},
             "scene": {"moving": len(scene.moving), "fixed": len(scene.ground), "diameter": scene.diameter,
                       "dt": scene.dt, "skin": scene.skin, "prepared_s": PREPARED * math.sqrt(plan.size),
                       "median_speed": float(np.median(np.linalg.norm(scene.moving[:, 3:6], axis=1)))},
             "measures": plan.values, "codes": codes, "same_scene": same_scene(plan), "breakdown_seconds": parts,
             "start_to_rest": plan.cases, "notes": plan.notes}
    for name, state in about["same_scene"].items():
        if not state["same"]:
            plan.notes.append(f"{codes[name]['title']} ran another collapse: kinetic energy "
                              f"{state['kinetic_energy_to_ours']:.3f} of ours, way of the centroid off by "
                              f"{100 * state['way_off']:.1f} %")
    runs.write(plan.output / "bench.csv", table(plan.runs))
    runs.write(plan.output / "bench.yaml", "# slope bench: s, m, J, bytes; ratios are medians of neighbouring runs\n"
               + yaml.safe_dump(about, sort_keys=False))
    draw(plan.output / "bench.png", about)
    show(about, plan.output)


def table(several):
    """bench.csv: one row per run."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    parts = sorted({name for one in several for name in one.result.breakdown})
    writer.writerow(["part", "code", "ranks", "moving", "fixed", "steps", "loop_s", "ns_per_ball_step", "peak_bytes",
                     *(f"{name.lower()}_s" for name in parts)])
    for one in several:
        writer.writerow([one.part, one.code, one.ranks, one.moving, one.fixed, one.steps, f"{one.result.seconds:.6g}",
                         f"{1e9 * one.per_ball:.6g}", one.result.peak,
                         *(one.result.breakdown.get(name, "") for name in parts)])
    return out.getvalue()


def show(about, folder):
    """Print tables, what differs, and where the numbers are."""
    console = Console() if sys.stdout.isatty() else Console(width=160)
    bench, scene, measures = about["bench"], about["scene"], about["measures"]
    machine = bench["machine"]
    print(f"{machine['processor']}, {machine['cores']} cores; {scene['moving']:,} moving and {scene['fixed']:,} fixed "
          f"balls, {bench['steps']} steps, median of {bench['repeat']}")
    if about["codes"]:
        shown = Table(title="one core, the same balls, the same step")
        for head, side in (("code", "left"), ("version", "left"), ("loop s", "right"), ("ns/ball/step", "right"),
                           ("time / ours", "right"), ("range", "right"), ("target", "right"), ("met", "right"),
                           ("energy / ours", "right"), ("way off %", "right")):
            shown.add_column(head, justify=side)
        for name, code in about["codes"].items():
            ratio, same = measures.get(name), about["same_scene"].get(name)
            shown.add_row(code["title"], code["version"].split(",")[0].removeprefix("Version "),
                          f"{code['loop_seconds']:.2f}", f"{code['ns_per_ball_step']:.1f}", *against(ratio),
                          f"{same['kinetic_energy_to_ours']:.3f}" if ratio else "",
                          f"{100 * same['way_off']:.2f}" if ratio else "")
        console.print(shown)
    rest = {name: value for name, value in measures.items() if name not in about["codes"]}
    if rest:
        shown = Table(title="terrain, ranks, more balls")
        for head, side in (("what", "left"), ("value", "right"), ("range", "right"), ("target", "right"),
                           ("met", "right")):
            shown.add_column(head, justify=side)
        for value in rest.values():
            shown.add_row(value["what"], *against(value))
        console.print(shown)
    total = sum(about["breakdown_seconds"].values())
    print("ours: " + ", ".join(f"{name.lower()} {seconds:.3f} s ({100 * seconds / total:.0f} %)"
                               for name, seconds in about["breakdown_seconds"].items()))
    for code in about["codes"].values():
        for text in code["differs"]:
            print(f"{code['title']}: {text}")
    for text in about["notes"]:
        print(text)
    print(f"{folder / 'bench.yaml'}, {folder / 'bench.csv'}, {folder / 'bench.png'}")


def against(value):
    """Cells of a measure: value, range, target, met."""
    if not value:
        return "", "", "", ""
    median_, low, high = (f"{value[key]:.3g}" if value[key] < 100 else f"{value[key]:.0f}"
                          for key in ("value", "low", "high"))
    return (median_, f"{low} to {high}", value.get("target", ""),
            {True: "yes", False: "NO", None: ""}[value.get("met")])


def draw(path, about):
    """The codes against ours with their targets, the other measures, and where our time goes."""
    from . import figures
    from .figures import plt
    measures, codes, parts = about["measures"], about["codes"], about["breakdown_seconds"]
    with plt.rc_context(figures.STYLE):
        figure, axes = plt.subplots(1, 2, figsize=(figures.FULL, 2.3), width_ratios=(1.5, 1))
        names = [name for name in measures if name in codes][::-1]
        if names:
            ratios = [measures[name]["value"] for name in names]
            colours = [figures.COLOURS[2 if measures[name]["met"] else 1] for name in names]
            axes[0].barh(names, ratios, color=colours, height=0.6)
            axes[0].set_yticks(range(len(names)), [codes[name]["title"] for name in names])
            bounds = [TARGETS[name][1] for name in names]
            axes[0].scatter(bounds, names, marker="|", s=260, color="black", lw=1.6, zorder=3)
            for i, name in enumerate(names):
                axes[0].annotate(f"{ratios[i]:.1f}  ({codes[name]['ns_per_ball_step']:.0f} ns)",
                                 (max(ratios[i], bounds[i]), i), xytext=(5, 0), textcoords="offset points",
                                 va="center", fontsize=6.5)
            axes[0].set(xscale="log", xlim=(1, 5 * max(ratios + bounds)), xlabel="its time / ours "
                        f"({codes['slope']['ns_per_ball_step']:.0f} ns per moving ball and step)")
            axes[0].set_xticks([1, 2, 5, 10, 20, 50], ["1", "2", "5", "10", "20", "50"])
            axes[0].minorticks_off()
            axes[0].set_title("| target", loc="right", fontweight="normal")
            axes[0].set_ylim(len(names) - 4.6, len(names) - 0.4)       # room for four
            axes[0].set_title("One core, the same balls", loc="left")
        else:
            axes[0].set_visible(False)
        total = sum(parts.values())
        shown = [name for name in parts if parts[name] > 0.005 * total][::-1]
        axes[1].barh(shown, [100 * parts[name] / total for name in shown], color=figures.COLOURS[0], height=0.6)
        axes[1].set(xlabel="% of our time", xlim=(0, 100))
        for i, name in enumerate(shown):
            axes[1].annotate(f"{100 * parts[name] / total:.0f}", (100 * parts[name] / total, i), xytext=(3, 0),
                             textcoords="offset points", va="center", fontsize=6.5)
        axes[1].set_title("Where our time goes", loc="left")
        new = path.with_name(f".{path.name}.new.png")
        figure.savefig(new, dpi=figures.DPI, metadata={"Software": None})
        plt.close(figure)
        new.replace(path)
