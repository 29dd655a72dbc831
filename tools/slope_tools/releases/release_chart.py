"""The picture of a body that is released: map with its depths, and a section along the fall line."""
import numpy as np
from scipy.ndimage import label

from ..drawing import figures, palettes, pictures
from ..drawing.figures import FULL, RELEASE, SECTION, STYLE
from ..drawing.maps import contours, draw_relief, outline, part, scheme, window
from ..survey.rasters import Raster
from ..survey.resampling import sample
from .release_area import Area, fall
from .release_toe import depth_of

ROOM = 0.35         # of the body's length, beyond each end of the section
POINTS = 600        # of the section


def draw_release(path, raster: Raster, area: Area, slip: np.ndarray, geometry, title: str) -> None:
    """Write the picture. slip: the ground without the body (m) on the nodes of the area; geometry: polygon or None."""
    whole = raster.z.copy()
    rows, columns = slip.shape
    whole[area.corner[0]:area.corner[0] + rows, area.corner[1]:area.corner[1] + columns] = slip
    depth = raster.z - whole
    row, column = np.nonzero(area.z > slip)
    half = area.cell / 2
    body = (area.x[column.min()] - half, area.y[row.max()] - half, area.x[column.max()] + half,
            area.y[row.min()] + half)
    ends, length = section_line(area, largest_part(depth_of(area, slip)))
    line = ends[0] + np.linspace(0, 1, POINTS)[:, None] * (ends[1] - ends[0])
    shown = window(raster, body, (*ends.min(axis=0), *ends.max(axis=0)), geometry and geometry.bounds)

    along = np.linspace(0, length, POINTS)
    ground, base = (sample(raster._replace(z=z), *line.T) for z in (raster.z, whole))

    with pictures.settings(STYLE):
        tall = min(max(FULL * (shown[3] - shown[1]) / (shown[2] - shown[0]), 2.0), 5.5)
        low = min(max(0.9 * FULL * np.ptp(ground[np.isfinite(ground)]) / length, 1.2), 4.0)
        figure, (map_axes, section) = pictures.subplots(2, 1, figsize=(FULL, tall + low), height_ratios=(tall, low))
        draw_map(figure, map_axes, raster, depth, shown, geometry)
        map_axes.plot(*line.T, color=SECTION, lw=0.8, ls=(0, (6, 2, 1, 2)))
        for point, name in zip(ends, ("A", "A'")):
            map_axes.annotate(name, point, fontsize=7, fontweight="bold", ha="center", va="center",
                              bbox={"boxstyle": "circle,pad=0.15", "fc": "white", "ec": SECTION, "lw": 0.5})
        map_axes.set_title(title)
        section.fill_between(along, base, ground, where=ground > base, color=RELEASE, alpha=0.25, lw=0,
                             label="released body")
        section.plot(along, ground, color="black", lw=1.0, label="ground")
        section.plot(along, np.where(ground > base, base, np.nan), color=RELEASE, lw=1.1, label="slip surface")
        section.set(xlabel="A to A', down the fall line (m)", ylabel="height (m)", aspect="equal", xlim=(0, length))
        figures.legend_above(section)
        section.grid(color="#dddddd", lw=0.4)
        pictures.save(figure, path, bbox_inches="tight")


def largest_part(depth: np.ndarray) -> np.ndarray:
    """Mask of the part of a body, whose depth (m) is > 0, that has the largest volume."""
    parts, count = label(depth > 0, np.ones((3, 3)))
    return parts == 1 + np.argmax(np.bincount(parts.ravel(), depth.ravel(), count + 1)[1:])


def section_line(area: Area, body: np.ndarray):
    """Ends of the line down the fall line through the middle of a mask, an array of two points, and its length."""
    row, column = np.nonzero(body)
    points = np.column_stack([area.x[column], area.y[row]])
    downhill, _ = fall(area.x, area.y, area.z, body)
    middle = points.mean(axis=0)
    place = (points - middle) @ downhill
    room = ROOM * np.ptp(place) + 2 * area.cell
    first, last = place.min() - room, place.max() + room
    return middle + np.array([[first], [last]]) * downhill, float(last - first)


def draw_map(figure, axes, raster: Raster, depth: np.ndarray, shown, geometry) -> None:
    """Shaded relief, contours, depths of the body in classes, the polygon."""
    z, where = draw_relief(axes, raster, raster.z, shown, interpolation="bilinear")
    axes.set(xlim=(shown[0], shown[2]), ylim=(shown[1], shown[3]))
    contours(axes, z, where, figures.contour_interval(z), alpha=0.7)
    values, _ = part(raster, depth, shown)
    bounds = figures.even(float(np.nanmax(depth)))
    colours, norm = scheme(palettes.DEPTH, bounds)
    image = axes.imshow(np.ma.masked_where(~(values > 0), values), cmap=colours, norm=norm, alpha=0.75, extent=where,
                        interpolation="nearest")
    figure.colorbar(image, cax=axes.inset_axes([1.03, 0.05, 0.05, 0.9]), label="depth below the ground (m)")
    if geometry is not None:
        outline(axes, geometry, color=RELEASE, linewidth=1.0, linestyle="--")
    axes.set(xlabel="x (m)", ylabel="y (m)", aspect="equal")
