"""The number of page 1, made once: of a study's conservative volume, of its weighted ensemble, or of both studies of a
site (statistics.answer takes the larger); with it which study governs, and the next step.

The volumes come from combinations.conservative() and ensembles/known_events; words are made in studies/letter.
"""
import functools
import math
from dataclasses import replace
from pathlib import Path
from typing import Any, Dict, List, Mapping, Optional, Sequence

from ..findings import Finding
from ..statistics.answer import Code, Ensemble, Headline, Paper, Reason, Size, Withheld, combine_answers
from ..statistics.entries import Road
from ..statistics.withheld import Kind as Rule
from . import ensemble_types, next_step, study_types
from .quantities import REMOVE
from .rows import finished_of

GROWS = 0.25        # by the last halving of the balls: a number that grows by more is a floor


def conclude(studies: Mapping[Path, study_types.Study], given: Any = None) -> Dict[Path, study_types.Study]:
    """The studies of one command with what all of them say, the one that governs first.

    studies: by their folders, of a site the sweep before the ensemble; given: the request, for the next step.
    """
    number = make_headline(list(studies.values()))
    made = [next_step.Made(study, folder, given=given) for folder, study in studies.items()]
    step, sweep = next_step.of_studies(made, number), made[0].study
    governs = next((each for each in made if number and each.source is number.source), made[-1])
    return {each.folder: replace(
        each.study, study=replace(each.study.study, governs=governs.folder.name), headline=number, at_road=None,
        next_step=step, reach=sweep.reach, largest_restitution=sweep.largest_restitution)
        for each in sorted(made, key=lambda each: each is not governs)}


def make_headline(studies: Sequence[study_types.Study]) -> Optional[Headline]:
    """Of one study, or of both of a site; None without a road, and of an ensemble alone that no known events weigh."""
    paper = next(filter(None, map(paper_of, studies)), None)
    ensemble = next(filter(None, map(ensemble_of, studies)), None)
    roads = [study.at_road for study in studies if study.at_road and (study.conservative or ensemble_of(study))]
    return combine_answers(paper, ensemble, functools.reduce(Road.and_of, roads) if roads else None)


def paper_of(study: study_types.Study) -> Optional[Paper]:
    """Its conservative volume, if it has one, rounded up as it is shown."""
    best = study.conservative
    if not best:
        return None
    least = None if best.chance_m3 is None else best.mean_m3 - best.chance_m3
    return Paper(best.rounded["volume_m3"], rules(best.withheld), least, best.transfer_m3 or (0.0, 0.0), size_of(study),
                 released_of(study), len(finished_of(study.runs)))


def ensemble_of(study: study_types.Study) -> Optional[Ensemble]:
    """Its weighted ensemble, if it has one with volumes."""
    whole, weighted = study.ensemble, ensemble_types.weighted(study.ensemble)
    if not whole or not weighted or not weighted.to_remove:
        return None
    most = max((row.at_road.remove_m3 for row in finished_of(study.runs) if row.road), default=0.0)
    return Ensemble(weighted.to_remove, weighted.far, weighted.longest_m, rules(whole.withheld),
                    weighted.added.stopped, most, size_of(study), weighted.path_end_m,
                    released_of(study), weighted.runs)


def released_of(study: study_types.Study) -> float:
    """m3 of the largest body; infinite without a run."""
    return max((row.released_m3 for row in finished_of(study.runs)), default=math.inf)


def size_of(study: study_types.Study) -> Size:
    """What the size of the balls leaves open of the volume to remove: a floor with fewer than two halvings, or where
    the last one grows by more than GROWS."""
    size = study.size
    if size is None:
        return Size(floor=Reason(Code.SIZE, {"sizes": 1, "grown": None}))
    effect = size.effects.get(REMOVE)
    left = effect.left if effect else None
    grown = left.grown if left else None
    reason = Reason(Code.SIZE, {"sizes": len(size.sizes), "grown": grown})
    if left is None:
        return Size(floor=reason)
    return Size(left.low, left.high, reason if left.grown > GROWS else None)


def rules(reasons: Sequence[Finding]) -> List[Withheld]:
    """Of withheld_words.with_remedies()."""
    return [Withheld(Rule(one.kind), one.numbers.get("number"), one.numbers.get("bound")) for one in reasons]
