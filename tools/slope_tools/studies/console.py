"""What a study tells on the console: its tables and numbers, in words, and where they are."""
from pathlib import Path
from typing import Any, Callable, List

from ..ensembles import ensemble, known_study
from ..seismic import chain_files
from ..tables import combinations, intensity, road_runs, structures, study_table, study_types
from . import letter, mapped
from .outcome import Outcome

SHOWN = 20              # runs of an ensemble whose table is printed


def tell(outcome: Outcome, study: study_types.Study, output: Path, say: Callable[[Any], Any],
         warn: Callable[[Any], Any]) -> None:
    """study: what study.yaml says; say: what gets lines and tables; warn: what gets findings."""
    asked, rows, finished = outcome.questions, outcome.read.rows, outcome.read.finished
    if study.intensity:
        say(intensity.shown_of(study.intensity))
        say(f"{output / intensity.FILE}: volume on the road against {study.intensity.variable}, and how likely "
            "more is")
    for table in structures.list_structure_tables(finished):
        say(table)
    files = [str(output / name) for what, name in structures.FILES.items() if any(row.value(what) for row in finished)]
    if files:
        say(f"{', '.join(files)}: of each run")
    for one in study.warnings:
        warn(one)
    if not asked.order or len(rows) <= SHOWN:
        say(study_table.runs_shown(asked.settings, rows, outcome.scatters,
                                   f"{study.study.deck}: {len(rows)} run{'s' * (len(rows) != 1)}, volumes in m3 "
                                   "of ground"))
    if any(outcome.scatters.values()) and not asked.order:
        say(study_table.combinations_shown(asked.settings, outcome.groups, outcome.scatters))
    if stretches := study.stretches:
        say(f"{output / road_runs.FILE}: {len(stretches.stretches)} stretches of the road that runs block")
    say(f"{output / 'study.yaml'}, {output / 'study.csv'}, {output / 'combinations.csv'}: all numbers")
    tell_numbers(study, output, say)
    if study.observed:
        say("\n".join(mapped.describe_mapped(study.observed, rows)))
    if study.chain:
        say("\n".join(chain_files.describe_chain(study.chain, output)))
    if finished and asked.method not in known_study.OF_BOTH:
        say("\n".join(tell_letter(study)))
    for entry in [*(study.envelope or {}).values(), *(study.exceedance or ())]:
        say(f"{output / entry['file']}: {entry['what']}")


def tell_letter(study: study_types.Study) -> List[str]:
    """What the first page begins with; a line each."""
    return [*letter.list_letter_lines(letter.make_letter(study)), *([str(study.next_step)] if study.next_step else [])]


def tell_numbers(study: study_types.Study, output: Path, say: Callable[[Any], Any]) -> None:
    """The conservative volume, the effects of step and size, the ensemble."""
    if study.conservative:
        say("\n".join(combinations.describe_combinations(study.conservative)))
        if study.step:
            say(study.step.text)
    if study.largest_restitution:
        say(study.largest_restitution.text)
    if study.ensemble:
        say("\n".join(ensemble.describe_ensemble(study.ensemble)))
        say(f"{output / ensemble.HAZARD}, {output / ensemble.INFLUENCE}: all curves and indices; "
            f"{output / ensemble.MAPS}: {len(study.ensemble.maps)} maps of quantiles and exceedance")
