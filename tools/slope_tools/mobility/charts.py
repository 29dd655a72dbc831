"""The pictures of a Mobility: its path on a map, and its profile with the probabilities."""
from pathlib import Path
from typing import Optional

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize
from shapely.geometry.base import BaseGeometry

from ..drawing import figures, maps, palettes, pictures
from ..survey.crs import crs_name
from ..survey.resampling import sample
from .body import Body
from .known import WORDS, Found, Mobility, Way

MARKED = (0.9, 0.5, 0.1, 0.01)      # probabilities that are marked on the path
STYLES = ("-", "--", ":")           # of the curve that counts, and the others


def draw_map(path: Path, mobility: Mobility, body: Body, road: Optional[BaseGeometry],
             to_road: Optional[Way] = None) -> None:
    """Relief, body, road, and the path in the colour of the exceedance that counts; dashed that to the road."""
    way, raster = mobility.path, body.raster
    row, column = np.nonzero(body.depth)
    xs, ys = raster.transform @ np.array([column + 0.5, row + 0.5])
    boxes = [(way.x.min(), way.y.min(), way.x.max(), way.y.max()), (xs.min(), ys.min(), xs.max(), ys.max())]
    shown = maps.window(raster, *boxes)
    with pictures.settings(figures.STYLE):
        figure, axes = maps.relief(raster, raster.z, shown, f"fall path, {WORDS[mobility.chosen]}")
        z, where = maps.part(raster, raster.z, shown)
        maps.contours(axes, z, where, figures.contour_interval(z))
        axes.contour(maps.part(raster, (body.depth > 0).astype(float), shown)[0], [0.5], extent=where, origin="upper",
                     colors=figures.RELEASE, linewidths=1.2)
        if road is not None:
            maps.outline(axes, road, color=figures.ROAD, linewidth=1.0)
        points = np.column_stack([way.x, way.y])
        curve = mobility.curves[mobility.chosen]
        middle = (curve[1:] + curve[:-1]) / 2
        drawn = axes.add_collection(LineCollection(np.stack([points[:-1], points[1:]], axis=1), cmap=palettes.PATH,
                                                   norm=Normalize(0, 1), linewidths=3, array=middle))
        figure.colorbar(drawn, cax=axes.inset_axes([1.12, 0, 0.03, 1]), label="share of known events that go beyond")
        if to_road and not to_road.own:
            other = to_road.mobilities.decides.path
            axes.plot(other.x, other.y, "--", color="black", lw=0.8)
        axes.plot(*way.crown[:2], "^", color=figures.RELEASE, ms=6, mec="white", mew=0.5)
        for share in MARKED:
            length = mobility.length_at(share)
            if length:
                x, y = (np.interp(length, way.length, values) for values in (way.x, way.y))
                axes.plot(x, y, "o", color="black", ms=3)
                axes.annotate(f"{100 * share:g} %", (x, y), xytext=(4, 3), textcoords="offset points", fontsize=7)
        maps.crs_axes(axes, raster, crs_name(raster.crs) if raster.crs is not None else "")
        maps.save(figure, path)


def draw_profile(path: Path, mobilities: Found, body: Body, to_road: Optional[Way]) -> None:
    """Ground along the path above, probabilities below: of the events that count, of others the curve that would; the
    road by the path that leads there."""
    counts = mobilities.decides
    way = counts.path
    ground = way.elevation(body)
    with pictures.settings(figures.STYLE):
        figure, (above, below) = pictures.subplots(2, 1, figsize=(figures.FULL, 4.6), sharex=True)
        above.plot(way.length, ground, color="black", lw=1.0)
        above.fill_between(way.length, sample(body.raster._replace(z=body.base), way.x, way.y), ground,
                           color=figures.RELEASE, alpha=0.25, lw=0, label="released body")
        above.axhline(way.crown[2], color=figures.RELEASE, lw=0.7, ls=":", label="elevation of the crown")
        above.set(ylabel="elevation (m)")
        for style, kind in zip(STYLES, (counts.chosen, *(one for one in counts.curves if one != counts.chosen))):
            below.plot(way.length, counts.curves[kind], style, color=figures.COLOURS[0], label=WORDS[kind])
        for one in mobilities.each:
            if one is not counts and one.in_range:
                below.plot(way.length, one.curves[one.chosen], color=figures.COLOURS[1], label=one.law.name)
        below.set(xlabel="length along the fall path (m)", ylabel="share that goes beyond", ylim=(0, 1.02),
                  xlim=(0, way.length[-1]))
        if to_road and not to_road.own:
            other = to_road.mobilities.decides
            above.plot(other.path.length, other.path.elevation(body), "--", color=figures.ROAD, lw=0.8,
                       label="along the part of the mass that comes to the road")
            below.plot(other.path.length, other.curves[other.chosen], "--", color=figures.ROAD, lw=0.8,
                       label="of that part")
        for axes in (above, below):
            if to_road:
                road = to_road.at
                axes.axvline(road.length, color=figures.ROAD, lw=1.0,
                             label="road" if road.met else f"nearest to the road, {road.beside:.0f} m beside")
            axes.legend(loc="upper right")
            axes.grid(color="#dddddd", lw=0.4)
        if not (mobilities.by_set and mobilities.by_set.in_range):
            above.set_title(counts.law.name, loc="left")
        pictures.save(figure, path)
