"""The number of page 1, made once: of a study's conservative volume, of its weighted ensemble, or of both studies of a
site (the larger); with it which study governs, and the next step.

A sweep gives a conservative volume (combinations.conservative()), an ensemble that is weighted by known events the
volume that SHARE of them stay within (ensembles/known_events). Words are made in studies/letter.
"""
import functools
import math
from dataclasses import replace
from pathlib import Path
from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from ..findings import Finding
from ..statistics import rounding
from ..statistics.entries import (Cause, Code, EnsemblePart, Headline, Kind, KnownQuantile, Reason, Road, Share,
                                  Source, SweepPart)
from ..statistics.withheld import Kind as Rule
from . import ensemble_types, next_step, study_types
from .quantities import REMOVE
from .rows import finished_of

SHARE = 0.95            # of the known events, which stay within the volume
MANY = 0.1              # of the known events: if more reach a road that no run does, its volume is a floor
# rules that say of a number that it is small, or that few of the known were run: the other study makes up for them
HARMLESS = Rule.BALLS, Rule.MOBILITY
GROWS = 0.25            # by the last halving of the balls: a number that grows by more is a floor


class Size(NamedTuple):
    """What the size of the balls leaves open.

    low, high: what finer ones would change, shares of a number; floor: why there is no more than a lower bound.
    """
    low: float = 0.0
    high: float = 0.0
    floor: Optional[Reason] = None

    @property
    def known(self) -> bool:
        """Whether it is known what finer ones would change, without which nothing is a bound."""
        return self.floor is None or self.floor.numbers["grown"] is not None

    def share(self, value: float) -> Share:
        return Share(Cause.SIZE.value, -self.low * value, self.high * value)


class Sweep(NamedTuple):
    """The conservative volume (m3) of a sweep; None where it is withheld.

    least: m3, what runs lie above as well; None: chance is not known; transfer: m3 below and above; released: m3, of
    the largest body, more than which is not to be removed.
    """
    volume: Optional[float]
    withheld: Sequence[Finding] = ()
    least: Optional[float] = None
    transfer: Sequence[float] = (0.0, 0.0)
    size: Size = Size()
    released: float = math.inf
    runs: int = 0


class Ensemble(NamedTuple):
    """A weighted ensemble: quantiles (m3) of choose_known_shares().

    far: share of the known events beyond all runs; longest: m; stopped: why no more runs were added, None: enough were.
    most: m3, of a run; size, released, runs: as of Sweep; path_end: m, of a fall path that ends before the longest run:
    far is the share beyond it.
    """
    quantiles: Sequence[KnownQuantile]
    far: float
    longest: float
    withheld: Sequence[Finding] = ()
    stopped: Optional[Reason] = None
    most: float = 0.0
    size: Size = Size()
    path_end: Optional[float] = None
    released: float = math.inf
    runs: int = 0

    def at(self, share: float) -> Optional[KnownQuantile]:
        return next((one for one in self.quantiles if one.share == share), None)


class Part(NamedTuple):
    """What one study says alone; band: of its number, of a floor too; bound: whether its lower end is one; open:
    nothing but its runs bounds it from above."""
    kind: Kind
    volume: Optional[float]
    share: Optional[float] = None
    band: Sequence[Share] = ()
    reasons: Sequence[Reason] = ()
    bound: bool = True
    open: bool = False


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
    sweep = next(filter(None, map(sweep_of, studies)), None)
    ensemble = next(filter(None, map(ensemble_of, studies)), None)
    roads = [study.at_road for study in studies if study.at_road and (study.conservative or ensemble_of(study))]
    return combine_answers(sweep, ensemble, functools.reduce(Road.and_of, roads) if roads else None)


def sweep_of(study: study_types.Study) -> Optional[Sweep]:
    """Its conservative volume, if it has one, rounded up as it is shown."""
    best = study.conservative
    if not best:
        return None
    least = None if best.chance_m3 is None else best.mean_m3 - best.chance_m3
    return Sweep(best.rounded["volume_m3"], best.withheld, least, best.transfer_m3 or (0.0, 0.0), size_of(study),
                 released_of(study), len(finished_of(study.runs)))


def ensemble_of(study: study_types.Study) -> Optional[Ensemble]:
    """Its weighted ensemble, if it has one with volumes."""
    whole, weighted = study.ensemble, ensemble_types.weighted(study.ensemble)
    if not whole or not weighted or not weighted.to_remove:
        return None
    most = max((row.at_road.remove_m3 for row in finished_of(study.runs) if row.road), default=0.0)
    return Ensemble(weighted.to_remove, weighted.far, weighted.longest_m, whole.withheld,
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


# --- from what each says to one number ---

def low_high(value: float, band: Sequence[Share]) -> Tuple[float, float]:
    """The ends of a number whose causes are independent: each side by the root of the sum of the squares.

    Balls' sizes are given with 90 %, two-sided, chance, of a single run, with 95: the ends are said with 90.
    """
    below, above = (math.sqrt(math.fsum(side ** 2 for side in sides))
                    for sides in ([one.below_m3 for one in band], [one.above_m3 for one in band]))
    return max(0.0, value - below), value + above


def choose_known_shares(far: float) -> List[float]:
    """Shares of the known events whose quantiles count; far: the share that lies beyond all runs.

    SHARE; where the runs reach less, also what they reach, in whole per cents: the number is of that share then.
    """
    within = math.floor(100 * (1 - far) + 1e-10) / 100
    return [SHARE] if within >= SHARE else [SHARE, within]


def judge_sweep(sweep: Sweep, beside: Optional[Part]) -> Optional[Part]:
    """beside: of an ensemble, which makes up for HARMLESS rules; None: those alone withhold it."""
    if sweep.volume is not None:
        known = sweep.least is not None       # chance
        band = [Share(Cause.RUNS.value, max(0.0, sweep.volume - sweep.least), 0.0)] if sweep.least is not None else []
        return correct_part(Part(Kind.NUMBER, sweep.volume, None, [*band, Share(Cause.TRANSFER.value, *sweep.transfer)],
                                 bound=known), sweep.size)
    grave = [rule for rule in sweep.withheld if not (
        beside and rule.kind in HARMLESS and is_within(rule.numbers.get("volume"), beside))]
    if not grave:
        return None
    return Part(Kind.WITHHELD, None, reasons=[explain_rule(rule, Source.SWEEP) for rule in grave])


def is_within(volume: Optional[float], part: Part) -> bool:
    """Whether a volume (m3) that is withheld is no larger than a number that stands may be: few balls on a narrow road,
    or below a steep hillside, may be a large one.
    """
    return volume is None or part.volume is None or volume <= low_high(part.volume, part.band)[1]


def judge_ensemble(ensemble: Ensemble, road: Optional[Road]) -> Part:
    # that no run goes as far as half of the known events is said beside the number of those that the runs cover
    grave = [rule for rule in ensemble.withheld if rule.kind != Rule.MOBILITY]
    if grave:
        return Part(Kind.WITHHELD, None, reasons=[explain_rule(rule, Source.ENSEMBLE) for rule in grave])
    stopped = [ensemble.stopped] if ensemble.stopped else []
    if road and road.missed:
        low, high = min(road.reached), max(road.reached)
        if low > MANY:
            return Part(Kind.FLOOR, 0.0, 1 - high, reasons=[explain_missed(road), *stopped])
        said = [explain_missed(road, Code.ONE_SCATTER)] if high > MANY else []
        return Part(Kind.NUMBER, 0.0, SHARE, reasons=said)
    best = max((each for each in ensemble.quantiles if each.value is not None), key=lambda each: each.share,
               default=None)
    if best is None or best.value is None:
        return Part(Kind.FLOOR, 0.0, 0.0, reasons=[explain_known_beyond(ensemble), *stopped])
    high = max(best.value, ensemble.most) if best.high is None else best.high        # what no run exceeded
    band = [Share(Cause.RUNS.value, best.value - (best.low or 0.0), high - best.value),
            Share(Cause.TRANSFER.value, *(best.transfer or (0.0, 0.0)))]
    part = Part(Kind.NUMBER, best.value, best.share, band, bound=best.low is not None, open=best.high is None)
    if best.share != SHARE:
        # a terrain that ends behind the road is no reason against its number
        ends = any(reason.code is Code.TERRAIN and not (road and road.far_m < reason.numbers["path_m"])
                   for reason in stopped)
        part = part._replace(kind=Kind.FLOOR if ends else Kind.NUMBER,
                             reasons=[explain_known_beyond(ensemble), *stopped])
    return correct_part(part, ensemble.size)


def explain_rule(rule: Finding, source: Source) -> Reason:
    """That a number breaks it."""
    return Reason(Code.RULE, {"source": source.value, "rule": rule.kind, "number": rule.numbers.get("number"),
                              "bound": rule.numbers.get("bound"), "volume": rule.numbers.get("volume")})


def explain_known_beyond(ensemble: Ensemble) -> Reason:
    """That known events go beyond all runs."""
    end = {} if ensemble.path_end is None else {"path_end_m": ensemble.path_end}
    return Reason(Code.BEYOND, {"far": ensemble.far, "longest_m": ensemble.longest, "most_m3": ensemble.most,
                                "runs": ensemble.runs, **end})


def explain_missed(road: Road, code: Code = Code.NOT_REACHED) -> Reason:
    """That no run reaches it, and how many known events do."""
    low, high = min(road.reached), max(road.reached)
    return Reason(code, {"low": low, "high": high, "near_m": road.near_m, "longest_m": road.longest_m})


def correct_part(part: Part, size: Size) -> Part:
    """A number with what finer balls would change; a floor where that is not known; nothing stays nothing."""
    if not part.volume:
        return part
    part = part._replace(band=[*part.band, size.share(part.volume)], bound=part.bound and size.known)
    if size.floor is None:
        return part
    # what makes it a floor comes first
    reasons = [*part.reasons, size.floor] if part.kind is Kind.FLOOR else [size.floor, *part.reasons]
    return part._replace(kind=Kind.FLOOR, reasons=reasons)


def combine_answers(sweep: Optional[Sweep], ensemble: Optional[Ensemble], road: Optional[Road]) -> Optional[Headline]:
    """The larger of both, with the higher of their upper ends; None without either.

    Where one of them is withheld for a reason that the other does not make up for, the other is a floor; so is 0 where
    a run reaches the road. A floor is the lower end of the number's band, rounded down; where this end is no bound, as
    chance or what finer balls would change is not known, or is 0, the number stays open.
    """
    parts: List[Tuple[Source, Part]] = []
    weighted = judge_ensemble(ensemble, road) if ensemble else None
    if sweep and (mine := judge_sweep(sweep, weighted)):
        parts.append((Source.SWEEP, mine))
    if weighted:
        parts.append((Source.ENSEMBLE, weighted))
    if not parts:
        return None
    broken = [[Rule(rule.kind) for rule in study.withheld] if study else [] for study in (sweep, ensemble)]
    beside = (SweepPart(sweep.volume, broken[0], sweep.runs) if sweep else None,
              EnsemblePart(at.value if (at := ensemble.at(SHARE)) else None, broken[1], ensemble.runs,
                           ensemble.far) if ensemble else None, road)
    reasons = [reason for _, part in parts[::-1] for reason in part.reasons]
    known = [(source, part) for source, part in parts if part.volume is not None]
    if not known:
        return Headline(Kind.WITHHELD, None, None, None, None, None, *beside, reasons, [])
    source, best = max(known, key=lambda pair: pair[1].volume or 0.0)
    volume, some = best.volume or 0.0, []
    if road and not volume:
        if not road.missed:
            some = [Reason(Code.SOME, {key: getattr(road.brought, key)
                                       for key in ("runs", "reach", "least_m3", "most_m3")})]
        elif min(road.reached) > MANY and not any(one.code is Code.NOT_REACHED for one in reasons):
            some = [explain_missed(road)]
    open_ = bool(some) or any(
        part.kind is Kind.FLOOR or part.kind is Kind.WITHHELD and not few(part, best) for _, part in parts)
    low, high = low_high(volume, best.band)
    if open_ and volume:        # of lower bounds the largest counts
        lows = [(low_high(part.volume, part.band)[0], each, part) for each, part in known if part.bound and part.volume]
        low, source, best = max([(low if best.bound else 0.0, source, best), *lows], key=lambda pair: pair[0])
    kind = Kind.NUMBER if volume else Kind.NOTHING
    if open_:
        kind = Kind.FLOOR if not volume or best.bound and low else Kind.OPEN
    band, most = best.band, max(low_high(part.volume or 0.0, part.band)[1] for _, part in known)
    if most > high and not open_:
        band = [*band, Share(Cause.OTHER.value, 0.0, math.sqrt((most - volume) ** 2 - (high - volume) ** 2))]
        high = most
    released = min(one.released for one in (sweep, ensemble) if one)
    volume, low, high = (min(one, released) for one in (volume, low, high))
    if kind is Kind.OPEN:
        return Headline(kind, volume, best.share, None, None, source, *beside, reasons, [*band])
    if kind is Kind.FLOOR:
        low = volume = rounding.down(low, rounding.place_of_digits(low))
    return Headline(kind, volume, best.share, low, None if open_ else high, source, *beside, [*some, *reasons], [*band],
                    best.open)


def few(part: Part, beside: Part) -> bool:
    """Whether a number is withheld only because hardly a ball lies on the road, and is no larger than the other one."""
    return all(one.numbers.get("rule") == Rule.BALLS.value and is_within(one.numbers.get("volume"), beside)
               for one in part.reasons)
