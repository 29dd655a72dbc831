"""The range that a deck allows for a variable: from the commands of SLOPE that use it, and from its comment.

A comment such as `# of the lattice; 0 <= offset < 1` on the line of an index variable states its range; the word in the
middle may be any.
"""
import math
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Dict, Optional

from ..errors import SlopeError
from . import decks

NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
STATED = re.compile(rf"({NUMBER})\s*(<=?)\s*[A-Za-z_]\w*\s*(<=?)\s*({NUMBER})(?![\w.])")
LINE = re.compile(r"^\s*variable\s+(\w+)\s+index\b[^#]*#(.*)$", re.MULTILINE)


@dataclass(frozen=True)
class Bounds:
    """An interval; below, above: whether its ends belong to it."""
    low: float
    high: float
    with_low: bool = True
    with_high: bool = True

    def holds(self, value: float) -> bool:
        above = value > self.low or (self.with_low and value == self.low)
        return above and (value < self.high or (self.with_high and value == self.high))

    @property
    def text(self) -> str:
        parts = [f"{'>=' if self.with_low else '>'} {self.low:g}"] * math.isfinite(self.low)
        parts += [f"{'<=' if self.with_high else '<'} {self.high:g}"] * math.isfinite(self.high)
        return " and ".join(parts)


ABOVE_ZERO = Bounds(0, math.inf, with_low=False)
FROM_ZERO = Bounds(0, math.inf)
# the number behind a keyword of a command
KEYWORDS = {"pair_coeff": {"friction": Bounds(0, 90, with_high=False), "restitution": Bounds(0, 1, with_low=False),
                           "rolling": FROM_ZERO, "stiffness": ABOVE_ZERO, "damping": FROM_ZERO},
            "set": {"diameter": ABOVE_ZERO, "density": ABOVE_ZERO},
            "fix": {"spacing": ABOVE_ZERO, "cell": ABOVE_ZERO},
            "create_balls": {"spacing": ABOVE_ZERO}}
# the places of numbers in a command, the first behind its name being 1
PLACES = {"create_balls": {2: ABOVE_ZERO, 3: ABOVE_ZERO}}


def ranges(deck: Path) -> Dict[str, Bounds]:
    """{variable: its Bounds} of those whose range is known; a stated one counts before that of a command."""
    known: Dict[str, Bounds] = {}
    for words in decks.commands(deck):
        for place, (keyword, word) in enumerate(zip(words, words[1:]), 1):
            match = re.fullmatch(r"\$(?:\{(\w+)\}|(\w))", word)
            bounds: Optional[Bounds] = (KEYWORDS.get(words[0], {}).get(keyword)
                                        or PLACES.get(words[0], {}).get(place))
            if match and bounds:
                known[match[1] or match[2]] = bounds
    text = Path(deck).read_text(encoding="utf-8", errors="replace")
    for name, comment in LINE.findall(text):
        stated = STATED.search(comment)
        if stated:
            low, first, second, high = stated.groups()
            known[name] = Bounds(float(low), float(high), first == "<=", second == "<=")
    return known


class Checks:
    """What the values of a deck's variables must be, as far as the deck shows it."""

    def __init__(self, deck: Path):
        self.ranges = ranges(deck)
        self.own = decks.index_variables(deck)
        self.outputs = decks.only_in_outputs(deck)

    def vary(self, option: str, name: str, words: str) -> None:
        """Raise SlopeError if a variable that is to have several values only names files that runs write."""
        if name in self.outputs:
            raise SlopeError(option, f"must not vary {name}, which only names the files that a run writes: every run "
                             "has a folder of its own", words)

    def value(self, option: str, name: str, value: str, words: str) -> None:
        """Raise SlopeError if a value leaves the range of a variable, or is no number although it has one.

        A variable whose own value in the deck is no number may have others: it is not said what they stand for.
        """
        bounds = self.ranges.get(name)
        if bounds is None:
            return
        if is_deck_number(value):
            if not bounds.holds(float(value)):
                raise SlopeError(option, f"{name} must stay within the deck's range, {bounds.text}", words)
        elif is_deck_number(self.own.get(name, "")):
            raise SlopeError(option, f"{name} must be a number, {bounds.text}", words)


def is_deck_number(text: str) -> bool:
    """Whether LAMMPS takes a text for a number, a finite one."""
    return bool(re.fullmatch(NUMBER, text)) and math.isfinite(float(text))
