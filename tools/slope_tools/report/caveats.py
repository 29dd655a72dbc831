"""What a client must know beside the number: a line for each kind of doubt, counted, the weightiest first.

The appendix has all warnings, with the runs concerned and what mends them; see warnings.py.
"""
from typing import Any, List, NamedTuple, Optional, Sequence, Tuple

from .. import digits
from ..deposits.volume import MUCH_BELOW
from ..sites.site_warnings import LARGE
from . import structures_part
from .warnings import SMALL

MOST = 3
MUCH = 0.01             # of the released volume that is lost: more weighs as much as a wrong body
SIDE = 0.5              # of the mass at the most touched edge: another edge with as much is named too
# by weight, the heaviest first
(FAILED, MOVING, LOST_MUCH, BODY, ROAD, LARGE_MASS, NOT_AT_REST, NO_REPEATS, NO_SIZES, COARSE, CUT, THIN_BODY, LOST,
 SLIP) = range(14)


class Caveat(NamedTuple):
    """A doubt; order: of its kind, small ones weigh more."""
    order: int
    text: str


def caveats(data, ground) -> List[Caveat]:
    """All of a data.Data on its ground.Ground, by weight, one of each kind."""
    found = [failed(data), *at_rest(data), lost(data, ground), body(data), road(data),
             large(data), repeats(data), sizes(data), coarse(data, ground),
             below_ground(data), thin(data),
             Caveat(SLIP, "The slip surface is an assumption: whether, and how likely, the slope fails is not said "
                          "here.")]
    return sorted((one for one in found if one), key=lambda one: one.order)


def of_runs(count: int, runs: int) -> str:
    """How many of them, as the subject of a sentence."""
    return "The run" if runs == 1 else f"All {runs} runs" if count == runs else f"{count} of {runs} runs"


def failed(data) -> Optional[Caveat]:
    count = len(data.rows) - len(data.finished)
    return Caveat(FAILED, f"{of_runs(count, len(data.rows))} failed and are not in the numbers.") if count else None


def at_rest(data) -> List[Caveat]:
    ends = data.ends()
    found = []
    for order, moving, text in ((MOVING, True, "ended with more than a tenth of the mass in motion: the numbers are "
                                               "not those of a deposit."),
                                (NOT_AT_REST, False, "ended before the whole mass was at rest: it may go a little "
                                                     "farther.")):
        count = sum(not end.at_rest and end.moving == moving for end in ends)
        if count:
            found.append(Caveat(order, f"{of_runs(count, len(ends))} {text}"))
    return found


def lost(data, ground) -> Optional[Caveat]:
    """Mass that left the terrain: how much, and to which side."""
    if data.study:
        rows = [(row["off_grid_m3"] + row["lost_m3"], row["released_m3"]) for row in data.finished]
    else:
        volume = data.result.summary["volume"]
        rows = [(volume["off_grid"] + volume["lost"], volume["released"])]
    gone = [row for row in rows if row[0] > SMALL * row[1]]
    if not gone:
        return None
    most = max(left for left, _ in gone)
    side = side_of(ground)
    text = (f"{of_runs(len(gone), len(rows))} lost {'up to ' * (len(gone) > 1)}{digits.cubic(most)} over the edge: "
            f"enlarge the terrain{f' {side}' * bool(side)}.")
    return Caveat(LOST_MUCH if any(left > MUCH * released for left, released in gone) else LOST, text)


def side_of(ground) -> str:
    """Towards which side the mass left, by the depth of what reached each edge of the shown run; "" if none did."""
    z = ground.max_thickness
    edges = {"north": z[0].sum(), "south": z[-1].sum(), "west": z[:, 0].sum(), "east": z[:, -1].sum()}
    most = max(edges.values())
    if not most > 0:
        return ""
    named = [name for name, value in edges.items() if value > SIDE * most]
    if ground.raster.crs is None:       # nobody knows where north is
        sides = {"north": "upper", "south": "lower", "west": "left", "east": "right"}
        return f"beyond the {' and the '.join(sides[name] for name in named)} edge of the map"
    return "to the " + ("-".join(named) if len(named) == 2 and named[0] in ("north", "south")
                        and named[1] in ("west", "east") else " and the ".join(named))


def body(data) -> Optional[Caveat]:
    found = [one for _, one in data.releases() if one.doubt]
    if not found:
        return None
    return Caveat(BODY, f"{of_runs(len(found), len(data.releases()))} released a mass that may not be the body: "
                        f"{digits.cubic(found[0].released)}"
                        + (f" of {digits.cubic(found[0].body)}." if found[0].body else "."))


def large(data) -> Optional[Caveat]:
    if data.largest_release() < LARGE:
        return None
    return Caveat(LARGE_MASS, f"Masses of {LARGE / 1e6:g} million m³ and more are known to run farther than laboratory "
                              "friction suggests: the reach is not conservative unless a past event was used to "
                              "calibrate it.")


def repeats(data) -> Optional[Caveat]:
    if data.repeats or data.study and data.study.get("ensemble"):
        return None
    return Caveat(NO_REPEATS, "No run was repeated: how much chance changes the numbers, usually several percent, is "
                              "unknown.")


def sizes(data) -> Optional[Caveat]:
    best: Any = data.study and data.study["conservative"]
    if best and best["size_m3"] is not None or data.study and data.study.get("ensemble"):
        return None
    if best and data.study.get("size_error_unusable") and best.get("withheld"):
        return None         # the number's place says so
    return Caveat(NO_SIZES, "What smaller balls in the model would change is unknown.")


def coarse(data, ground) -> Optional[Caveat]:
    found = structures_part.coarse_walls(data, ground)
    if not found:
        return None
    name, tall, ball = max(found, key=lambda one: one[2] / one[1])
    return Caveat(COARSE, f"{name} is {tall / ball:.2g} of the model's balls high: the forces on it are those of "
                          "single balls, and rough.")


def road(data) -> Optional[Caveat]:
    if not any(row.get("road_on_body_m2") for row in data.finished):       # none in older files
        return None
    return Caveat(ROAD, "A part of the road lies on the mass that is released, and goes with it: what it takes to "
                        "build it anew is not in the volume.")


def below_ground(data) -> Optional[Caveat]:
    below, share = data.below_ground() or (0, 0)
    if share <= MUCH_BELOW:
        return None
    return Caveat(CUT, f"{100 * share:.0f} % of the volume to remove lies where the hillside is as steep as the cut or "
                       "steeper: a steeper cut gives less.")


def thin(data) -> Optional[Caveat]:
    balls = next((one.numbers["balls"] for one in data.warnings() if one.kind == "thin"), None)
    return None if balls is None else Caveat(
        THIN_BODY, f"The body is only {balls:.1f} of the model's balls thick on average: the numbers are rough.")


def shown(found: Sequence[Caveat], all_warnings: int) -> Tuple[List[str], str]:
    """Those of the first page, and what it says of all others."""
    first = f"The appendix has {'both warnings' if all_warnings == 2 else f'all {all_warnings} warnings'}, the" \
        if all_warnings > 1 else "The appendix has the warning, the" if all_warnings else \
        "The programs gave no warnings. The appendix has the"
    return [one.text for one in found[:MOST]], f"{first} settings, the runs and the checks."
