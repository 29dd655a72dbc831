"""Arguments of the commands that compare a mass with known events: which ones, and whether its path is confined."""
from dataclasses import dataclass
from typing import Any, List, Optional

from ..mobility import events, known
from ..mobility.known import CONFINED
from ..options import option, several
from ..sites.site_choices import Site
from ..sites.site_sections import OfMass

SETS = ("rock_avalanches (49 of Canada, the default; where they do not cover the mass, landslides of all sizes do), "
        f"or the landslides of a TYPE[:PATH] of Corominas (1996), {', '.join(events.TYPES)}; paths all, "
        "obstructed, deflected, channelized, unobstructed")


def known_option(use: str, *names: str) -> Any:
    """--known; use: what the events are for."""
    return option(f"{use}: {SETS}", *names, metavar="SET")


@dataclass(frozen=True, kw_only=True)
class Confined:
    """--confined and --unconfined."""
    GROUP = "known events"
    confined: Optional[str] = option(
        "whether the path is laterally confined, a valley; unknown (default): as often as those of the set are; "
        "without a value: yes", nargs="?", const="yes", choices=list(CONFINED), one_of="confined",
        also={"--unconfined": "no"})


@dataclass(frozen=True, kw_only=True)
class Known(Confined):
    """The same with --except, of the commands that compare with known events; they have a field known, too."""
    GROUP = "known events"
    left_out: List[str] = several("leave out this event of the set; may be given several times", "--except",
                                  metavar="NAME")


def choice_of(events: Optional[str], left_out: List[str], confined: Optional[str],
              site: Optional[Site] = None) -> known.Choice:
    """What these options ask for; what they leave open is that of a site, if there is one."""
    own = (site.choices if site else OfMass.of({})).known
    return known.choice(events or own.set, left_out, confined or own.confined)
