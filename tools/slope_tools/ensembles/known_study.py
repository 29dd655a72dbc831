"""The ensemble of a site's study, which counts as known events of this volume and height say: how many runs, of what.

Its runs go from masses as sluggish as the defaults to rock avalanches. Beside it stands the sweep, the largest
volume over rolling resistances and grounds; the larger of both counts (tables.headline).
"""
from pathlib import Path

from ..errors import SlopeError
from ..mobility import body

SWEEP = "by a sweep"
ASKED = f"{SWEEP}, as asked for"
BESIDE = f"{SWEEP}, beside runs that are weighted by known events"
NONE = "site.yaml asks for no runs that are weighted by known events (study.points)"
WEIGHTED = "weighted by known events of this volume and height, beside a sweep"
OF_BOTH = (BESIDE, WEIGHTED)        # methods of the two studies that give one number together
# --vary, unless it is given: from values back-calculated for rock avalanches (doc/src/events.rst) to the defaults
# and site_choices.CHANCE
VARY = ("friction=5:30", "rolling=0:0.15", "spacing=0.3:0.95", "field_e=0.05:0.5")
# bounds of runs that are added towards longer ones; between them the density is that of VARY
WIDE = {"friction": (2.0, 30.0), "spacing": (0.2, 0.95)}


def why_not(site: Path) -> str:
    """Why the runs of a site cannot be compared with known events; empty: they can."""
    try:
        body.read_mobility_body(site).fall_line()
    except SlopeError as error:
        return f"the mass cannot be compared with known events: {error}"
    return ""
