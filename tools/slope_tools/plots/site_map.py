"""The map of a site, to check by eye: ground, body, fall path, road, structures, and where the trial run went."""
import base64
from pathlib import Path
from typing import List

import numpy as np

from ..drawing import figures, palettes
from ..drawing.maps import outline, window
from ..geometry import extent, extent_of
from ..mobility import body, known
from ..sites.site_layers import Shown
from . import figure_maps, known_reach
from .figure_maps import LINE, WALL
from .sheets import Entry

RELEASE = {"color": figures.RELEASE, "lw": 1.0, "ls": "--"}
OBSERVED = {"color": "#d1603d", "lw": 1.1}
TRIAL = {"color": "#1f7a4d", "lw": 1.0, "ls": ":"}
REACHED = 0.1       # m of thickness


def draw_site_map(path: Path, layers: Shown, title: str) -> None:
    """Write the map as a PNG."""
    raster, shown = layers.raster, window(layers.raster, *boxes(layers))
    base = figure_maps.Layers(raster, raster.z, shown, None, layers.road, None, figures.contour_interval(raster.z),
                              reach=reach_of(layers), zones={zone.name: zone.geometry for zone in layers.zones})
    bounds, legend = figures.even(float(layers.depth.max())), figure_maps.list_legend_entries(base)

    def draw(axes, _):
        image = figure_maps.draw_values(axes, base, layers.depth, bounds, palettes.DEPTH, layers.depth > 0)
        legend.extend(draw_outlines(axes, layers))
        return image if layers.depth.any() else None
    uri = figure_maps.compose_map(base, title, "depth of the body (m)", bounds, draw, legend=legend)
    path.write_bytes(base64.b64decode(uri.partition(",")[2]))


def reach_of(layers: Shown) -> known_reach.KnownReach:
    """The fall path of the body, and how far known events went on it; nothing without a body that falls."""
    found = known.among_events(
        None, lambda: body.of_arrays(layers.raster, layers.depth, "the site"), layers.known).found
    if not found:
        return known_reach.NOTHING
    path, reach = found.decides.path, known_reach.of_mobility(found.decides)
    return reach._replace(path=np.column_stack([path.x, path.y]))


def boxes(layers: Shown) -> List:
    """The boxes of all that must be seen; parts beyond the terrain are cut off."""
    raster = layers.raster
    boxes = [extent_of(one.transform, mask) for one, mask in (
        (raster, layers.depth > 0), *([(layers.reached, layers.reached.z > REACHED)] if layers.reached else []))
        if mask.any()]
    boxes += [one.bounds for one in (layers.release, layers.road, layers.observed) if one is not None]
    boxes += [(*one.low[:2], *one.high[:2]) for one in layers.structures]
    boxes += [(*one.points.min(axis=0), *one.points.max(axis=0)) for one in layers.lines]
    whole = extent(raster)
    return [(*np.clip(one[:2], whole[:2], whole[2:]), *np.clip(one[2:], whole[:2], whole[2:])) for one in boxes]


def draw_outlines(axes, layers: Shown) -> List[Entry]:
    """Everything that is a line; what it is, for the legend."""
    entries = []
    for geometry, style, name in ((layers.release, RELEASE, "release polygon"),
                                  (layers.observed, OBSERVED, "mapped deposit")):
        if geometry is not None:
            outline(axes, geometry, color=style["color"], linewidth=style["lw"], linestyle=style.get("ls", "-"),
                    zorder=6)
            entries.append(Entry(name, style))
    for one in layers.structures:
        (xlo, ylo), (xhi, yhi) = one.low[:2], one.high[:2]
        axes.plot([xlo, xhi, xhi, xlo, xlo], [ylo, ylo, yhi, yhi, ylo], color=WALL["color"], lw=WALL["lw"],
                  zorder=7)
        axes.annotate(one.name, (xhi, yhi), fontsize=6, xytext=(2, 2), textcoords="offset points", zorder=8)
    if layers.structures:
        entries.append(Entry("structure", WALL))
    for line in layers.lines:
        axes.plot(*line.points.T, color=LINE["color"], lw=LINE["lw"], zorder=7)
        axes.annotate(line.name, line.points[-1], fontsize=6, xytext=(2, 2), textcoords="offset points", zorder=8)
    if layers.lines:
        entries.append(Entry("control line", LINE))
    if layers.reached is not None and (layers.reached.z > REACHED).any():
        xlo, ylo, xhi, yhi = extent(layers.reached)
        axes.contour(np.nan_to_num(layers.reached.z), [REACHED], extent=(xlo, xhi, ylo, yhi), origin="upper",
                     colors=TRIAL["color"], linewidths=TRIAL["lw"], linestyles=TRIAL["ls"], zorder=5)
        entries.append(Entry("reached in the trial run", TRIAL))
    return entries
