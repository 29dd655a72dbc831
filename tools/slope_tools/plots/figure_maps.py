"""The maps of a report on a shaded relief, as data URIs."""
import math
from typing import Any, List, Mapping, NamedTuple, Optional, Tuple

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.patches import Rectangle

from ..drawing import figures, palettes, pictures
from ..drawing.figures import FULL, HALF, RELEASE, ROAD, SECTION, STYLE, TITLE, classes_of, text_width, wrapped
from ..drawing.maps import contours, draw_relief, outline, part, scheme
from ..geometry import parts_of, polygons_of
from ..survey.rasters import crs_name
from . import sheets
from .known_reach import NOTHING, SHARES, KnownReach
from .sheets import Box, Entry, Frame

TALL = {FULL: 5.2, HALF: 3.7}       # inches: the tallest map
MESH_FONT, LEAST_FONT = 6.5, 4.0    # points, of the numbers in a mesh: as a rule, and the smallest that can be read
SECTION_LINE = {"color": SECTION, "lw": 0.9, "ls": (0, (6, 2, 1, 2))}
RELEASE_LINE = {"color": RELEASE, "lw": 0.9, "ls": "--"}
WALL = {"color": "#111111", "lw": 1.2}
LINE = {"color": "#8a5aa8", "lw": 1.2}
ZONE = {"color": "#7a4d1f", "lw": 0.9, "ls": "-."}
MAPPED = {"color": "#1f2fbf", "lw": 1.3}
PATH = {"color": "#00695c", "lw": 0.7, "ls": (0, (1, 1.5))}
OUTLINES = {0.95: {"color": "#111111", "lw": 1.4}, 0.5: {"color": "#111111", "lw": 1.1, "ls": (0, (4, 1.5))},
            0.05: {"color": "#111111", "lw": 1.0, "ls": (0, (1, 1.2))}}
MARKS = {0.5: {"color": "#00695c", "lw": 1.6}, 0.1: {"color": "#00695c", "lw": 1.6, "ls": (0, (1.5, 0.8))}}
TINTS = LinearSegmentedColormap.from_list(
    "tints", ["#5f8f5a", "#9dbb7c", "#d9d39a", "#c8a36c", "#a87a55", "#e9e4de"])


class Exceeded(NamedTuple):
    """The share of whom a deposit is thicker than `thick` (m) at each cell; its OUTLINES are drawn.

    far: the share that goes beyond all runs, nobody knows how far: a line of no more than that has no place; short:
    that which ends before all of them.
    """
    share: np.ndarray
    whom: str
    thick: float
    far: float = 0.0
    short: float = 0.0

    @property
    def drawn(self) -> List[float]:
        return [one for one in OUTLINES if self.share.max() > one > self.far]

    def entries(self) -> List[Entry]:
        return [Entry(f"thicker than {self.thick:g} m in {100 * one:g} % of {self.whom}", OUTLINES[one])
                for one in self.drawn]


class Layers(NamedTuple):
    """What is drawn over every map; geometries are in local metres."""
    raster: Any                          # grid, CRS and offset of the deposit
    ground: np.ndarray                   # the ground before
    shown: Tuple                         # local xlo, ylo, xhi, yhi of the maps
    release: Optional[np.ndarray] = None     # mask: cells that held balls at the start
    road: Any = None                     # polygon
    section: Optional[np.ndarray] = None     # points of the line, rows of x y
    interval: float = 5.0                # of the contours, m
    walls: Mapping[str, Any] = {}        # what structures cover
    lines: Mapping[str, np.ndarray] = {}     # points of control lines, rows of x y
    reach: KnownReach = NOTHING              # of known events
    mapped: Any = None                       # the deposit of an event: a polygon, or a mask of cells
    zones: Mapping[str, Any] = {}            # of the ground: polygons
    exceeded: Optional[Exceeded] = None      # by an ensemble


# --- what is drawn into the axes of a map ---

def base_map(axes, layers, labels=True):
    """Shaded relief, contours, zones of the ground, release, road, structures, control lines, reach of known events."""
    z, where = draw_relief(axes, layers.raster, layers.ground, layers.shown, interpolation="bilinear", zorder=1)
    known = z[np.isfinite(z)]
    if min(z.shape) >= 2 and known.size and np.ptp(known) > layers.interval / 2:
        contours(axes, z, where, layers.interval, labels, alpha=0.6, zorder=3)
    if layers.release is not None:
        draw_edge(axes, layers, layers.release, 0.5, RELEASE_LINE, 5)
    if layers.road is not None:
        outline(axes, layers.road, color=ROAD, linewidth=1.1, zorder=6)
        for polygon in polygons_of(layers.road):
            axes.fill(*np.asarray(polygon.exterior.coords)[:, :2].T, color=ROAD, alpha=0.13, lw=0, zorder=1.5)
    for name, zone in layers.zones.items():
        outline(axes, zone, color=ZONE["color"], linewidth=ZONE["lw"], linestyle=ZONE["ls"], zorder=4)
        place = zone.representative_point()
        axes.annotate(name, (place.x, place.y), fontsize=6, color=ZONE["color"], annotation_clip=True, zorder=8)
    draw_obstacles(axes, layers)
    draw_mapped(axes, layers)
    for share in layers.exceeded.drawn if layers.exceeded else ():
        draw_edge(axes, layers, layers.exceeded.share, share, OUTLINES[share], 6)
    if len(layers.reach.path):
        axes.plot(*layers.reach.path.T, zorder=6, **PATH)
    for mark in layers.reach.marks:
        axes.plot(*mark.ends.T, zorder=6.5, **MARKS[mark.share])


def draw_edge(axes, layers, values, level, style, zorder):
    """A line around where a raster is above a level."""
    z, where = part(layers.raster, values.astype(float), layers.shown)
    if min(z.shape) >= 2 and np.ptp(z) > 0:
        axes.contour(z, [level], extent=where, origin="upper", colors=style["color"], linewidths=style["lw"],
                     linestyles=[style.get("ls", "-")], zorder=zorder)


def draw_obstacles(axes, layers):
    """Structures and control lines."""
    for shape in layers.walls.values():
        for one in parts_of(shape):
            if one.geom_type == "Polygon":
                axes.fill(*np.asarray(one.exterior.coords)[:, :2].T, color=WALL["color"], alpha=0.35, lw=0, zorder=6)
                one = one.exterior
            axes.plot(*np.asarray(one.coords)[:, :2].T, zorder=6, **WALL)
    for points in layers.lines.values():
        axes.plot(*np.asarray(points).T, zorder=6, **LINE)


def draw_mapped(axes, layers):
    """The outline of a mapped deposit."""
    if isinstance(layers.mapped, np.ndarray):
        draw_edge(axes, layers, layers.mapped, 0.5, MAPPED, 6)
    elif layers.mapped is not None:
        outline(axes, layers.mapped, zorder=6, **MAPPED)


def draw_values(axes, layers, values, bounds, colours, mask=None, alpha=0.82):
    """A raster in classes; values below the first bound, and where mask is False, are not drawn."""
    z, where = part(layers.raster, values, layers.shown)
    hidden = ~(z >= bounds[0])
    if mask is not None:
        hidden |= ~part(layers.raster, mask.astype(float), layers.shown)[0].astype(bool)
    cmap, norm = scheme(colours, bounds)
    return axes.imshow(np.ma.masked_where(hidden, z), extent=where, cmap=cmap, norm=norm, alpha=alpha,
                       interpolation="nearest", zorder=2)


def draw_section_line(axes, layers, size):
    """The line of the section, with A and A' just beyond its ends."""
    if layers.section is None:
        return
    line = np.asarray(layers.section)
    axes.plot(*line.T, zorder=7, **SECTION_LINE)
    shown = np.array(layers.shown)
    scale = size[0] / (shown[2] - shown[0])     # inches per metre
    room = 0.11 / scale
    for point, towards, text in ((line[0], line[0] - line[1], "A"), (line[-1], line[-1] - line[-2], "A'")):
        place = point + towards / max(np.hypot(*towards), 1e-30) * 0.1 / scale
        axes.text(*np.clip(place, shown[:2] + room, shown[2:] - room), text, ha="center", va="center",
                  fontsize=6.5, fontweight="bold", zorder=9,
                  bbox={"boxstyle": "circle,pad=0.12", "fc": "white", "ec": SECTION, "lw": 0.5})


def list_legend_entries(layers):
    """What the lines over a map are."""
    entries = []
    if layers.release is not None and layers.release.any():
        entries.append(Entry("released mass", RELEASE_LINE))
    if layers.road is not None:
        entries.append(Entry("road", {"color": ROAD, "lw": 1.1}))
    if layers.walls:
        entries.append(Entry("structure", WALL))
    if layers.lines:
        entries.append(Entry("control line", LINE))
    if layers.mapped is not None:
        entries.append(Entry("mapped deposit", MAPPED))
    if layers.zones:
        entries.append(Entry("zone of the ground", ZONE))
    if layers.exceeded:
        entries += layers.exceeded.entries()
    if len(layers.reach.path):
        entries.append(Entry("fall path", PATH))
    entries += entries_of_marks({mark.share for mark in layers.reach.marks})
    if layers.section is not None:
        entries.append(Entry("section A-A'", SECTION_LINE))
    return [*entries, Entry(f"contours every {layers.interval:g} m", {"color": "#333333", "lw": 0.5})]


def entries_of_marks(shares):
    """What the marks of known events are."""
    return [Entry(f"{SHARES[share]} of known events go farther", MARKS[share]) for share in SHARES if share in shares]


def frame_of(layers, names):
    crs = layers.raster.crs if names else None
    return Frame(layers.shown, names, *(() if crs is None else (layers.raster.offset, crs_name(crs))))


def finish(sheet, layers, size, left, legend=None):
    """The scale, the legend and the data URI of a sheet whose maps have that size."""
    width = layers.shown[2] - layers.shown[0]
    sheets.scale_and_legend(sheet, left, size[0] / width, min(width, 2.5 / (size[0] / width)),
                            legend or list_legend_entries(layers), layers.raster.crs is not None)
    return figures.data_uri(sheet.finish())


# --- maps ---

def compose_map(layers, title, bar, bounds, draw, width=FULL, labels=True, classed=True, legend=None):
    """A map with one colour bar.

    draw(axes, inches per metre) draws what it is of, and gives the image that the bar is of, or None; bar: its name;
    bounds: its numbers, of classes or of a range; legend: entries, those of the layers if None, which draw may add to.
    """
    with pictures.settings(STYLE):
        frame = frame_of(layers, width == FULL)
        sheet, axes, size, beside, below = sheets.single(width, frame, title, TALL[width], bounds)
        base_map(axes, layers, labels)
        image = draw(axes, size[0] / frame.width)
        draw_section_line(axes, layers, size)
        sheets.draw_axes(axes, frame, size)
        if image is not None:
            sheets.colour_bar(sheet, image, bounds if classed else None, bar, beside, below)
        return finish(sheet, layers, size, sheets.margins(frame)[0], legend)


def value_map(layers, values, title, bar, bounds, colours, width=HALF, mask=None):
    """A map of a raster in classes; values below the first bound, and where mask is False, are not drawn."""
    return compose_map(layers, title, bar, bounds, lambda axes, _: draw_values(
        axes, layers, values, bounds, colours, mask), width, width == FULL)


def mesh_map(layers, removed, mesh, title):
    """What must be removed: its thickness, and its volume (m3) in the cells of a mesh, a Raster in local metres.

    The data URI, and whether the mesh is drawn: only where its numbers can be read.
    """
    bounds, side, font = classes_of(removed), mesh.transform.a, 0.0

    def draw(axes, scale):
        nonlocal font
        image = draw_values(axes, layers, removed, bounds, palettes.THICKNESS, alpha=0.75)
        widest = max((text_width(f"{value:,.0f}", MESH_FONT) for value in mesh.z[mesh.z >= 0.5]), default=0)
        font = MESH_FONT * min(1, 0.9 * side * scale / max(widest, 1e-9))
        for row, column in np.argwhere(mesh.z >= (0.5 if font >= LEAST_FONT else np.inf)):
            x, y = mesh.transform @ (column, row + 1)
            axes.add_patch(Rectangle((x, y), side, side, fill=False, lw=0.35, edgecolor="#222222", zorder=6))
            axes.text(x + side / 2, y + side / 2, f"{mesh.z[row, column]:,.0f}", fontsize=font, ha="center",
                      va="center", zorder=7, clip_on=True)
        return image
    uri = compose_map(layers._replace(section=None), title, "thickness to remove (m)", bounds, draw, labels=False)
    return uri, font >= LEAST_FONT


def road_map(layers, parts, bounds, title, bar):
    """Parts of the road, areas in local metres, by a value in classes; parts: list of (area, value)."""
    cmap, norm = scheme(palettes.SHARE, bounds)

    def draw(axes, _):
        for area, value in parts:
            for polygon in polygons_of(area):
                axes.fill(*np.asarray(polygon.exterior.coords).T, color=cmap(norm(value)), lw=0, zorder=6.2)
        return ScalarMappable(norm, cmap)
    return compose_map(layers, title, bar, bounds, draw)


def terrain_map(layers, detail):
    """The whole terrain, tinted by height; detail: the part that the other maps show."""
    z, where = part(layers.raster, layers.ground, layers.shown)
    numbers = [np.nanmin(z), np.nanmax(z)] if np.isfinite(z).any() else [0]

    def draw(axes, _):
        if tuple(detail) != tuple(layers.shown):
            axes.add_patch(Rectangle(detail[:2], detail[2] - detail[0], detail[3] - detail[1], fill=False, lw=0.9,
                                     edgecolor="black", zorder=6))
        return axes.imshow(np.ma.masked_invalid(z), extent=where, cmap=TINTS, alpha=0.45, zorder=2,
                           interpolation="bilinear")
    return compose_map(layers, "Terrain before the collapse", "height (m)", [round(float(value)) for value in numbers],
                       draw, classed=False)


def small_maps(layers, panels, bar, bounds, colours):
    """The same map of several runs side by side; panels: list of (title, values)."""
    with pictures.settings(STYLE):
        sheet, frame = sheets.Sheet(FULL), frame_of(layers, False)
        left, _, right, bottom = sheets.margins(frame)
        beside = sheets.bar_room(bounds)
        columns, size = sheets.layout(len(panels), frame, FULL - left - right - beside, 1.5 * TALL[FULL])
        rows = math.ceil(len(panels) / columns)
        step = max(size[0], sheets.NARROW) + 0.1
        top: float = sheet.bottom
        image: Any = None
        for row in range(rows):
            titles = [wrapped(title, step - 0.1, TITLE - 1.5, True) for title, _ in
                      panels[row * columns:(row + 1) * columns]]
            top += max(len(lines) for lines in titles) * TITLE * 1.25 / 72 + 0.02
            for column, lines in enumerate(titles):
                place = row * columns + column
                lowest = place + columns >= len(panels)
                axes = sheet.axes(Box(left + column * step, top, *size))
                for k, line in enumerate(reversed(lines)):
                    sheet.write(line, left + column * step, top - (k + 1) * (TITLE - 1.5) * 1.25 / 72 - 0.03,
                                TITLE - 1.5, fontweight="bold")
                base_map(axes, layers, labels=False)
                image = draw_values(axes, layers, panels[place][1], bounds, colours)
                sheets.draw_axes(axes, frame, size, left=column == 0, bottom=lowest)
            below_is_full = len(panels) - (row + 1) * columns >= columns
            top += size[1] + (0.05 if below_is_full else bottom)
        sheet.bottom = top
        upright = rows * size[1] >= sheets.LEAST_BAR
        sheets.colour_bar(sheet, image, bounds, bar,
                          Box(left + columns * step - 0.1 + right + 0.05, sheet.boxes[0][1].top, sheets.BAR,
                              min(sheets.MOST_BAR, top - bottom - sheets.EDGE - 0.2)) if upright else None,
                          Box(left, top + 0.04, 3.5, sheets.BAR))
        return finish(sheet, layers, size, left)
