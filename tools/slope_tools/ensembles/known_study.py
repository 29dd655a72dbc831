"""The ensemble that is a site's study where a set of known events covers the mass: how many runs, of what.

Its runs go from masses as sluggish as the defaults to rock avalanches, and count as known events of this volume and
height say (known_events). Where no set covers the mass, the study is that of the paper: the largest volume over rolling
resistances.
"""
from pathlib import Path

from ..errors import SlopeError
from ..mobility import body, events, known, relation

SET = events.OWN.stem
PAPER = "by the paper's method"
ASKED = f"{PAPER}, as asked for"
POINTS = 64             # a power of two: even in all directions
# --vary, unless it is given: from values back-calculated for rock avalanches (doc/src/events.rst) to the defaults
VARY = ("friction=5:30", "rolling=0:0.15", "spacing=0.3:0.95", "xoffset=0:0.99")


def covers(volume: float) -> bool:
    """Whether our set has events of a volume (m3)."""
    low, high = relation.of_events(events.read()).volumes
    return low <= volume / 1e6 <= high


def points(volume: float) -> int:
    """The runs of the ensemble of a mass of a volume (m3); 0 where known events do not cover it."""
    return POINTS if covers(volume) else 0


def why_not(site: Path, volume: float, observed: bool, confined: str) -> str:
    """Why the study of a site is not weighted by known events; empty: it is.

    volume: of its body, m3; observed: whether a mapped deposit is given; confined: yes, no, unknown, its path.
    """
    if observed:
        return "a mapped deposit is given, with which a single run is compared"
    if not covers(volume):
        low, high = relation.of_events(events.read()).volumes
        return (f"no set of known events covers this volume, {volume:,.0f} m3; ours has {low:g} to {high:g} "
                "million m3")
    try:
        found = known.one_of_body(body.of_site(site), known.choice(confined=confined))
    except SlopeError as error:
        return f"the mass cannot be compared with known events: {error}"
    return "; ".join(found.outside)
