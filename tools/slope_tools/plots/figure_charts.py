"""The section and the charts of a report, as data URIs."""
from typing import NamedTuple, Optional, Sequence, Tuple

import numpy as np

from ..drawing import figures, pictures
from ..drawing.figures import COLOURS, FULL, HALF, LINE, ROAD, SECTION, STYLE, shortened, text_width, ticks
from .figure_maps import LINE as CONTROL, MARKS, WALL, entries_of_marks
from .sheets import Box, EDGE, Entry, LABEL, OUT, Sheet, TICK, keep_in, label, place_entries, widest

VISIBLE = 0.055     # inches: a deposit of this thickness can be seen
LEAST, MOST = 0.9, 3.6      # inches: height of the section, but for a low one on level ground
STEPS = (1, 2, 5, 10)       # how many times heights may be exaggerated
TICKS = 0.2         # inches: room of the labels below an axis
CUT = {"color": ROAD, "lw": 1.1, "ls": "--"}
THICK = {"lw": 5, "solid_capstyle": "butt"}     # of an area, in a legend


# --- the section ---

class Scale(NamedTuple):
    """How a section is drawn: inches per metre along it, and how many times heights are exaggerated."""
    inches: float
    factor: float

    @property
    def heights(self):
        return self.inches * self.factor


def scale_of(length, height, thickness, width):
    """The Scale of a section of that length and height (m), so that a thickness (m) can be seen where that is possible

    on a paper of a width (inches).
    """
    inches = min(width / length, MOST / height)
    fitting = [step for step in STEPS if step == 1 or height * step * inches <= MOST]
    for step in fitting:
        if thickness * step * inches >= VISIBLE and height * step * inches >= LEAST:
            return Scale(inches, step)
    # what no exaggeration shows is shown below: then none is needed but for a low section
    seen = [step for step in fitting if height * step * inches >= LEAST]
    return Scale(inches, fitting[-1] if thickness * fitting[-1] * inches >= VISIBLE else (seen or fitting[-1:])[0])


def times(factor):
    return "" if factor == 1 else f", {factor:g} times exaggerated"


def draw_section(s, before, base, runs, road, cut, title, bends=(), walls=(), crossings=(), marks=()):
    """Heights along the section, and below them the thickness where it cannot be seen in the heights.

    s: distance (m); before, base: ground before, and slip surface with the ground that stays; runs: list of
    (name, surface after, thickness), the first of them filled; road: list of (from, to); cut: its heights or None;
    bends: distances at which the line turns; walls: pieces of structures, pairs of (distance, height); crossings:
    distances of control lines; marks: (share, distance) of known events. Returns the picture, the exaggeration of the
    heights, and that of the thickness or None.
    """
    known = np.concatenate([values[np.isfinite(values)] for values in (before, base, *(run[1] for run in runs))])
    room = max(0.05 * np.ptp(known), 0.005 * np.ptp(s), 0.1)
    low, high = known.min() - room, known.max() + room
    deposit = runs[0][2][runs[0][2] > 0.05 * max(runs[0][2].max(), 1e-9)]
    typical = float(np.percentile(deposit, 75)) if deposit.size else 0.0
    left = EDGE + OUT + widest(low, high) + 0.02
    scale = scale_of(np.ptp(s), high - low, typical, FULL - left - 0.12)
    with pictures.settings(STYLE):
        sheet = Sheet(FULL)
        sheet.title(title, left)
        size = np.ptp(s) * scale.inches, max((high - low) * scale.heights, 0.4)
        high = low + size[1] / scale.heights
        names = [shortened(name, 3.0, TICK) for name, *_ in runs]
        axes, entries = panel(sheet, left, size, "height (m)" + times(scale.factor), s, (low, high), road, bends)
        entries += draw_heights(axes, s, before, base, runs, names, low)
        if cut is not None:
            axes.plot(s, np.where(cut <= high, cut, np.nan), zorder=7, **CUT)
            entries.append(Entry("cut surface", CUT))
        entries += draw_obstacles(axes, walls, crossings)
        for share, at in marks:
            axes.axvline(at, zorder=2, **MARKS[share])
        entries += entries_of_marks({share for share, _ in marks})
        factor = None
        if 0 < typical * scale.heights < VISIBLE:
            top = 1.05 * max(run[2].max() for run in runs)
            factor = float(f"{0.9 / top / scale.inches:.2g}")
            axes.tick_params(labelbottom=False)
            sheet.bottom += 0.05
            axes, _ = panel(sheet, left, (size[0], top * factor * scale.inches), "thickness (m)" + times(factor), s,
                            (0, top), road, bends, corners=False)
            draw_thickness(axes, s, runs)
        else:
            sheet.bottom += TICKS
        if factor is not None:
            sheet.bottom += TICKS
        sheet.write("distance from A (m)", left, sheet.bottom, LABEL)
        place_entries(sheet, entries, left, left, sheet.bottom + 0.06)
        return figures.data_uri(sheet.finish(), "svg"), scale.factor, factor


def panel(sheet, left, size, name, s, limits, road, bends, corners=True):
    """Axes over the distance, their name above them, with the road and the bends of the line; and legend entries."""
    top = sheet.bottom + 0.03
    shift = 0.0
    if corners:
        shift = 0.2
        sheet.write("A", left, top, LABEL, fontweight="bold")
        if size[0] > text_width(name, LABEL) + 0.7:
            sheet.write("A'", left + size[0], top, LABEL, fontweight="bold", ha="right")
    sheet.write(name, left + shift, top, LABEL)
    axes = sheet.axes(Box(left, top + LABEL * LINE / 72 + 0.03, *size))
    axes.set(xlim=(s[0], s[-1]), ylim=limits)
    wide = text_width(label(round(s[-1])), TICK) + 0.25
    axes.set_xticks(at := ticks(s[0], s[-1], max(1, min(9, int(size[0] / wide)))), [label(value) for value in at])
    keep_in(axes.get_xticklabels(), at, s[0], s[-1], size[0])
    axes.set_yticks(at := ticks(limits[0], limits[1], max(1, min(8, int(size[1] / 0.22)))),
                    [label(value) for value in at])
    axes.tick_params(labelsize=TICK)
    entries = []
    for start, end in road:
        axes.axvspan(start, end, color=ROAD, alpha=0.13, lw=0)
        entries = [Entry("road", {"color": ROAD, "alpha": 0.25, **THICK})]
    for bend in bends:
        axes.axvline(bend, color=SECTION, lw=0.5, ls=(0, (1, 2)), zorder=1)
        entries = [*entries[:1 if road else 0], Entry("the line turns",
                                                      {"color": SECTION, "lw": 0.5, "ls": (0, (1, 2))})]
    return axes, entries


def draw_heights(axes, s, before, base, runs, names, low):
    """The ground before and after; returns the legend's entries."""
    several = len(runs) > 1
    axes.fill_between(s, low, base, color="#dcd7cf", lw=0, zorder=1)
    axes.plot(s, base, color="#6b6459", lw=0.5, zorder=3)
    _, surface, thickness = runs[0]
    axes.fill_between(s, base, surface, where=thickness > 0, color="#d9a066", alpha=0.85, lw=0, zorder=2)
    entries = [Entry(f"deposit{f' ({names[0]})' if several else ''}", {"color": "#d9a066", **THICK})]
    with np.errstate(invalid="ignore"):
        slip = np.where(before - base > 0.01, base, np.nan)
    for values, entry in ((before, Entry("ground before", {"color": "black", "lw": 1.1, "ls": (0, (5, 1.5))})),
                          (slip, Entry("slip surface", {"color": "#c1121f", "lw": 1.2}))):
        if np.isfinite(values).any():
            axes.plot(s, values, zorder=5 if values is before else 4, **entry.style)
            entries.append(entry)
    for i, (name, (_, surface, thickness)) in enumerate(zip(names, runs)):
        style = {"color": COLOURS[i % len(COLOURS)] if several else "#8a4b08", "lw": 1.1}
        axes.plot(s, np.where(thickness > 0, surface, np.nan), zorder=6, **style)
        entries.append(Entry(f"after: {name}" if several else "ground after", style))
    return entries


def draw_obstacles(axes, walls, crossings):
    """Structures as they are cut, control lines upright; returns the legend's entries."""
    for piece in walls:
        axes.plot(*np.asarray(piece).T, zorder=7, **WALL)
    for at in crossings:
        axes.axvline(at, zorder=2, **CONTROL)
    return [entry for entry, any_of in ((Entry("structure", WALL), walls), (Entry("control line", CONTROL), crossings))
            if len(any_of)]


def draw_thickness(axes, s, runs):
    axes.fill_between(s, 0, runs[0][2], color="#d9a066", alpha=0.85, lw=0, zorder=2)
    for i, (_, _, thickness) in enumerate(runs):
        axes.plot(s, np.where(thickness > 0, thickness, np.nan), lw=1.1, zorder=6,
                  color=COLOURS[i % len(COLOURS)] if len(runs) > 1 else "#8a4b08")


# --- charts ---

class Series(NamedTuple):
    """Values of runs against a variable; joined: whether the means are joined by a line, as a trend."""
    name: str
    x: Sequence[float]
    y: Sequence[float]
    scatter: Optional[float] = None     # standard deviation of one run
    joined: bool = True


def means(series):
    """The mean of a series at each of its x: two arrays."""
    x = np.unique(series.x)
    return x, np.array([np.mean([value for at, value in zip(series.x, series.y) if at == one]) for one in x])


def panel_width(width, left):
    """Of the axes of a chart whose numbers end at left, inches."""
    return width - left - 0.12


def value_panel(sheet, values, y_label, title, width, tall):
    """Axes below a title, with room for all values and zero; the ticks of y, and where the axes begin, inches."""
    low, high = 1.08 * min(0.0, values.min()), 1.08 * max(0.0, values.max())
    high = high if high > low else 1.0      # all of them are 0
    grid = ticks(low, high, 6)
    left = EDGE + OUT + max(text_width(f"{value:,.6g}", TICK) for value in grid) + 0.02
    sheet.title(title, left)
    sheet.write(y_label, left, sheet.bottom + 0.02, LABEL)
    axes = sheet.axes(Box(left, sheet.bottom + 0.05, panel_width(width, left), tall))
    axes.set(ylim=(low, high))
    return axes, grid, left


def label_axes(sheet, axes, grid, left, x_label, at, limits):
    """Ticks of both axes with their numbers, lines at those of y, and the name of x below."""
    axes.set_xticks(at, [label(value) for value in at])
    axes.set_xlim(*limits)
    axes.set_yticks(grid, [f"{value:,.6g}" for value in grid])
    axes.tick_params(labelsize=TICK)
    axes.grid(axis="y", color="#dddddd", lw=0.5)
    axes.spines[["top", "right"]].set_visible(False)
    sheet.bottom += TICKS
    sheet.write(x_label, left, sheet.bottom, LABEL)


def chart(series, x_label, y_label, title, others=(), levels=(), mark: Optional[Tuple] = None, width=FULL):
    """Values against a variable. others: Series from elsewhere, in grey; levels: list of (label, y);

    mark: (x, y, text) of the point that counts.
    """
    with pictures.settings(STYLE):
        sheet = Sheet(width)
        every = np.concatenate([[0.0], *(one.y for one in (*series, *others)), [y for _, y in levels],
                                [mark[1]] if mark else [], *(np.asarray(one.y) + (one.scatter or 0)
                                                             for one in series)]).astype(float)
        axes, grid, left = value_panel(sheet, every, y_label, title, width, 2.2 if width > HALF else 1.6)
        entries = []
        for further, style in zip(others, ("s--", "D:", "^-.", "v--") * len(others)):
            axes.plot(further.x, further.y, style, color="#999999", mfc="white", ms=5, lw=1.0)
            entries.append(Entry(further.name, {"color": "#999999", "marker": style[0], "ls": style[1:], "mfc": "white",
                                                "ms": 4, "lw": 1.0}))
        for k, (text, y) in enumerate(levels):
            look = {"color": "#777777", "lw": 0.9, "ls": (0, (1, 1 + k))}
            axes.axhline(y, **look)
            entries.append(Entry(text, look))
        for i, further in enumerate(series):
            entries += draw_series(axes, further, COLOURS[i % len(COLOURS)], len(series) > 1 or bool(others))
        if mark:
            ring = {"marker": "o", "ms": 10, "mfc": "none", "mec": "#c1121f", "mew": 1.2, "ls": ""}
            axes.plot(*mark[:2], **ring)
            entries.append(Entry(mark[2], {**ring, "ms": 6}))
        axes.margins(x=0.08)
        xlo, xhi = axes.get_xlim()
        wide = max(text_width(label(value), TICK) for value in ticks(xlo, xhi, 6)) + 0.2
        most = max(1, min(7, int(panel_width(width, left) / wide)))
        label_axes(sheet, axes, grid, left, x_label, ticks(xlo, xhi, most), (xlo, xhi))
        if entries:
            place_entries(sheet, entries, left, left, sheet.bottom + 0.05)
        return figures.data_uri(sheet.finish(), "svg")


def draw_series(axes, series, colour, named):
    """The runs as dots, their means with the scatter of a run, and a line only where the differences are a trend."""
    x, y = means(series)
    several = len(x) < len(series.x)
    line = {"color": colour, "lw": 1.6 if series.joined else 0, "marker": "o"}
    if several:
        axes.plot(series.x, series.y, "o", color=colour, ms=2.6, alpha=0.6, mew=0)
    axes.plot(x, y, ms=4 if several else 5, **line)
    if series.scatter:
        axes.errorbar(x, y, series.scatter, fmt="none", ecolor=colour, elinewidth=0.9, capsize=2.5)
    return [Entry(series.name, {**line, "ms": 4})] if named and series.name else []


class Convergence(NamedTuple):
    """Means over sizes."""
    sizes: Sequence[float]
    means: Sequence[float]
    scatter: Sequence[Optional[float]]      # standard deviation of a run of each size


def convergence(sizes, x_label, y_label, title, width=HALF):
    """Means against the thickness in balls, or another size."""
    with pictures.settings(STYLE):
        sheet = Sheet(width)
        deviations = np.array([one or 0.0 for one in sizes.scatter])
        means_ = np.asarray(sizes.means, float)
        every = np.concatenate([[0.0], means_ + deviations, means_ - deviations])
        axes, grid, left = value_panel(sheet, every, y_label, title, width, 1.7)
        end = 1.05 * max(sizes.sizes)
        dots = {"color": COLOURS[1], "marker": "o", "ms": 4.5, "lw": 0.9}
        axes.errorbar(sizes.sizes, means_, deviations, fmt="none", ecolor=COLOURS[1], elinewidth=0.9, capsize=2.5)
        axes.plot(sizes.sizes, means_, **dots)
        label_axes(sheet, axes, grid, left, x_label, ticks(0, end, 6), (0, end))
        place_entries(sheet, [Entry("means; bars: one standard deviation of a run", dots)], left, left,
                      sheet.bottom + 0.05)
        return figures.data_uri(sheet.finish(), "svg")


def bars(names, values, y_label, title, width=FULL):
    """Values of runs whose variables are no numbers."""
    with pictures.settings(STYLE):
        sheet = Sheet(width)
        names = [shortened(name, 0.37 * width, TICK) for name in names]
        left = EDGE + OUT + max(text_width(name, TICK) for name in names) + 0.02
        sheet.title(title, left)
        width = panel_width(width, left)
        axes = sheet.axes(Box(left, sheet.bottom + 0.05, width, 0.15 + 0.2 * len(names)))
        axes.barh(range(len(names)), values, color=COLOURS[0], height=0.7)
        axes.set_yticks(range(len(names)), names)
        axes.set_ylim(len(names) - 0.4, -0.6)
        low, high = min(0.0, *values) * 1.05, max(0.0, *values) * 1.05
        high = high if high > low else 1.0
        axes.set_xlim(low, high)
        axes.set_xticks(at := ticks(low, high, 6), [f"{value:,.6g}" for value in at])
        keep_in(axes.get_xticklabels(), at, low, high, width)
        axes.tick_params(labelsize=TICK)
        axes.spines[["top", "right"]].set_visible(False)
        sheet.bottom += TICKS
        sheet.write(y_label, left, sheet.bottom, LABEL)
        return figures.data_uri(sheet.finish(), "svg")


def draw_side_bars(parts, x_label, y_label, title):
    """Bars side by side, coloured by their names; parts: of each from, to, value, name."""
    names = list(dict.fromkeys(name for *_, name in parts))
    with pictures.settings(STYLE):
        figure, axes = pictures.subplots(figsize=(FULL, 1.9))
        for k, name in enumerate(names):
            low, high, value = np.array([one[:3] for one in parts if one[3] == name], float).T
            axes.bar(low, value, high - low, align="edge", color=COLOURS[k % len(COLOURS)], label=f"body {name}")
        axes.set_xlabel(x_label)
        axes.set_ylabel(y_label)
        axes.set_title(title, loc="left")
        axes.spines[["top", "right"]].set_visible(False)
        if names:
            figures.legend_above(axes)
        return figures.data_uri(figure, "svg")
