"""What makes a number of a floor, or of one that is withheld: the next step, its command, and how long it takes."""
from pathlib import Path
from shlex import quote
from typing import Any, Collection, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from ..findings import Finding
from ..heads import is_number
from ..mobility import events
from ..runs import again
from ..sites import site_choices, site_roads
from ..statistics.entries import Code, Headline, Kind, Reason, Source
from ..statistics.withheld import Kind as Rule
from . import answer_words, study_types
from .rows import finished_of
from .sizes import VARIABLE
from .study_types import NextStep
from .usable import times_the_balls

MORE = 2            # times the runs, where more are needed
LESS = {"friction": 0.0, "rolling": 0.0, "spacing": 0.2}      # what resists less with a smaller value, and its least


class Made(NamedTuple):
    """A study: study.yaml and its folder; beside: study.yaml of the other study of a site, which one command makes."""
    study: study_types.Study
    folder: Path
    beside: Optional[study_types.Study] = None
    given: Any = None       # the request of the command that made it; None: not known

    @property
    def source(self) -> Source:
        return Source.ENSEMBLE if self.study.ensemble else Source.SWEEP

    @property
    def whole(self) -> Optional[float]:
        """Seconds of both studies."""
        other = 0.0 if self.beside is None else Made(self.beside, self.folder).seconds
        return None if self.seconds is None or other is None else self.seconds + other

    @property
    def seconds(self) -> Optional[float]:
        """How long all runs took, as many at a time as they were; None: not known."""
        walls = [row.wall_s for row in finished_of(self.study.runs)]
        known = [wall for wall in walls if wall is not None]
        jobs = max(1, self.study.study.jobs)
        return None if len(known) < len(walls) or not walls else sum(known) / jobs

    @property
    def site(self) -> Optional[Path]:
        """The site's folder, if the study is one of a site."""
        return site_roads.home(self.folder)

    @property
    def withheld(self) -> List[Finding]:
        """Why its numbers are."""
        sweep, ensemble_ = self.study.conservative, self.study.ensemble
        return [*(sweep.withheld if sweep else ()), *(ensemble_.withheld if ensemble_ else ())]


def of_studies(studies: Sequence[Made], headline: Optional[Headline]) -> Optional[NextStep]:
    """What makes a number of a headline, by the first of its reasons that something can be done about; None where it
    is a number, or there is none.

    studies: one, or both of a site: each reason is of one of them.
    """
    if not headline or headline.kind not in (Kind.FLOOR, Kind.OPEN, Kind.WITHHELD):
        return None
    if len(studies) == 2:
        first, other = studies
        studies = [first._replace(beside=other.study), other._replace(beside=first.study)]
    by_source = {one.source: one for one in studies}
    ensemble, governs = by_source.get(Source.ENSEMBLE), headline.source

    def of(reason: Reason) -> Made:
        source = {Code.RULE: reason.numbers.get("source"), Code.SIZE: governs}.get(reason.code)
        return by_source.get(Source(source or Source.ENSEMBLE)) or studies[0]

    found = (make_next_step(of(one), one.code, one.numbers) for one in answer_words.told(headline))
    return next((step for step in found if step), None) or (more_runs(ensemble) if ensemble else None)


def make_next_step(made: Made, code: Code, of: Mapping[str, Any]) -> Optional[NextStep]:
    if code is Code.TERRAIN:
        return NextStep(*larger_terrain(made), made.whole)
    if code in (Code.RUNS, Code.FEW):
        return more_runs(made)
    if code is Code.RANGE:
        return wider_ranges(made, of["ends"])
    if code is Code.SIZE:
        return more_sizes(made, of["sizes"])
    if code is not Code.RULE:
        return None
    rule = Rule(of["rule"])
    mine = next((one for one in made.withheld if one.kind == rule.value), None)
    if rule is Rule.LEFT:
        add = mine.numbers.get("add") if mine else ""
        return NextStep(*larger_terrain(made, add or ""), made.whole)
    words = {Rule.BALLS: "a finer model", Rule.RUNS: "more time for the mass to come to rest",
             Rule.MOBILITY: "runs with less resistance"}
    return NextStep(words[rule], mine.remedy, times(made, rule, of)) if mine else None


def first_remedy(made: Made) -> Optional[NextStep]:
    """Of a study whose number is withheld: what mends the first of its reasons."""
    found = [make_next_step(made, Code.RULE, {**one.numbers, "rule": one.kind}) for one in made.withheld]
    return found[0] if found else None


def times(made: Made, rule: Rule, of: Mapping[str, Any]) -> Optional[float]:
    """Seconds of the study once more: steps are in proportion to the balls' diameter."""
    whole = made.whole
    factor = 2.0 if rule is Rule.RUNS else 1.0
    if rule is Rule.BALLS:
        factor = times_the_balls(of["number"] or 0.0) ** (4 / 3)
    return None if whole is None else factor * whole


def more_runs(made: Made) -> Optional[NextStep]:
    if not made.study.ensemble:
        return None
    whole, points = made.seconds, MORE * made.study.ensemble.design.points
    seconds = None if whole is None else (MORE - 1) * whole
    if made.site and made.given and of_both(made.given):
        place = quote(str(made.site))
        return NextStep("more runs", f"study.points: {points} in {place}/{site_choices.NAME}, then: "
                        f"{again.command(made.given)}", seconds)
    return NextStep("more runs", ensemble(made, points), seconds)


def wider_ranges(made: Made, ends: Collection[str]) -> Optional[NextStep]:
    """Runs with less resistance; ends: the variables whose ranges end in the way; none: of all that resist."""
    if not made.study.ensemble or made.given and made.given.fit:
        return None
    ranges = ranges_of(made)
    asked = [name for name in LESS if name in ranges and (name in ends or not ends)]
    wider = {**ranges, **{name: widened(ranges[name], LESS[name]) for name in asked}}
    if all(wider[name] == ranges[name].removeprefix("uniform:") for name in asked):
        return None
    return NextStep("runs with less resistance than the least that was tried",
                    ensemble(made, made.study.ensemble.design.points, wider), made.seconds)


def more_sizes(made: Made, sizes: int) -> NextStep:
    """The same study with one size of balls more, three at least; of a deck, halves of its diameter."""
    levels, rows = str(max(3, sizes + 1)), finished_of(made.study.runs)
    if made.site is None:
        d = rows[0].variables.get(VARIABLE, "") if rows else ""
        if not is_number(d):
            return NextStep("a finer model", f"a deck whose variable {VARIABLE} is the diameter of the balls, "
                            f"and the same command with --levels {VARIABLE}=5,2.5,1.25", None)
        coarsest = made.study.size.sizes[0].d if made.study.size else float(d)
        levels = f"{VARIABLE}=" + ",".join(f"{coarsest / 2 ** k:.4g}" for k in range(int(levels)))
    if made.given:
        command = again.command(made.given, levels=levels)
    else:
        command = (f"tools/slope study {quote(str(made.site))}" if made.site else "the same command with") + \
            f" --levels {levels}"
    return NextStep("a finer model", command, None)


def larger_terrain(made: Made, add: str = "") -> Tuple[str, str]:
    """add: how much on which side, in words."""
    site, larger = made.site, "a larger elevation model" + f", by {add}" * bool(add)
    if site is None:
        return f"{larger}, and the box of the deck with it", study_anew(made)
    return larger, (f"terrain.files, terrain.bounds in {quote(str(site))}/{site_choices.NAME}, then: "
                    f"tools/slope site {quote(str(site))} && {study_anew(made)}")


def study_anew(made: Made) -> str:
    """The command of a study once more, for another deck or other data."""
    if made.given:
        return again.command(made.given, anew=True)
    return f"tools/slope study {quote(str(made.site))} --anew" if made.site else "the same command with --anew"


def ensemble(made: Made, points: int, ranges: Optional[Mapping[str, str]] = None) -> str:
    """The command of an ensemble like this one with so many points; ranges: other ones, of all its variables."""
    one = made.study.ensemble
    ranges = ranges or ranges_of(made)
    vary = [f"{name}={text}" for name, text in ranges.items()]
    weighted = one.known_events if one else None
    known = weighted.set if weighted else None
    known = events.OWN.stem if known == events.OWN.name else known
    if made.given:
        changes: Dict[str, Any] = {"known": made.given.known or known, "paper": False} if of_both(made.given) else {}
        if not made.given.fit:
            changes["vary"] = vary
        return again.command(made.given, **{"sample": points, **changes})
    site = made.site
    where = quote(str(site)) if site else f"{quote(str(made.study.study.deck))} -o {quote(str(made.folder))}"
    words = [f"tools/slope study {where} --sample {points}", *([f"--known {quote(str(known))}"] if known else [])]
    return " ".join([*words, *(f"--vary {quote(text)}" for text in vary)])


def of_both(given: Any) -> bool:
    """Whether a request asks for all of a site, not for an ensemble."""
    return given.sample is None and given.fit is None


def ranges_of(made: Made) -> Mapping[str, str]:
    """The variables of an ensemble, and their distributions."""
    return made.study.ensemble.design.variables if made.study.ensemble else {}


def widened(text: str, least: float) -> str:
    """A range with half its least value, or down to a least one."""
    low, colon, high = text.removeprefix("uniform:").partition(":")
    if not (colon and is_number(low) and is_number(high)):
        return text
    return f"{max(float(low) / 2, min(least, float(low))):.10g}:{float(high):.10g}"
