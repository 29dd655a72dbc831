"""The headline of study.yaml (statistics.answer): of what a study says, and of both studies of a site."""
import datetime
import functools
import math
from pathlib import Path
from shlex import quote
from typing import Any, List, Mapping, Optional, Sequence

from .. import schemas
from ..errors import SlopeError
from ..findings import Finding
from ..schemas import OBJECT, mapping
from ..statistics import answer
from ..statistics.answer import Answer, AtRoad, Code, Ensemble, Paper, Reason, Road, Size, Withheld
from ..statistics.withheld import Kind as Rule
from . import ensemble_types, study_types
from .quantities import REMOVE
from .rows import finished_of

STUDY = "study.yaml"
GROWS = 0.25        # by the last halving of the balls: a number that grows by more is a floor
INSIDE = "study", "ensemble"        # folders of a site: the sweep, and the ensemble of known events
TITLE = "slope study: volumes in m3 of ground (bulk), lengths in m, times in s"
SCHEMA = mapping({}, conservative=mapping({}, null=True), ensemble=mapping({}, null=True),
                 headline=mapping({}, null=True, road=mapping({}, null=True)), study=OBJECT)


def of_study(study: study_types.Study, road: Optional[Road]) -> Optional[Answer]:
    """Of one study.yaml; None without a road, and of an ensemble that no known events weigh."""
    return answer.combine_answers(paper_of(study), ensemble_of(study), road)


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
    stopped = weighted.added.stopped
    most = max((row.at_road.remove_m3 for row in finished_of(study.runs) if row.road), default=0.0)
    return Ensemble(weighted.to_remove, weighted.far, weighted.longest_m, rules(whole.withheld),
                    Reason.read(stopped) if stopped else None, most, size_of(study), weighted.path_end_m,
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


def road_of(study: study_types.Study) -> Optional[Road]:
    """That of a headline."""
    one = study.headline.road if study.headline else None
    if not one:
        return None
    (reached, more_reached), (passed, more_passed) = one.reached, one.passed
    return Road(one.near_m, one.far_m, (reached, more_reached), (passed, more_passed), one.longest_m,
                one.brought)


def governing(paper: Path, ensemble: Path) -> Path:
    """Of the folders of both studies of a site that whose number it is; the one that there is, if it is one.

    What both files say of it where one command made them; else the study that was made last, as the files say.
    """
    there = [one for one in (ensemble, paper) if (one / STUDY).is_file()]
    if len(there) < 2:
        return there[0] if there else paper
    studies = {one: schemas.load_checked(one / STUDY, "what `slope study` wrote", SCHEMA) for one in there}
    names = {(about.get("study") or {}).get("governs") for about in studies.values()}
    if len(names) == 1 and (named := [one for one in there if one.name in names]):
        return named[0]
    number, other = (about.get("headline") for about in studies.values())
    if number and number == other:
        return paper if number["source"] == answer.Source.PAPER.value else ensemble
    return max(there, key=lambda folder: made(studies[folder]))


def study_in(folder: Path, weighted: bool = False) -> Optional[Path]:
    """The folder of the study that a folder names: its own, else the one of a site that governs; None: there is none.

    weighted: of a site, rather the one whose runs known events weigh.
    """
    if (folder / STUDY).is_file():
        return folder
    paper, ensemble = (folder / name for name in INSIDE)
    found = ensemble if weighted and weighs(ensemble) else governing(paper, ensemble)
    return found if (found / STUDY).is_file() else None


def weighs(study: Path) -> bool:
    """Whether a folder has a study whose runs known events weigh."""
    if not (study / STUDY).is_file():
        return False
    about = schemas.load_checked(study / STUDY, "what `slope study` wrote", SCHEMA).get("ensemble") or {}
    return bool((about.get("known_events") or {}).get("weights"))


def without_study(site: Path) -> SlopeError:
    """Of the folder of a site whose study is asked for and not made yet."""
    return SlopeError(site, f"must hold the study of this site: `slope study {quote(str(site))}` makes it and the "
                      "report", f"no {site / INSIDE[0] / STUDY}")


def made(study: Mapping[str, Any]) -> datetime.datetime:
    """When a study was, by its study.yaml; the beginning of time where that does not say it."""
    text = str((study.get("study") or {}).get("collected"))
    try:
        return datetime.datetime.fromisoformat(text).astimezone(datetime.timezone.utc)
    except ValueError:
        return datetime.datetime.min.replace(tzinfo=datetime.timezone.utc)


def of_both(paper: study_types.Study, ensemble: study_types.Study) -> Optional[Answer]:
    """Of both studies of a site, of one command; None without a road."""
    roads = [one for one in map(road_of, (paper, ensemble)) if one]
    road = roads[-1]._replace(
        longest=max((one.longest for one in roads if one.longest is not None), default=None),
        brought=functools.reduce(AtRoad.and_of, [one.brought for one in roads])) if roads else None
    return answer.combine_answers(paper_of(paper), ensemble_of(ensemble), road)
