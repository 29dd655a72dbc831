"""The table of a report on how uncertain its numbers are, and what they do not include."""
import math
from typing import List, Optional, Tuple

from ..deposits import travel_shares
from ..digits import rounded
from ..errors import SlopeError
from ..sites import site_zones
from ..sites.site_found import Found
from ..sites.site_sections import OfMass
from ..statistics import rounding
from ..studies import site_ground
from ..tables.quantities import STOP
from . import mobility_part
from .data import Data
from .numbers import Numbers
from .sections import Cell, Pairs, Section, Table

CONTENT = List[Tuple[str, str]]
RESISTANCE = "Resistance of the ground"
ZONE_HEADS = ["zone", Cell("share of the terrain", "%"), Cell("friction", "degrees"), "rolling resistance",
              "restitution", Cell("spacing", "diameters")]
ZONES = ("What the ground is, where: zones as on the maps, and the ground outside of them. Values are "
         "those of the shown run; the stop angle is that of a sheet of three balls whose soil has them, too.")

# by tests/size_family.py
BEYOND = (" More may come to lie beyond the road than any run here says: half the diameter brought up to 1.6 times as "
          "much in nine slides, 3.4 times in one of 3 balls' thickness.")


def make_limits_section(data: Data, ground, numbers: Numbers) -> Section:
    """Of the shown run and of its study."""
    return Section("limits", "", [Pairs(
        [*mobility_part.list_mobility_limits(data, ground, numbers), *uncertainty(data, numbers),
         ("Varied", varied(data)), *resistance(data, ground, numbers), *model(data)],
        "How uncertain these numbers are, and what is not in them", "limits")])


def resistance(data: Data, ground, numbers: Numbers) -> CONTENT:
    """The stop angle of the ground, where it is known, and what share of the slope below the body is steeper."""
    degrees, label = data.result.row.value(STOP), data.label(data.result)
    if degrees is None:
        return []
    others = [row.value(STOP) for row in data.compared if row.value(STOP) is not None]
    text = (f"A sheet of three balls stops on it where the slope is below {format_stop_angle(numbers, degrees, label)} "
            "degrees " f"(stop angle, run {label}")
    if max(others) - min(others) > 0.05:
        text += f"; in all runs {format_stop_angle(numbers, min(others))} to {format_stop_angle(numbers, max(others))}"
    try:
        share = 100 * ground.below.steeper(degrees)
    except SlopeError:      # a level body has no fall path
        return [(RESISTANCE, f"{text}).")]
    numbers.rows.append(("slope below the body that is steeper", "%", label, f"{share:.0f}", share))
    return [(RESISTANCE, f"{text}). Of the slope below the body {share:.0f} % is steeper: of the height that the fall "
             "path loses below its toe.")]


def format_stop_angle(numbers, degrees: float, label: str = "") -> str:
    """A stop angle, which is known to half a degree."""
    numbers.rows.append(("stop angle of the ground", "degrees", label, f"{degrees:.1f}", degrees))
    return f"{degrees:.1f}"


def zones_of_ground(data: Data, numbers: Numbers) -> Optional[Section]:
    """Which zones the ground has, with which values in the shown run; None without zones, or where it is no site's."""
    site = data.site
    zones, variables = Found.of(site).zones, data.result.row.variables
    if not zones or not set(site_zones.VALUES.values()) <= set(variables):
        return None
    rows = []
    model = OfMass.of(site).model
    for zone in site_zones.with_rest(zones):
        now = site_zones.now(zone, model, variables)
        degrees = site_ground.of_zone(zone, model, variables)
        numbers.rows.append((f"ground: {zone.name}: share of the terrain", "%", "", f"{100 * zone.share:.3g}",
                             100 * zone.share))
        rows.append((zone.name, f"{100 * zone.share:.3g}", *(f"{value:.3g}" for value in now.values()),
                     "" if degrees is None else f"{degrees:.1f}"))
    return Section("ground", "The ground", [Table(ZONES, [*ZONE_HEADS, Cell("stop angle", "degrees")], rows)])


# --- uncertainty ---

def uncertainty(data: Data, numbers: Numbers) -> CONTENT:
    """How far a run differs by chance, and the effect of the size of the balls."""
    study = data.study
    best = study.conservative if study else None
    rows = []
    if best and best.chance_m3 is not None and not best.mean_m3 and not best.chance_m3:
        rows.append(f"In none of the {len(data.finished)} runs anything is to be removed.")
    elif best and best.chance_m3 is not None:
        low, high = (rounding.format_rounded(value, best.place_m3) for value in
                     (max(0.0, best.mean_m3 - best.chance_m3), best.mean_m3 + best.chance_m3))
        rows.append(f"Another run with the same values gives {low} to {high} m3 to remove, in 95 % of cases.")
    key = travel_shares.DISTANCE
    scatter = study.scatter.get(key) if study else None
    if scatter:
        deviation = scatter["deviation"]
        text = rounding.format_rounded(deviation, 10 * rounding.place_of_digits(deviation))       # two digits
        numbers.rows.append(("scatter of a run: 99 % within", "m", "", text, deviation))
        rows.append(f"The distance that 99 % of the volume stays within differs by {text} m from run to run "
                    "(standard deviation).")
    if not rows:
        rows = ["Unknown: no run was repeated, and equivalent runs may differ by several percent (study --repeat)."] \
            if not (study and study.ensemble) else []
    chance = [("Chance", " ".join(rows))] if rows else []
    size, step, most = (study.size, study.step, study.largest_restitution) if study else (None, None, None)
    chance.append(("Size of the balls", f"{size.text[0].upper()}{size.text[1:]}.{BEYOND * (data.road is not None)}"
                   if size else "What smaller balls change is not known (study --levels)."))
    chance.append(("Time step", f"{step.text[0].upper()}{step.text[1:]}." if step else
                   "What half the time step changes was not tried (the study of a site does, or --set step=0.5)."))
    if step and (energy := step.energy):
        chance.append(("Energy", f"In the run with half the time step, {energy['text']}."))
    if most:
        chance.append(("Largest restitution", f"{most.text[0].upper()}{most.text[1:]}. Reach and area only: "
                       "these runs are none of those that the volume is of."))
    return chance


def varied(data: Data) -> str:
    """Which variables the runs differ in; nothing else contributes to the spread of the numbers."""
    several = {name: values for name, values in data.settings.items() if len(values) > 1}
    if not several:
        return ("Nothing: one set of values. The effect of other values of friction, restitution and roughness of the "
                "ground, or of another slip surface, is not included.")
    ranges = ", ".join(f"{name} {shortly(values)}" for name, values in several.items())
    return f"{ranges}. The effect of other variables, or of another slip surface, is not included."


def shortly(values) -> str:
    """The values of a variable, or the ends of many."""
    if len(values) <= 4:
        return ", ".join(map(str, values))
    try:
        ordered = sorted(values, key=float)
    except ValueError:
        return f"{len(values)} values"
    return f"{ordered[0]} to {ordered[-1]}"


# --- what the model leaves out ---

def model(data: Data) -> CONTENT:
    about = data.result.summary
    ball = about["volume"]["released"] / about["balls"]["released"]
    side = rounding.format_rounded(ball ** (1 / 3), 10.0 ** (math.floor(math.log10(ball) / 3) - 2))
    return [
        ("The body", "Its slip surface and volume were given, not computed: the report does not say whether, or how "
                     "likely, the slope fails. The body is released at once; no trigger is modelled, except with an "
                     "earthquake."),
        ("The mass", f"Equal balls, each representing {rounding.format_rounded(ball, rounding.place_of_digits(ball))} "
         "m3 of "
                     f"ground, a cube of {side} m: a parameter of the model, not the size of blocks. Speeds and "
                     "energies of single balls are those of such a block. Dry: no water, no pore pressure, no "
                     "liquefaction. No cohesion, no breakage, no bulking on the way."),
        ("The ground", "That of the elevation model; the deposit is sampled in cells of "
                       f"{rounded(data.result.deposit.cell, 3)} m. Anything narrower than a cell or a "
                       "ball, such as a ditch, has no effect. There is no "
                       "erosion or entrainment; there are no trees, and no walls or buildings except those in the "
                       "deck.")]
