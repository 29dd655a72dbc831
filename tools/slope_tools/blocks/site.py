"""The folder of a site of single blocks: terrain, layers, where the blocks start, deck, map and site.yaml."""
import math
import os
import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any, Dict, List, NamedTuple, Optional, Tuple

import numpy as np
from shapely.geometry import Point
from shapely.geometry.base import BaseGeometry
from shapely.prepared import prep

from .. import disk
from ..digits import metres
from ..errors import SlopeError
from ..findings import Finding, keeper
from ..geometry import box_of, extent, polygons_of
from ..heads import GRAVITY
from ..releases.release_area import FLAT
from ..sites import site, site_budget, site_choices, site_deck, site_layers, site_trial, site_warnings
from ..sites.site_budget import Trial
from ..sites.site_choices import Derived
from ..sites.site_folder import BODY, MAP
from ..sites.site_inputs import Line
from ..sites.site_sections import OfBlocks, widest
from ..survey import polygons
from ..survey.rasters import Raster
from ..survey.resampling import sample
from . import edges

TEMPLATE = Path(__file__).with_name("in.blocks.j2")
FIELD = 3               # type of the ground's balls; those of zones follow
MOST = 100_000          # blocks
SHOWN = 200             # blocks whose paths are kept, of each run and of all together
TRIAL = 100             # blocks of the trial run
BINS = 2e5              # of the neighbor list, at most: the box is large and nearly empty
PLACES = 3000           # below a block at which it must be above the ground
BETWEEN = 0.025         # of the circle's radius between two of them: an edge of a cliff may lie there
CLEAR = 1.02            # times the distance at which blocks and the ground's balls touch
WIDEST = 10.0           # times as large as the smallest block, which sets the step, may be the largest


class Start(NamedTuple):
    """Where blocks start, and what they are."""
    raster: Raster
    polygon: BaseGeometry
    down: np.ndarray        # x y z, unit vector down the plane that fits the ground in it best
    slope: float            # degrees, of that plane
    top: float              # m, that no block can exceed
    sizes: Tuple[float, float]      # the smallest and the largest, m
    types: int              # of balls in the deck

    def data(self, ground: int, number: int) -> str:
        """The blocks of a ground, for read_data: all places and sizes are as likely."""
        chance = np.random.default_rng(ground)
        (low, high), points = self.sizes, inside(self.polygon, number, chance)
        diameters = chance.uniform(low, high, number)
        z = lifted(self.raster, points, CLEAR * (diameters + low) / 2)
        xlo, ylo, xhi, yhi = extent(self.raster)
        return (f"blocks of ground {ground}: id type diameter density x y z, m and kg/m3\n\n{number} atoms\n"
                f"{self.types} atom types\n\n{xlo!r} {xhi!r} xlo xhi\n{ylo!r} {yhi!r} ylo yhi\n"
                f"{float(np.nanmin(self.raster.z)) - 10 * high!r} {self.top!r} zlo zhi\n\nAtoms # sphere\n\n" + "".join(
                    f"{k} 1 {d:.6g} 1000 {x:.4f} {y:.4f} {h:.4f}\n"
                    for k, (d, (x, y), h) in enumerate(zip(diameters, points, z), 1)))


def build(given: OfBlocks, known: Derived, new: Path, folder: Path, machine: site.Machine, tell, warn,
          draw: site.Draw) -> site.Made:
    """Everything, into the folder `new`, which will be `folder`: as site.build() of a mass."""
    keep, warnings = keeper(warn)
    site_choices.check_assigned(given)
    several, grounds = given.study.rolling, given.blocks.grounds
    runs = len(several) * grounds
    each = math.ceil(given.blocks.number / runs)
    check_block_site(given, runs)
    raster, _ = site.terrain(given, new, tell, keep)
    start = start_of(given, raster, new, tell, keep)
    layers = site_layers.read_layers(given, raster, new, tell, keep)
    start = start._replace(types=FIELD + len(layers.zones))
    title = given.project.name or folder.absolute().name
    findings = deck_values(given, title, start, [*layers.lines, *add_edges(given, layers, start, new)], layers.zones)
    trial = tried(given, start, findings, new, machine, tell)
    choices = settled(given, start, trial)
    for ground in range(1, grounds + 1):
        disk.write_file(new / f"blocks.{ground}.data", start.data(ground, each))
    seconds = trial and trial.setup + trial.cost * each * trial.rest / choose_time_step(choices)
    tell(f"{each * runs:,} blocks, {each:,} in each of {runs} runs: rolling resistances "
         f"{', '.join(f'{one:g}' for one in several)} on {grounds} grounds" + (
             f"; about {site_budget.duration_text(runs * seconds / machine.jobs)}, {machine.jobs} at a time, if "
             "nothing else runs" if seconds else ""))
    for one in (*site_warnings.of_trial(trial), *site_warnings.of_resistance(choices),
                *site_warnings.of_zones(layers.zones), *find_block_caveats(start)):
        keep(one)
    site_warnings.write_site_warnings(new, warnings)
    disk.write_file(new / site_deck.NAME, deck(choices, findings, f"{each:,}", site_deck.run_time(seconds)))
    draw(new / MAP, site_layers.Shown(raster, np.zeros(raster.z.shape), start.polygon, layers.road, None, (),
                                      layers.lines, None, layers.zones), f"{title}: {each * runs:,} blocks")
    about = {**site.about_made(choices, new, folder, raster, layers), "trial": trial and trial._asdict(),
             "derived": site_choices.derived(given, choices, known), "blocks": {
                 "of_a_run": each, "runs": runs, "down": start.down, "slope": start.slope}}
    disk.write_file(new / site_choices.NAME, site_choices.make_site_file(choices, about, folder.absolute()))
    return site.Made(folder, list(about["files"] or ()))


def check_block_site(choices: OfBlocks, runs: int) -> None:
    """Raise SlopeError unless the choices make sense together."""
    (low, high), number = sizes_of(choices), choices.blocks.number
    if not choices.release.polygon:
        raise SlopeError("--release", "must be given, the polygon in which blocks start")
    if number < runs:
        raise SlopeError("--blocks", f"must be at least {runs}, one for each run: chance is measured on several "
                         "grounds (blocks.grounds of site.yaml)", number)
    if number > MOST:
        raise SlopeError("--blocks", f"must be at most {MOST:,}: more grounds (blocks.grounds of site.yaml) say more "
                         "than more blocks", f"{number:,}")
    if not low <= high <= WIDEST * low:
        raise SlopeError("--size", f"must be D or D:D2, m, with D <= D2 <= {WIDEST:g} D", f"{low:g}:{high:g}")


def sizes_of(choices: OfBlocks) -> Tuple[float, float]:
    return choices.blocks.size[0], choices.blocks.size[-1]


# --- where they start ---

def start_of(choices: OfBlocks, raster: Raster, new: Path, tell, warn) -> Start:
    """Where the blocks start; SlopeError unless all of it has ground, and a fall line if they have a speed."""
    path, sizes, speed = choices.release.polygon, sizes_of(choices), choices.blocks.speed
    assert path
    polygon = polygons.read_local(path, raster, crs=site_layers.assigned(choices, path),
                                  advice=site_layers.advice(choices, path), warn=warn)
    polygon = polygons.write_polygon(new / f"{BODY}.csv", polygon, raster)
    corners = np.concatenate([np.asarray(one.exterior.coords)[:, :2] for one in polygons_of(polygon)])
    points = np.concatenate([corners, inside(polygon, 1000, np.random.default_rng(0))])
    none = np.isnan(lifted(raster, points, np.full(len(points), CLEAR * sizes[1])))
    if none.any():
        east, north = points[none][0] + raster.offset
        raise SlopeError(path, f"must have terrain in it, and {metres(sizes[1])} beside it: a larger elevation model, "
                         "--fill, or a smaller area", f"none at east {east:.1f} north {north:.1f}")
    level = np.column_stack([points - points.mean(axis=0), np.ones(len(points))])
    gradient = np.linalg.lstsq(level, sample(raster, *points.T), rcond=None)[0][:2]
    steep = float(np.hypot(*gradient))
    slope = math.degrees(math.atan(steep))
    if speed and slope < FLAT:
        raise SlopeError("--speed", f"needs a fall line: the release area must fall by at least {FLAT:g} degree",
                         f"{slope:.1f}")
    tell(f"{BODY}.csv: {polygon.area:,.0f} m2 in which blocks start, a slope of {slope:.0f} degrees")
    down = np.array([*(-gradient / max(steep, 1e-9)), -steep]) / math.hypot(1, steep) if steep > 1e-9 else np.eye(3)[0]
    top = float(np.nanmax(raster.z)) + 12 * sizes[1] + speed ** 2 / (2 * GRAVITY)
    return Start(raster, polygon, down, slope, top, sizes, FIELD)


def inside(polygon: BaseGeometry, number: int, chance: np.random.Generator) -> np.ndarray:
    """Places in a polygon, each as likely."""
    low, high = np.reshape(polygon.bounds, (2, 2))
    ready, found = prep(polygon), np.empty((0, 2))
    while len(found) < number:
        points = chance.uniform(low, high, (number, 2))
        found = np.concatenate([found, points[[ready.contains(Point(one)) for one in points]]])
    return found[:number]


def lifted(raster: Raster, points: np.ndarray, reach: np.ndarray) -> np.ndarray:
    """Height at which the ground is nowhere nearer than that (m) to a point above each of points; NaN beside it."""
    most = sample(raster, *points.T) + reach
    for place in np.split(np.arange(PLACES) + 0.5, PLACES // 50):       # a spiral that fills the circle evenly
        away, angle = np.sqrt(place / PLACES), place * math.pi * (3 - math.sqrt(5))
        x, y = (points[:, [k]] + np.outer(reach, away * part) for k, part in enumerate((np.cos(angle), np.sin(angle))))
        above = np.outer(reach, np.sqrt(1 - np.maximum(0.0, away - BETWEEN) ** 2))
        most = np.maximum(most, (sample(raster, x, y) + above).max(axis=1))
    return most


def find_block_caveats(start: Start) -> List[Finding]:
    """What is to be known of a release area and of blocks."""
    cell = float(start.raster.transform.a)
    level = [Finding("blocks on level ground", {"slope": start.slope, "limit": FLAT})] * (start.slope < FLAT)
    return level + [Finding("blocks below cell", {"size": start.sizes[0], "cell": cell})] * (start.sizes[0] < cell)


# --- the road ---

def add_edges(choices: OfBlocks, layers: site_layers.Layers, start: Start, new: Path) -> List[Line]:
    """The control lines around the road."""
    if layers.road is None:
        return []
    if line := site_layers.swapped(choices, start.raster):
        raise SlopeError("--release, --road", "must not be swapped, blocks fall from the release area onto the road",
                         line)
    found = edges.find_edges(layers.road, start.polygon, start.sizes[1], start.raster)
    if name := next((one.name for one in layers.lines if one.name.startswith(edges.EDGE)), None):
        raise SlopeError("--line", f"must not be called {edges.EDGE}, as lines around the road are: rename the file",
                         name)
    edges.write_edges(new, found)
    return [Line(name, f"{name}.csv", points) for name, points in found.items()]


# --- deck, and a trial of it ---

def deck_values(choices: OfBlocks, title: str, start: Start, lines, zones) -> Dict[str, Any]:
    """What the template is filled in with, but for what a trial tells."""
    model, (low, high), raster = choices.model, start.sizes, start.raster
    room = box_of(raster).area * (start.top - float(np.nanmin(raster.z)))
    return {"title": title, "terrain": ", ".join(Path(name).name for name in choices.terrain.files),
            "deck": site_deck.NAME, "size": f"{low:g}" if low == high else f"{low:g} to {high:g}",
            "grounds": choices.blocks.grounds, "headroom": math.ceil(start.top - float(np.nanmax(raster.z))),
            "bins": f"{max(2.0, (room / BINS) ** (1 / 3) / high):.3g}", "lines": lines, "shown": SHOWN,
            "zones": site_deck.zone_values(zones, FIELD, model), "down": [site_deck.format_deck_number(one) for one
                                                                          in start.down],
            **{name: site_deck.format_deck_number(value) for name, value in (
                ("d", low), ("largest", high), ("spacing", model.spacing), ("widest", widest()),
                ("rolling", min(choices.study.rolling)), ("friction", model.friction),
                ("field_e", model.field_restitution), ("density", model.density),
                ("start", choices.blocks.speed), ("step", site_budget.STEP), ("close", site_budget.CLOSE))}}


def deck(choices: OfBlocks, values: Dict[str, Any], blocks: str, run_time: str) -> str:
    model = choices.model
    assert model.speed and model.duration and model.cell and model.film       # settled
    return site_deck.filled(TEMPLATE, {
        **values, "speed": site_deck.format_deck_number(model.speed),
        "duration": site_deck.format_deck_number(model.duration),
        "cell": site_deck.format_deck_number(model.cell), "film": site_deck.format_deck_number(model.film),
        "blocks": blocks, "run_time": run_time})


def tried(choices: OfBlocks, start: Start, values: Dict[str, Any], new: Path, machine: site.Machine,
          tell) -> Optional[Trial]:
    """What a run of some blocks with the least rolling resistance measures; None where there is no LAMMPS."""
    if machine.lmp is None:
        return None
    folder = new / "trial"
    folder.mkdir()
    for path in (*new.glob("*.asc"), *new.glob("*.csv")):
        os.symlink(f"../{path.name}", folder / path.name)
    disk.write_file(folder / "blocks.1.data", start.data(1, TRIAL))
    disk.write_file(folder / site_deck.NAME, deck(settled(choices, start, None), values, f"{TRIAL}", "some seconds"))
    found = site_trial.measure(folder, site_deck.NAME, machine.lmp, {})
    shutil.rmtree(folder)
    tell(f"trial run, {site.trial_text(found._replace(diameter=start.sizes[0]))}; took {found.seconds:.1f} s")
    return found


def settled(choices: OfBlocks, start: Start, trial: Optional[Trial]) -> OfBlocks:
    """With what they leave open; without a trial by the height through which a block can fall."""
    model, raster = choices.model, start.raster
    falling = math.sqrt(2 * GRAVITY * (start.top - float(np.nanmin(raster.z))))
    return replace(choices, model=replace(
        model, speed=model.speed or (site_budget.stiff_to(trial) if trial else float(f"{falling:.2g}")),
        duration=model.duration or site_budget.duration(trial),
        film=model.film or site_deck.frame(trial.rest if trial else site_budget.LEAST_DURATION / 3),
        cell=model.cell or float(raster.transform.a)))


def choose_time_step(choices: OfBlocks) -> float:
    """The deck's time step, s."""
    (low, high), speed = sizes_of(choices), choices.model.speed
    assert speed
    return site_budget.STEP * 0.25 * site_budget.OVERLAP * high / speed * (low / high) ** 1.5
