"""When the number of a study is withheld, because it governs nothing: one function for each rule.

A rule takes the Facts of a study and returns a Finding, or None where the number may stand; tables/usable adds the
command that mends it.
"""
from enum import Enum
from typing import List, NamedTuple, Optional

from ..digits import metres
from ..findings import Finding

BALLS = 10              # on the road: fewer are not a volume but single balls
LEFT = 0.01             # of the released volume, that left the terrain before, beside or on the road
UNFINISHED = 0.1        # of all runs, that failed or are not at rest
CONFIDENCE = 0.95       # of the probability that no volume at all is exceeded


class Kind(str, Enum):
    """Of the findings: which rule."""
    BALLS = "balls on the road"
    MOBILITY = "known events"
    LEFT = "left the terrain"
    RUNS = "runs not at rest or failed"


class Facts(NamedTuple):
    """What the rules look at."""
    volume: float                   # m3, the number; of an ensemble the largest of all runs
    on_road: float                  # m3 of it on the road itself
    ball: float                     # bulk volume of a ball, m3
    runs: int                       # all of them
    failed: int
    moving: int                     # not at rest at their end
    left: float                     # share of the released volume that left before the road, or nobody knows where
    length: Optional[float]         # m, of the longest run; None: no run has one
    median: Optional[float]         # m, length that half of known events exceed; None: no set covers the mass
    where: str = ""                 # it left, in words
    add: str = ""                   # terrain that is missing there, in words


# --- rules ---

def few_balls(facts: Facts) -> Optional[Finding]:
    number = facts.on_road / facts.ball
    if not facts.volume > 0 or number >= BALLS:
        return None
    balls = "less than one ball" if number < 1 else f"{number:.2g} ball{'s' * (f'{number:.2g}' != '1')}"
    return Finding(Kind.BALLS.value, {"number": number, "bound": BALLS, "balls": balls, "volume": facts.volume})


def short(facts: Facts) -> Optional[Finding]:
    if facts.median is None or facts.length is not None and facts.length >= facts.median:
        return None
    longest = "there is no deposit" if facts.length is None else f"the longest one ends at {metres(facts.length)}"
    return Finding(Kind.MOBILITY.value, {"number": facts.length, "bound": facts.median, "longest": longest})


def judge_lost_mass(facts: Facts) -> Optional[Finding]:
    if facts.left <= LEFT:
        return None
    return Finding(Kind.LEFT.value, {"number": facts.left, "bound": LEFT, "percent": 100 * facts.left,
                                     "most": 100 * LEFT, "where": facts.where, "add": facts.add})


def unfinished(facts: Facts) -> Optional[Finding]:
    number = facts.failed + facts.moving
    if number <= UNFINISHED * facts.runs:
        return None
    return Finding(Kind.RUNS.value, {"number": number, "bound": facts.runs, "failed": facts.failed,
                                     "most": 100 * UNFINISHED})


RULES = (few_balls, short, judge_lost_mass, unfinished)


def reasons(facts: Facts) -> List[Finding]:
    """Why a number is withheld; empty where it may stand."""
    return [found for rule in RULES if (found := rule(facts))]


def exceeded_at_most(runs: int) -> float:
    """The probability with which one more run brings something, at most, if none of so many does (Clopper, Pearson)."""
    return 1 - (1 - CONFIDENCE) ** (1 / runs)
