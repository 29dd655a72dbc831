"""What the study of a site can say, before it takes its time: by fall path, known events, road, balls and disk."""
from pathlib import Path
from typing import List, Optional, Sequence

import numpy as np

from ..case.data_files import OUTPUTS
from ..deposits import gone
from ..digits import metres, three
from ..ensembles.farther import REACHED
from ..errors import SlopeError
from ..geometry import extent
from ..mobility import body, known, results
from ..mobility.known import Mobility
from ..mobility.fall_path import TERRAIN, FallPath
from ..releases import packing
from ..sites import site_budget, site_choices, site_roads, site_trial
from ..sites.site_found import Found
from ..sites.site_sections import OfMass
from ..survey import rasters, roads
from ..survey.rasters import Raster
from . import site_study
from .setup import Setup

SIDES = (("west", "east"), ("south", "north"))
FARTHEST = 20.0         # times as far as the path may the end of known events be looked for
# on the disk
FRAME = 100.0           # bytes of a ball in a snapshot
RESTART = 1000.0        # of a ball in a restart file, with its contacts
BASE = 45e3             # of a restart file without balls
FILES = 2               # restart files, written in turn
CELL = 60.0             # of a cell in all rasters of a run
ROOM = 1.5              # times as many cells have a run's rasters as those that the trial run reached
RUN = 200e3             # of logs, and the volume on the road, with its map
PAGES = 12e6            # of maps, reports and film


def describe_outlook(folder: Path) -> List[str]:
    """In words: what is known without a run, what the study takes, and what kind of number it can be."""
    site = site_choices.load_site(folder)
    choices, site_found = site.choices, site.found
    lines: List[str] = []
    floors: List[str] = []
    try:
        mass = body.read_mobility_body(folder)
        asked = known.choice(choices.known.set, (), choices.known.confined)
        decides = known.compute_known_mobility(mass, asked)
    except SlopeError as error:
        lines.append(f"the mass cannot be compared with known events: {error}")
    else:
        counts = decides.decides
        length, fall = (metres(values[-1]) for values in (counts.path.length, counts.path.fall))
        lines += [f"fall path of {length}, down to {fall} below the crown, {counts.path.end}",
                  events_text(counts, asked)]
        met = {name: known.way_to_road(mass, decides, roads.read_local(
            folder / site_roads.file_name(name), mass.raster, choices.road.asked, local=True).polygon)
            for name in site_roads.names(site) or [""] * bool(choices.road.file)}
        lines += [road_text(one, name) for name, one in met.items()]
        if why := terrain_ends(counts, mass.raster):
            # behind all roads it is no reason against their numbers
            behind = met and all(one.at.passed < counts.path.length[-1] for one in met.values())
            (lines if behind else floors).append(why)
    engine = Setup(Path(), Path())
    numbers = site_study.wanted(site, site_study.plan_site_study(site, engine), site_study.Asked(),
                                site_study.points_of(site, engine)).points
    lines.append("the study takes about "
                 f"{format_disk_size(disk_of_study(folder, choices, site_found, numbers))} of disk")
    if why := coarse(1 + len(numbers)):
        lines.append(f"the number will have neither a lower nor an upper bound, because {why}")
    elif floors:
        lines.append(f"the number will be at best a floor, at least so much, because {'; and because '.join(floors)}")
    return lines


def events_text(counts: Mobility, asked: known.Choice) -> str:
    """How far known events went."""
    name = f"{asked.number(counts)} known events, {asked.name(counts)}"
    return f"{name}: " + (results.lengths(counts, counts.chosen) if counts.in_range else "; ".join(counts.outside))


def road_text(way: known.Way, name: str) -> str:
    """Which share of known events reaches and passes the road; name: of one of several."""
    met = way.at
    if met.behind:
        return (f"the road{name and f' {name}'} lies behind the crown or as high, {metres(met.beside)} from the fall "
                "path, where no known event goes")
    where = "first met" if met.met else f"which the fall path passes {metres(met.beside)} beside,"
    return (f"the road{name and f' {name}'}, {where} after {metres(met.length)}"
            f"{results.describe_way(way)}: {results.describe_road_reach(way)}")


def terrain_ends(counts: Mobility, raster: Raster) -> Optional[str]:
    """Why known events that count go beyond the terrain, and what is to be added; None where hardly any do."""
    path, beyond = counts.path, counts.beyond_path()
    if path.end != TERRAIN or not counts.in_range or beyond < 1 - REACHED:
        return None
    more, x, y = missing(counts), float(path.x[-1]), float(path.y[-1])
    how = "" if more is None else f": add about {three(more)} m of terrain in the {side_of(path, raster)}"
    if gone.is_in_hole(x, y, np.isfinite(raster.z), raster):
        how = f" into a hole, at x y {x:.0f} {y:.0f}: give heights there (slope site --fill)"
    return (f"{results.percent(beyond)} of known events go beyond the terrain, which the fall path leaves after "
            f"{metres(path.length[-1])}{how}")


def missing(counts: Mobility) -> Optional[float]:
    """How many metres the path is too short for all but a few of the events, were the ground beyond it level; None:
    more than anybody has."""
    path, volume = counts.path, counts.volume
    length = path.length[-1] * np.geomspace(1.0, FARTHEST, 400)
    share = counts.law.beyond(counts.chosen, length, volume, np.full(len(length), path.fall[-1]))
    enough = np.flatnonzero(share <= 1 - REACHED)
    return float(length[enough[0]] - path.length[-1]) if len(enough) else None


def side_of(path: FallPath, raster: Raster) -> str:
    """The side, or both sides of a corner, of a terrain at which a path ends."""
    xlo, ylo, xhi, yhi = extent(raster)
    x, y = float(path.x[-1]), float(path.y[-1])
    far = {"west": x - xlo, "east": xhi - x, "south": y - ylo, "north": yhi - y}
    near = [name for name, metres in far.items() if metres <= min(far.values()) + 2 * raster.transform.a]
    return " and the ".join(sorted(near, key=lambda name: name in SIDES[0]))


def coarse(number: int) -> Optional[str]:
    """Why so many sizes of balls are too few for a number; None where they are enough."""
    if number >= site_budget.SIZES:
        return None
    return (f"balls of {number} size{'s' * (number > 1)} are run, {site_budget.SIZES} show what finer ones bring "
            f"(study --levels {site_budget.SIZES}, or more --minutes)")


# --- disk ---

def disk_of_study(folder: Path, choices: OfMass, site_found: Found, numbers: Sequence[int]) -> float:
    """Bytes of all runs of a study, without those that may be added, and of its pages; of a site that is made.

    numbers: of points with each of the finer balls.
    """
    d, body, plan = choices.balls.diameter, site_found.body, site_budget.plan_budget(choices)
    assert d and body and choices.model.duration and choices.model.film and choices.model.cell
    of_site = packing.count_balls(body.volume, d)
    inputs = sum(path.stat().st_size for path in folder.iterdir() if path.is_file() and not OUTPUTS.search(path.name))
    rest = site_found.trial and site_found.trial.rest or choices.model.duration / site_budget.PATIENCE
    frames = 1 + rest / choices.model.film
    cells = covered(folder) / choices.model.cell ** 2

    def run(factor: float) -> float:
        balls = of_site / factor ** 3
        return inputs + RUN + CELL * cells + FILES * (BASE + RESTART * balls) + FRAME * balls * frames
    return PAGES + (plan.runs + plan.half_step) * run(1.0) + sum(
        number * run(0.5 ** k) for k, number in enumerate(numbers, 1))


def covered(folder: Path) -> float:
    """Area (m2) of the rectangle that a run's rasters cover."""
    try:
        raster = rasters.read_raster(folder / site_trial.REACHED, heights=False)
    except SlopeError:
        return 0.0
    rows, columns = np.nonzero(np.nan_to_num(raster.z) > 0)
    if not len(rows):
        return 0.0
    return ROOM * float(np.ptp(rows) + 1) * float(np.ptp(columns) + 1) * raster.transform.a ** 2


def format_disk_size(size: float) -> str:
    """In words."""
    return f"{three(size / 1e9)} GB" if size >= 1e9 else f"{three(size / 1e6)} MB"
