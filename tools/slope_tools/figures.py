"""The pictures of a report: maps on a shaded relief, sections, charts, as data URIs that go into the page."""
import base64
import io
import math
from typing import NamedTuple, Optional, Tuple

import matplotlib
import numpy as np

matplotlib.use("Agg")  # no display is needed

from matplotlib import pyplot as plt  # noqa: E402  (after the backend is set)
from matplotlib.colors import BoundaryNorm, ListedColormap  # noqa: E402
from matplotlib.patches import Rectangle  # noqa: E402
from matplotlib.ticker import MaxNLocator  # noqa: E402
from matplotlib.transforms import Bbox  # noqa: E402

from .deposit import polygons_of  # noqa: E402
from .maps import outline, part  # noqa: E402

FULL, WIDE, HALF = 7.0, 4.6, 3.42    # inches: the width of a page's text, of two thirds, of one of two side by side
DPI = 200
CLASSES = {2: (0.1, 0.25, 0.5, 0.75, 1, 1.5, 2), 5: (0.1, 0.5, 1, 2, 3, 4, 5), 20: (0.1, 0.5, 1, 2, 5, 10, 15, 20),
           50: (0.1, 1, 2, 5, 10, 20, 30, 40, 50)}     # m; of a thickness up to the key
GRAY, ROAD, RELEASE, SECTION = "#444444", "#0057a8", "#7a0019", "#111111"
COLOURS = ("#1b6ca8", "#d1603d", "#3c8d53", "#8a5aa8", "#b8860b", "#4d4d4d", "#c2558c", "#2a9d9d", "#7f7f00")
STYLE = {"font.size": 7.5, "axes.titlesize": 8.5, "axes.titleweight": "bold", "axes.linewidth": 0.6,
         "axes.edgecolor": GRAY, "xtick.color": GRAY, "ytick.color": GRAY, "xtick.labelsize": 6.5,
         "ytick.labelsize": 6.5, "xtick.major.width": 0.5, "ytick.major.width": 0.5, "xtick.major.size": 2.5,
         "ytick.major.size": 2.5, "legend.fontsize": 6.8, "legend.framealpha": 0.9, "legend.edgecolor": "#bbbbbb",
         "figure.constrained_layout.use": True, "svg.hashsalt": "slope"}


class Layers(NamedTuple):
    """What is drawn over every map; geometries are in local metres."""
    raster: object                       # grid, CRS and offset of the deposit
    ground: np.ndarray                   # the ground before
    shown: Tuple                         # local xlo, ylo, xhi, yhi of the maps
    release: Optional[np.ndarray] = None     # mask: cells that held balls at the start
    road: object = None                  # polygon
    section: Optional[np.ndarray] = None     # ends, two rows of x y
    interval: float = 5.0                # of the contours, m


def data_uri(figure, kind="png"):
    """The figure as a data URI; closes it. Empty room above and below is cut off; the width, and so the size of the

    letters on the page, stays.
    """
    out = io.BytesIO()
    figure.draw_without_rendering()
    figure.set_layout_engine("none")    # once more, and it would not be what was measured
    used = figure.get_tightbbox(figure.canvas.get_renderer())
    width = figure.get_size_inches()[0]
    figure.savefig(out, format=kind, dpi=DPI, metadata={"Date": None} if kind == "svg" else {"Software": None},
                   bbox_inches=Bbox([[min(0, used.x0), used.y0 - 0.03], [max(width, used.x1), used.y1 + 0.03]]))
    plt.close(figure)
    mime = {"png": "image/png", "svg": "image/svg+xml"}[kind]
    return f"data:{mime};base64,{base64.b64encode(out.getvalue()).decode('ascii')}"


def nice(length):
    """The largest of 1, 2, 5 x 10^n that is not above a length."""
    power = 10.0 ** math.floor(math.log10(length))
    return max(step * power for step in (1, 2, 5) if step * power <= length * (1 + 1e-9))


def contour_interval(ground):
    """Metres between two contours, so that there are about ten."""
    known = ground[np.isfinite(ground)]
    relief = np.ptp(known) if known.size else 0
    return nice(relief / 6) if relief > 1e-3 else 1.0


def classes(largest):
    """Bounds of the classes of a thickness (m), ascending, the last one at or above the largest."""
    for top, bounds in CLASSES.items():
        if bounds[2] <= largest <= top:
            return [*(bound for bound in bounds if bound < largest), min(bound for bound in bounds if bound >= largest)]
    bounds = even(largest)
    return [bounds[1] / 10, *bounds[1:]]    # 0 itself is no deposit


def even(largest, lowest=0.0):
    """Bounds of about seven classes of equal width."""
    if not largest > lowest:
        return [lowest, lowest + 1]
    return list(MaxNLocator(7, steps=[1, 2, 2.5, 5, 10]).tick_values(lowest, largest))


def even_to_most(values):
    """Bounds of classes of equal width for most of the values (finite); stragglers are in one more class."""
    bounds = even(np.percentile(values, 97))
    if bounds[-1] < values.max():
        bounds.append(math.ceil(values.max()))
    return bounds


def shade(z, step):
    """Shaded relief, light from the north-west at 45 degrees; flat ground is 0.71 whatever else is on the map.

    matplotlib's stretches what it finds to 0 to 1, so that a map of nearly flat ground looks like mountains.
    """
    south, east = np.gradient(z, step)
    azimuth, altitude = math.radians(315), math.radians(45)
    light = math.sin(azimuth) * math.cos(altitude), math.cos(azimuth) * math.cos(altitude), math.sin(altitude)
    return np.clip((-east * light[0] + south * light[1] + light[2]) / np.sqrt(1 + east ** 2 + south ** 2), 0, 1)


def scheme(name, bounds, low=0.15, high=1.0):
    """Colour map and norm of classes; the lightest tones of the colour map are left out."""
    colours = plt.get_cmap(name)(np.linspace(low, high, len(bounds) - 1))
    return ListedColormap(colours), BoundaryNorm(bounds, len(bounds) - 1)


def scale_bar(axes, shown):
    """A bar of a round length in the lower left corner, half black, half white."""
    width, height = shown[2] - shown[0], shown[3] - shown[1]
    length = nice(width / 4)
    x, y, thick = shown[0] + 0.035 * width, shown[1] + 0.05 * height, 0.014 * height
    axes.add_patch(Rectangle((x - 0.02 * width, y - 0.03 * height), length + 0.09 * width, 0.105 * height,
                             facecolor="white", alpha=0.8, lw=0, zorder=8))
    for i, colour in enumerate(("black", "white")):
        axes.add_patch(Rectangle((x + i * length / 2, y), length / 2, thick, facecolor=colour, edgecolor="black",
                                 lw=0.5, zorder=9))
    for at, text in ((0, "0"), (length, f"{length:g} m")):
        axes.text(x + at, y + 1.6 * thick, text, fontsize=6, ha="center", va="bottom", zorder=9)


def north_arrow(axes):
    axes.annotate("N", xy=(0.965, 0.965), xytext=(0.965, 0.86), xycoords="axes fraction", ha="center", va="center",
                  fontsize=7, fontweight="bold", zorder=9,
                  arrowprops={"arrowstyle": "-|>", "lw": 0.9, "color": "black"},
                  bbox={"boxstyle": "round,pad=0.15", "fc": "white", "ec": "none", "alpha": 0.8})


def base_map(axes, layers, title, shown=None, labels=True):
    """Shaded relief, contours, release, road, section line, scale and coordinates."""
    raster, shown = layers.raster, shown or layers.shown
    z, where = part(raster, layers.ground, shown)
    step = (where[1] - where[0]) / z.shape[1]
    known = np.isfinite(z)
    if min(z.shape) >= 2 and known.any():
        relief = shade(np.where(known, z, np.nanmean(z)), step)
        axes.imshow(np.where(known, relief, np.nan), cmap="gray", extent=where, vmin=-0.6, vmax=1.0,
                    interpolation="bilinear", zorder=1)
        if np.ptp(z[known]) > layers.interval / 2:
            heights = np.arange(math.floor(z[known].min() / layers.interval),
                                math.ceil(z[known].max() / layers.interval) + 1) * layers.interval
            # a little above the level, or a flat place at just that level would be full of them
            lines = axes.contour(z, heights + 1e-4 * layers.interval, extent=where, origin="upper", colors="#333333",
                                 linewidths=0.35, alpha=0.6, zorder=3)
            if labels:
                axes.clabel(lines, lines.levels[::2], fontsize=5, inline_spacing=2,
                            fmt=lambda level: f"{layers.interval * round(level / layers.interval):g}")
    if layers.release is not None and layers.release.any():
        mask, where = part(raster, layers.release.astype(float), shown)
        if min(mask.shape) >= 2 and np.ptp(mask) > 0:
            axes.contour(mask, [0.5], extent=where, origin="upper", colors=RELEASE, linewidths=0.9, linestyles="--",
                         zorder=5)
    if layers.road is not None:
        outline(axes, layers.road, color=ROAD, linewidth=1.1, zorder=6)
        for polygon in polygons_of(layers.road):
            axes.fill(*np.asarray(polygon.exterior.coords)[:, :2].T, color=ROAD, alpha=0.13, lw=0,
                      zorder=1.5)
    axes.set(xlim=(shown[0], shown[2]), ylim=(shown[1], shown[3]), aspect="equal")
    axes.set_title(title, loc="left")
    axes.locator_params(nbins=6)
    axes.ticklabel_format(useOffset=False, style="plain")
    axes.tick_params(direction="out")
    scale_bar(axes, shown)
    if raster.crs is not None:
        north_arrow(axes)


def name_axes(axes, layers, crs_name):
    """Local metres at the bottom and on the left; coordinates of the CRS on the other sides."""
    axes.set(xlabel="local x (m)", ylabel="local y (m)")
    if layers.raster.crs is None:
        return
    east, north = layers.raster.offset
    top = axes.secondary_xaxis("top", functions=(lambda x: x + east, lambda x: x - east))
    right = axes.secondary_yaxis("right", functions=(lambda y: y + north, lambda y: y - north))
    top.set_xlabel(f"east (m), {crs_name}")
    right.set_ylabel("north (m)")
    for side, axis in ((top, top.xaxis), (right, right.yaxis)):
        axis.set_major_locator(MaxNLocator(5))
        axis.get_major_formatter().set_useOffset(False)
        axis.get_major_formatter().set_scientific(False)
        side.tick_params(labelsize=6)
    right.tick_params(labelrotation=90)
    for text in right.get_yticklabels():
        text.set_va("center")


def draw_section_line(axes, layers):
    if layers.section is None:
        return
    axes.plot(*layers.section.T, color=SECTION, lw=0.9, ls=(0, (6, 2, 1, 2)), zorder=7)
    way = np.diff(layers.section, axis=0)[0]
    for point, text, side in zip(layers.section, ("A", "A'"), (1, -1)):
        axes.annotate(text, point, xytext=7 * side * way / np.hypot(*way), textcoords="offset points", ha="center",
                      va="center", fontsize=7, fontweight="bold", zorder=9, annotation_clip=False,
                      bbox={"boxstyle": "circle,pad=0.15", "fc": "white", "ec": SECTION, "lw": 0.5})


def value_map(layers, values, title, bar, bounds, colours, width=HALF, crs_name="", mask=None):
    """A map of a raster in classes; values below the first bound, and where mask is False, are not drawn."""
    shown = layers.shown
    with plt.rc_context(STYLE):
        ratio = (shown[3] - shown[1]) / (shown[2] - shown[0])
        height = min(max(width * 0.86 * ratio, 0.3 * width), 1.3 * width) + (0.75 if width == FULL else 0.6)
        figure, axes = plt.subplots(figsize=(width, height))
        base_map(axes, layers, title, labels=width == FULL)
        z, where = part(layers.raster, values, shown)
        hidden = ~(z >= bounds[0])
        if mask is not None:
            hidden |= ~part(layers.raster, mask.astype(float), shown)[0].astype(bool)
        cmap, norm = scheme(colours, bounds)
        image = axes.imshow(np.ma.masked_where(hidden, z), extent=where, cmap=cmap, norm=norm, alpha=0.82,
                            interpolation="nearest", zorder=2)
        value_bar(figure, axes, image, bounds, bar)
        draw_section_line(axes, layers)
        if width == FULL:
            name_axes(axes, layers, crs_name)
            legend(axes, layers)
        return data_uri(figure)


def mesh_map(layers, removed, mesh, title, crs_name):
    """What must be removed: its thickness, and its volume (m3) in the cells of a mesh, a Raster in local metres."""
    with plt.rc_context(STYLE):
        width, height = layers.shown[2] - layers.shown[0], layers.shown[3] - layers.shown[1]
        size = min(max(FULL * 0.86 * height / width, 0.3 * FULL), 1.2 * FULL) + 0.75
        figure, axes = plt.subplots(figsize=(FULL, size))
        base_map(axes, layers, title, labels=False)
        bounds = classes(removed.max())
        z, where = part(layers.raster, removed, layers.shown)
        cmap, norm = scheme("YlOrBr", bounds)
        image = axes.imshow(np.ma.masked_where(~(z >= bounds[0]), z), extent=where, cmap=cmap, norm=norm, alpha=0.75,
                            interpolation="nearest", zorder=2)
        value_bar(figure, axes, image, bounds, "thickness to remove (m)")
        side = mesh.transform.a
        listed = np.argwhere(mesh.z >= 0.5)
        font = min(6.5, 72 * (FULL * 0.86) * side / width / 3.4)
        for row, column in listed:
            x, y = mesh.transform * (column, row + 1)
            axes.add_patch(Rectangle((x, y), side, side, fill=False, lw=0.35, edgecolor="#222222", zorder=6))
            if font >= 2.5:
                axes.text(x + side / 2, y + side / 2, f"{mesh.z[row, column]:,.0f}", fontsize=font, ha="center",
                          va="center", zorder=7, clip_on=True)
        name_axes(axes, layers, crs_name)
        legend(axes, layers._replace(section=None))
        return data_uri(figure)


def value_bar(figure, axes, image, bounds, label):
    """The colour bar of a map in classes."""
    bar = figure.colorbar(image, ax=axes, shrink=0.85, aspect=24, pad=0.02, ticks=bounds, spacing="uniform")
    bar.ax.set_yticklabels([f"{bound:g}" for bound in bounds])
    bar.set_label(label, fontsize=7)
    bar.ax.tick_params(labelsize=6.2, size=2)
    bar.outline.set_linewidth(0.5)


def legend(axes, layers):
    """What the lines over a map are."""
    entries = []
    if layers.release is not None and layers.release.any():
        entries.append(plt.Line2D([], [], color=RELEASE, lw=0.9, ls="--", label="released mass"))
    if layers.road is not None:
        entries.append(plt.Line2D([], [], color=ROAD, lw=1.1, label="road"))
    if layers.section is not None:
        entries.append(plt.Line2D([], [], color=SECTION, lw=0.9, ls=(0, (6, 2, 1, 2)), label="section A-A'"))
    entries.append(plt.Line2D([], [], color="#333333", lw=0.4, label=f"contours every {layers.interval:g} m"))
    axes.legend(handles=entries, loc="upper left", ncol=len(entries), borderpad=0.4, handlelength=1.8,
                columnspacing=1.0).set_zorder(10)


def terrain_map(layers, detail, crs_name):
    """The whole terrain, tinted by height; detail: the part that the other maps show."""
    with plt.rc_context(STYLE):
        shown = layers.shown
        ratio = (shown[3] - shown[1]) / (shown[2] - shown[0])
        figure, axes = plt.subplots(figsize=(FULL, min(max(FULL * 0.86 * ratio, 0.3 * FULL), 0.95 * FULL) + 0.75))
        base_map(axes, layers, "Terrain before the collapse")
        z, where = part(layers.raster, layers.ground, shown)
        image = axes.imshow(np.ma.masked_invalid(z), extent=where, cmap=TINTS, alpha=0.45, zorder=2,
                            interpolation="bilinear")
        colour_bar = figure.colorbar(image, ax=axes, shrink=0.85, aspect=24, pad=0.02)
        colour_bar.set_label("height (m)", fontsize=7)
        colour_bar.outline.set_linewidth(0.5)
        if tuple(detail) != tuple(shown):
            axes.add_patch(Rectangle(detail[:2], detail[2] - detail[0], detail[3] - detail[1], fill=False, lw=0.9,
                                     edgecolor="white", zorder=6))
        draw_section_line(axes, layers)
        name_axes(axes, layers, crs_name)
        legend(axes, layers)
        return data_uri(figure)


TINTS = matplotlib.colors.LinearSegmentedColormap.from_list(
    "tints", ["#5f8f5a", "#9dbb7c", "#d9d39a", "#c8a36c", "#a87a55", "#e9e4de"])


def small_maps(layers, panels, bar, bounds, colours):
    """The same map of several runs side by side, as the paper's Figure 14; panels: list of (title, values)."""
    columns = 2 if len(panels) in (2, 4) else 3
    rows = math.ceil(len(panels) / columns)
    shown = layers.shown
    cmap, norm = scheme(colours, bounds)
    with plt.rc_context(STYLE):
        width = (FULL - 0.6) / columns
        height = min(max(width * (shown[3] - shown[1]) / (shown[2] - shown[0]), 0.4 * width), 1.4 * width) + 0.3
        figure, axes = plt.subplots(rows, columns, figsize=(FULL, rows * height + 0.1), squeeze=False, sharex=True,
                                    sharey=True)
        for axis in axes.flat[len(panels):]:
            axis.set_axis_off()
        image = None
        for axis, (title, values) in zip(axes.flat, panels):
            base_map(axis, layers, title, labels=False)
            z, where = part(layers.raster, values, shown)
            image = axis.imshow(np.ma.masked_where(~(z >= bounds[0]), z), extent=where, cmap=cmap, norm=norm,
                                alpha=0.82, interpolation="nearest", zorder=2)
        value_bar(figure, axes, image, bounds, bar)
        return data_uri(figure)


# --- sections and charts ---

def section(s, before, base, runs, road, cut, title):
    """Heights along the section, as the paper's Figure 12.

    s: distance (m); before, base: ground before, and slip surface with the ground that stays; runs: list of
    (name, surface after, thickness), the first of them filled; road: list of (from, to); cut: its heights or None.
    Returns the picture and its vertical exaggeration.
    """
    heights = np.concatenate([values[np.isfinite(values)] for values in (before, base, *(run[1] for run in runs))])
    low, high = heights.min(), heights.max()
    room = max(0.06 * (high - low), 0.01 * np.ptp(s), 0.1)
    low, high = low - room, high + 3 * room
    exaggeration = 1.0
    while (high - low) * exaggeration < 0.16 * np.ptp(s) and exaggeration < 10:
        exaggeration = {1.0: 2.0, 2.0: 5.0, 5.0: 10.0}[exaggeration]
    with plt.rc_context(STYLE):
        tall = min(max((FULL - 0.6) * (high - low) * exaggeration / np.ptp(s), 1.1), 4.5)
        longest = max(len(name) for name, *_ in runs) + 9
        columns = max(2, 88 // (8 + longest))
        rows = math.ceil((len(runs) + 4) / columns)
        figure, axes = plt.subplots(figsize=(FULL, tall + 0.65 + 0.16 * rows))
        for start, end in road:
            axes.axvspan(start, end, color=ROAD, alpha=0.13, lw=0)
            axes.annotate("road", ((start + end) / 2, high), xytext=(0, -3), textcoords="offset points", ha="center",
                          va="top", fontsize=6.5, color=ROAD)
        axes.fill_between(s, low, base, color="#dcd7cf", lw=0, zorder=1)
        name, surface, thickness = runs[0]
        axes.fill_between(s, base, surface, where=thickness > 0, color="#d9a066", alpha=0.85, lw=0, zorder=2,
                          label=f"deposit{f' ({name})' if len(runs) > 1 else ''}")
        if np.isfinite(before).any():
            axes.plot(s, before, color="black", lw=1.1, ls=(0, (5, 1.5)), zorder=5, label="ground before")
            slip = np.where(before - base > 0.01, base, np.nan)
            axes.plot(s, slip, color="#c1121f", lw=1.2, zorder=4, label="slip surface")
        axes.plot(s, base, color="#6b6459", lw=0.5, zorder=3)
        for i, (name, surface, thickness) in enumerate(runs):
            axes.plot(s, np.where(thickness > 0, surface, np.nan), color=COLOURS[i % len(COLOURS)] if len(runs) > 1
                      else "#8a4b08", lw=1.1, zorder=6, label=f"after: {name}" if len(runs) > 1 else "ground after")
        if cut is not None:
            axes.plot(s, np.where(cut <= high, cut, np.nan), color=ROAD, lw=0.8, ls=":", zorder=5, label="cut surface")
        axes.set(xlim=(s[0], s[-1]), ylim=(low, high), aspect=exaggeration, xlabel="distance from A (m)",
                 ylabel="height (m)")
        axes.set_title(title, loc="left")
        for x, text in ((0.015, "A"), (0.985, "A'")):
            axes.text(x, 0.94, text, transform=axes.transAxes, ha="center", va="top", fontsize=7.5, fontweight="bold",
                      zorder=9, bbox={"boxstyle": "circle,pad=0.15", "fc": "white", "ec": SECTION, "lw": 0.5})
        handles, labels = axes.get_legend_handles_labels()
        axes.legend(handles, labels, loc="upper center", bbox_to_anchor=(0.5, -0.4 / tall), frameon=False,
                    ncol=min(len(labels), columns))
        return data_uri(figure, "svg"), exaggeration


def chart(series, x_label, y_label, title, others=(), level=None, mark=None, width=FULL):
    """Values against a variable. series, others: lists of (label, x, y), the others in grey; level: (label, y);

    mark: (x, y, text) of the point that counts.
    """
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(figsize=(width, 2.9 if width > HALF else 2.3))
        for (label, x, y), style in zip(others, ("s--", "D:")):
            axes.plot(x, y, style, color="#999999", mfc="white", ms=5, lw=1.0, label=label)
        if level:
            axes.axhline(level[1], color="#999999", lw=0.9, ls=(0, (1, 2)))
            axes.annotate(level[0], (0.0, level[1]), xycoords=("axes fraction", "data"), xytext=(4, 3),
                          textcoords="offset points", ha="left", fontsize=6.5, color="#666666")
        for i, (label, x, y) in enumerate(series):
            axes.plot(x, y, "o-", color=COLOURS[i % len(COLOURS)], ms=5, lw=1.6, label=label)
        if mark:
            axes.annotate(mark[2], mark[:2], xytext=(0, 9), textcoords="offset points", ha="center", fontsize=7,
                          fontweight="bold")
            axes.plot(*mark[:2], "o", ms=10, mfc="none", mec="#c1121f", mew=1.2)
        axes.set(xlabel=x_label, ylabel=y_label)
        axes.set_title(title, loc="left")
        axes.set_ylim(bottom=0)
        axes.set_ylim(top=axes.get_ylim()[1] * 1.08)
        axes.margins(x=0.08)
        axes.yaxis.set_major_formatter(matplotlib.ticker.StrMethodFormatter("{x:,.6g}"))
        axes.grid(axis="y", color="#dddddd", lw=0.5)
        axes.spines[["top", "right"]].set_visible(False)
        if others or len(series) > 1 or series[0][0]:
            axes.legend(loc="best", frameon=True)
        return data_uri(figure, "svg")


def bars(names, values, y_label, title):
    """Values of runs whose variables are no numbers."""
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(figsize=(FULL, 0.6 + 0.24 * len(names)))
        axes.barh(names, values, color=COLOURS[0])
        axes.invert_yaxis()
        axes.set(xlabel=y_label)
        axes.set_title(title, loc="left")
        axes.spines[["top", "right"]].set_visible(False)
        return data_uri(figure, "svg")


def tornado(path, panels, variables, title):
    """What each variable does, largest first, around the mean of the equivalent runs; written to a PNG.

    panels: list of (name, unit, scatter, {variable: [(value, result), ...]}), scatter with mean and standard_deviation;
    variables: {variable: (kind, base value)}, those of kind repeat are drawn in grey.
    """
    _, _, about, first = panels[0]
    order = sorted(variables, key=lambda name: (variables[name][0] != "repeat",
                                                max(abs(value - about["mean"]) for _, value in first[name])))
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(1, len(panels), figsize=(FULL, 0.9 + 0.26 * len(order)), sharey=True, squeeze=False)
        for axis, (name, unit, scatter, found) in zip(axes[0], panels):
            mean, deviation = scatter["mean"], scatter["standard_deviation"]
            if deviation is not None:
                axis.axvspan(mean - 2 * deviation, mean + 2 * deviation, color="#e8e8e8", lw=0, zorder=0)
            axis.axvline(mean, color=GRAY, lw=0.8, zorder=1)
            for y, variable in enumerate(order):
                values = [result for _, result in found[variable]]
                low, high = min(mean, *values), max(mean, *values)
                grey = variables[variable][0] == "repeat"
                axis.barh(y, high - low, left=low, height=0.5, color="#b5b5b5" if grey else COLOURS[0], alpha=0.85,
                          zorder=2)
                axis.plot(values, [y] * len(values), "|", color="black", ms=7, mew=0.8, zorder=3)
                if not grey:
                    label_ends(axis, y, mean, found[variable])
            axis.set_title(f"{name} ({unit})", loc="left")
            axis.use_sticky_edges = False       # bars have them: no room for the labels
            axis.margins(x=0.12, y=0.02)
            axis.autoscale_view()
            axis.xaxis.set_major_locator(MaxNLocator(5))
            axis.xaxis.set_major_formatter(matplotlib.ticker.StrMethodFormatter("{x:,.6g}"))
            axis.grid(axis="x", color="#dddddd", lw=0.5, zorder=0)
            axis.set_axisbelow(True)
            axis.spines[["top", "right"]].set_visible(False)
        axes[0][0].set_yticks(range(len(order)), [f"{name} (base {variables[name][1]})" for name in order], fontsize=7)
        if panels[0][2]["standard_deviation"] is not None:
            title += "; grey: runs that are equally good, and two of their standard deviations"
        figure.suptitle(title, fontsize=7.5, x=0.01, ha="left")
        figure.savefig(path, dpi=150, metadata={"Software": None})
        plt.close(figure)


def label_ends(axis, y, mean, found):
    """Write the values of a variable beside the two ends of its bar."""
    for side, ha in ((-1, "right"), (1, "left")):
        beyond = [(value, result) for value, result in found if side * (result - mean) > 0]
        if beyond:
            value, result = max(beyond, key=lambda pair: side * pair[1])
            axis.annotate(value, (result, y), xytext=(3 * side, 0), textcoords="offset points", ha=ha, va="center",
                          fontsize=6)
