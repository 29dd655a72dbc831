"""The page of a site's scenarios: a table, the outlines of the deposits on one map, and in what the models differ."""
from pathlib import Path
from shlex import quote
from typing import Iterator, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from .. import digits, disk, provenance
from ..case import run_folders
from ..drawing import figures, maps
from ..errors import SlopeError
from ..plots import figure_maps, sheets
from ..report import document
from ..report.sections import Cell, Figures, Listing, Picture, Section, Table, Text
from ..sites.site_folder import BODY as NAME_OF_BODY, TERRAIN
from ..sites.site_roads import ROAD
from ..statistics.entries import Headline
from ..survey import rasters, roads
from ..survey.rasters import Raster
from ..tables import answer_words, how_far
from . import method
from .compare import One, choices_that_differ, different_sizes, differences, read_scenarios, run_of

PAGE = "scenarios.html"
BODY = f"{NAME_OF_BODY}.depth.asc"
COLOURS = figures.COLOURS[1:]       # the first one is nearly that of roads
THICK = 0.1         # m: the deposit ends where it is thinner


class Outline(NamedTuple):
    """Of a deposit, or of a body: thickness (m) at places x, y of the local metres of the site, and the box of what is
    THICK."""
    x: np.ndarray
    y: np.ndarray
    thickness: np.ndarray
    box: Tuple[float, float, float, float]


class Shown(NamedTuple):
    """Of a site on the map; None: nothing of it is THICK."""
    name: str
    deposit: Optional[Outline]
    body: Optional[Outline]


def write_scenarios_page(folder: Path, output: Path, overwrite: bool) -> str:
    """Write the page of a site's folder beside its report; a line for the user."""
    disk.check_standing(output, [output], [document.MADE_BY], overwrite, f"slope report {quote(str(folder))}")
    several = read_scenarios(folder)
    difference = " ".join(filter(None, (method.difference({one.name: one.studied for one in several}, {
        one.name: one.site.folder for one in several}), different_sizes(several))))
    content = {
        "title": several[0].name, "client": several[0].site.choices.project.client,
        "author": several[0].site.choices.project.author, "made": provenance.now(),
        "mark": document.mark(folder),
        "sections": [Section("scenarios", "Side by side", [
            *([Text(difference, "caveat")] if difference else []), tabulate_scenarios(several),
            Figures([draw_scenarios(several)], "two-thirds")]),
                     Section("models", "In what the models differ", [Listing(list(models(several)))])],
        "footer": f"{document.MADE_BY}, SLOPE {provenance.version()}; each scenario has a report of its own."}
    disk.write_file(output, document.render(content, Path(__file__).with_name("scenarios.html.j2")))
    return f"{output}: the site and its {len(several) - 1} scenarios" + (f". {difference}" if difference else "")


def refresh(site: Path) -> str:
    """The page of a site anew after a study of it or of a scenario; why not, where it is none of ours."""
    try:
        return write_scenarios_page(site, site / PAGE, False)
    except SlopeError as error:
        return f"{PAGE} is not made: {error}"


def models(several: Sequence[One]) -> Iterator[str]:
    """A sentence on each scenario."""
    for one in several[1:]:
        found = list(differences(several[0], one))
        yield f"{one.name}: " + ("not made yet" if not one.variables else "; ".join(found) if found else
                                 "balls, stiffness and ground are those of the site") + "."


# --- the table ---

def tabulate_scenarios(several: Sequence[One]) -> Table:
    names = method.common([one.studied for one in several])
    roads = list(dict.fromkeys(road for one in several for road in (one.studied.roads if one.studied else ())))
    rows = [[one.name, "" if one is several[0] else "; ".join(choices_that_differ(several[0].site, one.site))
             or "nothing else", *list_scenario_numbers(one, names, roads)] for one in several]
    return Table("Released: of the body. 99 %: the distance within which so much of the volume stays, the largest of "
                 "all runs, in plan from the highest point of the body. Length: along the fall path, of the longest "
                 "run. To remove: the number of the first page of each report, where all have the same studies.",
                 ["", "with", Cell("released", "m3"), Cell("99 % within", "m"), Cell("length", "m"),
                  *(Cell(f"to remove{road and f' from {road}'}", "m3") for road in roads or [""]), "runs"],
                 rows, (0, 1))


def list_scenario_numbers(scenario: One, names: Sequence[str], roads: Sequence[str]) -> List[str]:
    """Of a row: what is released, how far it goes, what is to be removed from each road, how many runs finished.

    names: of the studies that count (method.common)."""
    body, studied = scenario.site.found.body, scenario.studied
    released = digits.rounded(body.volume, 4) if body else "-"
    if studied is None:
        return [released, "-", "-", *["-"] * max(1, len(roads)), "not studied as it is"]
    first = next(iter(studied.roads.values()))
    finished, far = method.list_finished_rows(first, names), method.find_farthest_reach(first, names)
    length = how_far.longest(finished)
    least = "at least " * any(row.left_box or not row.at_rest for row in finished)
    return [released, "unknown" if far is None else least + digits.three(far),
            "-" if length is None else least + digits.three(length),
            *(to_remove(method.headline_of(studied.roads[road], names)) if road in studied.roads else "-"
              for road in roads), f"{len(finished)} of {sum(len(about.runs) for about in method.taken(first, names))}"]


def to_remove(headline: Optional[Headline]) -> str:
    """The number of a headline, as page 1 has it."""
    return answer_words.describe_volume(headline.kind, headline.volume_m3) if headline else "-"


# --- the map ---

def draw_scenarios(several: Sequence[One]) -> Optional[Picture]:
    """The outlines of the deposits of the governing runs; None where there are none."""
    mine, shown = several[0].site, []
    names = method.common([one.studied for one in several])
    for one in several:
        if one.studied:
            by, run = origin(one) - origin(several[0]), run_of(one.studied, names)
            shown.append(Shown(one.name, outline(run_folders.load_raster(run, "thickness"), by),
                               outline(rasters.read_asc_local(one.site.folder / BODY, heights=False), by)))
    boxes = [each.box for one in shown for each in (one.deposit, one.body) if each]
    if not boxes:
        return None
    raster = rasters.read_asc_local(mine.folder / TERRAIN)
    whole = maps.window(raster, *boxes)
    road = mine.choices.road
    polygon = roads.read_local(mine.folder / ROAD, raster, road.asked, local=True).polygon if road.file else None
    layers = figure_maps.Layers(raster, raster.z, whole, None, polygon, None, figures.contour_interval(raster.z))
    title = "Outlines of the deposits"
    return Picture(map_of(layers, shown, title), title, f"{title}, where they are thicker than {THICK:g} m at the "
                   "end of the run that represents the number of each; dashed: what is released; the ground is that of "
                   "the site.")


def origin(scenario: One) -> np.ndarray:
    """Coordinates of the local 0 0 of a site."""
    return np.array([scenario.site.found.origin.east, scenario.site.found.origin.north])


def outline(raster: Raster, by: np.ndarray) -> Optional[Outline]:
    """Of thicknesses that lie so many metres east and north of their local metres; None where nothing is so thick."""
    thickness = np.pad(np.nan_to_num(raster.z), 1)      # an outline is closed at the edge, too
    rows, columns = thickness.shape
    x = raster.transform.c + raster.transform.a * (np.arange(columns) - 0.5) + by[0]
    y = raster.transform.f + raster.transform.e * (np.arange(rows) - 0.5) + by[1]
    row, column = np.nonzero(thickness > THICK)
    if not len(row):
        return None
    return Outline(x, y, thickness, (x[column].min(), y[row].min(), x[column].max(), y[row].max()))


def map_of(layers: figure_maps.Layers, shown: Sequence[Shown], title: str) -> str:
    legend = figure_maps.list_legend_entries(layers)

    def draw(axes, _):
        for k, scenario in enumerate(shown):
            colour = COLOURS[k % len(COLOURS)]
            for each, style, wide in ((scenario.deposit, "-", 1.4), (scenario.body, "--", 0.8)):
                if each:
                    axes.contour(each.x, each.y, each.thickness, [THICK], colors=colour, linewidths=wide,
                                 linestyles=style, zorder=6)
            legend.insert(k, sheets.Entry(scenario.name, {"color": colour, "lw": 1.4}))
    return figure_maps.compose_map(layers, title, "", None, draw, legend=legend)
