"""The picture of a search: the factor of safety and the bodies in plan, a section of each."""
import math
from pathlib import Path
from typing import Dict, List, Optional, Sequence

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import BoundaryNorm

from ..drawing import figures, palettes, pictures
from ..drawing.figures import COLOURS, FULL, STYLE
from ..drawing.maps import contours, draw_relief, part, window
from ..geometry import extent, extent_of
from ..survey.rasters import Raster
from ..survey.resampling import sample
from . import bodies, columns
from .doubts import length

CLASSES = (0.8, 0.9, 1.0, 1.1, 1.2, 1.3, 1.5, 2.0, 3.0)     # of the factor of safety
MOST = 6            # sections
ROOM = 0.35         # of the body's length, beyond each end of its section
POINTS = 600


def draw_slips(path: Path, raster: Raster, factor: np.ndarray, rows: Sequence[Dict[str, float]],
               masks: List[np.ndarray], title: str, rock: Optional[np.ndarray] = None) -> None:
    """Write the picture.

    factor: the least one in each cell; masks: the cells of each body, as in rows; rock: heights of the bedrock.
    """
    boxes = [extent_of(raster.transform, mask) for mask in (np.isfinite(factor), *masks) if mask.any()]
    shown = window(raster, *boxes) if boxes else extent(raster)
    sections = min(len(rows), MOST)
    deep = math.ceil(sections / 2)
    with pictures.settings(STYLE):
        tall = min(max(0.85 * FULL * (shown[3] - shown[1]) / (shown[2] - shown[0]), 2.0), 6.0)
        figure = pictures.figure(figsize=(FULL, tall + 2.0 * deep))
        grid = figure.add_gridspec(1 + deep, 2, height_ratios=[tall] + [2.0] * deep)
        axes = figure.add_subplot(grid[0, :])
        draw_map(axes, raster, factor, shown)
        for k, (row, mask) in enumerate(zip(rows, masks)):
            colour = COLOURS[k % len(COLOURS)]
            draw_body(axes, raster, row, mask, colour)
            if k < sections:
                draw_slip_section(figure.add_subplot(grid[1 + k // 2, k % 2]), raster, row, mask, colour,
                                  rock)
        axes.set_title(title)
        pictures.save(figure, path, bbox_inches="tight")


def middle_of(raster: Raster, mask: np.ndarray) -> np.ndarray:
    """x and y of the middle of the cells of a mask."""
    row, column = np.nonzero(mask)
    return np.array(raster.transform @ (column.mean() + 0.5, row.mean() + 0.5))


def draw_map(axes, raster: Raster, factor: np.ndarray, shown) -> None:
    """Shaded relief, contours, least factor of safety in classes."""
    z, where = draw_relief(axes, raster, raster.z, shown, interpolation="bilinear")
    contours(axes, z, where, figures.contour_interval(z), alpha=0.7)
    values, _ = part(raster, factor, shown)
    image = axes.imshow(np.ma.masked_invalid(values), cmap=palettes.SAFETY, extent=where, alpha=0.75,
                        interpolation="nearest",
                        norm=BoundaryNorm(CLASSES, colormaps[palettes.SAFETY].N, extend="both"))
    axes.figure.colorbar(image, ax=axes, shrink=0.9, label="least factor of safety of the surfaces")
    axes.set(xlim=(shown[0], shown[2]), ylim=(shown[1], shown[3]), xlabel="x (m)", ylabel="y (m)", aspect="equal")


def draw_body(axes, raster: Raster, row: Dict[str, float], mask: np.ndarray, colour: str) -> None:
    """Outline of a body, its number, an arrow in the direction of sliding."""
    rows, columns = mask.shape
    where = (*(raster.transform @ (0, 0)), *(raster.transform @ (columns, rows)))
    axes.contour(mask, [0.5], extent=(where[0], where[2], where[3], where[1]), origin="upper", colors=colour,
                 linewidths=1.4)
    along = np.radians(row["direction"])
    start = middle_of(raster, mask)
    end = start + 0.3 * length(raster, mask, row["direction"]) * np.array([np.cos(along), np.sin(along)])
    axes.annotate("", end, start, arrowprops={"arrowstyle": "-|>", "color": colour, "lw": 1.2})
    axes.annotate(f"{row['rank']:.0f}", start, ha="center", va="center", fontsize=7, fontweight="bold",
                  bbox={"boxstyle": "circle,pad=0.15", "fc": "white", "ec": colour, "lw": 0.8})


def draw_slip_section(axes, raster: Raster, row: Dict[str, float], mask: np.ndarray, colour: str,
                      rock: Optional[np.ndarray] = None) -> None:
    """Ground, bedrock and base along the direction of sliding through the middle of a body, down to the right."""
    along = np.array([math.cos(math.radians(row["direction"])), math.sin(math.radians(row["direction"]))])
    long = length(raster, mask, row["direction"])
    place = np.linspace(-(0.5 + ROOM) * long, (0.5 + ROOM) * long, POINTS)
    x, y = (middle_of(raster, mask)[:, None] + along[:, None] * place)
    ground = sample(raster, x, y)
    base = columns.height_at(x, y, bodies.centre_of(row), row["radius"], row["direction"], bodies.shape_of(row))
    below = None if rock is None else sample(raster._replace(z=rock), x, y)
    base = columns.limit_by_rock(base, below)
    inside = sample(raster._replace(z=mask.astype(float)), x, y) > 0.25     # other parts above it do not slide
    with np.errstate(invalid="ignore"):
        there = inside & (ground > base)
    way = place - place[0]
    axes.fill_between(way, base, ground, where=there, color=colour, alpha=0.25, lw=0)
    axes.plot(way, ground, color="black", lw=1.0)
    if below is not None:
        axes.plot(way, np.fmin(below, ground), color="gray", lw=1.0, ls="--", label="bedrock")
        figures.legend_above(axes)
    axes.plot(way, np.where(there, base, np.nan), color=colour, lw=1.2)
    axes.set(xlabel="in the direction of sliding (m)", ylabel="height (m)", aspect="equal")
    axes.set_title(f"{row['rank']:.0f}: F = {row['factor']:.3f}, yield coefficient {row['yield']:.3f}", loc="left")
    axes.grid(color="#dddddd", lw=0.4)
