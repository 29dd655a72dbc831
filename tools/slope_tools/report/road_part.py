"""What a report shows of a road: its blocked stretches over the runs, the lane and the hours."""
from typing import Any, List, Mapping, Optional, Sequence

from ..deposits.axis import Span
from ..deposits.road_axis import axes_of, part_in_grid, width_of
from ..digits import percent
from ..plots import figure_charts, figure_maps, known_reach
from ..sites.site_roads import FOLDER
from ..studies import road_numbers
from ..survey.roads import Asked
from ..tables import ensemble_types, study_types
from ..tables.answer_words import describe_volume
from ..tables.road_runs import BODIES
from .data import Data
from .ensemble_part import ODDS
from .numbers import Numbers
from .sections import Cell, Figures, Picture, Section, Table

# head, unit, number of tables.road_runs
COLUMNS = (("length", "m", "length"), ("passable", "m", "passable_width"), ("to remove", "m3", "remove"),
           ("for a lane", "m3", "remove_lane"), ("until clear", "h", "hours"),
           ("until a lane is open", "h", "hours_lane"))


def make_road_section(data: Data, numbers: Numbers, maps) -> Optional[Section]:
    """Of a data.Data; None where no run blocks the road, or of older studies."""
    study = data.study
    stretches = study.stretches if study else None
    if not (study and stretches and stretches.stretches):
        return None
    asked, all_ = Asked.of(study.study.the_road), stretches.share_blocked
    columns = [one for one in COLUMNS if one[2] in stretches.stretches[0]]

    def cells(stretch, name):
        yield f"{100 * stretch.get('share', all_):.0f}"
        for head, unit, key in columns:
            low, middle, high = (numbers(f"{head}, {share} %", unit, value, name) for share, value in zip(
                (5, 50, 95), stretch[key])) if key in stretch else ("", "", "")
            yield f"{middle} ({low} to {high})" if low != high else middle

    lines = [[str(number), f"{one['from']:,.1f} to {one['to']:,.1f}", *cells(one, f"stretch {number}")]
             for number, one in enumerate(stretches.stretches, 1)]
    if len(lines) > 1:
        lines.append(["all", "", *cells(stretches.totals, "all stretches")])
    runs = "known events" if stretches.of_known_events else "runs"
    along = [Figures([bodies_along(stretches.bodies)])] if stretches.bodies else []
    heads: List[Any] = ["stretch", Cell("chainage", "m"), Cell("blocked in", f"% of {runs}"),
                        *(Cell(head, unit) for head, unit, _ in columns)]
    return Section("road", "Blocked stretches of the road", [
        Figures([draw_road_shares(data, asked, stretches, runs, maps)], "tall"), *along,
        Table(caption(asked, stretches, runs) + describe_gaps(data, stretches), heads, lines, ())])


def bodies_along(entries: Sequence[Mapping[str, Any]]) -> Picture:
    """Which of several bodies brings most to each 10 m of the road: entries of road_runs.by_body()."""
    title = "Which body brings most"
    return Picture(figure_charts.draw_side_bars([(one["from_m"], one["to_m"], one["mean_m3"], one["body"]) for one
                                                 in entries],
                                                "chainage (m)", "m3 on 10 m of the road", title), title,
                   "Of each 10 m of the road, the body whose runs leave most on it on the mean, given that it fails, "
                   f"and how much. All bodies: {BODIES}.csv.")


def make_roads_section(data: Data) -> Optional[Section]:
    """The roads of a site with several, the worst first; None of a single one."""
    several = road_numbers.read_road_numbers(data.study) if data.study else []
    if not several:
        return None
    rows = [[one.road, one.text, f"{one.reaching} of {one.runs}", f"{FOLDER}/{one.road}/{one.page}"]
            for one in several]
    return Section("roads", "The roads", [Table(
        "To remove: the number of the first page on each road, which is in the site's folder; runs: of both studies. "
        f"This page is of the worst, {several[0].road}: a number counts as its volume, also where at "
        "least so much is to be removed; a road without one as the largest of its runs.",
        ["road", "to remove", "runs that reach it", "its page"], rows, (0, 1, 2, 3))])


def describe_gaps(data: Data, stretches: study_types.Stretches) -> str:
    """Where known events end and no run does."""
    known = ensemble_types.weighted(data.of_study.ensemble) if stretches.of_known_events else None
    text = f" {percent(known.short)} of known events end before all runs and count as the shortest: fewer may block " \
        "it." if known and known.short else ""
    return text + "".join(f" {one.text[0].upper()}{one.text[1:]}." for one in (known.doubts if known else ())
                          if one.kind == "gap")


def caption(asked: Asked, stretches: study_types.Stretches, runs: str) -> str:
    text = (f"A stretch is a range of chainages each of which is blocked in one of {stretches.runs} runs: the deposit "
            f"is thicker than {asked.blocked:g} m somewhere across the road. Of each number the median, and in "
            f"brackets what 5 and 95 % of the {runs} stay within.")
    if asked.lane:
        text += f" For a lane: the least volume that opens one of {asked.lane:g} m, parallel to the road's axis."
    return text + (f" Hours: of {rate(asked)}, of ground that loosens by a factor of {asked.loosening:g}."
                   if asked.hours else "")


def rate(asked: Asked) -> str:
    return f"one loader of {asked.clearing:g} m3/h"


def draw_road_shares(data: Data, asked: Asked, stretches: study_types.Stretches, runs: str, maps):
    """The map of the road, coloured by the share of the runs that block it."""
    raster = data.result.deposit.raster
    axes, _ = axes_of(data.road_lines, data.road, asked, raster)
    width = asked.width or width_of(axes, part_in_grid(data.road, raster))
    parts = [(one.band(Span(low, high), Span(-width / 2, width / 2)), share)
             for low, high, share in stretches.shares for one in axes]
    layers = maps.layers._replace(section=None, reach=known_reach.NOTHING)
    title = "Where the road is blocked"
    return Picture(figure_maps.road_map(layers, parts, ODDS, title, f"share of the {runs}"), title,
                   f"Share of the {runs} in which the road is blocked, at each of its places.")


def on_first_page(data: Data, numbers: Numbers, withheld: bool) -> List[str]:
    """What lane and hours were asked for: a sentence in a list; none where neither was, or the numbers are withheld."""
    study = data.study
    stretches = study.stretches if study else None
    if not study or not stretches or withheld:
        return []
    asked, totals = Asked.of(study.study.the_road), stretches.totals

    def span(what: str, unit: str, key: str) -> str:
        low, _, high = (numbers(what, unit, value) for value in totals[key])
        return high if low == high else f"{low} to {high}"

    cells = []
    if "hours_lane" in totals:
        cells.append(f"A lane of {asked.lane:g} m is open after "
                     f"{span('until a lane is open', 'h', 'hours_lane')} hours")
    elif "remove_lane" in totals:
        cells.append(f"A lane of {asked.lane:g} m is open when "
                     f"{span('for a lane', 'm3', 'remove_lane')} m3 are removed")
    if "hours" in totals:
        cells.append(f"{'the whole road' if cells else 'The road is clear'} after "
                     f"{span('until clear', 'h', 'hours')} hours")
    if not cells:
        return []
    known = "known events" if stretches.of_known_events else "the runs"
    return [f"{', '.join(cells)}{f' of {rate(asked)}' if asked.hours else ''} (what 5 and 95 % of {known} stay within)"
            f"{describe_number_hours(study, asked, numbers)}."]


def describe_number_hours(study: study_types.Study, asked: Asked, numbers: Numbers) -> str:
    """What the number of the first page takes, which may be more than that of nearly all runs."""
    number = study.headline
    if not (asked.hours and number and number.volume_m3):
        return ""
    hours = numbers("until clear, the number of the first page", "h", number.volume_m3 * asked.hours)
    return f"; {describe_volume(number.kind, number.volume_m3, 'm3')} take {hours} hours"
