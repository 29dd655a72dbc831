"""What the runs of all bodies say of the road together: pieces, stretches, bodies; tables, rasters, layers."""
from pathlib import Path
from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Sequence

import numpy as np
from rasterio.features import shapes
from shapely.geometry import LineString, shape
from shapely.ops import unary_union

from .. import disk, provenance
from ..case import run_folders
from ..deposits.axis import SAME, Axis, Span, merged
from ..errors import SlopeError
from ..findings import Finding, encode_findings
from ..geometry import as_multi
from ..seismic import fragility_files
from ..survey import geopackage, rasters
from ..survey.geopackage import Layer
from ..tables import road_runs, usable
from ..tables.rows import Finished, Row, finished_of
from ..tables.study_file import load_study
from . import reached, runs, search
from .choices import Choices
from .corridor import Corridor
from .reached import Source
from .yearly import Yearly

RESULTS, MAP, LAYERS = "results.yaml", "governing.tif", "route.gpkg"
STRETCHES, BODIES, PIECES = "stretches.csv", "bodies.csv", "pieces.csv"
ALONG = f"{road_runs.BODIES}.csv"
FILES = (RESULTS, MAP, LAYERS, STRETCHES, BODIES, PIECES, ALONG)
NUMBERS = ("length", "passable_width", *road_runs.SUMS)


class BodyRuns(NamedTuple):
    """A body with its runs; rows: of those that failed, too."""
    about: Mapping[str, Any]
    runs: List[road_runs.Run]
    source: Source
    rows: List[Row]

    @property
    def number(self) -> int:
        return self.about["body"]

    @property
    def finished(self) -> List[Finished]:
        return finished_of(self.rows)

    def share(self, span: Optional[Span] = None) -> float:
        """Of the runs that block the road, or any of a range."""
        hit = [any(span is None or one["from"] < span.high - SAME and one["to"] > span.low + SAME
                   for one in run.stretches) for run in self.runs]
        return float(np.mean(hit))


def read_body(folder: Path, body: Mapping[str, Any]) -> BodyRuns:
    place = runs.folder_of(folder, body["body"])
    output = place / runs.STUDY
    # runs that `slope study bodies/N` added under a condition do not count as those of the sample
    rows = [row for row in load_study(output / "study.yaml").runs if not row.batch]
    done = finished_of(rows)
    prefixes = [run_folders.prefix_of(run_folders.summary_of(output, row.summary)) for row in done]
    source = Source(body["body"], prefixes, np.full(len(done), 1 / len(done)), len(rows) - len(done),
                    rasters.read_place(place / "terrain.asc").offset)
    return BodyRuns(body, [road_runs.Run(1.0, row.at_road.stretches, row.at_road.clearing) for row in done], source,
                    rows)


def yearly_of(choices: Choices, folder: Path, bodies: Sequence[Mapping[str, Any]]) -> Optional[Yearly]:
    """The fragilities of the bodies, None if none are given; SlopeError unless they are of these."""
    if choices.fragility is None:
        return None
    fragility = fragility_files.read_fragility(Path(choices.fragility))
    known = dict(zip(fragility.bodies, fragility.bases))
    for one in bodies:
        digest = disk.sha256(folder / search.SLIPS / str(one["body"]) / f"{search.PREFIX}.{one['body']}.base.asc")
        if known.get(str(one["body"])) != digest:
            raise SlopeError("--fragility", f"must be of the bodies of {folder}, as slope fragility {folder} makes it: "
                             f"body {one['body']} is not in it", choices.fragility)
    return Yearly(fragility)


def make_route_results(choices: Choices, corridor: Corridor, folder: Path, table: Mapping[str, Any]) -> Dict[str, Any]:
    """All results of a route, written to its folder; what results.yaml says."""
    yearly = yearly_of(choices, folder, table["bodies"])
    bodies = [read_body(folder, about) for about in table["bodies"]]
    spans = merged([Span(one["from"], one["to"]) for body in bodies for run in body.runs for one in run.stretches],
                   SAME)
    results: Dict[str, Any] = {
        "collected": provenance.now(), "chainage_m": [corridor.start, corridor.start + corridor.axis.length],
        "blocked_above_m": choices.blocked, "fragility": choices.fragility and Path(choices.fragility).name,
        "route": route(bodies, yearly), "pieces": pieces(bodies, yearly),
        "along": road_runs.by_body({one.number: [(1.0, row.at_road.by_10_m) for row in one.finished]
                                    for one in bodies}),
        "stretches": [stretch(number, span, bodies, yearly) for number, span in enumerate(spans, 1)],
        "bodies": [make_body_row(one, yearly) for one in bodies], "left_out": table["left_out"],
        "doubts": encode_findings(find_doubts(bodies)),
        "fragility_warnings": yearly.warnings if yearly else []}
    hits = reached.combine_reached([one.source for one in bodies], corridor.raster, "max_thickness", choices.blocked)
    with disk.complete(folder, RESULTS) as new:
        disk.write_file(new / PIECES, disk.csv_text(("from_m", "to_m", "share", "body", *YEAR), (
            (one["from"], one["to"], one["share"], one["body"], *year(one)) for one in results["pieces"])))
        quantiles = [f"{name}_{100 * share:g}" for name in NUMBERS for share in road_runs.SHARES]
        disk.write_file(new / STRETCHES, disk.csv_text(
            ("stretch", "from_m", "to_m", *YEAR, "body", "factor", "share", *quantiles, "no_factor"),
            ((one["stretch"], one["from"], one["to"], *year(one), by["body"], by["factor"], by["share"],
              *(value for name in NUMBERS for value in by.get(name, [None] * len(road_runs.SHARES))), by["no_factor"])
             for one in results["stretches"] for by in one["bodies"])))
        disk.write_file(new / ALONG, road_runs.table_of_bodies(results["along"]))
        heads = [name for name in results["bodies"][0] if name != "per_year"]
        disk.write_file(new / BODIES, disk.csv_text([*heads, "fails_per_year", "blocks_per_year"], (
            [*(one[name] for name in heads), *((one["per_year"] or {}).get(key) for key in ("fails", "blocks"))]
            for one in results["bodies"])))
        of_sets = [governs(one, bodies, yearly) for one in hits.sets]
        rasters.write_geotiff(new / MAP, {name: np.array(values, float)[hits.codes] for name, values in zip(
            ("governing body", "share of its runs", "bodies that reach the cell", "times per year"), zip(*of_sets))},
            corridor.raster)
        write_layers(new / LAYERS, corridor, folder, results, hits, of_sets)
        disk.write_yaml(new / RESULTS, results, "slope route: m, m3 of ground (bulk), hours, per year")
    return results


def find_doubts(several: Sequence[BodyRuns]) -> List[Finding]:
    """Why more of the road may be blocked, or more often, than runs say: of each kind that of the gravest body."""
    kinds: Dict[str, List[Finding]] = {}
    for body in several:
        for doubt in usable.doubts_of_shares(body.rows):
            kinds.setdefault(doubt.kind, []).append(doubt._replace(part=f"body {body.number}"))
    return [gravest(same, "number") for same in kinds.values()]


def gravest(same: Sequence[Finding], number: str) -> Finding:
    """That of the gravest body by one of its numbers, which says how many others there are."""
    worst = max(same, key=lambda doubt: doubt.numbers[number])
    return worst._replace(part=worst.part + f", as {len(same) - 1} more" * (len(same) > 1))


YEAR = ("per_year", "independent", "dependent", "low", "high")


def year(row: Mapping[str, Any]) -> List[Optional[float]]:
    """The columns YEAR."""
    found = row["per_year"] or {}
    return [found.get(name) for name in ("counts", *YEAR[1:])]


def route(bodies: Sequence[BodyRuns], yearly: Optional[Yearly]) -> Dict[str, Any]:
    """How likely any of the road is blocked."""
    return reached.combined([one.source for one in bodies], [one.share() for one in bodies],
                            yearly)._asdict()


def pieces(bodies: Sequence[BodyRuns], yearly: Optional[Yearly]) -> List[Dict[str, Any]]:
    """Ranges of chainages in which the bodies' shares are the same, where any body blocks the road."""
    ranges = np.array([(one["from"], one["to"], k) for k, body in enumerate(bodies) for run in body.runs
                       for one in run.stretches]).reshape(-1, 3)
    ends = np.unique(ranges[:, :2])
    stretches: List[Dict[str, Any]] = []
    for low, high in zip(ends[:-1].tolist(), ends[1:].tolist()):
        middle = (low + high) / 2
        here = [bodies[k] for k in np.unique(ranges[(ranges[:, 0] < middle) & (ranges[:, 1] > middle), 2]).astype(int)]
        if high - low > SAME and here:
            one = reached.combined([body.source for body in here], [body.share(Span(low, high)) for body in here],
                                   yearly)
            stretches.append({"from": low, "to": high, **one._asdict()})
    return stretches


def stretch(number: int, span: Span, bodies: Sequence[BodyRuns], yearly: Optional[Yearly]) -> Dict[str, Any]:
    """A stretch of the road and what each body does there: quantiles of its runs, road_runs.SHARES."""
    here = [body for body in bodies if body.share(span) > 0]
    each = []
    for body in here:
        weights = np.full(len(body.runs), 1 / len(body.runs))
        numbers = road_runs.stretch(span, body.runs, weights)
        low, high = body.source.bounds(numbers["share"])
        each.append({"body": body.number, "factor": body.about["factor"], "no_factor": body.about.get("no_factor", ""),
                     "share_low": low, "share_high": high,
                     **{name: numbers[name] for name in ("share", *NUMBERS) if name in numbers}})
    return {"stretch": number, "from": span.low, "to": span.high,
            **reached.combined([one.source for one in here], [one["share"] for one in each], yearly)._asdict(),
            "bodies": each}


def make_body_row(body_runs: BodyRuns, yearly: Optional[Yearly]) -> Dict[str, Any]:
    """A row of the table by body."""
    share = body_runs.share()
    low, high = body_runs.source.bounds(share)
    on_road = np.array([row.at_road.remove_on_road_m3 for row in body_runs.finished])
    per_year = yearly and {"fails": yearly.of([body_runs.number], [1.0]).counts,
                           "blocks": yearly.of([body_runs.number], [share]).counts}
    keys = ("body", "name", "chainage_m", "x", "y", "factor", "volume_m3", "area_m2", "depth_m", "known_share",
            "known_law")
    return {**{key: body_runs.about[key] for key in keys}, "runs": len(body_runs.runs),
            "balls": min(round(row.released_m3 / row.ball_m3) for row in body_runs.finished),
            "failed": body_runs.source.failed,
            "left_share": max(usable.left_before(row) / row.released_m3 for row in body_runs.finished),
            "share_blocked": share, "share_low": low, "share_high": high,
            "on_road_median_m3": float(np.median(on_road)), "on_road_most_m3": float(on_road.max()),
            "no_factor": body_runs.about.get("no_factor", ""), "per_year": per_year}


# --- who hits what ---

def governs(row, bodies: Sequence[BodyRuns], yearly: Optional[Yearly]):
    """Governing body, its share, how many bodies reach the cells of a set, how often per year; NaN where none does."""
    found = reached.of_set(row, [body.source for body in bodies], yearly)
    if found is None:
        return np.nan, np.nan, np.nan, np.nan
    return found.body, found.share, len(row), (found.per_year or {}).get("counts", np.nan)


def write_layers(path: Path, corridor: Corridor, folder: Path, results: Mapping[str, Any], hits, of_sets) -> None:
    """Road, bodies and hits as layers of a GeoPackage, in the CRS of the terrain."""
    axis = Axis(np.asarray(corridor.axis.coords), corridor.start)

    def line(row) -> LineString:
        return axis.line(Span(max(row["from"], axis.s[0]), min(row["to"], axis.s[-1])))
    road = {"from_m": "float", "to_m": "float", "share": "float", "body": "int", "per_year": "float"}

    def values(row):
        return {"from_m": row["from"], "to_m": row["to"], "share": row["share"], "body": row["body"],
                "per_year": year(row)[0]}
    of_hits = {"body": "int", "share": "float", "bodies": "int", "per_year": "float", "shares": "str"}

    def hit():
        for polygon, code in shapes(hits.codes, hits.codes > 0, connectivity=4, transform=corridor.raster.transform):
            body, share, number, per_year = of_sets[int(code)]
            yield shape(polygon), {"body": body, "share": share, "bodies": number,
                                   "per_year": None if np.isnan(per_year) else per_year, "shares": " ".join(
                                       f"{name}:{part:g}" for name, part in hits.sets[int(code)])}

    def bodies():
        for row in (*results["bodies"], *results["left_out"]):
            place = folder / search.SLIPS / str(row["body"])
            base = rasters.read_asc_local(place / f"{search.PREFIX}.{row['body']}.base.asc")
            mask = base.z < rasters.read_asc_local(place / "terrain.asc").z
            area = [shape(part) for part, _ in shapes(mask.astype(np.uint8), mask, transform=base.transform)]
            yield as_multi(unary_union(area)), {
                "body": row["body"], "name": row["name"], "factor": row["factor"], "volume_m3": row["volume_m3"],
                "why_not": row.get("why_not", ""), "share": row.get("share_blocked"),
                "no_factor": row.get("no_factor", "")}
    geopackage.write_geopackage(path, {
        "road": Layer("LineString", road, ((line(one), values(one)) for one in results["pieces"])),
        "stretches": Layer("LineString", {"stretch": "int", **road}, (
            (line(one), {"stretch": one["stretch"], **values(one)}) for one in results["stretches"])),
        "bodies": Layer("MultiPolygon", {"body": "int", "name": "str", "factor": "float", "volume_m3": "float",
                                         "why_not": "str", "share": "float", "no_factor": "str"}, bodies()),
        road_runs.BODIES: road_runs.layer_of_bodies(results["along"], [axis]),
        "hits": Layer("Polygon", of_hits, hit())}, corridor.raster)
