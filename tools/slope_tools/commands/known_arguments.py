"""Arguments of the commands that compare a mass with known events: which ones, and whether its path is confined."""
from pathlib import Path
from typing import Optional

from ..mobility import known, landslides
from ..mobility.exceedance import CONFINED
from ..sites import site_choices

SETS = ("rock_avalanches (49 of Canada, the default; where they do not cover the mass, landslides of all sizes do), "
        f"or the landslides of a TYPE[:PATH] of Corominas (1996), {', '.join(landslides.TYPES)}; paths all, "
        "obstructed, deflected, channelized, unobstructed")


def add_known(parser, alias: str, use: str) -> None:
    """--known, which has an older name, --except, --confined and --unconfined; use: what they are for."""
    parser.add_argument("--known", alias, metavar="SET", dest="known", help=f"{use}: EVENTS.csv, {SETS}")
    parser.add_argument("--except", metavar="NAME", dest="left_out", action="append", default=[],
                        help="leave out this event of the set; may be given several times")
    add_confined(parser.add_mutually_exclusive_group())


def add_site(group) -> None:
    """--known and --confined of a site, whose other commands take them from there."""
    group.add_argument("--known", metavar="SET",
                       help=f"events that the mass is compared with, in slope mobility and the study: {SETS}")
    add_confined(group.add_mutually_exclusive_group())


def add_confined(group) -> None:
    group.add_argument("--confined", nargs="?", const="yes", choices=list(CONFINED),
                       help="whether the path is laterally confined, a valley; unknown (default): as often as those "
                            "of the set are; without a value: yes")
    group.add_argument("--unconfined", action="store_const", const="no", dest="confined", help="--confined no")


def choice_of(args, site: Optional[Path] = None) -> known.Choice:
    """What they ask for; what they leave open is that of a site (a folder), if there is one."""
    own = site_choices.read(site)["known"] if site else {}
    return known.choice(args.known or own.get("set"), args.left_out, args.confined or own.get("confined", "unknown"))
