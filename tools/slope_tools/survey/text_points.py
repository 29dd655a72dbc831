"""Points x,y in the lines of a text, under a head that may name them in another order."""
import re
from typing import Callable, List, NamedTuple, NoReturn, Optional, Sequence, Tuple

from ..heads import DEGREES, LENGTHS, column

FARTHEST = 1e12    # m or degrees: larger coordinates are mistakes, region polygon refuses them, too
# how columns begin: pairs of east and north, with the units that they may have; heights
PAIRS = ((re.compile(r"x(?![^\W\d_])"), re.compile(r"y(?![^\W\d_])"), (*LENGTHS, *DEGREES)),
         (re.compile(r"e(?![^\W\d_])|east|oo?st|este?$"), re.compile(r"n(?![^\W\d_])|north|nord|norte$"),
          (*LENGTHS, *DEGREES)),
         (re.compile(r"rechts|rw$"), re.compile(r"hochw|hw$"), tuple(LENGTHS)),
         (re.compile(r"lon|lng"), re.compile(r"lat"), DEGREES))
HEIGHT = re.compile(r"[zh](?![^\W\d_])|heig|elev|alt|h(oe|o\u0308|\xf6|\ufffd)he|cota|quota|d[egst]m$|ele$")
WORDS = re.compile(r"points?|coord(inate)?s?")      # of POINT_X, xcoord: what is left counts
SEPARATORS = re.compile(r"[,;\s]+(?![(\[])")        # between the names of a comment
RULE = "columns must be x,y or east,north (m), or lon,lat (degrees), in either order, and perhaps z"
Fail = Callable[[int, str, str], NoReturn]      # number of a line, rule, value


class Head(NamedTuple):
    """Which columns are x and y, of how many."""
    x: int = 0
    y: int = 1
    width: int = 2
    unit: Optional[str] = None      # m or degrees, where the head says it
    z: Optional[int] = None
    z_unit: Optional[str] = None


class Points(NamedTuple):
    """What a text holds."""
    blocks: List[List[Tuple[int, Tuple[float, float]]]]     # between blank lines: number of the line, point
    head: Head


def read_text_points(text: str, fail: Fail) -> Points:
    """The points of a text: x,y in its lines, a blank line between two blocks, # before a comment.

    The first line may be a head, and so may a comment before it. SlopeError of fail() where the text is something else.
    """
    head: Optional[Head] = None
    blocks: List[List[Tuple[int, Tuple[float, float]]]] = [[]]
    begun = False       # whether there was anything but comments
    for place, line in enumerate(text.splitlines(), 1):
        content, _, comment = line.partition("#")
        content = content.strip()
        if not content:
            if not line.strip():
                blocks.append([])
            elif not begun:
                words = SEPARATORS.split(comment.strip())
                found = head_of(words, lambda: fail(place, RULE, comment.strip()[:60]))
                if found and found.x > found.y:     # region polygon reads no comments: there it would be x,y
                    fail(place, "a comment that names columns must name x before y", comment.strip()[:60])
                head = found or head
            continue
        words = [word.strip() for word in content.split(",")]
        if not begun and len(words) > 1 and all(parse_coordinate(word) is None for word in words):
            head = head_of(words, lambda: fail(place, RULE, content[:60]))
            if head is None:
                fail(place, RULE, content[:60])
            begun = True
            continue
        begun = True
        head = head or Head()
        blocks[-1].append((place, point_of(place, content, words, head, fail)))
    return Points([block for block in blocks if block], head or Head())


def parse_coordinate(word: str) -> Optional[float]:
    """A number, perhaps nan; None of anything else. Python would take 1_5 for 15."""
    try:
        return None if "_" in word else float(word)
    except ValueError:
        return None


def head_of(words: Sequence[str], wrong_unit: Callable[[], object], others: bool = False) -> Optional[Head]:
    """The Head with these columns, None if they are no coordinates; wrong_unit() is called if their unit is wrong.

    others: any other columns may stand beside them.
    """
    columns = [column(word) for word in words]
    names = [WORDS.sub("", one.name).strip(" _-") for one in columns]
    for east, north, allowed in PAIRS:
        x, y = ([k for k, name in enumerate(names) if pattern.match(name)] for pattern in (east, north))
        rest = [k for k in range(len(names)) if k not in (*x, *y)]
        z = [k for k in rest if HEIGHT.match(names[k])] or (rest if others and len(rest) == 1 else [])
        if len(x) != 1 or len(y) != 1 or not others and (len(rest) > 1 or z != rest):
            continue
        units = {columns[k].unit for k in (*x, *y)} - {None}
        in_degrees = allowed is DEGREES or bool(units & set(DEGREES))
        if units - set(DEGREES if in_degrees else LENGTHS):
            wrong_unit()
        height = z[0] if len(z) == 1 else None
        return Head(x[0], y[0], len(names), "degrees" if in_degrees else "m" if units else None, height,
                    columns[height].unit if height is not None else None)
    return None


def point_of(place: int, content: str, words: Sequence[str], head: Head, fail: Fail) -> Tuple[float, float]:
    """The point of a line."""
    values = [parse_coordinate(word) for word in words]
    what = "numbers, x,y" if head.width == 2 else "numbers, x,y and z"
    many = "two" if head.width == 2 else "three"
    if len(words) != head.width or None in values:
        fail(place, f"must be {many} {what}", content[:60])
    x, y = (float(values[k] or 0.0) for k in (head.x, head.y))
    if not (abs(x) <= FARTHEST and abs(y) <= FARTHEST):     # NaN, too
        fail(place, f"must be {many} finite {what}".replace("numbers", f"numbers within +-{FARTHEST:g}"), content[:60])
    return x, y
