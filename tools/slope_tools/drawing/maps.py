"""Maps of a deposit on a shaded relief of the ground, as PNG."""
import math

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import BoundaryNorm, ListedColormap

from ..geometry import extent, polygons_of
from . import palettes, pictures

SIDE = 8.0      # inches, width of a map
PIXELS = 1200   # a raster is thinned out to at most this many cells along a side
RELIEF = {"cmap": "gray", "vmin": -1.6, "vmax": 1.0}     # of imshow: the relief stays lighter than what is drawn on it
STANDING = 60   # degrees: a contour's label that falls more steeply is turned, so that all that stand read upwards
MARGIN = 0.1    # of the shown part around what matters, as a share of its size


def window(raster, *bounds):
    """Local xlo, ylo, xhi, yhi of a part of a raster: around the boxes in bounds, cut to the raster."""
    xlo, ylo, xhi, yhi = np.transpose([bound for bound in bounds if bound])
    low, high = np.array([xlo.min(), ylo.min()]), np.array([xhi.max(), yhi.max()])
    room = max(MARGIN * (high - low).max(), 5 * raster.transform.a)
    whole = extent(raster)
    return *np.maximum(low - room, whole[:2]), *np.minimum(high + room, whole[2:])


def part(raster, values, shown):
    """Values in the window `shown`, thinned out for a picture, and imshow's extent of them."""
    (left, top), (right, bottom) = ~raster.transform @ (shown[0], shown[3]), ~raster.transform @ (shown[2], shown[1])
    rows, columns = raster.z.shape
    top, left = max(0, math.floor(top)), max(0, math.floor(left))
    bottom, right = min(rows, math.ceil(bottom)), min(columns, math.ceil(right))
    step = max(1, math.ceil(max(bottom - top, right - left) / PIXELS))
    t = raster.transform
    values = values[top:bottom:step, left:right:step]
    right, bottom = left + values.shape[1] * step, top + values.shape[0] * step
    return values, (t.c + left * t.a, t.c + right * t.a, t.f + bottom * t.e, t.f + top * t.e)


def shade(z, step):
    """Shaded relief, light from the north-west at 45 degrees; flat ground is 0.71 whatever else is on the map.

    matplotlib's stretches what it finds to 0 to 1, so that a map of nearly flat ground looks like mountains.
    """
    south, east = np.gradient(z, step)
    azimuth, altitude = math.radians(315), math.radians(45)
    light = math.sin(azimuth) * math.cos(altitude), math.cos(azimuth) * math.cos(altitude), math.sin(altitude)
    return np.clip((-east * light[0] + south * light[1] + light[2]) / np.sqrt(1 + east ** 2 + south ** 2), 0, 1)


def contours(axes, z, where, interval, labels=True, **style):
    """Contours of the ground every `interval` metres in imshow's extent `where`, every second one with its height.

    Solid below sea level, too: matplotlib would dash them. style: of the lines.
    """
    known = z[np.isfinite(z)]
    heights = np.arange(math.floor(known.min() / interval), math.ceil(known.max() / interval) + 1) * interval
    # a little above the level, or a flat place at just that level would be full of them
    lines = axes.contour(z, heights + 1e-4 * interval, extent=where, origin="upper", colors="#333333",
                         linewidths=0.35, linestyles="solid", **style)
    if labels:
        for text in axes.clabel(lines, lines.levels[::2], fontsize=5, inline_spacing=2,
                                fmt=lambda level: f"{interval * round(level / interval):g}"):
            text.set_rotation((text.get_rotation() + STANDING) % 180 - STANDING)


def scheme(name, bounds, low=0.15, high=1.0):
    """Colour map and norm of classes; the lightest tones of the colour map are left out."""
    colours = colormaps[name](np.linspace(low, high, len(bounds) - 1))
    return ListedColormap(colours), BoundaryNorm(bounds, len(bounds) - 1)


def draw_relief(axes, raster, ground, shown, **style):
    """The shaded relief of the ground; its heights in the window `shown`, and imshow's extent of them."""
    z, where = part(raster, ground, shown)
    known = np.isfinite(z)
    if min(z.shape) >= 2 and known.any():
        light = shade(np.where(known, z, np.nanmean(z)), (where[1] - where[0]) / z.shape[1])
        axes.imshow(np.where(known, light, np.nan), extent=where, **RELIEF, **style)
    return z, where


def relief(raster, base, shown, title):
    """A figure with the shaded relief of the ground and axes in local metres: figure, axes."""
    width, height = shown[2] - shown[0], shown[3] - shown[1]
    figure, axes = pictures.subplots(figsize=(SIDE, min(max(SIDE * height / width, SIDE / 3), 1.5 * SIDE)), dpi=130)
    draw_relief(axes, raster, base, shown)
    axes.set(xlim=(shown[0], shown[2]), ylim=(shown[1], shown[3]), xlabel="x (m)", ylabel="y (m)", aspect="equal")
    axes.set_title(title, fontsize=10)
    axes.ticklabel_format(useOffset=False, style="plain")
    return figure, axes


def crs_axes(axes, raster, name):
    """Coordinates of the CRS (name) on the upper and the right side, where the raster has one."""
    if raster.crs is None:
        return
    (east, north), style = raster.offset, {"size": 2, "labelsize": 6}
    top = axes.secondary_xaxis("top", functions=(lambda x: x + east, lambda x: x - east))
    right = axes.secondary_yaxis("right", functions=(lambda y: y + north, lambda y: y - north))
    top.set_xlabel(f"east (m), {name}", fontsize=7)
    right.set_ylabel("north (m)", fontsize=7)
    for one, axis in ((top, top.xaxis), (right, right.yaxis)):
        one.tick_params(**style)
        axis.get_major_formatter().set_useOffset(False)
        axis.get_major_formatter().set_scientific(False)
        axis.get_major_locator().set_params(nbins=5)


def values_on(axes, raster, values, shown, label, cmap=palettes.THICKNESS):
    """Draw values > 0 over the relief, with a colour bar."""
    values, where = part(raster, values, shown)
    top = np.nanmax(values, initial=0)
    image = axes.imshow(np.ma.masked_where(~(values > 0), values), cmap=cmap, alpha=0.75, extent=where, vmin=0,
                        vmax=top if top > 0 else 1, interpolation="nearest")
    axes.figure.colorbar(image, cax=axes.inset_axes([1.02, 0, 0.03, 1]), label=label)


def outline(axes, geometry, **style):
    """Draw the edges of polygons."""
    label = style.pop("label", None)
    for polygon in polygons_of(geometry):
        for ring in (polygon.exterior, *polygon.interiors):
            axes.plot(*np.asarray(ring.coords)[:, :2].T, label=label, **style)
            label = None


def save(figure, path):
    """Write the figure, cut to what is drawn."""
    pictures.save(figure, path, dpi="figure", bbox_inches="tight")
