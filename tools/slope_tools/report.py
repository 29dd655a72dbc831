"""slope report: one self-contained HTML page on a study or a run, for the screen and for A4 paper.

Order of the work: find the runs, read their results, draw the pictures, fill the template, write.
"""
import argparse
import base64
import csv
import io
import math
import re
from pathlib import Path

import numpy as np
from affine import Affine

from . import deposit, rasters, runs
from .cli import number
from .errors import SlopeError
from .rasters import crs_name

MOST_SHOWN = 9          # runs that get a map and a line in the section
SMALL = 1e-6            # of the released volume
TALLEST = 0.7           # height / width of a map, where the terrain is wide enough
# Nakase et al., second Table 5: m3 to remove, of the collapse at Nakadori
PAPER = {"rolling": (0.0, 0.05, 0.10), "company J": (24048, 26009, 22340), "company I": (22114, 18262, 14490)}
ACTUAL = 14225

EPILOG = """\
units: metres; the ends of --section are local coordinates of the run's terrain.

example: the study that `slope study ... -o out` made:
  tools/slope report out -o report.html

Writes report.html, with all pictures in it, and report.section.csv, the heights along the section.
"""


def add_parser(commands, **kwargs):
    """Add `report` and its arguments to argparse's commands; return its parser."""
    parser = commands.add_parser(
        "report", formatter_class=argparse.RawDescriptionHelpFormatter, epilog=EPILOG,
        description="One self-contained HTML page on a study or a run.", **kwargs)
    parser.add_argument("folder", metavar="DIR", type=Path,
                        help="folder of a study (study.yaml) or of a single run (PREFIX.summary.yaml)")
    parser.add_argument("-o", dest="output", metavar="REPORT.html", type=Path,
                        help="the page (default DIR/report.html)")
    parser.add_argument("--section", nargs=4, type=number, metavar=("X1", "Y1", "X2", "Y2"),
                        help="ends of the section, local m (default: through the centroid of the released mass, along "
                             "the fall line)")
    parser.add_argument("--run", dest="shown", metavar="NAME",
                        help="the run of a study whose maps are shown (default: the one with the largest volume to "
                             "remove, else with the farthest front)")
    parser.add_argument("--no-paper", action="store_true",
                        help="leave out the numbers of the paper's second Table 5, which stand beside a study over "
                             "rolling")
    parser.add_argument("--pictures", action="store_true",
                        help="write the maps as files too, REPORT.1.png, REPORT.2.png, ... in the page's order; charts, "
                        "drawn as lines, stay in the page")
    return parser


def run(args):
    """Do the command; raises SlopeError on bad input. Prints what was written."""
    output = args.output or args.folder / "report.html"
    if output.suffix not in (".html", ".htm") or output.is_dir():
        raise SlopeError("-o", "must be a file that ends in .html", output)
    if not args.folder.is_dir():
        raise SlopeError(args.folder, "must be an existing folder")
    if not output.absolute().parent.is_dir():
        raise SlopeError("-o", "must be in an existing folder", output)
    if args.section and args.section[:2] == args.section[2:]:
        raise SlopeError("--section", "must have two different ends", " ".join(f"{value:g}" for value in args.section))
    page, html = make(args)
    runs.write(output, html)
    table = output.with_suffix(".section.csv")
    runs.write(table, page.section_table())
    print(f"{output}: {len(html) / 1e6:.1f} MB, {page.pictures} pictures; {table}")
    if args.pictures:
        write_pictures(output, html)
    for level, text in page.warnings:
        print(f"{'WARNING' if level == 'red' else 'note'}: {text}")


def write_pictures(output, html):
    """The page's PNG pictures, its maps, as files beside it."""
    pictures = re.findall(r"data:image/png;base64,([A-Za-z0-9+/=]+)", html)
    for place, picture in enumerate(pictures, 1):
        runs.write(output.with_suffix(f".{place}.png"), base64.b64decode(picture))
    print(f"{output.with_suffix('.1.png')} to {len(pictures)}: its maps")


def make(args):
    """The Page and its HTML. What `slope study` wrote is trusted to be of the right kind: if it is not, one line."""
    import jinja2
    try:
        page = Page(args)
        return page, render(page.content())
    except (jinja2.TemplateError, ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
        raise SlopeError(args.folder, "must hold what a run or `slope study` wrote, unchanged",
                         f"{type(error).__name__}: {error}"[:200]) from error


def render(content):
    """The page, from the template beside this file."""
    import jinja2
    loader = jinja2.FileSystemLoader(Path(__file__).parent)
    environment = jinja2.Environment(loader=loader, autoescape=True, trim_blocks=True, lstrip_blocks=True,
                                     undefined=jinja2.StrictUndefined)
    environment.filters.update(volume=lambda value: f"{value:,.0f}", percent=lambda value: f"{100 * value:.1f} %",
                               fixed=lambda value, digits=1: f"{value:,.{digits}f}")
    return environment.get_template("report.html.j2").render(content)


class Result:
    """A finished run, read back."""

    def __init__(self, folder, summary, row=None):
        self.folder, self.path = Path(folder), Path(summary)
        self.prefix = runs.prefix_of(summary)
        self.summary = runs.load_summary(summary)
        about, marker = (Path(folder) / name for name in (runs.VARIABLES, runs.MARKER))
        self.about = runs.load_yaml(about, "what `slope study` wrote") if about.is_file() else {}
        self.marker = runs.load_yaml(marker, "what `slope study` wrote") if marker.is_file() else {}
        self.log = runs.Log(find_log(self.folder)).update()
        self.row = row or {}
        self.name = self.row.get("run", self.prefix.name)
        terrain = self.log.terrain and self.folder / self.log.terrain
        self.terrain_path = terrain if terrain and terrain.is_file() else None
        self.deposit = deposit.read(self.prefix, self.terrain_path, lambda text: None)

    def raster(self, name):
        """Values of one of its rasters; they must have the deposit's grid."""
        raster = runs.load_raster(self.prefix, name)
        if raster.z.shape != self.deposit.raster.z.shape:
            raise SlopeError(f"{self.prefix}.{name}.asc", f"must have the grid of {self.prefix}.thickness.asc")
        return raster.z

    @property
    def thickness(self):
        return self.deposit.raster.z

    @property
    def surface(self):
        return self.deposit.base + self.thickness


def find_log(folder):
    """The log of a run: log.lammps, else the only log.* there is."""
    logs = sorted(path for path in Path(folder).glob("log.*") if path.name != "log.cite")
    usual = Path(folder) / runs.LOG
    return usual if usual in logs or len(logs) != 1 else logs[0]


def find_deck(result):
    """The deck of a run: the one that the study copied, else the only in.* there is; None if that is not clear."""
    named = result.about.get("deck")
    decks = [result.folder / str(named)] if named else sorted(result.folder.glob("in.*"))
    return decks[0] if len(decks) == 1 and decks[0].is_file() else None


class Page:
    """All that the page shows."""

    def __init__(self, args):
        self.args, self.folder = args, args.folder
        self.study = None
        self.rows = []
        if (self.folder / "study.yaml").is_file():
            self._read_study()
        else:
            self._read_single()
        self.warnings = []      # (red or amber, text)
        self.pictures = 0
        self._frame()
        self._warn()

    # --- reading ---

    def _read_study(self):
        from . import results
        path = self.folder / "study.yaml"
        self.study = results.read_study(path)
        self.rows = self.study["runs"]
        finished = [row for row in self.rows if row["status"] == "finished"]
        best = self.study["conservative"] or self.study["largest"]["front_m"]
        self.settings = self.study["study"]["set"]
        road = self.study["study"].get("road")
        names = [row["run"] for row in finished]
        shown = self.args.shown or best["run"]
        if shown not in names:
            raise SlopeError("--run", f"must be a finished run of {path}, such as {names[0]}", shown)
        self.finished = finished
        self.result = self._load(finished[names.index(shown)])
        # the runs that are drawn beside it: evenly spread if there are many
        others = names if len(names) <= MOST_SHOWN else [
            names[round(i * (len(names) - 1) / (MOST_SHOWN - 1))] for i in range(MOST_SHOWN)]
        if shown not in others:
            others[-1] = shown
        drawn = [self.result if name == shown else self._load(finished[names.index(name)]) for name in others]
        self.drawn = [one for one in drawn if same_grid(one, self.result)]
        self.road = None
        if road:
            from . import polygons
            self.road = polygons.read_local(self.folder / str(road["local"]), self.result.deposit.raster, True)
        # everything is read before anything is drawn: drawing takes a while
        self.over_all = {}
        if len(finished) > 1 and self.study.get("envelope"):
            for entry in (self.study["envelope"]["max_thickness"], *(self.study.get("exceedance") or ())):
                self.over_all[entry["file"]] = self._map(entry["file"])
        self.removed = self._removed() if road else None

    def _removed(self):
        """What `slope volume` says is to be removed: its thickness in the cells, and a Raster of volumes in a mesh."""
        found = []
        raster = self.result.deposit.raster
        for name in ("volume.tif", "volume_mesh.tif"):
            one = rasters.read(self.result.folder / "volume" / name, heights=False)
            east, north = raster.offset     # the files are in the CRS
            found.append(one._replace(transform=Affine.translation(-east, -north) * one.transform,
                                      z=np.nan_to_num(one.z)))
        if found[0].z.shape != raster.z.shape:
            raise SlopeError(self.result.folder / "volume" / "volume.tif",
                             f"must have the grid of {self.result.prefix}.thickness.asc")
        return found[0].z, found[1]

    def _load(self, row):
        path = self.folder / row["summary"]
        return Result(path.parent, path, row)

    def _read_single(self):
        if self.args.shown:
            raise SlopeError("--run", f"needs a study, with study.yaml, in {self.folder}", self.args.shown)
        found = runs.summaries(self.folder)
        if len(found) != 1:
            raise SlopeError(self.folder, "must be the folder of a study, with study.yaml, or of one run, with one "
                             "PREFIX.summary.yaml", f"{len(found)} summaries")
        self.result = Result(self.folder, found[0])
        self.drawn, self.finished, self.settings, self.road, self.removed = [self.result], [], {}, None, None

    # --- what the maps and the section share ---

    def _frame(self):
        from . import figures
        from .terrain import sample
        self.figures = figures
        one = self.result
        raster, base = one.deposit.raster, one.deposit.base
        rows, columns = base.shape
        x, y = raster.transform * np.meshgrid(np.arange(columns) + 0.5, np.arange(rows) + 0.5)
        self.terrain = rasters.read_asc_local(one.terrain_path) if one.terrain_path else None
        self.before = np.full(base.shape, np.nan)
        if self.terrain is not None:
            self.before = sample(self.terrain, x, y)
        self.before = np.where(np.isfinite(self.before), self.before, base)
        with np.errstate(invalid="ignore"):
            self.slip_depth = np.where(self.before - base > 0.01, self.before - base, 0)
        self.arrival, self.max_thickness = one.raster("arrival"), one.raster("max_thickness")
        self.max_speed = one.raster("max_speed")
        # balls larger than the cells leave holes between them
        side = (one.summary["volume"]["released"] / one.summary["balls"]["released"]) ** (1 / 3)
        self.release = closed(self.arrival == 0, math.ceil(side / one.deposit.cell / 2))
        touched = self.max_thickness > 0
        for other in self.drawn:
            touched |= other.thickness > 0
        if not touched.any():
            raise SlopeError(f"{one.prefix}.max_thickness.asc", "must have a cell that the mass ever touched")
        self.section = self._section_ends(x, y, touched)
        self.ground = self.before
        box = box_of(raster, touched)
        ends = (*self.section.min(axis=0), *self.section.max(axis=0))
        self.layers = figures.Layers(
            raster, self.ground, self.window(box, ends), self.release, self.road, self.section,
            figures.contour_interval(self.ground))

    def _section_ends(self, x, y, touched):
        """Ends of the section, west or south end first unless the user named them."""
        if self.args.section:
            ends = np.reshape(self.args.section, (2, 2)).astype(float)
            bounds = deposit.extent(self.result.deposit.raster)
            if not (np.minimum(*ends) < bounds[2:]).all() or not (np.maximum(*ends) > bounds[:2]).all():
                raise SlopeError("--section", f"must cross the grid of the run, {deposit.box(bounds)} (local metres)",
                                 " ".join(f"{value:g}" for value in self.args.section))
            return ends
        release = self.release if self.release.any() else touched
        weight = np.where(release, np.where(self.slip_depth > 0, self.slip_depth, 1e-3), 0)
        centre = np.array([(x * weight).sum(), (y * weight).sum()]) / weight.sum()
        cell = self.result.deposit.cell
        south, east = np.gradient(np.where(np.isfinite(self.before), self.before, np.nan), cell)
        steep = release & np.isfinite(south) & np.isfinite(east)
        way = np.array([-east[steep].mean(), south[steep].mean()]) if steep.any() else np.zeros(2)
        if np.hypot(*way) < 1e-3:       # no slope: to where the mass went
            volume = self.result.thickness
            way = np.array([(x * volume).sum(), (y * volume).sum()]) / max(volume.sum(), 1e-30) - centre
        way = way / np.hypot(*way) if np.hypot(*way) > 1e-6 else np.array([1.0, 0.0])
        if way[np.argmax(np.abs(way))] < 0:
            way = -way
        along = (x[touched] - centre[0]) * way[0] + (y[touched] - centre[1]) * way[1]
        room = 0.12 * np.ptp(along) + 2 * cell
        low, high = inside(centre, way, deposit.extent(self.result.deposit.raster))
        return np.array([centre + max(along.min() - room, low) * way, centre + min(along.max() + room, high) * way])

    def window(self, *boxes):
        """The part of the terrain that a map shows: the boxes and some room, at least as wide as is good to print."""
        from . import maps
        raster = self.result.deposit.raster
        xlo, ylo, xhi, yhi = maps.window(raster, *boxes)
        more = (yhi - ylo) / TALLEST - (xhi - xlo)
        whole = deposit.extent(raster)
        if more > 0:
            xlo, xhi = max(whole[0], xlo - more / 2), min(whole[2], xhi + more / 2)
        return xlo, ylo, xhi, yhi

    # --- warnings ---

    def _warn(self):
        add = self.warnings.append
        for row in self.rows:
            if row["status"] != "finished":
                add(("red", f"Run {row['run']} failed: {row.get('error')}"))
        summary = self.result.summary
        ends = [(self.label_of(row), row["moving"], row["stop_time_s"], row["moving_share"], row["released_m3"],
                 row["off_grid_m3"] + row["lost_m3"]) for row in self.finished]
        if not self.study:
            volume = summary["volume"]
            ends = [("", summary["moving"], summary["stop"]["time"], summary["motion"]["moving_share"],
                     volume["released"], volume["off_grid"] + volume["lost"])]
        moving = [(f"{name}: " if name else "") + f"{100 * share:.0f} % of the volume at {time:.1f} s"
                  for name, moves, time, share, _, _ in ends if moves]
        if moving:
            who = "The deposit still moves at the end of the run" if len(ends) == 1 else \
                f"{len(moving)} of {len(ends)} deposits still move at the end of the run"
            add(("red", f"{who}, faster than {summary['motion'].get('threshold', 0.1):g} m/s: {'; '.join(moving)}. "
                 "Such numbers are not those of a deposit at rest: let it run longer."))
        for name, _, _, _, released, left in ends:
            if left > SMALL * released:
                add(("amber", f"{name}{': ' if name else ''}{left:,.1f} m3 ({100 * left / released:.2g} % of the "
                     "released volume) left the grid or the box and are in no map"))
        if self.study:
            for doubt in (self.study["conservative"] or {}).get("doubts") or ():
                add(("amber", f"The conservative volume may be exceeded: {doubt}"))
            # what stands in other words here, or beside the maps
            told = (" failed: ", "still moves", "left the grid or the box", "has no CRS")
            for text in self.study.get("warnings") or ():
                if not any(known in text for known in told):
                    add(("amber", text))
        from_logs = {}
        if self.study:
            for row in self.rows:
                for text in row.get("log_warnings") or ():
                    from_logs.setdefault(text, []).append(self.label_of(row))
        else:
            from_logs = {text: [] for text in self.result.log.warnings}
        for text, names in from_logs.items():
            whose = ""
            if names:
                whose = " (all runs)" if len(names) == len(self.rows) else f" (runs: {'; '.join(names)})"
            add(("amber", f"LAMMPS: {text}{whose}"))

    # --- pictures ---

    def picture(self, uri, alt, caption):
        self.pictures += 1
        return {"uri": uri, "alt": alt, "caption": caption}

    def maps(self):
        """The maps of the shown run, by name."""
        figures, layers, one = self.figures, self.layers, self.result
        crs = layers.raster.crs
        name = crs_name(crs) if crs is not None else ""
        whole = deposit.extent(layers.raster)
        found = {"slip": None, "arrival": None}
        bounds = figures.classes(one.thickness.max())
        found["deposit"] = self.picture(
            figures.value_map(layers, one.thickness, "Thickness of the deposit at the end", "thickness (m)", bounds,
                              "YlOrBr", figures.FULL, name),
            "Map of the deposit's thickness at the end",
            f"Final thickness, {one.deposit.cell:g} m cells; less than {bounds[0]:g} m is not drawn."
            + ("" if not self.study else f" Run: {self.label(one)}."))
        found["terrain"] = self.picture(
            figures.terrain_map(layers._replace(shown=whole), layers.shown, name), "Map of the terrain before",
            "Terrain before the collapse, light from the north-west"
            + ("; the white frame is the part that the other maps show." if layers.shown != whole else "."))
        if self.slip_depth.max() > 0:
            found["slip"] = self.picture(
                figures.value_map(layers._replace(ground=one.deposit.base), self.slip_depth, "Slip surface",
                                  "depth below the ground (m)",
                                  figures.classes(self.slip_depth.max()), "PuBu"),
                "Map of the slip surface", "Depth of the slip surface below the ground before; relief and contours are "
                "those of the surface that stays.")
        bounds = figures.classes(self.max_thickness.max())
        found["max_thickness"] = self.picture(
            figures.value_map(layers, self.max_thickness, "Largest thickness in the run", "thickness (m)", bounds,
                              "YlOrBr"),
            "Map of the largest thickness", "Largest thickness that a cell ever had.")
        speed = self.max_speed
        found["speed"] = self.picture(
            figures.value_map(layers, speed, "Largest speed", "speed (m/s)", figures.even(speed.max()), "viridis_r",
                              mask=speed > 0),
            "Map of the largest speed", "Speed of the fastest ball that passed, sampled in the run.")
        known = self.arrival[np.isfinite(self.arrival)]
        if known.size and known.max() > 0:
            found["arrival"] = self.picture(
                figures.value_map(layers, self.arrival, "First arrival", "time (s)",
                                  figures.even_to_most(known[known > 0]), "YlGnBu",
                                  mask=np.isfinite(self.arrival) & ~self.release),
                "Map of the first arrival", "Time at which the first ball arrived.")
        return found

    def removal(self):
        """Map of what `slope volume` says is to be removed, as the paper's Figure 15; None if that is nothing."""
        if self.removed is None or not self.removed[0].max() > 0:
            return None
        removed, mesh = self.removed
        crs = self.layers.raster.crs
        layers = self.layers._replace(shown=self.window(box_of(self.layers.raster, removed > 0)))
        road = self.study["study"]["road"]
        return self.picture(
            self.figures.mesh_map(layers, removed, mesh, "Volume to remove", crs_name(crs) if crs is not None else ""),
            "Map of the volume to remove", f"Thickness of what lies on the road and above a cut rising at "
            f"{road['cut_angle']:g} degrees from its edges, and its volume in m3 in squares of {mesh.transform.a:g} m; "
            f"together {self.result.row['remove_m3']:,.0f} m3; run: {self.label(self.result)}. Compare the paper's "
            "Figure 15.")

    def maps_over_all(self):
        """Maps of a study over all of its runs."""
        figures, layers = self.figures, self.layers._replace(section=None)
        found = {"runs": None, "envelope": None, "exceedance": []}
        if not self.study or len(self.finished) < 2:
            return found
        if len(self.drawn) > 1:
            top = max(one.thickness.max() for one in self.drawn)
            bounds = figures.classes(top)
            some = "" if len(self.drawn) == len(self.finished) else \
                f" {len(self.drawn)} of the {len(self.finished)} runs are shown."
            found["runs"] = self.picture(
                figures.small_maps(layers, [(self.label(one), one.thickness) for one in self.drawn], "thickness (m)",
                                   bounds, "YlOrBr"),
                "Final thickness of the runs", "Final thickness of the runs; compare the paper's Figure 14." + some)
        envelope = self.study.get("envelope")
        if envelope:
            values = self.over_all[envelope["max_thickness"]["file"]]
            found["envelope"] = self.picture(
                figures.value_map(layers, values, "Envelope of all runs", "thickness (m)",
                                  figures.classes(np.nanmax(values)), "YlOrBr"),
                "Envelope", f"Largest thickness over all {len(self.finished)} runs and all times.")
        for entry in self.study.get("exceedance") or ():
            values = self.over_all[entry["file"]]
            found["exceedance"].append(self.picture(
                figures.value_map(layers, values, f"Thicker than {entry['threshold_m']:g} m", "share of the runs",
                                  [0.0, 0.2, 0.4, 0.6, 0.8, 1.0], "RdPu", mask=values > 0),
                f"Share of the runs thicker than {entry['threshold_m']:g} m",
                f"Share of the {len(self.finished)} runs with a final thickness > {entry['threshold_m']:g} m: in every "
                f"run on {entry['area_in_every_run_m2']:,.0f} m2, in any run on "
                f"{entry['area_in_any_run_m2']:,.0f} m2."))
        return found

    def _map(self, name):
        path = self.folder / str(name)
        raster = rasters.read_asc_local(path)
        if raster.z.shape != self.result.thickness.shape:
            raise SlopeError(path, f"must have the grid of {self.result.prefix}.thickness.asc")
        return np.where(np.isfinite(raster.z), raster.z, 0)

    def label(self, one):
        """A short name of a run: the values that differ in the study."""
        return self.label_of(one.row) if self.study else one.name

    def label_of(self, row):
        varied = [f"{name} {value}" for name, value in row["set"].items() if len(self.settings.get(name) or ()) > 1]
        return ", ".join(varied) or row["run"]

    def profile(self):
        """Distance, x, y along the section and, at the same points, ground before, base, and (name, surface,

        thickness) of every drawn run, the shown one first.
        """
        from .terrain import sample
        raster, cell = self.layers.raster, self.result.deposit.cell
        start, end = self.section
        length = np.hypot(*(end - start))
        count = min(max(int(math.ceil(2 * length / cell)), 50), 2000) + 1
        s = np.linspace(0, length, count)
        x, y = (start[:, None] + (end - start)[:, None] * np.linspace(0, 1, count))

        def along(values):
            return sample(raster._replace(z=values), x, y)

        base = along(self.result.deposit.base)
        known = np.flatnonzero(np.isfinite(base))
        if not len(known):
            raise SlopeError("--section", "must cross cells whose ground is known")
        part = slice(known[0], known[-1] + 1)       # ends without ground are left out
        s, x, y, base = s[part], x[part], y[part], base[part]
        drawn = sorted(self.drawn, key=lambda one: one is not self.result)
        lines = []
        for one in drawn:
            thickness = np.nan_to_num(along(one.thickness))
            lines.append((self.label(one), along(one.deposit.base) + thickness, thickness))
        return s, x, y, along(self.before), base, lines

    def section_picture(self):
        s, x, y, before, base, lines = self.lines = self.profile()
        road, cut = [], None
        if self.road is not None:
            road, cut = self._road_on(s, x, y)
        uri, exaggeration = self.figures.section(s, before, base, lines, road, cut, "Section A-A'")
        (x1, y1), (x2, y2) = self.section
        how = "as --section asked" if self.args.section else \
            "through the centroid of the released mass, along its mean fall line"
        return self.picture(uri, "Section through the slope before and after",
                            f"Section from A ({x1:.1f}, {y1:.1f}) to A' ({x2:.1f}, {y2:.1f}), local metres, {how}; "
                            + ("heights not exaggerated" if exaggeration == 1 else
                               f"heights exaggerated {exaggeration:g} times")
                            + (f"; cut surface rising at {self.study['study']['road']['cut_angle']:g} degrees from the "
                               "road's edges" if cut is not None else "") + ". Compare the paper's Figure 12.")

    def _road_on(self, s, x, y):
        """Where the section crosses the road, list of (from, to), and the cut above it at every point."""
        from shapely.geometry import LineString, Point
        from shapely.ops import nearest_points
        from . import volume
        line = LineString(self.section)
        spans = []
        for part in volume.lines_of(line.intersection(self.road)).geoms:
            spans.append(sorted(line.project(Point(end)) for end in (part.coords[0], part.coords[-1])))
        from .terrain import sample
        base = self.layers.raster._replace(z=self.result.deposit.base)
        tangent = math.tan(math.radians(self.study["study"]["road"]["cut_angle"]))
        edge = self.road.boundary
        cut = np.full(s.shape, np.nan)
        for i, (px, py) in enumerate(zip(x, y)):
            point = Point(px, py)
            if self.road.contains(point):
                continue
            near = nearest_points(edge, point)[0]
            cut[i] = sample(base, np.array([near.x]), np.array([near.y]))[0] + tangent * near.distance(point)
        return spans, cut

    def section_table(self):
        """The section as CSV."""
        s, x, y, before, base, lines = self.lines
        east, north = self.layers.raster.offset
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        head = ["distance", "x", "y"] + (["east", "north"] if self.layers.raster.crs is not None else [])
        writer.writerow(head + ["ground_before", "base"]
                        + [f"{what} {name}" for name, *_ in lines for what in ("surface", "thickness")])
        for i in range(len(s)):
            values = [s[i], x[i], y[i]] + ([x[i] + east, y[i] + north] if len(head) > 3 else [])
            values += [before[i], base[i]] + [value for _, surface, thickness in lines
                                              for value in (surface[i], thickness[i])]
            writer.writerow("" if math.isnan(value) else f"{value:.4f}" for value in values)
        return text.getvalue()

    def charts(self):
        """The study's values against the first variable that it varies."""
        figures = self.figures
        if not self.study or len(self.finished) < 2:
            return []
        road = "remove_m3" in self.finished[0]
        wanted = [("remove_m3", "volume to remove (m3)", "Volume to remove from the road")] if road else []
        wanted += [("front_m", "front (m)", "Distance of the front"),
                   ("thickness_m", "thickness (m)", "Largest thickness at the end")]
        varied = [name for name, several in self.settings.items()
                  if len(several) > 1 and all(is_number(value) for value in several)]
        if not varied:
            names = [self.label_of(row) for row in self.finished]
            return [self.picture(figures.bars(names, [row[key] for row in self.finished], label, title), title,
                                 f"{title} of every run.") for key, label, title in wanted]
        name = "rolling" if "rolling" in varied else varied[0]
        series = {}
        for row in self.finished:
            rest = ", ".join(f"{other} {row['set'][other]}" for other, several in self.settings.items()
                             if other != name and len(several) > 1)
            series.setdefault(rest, []).append(row)
        found = []
        for key, label, title in wanted:
            lines = []
            for rest, rows in series.items():
                rows = sorted(rows, key=lambda row: float(row["set"][name]))
                lines.append((rest or ("this study" if self.paper and key == "remove_m3" else ""),
                              [float(row["set"][name]) for row in rows], [row[key] for row in rows]))
            others, level, mark, caption = (), None, None, f"{title} against {name}."
            if key == "remove_m3":
                best = max(self.finished, key=lambda row: row[key])
                mark = float(best["set"][name]), best[key], f"{best[key]:,.0f} m3"
                caption = f"{title} against {name}; ringed: the conservative volume."
                if self.paper:
                    others = [(f"paper, {who}", PAPER["rolling"], PAPER[who]) for who in ("company J", "company I")]
                    level = (f"paper, actual damage {ACTUAL:,} m3", ACTUAL)
                    caption += (" Grey: the second Table 5 of the paper, whose site is another one: they are shown for "
                                "the trend and the order of magnitude.")
            found.append(self.picture(figures.chart(lines, AXIS.get(name, name), label, title, others, level, mark,
                                                    figures.WIDE if key == "remove_m3" else figures.HALF),
                                      title, caption))
        return found

    @property
    def paper(self):
        """Whether the paper's numbers belong beside this study: volumes to remove against the rolling resistance."""
        return bool(self.study and self.study["conservative"] and not self.args.no_paper
                    and len(self.settings.get("rolling") or ()) > 1)

    # --- the page ---

    def content(self):
        one = self.result
        deck = find_deck(one)
        text = deck.read_text(encoding="utf-8", errors="replace") if deck else ""
        # the head of a deck: purpose; expected result and run time are for those who run it
        purpose = re.match(r"(?:#(?! *(?:Expected|Run time)).*\n)+", text)
        name = (self.study["study"]["deck"] if self.study else deck.name if deck else one.prefix.name)
        summary = one.summary
        variables = self.study and one.row.get("variables") or one.about.get("variables") or runs_variables(deck)
        raster = self.layers.raster
        sources = []
        if deck:
            digests = one.marker.get("inputs") or {}
            sources = [{"name": file, "sha256": digest} for file, digest in digests.items()]
        content = {
            "title": f"Slope collapse: {'study' if self.study else 'run'} of {name}", "deck_name": name,
            "purpose": " ".join(line.lstrip("# ") for line in purpose[0].splitlines()) if purpose else "",
            "made": runs.now(), "study": self.study, "rows": self.rows, "settings": self.settings,
            "varied": [key for key, several in self.settings.items() if len(several) > 1],
            "road": self.study["study"].get("road") if self.study else None,
            "conservative": self.study["conservative"] if self.study else None,
            "summary": summary, "one": one, "label": self.label(one), "single": not self.study,
            "labels": {row["run"]: self.label_of(row) for row in self.finished},
            "released": sorted({round(row["released_m3"], 3) for row in self.finished}
                               or {summary["volume"]["released"]}),
            "finished": self.finished, "warnings": self.warnings, "maps": self.maps(),
            "removal": self.removal(),
            "over_all": self.maps_over_all(), "charts": self.charts(), "section": self.section_picture(),
            "paper": PAPER if self.paper else None, "actual": ACTUAL,
            "variables": variables or {}, "deck": text, "sources": sources,
            "settings_lines": one.log.settings, "notes": one.log.notes, "table": "\n".join(one.log.table),
            "mass_error": (one.deposit.volume - summary["volume"]["released"] + summary["volume"]["off_grid"]
                           + summary["volume"]["lost"]) / summary["volume"]["released"],
            "place": {"crs": crs_name(raster.crs), "east": raster.offset[0], "north": raster.offset[1]}
            if raster.crs is not None else None,
            "machine": one.marker.get("machine"), "here": runs.machine(), "package": one.about.get("package"),
            "packages": sorted({str(row.get("package")) for row in self.finished}),
            "command": one.about.get("command"), "wall": one.marker.get("wall_seconds"),
            "started": one.about.get("started"), "ended": one.marker.get("finished"),
            "lmp_sha256": one.about.get("lmp_sha256"),
        }
        return content


AXIS = {"rolling": "rolling resistance (-)", "friction": "friction angle (degrees)", "restitution": "restitution (-)",
        "d": "diameter of the balls (m)"}


def runs_variables(deck):
    """Index variables of a deck that ran by hand: its defaults, marked as such."""
    return {f"{name} (deck's default)": value for name, value in runs.index_variables(deck).items()} if deck else {}


def is_number(text):
    try:
        return math.isfinite(float(text))
    except ValueError:
        return False


def closed(mask, cells):
    """The mask with gaps of up to 2 x cells filled: grown by so many cells, and shrunk again."""
    mask = np.pad(mask, cells)
    for _ in range(2):
        grown = mask.copy()
        for down in range(-cells, cells + 1):
            for right in range(-cells, cells + 1):
                grown |= np.roll(mask, (down, right), (0, 1))
        mask = ~grown
    return mask[cells:-cells, cells:-cells]


def same_grid(one, other):
    return (one.thickness.shape == other.thickness.shape
            and one.deposit.raster.transform.almost_equals(other.deposit.raster.transform))


def box_of(raster, mask):
    """Local xlo, ylo, xhi, yhi of the cells of a mask."""
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    xlo, yhi = raster.transform * (columns[0], rows[0])
    xhi, ylo = raster.transform * (columns[-1] + 1, rows[-1] + 1)
    return xlo, ylo, xhi, yhi


def inside(point, way, bounds):
    """Range of t for which point + t way lies within bounds; the point does."""
    low, high = -math.inf, math.inf
    for value, step, least, most in zip(point, way, bounds[:2], bounds[2:]):
        if abs(step) > 1e-12:
            ends = sorted(((least - value) / step, (most - value) / step))
            low, high = max(low, ends[0]), min(high, ends[1])
    return low, high
