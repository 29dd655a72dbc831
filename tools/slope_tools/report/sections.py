"""What the page is made of: a part of it takes the runs (data.Data) and returns a Section of blocks, or None.

Blocks are texts and numbers: a table with its caption, pictures and their layout, a list, lines of a file.
One macro draws any section, each kind of block in one place (sections.html.j2); page.py lists the parts in their order.
Whatever stands in a block is escaped where it is drawn, except Markup, which is made here alone.
The first page, the warnings, the cards and the 3-D view are drawn by report.html.j2.
"""
from typing import Any, NamedTuple, Optional, Sequence, Tuple

from markupsafe import Markup, escape

from .. import digits

verbatim = escape       # a text of somebody else, whose units stay as they are


class Picture(NamedTuple):
    uri: str
    alt: str
    caption: str


class Text(NamedTuple):
    """A paragraph."""
    text: str
    style: str = ""


class Heading(NamedTuple):
    """Of what follows in a section."""
    text: str


class Listing(NamedTuple):
    items: Sequence[str]


class Verbatim(NamedTuple):
    """Lines of a file; folded under a title, if it has one."""
    text: str
    style: str = ""
    folded: str = ""


class Figures(NamedTuple):
    """Pictures, those that there are; layout: columns, two-thirds of the width, tall, or the whole width."""
    pictures: Sequence[Optional[Picture]]
    layout: str = ""


class Cell(NamedTuple):
    """Of a table or of its head, where a text is not enough; span: of how many columns."""
    text: str
    unit: Optional[str] = None
    style: str = ""
    span: int = 0


class Table(NamedTuple):
    """Heads and rows are of texts or Cells; left: which columns are aligned to the left; marks: styles of the rows."""
    caption: str
    heads: Sequence[Any]
    rows: Sequence[Sequence[Any]]
    left: Tuple[int, ...] = (0,)
    marks: Sequence[str] = ()
    style: str = "dense"


class Pairs(NamedTuple):
    """A table of rows of a name and what belongs to it."""
    rows: Sequence[Sequence[Any]]
    caption: str = ""
    style: str = "pairs"


class Columns(NamedTuple):
    """Blocks beside each other."""
    sides: Sequence[Sequence[Any]]


class Section(NamedTuple):
    """A part of the page; blocks: of the kinds above, None where there is nothing."""
    id: str
    title: str
    blocks: Sequence[Any]


def marked(text: str, style: str) -> Markup:
    """A text in a style, within others."""
    return Markup('<span class="{}">{}</span>').format(style, digits.typeset(text))


def strong(text: str) -> Markup:
    return Markup("<strong>{}</strong>").format(digits.typeset(text))


# --- for sections.html.j2 ---

def kind(block: Any) -> str:
    """Which of the kinds above a block is."""
    return type(block).__name__


def make_cell(value: Any) -> Cell:
    return value if isinstance(value, Cell) else Cell(value)
