"""When the number of a study is withheld, because it governs nothing: one function for each rule.

A rule takes the Facts of a study and returns a Reason, or None where the number may stand; withheld_words makes the
words of it.
"""
from enum import Enum
from typing import List, NamedTuple, Optional

BALLS = 10              # on the road: fewer are not a volume but single balls
LEFT = 0.01             # of the released volume, that left the terrain before or beside the road
UNFINISHED = 0.1        # of all runs, that failed or are not at rest
FAILED = "most of them failed"
CONFIDENCE = 0.95       # of the probability that no volume at all is exceeded


class Kind(Enum):
    """Which rule."""
    BALLS = "balls on the road"
    MOBILITY = "known events"
    LEFT = "left the terrain"
    RUNS = "runs not at rest or failed"
    SIZE = "size error"


class Facts(NamedTuple):
    """What the rules look at."""
    volume: float                   # m3, the number; of an ensemble the largest of all runs
    on_road: float                  # m3 of it on the road itself
    ball: float                     # bulk volume of a ball, m3
    runs: int                       # all of them
    failed: int
    moving: int                     # not at rest at their end
    left: float                     # share of the released volume that left before or beside the road, the largest
    length: Optional[float]         # m, of the longest run; None: no run has one
    median: Optional[float]         # m, length that half of known events exceed; None: no set covers the mass
    size: str = ""                  # why the size error is not trusted; "": it is, or was not measured


class Reason(NamedTuple):
    """Why a number is withheld: its rule, what was found, and the bound that it breaks (None: there is no number)."""
    kind: Kind
    number: Optional[float]
    bound: Optional[float]
    detail: str = ""


# --- rules ---

def few_balls(facts: Facts) -> Optional[Reason]:
    number = facts.on_road / facts.ball
    return Reason(Kind.BALLS, number, BALLS) if facts.volume > 0 and number < BALLS else None


def short(facts: Facts) -> Optional[Reason]:
    if facts.median is None or facts.length is not None and facts.length >= facts.median:
        return None
    return Reason(Kind.MOBILITY, facts.length, facts.median)


def left(facts: Facts) -> Optional[Reason]:
    return Reason(Kind.LEFT, facts.left, LEFT) if facts.left > LEFT else None


def unfinished(facts: Facts) -> Optional[Reason]:
    number = facts.failed + facts.moving
    if number <= UNFINISHED * facts.runs:
        return None
    return Reason(Kind.RUNS, number, facts.runs, FAILED if facts.failed > facts.moving else "")


def size_error(facts: Facts) -> Optional[Reason]:
    return Reason(Kind.SIZE, None, None, facts.size) if facts.size and facts.volume > 0 else None


RULES = (few_balls, short, left, unfinished, size_error)


def reasons(facts: Facts) -> List[Reason]:
    """Why a number is withheld; empty where it may stand."""
    return [found for rule in RULES if (found := rule(facts))]


def exceeded_at_most(runs: int) -> float:
    """The probability with which one more run brings something, at most, if none of so many does (Clopper, Pearson)."""
    return 1 - (1 - CONFIDENCE) ** (1 / runs)
