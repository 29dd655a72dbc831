"""slope stability --failed: on which strengths a body that failed has F = 1."""
from typing import Any, Sequence, Tuple

from .. import disk, findings
from ..errors import SlopeError

SEARCH = ("cohesion", "friction", "layer", "volume", "depth", "within", "method", "shape", "keep", "np", "lmp")
APART = 0.1         # of the cohesion, between the axis of the nearest sphere and a far one


def run(args: Any) -> None:
    """Do it, a stability.Request; raises SlopeError on bad input. Prints points of the line."""
    from ..slips import back, back_files, failed
    from ..survey import beside, rasters

    for name in SEARCH:
        if getattr(args, name):
            raise SlopeError(f"--{name}", "must not be given with --failed, which searches no surface")
    horizontal, vertical = shaking = inertia(args.seismic or [0.0])
    ratio = args.water or 0.0
    if not args.density > 0:
        raise SlopeError("--density", "must be > 0 kg/m3", f"{args.density:g}")
    if not 0 <= ratio < 1:
        raise SlopeError("--water", "must be 0 to below 1", f"{ratio:g}")
    disk.check_folder(args.output, back_files.FILES, [args.terrain, args.failed], args.overwrite)
    raster = rasters.read_asc_local(args.terrain)
    warn, kept = findings.warner("stability")
    table, rock = (path and beside.heights_on(path, raster, args.local, warn)
                   for path in (args.water_table, args.bedrock))
    way = None if args.direction is None else (90.0 - args.direction) % 360.0
    body = failed.read(args.failed, raster, way, args.density, table, rock)
    if args.water is not None:
        body = body._replace(columns=body.columns._replace(pressure=None))
    line = back.line(body.columns, horizontal, vertical, ratio)
    far = back.line(body.far, horizontal, vertical, ratio) if body.far else None
    for one in warnings_of(body, line, far):
        warn(one)
    about = {"terrain": args.terrain, "failed": args.failed, "density": args.density, "seismic": shaking,
             "water": args.water, "water_table": args.water_table,
             "bedrock": args.bedrock, "volume": body.columns.volume,
             "cells": body.cells, "bearing": (90.0 - body.direction) % 360.0, "centre": body.centre,
             "radius": body.radius, "cohesion_without_friction": line.cohesion[0],
             "friction_without_cohesion": line.friction[-1] if line.cohesion[-1] < 1e-6 * line.cohesion[0] else None,
             "warnings": kept}
    back_files.write(args.output, line, far, about)
    print(back_files.summary(line, about))
    print(f"written to {args.output}: {' '.join(back_files.FILES)}")


def inertia(given: Sequence[float]) -> Tuple[float, float]:
    """KH and KV of --seismic."""
    if len(given) > 2 or given[0] < 0 or not abs(given[-1]) < 1:
        raise SlopeError("--seismic", "must be KH >= 0, or KH KV with KV above -1 and below 1",
                         " ".join(f"{one:g}" for one in given))
    return given[0], given[1] if len(given) > 1 else 0.0


def warnings_of(body, line, far):
    """What a reader must know."""
    from ..slips.columns import FEWEST

    if body.cells < FEWEST:
        yield findings.Finding("few columns", {"cells": body.cells, "limit": FEWEST})
    if far is not None:
        change = far.cohesion[0] / line.cohesion[0] - 1
        if abs(change) > APART:
            yield findings.Finding("no sphere", {"percent": 100 * float(change)})
