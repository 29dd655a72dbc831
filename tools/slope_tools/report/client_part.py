"""The first page of a report, which a client reads: the letter, the next step, caveats, a table of what else is found.

No names of options, variables or files: these are in the appendix, and on the console.
"""
from typing import Any, Dict, List, Tuple

from .. import digits
from ..statistics.entries import Kind
from ..studies import letter
from ..studies.letter import Letter
from ..tables import how_far, judged, next_step, sizes
from ..tables.quantities import ALL
from ..tables.structures import per_metre
from . import body, mobility_part, road_part, warnings
from .data import Data
from .numbers import Numbers
from .sections import Pairs


def make_client_content(data: Data, ground, numbers: Numbers, findings, listed: int) -> Dict[str, Any]:
    """What the template takes; findings: all findings; listed: how many warnings the appendix has."""
    letter_ = letter_of(data, ground)
    paragraphs = letter.write_letter(letter_, numbers)
    if len(letter_.bodies) < 2:
        paragraphs = paragraphs._replace(down=body.sentence(body.of_data(data, ground)))
    step = data.study.next_step if data.study else None
    kind = letter_.number.kind if letter_.number else Kind.NUMBER
    if letter_.drawn and letter_.drawn.withheld:
        kind, step = Kind.WITHHELD, next_step.first_remedy(next_step.Made(data.of_study, data.folder))
    return {"letter": paragraphs, "kind": kind.value, "step": step,
            "table": tabulate_ranges(data, numbers, kind),
            "rest": warnings.rest_of(listed), "caveats": warnings.first_page([
                each for each in findings if each.kind not in letter_.lacks])[:warnings.MOST]}


def letter_of(data: Data, ground) -> Letter:
    """That of a study, or of a run alone."""
    if data.study:
        return letter.make_letter(data.study)
    row = data.result.row
    return Letter(row.released_m3, None, None, how_far.reach([row], None, ground.known), [],
                  [one.kind for one in judged.limits(None, False)], sizes.alone(row.released_m3 / row.ball_m3))


# --- what else is found ---

def tabulate_ranges(data: Data, numbers: Numbers, kind: Kind) -> Pairs:
    """Of the runs of this page, the least and the most of all, each counted alike."""
    cleared = road_part.on_first_page(data, numbers, kind is Kind.WITHHELD)
    rows = [*on_road(data, numbers), *(("clearing", text) for text in cleared), *moving(data, numbers),
            *structures(data), *mapped(data, numbers)]
    runs = letter.describe_alike_runs(data.study) if data.study else ""
    return Pairs(rows, caption=runs and f"From the least to the most of {runs}, each counted alike.")


def span(numbers, key, values) -> str:
    """The smallest and the largest values of a quantity as text with its unit."""
    low, high = (numbers.quantity(key, value) for value in (min(values), max(values)))
    unit = ALL[key].unit
    return f"{low} {unit}" if low == high else f"{low} to {high} {unit}"


def on_road(data: Data, numbers: Numbers) -> List[Tuple[str, str]]:
    """What lies on the road, where there is one."""
    if data.road is None:
        return []
    rows = [("on the road itself", span(numbers, "remove_on_road_m3", [row.value("remove_on_road_m3")
                                                                       for row in data.finished]))]
    blocked = [row.at_road.blocked_m for row in data.finished if row.road]
    beyond = [past for row in data.finished if row.road and (past := row.road.beyond_road_m3) is not None]
    for what, key, values in (("length of it that is blocked", "blocked_m", blocked),
                              ("comes to lie beyond it", "beyond_road_m3", beyond)):
        if values and max(values) > 0:
            rows.append((what, span(numbers, key, values)))
    return rows


def moving(data: Data, numbers: Numbers) -> List[Tuple[str, str]]:
    rows = data.compared
    return [(what, span(numbers, key, [row.value(key) for row in rows])) for what, key in (
        ("thickest deposit", "thickness_m"), ("fastest part of the mass", "max_speed_m_s"))]


def structures(data: Data) -> List[Tuple[str, str]]:
    """The largest lasting force on a structure."""
    forces = [(numbers["mean_force_n"], name, per_metre(numbers, row.ball_m3 ** (1 / 3)) or 0.0)
              for row in data.finished for name, numbers in row.structures.items()]
    if not forces:
        return []
    force, name = max(each[:2] for each in forces)
    in_motion = any(row.moving for row in data.finished)
    if not force > 0:
        return [("force on structures", "nothing touches them" + " before the runs end, in motion" * in_motion)]
    text = f"{'at least ' * in_motion}{digits.si(force, 'N')}, on {name}"
    mine = max(each for _, other, each in forces if other == name)
    most, hardest = max((each, other) for _, other, each in forces)
    if mine > 0:
        text += f", at least {digits.si(mine, 'N')} per metre of the length that bears it"
    if most > mine:
        text += f"; at least {digits.si(most, 'N')} per metre on {hardest}"
    return [("largest force that lasts half a second", text)]


def mapped(data: Data, numbers: Numbers) -> List[Tuple[str, str]]:
    text = mobility_part.mapped_sentence(data, numbers)
    return [("the mapped deposit", text)] if text else []
