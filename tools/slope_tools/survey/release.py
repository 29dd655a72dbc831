"""The body that is released, below a polygon or from a scar."""
from pathlib import Path

import numpy as np

from ..errors import SlopeError
from . import polygons, rasters, release_area, release_bodies, release_scar, release_solve


def read_terrain(path):
    """The ground; SlopeError if region terrain could not read it as it is."""
    raster = rasters.read_asc_local(path)
    t = raster.transform
    if Path(path).suffix != ".asc" or t.b or t.d or t.e >= 0 or abs(t.a + t.e) > 1e-9 * t.a:
        raise SlopeError(path, "must be an .asc with square cells, which region terrain reads: slope terrain makes it")
    return raster


def from_scar(args, raster, geometry):
    """Area, slip surface on its nodes and choices of a body that a raster gives."""
    depth = release_scar.depths(args.scar, args.scar_is, raster, args.least)
    if geometry is not None:
        depth = np.where(release_area.nodes_inside(raster, geometry), depth, 0.0)
        if not depth.any():
            raise SlopeError(args.polygon, f"must hold some of the scar in {args.scar}")
    area = release_area.area_of(raster, depth > 0, args.polygon or args.scar, args.terrain)
    row, column = area.corner
    part = depth[row:row + area.z.shape[0], column:column + area.z.shape[1]]
    return area, area.z - part, {"shape": "scar", "scar": args.scar, "scar_is": args.scar_is, "least": args.least}


def from_shape(args, raster, geometry):
    """The same of a body below a polygon."""
    area = release_area.area_of(raster, release_area.nodes_inside(raster, geometry), args.polygon, args.terrain)
    release_area.require_slope(area, args.polygon)
    parts = len(polygons.polygons_of(geometry))
    if args.shape != "slbl" and parts > 1:
        raise SlopeError(args.polygon, f"must be one polygon for --shape {args.shape}; slbl takes several", parts)
    if args.shape == "sphere":
        shape = release_bodies.sphere_shape(area, geometry, args.polygon)
    elif args.shape == "ellipsoid":
        shape = release_bodies.ellipsoid_shape(area, geometry, args.polygon)
    elif args.shape == "plane":
        direction = release_bodies.bearing(area.downhill) if args.direction is None else args.direction
        shape = release_bodies.plane_shape(area, args.dip, direction)
    else:
        shape = release_bodies.slbl_shape(area)
    if args.depth is not None:
        free = release_solve.to_depth(area, shape, args.depth)
    elif args.volume is not None:
        free = release_solve.to_volume(area, shape, args.volume)
    else:
        free = shape.most if args.shape == "plane" else args.curvature
    choices = {"shape": shape.name, "given": {"depth_m": args.depth, "volume_m3": args.volume,
                                              "curvature_per_m": args.curvature},
               shape.number: free, **shape.about}
    if args.shape == "slbl":
        choices["tolerance_m"] = free * area.cell ** 2 / 4
    return area, shape.surface(free), choices
