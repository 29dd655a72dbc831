"""How far the mass goes with the most elastic rock: runs with soil, slip surface and ground at the largest restitution.

They estimate the area, after Nakase et al., and reach; the ground's restitution is ours. They are none of those that
the volume is of.
"""
from dataclasses import replace
from pathlib import Path
from typing import Dict, List, NamedTuple, Optional, Sequence, Tuple

from .. import disk
from ..case import run_folders
from ..digits import rounded
from . import study_types
from .quantities import ALL, DISTANCE, LENGTH
from .rows import Failed, Finished, Row, finished_of

ENTRY = "largest_restitution"           # of study.yaml
FILE = f"{ENTRY}.csv"
VARIABLES = "restitution", "field_e"    # of a site's deck: soil and slip surface, ground
AREA, THICK = "area_m2", 0.1            # where the deposit is thicker than this, m
COMPARED = DISTANCE, LENGTH, "front_m", AREA


class Made(NamedTuple):
    """Runs with the largest restitution, at the least rolling resistance."""
    restitution: float
    rolling: str
    rows: Sequence[Row]


class Spread(NamedTuple):
    """A run that finished; area: m2, of its deposit."""
    row: Finished
    area: float

    def value(self, key: str) -> Optional[float]:
        """Of COMPARED."""
        return self.area if key == AREA else self.row.value(key)


class Runs(NamedTuple):
    """Those that finished; others: of the study's own runs."""
    made: Made
    elastic: Sequence[Spread]
    others: Sequence[Spread]


def read_elastic_runs(made: Made, rows: Sequence[Row], output: Path) -> Runs:
    """rows: of the study's own runs, in whose folder their summaries are named."""
    return Runs(made, with_area(made.rows, output), with_area([row for row in rows if not row.batch], output))


def evaluate_elastic(runs: Runs) -> study_types.Elastic:
    """The entry of study.yaml."""
    made, elastic, others = runs
    quantities: Dict[str, study_types.ElasticQuantity] = {}
    if elastic:
        first = elastic[0].row.variables
        same = [one for one in others if all(one.row.variables.get(name) == first.get(name)
                                             for name in one.row.set if name not in VARIABLES)]
        for key in COMPARED:
            found = measure_span(elastic, key)
            if found is not None:
                quantities[key] = study_types.ElasticQuantity(found.mean, found.low, found.high,
                                                              measure_span(same, key), measure_span(others, key))
    about = study_types.Elastic(
        made.restitution, made.rolling, THICK, [one.row.run for one in elastic],
        [row.run for row in made.rows if isinstance(row, Failed)],
        [one.row.run for one in elastic if not one.row.at_rest], quantities, "")
    return replace(about, text=describe_elastic(about))


def with_area(rows: Sequence[Row], output: Path) -> List[Spread]:
    """Those that finished, with the area of the deposit."""
    found = []
    for row in finished_of(rows):
        deposit = run_folders.load_raster(run_folders.prefix_of(run_folders.summary_of(output, row.summary)),
                                          "thickness")
        found.append(Spread(row, float((deposit.z > THICK).sum()) * deposit.transform.a ** 2))
    return found


def measure_span(runs: Sequence[Spread], key: str) -> Optional[study_types.Span]:
    """Mean and ends; None where there are no runs, or one without a number."""
    values = [value for one in runs if (value := one.value(key)) is not None]
    if not values or len(values) < len(runs):
        return None
    return study_types.Span(sum(values) / len(values), min(values), max(values))


def tabulate_elastic(runs: Runs) -> str:
    """The CSV: a line for each run, those with the largest restitution first; "" where none of these finished."""
    if not runs.elastic:
        return ""
    return disk.csv_text(["run", ENTRY, *COMPARED],
                         ([one.row.run, largest, *map(one.value, COMPARED)]
                          for largest, several in (("yes", runs.elastic), ("no", runs.others)) for one in several))


# --- words ---

def describe_elastic(elastic: study_types.Elastic) -> str:
    """A sentence without its full stop."""
    runs = len(elastic.runs)
    if not runs:
        return f"not known: {', '.join(elastic.failed)} failed"
    text = (f"restitution {elastic.restitution:g} of soil, slip surface and ground, rolling {elastic.rolling}, "
            f"{runs} run{'s' * (runs != 1)}: ")
    distance, area = (elastic.quantities.get(key) for key in (DISTANCE, AREA))
    if distance is None:
        text += "how far the mass goes is not known, as more than 1 % of it left the terrain"
    else:
        text += f"99 % of the volume stays within {format_span(distance, 'm')}{instead(distance, 'm')}"
    if area:
        text += f"; the deposit covers {format_span(area, 'm2')}{instead(area, 'm2')}"
    for which, what in ((elastic.failed, "failed"), (elastic.moving, "had not come to rest")):
        if which:
            text += f"; {len(which)} {what}"
    return text


def format_span(span: study_types.Span, unit: str) -> str:
    ends = [rounded(end, 3) for end in (span.low, span.high)]
    return f"{rounded(span.mean, 3)} {unit}" + (f" ({' to '.join(ends)})" if ends[0] != ends[1] else "")


def instead(quantity: study_types.ElasticQuantity, unit: str) -> str:
    """What the study's own runs have: the same ones otherwise, and the largest of all."""
    if not quantity.usual or not quantity.study:
        return ""
    return (f" instead of {format_span(quantity.usual, unit)}; all other runs, up to {rounded(quantity.study.high, 3)} "
            f"{unit}")


def name_elastic_quantity(key: str, elastic: study_types.Elastic) -> Tuple[str, str]:
    """What one of COMPARED is called, and its unit."""
    if key == AREA:
        return f"area under more than {elastic.thicker_than_m:g} m", "m2"
    return ALL[key].name, ALL[key].unit
