"""The page on a study of blocks, and the sentences with which it and the console begin."""
from pathlib import Path
from typing import Dict, Iterator, List, Optional, Sequence, Tuple

import numpy as np

from .. import digits, disk, provenance
from ..animation import frames, view
from ..case import decks
from ..drawing import figures, palettes
from ..geometry import extent_of
from ..plots import figure_charts, figure_maps
from ..plots.ground import Ground
from ..plots.section import Section as Profile
from ..report import document, heading, limits_part
from ..report.data import Data
from ..report.sections import Figures, Picture, Section, Table, Text
from ..releases import release_area
from ..sites import site_deck, site_zones
from ..sites.site_choices import Folder
from ..sites.site_folder import BODY
from ..sites.site_sections import OfBlocks
from ..survey import polygons
from . import files
from .outcome import DITCH, Quantity, Result
from .runs import AT_ROAD, QUANTITIES, find_farthest_run
from .site import sizes_of

NAME = "report.html"
POINTS = 60             # of a curve
KEPT = 0.5, 0.8, 0.9, 0.95, 0.99
# what is travelled, and the quantities at a line
TITLES = {"distance": "Travelled distance in plan, from start to end",
          "along": "Along the fall line of the release area", "across": "Across it, to the left",
          "energy": "Energy, translation and rotation", "speed": "Speed",
          "height": "Height of the block's lower edge above the terrain"}


def format_block_number(value: Optional[float], unit: str) -> str:
    if value is None:
        return "?"
    return digits.si(value, unit) if unit == "J" else f"{digits.three(value) if value else '0'} {unit}"


def say_worst(known, *parts: Tuple[str, str, str]) -> str:
    """The worst of several numbers, each as (its name, its unit, a text around {}), after the last of those that
    come from one rolling resistance which one it is."""
    several = [known.outcome.worst[name] for name, _, _ in parts]
    said = ""
    for (_, unit, text), worst, after in zip(parts, several, [*several[1:], None]):
        number = format_block_number(worst.value, unit) if unit else worst.value.text
        said += text.format(number) + f" (rolling resistance {worst.rolling})" * (
            after is None or after.rolling != worst.rolling)
    return said


def sentences(known) -> Iterator[str]:
    """The answer: which share reaches the road, with which energy; how far blocks go: of each number the worst."""
    of, reach = known.outcome, known.outcome.worst.get("reach")
    several = f"the worst of {len(of.results)} rolling resistances, each with " * (len(of.results) > 1)
    whose = several + " on ".join(
        " to ".join(dict.fromkeys((f"{min(numbers):,}", f"{max(numbers):,}"))) + f" {what}" for what, numbers in (
            (what, [getattr(one, what) for one in of.results]) for what in ("blocks", "grounds")))
    if reach and reach.value.seen:
        yield say_worst(known, ("reach", "", "Of the blocks {} reach the road"),
                        ("past", "", " and {} pass it")) + f": {whose}"
        widest = max(of.results, key=lambda result: result.reach.high)
        if digits.percent(widest.reach.high) != digits.percent(reach.value.high):
            yield (f"up to {digits.percent(widest.reach.high)} may reach it (rolling resistance {widest.rolling}), as "
                   + ("some left the terrain before, or still moved" if widest.reach.open else
                      "the grounds differ more there"))
        yield say_worst(
            known, (f"{AT_ROAD}_energy_95", "J", "at its near edge 95 % of those that reach it have at most {}"),
            (f"{AT_ROAD}_energy_largest", "J", ", the hardest {}"),
            (f"{AT_ROAD}_speed_largest", "m/s", "; up to {}"),
            (f"{AT_ROAD}_height_largest", "m", ", the lower edge up to {} above the terrain"))
    elif reach:
        yield (f"none of the blocks {'was seen to reach' if reach.value.open else 'reaches'} the road; as blocks share "
               f"their grounds, chance leaves {reach.value.text} possible (rolling resistance {reach.rolling}; {whose})"
               ", more grounds (blocks.grounds of site.yaml) less")
    yield say_worst(known, ("distance_50", "m", f"in plan half of {'all' if reach else 'the'} blocks travel "
                            + of.at_least + "{}"), ("distance_95", "m", f", 5 % more than {of.at_least}" "{}"),
                    ("distance_largest", "m", f", the farthest {of.at_least}" "{}"))
    yield (f"one more ground brings something larger than the largest of all these with a probability of at most "
           f"{digits.percent(of.another)}")


def cells(quantity: Optional[Quantity], unit: str, prefix: str = "") -> List[str]:
    """Quantiles with their bounds, the largest, and of how many blocks."""
    if quantity is None:
        return ["-", "-", "-", "0"]
    return [*(f"{prefix}{format_block_number(at.value, unit)} ({format_block_number(at.low, unit)} to "
              f"{format_block_number(at.high, unit)})"
              for at in quantity.quantiles), prefix + format_block_number(quantity.largest, unit),
            f"{quantity.blocks:,}"]


def tables(known) -> Iterator[Section]:
    results: List[Result] = known.outcome.results
    heads = ["rolling resistance", "50 %", "95 %", "largest", "blocks"]
    lines = list(results[0].crossed)
    yield Section("reach", "What reaches the road", [Table(
        "By block; bounds of 90 % from the differences between the grounds, as blocks of one run share theirs.",
        ["rolling resistance", "blocks", "grounds", *["reach the road", "pass it"] * bool(results[0].reach),
         *(f"cross {line}" for line in lines), "left the terrain", "still moved"],
        [[one.rolling, f"{one.blocks:,}", one.grounds, *(share.text for share in (one.reach, one.past) if share),
          *(one.crossed[line].text for line in lines), f"{one.left:,}", f"{one.moving:,}"] for one in results])])
    if zones := known.site.found.zones:
        model, variables = known.site.choices.model, decks.index_variables(known.site.folder / site_deck.NAME)
        rows = []
        for zone in site_zones.with_rest(zones):
            each = [site_zones.now(zone, model, {**variables, "rolling": one.rolling}) for one in results]
            rows.append([zone.name, f"{100 * zone.share:.3g}", *(", ".join(dict.fromkeys(
                f"{now[name]:.3g}" for now in each)) for name in each[0])])
        yield Section("ground", "The ground", [Table(
            "What the ground is, where: zones as on the maps, and the ground outside of them; rolling resistances are "
            "those of the runs, or the zone's own.", limits_part.ZONE_HEADS, rows)])
    yield Section("travel", "How far they go", [Figures([farther(known), retained(known)], "columns"), *(Table(
        TITLES[name], heads, [[one.rolling, *cells(one.travel[name], "m", one.at_least * (name != "across"))]
                              for one in results]) for name in results[0].travel if name != DITCH), widths(known)])
    for place in results[0].at:
        yield Section(f"at_{place}", "At the road's near edge" if place == AT_ROAD else f"At the line {place}", [
            Text("Of the blocks that come there, each with its largest value. Heights count from the tops of the "
                 "ground's balls, which stand for the terrain: a block at rest is up to 0.4 of the smallest one lower.",
                 "soft"),
            *(Table(TITLES[name], heads, [[one.rolling, *cells(one.at[place][name], unit)] for one in results])
              for name, unit in QUANTITIES.items())])


def farther(known) -> Picture:
    """Which share goes farther."""
    series = []
    for one in known.outcome.results:
        distance = np.concatenate([run.travel["distance"] for run in known.runs if run.rolling == one.rolling])
        x = np.linspace(0, distance.max(), POINTS)
        series.append((one.rolling, x.tolist(), [100 * float(np.mean(distance > at)) for at in x]))
    return draw_curve(series, "travelled distance in plan (m)", "blocks that go farther (%)", "Travelled distance",
                      "Share of the blocks that go farther; one that left the terrain ends where it left it.")


def retained(known) -> Picture:
    """Which share a ditch keeps."""
    of = known.outcome
    to_road = (f" The road begins {format_block_number(of.to_road, 'm')} beyond the foot (median)." if of.to_road
               is not None else "")
    return draw_curve([(one.rolling, of.widths, [100 * share.share for share in one.retained]) for one in of.results],
                      "width of a ditch at the slope's foot (m)", "blocks retained (%)", "Retained by a ditch",
                      "Share of the blocks that end on the slope or within so far of its foot, below which the ground "
                      "falls "
                      f"less than 1 : 4; a level ditch, no barrier.{to_road} All numbers: study/{files.RETAINED}.")


def draw_curve(series, x_label: str, y_label: str, title: str, caption: str) -> Picture:
    """series: of each a rolling resistance, x and y."""
    return Picture(figure_charts.chart([figure_charts.Series(f"rolling resistance {rolling}", x, y)
                                        for rolling, x, y in series], x_label, y_label, title), title, caption)


def widths(known) -> Table:
    """How wide a ditch must be."""
    of = known.outcome

    def widest(results: Sequence[Result], share: float, side: str, none: str) -> str:
        wide = [width for result in results if (width := result.width(share, of.widths, side)) is not None]
        return f"{max(wide):g} m" if len(wide) == len(results) else none

    def width_of(results: Sequence[Result], share: float) -> str:
        at = widest(results, share, "share", f"> {of.widths[-1]:g} m")
        return f"{at} ({widest(results, share, 'high', '?')} to {widest(results, share, 'low', '?')})"
    several = [(one.rolling, [one]) for one in of.results]
    if len(several) > 1:
        several.append(("the worst", of.results))
    return Table("Width of a ditch at the foot of the slope that retains so many blocks, to a step of the curve, with "
                 "its bounds (?: so many grounds do not bound it).",
                 ["rolling resistance", *(f"{100 * share:g} %" for share in KEPT)],
                 [[name, *(width_of(results, share) for share in KEPT)] for name, results in several])


def maps(known, data: Data, ground: Ground) -> Dict[str, Picture]:
    """The largest energy and speed over all runs."""
    raster, drawings = ground.raster, {}
    several = {name: files.combine_largest(known.runs, name, raster).z for name in files.LARGEST}
    shown = ground.window(extent_of(raster.transform, several["max_speed"] > 0),
                          *([data.road.bounds] if data.road else []))
    release = release_area.nodes_inside(raster, polygons.read_local(known.site.folder / f"{BODY}.csv", raster, True))
    layers = figure_maps.Layers(raster, ground.before, shown, release, data.road, None,
                                figures.contour_interval(ground.before), {}, {
                                    name: points for name, points in ground.obstacles.lines.items()
                                    if name in known.terrain.lines},
                                zones=site_zones.outlines(known.site.folder, known.site.found.zones, raster))
    for name, unit in files.LARGEST.items():
        factor, prefix = digits.prefix(several[name].max())
        values, what = several[name] / factor, name.replace("max_", "")
        drawings[what] = Picture(figure_maps.value_map(
            layers, values, f"Largest {what} of a block", f"{what} ({prefix}{unit})",
            figures.even_to_most(values[values > 0]), palettes.PATH if unit == "J" else palettes.SPEED, figures.FULL,
            values > 0), f"Map of the largest {what}",
            f"Largest {what} of a block over all {len(known.runs)} runs, as sampled, not smoothed.")
    return drawings


def write_block_page(known, output: Path) -> str:
    """The page; a line for the user."""
    site, run = known.site, find_farthest_run(known.runs)
    data = Data(run.folder)
    data.road = known.terrain.road and known.terrain.road.polygon
    ground = Ground(data)
    shots, why = frames.read_frames(data.result)
    view_content = view.make_view_content(data, ground, Profile(data, ground, None, False), shots, why, "")
    caption = f"Run with the farthest block, {run.name}: {view_content['caption'].partition(' The ground is')[0]}"
    head = heading.heading(site.folder, {}, site.content)
    html = document.render({
        "title": f"Single blocks: {head['project']}", "name": head["project"], "heading": head,
        "made": provenance.now(), "mark": document.mark(site.folder), "place": ground.raster.crs is not None,
        "sentences": [f"{text[0].upper()}{text[1:]}." for text in sentences(known)], "how": how(site),
        "warnings": [(one.level, one.shown({})) for one in known.doubts], "maps": maps(known, data, ground),
        "sections": list(tables(known)), "view": {**view_content, "caption": caption,
                                                  "title": "Blocks in three dimensions"},
        "footer": f"{document.MADE_BY}, SLOPE {provenance.version()}; all numbers: study/{files.RESULTS}, "
                  f"study/{files.BLOCKS}; for a GIS: study/{', study/'.join(files.NAMES)}"},
        Path(__file__).with_name("blocks.html.j2"))
    disk.write_file(output, html)
    return f"{output}: {len(html) / 1e6:.1f} MB"


def how(site: Folder[OfBlocks]) -> str:
    """What was run."""
    of, model, (low, high) = site.choices.blocks, site.choices.model, sizes_of(site.choices)
    size = f"of {low:g} m" if low == high else f"of {low:g} to {high:g} m, all sizes as frequent,"
    start = f"at {of.speed:g} m/s down the fall line of the release area" if of.speed else "at rest"
    smooth = "; larger blocks find them smoother, the smallest one must not fall between them" if low < high else ""
    outside = " outside of the zones" if site.found.zones else ""
    return (f"Blocks {size} and {model.density:,g} kg/m3 begin {start}, evenly over the release area, just above "
            f"the ground; they do not see each other. The ground is scattered balls of {low:g} m, {model.spacing:g} "
            f"diameters apart{smooth}: friction {model.friction:g} degrees, restitution "
            f"{model.field_restitution:g}{outside}. Each run has other balls of the ground and other places of "
            "blocks.")
