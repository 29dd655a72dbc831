"""What the ground of a site holds: its stop angle, and how much of the slope below the body is steeper."""
from typing import Any, Dict, List, Mapping, Optional

from ..case import decks
from ..errors import SlopeError
from ..mobility import body, steeper
from ..sites import site_deck, site_zones
from ..sites.site_choices import Site
from ..sites.site_found import Zone
from ..sites.site_sections import Model
from ..sites.stop_angle import stop_angle

FIELD_SIZE = 1e-6       # of d; the table is of grounds of balls as large as the soil's
SEED = "ground_seed"    # variable of a deck whose ground is scattered balls; without it, it is a plan grid
SCALED = "${d}"         # field_d of a deck whose ground scales with its balls


def of_variables(variables: Optional[Mapping[str, Any]]) -> Optional[float]:
    """The stop angle (degrees) of a run's ground by the values of its deck's variables; None where it is unknown."""
    values = variables or {}
    try:
        d, field = (float(values[name]) if values[name] != SCALED else None for name in ("d", "field_d"))
        if field is not None and d is not None and abs(field - d) > FIELD_SIZE * d:
            return None
        scattered = SEED in values or str(values.get("pattern", "")).startswith("scattered")
        return stop_angle(float(values["spacing"]), float(values["friction"]), float(values["rolling"]),
                          float(values["field_e"]), "scattered" if scattered else "grid").degrees
    except (KeyError, ValueError):
        return None     # of a deck that has no such ground


def of_zone(zone: Zone, model: Model, variables: Mapping[str, Any]) -> Optional[float]:
    """The stop angle of a zone, as if the soil had its friction and rolling resistance, too; None where unknown."""
    try:
        return of_variables({**variables, **site_zones.now(zone, model, variables)})
    except (KeyError, ValueError):
        return None


def stop_angles(site: Site, others: bool = False) -> Dict[str, Dict[str, float]]:
    """Of a site: {spacing: {rolling resistance: stop angle (degrees)}}, without what is outside of the table.

    others: those of the other grounds of its study, too.
    """
    variables, choices = decks.index_variables(site.folder / site_deck.NAME), site.choices
    runs = [(variables.get("spacing", ""), f"{one:g}") for one in choices.study.rolling]
    if others and SEED in variables:
        runs += [(f"{spacing:g}", f"{rolling:g}") for spacing, rolling in choices.other_grounds]
    found: Dict[str, Dict[str, float]] = {}
    for spacing, rolling in runs:
        degrees = of_variables({**variables, "spacing": spacing, "rolling": rolling})
        if degrees is not None:
            found.setdefault(spacing, {})[rolling] = degrees
    return found


def describe_grounds(site: Site, others: bool = False) -> List[str]:
    """In words, a line for each ground; none where the stop angle is unknown."""
    grounds = stop_angles(site, others)
    try:
        slope = steeper.below(body.read_mobility_body(site.folder)) if grounds else None
    except SlopeError:      # a level body has no fall path
        slope = None
    texts = []
    for spacing, known in grounds.items():
        text = (f"the ground, spacing {spacing}: stop angle "
                f"{', '.join(f'{degrees:.1f}' for degrees in known.values())} degrees at a rolling resistance of "
                f"{', '.join(known)}")
        if slope:
            text += ("; of the slope below the body "
                     f"{', '.join(f'{100 * slope.steeper(degrees):.0f}' for degrees in known.values())} % is steeper")
        texts.append(text)
    return texts + [text for zone in site.found.zones if (text := zone_line(site, zone))]


def zone_line(site: Site, zone: Zone) -> str:
    """The stop angle of a zone at the site's own spacing, in words; empty where it is unknown."""
    variables, choices = decks.index_variables(site.folder / site_deck.NAME), site.choices
    rolling = [zone.values["rolling"]] if "rolling" in zone.values else choices.study.rolling
    runs = {f"{one:g}": of_zone(zone, choices.model, {**variables, "rolling": one}) for one in rolling}
    known = {name: f"{degrees:.1f}" for name, degrees in runs.items() if degrees is not None}
    return (f"zone {zone.name}: stop angle {', '.join(known.values())} degrees at a rolling resistance of "
            f"{', '.join(known)}" if known else "")
