"""slope stability: the slip surfaces with the least factor of safety below a terrain."""
import argparse
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Dict, List, NamedTuple, Optional, Sequence, Tuple

from .. import disk, findings
from ..case import slip_deck
from ..case.slip_deck import PREFIX
from ..errors import SlopeError
from ..options import Overwrite, Program, flag, parse_number, option, positional, several
from ..programs import find_lmp

# options without a meaning for --failed; of the cohesion, between the axis of the nearest sphere and a far one
SEARCH = ("cohesion", "friction", "layer", "volume", "depth", "within", "method", "shape", "keep", "np", "lmp")
APART = 0.1
ALONE = 0.1        # of the cells, without a neighbour in the body on one axis

DESCRIPTION = "The slip surfaces with the least factor of safety below a terrain."
EPILOG = """\
units: Pa, degrees, kg/m3; m and m3; directions are compass bearings.

examples:
  tools/slope stability terrain.asc --cohesion 3e3 --friction 19.6 --density 2039 --volume 500 5000 -o slips
  tools/slope stability terrain.asc --cohesion 1e4 --friction 30 --density 1900 --water 0.2 --seismic 0.2 \\
      --within slope.geojson --keep 5 -o slips
  tools/slope stability terrain.asc --cohesion 5e3 --friction 28 --density 1800 --layer rock.asc 2e5 40 2500 \\
      --water-table water.asc -o slips
  tools/slope stability terrain.asc --cohesion 5e3 --friction 28 --density 1800 --bedrock rock.asc -o slips
  tools/slope stability terrain.asc --failed 25.75,33.25,49,36.63 --density 1919 --seismic 0.3 -o back

Writes body.slips.csv and body.N.base.asc, which `slope fragility` reads, body.factor.asc, stability.csv,
stability.yaml, stability.png, and the deck in.slips with its log. With --failed: back.csv, back.yaml, back.png.
"""
HUGE = 100.0        # factor of safety that no slope has
FAINT = 100.0       # Pa
LIGHT = 500.0       # kg/m3
FILES = ["stability.csv", "stability.png", "stability.yaml"]


@dataclass(frozen=True, kw_only=True)
class Soil:
    """The ground."""
    GROUP = "ground"
    cohesion: Optional[float] = option("Pa; must be given without --failed", metavar="C")
    friction: Optional[float] = option("friction angle, degrees; must be given without --failed", metavar="PHI")
    density: float = option("kg/m3", metavar="R")
    layer: List[List[str]] = several(
        "below the heights in this raster another strength begins; may be given several times, from above",
        metavar=("RASTER", "C", "PHI", "R"), nargs=4)
    water: Optional[float] = option(
        "pore pressure over the weight per area, 0 to below 1 (default: dry)", metavar="RU", one_of="water")
    water_table: Optional[Path] = option("heights of the water table", metavar="RASTER", one_of="water")
    bedrock: Optional[Path] = option("no body goes below the heights in this raster", metavar="RASTER")
    seismic: Optional[List[float]] = option(
        "KH [KV]: horizontal inertia in the direction of sliding, and vertical one upwards, in parts of the weight",
        metavar="K", nargs="+")


@dataclass(frozen=True, kw_only=True)
class Search:
    """Which bodies are looked for, and how."""
    GROUP = "search"
    volume: Optional[List[float]] = option("limits of a body's volume, m3", metavar=("LO", "HI"), nargs=2)
    depth: Optional[List[float]] = option("limits of its greatest depth, m", metavar=("LO", "HI"), nargs=2)
    within: Optional[str] = option("the bodies lie in this polygon: GeoJSON, shapefile, CSV or WKT", metavar="P")
    local: bool = flag("the polygon, and rasters with neither sidecar nor CRS, are in the terrain's local metres")
    direction: Optional[float] = option(
        "compass bearing of sliding, degrees (default: where the weight drives most)", metavar="B")
    shape: Optional[str] = option(
        "ellipsoid: the width across the direction of sliding is free, too (default: sphere)",
        choices=("sphere", "ellipsoid"))
    method: Optional[str] = option("default: bishop", choices=("bishop", "ordinary", "spencer"))
    keep: Optional[int] = option("bodies that differ (default 3)", metavar="N")


@dataclass(frozen=True, kw_only=True)
class Request(Soil, Search, Program, Overwrite):
    terrain: Path = positional("the ground, as slope terrain wrote it", metavar="TERRAIN.asc")
    failed: Optional[str] = option(
        "no search: the strengths with which this body has F = 1, a sphere X,Y,Z,R (m), what find_slip wrote, or a "
        "raster of the ground without the body", metavar="BODY")
    np: Optional[int] = option("MPI ranks (default 1)", metavar="N")
    output: Path = option("folder for the results", "-o", metavar="DIR")


def run_stability(args: Request) -> None:
    """Do the command; raises SlopeError on bad input. Prints the bodies."""
    if args.failed is not None:
        run_failed(args)
        return
    from ..runs import slip_run         # numpy, rasterio
    from ..slips import bodies, doubts
    from ..survey import polygons, rasters

    asked = make_slip_request(args)
    lmp = find_lmp(args.lmp)
    disk.check_folder(args.output, FILES, [args.terrain], args.overwrite)
    raster = rasters.read_asc_local(args.terrain)
    polygon = polygons.read_local(args.within, raster, args.local) if args.within else None
    warn, kept = findings.warner("stability")
    placed: List[findings.Finding] = []
    given = rasters_of(args, raster, placed.append)
    with disk.complete(args.output, FILES[-1]) as folder:
        for beside in given:
            rasters.write_asc_local(folder / beside.name, raster._replace(z=beside.z), {"sources": [beside.source]},
                                    exact=True)
        output = slip_run.run_slip_search(asked, polygon, raster, folder, lmp, args.np or 1,
                                          lambda line: print(line, flush=True))
        rows = bodies.read_body_rows(folder / f"{PREFIX}.slips.csv", (*bodies.NUMBERS, "factor", "area", "depth"),
                                     ("yield",))
        if rows[0]["factor"] > HUGE:
            raise SlopeError(args.terrain, "must be steep enough, and the strengths in Pa, for a factor of safety "
                             f"below {HUGE:g} somewhere", f"{rows[0]['factor']:.4g}")
        masks = [bodies.mask_of(folder / f"{PREFIX}.{k + 1}.base.asc") for k in range(len(rows))]
        rock = next((one.z for one in given if one.name == slip_deck.BEDROCK), None)
        allowed = polygon and doubts.cells_in(raster, polygon)
        for finding in [*placed, *find_stability_warnings(asked.strength.cohesion, args.density, rows, masks, given),
                        *output.warnings, *(one for row, mask in zip(rows, masks) for one in doubts.find_body_doubts(
                            raster, row, mask, asked.volume, asked.depth, allowed))]:
            warn(finding)
        table = [numbers_of(raster, row, mask) for row, mask in zip(rows, masks)]
        write_stability(folder, args, raster, rows, masks, rock, {"method": asked.method, "shape": asked.shape,
                                                                  "keep": asked.keep, "bodies": table,
                                                                  "warnings": kept})
        slip_run.settle(asked, raster, folder, len(rows), args.output)
    slip_run.remove_others(args.output, len(rows), [one.name for one in given])
    print(describe_stability(table, args.output, output.notes))


class Given(NamedTuple):
    """A raster beside the terrain."""
    kind: str           # of the finding where it has no value
    name: str           # of the file beside the deck
    source: str
    z: Any              # heights in the cells of the terrain, NaN where it has none


def rasters_of(args: Request, raster, warn) -> List[Given]:
    """The rasters that the options name, on the cells of the terrain: find_slip takes coordinates as they are."""
    from ..survey import beside

    named = [("water table", slip_deck.TABLE, args.water_table), ("bedrock", slip_deck.BEDROCK, args.bedrock),
             *(("layer", slip_deck.LAYER.format(k), layer[0]) for k, layer in enumerate(args.layer, 1))]
    return [Given(kind, name, str(path), beside.heights_on(path, raster, args.local, warn))
            for kind, name, path in named if path is not None]


def find_stability_warnings(cohesion: float, density: float, rows, masks, given: Sequence[Given]):
    """What a reader must know of the input."""
    import numpy as np

    if 0 < cohesion < FAINT:
        yield findings.Finding("in kPa", {"value": cohesion})
    if density < LIGHT:
        yield findings.Finding("in kN", {"value": density})
    for row, mask in zip(rows, masks):
        for one in given:
            share = np.isnan(one.z[mask]).mean()
            if share > 0:
                yield findings.Finding(one.kind, {"body": int(row["rank"]), "percent": 100 * float(share),
                                                  "file": one.source})


def make_slip_request(args: Request) -> slip_deck.Asked:
    """What the options ask for; find_slip checks the numbers, this what has no number there."""
    if args.cohesion is None or args.friction is None:
        raise SlopeError("--cohesion" if args.cohesion is None else "--friction",
                         "must be given, or --failed a body that failed")
    for path in (args.terrain, args.water_table, args.bedrock, *(layer[0] for layer in args.layer)):
        if path is not None and not Path(path).is_file():
            raise SlopeError(path, "must be an existing file")
    shaking = args.seismic or [0.0]
    if len(shaking) > 2:
        raise SlopeError("--seismic", "must be KH, or KH KV", " ".join(f"{one:g}" for one in shaking))
    layers = tuple(slip_deck.Layer(slip_deck.LAYER.format(k), slip_deck.Strength(*(parsed(word) for word in words)))
                   for k, (_, *words) in enumerate(args.layer, 1))
    return slip_deck.Asked(
        args.terrain, slip_deck.Strength(args.cohesion, args.friction, args.density), layers, args.water,
        slip_deck.TABLE if args.water_table else None, (shaking[0], shaking[-1] if len(shaking) > 1 else 0.0),
        bool(args.within),
        parse_limits(args.volume), parse_limits(args.depth), None if args.direction is None
        else (90.0 - args.direction) % 360.0, args.method or "bishop", args.keep or 3, args.shape or "sphere",
        slip_deck.BEDROCK if args.bedrock else None)


def parse_limits(limits) -> Optional[Tuple[float, float]]:
    """LO and HI of an option, if it is given."""
    return (limits[0], limits[1]) if limits else None


def parsed(word):
    """A number of --layer."""
    try:
        return parse_number(word)
    except argparse.ArgumentTypeError as error:
        raise SlopeError("--layer", str(error)) from None


def numbers_of(raster, row: Dict[str, float], mask) -> Dict[str, float]:
    """A line of the table."""
    from ..slips import doubts

    return {"body": int(row["rank"]), **{name: row[name] for name in ("factor", "yield", "volume", "area", "depth")},
            "bearing": (90.0 - row["direction"]) % 360.0, "length": doubts.length(raster, mask, row["direction"]),
            "cells": int(mask.sum()), **{name: row[name] for name in ("x", "y", "z", "radius", "across")}}


def write_stability(folder: Path, args: Request, raster, rows, masks, rock, table) -> None:
    """stability.csv, .png and .yaml; rock: heights of the bedrock in the cells of the terrain, or None."""
    from ..slips import chart
    from ..survey import rasters

    disk.write_file(folder / FILES[0], disk.csv_text(table["bodies"][0], (
        [f"{value:.8g}" for value in row.values()] for row in table["bodies"])))
    factor = rasters.read_raster(folder / f"{PREFIX}.factor.asc", heights=False).z
    title = f"c {args.cohesion:g} Pa, friction {args.friction:g} degrees" + (
        f", k {args.seismic[0]:g}" if args.seismic else "")
    chart.draw_slips(folder / FILES[1], raster, factor, rows, masks, title, rock)
    about = {name: getattr(args, name) for name in ("terrain", "cohesion", "friction", "density", "layer", "water",
                                                    "water_table", "bedrock", "seismic", "volume", "depth",
                                                    "within", "local", "direction")}
    disk.write_yaml(folder / FILES[2], {**about, **table}, "slope stability: Pa, degrees, kg/m3, m, m3; bearings")


def describe_stability(table, folder, notes) -> str:
    """What the user needs to know."""
    lines = [*notes, "body  factor   yield    volume m3    area m2  depth m  bearing  length m"]
    for row in table:
        lines.append(f"{row['body']:4d}  {row['factor']:6.3f}  {row['yield']:6.3f}  {row['volume']:11.5g}  "
                     f"{row['area']:9.5g}  {row['depth']:7.3g}  {row['bearing']:7.1f}  {row['length']:8.4g}")
    return "\n".join([*lines, f"written to {folder}: {' '.join(FILES)} {PREFIX}.slips.csv and rasters"])


def run_failed(args: Any) -> None:
    """--failed: on which strengths a body that failed has F = 1. Prints points of the line."""
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
    body = failed.read_failed_body(args.failed, raster, way, args.density, table, rock)
    if args.water is not None:
        body = body._replace(columns=body.columns._replace(pressure=None))
    line = back.line(body.columns, horizontal, vertical, ratio)
    far = back.line(body.far, horizontal, vertical, ratio) if body.far else None
    for one in failed_warnings(body, line, far):
        warn(one)
    summary = {"terrain": args.terrain, "failed": args.failed, "density": args.density, "seismic": shaking,
               "water": args.water, "water_table": args.water_table,
               "bedrock": args.bedrock, "volume": body.columns.volume,
               "cells": body.cells, "bearing": (90.0 - body.direction) % 360.0, "centre": body.centre,
               "radius": body.radius, "cohesion_without_friction": line.cohesion[0],
               "friction_without_cohesion": line.friction[-1] if line.cohesion[-1] < 1e-6 * line.cohesion[0] else None,
               "warnings": kept}
    back_files.write_back_analysis(args.output, line, far, summary)
    print(back_files.describe_back_analysis(line, summary))
    print(f"written to {args.output}: {' '.join(back_files.FILES)}")


def inertia(given: Sequence[float]) -> Tuple[float, float]:
    """KH and KV of --seismic."""
    if len(given) > 2 or given[0] < 0 or not abs(given[-1]) < 1:
        raise SlopeError("--seismic", "must be KH >= 0, or KH KV with KV above -1 and below 1",
                         " ".join(f"{one:g}" for one in given))
    return given[0], given[1] if len(given) > 1 else 0.0


def failed_warnings(body, line, far):
    """What a reader must know."""
    from ..slips.columns import FEWEST

    if body.cells < FEWEST:
        yield findings.Finding("few columns", {"cells": body.cells, "limit": FEWEST})
    if body.alone > ALONE * body.cells:
        yield findings.Finding("narrow", {"alone": body.alone, "cells": body.cells})
    if far is not None:
        change = far.cohesion[0] / line.cohesion[0] - 1
        if abs(change) > APART:
            yield findings.Finding("no sphere", {"percent": 100 * float(change)})
