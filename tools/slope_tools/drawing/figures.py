"""What the pictures of a report share: style, sizes, text that is measured before it is drawn, data URIs."""
import base64
import math
from typing import Any, Dict, List

import numpy as np
from matplotlib.font_manager import FontProperties
from matplotlib.text import Text
from matplotlib.textpath import TextToPath
from matplotlib.ticker import MaxNLocator, StrMethodFormatter
from matplotlib.transforms import Bbox

from .. import digits
from . import pictures

FULL, WIDE, HALF = 7.0, 4.6, 3.42    # inches: the width of a page's text, of two thirds, of one of two side by side
DPI = 200
GRAY, ROAD, RELEASE, SECTION = "#444444", "#0057a8", "#7a0019", "#111111"
COLOURS = ("#1b6ca8", "#d1603d", "#3c8d53", "#8a5aa8", "#b8860b", "#4d4d4d", "#c2558c", "#2a9d9d", "#7f7f00")
STYLE: Dict[str, Any] = {
    "font.size": 7.5, "axes.titlesize": 8.5, "axes.titleweight": "bold", "axes.linewidth": 0.6,
    "axes.edgecolor": GRAY, "xtick.color": GRAY, "ytick.color": GRAY, "xtick.labelsize": 6.5,
    "ytick.labelsize": 6.5, "xtick.major.width": 0.5, "ytick.major.width": 0.5, "xtick.major.size": 2.5,
    "ytick.major.size": 2.5, "legend.fontsize": 6.8, "legend.framealpha": 0.9, "legend.edgecolor": "#bbbbbb",
    "figure.constrained_layout.use": True}
TITLE: float = STYLE["axes.titlesize"]     # points
FONT = "DejaVu Sans"    # matplotlib's own
LINE = 1.25     # of a letter's size: from one line to the next


def data_uri(figure, kind="png"):
    """The figure as a data URI. Empty room above and below is cut off; the width, and so the size of the

    letters on the page, stays.
    """
    for text in figure.findobj(Text):
        text.set_text(digits.typeset(text.get_text()))
    figure.draw_without_rendering()
    figure.set_layout_engine("none")    # once more, and it would not be what was measured
    used = figure.get_tightbbox(figure.canvas.get_renderer())
    width = figure.get_size_inches()[0]
    content = pictures.encode_figure(figure, format=kind, dpi=DPI, bbox_inches=Bbox([
        [min(0, used.x0), used.y0 - 0.03], [max(width, used.x1), used.y1 + 0.03]]),
        metadata={"Date": None} if kind == "svg" else {"Software": None})
    mime = {"png": "image/png", "svg": "image/svg+xml"}[kind]
    return f"data:{mime};base64,{base64.b64encode(content).decode('ascii')}"


def legend_above(axes) -> None:
    """A legend above axes, at the right: a section may be lower than its legend."""
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=4, frameon=False, borderaxespad=0.1)


# --- text ---

def text_width(text, size, bold=False):
    """Inches that a line of text takes; size in points. In the font of pictures.settings(), without these."""
    font = FontProperties(family=FONT, style="normal", variant="normal", stretch="normal", size=size,
                          weight="bold" if bold else "normal")
    return TextToPath().get_text_width_height_descent(text, font, ismath=False)[0] / 72 if text else 0.0


def shortened(text, inches, size, bold=False):
    """The text, or as much of it as fits, with dots at the end."""
    if text_width(text, size, bold) <= inches:
        return text
    low, high = 0, len(text)
    while low < high:       # the most letters that fit
        middle = (low + high + 1) // 2
        fits = text_width(text[:middle].rstrip() + "...", size, bold) <= inches
        low, high = (middle, high) if fits else (low, middle - 1)
    return text[:low].rstrip() + "..."


def wrapped(text, inches, size, bold=False, most=3):
    """The text in at most so many lines of a width; what does not fit is cut, with dots."""
    lines: List[str] = []
    for word in text.split():
        if lines and text_width(f"{lines[-1]} {word}", size, bold) <= inches:
            lines[-1] += f" {word}"
        else:
            lines.append(word)
    if len(lines) > most:
        lines[most - 1:] = [" ".join(lines[most - 1:])]
    return [shortened(line, inches, size, bold) for line in lines] or [""]


# --- round numbers ---

def nice(length):
    """The largest of 1, 2, 5 x 10^n that is not above a length."""
    power = 10.0 ** math.floor(math.log10(length))
    return max(step * power for step in (1, 2, 5) if step * power <= length * (1 + 1e-9))


def ticks(low, high, most):
    """At most so many round numbers from low to high, evenly spaced; the one nearest to the middle if most is 1."""
    if not (high > low and most >= 1):
        return []
    step = nice((high - low) / (most + 1))
    while True:
        places = np.arange(math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9) + 1) * step
        if len(places) <= most:
            break
        step = nice(2.5 * step)
    if not len(places):      # one only, and the step leads past all of them
        step = nice((high - low) / 2)
        places = [round((low + high) / 2 / step) * step]
    return [round(float(value), 9) + 0.0 for value in places]


def contour_interval(ground):
    """Metres between two contours, so that there are about ten."""
    known = ground[np.isfinite(ground)]
    relief = np.ptp(known) if known.size else 0
    return nice(relief / 6) if relief > 1e-3 else 1.0


CLASSES = {2: (0.1, 0.25, 0.5, 0.75, 1, 1.5, 2), 5: (0.1, 0.5, 1, 2, 3, 4, 5), 20: (0.1, 0.5, 1, 2, 5, 10, 15, 20),
           50: (0.1, 1, 2, 5, 10, 20, 30, 40, 50)}     # m; of a thickness up to the key
MOST = 98        # percent of the cells that the classes are chosen for; thicker ones are in one more class
FEW = 10         # cells, too few to choose classes for


def classes(largest):
    """Bounds of the classes of a thickness (m), ascending, the last one at or above the largest."""
    for top, bounds in CLASSES.items():
        if bounds[2] <= largest <= top:
            return [*(bound for bound in bounds if bound < largest), min(bound for bound in bounds if bound >= largest)]
    bounds = even(largest)
    return [bounds[1] / 10, *bounds[1:]]    # 0 itself is no deposit


def classes_of(values, apart=None):
    """Bounds of the classes of thicknesses (m, 0 where there is none): round numbers that suit the deposit.

    apart: mask of cells that do not set them, the release, where the mass is many times as thick as the deposit; what
    is thicker than the classes is in one more class, up to the largest of all.
    """
    values = np.nan_to_num(np.asarray(values, float))
    largest = float(values.max(initial=0))
    lowest = CLASSES[2][0]
    counted = values > lowest
    for mask in (counted & ~apart if apart is not None else counted, counted, values > 0):
        if np.count_nonzero(mask) >= FEW:
            bounds = classes(float(np.percentile(values[mask], MOST)))
            break
    else:
        bounds = classes(largest) if largest > 0 else [lowest, 1.0]
    if bounds[-1] < largest:
        bounds.append(round_up_nicely(largest))
    return bounds


def round_up_nicely(value):
    """The smallest of 1, 1.5, 2, 3, 4, 5, 6, 8 x 10^n at or above a value."""
    power = 10.0 ** math.floor(math.log10(value))
    return next(float(f"{step * power:.12g}") for step in (1, 1.5, 2, 3, 4, 5, 6, 8, 10)
                if step * power >= value * (1 - 1e-9))


def even(largest, lowest=0.0):
    """Bounds of about seven classes of equal width."""
    if not largest > lowest:
        return [lowest, lowest + 1]
    return list(MaxNLocator(7, steps=[1, 2, 2.5, 5, 10]).tick_values(lowest, largest))


def even_to_most(values):
    """Bounds of classes of equal width for most of the values (finite); stragglers are in one more class."""
    bounds = even(np.percentile(values, 97))
    if bounds[-1] < values.max():
        bounds.append(round_up_nicely(values.max()))
    return bounds


# --- the tornado chart of `slope sensitivity` ---

def tornado(path, panels, variables, title):
    """What each variable does, largest first, around the mean of the equivalent runs; written to a PNG.

    panels: list of (name, unit, scatter, {variable: [(value, result), ...]}), scatter with mean and standard_deviation;
    variables: {variable: (kind, base value)}, those of kind repeat are drawn in grey.
    """
    _, _, about, first = panels[0]
    order = sorted(variables, key=lambda name: (variables[name][0] != "repeat",
                                                max(abs(value - about["mean"]) for _, value in first[name])))
    with pictures.settings(STYLE):
        figure, axes = pictures.subplots(1, len(panels), figsize=(FULL, 0.9 + 0.26 * len(order)), sharey=True,
                                         squeeze=False)
        for axis, (name, unit, scatter, effects) in zip(axes[0], panels):
            mean, deviation = scatter["mean"], scatter["standard_deviation"]
            if deviation is not None:
                axis.axvspan(mean - 2 * deviation, mean + 2 * deviation, color="#e8e8e8", lw=0, zorder=0)
            axis.axvline(mean, color=GRAY, lw=0.8, zorder=1)
            for y, variable in enumerate(order):
                values = [result for _, result in effects[variable]]
                low, high = min(mean, *values), max(mean, *values)
                grey = variables[variable][0] == "repeat"
                axis.barh(y, high - low, left=low, height=0.5, color="#b5b5b5" if grey else COLOURS[0], alpha=0.85,
                          zorder=2)
                axis.plot(values, [y] * len(values), "|", color="black", ms=7, mew=0.8, zorder=3)
                if not grey:
                    label_ends(axis, y, mean, effects[variable])
            axis.set_title(f"{name} ({unit})", loc="left")
            axis.use_sticky_edges = False       # bars have them: no room for the labels
            axis.margins(x=0.12, y=0.02)
            axis.autoscale_view()
            axis.xaxis.set_major_locator(MaxNLocator(5))
            axis.xaxis.set_major_formatter(StrMethodFormatter("{x:,.6g}"))
            axis.grid(axis="x", color="#dddddd", lw=0.5, zorder=0)
            axis.set_axisbelow(True)
            axis.spines[["top", "right"]].set_visible(False)
        axes[0][0].set_yticks(range(len(order)), [f"{name} (base {variables[name][1]})" for name in order], fontsize=7)
        if panels[0][2]["standard_deviation"] is not None:
            title += "; grey: runs that are equally good, and two of their standard deviations"
        figure.suptitle(title, fontsize=7.5, x=0.01, ha="left")
        pictures.save(figure, path)


def label_ends(axis, y, mean, effect):
    """Write the values of a variable beside the two ends of its bar."""
    for side, ha in ((-1, "right"), (1, "left")):
        beyond = [(value, result) for value, result in effect if side * (result - mean) > 0]
        if beyond:
            value, result = max(beyond, key=lambda pair: side * pair[1])
            axis.annotate(value, (result, y), xytext=(3 * side, 0), textcoords="offset points", ha=ha, va="center",
                          fontsize=6)
