"""What the ground of a site holds: its stop angle, and how much of the slope below the body is steeper."""
from pathlib import Path
from typing import Any, Dict, List, Mapping, Optional

from ..case import decks
from ..errors import SlopeError
from ..mobility import body, steeper
from ..sites import ground, site_choices, site_deck
from ..sites.stop_angle import stop_angle

FIELD_SIZE = 1e-6       # of d; the table is of grounds of balls as large as the soil's


def of_variables(variables: Optional[Mapping[str, Any]]) -> Optional[float]:
    """The stop angle (degrees) of a run's ground by the values of its deck's variables; None where it is unknown."""
    values = variables or {}
    try:
        d, field = (float(values[name]) if values[name] != ground.SCALED else None for name in ("d", "field_d"))
        if field is not None and d is not None and abs(field - d) > FIELD_SIZE * d:
            return None
        scattered = ground.SEED in values or str(values.get("pattern", "")).startswith("scattered")
        return stop_angle(float(values["spacing"]), float(values["friction"]), float(values["rolling"]),
                          float(values["field_e"]), "scattered" if scattered else "grid").degrees
    except (KeyError, ValueError):
        return None     # of a deck that has no such ground


def stop_angles(folder: Path) -> Dict[str, Optional[float]]:
    """Of a site's folder: {rolling resistance: stop angle (degrees), None outside of the table}."""
    variables = decks.index_variables(folder / site_deck.NAME)
    return {f"{one:g}": of_variables({**variables, "rolling": one})
            for one in site_choices.read(folder)["study"]["rolling"]}


def lines(folder: Path) -> List[str]:
    """In words, a line; none where the stop angle is unknown."""
    known = {name: degrees for name, degrees in stop_angles(folder).items() if degrees is not None}
    if not known:
        return []
    text = (f"the ground: stop angle {', '.join(f'{degrees:.1f}' for degrees in known.values())} degrees at a rolling "
            f"resistance of {', '.join(known)}")
    try:
        slope = steeper.below(body.of_site(folder))
    except SlopeError:      # a level body has no fall path
        return [text]
    return [f"{text}; of the slope below the body "
            f"{', '.join(f'{100 * slope.steeper(degrees):.0f}' for degrees in known.values())} % is steeper"]
