"""The maps of a report: of the shown run, and over all runs of a study."""
from pathlib import Path
from typing import Any, Dict

import numpy as np

from .. import digits, geometry
from ..drawing import figures, palettes
from ..plots import figure_maps, known_reach
from ..sites import site_zones
from ..sites.site_found import Found
from ..survey.rasters import crs_name
from . import ensemble_part, heading, mobility_part
from .data import Data
from .numbers import shown_run
from .run_part import titled
from .sections import Figures, Picture, Section, Text

OPEN = " The last class is open: it holds the few thicker cells, most of them in the release."


def zones_of(data: Data, raster) -> Dict[str, Any]:
    """Polygons of the zones of a site's ground, by name."""
    zones, path = Found.of(data.site).zones, heading.site_file(Path(data.folder))
    return site_zones.outlines(path.parent, zones, raster) if zones and path else {}


def square(area: float) -> str:
    return digits.three(area) if area else "0"


class Maps:
    """Draws maps."""

    def __init__(self, data: Data, ground, section):
        self.data, self.ground = data, ground
        line = section.points
        self.layers = figure_maps.Layers(
            ground.raster, ground.before,
            ground.window(*ground.boxes(), (*line.min(axis=0), *line.max(axis=0))),
            ground.release, data.road, line, figures.contour_interval(ground.before), ground.obstacles.footprints,
            ground.obstacles.lines, ground.reach, mobility_part.find_mobility_shape(data),
            zones_of(data, ground.raster))

    def thickness(self, values, title, alt, caption, width=figures.HALF, layers=None):
        """A map of a thickness, in classes that the release does not set."""
        bounds = self.classes(values)
        more = f" Less than {bounds[0]:g} m is not drawn."
        if len(bounds) > 2 and bounds[-1] > 2 * bounds[-2]:
            more += OPEN
        return Picture(
            figure_maps.value_map(layers or self.layers, values, title, "thickness (m)", bounds, palettes.THICKNESS,
                                  width), alt, caption + more)

    def classes(self, values):
        return figures.classes_of(values, self.ground.source)

    def of_run(self):
        """The maps of the shown run, by name."""
        data, ground, layers, one = self.data, self.ground, self.layers, self.data.result
        whole = geometry.extent(layers.raster)
        pictures: Dict[str, Any] = {"slip": None, "speed": None, "arrival": None}
        pictures["deposit"] = self.thickness(
            one.thickness, "Thickness of the deposit at the end", "Map of the deposit's thickness at the end",
            f"Final thickness, {digits.three(one.deposit.cell)} m cells."
            + shown_run(data) + known_reach.describe_known_reach(ground.reach) + self.outlines(), figures.FULL,
            self.with_outlines())
        pictures["terrain"] = Picture(
            figure_maps.terrain_map(layers._replace(shown=whole), layers.shown), "Map of the terrain before",
            "Terrain before the collapse, light from the north-west"
            + ("; the black frame is the part that the other maps show." if layers.shown != whole else "."))
        if ground.slip_depth.max() > 0:
            pictures["slip"] = Picture(
                figure_maps.value_map(layers._replace(ground=ground.base), ground.slip_depth, "Slip surface",
                                      "depth below the ground (m)", figures.classes_of(ground.slip_depth),
                                      palettes.DEPTH),
                "Map of the slip surface", "Depth of the slip surface below the ground before the collapse; relief and "
                "contours are those of the ground without the body.")
        pictures["max_thickness"] = self.thickness(
            ground.max_thickness, "Largest thickness in the run", "Map of the largest thickness",
            "Largest thickness that a cell ever had.")
        speed = ground.max_speed
        if (speed > 0).any():
            pictures["speed"] = Picture(
                figure_maps.value_map(layers, speed, "Largest speed", "speed (m/s)",
                                      figures.even_to_most(speed[speed > 0]), palettes.SPEED, mask=speed > 0),
                "Map of the largest speed", "Speed of the fastest ball that passed, sampled in the run.")
        known = ground.arrival[np.isfinite(ground.arrival)]
        if known.size and known.max() > 0:
            pictures["arrival"] = Picture(
                figure_maps.value_map(layers, ground.arrival, "First arrival", "time (s)",
                                      figures.even_to_most(known[known > 0]), palettes.ARRIVAL,
                                      mask=np.isfinite(ground.arrival) & ~ground.release),
                "Map of the first arrival", "Time at which the first ball arrived.")
        return pictures

    def with_outlines(self):
        """The layers with what an ensemble exceeds, and a window that shows it."""
        exceeded = ensemble_part.exceeded(self.data)
        if exceeded is None:
            return self.layers
        xlo, ylo, xhi, yhi = self.layers.shown
        far = geometry.extent_of(self.layers.raster.transform, exceeded.share > min(exceeded.drawn, default=1.0))
        boxes = [(xlo, ylo, xhi, yhi), *([far] if exceeded.drawn else [])]
        return self.layers._replace(exceeded=exceeded, shown=(
            *np.min(boxes, axis=0)[:2], *np.max(boxes, axis=0)[2:]))

    def outlines(self) -> str:
        """What these lines are."""
        exceeded = ensemble_part.exceeded(self.data)
        if not (exceeded and exceeded.drawn):
            return ""
        shares = " and ".join(f"{100 * one:g} %" for one in exceeded.drawn)
        beyond = f"; {digits.percent(exceeded.far)} go beyond all runs" if exceeded.far else ""
        if exceeded.short:
            beyond += f"; {digits.percent(exceeded.short)} end before all runs, and count as the shortest"
        return (f" Black lines: where the deposit is thicker than {exceeded.thick:g} m in {shares} of {exceeded.whom}"
                f"{beyond}.")

    def section(self, of_run):
        """The section of the maps of the shown run."""
        crs, offset = self.ground.raster.crs, self.ground.raster.offset
        east, north = (f"local {axis} {'-' if by < 0 else '+'} {abs(by):,.10g}" for axis, by in zip("xy", offset)) \
            if crs is not None else ("", "")
        return Section("maps", titled("Maps", self.data), [
            Figures([of_run["terrain"]], "tall"),
            Figures([of_run[name] for name in ("slip", "max_thickness", "speed", "arrival")], "columns"),
            Text("The terrain has no coordinate reference system: coordinates are the local metres of the run."
                 if crs is None else f"Coordinate system {crs_name(crs)}: east = {east}, north = {north}.", "soft")])

    def removal(self, volume):
        """Map of what `slope volume` says is to be removed; None if that is nothing. volume: of the run, as text."""
        data = self.data
        if data.removed is None or not data.removed[0].max() > 0:
            return None
        removed, mesh = data.removed
        shown = self.ground.window(geometry.extent_of(self.layers.raster.transform, removed > 0))
        layers = self.layers._replace(shown=shown, reach=known_reach.NOTHING)
        road = data.of_study.study.the_road
        uri, numbered = figure_maps.mesh_map(layers, removed, mesh, "Volume to remove")
        squares = f", and its volume in m3 in squares of {mesh.transform.a:g} m" if numbered else ""
        more = "" if numbered else (f" The volumes in squares of {mesh.transform.a:g} m are too many to be read here: "
                                    "they are in volume/volume.csv and volume.geojson of the run.")
        return Picture(
            uri, "Map of the volume to remove",
            "Thickness of the deposit on the road, and beside it above a cut rising at "
            f"{road['cut_angle']:g} degrees from its edges{squares}; together {volume} m3; run: "
            f"{data.label(data.result)}.{more}")

    def over_all(self):
        """Maps of a study over all of its runs."""
        data, layers = self.data, self.layers._replace(section=None)
        pictures: Dict[str, Any] = {"runs": None, "envelope": None, "exceedance": []}
        if not data.study or len(data.finished) < 2:
            return pictures
        if len(data.drawn) > 1:
            some = "" if len(data.drawn) == len(data.finished) else \
                f" {len(data.drawn)} of the {len(data.finished)} runs are shown."
            bounds = figures.classes_of(np.array([one.thickness for one in data.drawn]),
                                        np.array([self.ground.source] * len(data.drawn)))
            pictures["runs"] = Picture(
                figure_maps.small_maps(layers, [(data.label(one), one.thickness) for one in data.drawn],
                                       "thickness (m)", bounds, palettes.THICKNESS),
                "Final thickness of the runs", "Final thickness of the runs." + some)
        envelope = data.study.envelope
        if envelope:
            pictures["envelope"] = self.thickness(
                data.over_all[envelope["max_thickness"]["file"]], "Envelope of all runs", "Envelope",
                f"Largest thickness over all {len(data.finished)} runs and all times.", layers=layers)
        volume, balls = data.result.summary["volume"]["released"], data.result.summary["balls"]["released"]
        side = (volume / balls) ** (1 / 3)
        for entry in data.study.exceedance or ():
            if entry["file"] not in data.over_all:
                continue
            values = data.over_all[entry["file"]]
            single = f" One ball of the model, a cube of {digits.rounded(side, 2)} m, is much thicker than that." \
                if side > 10 * entry["threshold_m"] else ""
            pictures["exceedance"].append(Picture(
                figure_maps.value_map(layers, values, f"Thicker than {entry['threshold_m']:g} m", "share of the runs",
                                      [0.0, 0.2, 0.4, 0.6, 0.8, 1.0], palettes.SHARE, mask=values > 0),
                f"Share of the runs thicker than {entry['threshold_m']:g} m",
                f"Share of the {len(data.finished)} runs with a final thickness > {entry['threshold_m']:g} m: in every "
                f"run on {square(entry['area_in_every_run_m2'])} m2, in any run on "
                f"{square(entry['area_in_any_run_m2'])} m2.{single}"))
        return pictures
