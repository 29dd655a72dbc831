"""The report on a route: the corridor with its road in the colours of the chance, and tables by stretch and by body."""
import math
from pathlib import Path
from typing import Any, Iterator, List, Mapping

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.colors import LogNorm, Normalize
from shapely.ops import substring

from .. import digits, disk, provenance
from ..deposits.axis import Axis, Span
from ..drawing import figures, maps, palettes, pictures
from ..findings import finding
from ..report import document, road_part
from ..report.sections import Figures, Picture, Section, Table
from ..statistics import hazard
from ..survey.rasters import crs_name
from ..tables import sizes
from .choices import Choices
from .corridor import Corridor

PAGE = "route.html"
ALONG = 4000.0      # m of the road in a map
KM = "{:.3f}"
LEAST = 1e-6        # per year: the lower end of the colours
OPEN = "before the curve", "beyond the curve"       # of a fragility: bodies fail more often


def km(metres: float) -> str:
    return KM.format(metres / 1000)


def sentences(results: Mapping[str, Any]) -> List[str]:
    """The answer."""
    route, stretches = results["route"], results["stretches"]
    blocked, least = sum(one["to"] - one["from"] for one in stretches), "at least " * bool(results["doubts"])
    rate = "at least " * (bool(least) or any(finding(one).kind in OPEN for one in results["fragility_warnings"]))
    text = (f"{len(results['bodies'])} bodies can reach the road; their runs block {len(stretches)} stretches of it, "
            f"{least}{blocked:,.0f} m in all")
    size = f"bodies are computed with {min(one['balls'] for one in results['bodies']):,} balls or more{sizes.UNKNOWN}"
    if route["per_year"] is None:
        return [text, "the largest chance that a body which fails blocks the road is "
                f"{least}{100 * route['share']:.0f} % (body {route['body']}); how often they fail is not known "
                "(--fragility)", size]
    one = route["per_year"]
    return [text, f"the route is blocked {rate}{one['counts']:.2g} times per year: {one['independent']:.2g} if the "
            f"bodies are independent, {one['dependent']:.2g} if all have the strength of one sample; the larger "
            f"counts; bounds of the runs (90 %), for any dependence: {one['low']:.2g} to {one['high']:.2g}", size]


def write_route_page(choices: Choices, corridor: Corridor, folder: Path, results: Mapping[str, Any], warn) -> None:
    """Write route.html."""
    yearly = choices.fragility is not None
    content = {
        "title": choices.name or folder.absolute().name, "client": choices.client, "author": choices.author,
        "made": provenance.now(), "mark": document.mark(folder), "how": how(choices),
        "sentences": [f"{text[0].upper()}{text[1:]}." for text in sentences(results)],
        "warnings": list(list_route_caveats(choices, results)), "maps": list(draw_route_maps(corridor, results,
                                                                                             yearly)),
        "sections": [*([make_along_section(results)] if len(results["bodies"]) > 1 else []),
                     make_stretches_section(results, yearly), bodies(results, yearly), left_out(results)],
        "footer": f"{document.MADE_BY.replace('report', 'route')}, SLOPE {provenance.version()}; all numbers: "
                  "results.yaml, stretches.csv, bodies.csv, pieces.csv; who hits what: governing.tif, route.gpkg"}
    for line in content["warnings"]:
        warn(line)
    disk.write_file(folder / PAGE, document.render(content, Path(__file__).with_name("route.html.j2")))


def how(choices: Choices) -> str:
    where = f"the polygons of {Path(choices.bodies).name}" if choices.bodies else (
        f"those that a search found within {choices.corridor:g} m of the road with a factor of safety below "
        f"{choices.below:g}, for a cohesion of {choices.cohesion:g} Pa, a friction angle of {choices.friction:g} "
        f"degrees and {choices.density:g} kg/m3" + (f", water {choices.water:g}" if choices.water else ""))
    return (f"The bodies are {where}. Each was released in {choices.sample} runs over {', '.join(choices.vary)}. A "
            f"share is that of a body's runs in which the deposit on the road is thicker than {choices.blocked:g} m, "
            "given that the body fails; its range is that of so few runs (Clopper and Pearson, 90 %).")


def list_route_caveats(choices: Choices, results: Mapping[str, Any]) -> Iterator[str]:
    """Of the runs, and those of the fragility, on which frequencies rest."""
    yield from (f"{finding(one)}: more of the road may be blocked, and more often" for one in results["doubts"])
    yield from (f"fragility: {finding(one)}" for one in results["fragility_warnings"])
    failed = [one for one in results["bodies"] if one["failed"]]
    if failed:
        yield f"runs of {len(failed)} bodies failed; their shares are of the others, body {failed[0]['body']} first"
    if choices.sample < 8:
        low = hazard.share_bounds(choices.sample, choices.sample)[0]
        yield (f"{choices.sample} runs of a body that all block the road tell no more than a share of {100 * low:.0f} "
               f"%, and where none does it may be up to {100 * (1 - low):.0f} %: --sample adds more to those that are "
               "there")


def draw_route_maps(corridor: Corridor, results: Mapping[str, Any], yearly: bool) -> Iterator[Picture]:
    """Maps of the corridor, of at most ALONG of its road each."""
    length = corridor.axis.length
    number = max(1, math.ceil(length / ALONG))
    for k in range(number):
        low, high = length * k / number, length * (k + 1) / number
        part = substring(corridor.axis, low, high)
        yield Picture(
            map_of(corridor, results, yearly, part.bounds, Span(corridor.start + low, corridor.start + high)),
            "map of the corridor", f"km {km(corridor.start + low)} to {km(corridor.start + high)}. The road in the "
            "colours of "
            + ("how often per year it is blocked" if yearly else "the largest share of a body's runs that block it")
            + "; white: no run does, which so few runs may miss. Bodies with their numbers; hollow: left out.")


def map_of(corridor: Corridor, results: Mapping[str, Any], yearly: bool, bounds, along: Span) -> str:
    raster = corridor.raster
    room = corridor.reach
    shown = maps.window(raster, (bounds[0] - room, bounds[1] - room, bounds[2] + room, bounds[3] + room))
    axis = Axis(np.asarray(corridor.axis.coords), corridor.start)
    with pictures.settings({**figures.STYLE, "figure.constrained_layout.use": False}):
        figure, axes = maps.relief(raster, raster.z, shown, "")
        maps.outline(axes, corridor.road, color="black", lw=0.4)
        axes.plot(*np.asarray(corridor.axis.coords)[:, :2].T, color="white", lw=2.2)
        here = [one for one in results["pieces"] if one["to"] > along.low and one["from"] < along.high]
        lines = [np.asarray(axis.line(Span(max(one["from"], axis.s[0]), min(one["to"], axis.s[-1]))).coords)[:, :2]
                 for one in here]
        norm = LogNorm(LEAST, 1.0) if yearly else Normalize(0, 1)
        values = np.array([max(one["per_year"]["counts"], LEAST) if yearly else one["share"] for one in here])
        coloured = axes.add_collection(LineCollection(lines, cmap=palettes.PATH, norm=norm, linewidths=3.2,
                                                      array=values))
        figure.colorbar(coloured, ax=axes, orientation="horizontal", aspect=50, shrink=0.6, pad=0.2,
                        label="blocked, times per year" if yearly else "share of the runs that block the road")
        for several, fill in ((results["bodies"], figures.RELEASE), (results["left_out"], "none")):
            for one in several:
                if shown[0] < one["x"] < shown[2] and shown[1] < one["y"] < shown[3]:
                    axes.plot(one["x"], one["y"], "o", ms=5, mfc=fill, mec=figures.RELEASE)
                    axes.annotate(str(one["body"]), (one["x"], one["y"]), xytext=(4, 4), textcoords="offset points",
                                  fontsize=7)
        maps.crs_axes(axes, raster, crs_name(raster.crs) if raster.crs is not None else "")
        return figures.data_uri(figure)


# --- tables ---

def make_table_section(title: str, heads: List[str], rows: List[List[Any]], caption: str) -> Section:
    return Section(title.lower().replace(" ", "_"), title, [Table(caption, heads, rows, ())])


def format_route_cell(value, form: str = "") -> str:
    return "-" if value is None else form.format(value) if form else digits.rounded(value, 3)


def format_factor(row: Mapping[str, Any], form: str = "{:.3f}") -> str:
    return row.get("no_factor") or format_route_cell(row["factor"], form)


def often(row: Mapping[str, Any], yearly: bool) -> List[str]:
    year = row["per_year"]
    return [f"{year['counts']:.2g}", f"{year['low']:.2g} to {year['high']:.2g}"] if yearly else []


def share(row: Mapping[str, Any], name: str) -> List[str]:
    return [f"{100 * row[name]:.0f} %", f"{100 * row['share_low']:.0f} to {100 * row['share_high']:.0f} %"]


def make_along_section(results: Mapping[str, Any]) -> Section:
    return Section("along", "Which body brings most", [Figures([road_part.bodies_along(results["along"])])])


def make_stretches_section(results: Mapping[str, Any], yearly: bool) -> Section:
    """Each stretch with the bodies that block it."""
    rows = []
    for one in results["stretches"]:
        for by in one["bodies"]:
            numbers = [format_route_cell(by.get(name, [None] * 3)[k]) for name, k in (
                ("length", 1), ("remove", 1), ("remove", 2), ("remove_lane", 1), ("passable_width", 1),
                ("hours_lane", 1), ("hours", 1))]
            rows.append([one["stretch"], f"{km(one['from'])} to {km(one['to'])}", *often(one, yearly), by["body"],
                         format_factor(by, "{:.2f}"), *share(by, "share"), *numbers])
    heads = ["stretch", "km", *(["blocked, per year", "90 %"] if yearly else []), "body", "factor of safety",
             "share of its runs", "90 %", "blocked m", "to remove m3", "95 % of the runs", "for a lane m3",
             "passable m", "hours, lane", "hours"]
    return make_table_section("By stretch", heads, rows, "Medians over the runs of a body, those that do not block the "
                              "stretch " "among them.")


def bodies(results: Mapping[str, Any], yearly: bool) -> Section:
    rows = [[one["body"], one["name"], km(one["chainage_m"]), format_factor(one),
             format_route_cell(one["volume_m3"]),
             format_route_cell(one["depth_m"]), format_route_cell(one["known_share"], "{:.2g}"), one["runs"],
             *share(one, "share_blocked"),
             format_route_cell(one["on_road_median_m3"]), format_route_cell(one["on_road_most_m3"]),
             *([f"{one['per_year']['fails']:.2g}", f"{one['per_year']['blocks']:.2g}"] if yearly else [])]
            for one in results["bodies"]]
    heads = ["body", "name", "km", "factor of safety", "volume m3", "depth m", "known events that reach the road",
             "runs", "block the road", "90 %", "on the road m3, median", "most",
             *(["fails, per year", "blocks, per year"] if yearly else [])]
    return make_table_section("By body", heads, rows, "By chainage. Known events: of this volume and height, the share "
                              "that goes as " "far as the road.")


def left_out(results: Mapping[str, Any]) -> Section:
    rows = [[one["body"], km(one["chainage_m"]), format_factor(one),
             format_route_cell(one["volume_m3"]), one["why_not"]]
            for one in results["left_out"]]
    return make_table_section("Left out", ["body", "km", "factor of safety", "volume m3", "why"], rows,
                              "Bodies that may fail and by known mobility do not come to the road; no number has them. "
                              "Those of "
                              "which some known events go so far can: a smaller --reach, in another folder, takes them "
                              "in.")
