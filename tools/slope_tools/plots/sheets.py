"""Sheets for maps: title, map, colour bar, scale and legend, each in a place of its own, so that nothing overlaps.

All places are in inches from the upper left corner of the sheet. Text is measured before anything is placed, the map
gets what is left of the width, and the sheet is as tall as that makes it.
"""
import math
from typing import NamedTuple, Optional, Tuple

from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from ..drawing import pictures
from ..drawing.figures import LINE, TITLE, nice, text_width, ticks, wrapped

EDGE, GAP = 0.05, 0.09      # around a sheet, between two things on it
OUT = 0.09                  # from an axis to its labels
MOST_TICKS = 7
TICK, LABEL = 6.3, 7.0      # points
BAR = 0.12                  # width of a colour bar
LEAST_BAR, MOST_BAR = 1.3, 3.2      # height of a map that has room for a colour bar beside it; the tallest bar
ROW = 0.17                  # height of a row of a legend
NARROW = 1.1                # the least room for the title of a small map
ENOUGH = 2.0                # square inches of a small map
SAMPLE = 0.32               # of a legend's entry: the line before the text


class Box(NamedTuple):
    """A place on a sheet: from the left, from the top, width, height."""
    left: float
    top: float
    width: float
    height: float


class Entry(NamedTuple):
    """A line of a legend."""
    text: str
    style: dict     # of a Line2D


class Frame(NamedTuple):
    """What a map shows, and how its sides are labelled."""
    shown: Tuple[float, float, float, float]    # local xlo, ylo, xhi, yhi
    names: bool = True                          # whether the axes are named
    offset: Optional[Tuple[float, float]] = None      # east, north of local 0 0: coordinates on the other sides
    crs: str = ""

    @property
    def width(self):
        return self.shown[2] - self.shown[0]

    @property
    def height(self):
        return self.shown[3] - self.shown[1]


def label(value):
    """A coordinate on an axis."""
    return f"{value:.10g}".replace("-", "\N{MINUS SIGN}")


def widest(low, high):
    """Inches that the coordinates on an axis take, whatever their number."""
    return max(text_width(label(value), TICK) for most in range(1, MOST_TICKS + 1) for value in ticks(low, high, most))


def map_size(frame, width, height):
    """The largest map, in inches, that fits in width x height and shows as many metres per inch in both directions."""
    scale = min(width / frame.width, height / frame.height)
    return frame.width * scale, frame.height * scale


class Sheet:
    """A figure of a width (inches) that is built from the top down; finish() gives it its height."""

    def __init__(self, width):
        self.width, self.bottom = width, EDGE
        self.figure = pictures.figure(figsize=(width, width))
        self.figure.set_layout_engine("none")
        self.boxes = []     # (axes, Box)
        self.texts = []     # (text, from the left, from the top)
        self.lines = []     # (line, places from the left, from the top)

    def axes(self, box):
        """New axes in a Box."""
        axes = self.figure.add_axes([0, 0, 1, 1], label=str(len(self.boxes)))
        self.boxes.append((axes, box))
        self.bottom = max(self.bottom, box.top + box.height)
        return axes

    def write(self, text, left, top, size, **style):
        """A line of text, its upper left corner at a place."""
        artist = self.figure.text(0, 0, text, fontsize=size, va="top", parse_math=False, **style)
        self.texts.append((artist, left, top))
        self.bottom = max(self.bottom, top + size * LINE / 72)

    def line(self, left, right, top, **style):
        """A level line, with a marker in its middle if the style has one."""
        artist = self.figure.add_artist(Line2D([], [], markevery=[1], transform=self.figure.transFigure, **style))
        self.lines.append((artist, (left, (left + right) / 2, right), top))

    def title(self, text, left=EDGE, width=None, size=TITLE, lines=3):
        """A title, over several lines if it is long; below it goes on at self.bottom."""
        top = self.bottom
        for k, line in enumerate(wrapped(text, (width or self.width - left) - EDGE, size, True, lines)):
            self.write(line, left, top + k * size * LINE / 72, size, fontweight="bold")
        return self.bottom - top

    def finish(self):
        """Put everything where it belongs; returns the figure."""
        height = self.bottom + EDGE
        self.figure.set_size_inches(self.width, height)
        for axes, (left, top, width, tall) in self.boxes:
            axes.set_position([left / self.width, 1 - (top + tall) / height, width / self.width, tall / height])
        for artist, left, top in self.texts:
            artist.set_position((left / self.width, 1 - top / height))
        for artist, places, top in self.lines:
            artist.set_data([place / self.width for place in places], [1 - top / height] * 3)
        return self.figure


# --- parts of a sheet ---

def margins(frame):
    """Room for the labels of a map's axes: left, top, right, bottom."""
    left = EDGE + OUT + widest(frame.shown[1], frame.shown[3]) + (LABEL * LINE / 72 + 0.03 if frame.names else 0)
    bottom = OUT + TICK * LINE / 72 + (LABEL * LINE / 72 + 0.02 if frame.names else 0)
    if frame.offset is None:
        return left, 0.02, 0.06, bottom
    more = OUT + (TICK + LABEL) * LINE / 72 + 0.02
    return left, more, more, bottom


def draw_axes(axes, frame, size, left=True, bottom=True):
    """Limits, ticks and names of a map that is drawn in size (inches)."""
    xlo, ylo, xhi, yhi = frame.shown
    axes.set(xlim=(xlo, xhi), ylim=(ylo, yhi))
    axes.set_aspect("auto")     # the box has the map's shape already
    axes.tick_params(direction="out", labelsize=TICK, labelleft=left, labelbottom=bottom)
    apart = widest(xlo, xhi) + 0.16
    most = [max(1, min(MOST_TICKS, int(inches / room))) for inches, room in zip(size, (apart, 0.28))]
    axes.set_xticks(at := ticks(xlo, xhi, most[0]), [label(value) for value in at])
    keep_in(axes.get_xticklabels(), at, xlo, xhi, size[0])
    axes.set_yticks(at := ticks(ylo, yhi, most[1]), [label(value) for value in at])
    if frame.names:
        axes.set_xlabel("local x (m)", fontsize=LABEL, labelpad=2)
        axes.set_ylabel("local y (m)", fontsize=LABEL, labelpad=2)
    if frame.offset is not None:
        crs_axes(axes, frame, size)


def keep_in(labels, places, low, high, inches):
    """Labels near the ends of an axis begin or end there, so that they do not stick out of it."""
    for text, place in zip(labels, places):
        half = text_width(text.get_text(), TICK) / 2
        before, after = (place - low) / (high - low) * inches, (high - place) / (high - low) * inches
        if inches > 4 * half:
            text.set_ha("left" if before < half * 0.6 else "right" if after < half * 0.6 else "center")


def crs_axes(axes, frame, size):
    """Coordinates of the CRS on the upper and the right side, where the map is large enough."""
    (xlo, ylo, xhi, yhi), (east, north) = frame.shown, frame.offset
    fit = int(size[0] / (widest(xlo + east, xhi + east) + 0.2))
    if fit:
        top = axes.secondary_xaxis("top", functions=(lambda x: x + east, lambda x: x - east))
        top.set_xticks(at := ticks(xlo + east, xhi + east, min(5, fit)), [label(value) for value in at])
        keep_in(top.get_xticklabels(), [value - east for value in at], xlo, xhi, size[0])
        top.set_xlabel(f"east (m), {frame.crs}", fontsize=LABEL, labelpad=2)
        top.tick_params(labelsize=TICK, size=2)
    fit = int(size[1] / (widest(ylo + north, yhi + north) + 0.15))
    if fit:
        right = axes.secondary_yaxis("right", functions=(lambda y: y + north, lambda y: y - north))
        right.set_yticks(at := ticks(ylo + north, yhi + north, min(5, fit)), [label(value) for value in at])
        right.set_ylabel("north (m)", fontsize=LABEL, labelpad=2)
        right.tick_params(labelsize=TICK, size=2, labelrotation=90)
        for text in right.get_yticklabels():
            text.set_va("center")


def bar_room(bounds):
    """Width of a colour bar beside a map, with its labels."""
    return GAP + BAR + 0.05 + max(text_width(f"{bound:g}", TICK) for bound in bounds) + LABEL * LINE / 72 + 0.06


def colour_bar(sheet, image, bounds, text, beside, below):
    """The colour bar of classes: beside the map, or below it (Boxes), where the map is too flat for that.

    bounds: of the classes, or None for a continuous one.
    """
    upright = beside is not None
    axes = sheet.axes(beside if upright else below)
    spacing = {"spacing": "uniform", "ticks": bounds} if bounds is not None else {}
    bar = sheet.figure.colorbar(image, cax=axes, orientation="vertical" if upright else "horizontal", **spacing)
    axis = axes.yaxis if upright else axes.xaxis
    if bounds is not None:
        axis.set_ticklabels(thinned([f"{bound:g}" for bound in bounds], None if upright else below.width))
    else:
        axis.set_major_locator(MaxNLocator(4 if not upright or beside.height < 2 else 7))
    axes.tick_params(labelsize=TICK, size=2, width=0.5)
    bar.set_label(text, fontsize=LABEL, labelpad=3)
    bar.outline.set_linewidth(0.5)
    if not upright:
        sheet.bottom += 0.05 + (TICK + LABEL) * LINE / 72 + 0.03


def thinned(texts, inches):
    """The texts of a colour bar, some of them empty where they would touch."""
    if inches is None:
        return texts
    each = inches / (len(texts) - 1)
    step = max(1, math.ceil((max(text_width(text, TICK) for text in texts) + 0.06) / each))
    return [text if k % step == 0 else "" for k, text in enumerate(texts)]


def scale_and_legend(sheet, left, inches_per_metre, most, entries, north):
    """Below everything: a scale bar of a round length, the arrow to the north, and what the lines of the map are."""
    top = sheet.bottom + 0.05
    length = nice(max(most / 4, 1e-9))
    inches = length * inches_per_metre
    text = f"{length:g} m"
    end = left + inches + 0.08 + text_width(text, TICK)
    middle = top + ROW / 2
    sheet.line(left, left + inches, middle, color="black", lw=4.2, solid_capstyle="butt")
    sheet.line(left + inches / 2, left + inches - 0.006, middle, color="white", lw=3.2, solid_capstyle="butt")
    sheet.write(text, left + inches + 0.06, top + 0.03, TICK)
    if north:
        sheet.line(end + 0.15, end + 0.25, middle, color="black", lw=0, marker=r"$\uparrow$", ms=9, mew=0)
        sheet.write("N", end + 0.28, top + 0.02, TICK + 0.7, fontweight="bold")
        end += 0.28 + text_width("N", TICK + 0.7, True)
    place_entries(sheet, entries, left, end + 0.25, top)


def place_entries(sheet, entries, left, first, top):
    """The entries of a legend one after another from `first`, in rows that begin at `left`."""
    x, right = first, sheet.width - EDGE
    for entry in entries:
        width = SAMPLE + 0.06 + text_width(entry.text, TICK + 0.3)
        if x > left and x + width > right:
            x, top = left, top + ROW
        sheet.line(x, x + SAMPLE, top + ROW / 2, **entry.style)
        room = right - x - SAMPLE - 0.06
        sheet.write(wrapped(entry.text, room, TICK + 0.3, most=1)[0], x + SAMPLE + 0.06, top + 0.025, TICK + 0.3)
        x += width + 0.16
    sheet.bottom = max(sheet.bottom, top + ROW)


def single(width, frame, title, tallest, bar=None):
    """A sheet with one map; bar: the numbers beside its colour bar.

    Returns the sheet, the map's axes, its size in inches, and the places for the colour bar beside and below it, of
    which one is None.
    """
    sheet = Sheet(width)
    left, top, right, bottom = margins(frame)
    beside = bar_room(bar) if bar else 0
    size = map_size(frame, width - left - right - beside - EDGE, tallest)
    flat = bar and size[1] < LEAST_BAR
    if flat:
        size = map_size(frame, width - left - right - EDGE, min(tallest, LEAST_BAR))
    sheet.title(title, left)
    box = Box(left, sheet.bottom + 0.07 + top, *size)
    axes = sheet.axes(box)
    beside = below = None
    if bar and flat:
        below = Box(left, box.top + size[1] + bottom + 0.04, min(max(size[0], 2.0), width - left - 0.2, 4.5), BAR)
    elif bar:
        beside = Box(left + size[0] + right + GAP - 0.04, box.top, BAR, min(size[1], MOST_BAR))
    sheet.bottom = box.top + size[1] + bottom
    return sheet, axes, size, beside, below


def layout(count, frame, width, tallest) -> Tuple[int, Tuple[float, float]]:
    """Columns and size of several maps of one frame in width x tallest: large enough to read, and then low."""
    found = []
    for columns in range(1, min(count, int(width / (NARROW + 0.1)), 4) + 1):
        rows = math.ceil(count / columns)
        size = map_size(frame, width / columns - 0.1, tallest / rows)
        found.append((min(size[0] * size[1], ENOUGH), -rows * size[1], columns, size))
    _, _, columns, size = max(found)
    return columns, size
