"""Pictures of structures and control lines in a report, as data URIs: curves of runs, and a map of pressures."""
import numpy as np
from matplotlib import colormaps
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PolyCollection
from matplotlib.colors import LogNorm, to_rgba
from mpl_toolkits.axes_grid1 import make_axes_locatable

from .. import digits
from ..drawing import figures, palettes, pictures
from ..drawing.figures import COLOURS, FULL, HALF, STYLE

EMPTY = "#e4e6e9"       # of a panel that nothing touched
DECADE = 10.0           # values that span less are on a linear axis
DECADES = 3             # of the pressures that have a colour


def curves(lines, x_label, y_label, title, falling=False):
    """Lines of (name, x, y) as an SVG; falling: y is a share, from 1 down, over x on a log axis if x spans DECADE."""
    with pictures.settings(STYLE):
        figure, axes = pictures.subplots(figsize=(HALF, 2.3))
        for k, (name, x, y) in enumerate(lines):
            axes.plot(x, y, color=COLOURS[k % len(COLOURS)], lw=0.9, label=name,
                      drawstyle="steps-post" if falling else "default")
        axes.set(xlabel=x_label, ylabel=y_label, ylim=(0, 1.02 if falling else None))
        axes.set_title(title, loc="left")
        if falling:
            values = np.concatenate([x for _, x, _ in lines])
            if values.max() > DECADE * values.min():
                axes.set_xscale("log")
            else:
                axes.set_xlim(0, 1.05 * values.max())
        if len(lines) > 1:
            axes.legend(loc="upper right")
        axes.grid(color="#dddddd", lw=0.4)
        axes.spines[["top", "right"]].set_visible(False)
        return figures.data_uri(figure, "svg")


def seen_from(corners, direction):
    """Triangles (n, 3, 3) as seen along a horizontal direction: places (n, 3, 2) across and up, the farthest first."""
    ahead = np.array([direction[0], direction[1], 0.0])
    ahead /= np.linalg.norm(ahead)
    across = np.array([ahead[1], -ahead[0], 0.0])       # to the right of who looks ahead
    places = np.stack([corners @ across, corners[..., 2]], axis=-1)
    order = np.argsort(-(corners.mean(axis=1) @ ahead), kind="stable")
    return places[order], order


def pressure_map(corners, pressure, direction, title):
    """The largest pressure (Pa) on each triangle, seen along the horizontal direction of the load, as a PNG."""
    places, order = seen_from(corners, direction)
    factor, prefix = digits.prefix(max(pressure))
    values = np.asarray(pressure, float)[order] / factor
    one, other = (places[:, 1:] - places[:, :1]).swapaxes(0, 1)
    areas = np.abs(one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0])
    seen = areas > 1e-9 * areas.max()     # others are seen from their edge
    places, values = places[seen], values[seen]
    places[..., 0] -= places[..., 0].min()
    top = values.max()
    with pictures.settings(STYLE):
        span = np.ptp(places.reshape(-1, 2), axis=0)
        tall = min(max(0.8 * FULL * span[1] / max(span[0], 1e-9), 0.5), 2.6) + 0.7
        figure, axes = pictures.subplots(figsize=(FULL, tall))
        norm = LogNorm(top / 10 ** DECADES, top)
        colours = colormaps[palettes.PRESSURE](norm(np.maximum(values, norm.vmin)))
        colours[values <= 0] = to_rgba(EMPTY)
        axes.add_collection(PolyCollection(places, facecolors=colours, edgecolors="#9aa0a6", linewidths=0.15))
        low, high = places.reshape(-1, 2).min(axis=0), places.reshape(-1, 2).max(axis=0)
        room = 0.02 * span.max()
        axes.set(xlim=(low[0] - room, high[0] + room), ylim=(low[1] - room, high[1] + room), aspect="equal",
                 xlabel="along the structure (m)", ylabel="height (m)")
        axes.set_title(title, loc="left")
        beside = make_axes_locatable(axes).append_axes("right", size=0.1, pad=0.08)
        bar = figure.colorbar(ScalarMappable(norm, palettes.PRESSURE), cax=beside, extend="min")
        bar.set_label(f"largest pressure ({prefix}Pa)", fontsize=6.5)
        bar.ax.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
        bar.ax.tick_params(labelsize=6)
        return figures.data_uri(figure)
