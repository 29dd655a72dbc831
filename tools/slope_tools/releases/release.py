"""The body that is released, below a polygon or from a scar."""
import math
from pathlib import Path
from typing import Any, Dict, List, NamedTuple, Optional, Tuple, Union

import numpy as np

from ..digits import rounded
from ..errors import SlopeError
from ..findings import Finding
from ..survey import features, marks, plausible, polygons, rasters
from ..survey.crs import as_crs
from . import release_area, release_bodies, release_dip, release_parts, release_scar, release_solve, release_toe

SHAPES = ("sphere", "ellipsoid", "plane", "slbl", "slab")
OF_EACH = ("slbl", "slab")      # of SHAPES, which take several polygons: a body in each
ABOVE = "above_ground"      # of a body's choices: where its slip surface is, in the polygon
SCAR_REMEDY = ": --polygon takes a part of the scar, --least D leaves out the noise of two surveys"
CLIFF = 60.0    # degrees, mean of a body's ground; it may be in feet
HOLLOW = 0.05   # of a scar's largest depth; a shallower hollow in its slip surface may be the survey's
SHIFT = 0.25    # m between two surveys, beside the body
COARSE = 50     # cells; a body of fewer is drawn with a coarse brush


class Wanted(NamedTuple):
    """Which body: below a polygon, or a scar."""
    terrain: str                        # the ground before
    polygon: Optional[str] = None
    shape: Optional[str] = None         # of SHAPES; None: what the numbers below belong to
    depth: Optional[float] = None       # m
    volume: Optional[float] = None      # m3
    curvature: Optional[float] = None   # 1/m, of slbl
    dip: Union[float, str, None] = None     # degrees, of a plane; release_dip.LEAST, of a sphere
    direction: Optional[float] = None   # degrees from north, of a plane
    scar: Optional[str] = None          # raster
    scar_is: Optional[str] = None       # of release_scar.KINDS; None: heights, if they look like it
    least: float = 0.0                  # m; a scar is where it is deeper
    crs: Optional[str] = None           # of the polygon, whatever it says
    scar_crs: Optional[str] = None      # of the scar
    foundation: Union[float, str, None] = None  # of the sphere that dips least: level, m, or raster
    foundation_crs: Optional[str] = None
    local: bool = False                 # the polygon is in local metres
    advice: Optional[polygons.Advice] = None        # for messages on the polygon's place
    read: Optional[Tuple[rasters.Raster, Any]] = None   # ground and polygon in local metres, if they are read already

    def called(self, name: str) -> str:
        """What messages call a number: the option, or the attribute of a polygon that is read already."""
        return f"{self.where}: {name}" if self.read else f"--{name}"

    @property
    def where(self) -> str:
        """What messages name: the file that says where the body is."""
        return self.polygon or self.scar or "--polygon"


class Body(NamedTuple):
    """A body that is released."""
    raster: rasters.Raster              # the ground before
    geometry: Any                       # the polygon, in local metres; None without
    area: release_area.Area
    slip: np.ndarray                    # m, on the nodes of the area
    choices: Dict[str, Any]             # shape and its numbers
    measures: release_solve.Measures
    warnings: List[Finding]
    made: List[release_parts.Made] = []     # in each of several polygons

    @property
    def depth(self) -> np.ndarray:
        """m, on the grid of its terrain, 0 beside it."""
        depth = np.zeros(self.raster.z.shape)
        row, column = self.area.corner
        rows, columns = self.slip.shape
        depth[row:row + rows, column:column + columns] = np.nan_to_num(self.area.z - self.slip)
        return depth


def body_of(wanted: Wanted) -> Body:
    """The body; raises SlopeError on bad input."""
    wanted = check_wanted_release(wanted)
    raster, geometry = wanted.read or (read_terrain(wanted.terrain), None)
    doubts: List[Finding] = []
    if wanted.polygon and not wanted.read:
        crs = as_crs("--assign-crs", wanted.crs) if wanted.crs else None
        geometry = polygons.read_local(wanted.polygon, raster, local=wanted.local, crs=crs,
                                       advice=wanted.advice or polygons.OF_ASSIGN_CRS._replace(terrain=wanted.terrain),
                                       warn=doubts.append)
    several: List[features.Polygon] = []
    if wanted.polygon:
        check_pits(raster, geometry, wanted)
        several = polygons_in(wanted, raster, geometry)
    scar = scar_of(wanted, raster) if wanted.scar else None
    if scar:
        raster = scar.ground
    numbers, made = release_parts.numbered(raster, several), []
    if scar:
        area, surface, choices = from_scar(wanted, scar, geometry)
    elif wanted.shape in OF_EACH:
        area, surface, choices, made = from_each(wanted, raster, several, numbers)
        doubts += [*release_parts.own_depths(made, wanted.depth, wanted.where),
                   *release_parts.shared(several, made, wanted.volume, area.cell, wanted.where),
                   *release_parts.warnings(made, choices["shape"], wanted.where)]
    else:
        area, surface, choices = from_shape(wanted, raster, geometry)
    doubts += unused(wanted)
    slip = release_solve.slip_surface(area, release_solve.depths(area, surface), wanted.where)
    measures = release_solve.measures(area, slip)
    names = [one.name for one in several]
    depth, numbers = release_toe.depth_of(area, slip), release_parts.within(numbers, area)
    if scar:
        doubts += release_parts.empty(depth, numbers, names, wanted.where)
    else:
        doubts += release_parts.in_pits(depth, area.z, numbers, names)
    doubts += [*warnings(choices, measures, area, slip), *release_parts.in_parts(depth, area.cell, numbers, names)]
    return Body(raster, geometry, area, slip, choices, measures, doubts, made)


def polygons_in(wanted: Wanted, raster, geometry) -> List[features.Polygon]:
    """The polygons of a body, with what their features say."""
    if wanted.read:
        return features.distinct([features.Polygon("", one) for one in polygons.polygons_of(geometry)], raster)
    assert wanted.polygon
    sized = wanted.shape in OF_EACH and wanted.curvature is None
    return features.read_polygon_features(wanted.polygon, geometry, raster, wanted.local,
                                          as_crs("--assign-crs", wanted.crs) if wanted.crs else None, sized)


def unused(wanted: Wanted) -> List[Finding]:
    """That features say how deep they are, where that does not count."""
    if wanted.read or wanted.scar or not wanted.polygon or wanted.shape in OF_EACH and wanted.curvature is None:
        return []
    own = [one for one in features.own_depths(wanted.polygon) if one.depth != wanted.depth]
    by = f"--shape {wanted.shape}" if wanted.curvature is None else f"--curvature {wanted.curvature:g}"
    return [Finding("unused depth", {"file": wanted.where, "attribute": own[0].attribute, "by": by,
                                     "depths": features.list_depths(own)})] if own else []


def check_wanted_release(wanted: Wanted) -> Wanted:
    """Check what can be checked before any reading; the same, with the shape that is not named."""
    for name in ("depth", "volume"):
        value = getattr(wanted, name)
        if value is not None and not value > 0:
            raise SlopeError(wanted.called(name), "must be > 0", f"{value:g}")
    if wanted.least < 0:
        raise SlopeError("--least", "must be >= 0", f"{wanted.least:g}")
    if wanted.scar:
        for name in ("shape", "depth", "volume", "curvature", "dip", "foundation", "direction"):
            if getattr(wanted, name) is not None:
                raise SlopeError(f"--{name}", "must not be given with --scar, whose depths are not changed")
        return wanted
    for name, value, default in (("least", f"{wanted.least:g}", "0"), ("scar-is", wanted.scar_is, None)):
        if value != default:
            raise SlopeError(f"--{name}", "must be given with --scar only", value)
    if not wanted.polygon:
        raise SlopeError("--polygon", "must be given, unless --scar says where the body is")
    if wanted.shape is None:
        plane = wanted.dip != release_dip.LEAST and (wanted.dip, wanted.direction) != (None, None)
        wanted = wanted._replace(shape="plane" if plane else "slbl" if wanted.curvature is not None else "sphere")
    check_shape(wanted)
    return wanted


def check_shape(wanted: Wanted) -> None:
    """What goes with which shape."""
    if wanted.dip == release_dip.LEAST:
        check_least(wanted)
        return
    if wanted.foundation is not None:
        raise SlopeError(wanted.called("foundation"), f"must be given with --dip {release_dip.LEAST} only",
                         wanted.foundation if isinstance(wanted.foundation, str) else f"{wanted.foundation:g}")
    if wanted.shape == "plane":
        if wanted.dip is None:
            raise SlopeError("--dip", "must be given for a plane, degrees below the horizontal")
        if not 0 < float(wanted.dip) < 90:
            raise SlopeError("--dip", "must be > 0 and < 90 degrees", f"{wanted.dip:g}")
        if wanted.direction is not None and not 0 <= wanted.direction <= 360:
            raise SlopeError("--direction", "must be a compass bearing, 0 to 360 degrees", f"{wanted.direction:g}")
    elif wanted.dip is not None or wanted.direction is not None:
        raise SlopeError("--dip" if wanted.dip is not None else "--direction", "must be given for a plane only",
                         f"--shape {wanted.shape}")
    if wanted.curvature is not None and wanted.shape != "slbl":
        raise SlopeError("--curvature", "must be given for slbl only", f"--shape {wanted.shape}")
    if wanted.shape == "plane" or any(one is not None for one in (wanted.depth, wanted.volume, wanted.curvature)):
        return
    must, without = f"must be given for --shape {wanted.shape}, or --volume", None
    if wanted.shape in OF_EACH:
        each = {} if wanted.read else features.depths(str(wanted.polygon))
        if each and None not in each.values():
            return
        must += ", or --curvature" * (wanted.shape == "slbl") + \
            f", or an attribute {' or '.join(features.DEPTHS)} of each feature, m"
        without = f"none of {next(name for name, depth in each.items() if depth is None)}" if each else None
    elif not wanted.read and (own := features.own_depths(str(wanted.polygon))):
        must += f"; or --shape slab, which takes the attribute {own[0].attribute} of its features"
    raise SlopeError("--depth", must, without)


def check_least(wanted: Wanted) -> None:
    """What goes with the sphere that dips least, whose depth and volume follow."""
    if wanted.shape != "sphere":
        raise SlopeError(wanted.called("dip"), f"must be degrees for --shape {wanted.shape}: the sphere dips least",
                         wanted.dip)
    for name in ("depth", "volume", "curvature", "direction"):
        if (value := getattr(wanted, name)) is not None:
            raise SlopeError(wanted.called(name), f"must not be given with --dip {wanted.dip}, from which it follows",
                             f"{value:g}")


def read_terrain(path):
    """The ground; SlopeError if region terrain could not read it as it is."""
    raster = rasters.read_asc_local(path)
    t = raster.transform
    if Path(path).suffix != ".asc" or t.b or t.d or t.e >= 0 or abs(t.a + t.e) > 1e-9 * t.a:
        raise SlopeError(path, "must be an .asc with square cells, which region terrain reads: slope terrain makes it")
    return raster


def check_pits(raster, geometry, wanted: Wanted) -> None:
    """Raise SlopeError if the ground of a polygon has pits of a NODATA value that no file declares."""
    rows, columns = np.nonzero(release_area.nodes_inside(raster, geometry))
    if not len(rows):
        return
    rim = release_area.RIM
    part = tuple(slice(max(0, one.min() - rim), one.max() + rim + 1) for one in (rows, columns))
    ground = marks.in_metres(raster.z[part])
    pits = plausible.pits(raster.z[part], float(raster.transform.a), ground)
    if pits is None:
        return
    row, column = np.argwhere(pits.cells)[0] + [part[0].start, part[1].start]
    x, y = raster.transform @ (column + 0.5, row + 0.5)
    raise SlopeError(wanted.polygon, f"the ground in it must have no pits: {int(pits.cells.sum())} cells of "
                     f"{pits.shown} lie {pits.least:.4g} m or more {pits.side} all cells beside them; "
                     f"{plausible.suggest_pit_remedy(pits, ground)} (slope terrain, site, route)",
                     f"the first at east {x + raster.offset[0]:.1f} north {y + raster.offset[1]:.1f}")


def scar_of(wanted: Wanted, raster) -> release_scar.Scar:
    assert wanted.scar
    crs = as_crs(f"--assign-crs {wanted.scar}", wanted.scar_crs) if wanted.scar_crs else None
    return release_scar.read_scar(wanted.scar, wanted.scar_is, raster, wanted.least, crs)


def from_scar(wanted: Wanted, scar: release_scar.Scar, geometry):
    """Area, slip surface on its nodes and choices of a body that a raster gives."""
    raster, depth, inside, above = scar.ground, scar.depth, None, None
    if geometry is not None:
        inside = release_area.nodes_inside(raster, geometry)
        depth = np.where(inside, depth, 0.0)
        if not depth.any():
            raise SlopeError(wanted.polygon, f"must hold some of the scar in {wanted.scar}")
        if scar.above is not None:
            above = release_toe.above_ground(raster.z, raster.z - scar.above, inside, float(raster.transform.a))
    area = release_area.area_of(raster, depth > 0, wanted.where, wanted.terrain, SCAR_REMEDY)
    row, column = area.corner
    part = depth[row:row + area.z.shape[0], column:column + area.z.shape[1]]
    gaps = release_scar.is_unknown_inside(scar, inside)
    return area, area.z - part, {"shape": "scar", "scar": wanted.scar, "scar_is": scar.kind, "least": wanted.least,
                                 "beside_m": release_scar.off_beside(scar, inside), ABOVE: above and above._asdict(),
                                 "unknown_m2": float(gaps.sum()) * area.cell ** 2}


def from_shape(wanted: Wanted, raster, geometry):
    """The same of a body below a polygon."""
    area = release_area.area_of(raster, release_area.nodes_inside(raster, geometry), wanted.where, wanted.terrain)
    release_area.require_slope(area, wanted.where)
    parts = len(polygons.polygons_of(geometry))
    if parts > 1:
        raise SlopeError(wanted.polygon, f"must be one polygon for --shape {wanted.shape}; {' and '.join(OF_EACH)} "
                         "take several", parts)
    below = None
    if wanted.shape == "sphere":
        shape = release_bodies.sphere_shape(area, geometry, wanted.where)
    elif wanted.shape == "ellipsoid":
        shape = release_bodies.ellipsoid_shape(area, geometry, wanted.where)
    else:
        assert wanted.dip is not None       # check_wanted_release() has seen to it
        direction = release_bodies.bearing(area.downhill) if wanted.direction is None else wanted.direction
        shape = release_bodies.plane_shape(area, float(wanted.dip), direction)
    if wanted.dip == release_dip.LEAST:
        line = release_area.fall_line(area, geometry, wanted.where)
        crs = as_crs("--assign-crs", wanted.foundation_crs) if wanted.foundation_crs else None
        below = release_dip.foundation(wanted.foundation, raster, area, line, crs)
        free = release_dip.find_least_sagitta(area, line, below)
        depth = release_solve.depths(area, shape.surface(free))
    elif wanted.depth is not None:
        free, depth = release_solve.to_depth(area, shape, wanted.depth, wanted.called("depth"))
    elif wanted.volume is not None:
        free, depth = release_solve.to_volume(area, shape, wanted.volume, wanted.called("volume"))
    else:
        free = shape.most
        depth = release_solve.depths(area, shape.surface(free))
    choices = {"shape": shape.name, "given": given(wanted), shape.number: free, **shape.about}
    above = release_toe.above_ground(area.z, shape.surface(free), area.inside, area.cell)
    choices[ABOVE] = above and above._asdict()
    if below:
        choices.update(dip=wanted.dip, **release_dip.dips(area, area.z - depth, below))
    return area, area.z - depth, choices


def given(wanted: Wanted) -> Dict[str, Optional[float]]:
    """The numbers that were asked for."""
    return {"depth_m": wanted.depth, "volume_m3": wanted.volume, "curvature_per_m": wanted.curvature}


def from_each(wanted: Wanted, raster, several: List[features.Polygon], numbers: np.ndarray):
    """The same of bodies in several polygons, and what became of each."""
    assert wanted.shape
    area = release_area.area_of(raster, numbers > 0, wanted.where, wanted.terrain)
    size = release_parts.Size(wanted.depth, wanted.volume, wanted.curvature, wanted.called)
    depth, made = release_parts.depths(area, release_parts.within(numbers, area), several, wanted.shape, size,
                                       wanted.where)
    choices: Dict[str, Any] = {"shape": wanted.shape, "given": given(wanted)}
    if len(made) == 1 and wanted.shape == "slbl":
        choices.update(curvature_per_m=made[0].curvature, tolerance_m=made[0].curvature * area.cell ** 2 / 4)
    choices["polygons"] = [one.about(area.cell) for one in made]
    return area, area.z - depth, choices, made


def warnings(choices, body, area, slip) -> List[Finding]:
    """What makes the body doubtful."""
    doubts = []
    if choices.get("sagitta_m", 1) < 0:
        doubts.append(Finding("bulges", {"shape": choices["shape"]}))
    if choices["shape"] == "plane" and (steep := no_way_out(choices, area)) is not None:
        doubts.append(Finding("no way out", {"dip": choices["dip_degrees"], "direction": choices["direction_degrees"],
                                             "ground": steep}))
    if choices["shape"] == "scar":
        hollow = release_solve.hollow(area, slip)
        if hollow > HOLLOW * body.largest_depth:
            doubts.append(Finding("hollow", {"depth": hollow, "remedy": (
                "are these metres? Is it the mass on top of the terrain? Then --scar-is height"
                if choices["scar_is"] == "depth" else "a smaller body, or a survey without what came to rest there?")}))
        if choices["unknown_m2"]:
            doubts.append(Finding("unknown inside", {"area": choices["unknown_m2"], "file": choices["scar"]}))
    if level := release_toe.beyond_toe(area, slip):
        doubts.append(Finding("beyond toe", level._asdict()))
    if above := choices.get(ABOVE):
        doubts.append(Finding("above ground", {"area": above["area"], "height": above["depth"]}))
    if body.mean_slope > CLIFF:
        doubts.append(Finding("cliff", {"degrees": body.mean_slope, "in_feet": plausible.in_feet(body.mean_slope)}))
    if body.cells < COARSE:
        doubts.append(Finding("few cells", {"cells": body.cells, "cell": area.cell}))
    if body.wall > 0.5 * body.largest_depth and choices["shape"] != "slab":
        doubts.append(Finding("rim", {"depth": body.wall, "remedy": {
            "sphere": "a wider polygon, or --shape ellipsoid?",
            "scar": "does the raster, or the polygon, end in the middle of the scar?"}.get(
                choices["shape"], "is the polygon large enough?")}))
    if abs(shift := choices.get("beside_m") or 0.0) > SHIFT:
        doubts.append(Finding("shift", {"file": choices["scar"], "metres": abs(shift),
                                        "side": "below" if shift > 0 else "above"}))
    return doubts


def no_way_out(choices, area) -> Optional[float]:
    """Degrees by which the ground falls in the direction of a plane, if that dips more; else None."""
    bearing = math.radians(choices["direction_degrees"])
    fall = math.tan(math.radians(area.slope)) * float(area.downhill @ (math.sin(bearing), math.cos(bearing)))
    return math.degrees(math.atan(fall)) if math.tan(math.radians(choices["dip_degrees"])) > fall else None


def describe_body(body: Body) -> str:
    """What the user needs to know of the body before anything is written."""
    choices, measures, cell = body.choices, body.measures, body.area.cell
    shape = choices["shape"]
    if shape == "scar":
        what = f"scar of {choices['scar']} ({choices['scar_is']})"
        if choices["scar_is"] == "surface":
            what += "; vertical datums are not compared"
            if choices["beside_m"] is not None:
                what += f", beside the body the two surveys differ by {rounded(abs(choices['beside_m']), 2)} m (median)"
    elif shape == "plane":
        what = (f"plane that dips {choices['dip_degrees']:.4g} degrees towards {choices['direction_degrees']:.4g}, "
                f"{choices['drop_m']:.4g} m below the plane that touches the highest ground")
    elif shape in OF_EACH:
        what = "sloping local base level" if shape == "slbl" else "the ground lowered vertically"
        if "curvature_per_m" in choices:
            what += (f", curvature {choices['curvature_per_m']:.4g} /m (tolerance {choices['tolerance_m']:.4g} m for "
                     f"cells of {cell:g} m)")
        if len(body.made) > 1:
            what += f" in each of {len(body.made)} polygons\n{release_parts.describe_parts(body.made, cell)}"
    else:
        toe, shoulder = (" ".join(f"{value:.1f}" for value in choices[end]) for end in ("toe", "shoulder"))
        wide = f", {choices['width_m']:.4g} m wide" if shape == "ellipsoid" else ""
        sagitta = choices["sagitta_m"]
        what = (f"{shape} through toe {toe} and shoulder {shoulder}, {abs(sagitta):.4g} m "
                f"{'below' if sagitta > 0 else 'above'} its chord of {choices['chord_m']:.4g} m{wide}"
                f"{release_dip.describe_dip(choices) if 'dip_m' in choices else ''}")
    return (f"{what}\n"
            f"volume {rounded(measures.volume)} m3, largest depth {measures.largest_depth:.4g} m, mean depth "
            f"{measures.mean_depth:.4g} m, area {rounded(measures.area)} m2 ({measures.cells} cells of {cell:g} m)\n"
            f"mean slope {measures.mean_slope:.1f} degrees, of the slip surface {measures.slip_slope:.1f}, towards "
            f"{measures.bearing:.0f} degrees from north; ground at {measures.lowest:.1f} to {measures.highest:.1f} m")
