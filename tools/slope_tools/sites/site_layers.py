"""What lies on a site's terrain: road, structures, control lines, a mapped deposit, and the motion of the ground."""
import shlex
from pathlib import Path
from typing import Any, Callable, Dict, List, Mapping, NamedTuple, Optional, Sequence, Set, TypeVar

import numpy as np
from rasterio.crs import CRS
from shapely.geometry import box
from shapely.geometry.base import BaseGeometry
from shapely.ops import unary_union

from ..errors import SlopeError
from ..findings import Finding
from ..geometry import extent
from ..releases import release_area
from ..survey import beside, polygons, rasters, roads, vectors
from ..survey.crs import as_crs, same_crs
from ..survey.rasters import Raster, crs_name
from . import site_choices, site_inputs, site_roads, site_zones
from .site_inputs import Line, Motion, Structure
from .site_sections import Choices, OfMass
from .site_zones import Zone

T = TypeVar("T")
OBSERVED = "observed"       # .csv of an outline, .tif of a raster


class Layers(NamedTuple):
    """What was read and written into the folder; geometries in local metres."""
    roads: Dict[str, BaseGeometry]          # by their names
    observed: Optional[BaseGeometry]        # None of a raster, too
    structures: List[Structure]
    lines: List[Line]
    motion: Optional[Motion]
    zones: List[Zone]

    @property
    def road(self) -> Optional[BaseGeometry]:
        """All of them; None without one."""
        return unary_union(list(self.roads.values())) if self.roads else None


class Shown(NamedTuple):
    """What the map of a site shows; geometries in local metres."""
    raster: Raster                      # the ground before
    depth: np.ndarray                   # of the body on its nodes, m, 0 where there is none
    release: Optional[BaseGeometry]
    road: Optional[BaseGeometry]
    observed: Optional[BaseGeometry]
    structures: Sequence[Structure]
    lines: Sequence[Line]
    reached: Optional[Raster]           # largest thickness of the trial run, m
    zones: Sequence[Zone] = ()          # of the ground
    known: Mapping[str, Any] = {}       # with which events it is compared, as site.yaml says


def with_missing(choices: OfMass, check: Callable[[], T]) -> T:
    """What a check gives; SlopeError before anything is computed, with all that is missing of road and walls, too."""
    road, along, missing, checked = choices.road, choices.structures, [], []
    try:
        checked.append(check())
    except SlopeError as error:
        missing.append(error)
    missing += [SlopeError(path, roads.WITHOUT_WIDTH) for path in site_roads.list_road_files(choices)
                if road.width is None and roads.is_line(path)]
    if along.walls and along.height is None:
        missing.append(SlopeError("--height", site_inputs.WITHOUT_HEIGHT))
    if missing:
        missing[0].args = ("; ".join(map(str, missing)),)
        raise missing[0]
    return checked[0]


def read_layers(choices: Choices, raster: Raster, folder: Path, tell, warn) -> Layers:
    """Read all layers of the choices, and write what the deck and the study need into a folder; a kind of site may do
    without structures, motion and a mapped deposit.

    Raises SlopeError, which names the file, if one does not fit the terrain.
    """
    road, mass = road_layers(choices, raster, folder, tell, warn), choices if isinstance(choices, OfMass) else None
    observed = observed_layer(mass, raster, folder, tell, warn) if mass else None
    taken: Set[str] = set(site_inputs.TAKEN)
    structures: List[Structure] = []
    if mass:
        along = mass.structures
        structures = site_inputs.structures(along.files, raster, folder, taken)
        structures += site_inputs.walls(read_drawn_lines(choices, along.walls), raster, along.height, along.width,
                                        folder, taken, warn)
    lines = site_inputs.control_lines(read_drawn_lines(choices, choices.lines.files), raster, folder, taken, warn)
    motion = site_inputs.motion(mass.motion.file, folder) if mass and mass.motion.file else None
    path = choices.ground.file
    zones = site_zones.of_choices(site_zones.Source(path, choices.ground.table, assigned(choices, path),
                                                    advice(choices, path)),
                                  raster, folder, tell, warn) if path else []
    for one in structures:
        tell(one.summary)
    for line in lines:
        tell(f"{line.file}: control line of {len(line.points)} points")
    if mass and motion:
        tell(f"{motion.file}: {motion.length:g} s, up to {100 * motion.peak * mass.motion.scale:.4g} gal horizontally")
    return Layers(road, observed, structures, lines, motion, zones)


def read_drawn_lines(choices: Choices, files: Sequence[str]) -> List[site_inputs.Drawn]:
    """Files with lines."""
    return [site_inputs.Drawn(path, assigned(choices, path), advice(choices, path)) for path in files]


def advice(choices: Choices, path: str) -> polygons.Advice:
    """What can be done in slope site where a file does not fit the terrain."""
    own = f"--assign-crs {shlex.quote(Path(vectors.source(path).path).name + '=EPSG:n')}, or save it with its CRS"
    return polygons.Advice(choices.terrain.files[0], "--crs EPSG:n gives it one", own,
                           f"{own}; a GeoJSON that names none is in longitude and latitude")


def assigned(choices: Choices, path: str) -> Optional[CRS]:
    """The CRS that the choices assign to a file, None if they do not."""
    name = site_choices.assigned(choices, path)
    return as_crs(f"--assign-crs {path}", name) if name else None


class Ground(NamedTuple):
    """The ground in a polygon."""
    mean: float         # m
    low: float
    high: float
    slope: float        # degrees, of the plane that fits it best

    @property
    def words(self) -> str:
        return f"{self.mean:.0f} m on average, a slope of {self.slope:.0f} degrees"


def ground_of(choices: Choices, path: str, raster: Raster, asked: roads.Asked = roads.NOTHING) -> Optional[Ground]:
    """The ground in a polygon file or on a road, None if that cannot be read or has too few nodes."""
    try:
        geometry = roads.read_local(path, raster, asked, crs=assigned(choices, path)).polygon
    except SlopeError:
        return None
    inside = release_area.nodes_inside(raster, geometry) & np.isfinite(raster.z)
    if inside.sum() < release_area.FEWEST:
        return None
    z = raster.z[inside]
    columns, rows = raster.transform @ np.meshgrid(np.arange(raster.z.shape[1]) + 0.5, np.arange(len(raster.z)) + 0.5)
    _, slope = release_area.fall(columns[0], rows[:, 0], raster.z, inside)
    return Ground(float(z.mean()), float(z.min()), float(z.max()), slope)


def swapped(choices: Choices, raster: Raster, wholly: bool = False) -> Optional[str]:
    """What speaks for release area and road having been swapped, None if nothing does.

    That is a road on higher and steeper ground; wholly: no part of it as low as the top of the release area.
    """
    paths = choices.release.polygon, choices.road.file
    release, road = (ground_of(choices, path, raster, asked) if path else None for path, asked in
                     zip(paths, (roads.NOTHING, choices.road.asked)))
    higher = release and road and (road.low > release.high if wholly else road.mean > release.mean)
    if release and road and higher and road.slope > release.slope:
        return f"--release {paths[0]}: {release.words}; --road {paths[1]}: {road.words}"
    return None


def polygon_layer(choices: Choices, path: Optional[str], raster: Raster, target: Path, tell, warn):
    """A polygon in local metres, written for the deck; None if there is none."""
    if not path:
        return None
    geometry = polygons.read_local(path, raster, crs=assigned(choices, path), advice=advice(choices, path), warn=warn)
    warn_outside(path, geometry, raster, warn)
    geometry = polygons.write_polygon(target, geometry, raster)
    tell(f"{target.name}: {count_polygons(geometry)}, {geometry.area:,.0f} m2")
    return geometry


def count_polygons(geometry: BaseGeometry) -> str:
    number = len(polygons.polygons_of(geometry))
    return f"{number} polygon{'s' * (number > 1)}"


def road_layers(choices: Choices, raster: Raster, folder: Path, tell, warn) -> Dict[str, BaseGeometry]:
    """The roads in local metres, written for the study; of several the first one also as that of the site."""
    several = site_roads.read_site_roads(choices, raster, lambda path: assigned(choices, path),
                                         lambda path: advice(choices, path), warn)
    written = {}
    for name, (path, road) in several.items():
        if road.line is None:
            warn_outside(path, road.polygon, raster, warn)
        target = folder / site_roads.file_name(name if len(several) > 1 else "")
        written[name] = geometry = roads.write_road(target, road, raster)
        if len(written) == 1 and len(several) > 1:
            roads.write_road(folder / site_roads.ROAD, road, raster)
        tell(f"{target.name}: {describe_road_shape(road, choices.road.width)}, {geometry.area:,.0f} m2")
    return written


def describe_road_shape(road: roads.Road, width: Optional[float]) -> str:
    if road.line is None:
        return count_polygons(road.polygon)
    lengths = [f"{line.length:,.0f}" for line in road.lines]
    return f"{len(lengths)} line{'s' * (len(lengths) > 1)} of {' and '.join(lengths)} m, {width:g} m wide"


def warn_outside(path: str, geometry: BaseGeometry, raster: Raster, warn) -> None:
    """Warn of polygons that lie outside of the terrain in part."""
    beyond = 1 - geometry.intersection(box(*extent(raster))).area / geometry.area
    if beyond > 1e-9:
        warn(Finding("outside", {"file": str(path), "percent": 100 * beyond, "terrain": "the terrain"}))


def observed_layer(choices: OfMass, raster: Raster, folder: Path, tell, warn):
    """The mapped deposit: an outline in local metres, or None after a raster was copied."""
    path = choices.observed.file
    if not path:
        return None
    if not rasters.is_raster(path):
        return polygon_layer(choices, path, raster, folder / f"{OBSERVED}.csv", tell, warn)
    mapped = beside.read_raster_beside(path, raster, False, assigned(choices, path), warn=warn)
    if not same_crs(mapped.crs, raster.crs):
        raise SlopeError(path, f"must be in the CRS of the terrain, {crs_name(raster.crs)} (gdalwarp -t_srs "
                         "reprojects)", crs_name(mapped.crs))
    wrong = np.argwhere((mapped.z < 0) | (mapped.z > rasters.HIGHEST))
    if len(wrong) or not np.nansum(mapped.z) > 0:
        raise SlopeError(path, f"must be thicknesses >= 0 and <= {rasters.HIGHEST:g} m, somewhere > 0",
                         f"{mapped.z[tuple(wrong[0])]:g}" if len(wrong) else "none")
    check_overlap(path, mapped, raster)
    target = folder / f"{OBSERVED}.tif"
    rasters.write_geotiff(target, {"thickness": mapped.z}, mapped)
    tell(f"{target.name}: thickness, {mapped.z.shape[1]} x {mapped.z.shape[0]} cells")
    return None


def check_overlap(path: str, mapped: Raster, raster: Raster) -> None:
    """Raise SlopeError unless something of a mapped thickness, in coordinates of the CRS, lies on the terrain."""
    rows, columns = np.nonzero(np.nan_to_num(mapped.z) > 0)
    x, y = mapped.transform @ (columns + 0.5, rows + 0.5)
    xlo, ylo, xhi, yhi = extent(raster)
    x, y = x + mapped.offset[0] - raster.offset[0], y + mapped.offset[1] - raster.offset[1]
    if not np.any((x >= xlo) & (x <= xhi) & (y >= ylo) & (y <= yhi)):
        far = np.hypot(x - (xlo + xhi) / 2, y - (ylo + yhi) / 2).min()
        raise SlopeError(path, "must have thickness on the terrain", f"{far:,.0f} m from its centre at the nearest")
