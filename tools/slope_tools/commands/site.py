"""slope site: make a folder with terrain, body, deck and map from GIS files, ready for `slope study`."""
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path
from shlex import quote
from typing import Any, Dict, List, Optional, Sequence, Tuple, Union

from .. import findings
from ..blocks import kinds
from ..ensembles import known_study
from ..errors import SlopeError
from ..findings import Finding, finding, printer
from ..mobility import results
from ..options import Program, flag, parse_number, option, positional, parse_whole_number
from ..plots import site_map
from ..programs import lmp_if_any
from ..releases import packing
from ..releases.release import SHAPES
from ..releases.release_dip import LEAST
from ..releases.release_scar import KINDS
from ..runs import jobs
from ..sites import site, site_budget, site_choices, site_deck, site_scenarios, site_warnings
from ..sites.site_sections import VERSION, Choices, Key, OfMass, sections
from ..slips import bodies
from ..studies import ahead, outlook, site_ground
from ..studies.setup import RUNS, Setup
from ..survey import roads
from . import known_arguments, road_arguments
from .release_arguments import Heights, degrees_or_least, level_or_file

# of each section of site.yaml, the options, as option=key where they are not called alike, in the order of messages
BY_SECTION = {
    "terrain": "terrain=files crs assign_crs bounds z_unit nodata differ cell fill", "crs": "assigned",
    "release": "release=polygon shape depth volume curvature dip foundation direction scar scar_is least bodies",
    "road": " ".join(["road=file roads=others cut_angle mesh", *(f"{option}={roads.KEYS[field]}" for option, field
                                                                 in road_arguments.OPTIONS.items())]),
    "ground": "ground=file ground_table=table", "structures": "structure=files wall=walls height width",
    "lines": "line=files", "motion": "motion=file peak_friction",
    "model": "friction slip_friction density spacing field_restitution", "study": "rolling largest_restitution",
    "observed": "observed=file", "known": "known=set confined", "balls": "diameter balls=number minutes memory",
    "project": "name client author", "blocks": "blocks=number size speed"}
OPTIONS = {option: (section, key or option) for section, words in BY_SECTION.items()
           for option, _, key in (word.partition("=") for word in words.split())}
# options that change neither the body nor its runs: what was determined for these is kept
BESIDE = {"road", "roads", *road_arguments.OPTIONS, "cut_angle", "mesh", "line", "observed", "known", "confined",
          "rolling", "largest_restitution", "name", "client", "author"}
OTHERWISE = {"assigned": "--assign-crs", "roads": "--road"}     # options that are not called so
# of each group, an option that is given replaces the others
SIZES = ("diameter", "balls", "memory")
OF_SHAPE = "depth", "volume", "curvature", "dip", "direction"
ONE_OF = (("depth", "volume", "curvature"), SIZES)
OF_SOIL = ("friction", "rolling", "spacing", "field_restitution", "density", "slip_friction")
LIGHT = 100                 # kg/m3; less is not a ground's density, but one in t/m3 or relative to water's
Chosen = Tuple[Path, Choices, site_choices.Derived]

DESCRIPTION = "A folder for a site: terrain, body, layers, deck, map, and site.yaml with every choice."
EPILOG = """\
units: metres, m3, degrees; minutes of the whole study on this machine, GB of all runs that are active at a time.

examples: a folder from three GIS files, then the study and its report:
  tools/slope site --terrain dem.tif --release release.geojson --depth 12 --road road.geojson -o mine
  tools/slope study mine

the body that slope stability found below dem.asc:
  tools/slope site --terrain dem.asc --slips slips --road road.geojson -o critical

a scar from two surveys; a wall, an earthquake and a line behind the wall; finer balls for an existing site:
  tools/slope site --terrain before.tif --scar after.tif --least 0.5 --road road.shp -o scar
  tools/slope site --terrain dem.tif --release release.shp --volume 50000 --structure wall.stl --line behind.geojson \\
      --motion motion.txt -o quake
  tools/slope site mine --minutes 60

half of it, with the balls and cells of the site, in mine/scenarios/half; slope report mine sets them side by side:
  tools/slope site mine --scenario half --volume 25000

a light and smooth ground:
  tools/slope site mine --friction 25 --rolling 0 0.05 --spacing 0.8 --density 1600

10,000 single blocks of 0.8 to 1.2 m, and which share of them reaches the road:
  tools/slope site --terrain dem.tif --release cliff.geojson --blocks 10000 --size 0.8:1.2 --road road.geojson -o cliff

FOLDER/site.yaml holds every choice, and what each means; change it and give FOLDER alone to rebuild the folder. Changes
of road, known and study take effect in the next `slope study FOLDER`, which makes only the runs that are not there.
Keys of it that no option has:
""" + "\n".join(f"  {section}.{key}: {entry.get('description', '')}" for section, about in sections()
                for key, entry in about["properties"].items() if (section, key) not in OPTIONS.values()) + "\n"


@dataclass(frozen=True, kw_only=True)
class Ground(Heights):
    """The ground and the body."""
    GROUP = "ground and body"
    terrain: Optional[List[str]] = option(
        "elevation model, as slope terrain takes it: GeoTIFF, ASCII grid, XYZ, FG-GML, also zipped; several are merged",
        metavar="DEM", nargs="+")
    crs: Optional[str] = option("wanted CRS, in metres; an elevation model without one is in it", metavar="EPSG:n")
    assign_crs: Optional[List[str]] = option(
        "the elevation model, or the FILE of another option, is in this CRS, whatever it says; may be given several "
        "times", metavar="[FILE=]EPSG:n", action="append")
    bounds: Optional[List[float]] = option("take this part, m", nargs=4, metavar=("W", "S", "E", "N"))
    cell: Optional[float] = option("wanted cell size, m", metavar="S")
    fill: Optional[int] = option("fill NODATA holes of at most N cells", type=parse_whole_number, metavar="N")
    release: Optional[str] = option(
        "polygon of the ground that is released, in any CRS: GeoJSON, shapefile, CSV or WKT; with --scar, only the "
        "part of the scar inside it is used", metavar="P")
    shape: Optional[str] = option("of the slip surface, see slope release (default sphere)", choices=SHAPES)
    depth: Optional[float] = option("largest depth of the body, vertical, m", metavar="D", one_of="size")
    volume: Optional[float] = option("volume of the body, m3", metavar="V", one_of="size")
    curvature: Optional[float] = option("of slbl, 1/m", metavar="K", one_of="size")
    dip: Union[float, str, None] = option(
        "of a plane, degrees below the horizontal; least: the sphere that dips least, see slope release",
        metavar="A|least", type=degrees_or_least)
    foundation: Union[float, str, None] = option("of --dip least: level, m, or raster (default: the toe's level)",
                                                 metavar="LEVEL|RASTER", type=level_or_file)
    direction: Optional[float] = option("compass bearing to which the plane dips, degrees", metavar="B")
    scar: Optional[str] = option("the body is what this raster says, see --scar-is", metavar="RASTER")
    scar_is: Optional[str] = option(
        "surface: heights after the event (default, if they follow the terrain); depth; change; height of the mass on "
        "top of the terrain", choices=KINDS)
    slips: Optional[Path] = option(
        "the bodies are those that slope stability found on this terrain, its folder or PREFIX.slips.csv; instead of "
        "--release. The first is released where the deck's variable body does not say otherwise", metavar="SLIPS")
    body: Optional[int] = option("only the one of this rank (1 has the least factor of safety)", metavar="N")
    least: Optional[float] = option("depths of a scar below this count as none, m", metavar="D")


@dataclass(frozen=True, kw_only=True)
class Layers(road_arguments.Clearing):
    """What lies on it."""
    GROUP = "what lies on it"
    road: Optional[List[str]] = option("for the volume to remove, " + road_arguments.ROAD + "; may be given several "
                                       "times, and lines that do not meet are each a road", metavar="P",
                                       action="append")
    ground: Optional[str] = option(
        "zones of the ground: polygons with the attributes name, friction (degrees), rolling, restitution, spacing "
        "(diameters); what a zone does not give, and the ground outside of all, has the values below. Or a raster of "
        "classes", metavar="P|RASTER")
    ground_table: Optional[str] = option("of these classes: CSV with the columns class and these attributes",
                                         metavar="CSV")
    cut_angle: Optional[float] = option("rise of the cut from its edges (default 30)", metavar="DEG")
    mesh: Optional[float] = option("side of the mesh cells, m (default 10)", metavar="SIZE")
    structure: Optional[List[str]] = option(
        "a wall or building of triangles, m, in local coordinates or the terrain's CRS; may be given several times",
        metavar="STL", action="append")
    wall: Optional[List[str]] = option(
        "a wall along this line, which stands on the ground and is --height high; may be given several times",
        metavar="LINE", action="append")
    height: Optional[float] = option("of the walls along lines, above the ground, m", metavar="H")
    width: Optional[float] = option("of the walls along lines, m (default 1)", metavar="B")
    line: Optional[List[str]] = option(
        "control line: what crosses it is counted; may be given several times", metavar="LINE", action="append")
    motion: Optional[str] = option(
        "ground motion written by slope quake: the body stands, is shaken, and loses its strength once it has moved "
        "far enough", metavar="FILE")
    peak_friction: Optional[float] = option(
        "strength that holds the body before the earthquake, degrees (default: 7 more than the slope of its slip "
        "surface, 33 at least)", metavar="DEG")
    observed: Optional[str] = option(
        "a mapped deposit, outline or thickness, with which the run shown in the report is compared",
        metavar="P|RASTER")
    known: Optional[str] = known_arguments.known_option(
        "events that the mass is compared with, in slope mobility and the study")


@dataclass(frozen=True, kw_only=True)
class Model:
    """Both frictions, rolling resistance and restitution on the ground are the paper's by default, the others ours."""
    GROUP = "soil and ground (of the paper by default: both frictions, rolling resistance, restitution on the ground)"
    friction: Optional[float] = option("of soil and ground, degrees (default 30)", metavar="DEG")
    rolling: Optional[List[float]] = option(
        "rolling resistances of the study, of which the largest volume counts (default 0 0.05 0.1)", metavar="R",
        nargs="+")
    slip_friction: Optional[float] = option("of the slip surface, degrees (default 0)", metavar="DEG")
    density: Optional[float] = option(
        "bulk density of the ground, kg/m3 (default 1786); forces and energies are proportional to it, volumes and "
        "distances do not depend on it", metavar="R")
    spacing: Optional[float] = option(
        "of the ground's balls, in diameters, its roughness: up to 0.95 (default 0.9); less is smoother", metavar="S")
    field_restitution: Optional[float] = option("on the ground (default 0.1)", metavar="E")
    largest_restitution: Optional[float] = option(
        "that rock may have: runs with it, of reach and area alone (default 0.9)", metavar="E")


@dataclass(frozen=True, kw_only=True)
class Size:
    """Of the balls."""
    GROUP = f"the coarsest balls: one of --balls, --memory, --diameter (default: --balls {site_budget.DEFAULT})"
    balls: Optional[int] = option("number of balls in the body", metavar="N", one_of="size")
    minutes: Optional[float] = option(
        f"that the study may take on this machine (default {site_budget.MINUTES:g}), which decides how many points run "
        "with finer balls", metavar="M")
    memory: Optional[float] = option(
        "choose the size so that the active runs together take this much memory", metavar="GB", one_of="size")
    diameter: Optional[float] = option("of the balls, m", metavar="D", one_of="size")


def sizes(text: str) -> List[float]:
    """argparse type: D or D:D2."""
    return [parse_number(part) for part in text.split(":")]


@dataclass(frozen=True, kw_only=True)
class Blocks:
    """Instead of a mass."""
    GROUP = "single blocks instead of a mass, which begin in the release area"
    blocks: Optional[int] = option("number of blocks, of all runs together", metavar="N")
    size: Optional[List[float]] = option("their diameter, m; D:D2: from D to D2, all as frequent (default 1)",
                                         type=sizes, metavar="D[:D2]")
    speed: Optional[float] = option("at the start, m/s, down the fall line of the release area (default 0)",
                                    metavar="V")


@dataclass(frozen=True, kw_only=True)
class About:
    """Of the report."""
    GROUP = "report"
    name: Optional[str] = option("of the site (default: of the folder)")
    client: Optional[str] = option("recipient of the report")
    author: Optional[str] = option("the person responsible")


@dataclass(frozen=True, kw_only=True)
class Request(Ground, Layers, known_arguments.Confined, Model, Size, Blocks, About, Program):
    folder: Optional[Path] = positional(
        "a site's folder that is rebuilt from its site.yaml; options change its choices", metavar="FOLDER", nargs="?")
    scenario: Optional[str] = option(
        "make another site, FOLDER/scenarios/NAME, that differs by the other options alone: with the balls, cells, "
        "time limit and packings of FOLDER, and at least as stiff", metavar="NAME")
    output: Optional[Path] = option("the new folder", "-o", metavar="FOLDER")
    jobs: Optional[int] = option("runs at a time, for the estimate (default: as many as the cores)", metavar="J")
    verbose: bool = flag(f"print all warnings and notes, not the {site_warnings.MOST} that weigh most")


def run_site(args: Request) -> None:
    """Do the command; raises SlopeError on bad input. Prints what may make the answer wrong, then what was read, found
    and written.
    """
    folder, choices, known = choose_site(args)
    lines: List[str] = []
    doubts: Dict[str, Finding] = {}
    warn = printer("site")

    def keep(entry) -> None:
        doubts.setdefault(str(one := finding(entry)), one)
    if isinstance(choices, OfMass) and any(getattr(args, option) is not None for option in OF_SOIL):
        lines.append(site_deck.soil(choices))
    cores, first = args.jobs or jobs.cores(), None
    try:
        with jobs.signals_interrupt(), site_scenarios.room(folder) if args.scenario is not None else nullcontext():
            made = site.make_site(choices, folder, site.Machine(lmp_if_any(args.lmp), cores), lines.append,
                                  warn if findings.as_json else keep, site_map.draw_site_map,
                                  again=args.folder is not None and args.scenario is None, known=known,
                                  how=kinds.build(choices))
        if isinstance(choices, OfMass):
            lines += [*site_ground.describe_grounds(site_choices.load_site(folder)), *outlook.describe_outlook(folder)]
            second, differs = results.describe_site_mobility(folder)
            lines += second
            if differs:
                keep(differs[0])
                site_warnings.add(folder, differs)
            if (folder / RUNS).is_dir():
                lines.append(runs_ahead(args, folder))
        first = None if args.verbose else site_warnings.heaviest(list(doubts.values()))
    finally:        # all of them where it ends with an error
        for one in doubts.values() if first is None else first:
            warn(one)
        print("".join(f"{line}\n" for line in lines), end="", flush=True)
    if first is not None and len(doubts) > len(first):
        print(f"all {len(doubts)} warnings and notes: --verbose, or {folder / site_warnings.NAME}")
    print(f"written to {folder}: {' '.join(made.files)}")
    print(f"look at {folder / site.MAP}, then: tools/slope study {quote(str(folder))}")


def runs_ahead(args: Request, folder: Path) -> str:
    """Which runs of the study are there now."""
    engine = Setup(folder / site_deck.NAME, folder, jobs=args.jobs, lmp=args.lmp)
    try:
        site_ = site_choices.load_site(folder)
        points = 0 if known_study.why_not(folder) else ahead.choose_points(site_, engine)
        return f"the study: {ahead.look_ahead(site_, engine, points).text}"
    except SlopeError as error:
        return f"the study: {error}"


def choose_site(args: Request) -> Chosen:
    """The folder; the choices of the command line, or of the folder with those of the command line; and what of them
    was found before.
    """
    given = {name: value for name in OPTIONS if (value := getattr(args, name, None)) is not None}
    given.update(site_choices.assigned_crs(given.pop("assign_crs", ())))
    given.update(of_roads(given.pop("road", ())))
    given.update(of_slips(args))
    if args.folder is not None:
        if args.output is not None:
            raise SlopeError("-o", f"must not be given with the folder of a site, {args.folder}, which is rebuilt",
                             args.output)
        folder, choices, known = rebuilt(args.folder, given) if args.scenario is None else of_scenario(args, given)
    else:
        if args.scenario is not None:
            raise SlopeError("--scenario", "must be given with the folder of a site", args.scenario)
        if args.terrain is None or args.output is None:
            raise SlopeError("--terrain" if args.terrain is None else "-o", "must be given, or the folder of a site")
        folder, choices, known = args.output, kinds.begun(args.blocks), {}
    kinds.check_kind(choices, {name: OPTIONS[name] for name in given})
    if "known" in given:
        known_arguments.choice_of(given["known"], [], None)     # SlopeError
    if "density" in given and isinstance(choices, OfMass):
        given["density"] = density_of_ball(given["density"])
    choices = replaced(choices, given)
    site_choices.check_site_file({"slope_site": VERSION, **choices.entries()},
                                 str(folder / site_choices.NAME),
                                 {OPTIONS[option]: OTHERWISE.get(option, f"--{option.replace('_', '-')}") for option
                                  in given})
    return folder, choices, known


def rebuilt(folder: Path, given: Dict[str, Any]) -> Chosen:
    """The folder of a site, its choices, and of them what counts of what was found before."""
    made = site_choices.load_kind(folder, site_choices.kind_in(folder))
    choices, known = made.choices, made.found.derived
    if given.keys() - BESIDE:
        return folder, site_choices.forgotten(choices, known), {}
    return folder, choices, known


def of_scenario(args: Request, given: Dict[str, Any]) -> Chosen:
    """The same of a new scenario, of which nothing was found before."""
    assert args.folder is not None and args.scenario is not None
    folder, of = site_scenarios.choose_scenario_folder(args.folder, args.scenario), site_choices.load_site(args.folder)
    for name in SIZES:
        if name in given:
            raise SlopeError(f"--{name}", "must not be given with --scenario, whose balls are those of its site",
                             f"{given[name]:g}")
    return folder, site_scenarios.choices(of, args.scenario), {}


def of_slips(args: Ground) -> Dict[str, Any]:
    """--slips and --body as options of a scar: the surface of the first body, and those of all that may be released."""
    if args.slips is None:
        if args.body is not None:
            raise SlopeError("--body", "must be given with --slips", args.body)
        return {}
    for name in ("scar", "release"):
        if getattr(args, name) is not None:
            raise SlopeError("--slips", f"must be given without --{name}: it is the body", args.slips)
    found = [bodies.base_file(args.slips, args.body)] if args.body else bodies.base_files(args.slips)
    return {"scar": str(found[0]), "scar_is": "surface", "bodies": [str(one) for one in found]}


def of_roads(files: Sequence[str]) -> Dict[str, Any]:
    """Options from the values of --road: the first one, and the others."""
    return {"road": files[0], **({"roads": list(files[1:])} if files[1:] else {})} if files else {}


def density_of_ball(bulk):
    """Of the balls (kg/m3) that together have a bulk density."""
    if bulk < LIGHT:
        raise SlopeError("--density", f"must be at least {LIGHT} kg/m3, of the ground with its voids", bulk)
    return round(bulk * packing.BULK, 1)


def replaced(choices: Choices, given: Dict[str, Any]) -> Choices:
    """The choices with options; those that one of them replaces become null."""
    new: Dict[Key, Any] = {OPTIONS[name]: None for group in ONE_OF if given.keys() & set(group) for name in group}
    least = LEAST in (given.get("dip"), choices.value("release", "dip"))     # depth and volume follow from it
    if "scar" in given or least and given.keys() & {*OF_SHAPE}:
        new.update({("release", key): None for key in (*OF_SHAPE, "shape")})
        new.update({("release", "foundation"): None} if given.get("dip") != LEAST else {})
    if isinstance(choices, OfMass) and ("scar" in given or "release" in given):
        new["release", "bodies"] = []
    if isinstance(choices, OfMass) and "road" in given:
        new["road", "others"] = []
    for name, value in given.items():
        section, key = OPTIONS[name]
        new[section, key] = {**choices.value(section, key), **value} if isinstance(value, dict) else value
    return choices.changed(new)
