"""The deck of a site: in.site.j2 filled in, plain LAMMPS with every number an index variable."""
import functools
import math
import re
from pathlib import Path
from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Sequence

import jinja2

from ..releases import packing
from ..releases.release_deck import Body
from ..slips.bodies import rank_of
from . import site_budget
from .site_inputs import Line, Motion, Structure
from .site_sections import Model, OfMass, widest
from .site_zones import LIMITS, VALUES, Zone, find_site_value

NAME = "in.site"
TEMPLATE = "in.site.j2"
KNOB = re.compile(r"variable +\w+ +index ")
ROLLING = 0.05          # of a run by hand; a deck has no value of a list, so that a run is the same whatever the list
REST = 0.02             # share of the mass that may be faster than 0.1 m/s in a deposit at rest
FRAMES = 40             # snapshots of a run, about
BINS = 1000             # of the neighbor list for a ball, at most: each is cleared whenever the list is built
LEAST, WIDEST = 1.2, 5.0        # diameters: of these bins; wider ones gain no more, and cost in a dense mass
STEEPER = 7.0           # degrees: default of a strength that holds a body, above the slope of its slip surface
LEAST_PEAK, MOST_PEAK = 33.0, 80.0
# what the variables of a zone are
OF_ZONE = {"friction": "degrees; 0 <= friction < 90", "rolling": "rolling resistance",
           "restitution": "restitution; 0 < field_e <= 1", "spacing": f"diameters; 0 < spacing <= {widest():g}"}


class Parts(NamedTuple):
    """What a deck is made of, beside the choices."""
    title: str
    terrain: str            # what the terrain was made of, for the first line
    body: Body
    structures: Sequence[Structure]
    lines: Sequence[Line]
    motion: Optional[Motion]
    room: float             # m3, of the box around the ground
    zones: Sequence[Zone] = ()


class Numbers(NamedTuple):
    """What the choices leave open."""
    diameter: float         # m
    speed: float            # m/s
    duration: float         # s
    cell: float             # m
    film: float             # s
    peak_friction: float    # degrees
    rest: Optional[float] = None        # s, expected
    run_seconds: Optional[float] = None


def make_site_deck(choices: OfMass, parts: Parts, numbers: Numbers) -> str:
    """The deck."""
    return filled(Path(__file__).with_name(TEMPLATE), fill_deck_values(choices, parts, numbers))


@functools.lru_cache
def templates(folder: Path) -> jinja2.Environment:
    """Those of a folder, which may import those beside this module; each is compiled once."""
    return jinja2.Environment(loader=jinja2.FileSystemLoader([folder, Path(__file__).parent]), trim_blocks=True,
                              lstrip_blocks=True, keep_trailing_newline=True, undefined=jinja2.StrictUndefined)


def filled(template: Path, parameters: Mapping[str, Any]) -> str:
    """A deck from a template."""
    return aligned(templates(template.parent).get_template(template.name).render(parameters))


def fill_deck_values(choices: OfMass, parts: Parts, numbers: Numbers) -> Dict[str, Any]:
    """What the template is filled in with."""
    model, motion, body = choices.model, choices.motion, parts.body
    balls = packing.count_balls(body.volume, numbers.diameter)
    parameters: Dict[str, Any] = {
        "title": parts.title, "terrain": parts.terrain, "deck": NAME,
        "mass": f"one of {len(of)} bodies" if (of := choices.release.bodies) else f"{body.volume:,.0f} m3",
        "balls": f"about {balls:,.0f}", "rest_s": "some" if numbers.rest is None else f"{numbers.rest:.0f}",
        "run_time": run_time(numbers.run_seconds), "lower": math.ceil(body.lower),
        "box": " ".join(format_deck_number(value) for value in body.box), "types": types_before(parts) +
        len(parts.zones), "zones": zone_values(parts.zones, types_before(parts), model),
        "bins": bins(parts.room, body.volume),
        "slip_file": body.slip, "body": choices.release.bodies and rank_of(Path(choices.release.scar or "")),
        "structures": [{"name": one.name, "file": one.file, "point": " ".join(map(format_deck_number, one.point)),
                        "move": " ".join(["", "move", *map(format_deck_number, one.move)]) if any(one.move) else ""}
                       for one in parts.structures],
        "lines": parts.lines, "motion": parts.motion.file if parts.motion else "", }
    parameters.update({name: format_deck_number(value) for name, value in (
        ("d", numbers.diameter), ("spacing", model.spacing), ("widest", widest()),
        ("rolling", ROLLING), ("friction", model.friction), ("slip", model.slip_friction),
        ("restitution", model.restitution), ("field_e", model.field_restitution), ("density", model.density),
        ("thick", body.thick), ("stiffness_number", site_budget.STIFFNESS_NUMBER), ("rest", REST),
        ("step", site_budget.STEP), ("close", site_budget.CLOSE),
        ("speed", numbers.speed), ("duration", numbers.duration), ("cell", numbers.cell), ("film", numbers.film),
        ("concrete", choices.structures.friction), ("concrete_e", choices.structures.restitution),
        ("scale", motion.scale), ("shaking", parts.motion.length if parts.motion else 0),
        ("peak_friction", numbers.peak_friction), ("peak_rolling", motion.peak_rolling),
        ("trigger", motion.trigger))})
    return parameters


def types_before(parts: Parts) -> int:
    """Types of balls beside those of the zones."""
    return 4 if parts.structures else 3


def zone_values(zones: Sequence[Zone], before: int, model: Model) -> List[Dict[str, Any]]:
    """What a template needs of the zones of the ground; before: types of balls beside theirs.

    What a zone has changes by the factor by which the site's own value, the variable without the zone's name, is
    changed; not so the rolling resistance, which may be 0 there. What it does not have is the site's.
    """
    values = []
    for number, zone in enumerate(zones, before + 1):
        own, now = [], []
        used = {"spacing": "", "friction": "${friction}", "rolling": "${rolling}", "field_e": "${field_e}"}
        for name, value in zone.values.items():
            variable = VALUES[name]
            mine = f"{variable}_{zone.word}"
            own.append({"name": mine, "value": format_deck_number(value), "what": OF_ZONE[name]})
            used[variable] = f"${{{mine}}}"
            of = find_site_value(name, model)
            if not of:
                continue
            low, high = map(format_deck_number, LIMITS[name])
            own_ = f"v_{mine}"
            now += [{"name": f"x_{mine}", "formula": f"{own_}*(v_{variable}/{format_deck_number(of)})"},
                    {"name": f"low_{mine}", "formula": f"({own_}<{low})*{own_}+({own_}>={low})*{low}"},
                    {"name": f"high_{mine}", "formula": f"({own_}>{high})*{own_}+({own_}<={high})*{high}"},
                    {"name": f"now_{mine}", "formula": limited(f"v_x_{mine}", f"v_low_{mine}", f"v_high_{mine}")}]
            used[variable] = f"${{now_{mine}}}"
        values.append({"word": zone.word, "file": zone.file, "type": number, "own": own, "now": now, "used": used})
    return values


def limited(name: str, low: str, high: str) -> str:
    """A value within limits, as a formula of LAMMPS."""
    return f"({name}<{low})*{low}+({name}>={low})*({name}<={high})*{name}+({name}>{high})*{high}"


def bins(room: float, volume: float) -> str:
    """Side of the neighbor list's bins (diameters) in a box around the ground (m3); "": the list's reach, as usual."""
    side = (room / (BINS * volume)) ** (1 / 3)
    return f"{min(side, WIDEST):.3g}" if side > LEAST else ""


def format_deck_number(value: float) -> str:
    """A number as a word of a deck."""
    return f"{value:.10g}"


def frame(rest: float) -> float:
    """Seconds between two snapshots: a round number, so that there are about FRAMES."""
    power = 10.0 ** math.floor(math.log10(rest / FRAMES))
    return min((step * power for step in (1, 2, 5, 10)), key=lambda step: abs(math.log(step * FRAMES / rest)))


def peak_friction(slip_slope: float) -> float:
    """Friction angle (degrees) that holds a body on a slip surface of that mean slope: a first guess."""
    return min(MOST_PEAK, max(LEAST_PEAK, float(math.ceil(slip_slope + STEEPER))))


def run_time(seconds: Optional[float]) -> str:
    """Of one run on one core."""
    if seconds is None:
        return "not measured"
    return f"about {seconds / 60:.0f} minutes on one core" if seconds > 90 else f"about {seconds:.0f} s on one core"


def aligned(deck: str) -> str:
    """The comments behind the index variables on the deck's top in one column."""
    parts = [line.partition("  # ") if KNOB.match(line) else (line, "", "") for line in deck.splitlines()]
    wide = max(len(code.rstrip()) for code, mark, _ in parts if mark)
    return "".join(f"{code.rstrip():<{wide}}  # {comment.strip()}\n" if mark else f"{code}\n"
                   for code, mark, comment in parts)


def soil(choices: OfMass) -> str:
    """The values of soil and ground in words."""
    of = choices.model
    return (f"friction {of.friction:g} degrees, on the slip surface {of.slip_friction:g}; rolling resistance "
            f"{', '.join(f'{one:g}' for one in choices.study.rolling)}; the ground: spacing {of.spacing:g}, "
            f"restitution {of.field_restitution:g}; bulk density {of.density / packing.BULK:,.0f} kg/m3")
