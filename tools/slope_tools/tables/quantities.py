"""The quantities of a run: each once, with its column, name, unit, digits, and where it is shown.

Tables on the screen, study.csv, study.yaml, pages, charts, ensembles and their options read it here. A new one is an
entry and a field of a row, with its place in a summary; else studies/run_rows gives its value.
"""
from enum import Flag, auto
from typing import Any, Callable, Dict, Iterable, List, Mapping, NamedTuple, Sequence, Tuple, Union

from ..deposits import travel_shares
from ..digits import format_measured_share, to_three
from ..mobility.run_length import ON_PATH, STRAIGHT
from .rows import Finished

Form = Union[str, Callable[[Any], str]]     # how a value is written; "": not shown

WHOLE, TENTH, AS_IS = "{:,.0f}", "{:.1f}", "{}"
KNOWN = "known"         # with the digits that are known: by the scatter on a screen, else three


class On(Flag):
    """Where a quantity is, beside study.csv, and what is made of it."""
    NOWHERE = 0
    ASKED = auto()          # it has a number to ask for (--of), charts, quantiles of an ensemble
    MEAN = auto()           # mean and scatter of each combination
    PAGE_MEAN = auto()      # the same on a page, too
    INFLUENCE = auto()      # on which variables it depends, in an ensemble
    HIDDEN = auto()         # not in study.csv: another column has it for programs


class Quantity(NamedTuple):
    """One of a run: key in study.csv and in the rows of study.yaml."""
    key: str
    name: str               # in words; of charts and all that has room
    unit: str
    on: On = On.NOWHERE
    at: str = ""            # words of its place in a summary
    head: str = ""          # of tables; "": its name
    screen: Form = ""       # on the table of the screen
    page: Form = ""         # on that of a page
    keeps: int = 0          # columns that a narrow screen lacks first have less
    title: str = ""         # of a chart; "": its name
    maybe: bool = False     # runs may have none

    @property
    def heading(self) -> str:
        return self.head or self.name

    @property
    def on_screen(self) -> str:
        """Its head there: volumes are in m3, which the title of the table says."""
        unit = {"m3": "", "degrees": "deg"}.get(self.unit, self.unit)
        return f"{self.heading} {unit}".rstrip()

    @property
    def label(self) -> str:
        """Of an axis."""
        return f"{self.name} ({self.unit})"


ASKED, MEAN, PAGE_MEAN, MATTERS = On.ASKED, On.ASKED | On.MEAN, On.ASKED | On.MEAN | On.PAGE_MEAN, On.INFLUENCE
DISTANCE, REACH = travel_shares.DISTANCE, travel_shares.REACH
LENGTH, REMOVE, STOP = "length_m", "remove_m3", "stop_angle_deg"
OVERLAP, BEYOND_MAPPED = "overlap", "beyond_mapped_m"
SMALLER = travel_shares.SHARES[:-1]

# of every run
OF_RUN = (
    Quantity("released_m3", "released", "m3", MEAN, "volume released", screen=WHOLE, page=WHOLE, keeps=7),
    Quantity("on_grid_m3", "on grid", "m3", at="volume on_grid", screen=WHOLE, keeps=4),
    Quantity("off_grid_m3", "off the grid", "m3", at="volume off_grid"),
    Quantity("lost_m3", "lost", "m3", at="volume lost", screen=WHOLE, keeps=3),
    Quantity("residual_m3", "residual", "m3", at="volume residual"),
    *(Quantity(f"distance_{share}_m", f"{share} % within", "m", ASKED, maybe=True) for share in SMALLER),
    Quantity(DISTANCE, "99 % within", "m", PAGE_MEAN | MATTERS, screen=TENTH, page=KNOWN, keeps=10, maybe=True,
             title="Distance that 99 % of the volume stays within"),
    *(Quantity(f"reach_{share}_deg", f"reach angle of {share} %", "degrees", ASKED, maybe=True) for share in SMALLER),
    Quantity(REACH, "reach angle of 99 %", "degrees", MEAN, head="reach angle", screen=TENTH, page=KNOWN, keeps=2,
             maybe=True),
    Quantity(LENGTH, f"length {ON_PATH}", "m", PAGE_MEAN | MATTERS, head="length", screen=TENTH, page=KNOWN, keeps=12,
             maybe=True),
    Quantity("length_deg", "reach angle of that length", "degrees", ASKED, maybe=True),
    Quantity("front_m", "farthest ball", "m", MEAN, "travel front", screen=TENTH, page=KNOWN, keeps=6,
             title="Distance of the farthest ball"),
    Quantity("reach_angle_deg", "reach angle of the farthest ball", "degrees", ASKED, "travel reach_angle"),
    Quantity("centroid_m", "travel of the centroid", "m", PAGE_MEAN | MATTERS, "travel centroid", "centroid moved"),
    Quantity("thickness_m", "largest thickness at the end", "m", ASKED | MATTERS, "largest thickness", "thickness",
             page=KNOWN),
    Quantity("max_thickness_m", "largest thickness at any time", "m", ASKED, "largest max_thickness"),
    Quantity("max_speed_m_s", "largest speed", "m/s", ASKED | MATTERS, "largest max_speed"),
    Quantity("stop_time_s", "end of the run", "s", ASKED, "stop time", "ended at", TENTH, TENTH, 9),
    Quantity("stop_reason", "reason of the end", "", at="stop reason"),
    Quantity("moving", "moving", "", at="moving"),
    Quantity("at_rest", "at rest", ""),
    Quantity("end", "how the run ended", ""),
    Quantity("end_short", "end", "", On.HIDDEN, screen=AS_IS, keeps=13),
    Quantity("moves_share", "moves", "", On.HIDDEN, screen=format_measured_share, keeps=5),
    Quantity("wall_s", "wall time", "s", head="wall", screen=WHOLE, keeps=1, maybe=True))
# of runs with a road
OF_ROAD = (
    Quantity(REMOVE, "to remove", "m3", PAGE_MEAN | MATTERS, screen=KNOWN, page=KNOWN, keeps=15,
             title="Volume to remove from the road"),
    Quantity("remove_on_road_m3", "on the road", "m3", PAGE_MEAN | MATTERS, screen=KNOWN, page=KNOWN, keeps=14,
             title="Volume on the road"),
    Quantity("remove_beside_road_m3", "beside the road", "m3", ASKED),
    Quantity("before_road_m3", "before the road", "m3", ASKED, maybe=True),
    Quantity("on_road_m3", "on the road, or left the terrain on it", "m3", maybe=True),
    Quantity("beyond_road_m3", "beyond the road", "m3", PAGE_MEAN | MATTERS, head="beyond it", screen=KNOWN,
             page=KNOWN, keeps=11, maybe=True),
    Quantity("blocked_m", "blocked length", "m", ASKED | MATTERS, head="blocked", screen=WHOLE, page=KNOWN, keeps=8),
    Quantity("axis_thickness_m", "thickness on the road's axis", "m", ASKED))
# of those that were asked for, or for which it is known
IF_KNOWN = (
    Quantity(STOP, "stop angle of the ground", "degrees", head="stop angle", page=KNOWN),
    Quantity("remove_lane_m3", "to remove for a lane", "m3", ASKED),
    Quantity("lane_hours", "until a lane is open", "hours", ASKED),
    Quantity("clear_hours", "until the road is clear", "hours", ASKED),
    Quantity(OVERLAP, "overlap with the mapped deposit", "1"),
    Quantity(BEYOND_MAPPED, "farther than the mapped deposit", "m"))
NEED_ROAD = {one.key for one in (*OF_ROAD, *IF_KNOWN) if On.ASKED in one.on}

# those of a road first, which count
ALL: Dict[str, Quantity] = {one.key: one for one in (*OF_ROAD, *IF_KNOWN, *OF_RUN)}


def keys(where: On) -> List[str]:
    """Keys of those that are somewhere."""
    return [one.key for one in ALL.values() if where in one.on]


def volume_folder(road: str) -> str:
    """In that of a run: where the volume to remove from a road is; road: its name, if it is one of several."""
    return f"volume_{road}" if road else "volume"


def shown_on(what: str) -> List[Quantity]:
    """Those of the table of the screen or of a page, as study.csv has them."""
    return [one for one in (*OF_RUN, *OF_ROAD, *IF_KNOWN) if getattr(one, what)]


def known(where: On, rows: Iterable[Finished]) -> List[str]:
    """The same of which every run has a number."""
    several = list(rows)
    return [key for key in keys(where) if all(row.value(key) is not None for row in several)]


def name_quantity(key: str, rows: Iterable[Finished]) -> str:
    """What a quantity of some runs is called: a length is straight where a run has no fall path."""
    if key != LENGTH:
        return ALL[key].name
    kinds = {row.length_is for row in rows if row.length_is}
    return f"{STRAIGHT} length" if kinds == {STRAIGHT} else \
        f"length ({STRAIGHT} in some runs)" if STRAIGHT in kinds else ALL[key].name


def name_asked(rows: Sequence[Finished]) -> Dict[str, Tuple[str, str]]:
    """{key: (what it is called, unit)} of the quantities that may be asked for, of which every run has a number."""
    return {key: (name_quantity(key, rows), ALL[key].unit) for key in known(On.ASKED, rows)}


# --- values ---

def written(form: Form, value) -> str:
    """A value in one of its forms, but KNOWN."""
    return form(value) if callable(form) else form.format(value)


def of_summary(summary: Mapping[str, Any]) -> Dict[str, Any]:
    """Those that a summary has (run_folders.load_summary)."""
    def value(words):
        found: Any = summary
        for word in words:
            found = found[word]
        return found

    return {**{one.key: value(one.at.split()) for one in OF_RUN if one.at}, **travel_shares.read_share_columns(summary)}


def share_within(share: str, unit: str) -> str:
    """A share of runs or events that has a value or less: of angles, of which the least go farthest, no one stays
    within it."""
    return f"{share} {'have at most' if unit == 'degrees' else 'stay within'}"


def format_quantity(value, sign=""):
    """Three digits, whole numbers from 100 on: as a page has it."""
    value = to_three(value)
    return f"{value:{sign},.0f}" if abs(value) >= 100 else f"{value:{sign}.3g}"
