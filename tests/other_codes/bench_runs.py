"""The runs of the benchmark, and their times."""
import math
import os
import shutil
import sys
from statistics import median
from typing import Any, Dict, List, NamedTuple

import numpy as np
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from slope_tools import disk
from . import peer_runs, peers
from .bench_report import BUSY, TARGETS, report
from .bench_scenes import BALLS, CASE, D, DENSITY, PREPARED, SKIN, collapse, contacts, copies, time_step, write_terrain
from .peers import Scene

LARGER = 10.0           # terrain of the part terrain
MANY = 1_000_000        # moving balls of the part weak


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
        """Release the mass and run it; the scene that it has become."""
        self.say(f"making the {name}")
        folder = self.folder(name)
        write_terrain(folder / "terrain.asc", self.size, factor)
        disk.write_file(folder / peers.DECK, collapse(self.size, steps))
        result = peer_runs.run(self.ours, folder)
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
        result = peer_runs.run(code, folder, ranks)
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
        for kind in peers.ALL[1:]:
            if kind.name in names:
                one = kind(self.programs.get(kind.name, self.lmp))
                missing = one.missing()
                if missing:
                    self.notes.append(f"{one.title}: not measured: {missing}")
                else:
                    codes.append(one)
        ours = self.write(self.ours, "slope", self.scene, self.steps)
        folders = {code.name: self.write(code, code.name, self.scene, self.steps) for code in codes}
        ratios: Dict[str, List[float]] = {code.name: [] for code in codes}
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
        ratios, extra, reported = [], [], []
        for _ in range(2 * self.repeat):
            one = self.measure("terrain", self.ours, here, self.scene, self.steps)
            other = self.measure("terrain", self.ours, there, wide, self.steps)
            ratios.append(other.result.seconds / one.result.seconds)
            more = other.fixed - one.fixed
            extra.append((other.result.peak - one.result.peak) / more)
            reported.append((other.result.reported - one.result.reported) / more)
        self.set("terrain_time", "time per step, terrain ten times larger / as it is", ratios)
        self.set("terrain_bytes", "bytes per extra fixed ball and rank, largest resident", extra)
        self.set("terrain_bytes_reported", "bytes per extra fixed ball and rank, as LAMMPS counts", reported)

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
        steps, seconds = peer_runs.run_deck(self.lmp, folder, CASE.name, ranks, ["-var", "rule", "ours"])
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
                    for result in peer_runs.run_together(self.ours, [here, there])]
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
        ratios: Dict[Any, List[float]] = {ranks: [] for ranks in (1, *several)}
        extra, reported = [], []
        for _ in range(self.repeat):
            for ranks, ratio in ratios.items():
                one = self.measure("weak", self.ours, here, self.scene, steps, ranks)
                other = self.measure("weak", self.ours, there, many, steps, ranks)
                ratio.append(other.per_ball / one.per_ball)
                if ranks == 1:
                    more = other.moving - one.moving
                    extra.append((other.result.peak - one.result.peak) / more)
                    reported.append((other.result.reported - one.result.reported) / more)
        what = f"time per ball-step, {len(many.moving):,} moving balls / {len(self.scene.moving):,}"
        self.set("weak_time", what, ratios.pop(1))
        for ranks, ratio in ratios.items():
            self.set(f"weak_time_{ranks}", f"{what}, both on {ranks} ranks", ratio)
        self.set("weak_bytes", "bytes per moving ball with its fixed ones, largest resident", extra)
        self.set("weak_bytes_reported", "bytes per moving ball with its fixed ones, as LAMMPS counts", reported)

    def set(self, name, what, several):
        """Keep the median of some values, and whether it meets its target."""
        about = {"what": what, "value": median(several), "low": min(several), "high": max(several),
                 "runs": len(several)}
        if name in TARGETS:
            sense, bound = TARGETS[name]
            met = about["value"] >= bound if sense == ">=" else about["value"] <= bound
            about.update(target=f"{sense} {bound:g}", met=met)
        self.values[name] = about
