"""The warnings of a site: slope site prints the heaviest, and keeps all in the folder for the report."""
import math
from pathlib import Path
from typing import Dict, List, Mapping, Optional, Sequence

import numpy as np
import yaml
from shapely.geometry import MultiPoint
from shapely.geometry.base import BaseGeometry

from .. import disk
from ..digits import at_most, three
from ..errors import SlopeError
from ..finding_words import words_of
from ..findings import WARNING, Finding, encode_findings, finding
from ..releases.release_solve import Measures
from .site_budget import Size, Trial
from .site_found import Body
from .site_inputs import Structure
from .site_sections import Choices, OfMass, Structures
from .site_zones import Zone

NAME = "warnings.yaml"
ROUGH = 3.0             # balls, mean thickness of the body: below, the numbers are rough
THICK = 10.0            # balls, largest thickness: below, a site should be repeated with more balls
OF_THICKNESS = "thin", "first look"
MOST = 3                # warnings that are shown before the numbers
# kinds by what they do to the number, the heaviest first: it may be another ground, another body, another run, or rough
HEAVIEST = ("in feet", "no ground's slope", "cliff", "picture", "pits", "no such cell", "swapped", "tiles differ",
            "step between tiles", "shift", "stretched", "CRS of terrain", "datums",
            "in a pit", "no way out", "hollow", "above ground", "no body", "little", "road on body", "under road",
            "beyond toe", "motion across", "bulges", "unknown inside", "rim", "parts", "own depth", "shared",
            "unused depth",
            "small angle", "large rolling", "narrow road", "high wall", "low wall", "left terrain", "outside",
            "not at rest",
            "zone covered", "zones overlap", "several bodies", "second opinion",
            "blocks on level ground", "thin", "few across", "few cells")
NAMES = "{file}:", "{name}:"        # with which the words of a kind begin that is of one object
LARGE = 1e6             # m3: larger masses run farther than laboratory friction suggests
LOST = 0.001            # share of the mass that may leave the terrain
LEAST_CELLS = 2         # across a road
ACROSS = 10.0           # cells across a body
COEFFICIENT = 3.0       # degrees: smaller angles of friction, or of a cut, may be meant as tangents
ROLLS_NOT = 1.0         # larger coefficients of rolling resistance may be meant as angles or percents
HIGH = 50.0             # m: walls are rarely higher
STEEP = 65.0            # degrees; tried: some faces of balls stand at 60, none at 70 and 80, whatever their friction
# what a run says whose body falls while it settles
FALLS = ("does not stand before it is shaken", "Lost atoms", "must be the body that the balls fill")


def site_warnings(measures: Measures, size: Size, trial: Optional[Trial]) -> List[Finding]:
    """Warnings on a body and its balls; trial: None where there is no LAMMPS program."""
    return [*of_trial(trial), *of_volume(measures.volume),
            *of_thickness(measures.mean_depth / size.finest, measures.largest_depth / size.finest)]


def of_trial(trial: Optional[Trial]) -> List[Finding]:
    """What the trial run showed."""
    if trial is None:
        return [Finding("no program")]
    lines = []
    if trial.left > LOST:
        lines.append(Finding("left terrain", {"percent": 100 * trial.left}))
    if not trial.at_rest:
        lines.append(Finding("not at rest", {"seconds": trial.rest}))
    return lines


def of_volume(volume: float) -> List[Finding]:
    """Whether the default friction can be that of so large a mass (m3)."""
    if volume < LARGE:
        return []
    return [Finding("large", {"millions": volume / 1e6, "limit": LARGE / 1e6})]


def of_resistance(choices: Choices) -> List[Finding]:
    """Angles that look like coefficients, and coefficients that look like angles or percents."""
    angles = {"--friction": choices.model.friction}
    if isinstance(choices, OfMass):
        angles["--slip-friction"] = choices.model.slip_friction
        if choices.road.file:
            angles["--cut-angle"] = choices.road.cut_angle
    return [*of_angles(angles), *of_rolling("--rolling", *choices.study.rolling)]


def of_zones(zones: Sequence[Zone]) -> List[Finding]:
    """The same of the zones of the ground."""
    return [one for zone in zones for one in (
        *of_angles({f"friction of zone {zone.name}": zone.values.get("friction", 0.0)}),
        *of_rolling(f"rolling of zone {zone.name}", zone.values.get("rolling", 0.0)))]


def of_rolling(option: str, *values: float) -> List[Finding]:
    """Coefficients of rolling resistance that look like angles or percents."""
    return [Finding("large rolling", {"option": option, "rolling": value, "limit": ROLLS_NOT})
            for value in values if value > ROLLS_NOT]


def of_angles(angles: Mapping[str, float]) -> List[Finding]:
    """Angles (degrees, by their options) that look like coefficients."""
    return [Finding("small angle", {"option": option, "degrees": value, "meant": math.degrees(math.atan(value))})
            for option, value in angles.items() if 0 < value < COEFFICIENT]


def thickness_at(body: Optional[Body], finest: float, findings: Sequence[Finding]) -> List[Finding]:
    """The findings of a site with those on the thickness of its body as balls of that diameter (m) have it."""
    if not body or body.mean_depth is None or body.largest_depth is None:
        return list(findings)
    return [*of_thickness(body.mean_depth / finest, body.largest_depth / finest),
            *(one for one in findings if one.kind not in OF_THICKNESS)]


def of_thickness(mean: float, largest: float) -> List[Finding]:
    """Whether the body is thick enough; mean and largest thickness in the finest balls."""
    if mean < ROUGH:
        return [Finding("thin", {"balls": mean, "limit": ROUGH})]
    if largest < THICK:
        return [Finding("first look", {"balls": largest, "limit": THICK})]
    return []


def check_road_resolution(road: Optional[BaseGeometry], width: Optional[float], d: float, cell: float,
                          name="road") -> List[Finding]:
    """Whether balls (d, m) and cells (m) are small enough for a road; width: of a line, m; name: of the road."""
    if road is None:
        return []
    wide = width or 2 * road.area / road.length         # of a strip, whose ends hardly count
    if wide >= max(d, LEAST_CELLS * cell):
        return []
    remedy = [smaller(d, wide)] * (wide < d)
    remedy += ["a finer elevation model, or a smaller model.cell"] * (wide < LEAST_CELLS * cell)
    return [Finding("narrow road", {"file": name, "width": wide, "d": d, "balls": wide / d, "cell": cell,
                                    "cells": wide / cell, "remedy": " and ".join(remedy)})]


def of_walls(structures: Sequence[Structure], d: float, asked: Structures = Structures()) -> List[Finding]:
    """Structures that are not as high above the ground as a ball (d, m), and walls of a height that is none."""
    high = [Finding("high wall", {"height": asked.height, "limit": HIGH})] if asked.walls and (
        asked.height or 0) > HIGH else []
    return high + [Finding("low wall", {"name": one.name, "height": one.above, "d": d,
                                        "remedy": smaller(d, one.above)}) for one in structures if 0 < one.above < d]


def smaller(d: float, most: float) -> str:
    """Balls of at most so many metres instead of d, and what they take: more of them, and smaller steps."""
    size = at_most(most, 2)
    return f"smaller balls (--diameter {size}, about {three((d / float(size)) ** 4)} times the minutes)"


def of_cells(depth: np.ndarray, cell: float, surveyed: float) -> List[Finding]:
    """Whether the elevation model is fine enough for a body: its depth (m) on cells (m), that may have been surveyed as
    larger ones."""
    row, column = np.nonzero(np.nan_to_num(depth) > 0)
    around = np.array(MultiPoint(np.column_stack([column, row])).buffer(0.5).minimum_rotated_rectangle.exterior.coords)
    size = max(cell, surveyed)
    across = float(np.hypot(*np.diff(around, axis=0).T).min()) * cell / size
    return [Finding("few across", {"across": across, "cell": size, "limit": ACROSS})] if across < ACROSS else []


def require_standing(error: SlopeError, peak_friction: float, slope: float) -> None:
    """Raise SlopeError with what can be done if a trial run failed because the body does not stand before it is shaken.

    peak_friction and slope (of the ground of the body) in degrees.
    """
    if not any(words in str(error) for words in FALLS):
        return
    alone = ("leave out --motion (motion.file: null in site.yaml), the body then fails by the loss of its strength "
             "alone")
    if slope >= STEEP:
        raise SlopeError("--motion", "the body must stand before it is shaken, but a face of spheres as steep as this "
                         f"one stands at no --peak-friction: {alone}", f"{slope:.0f} degrees") from None
    raise SlopeError("--peak-friction", "must hold the body before it is shaken: try a larger one, up to 80, or a "
                     f"thinner body; or {alone}", f"{peak_friction:g}") from None


def heaviest(several: Sequence[Finding]) -> List[Finding]:
    """The warnings that weigh most, one for all objects of which the same is said: with the numbers of the first."""
    groups: Dict[str, List[Finding]] = {}
    for warning in several:
        if warning.level == WARNING:
            groups.setdefault(warning.kind if words_of(warning.kind).text.startswith(NAMES) else str(warning),
                              []).append(warning)
    merged = []
    for first, *others in groups.values():
        numbers = dict(first.numbers)
        if key := next((name for name in ("file", "name") if name in numbers), None) if others else None:
            numbers[key] = ", ".join(dict.fromkeys(str(one.numbers[key]) for one in (first, *others)))
        merged.append(first._replace(numbers=numbers))
    return sorted(merged, key=lambda warning: HEAVIEST.index(warning.kind) if warning.kind in HEAVIEST
                  else len(HEAVIEST))[:MOST]


def add(folder: Path, several: Sequence[Finding]) -> None:
    """More of them, to those in a site's folder."""
    path = folder / NAME
    write_site_warnings(folder, [finding(one) for one in [*yaml.safe_load(path.read_text(encoding="utf-8")), *several]])


def write_site_warnings(folder: Path, several: Sequence[Finding]) -> None:
    """All warnings of a site into its folder: a YAML list, empty if there are none."""
    about = "# slope site: what makes this site doubtful\n"
    disk.write_file(folder / NAME, about + yaml.safe_dump(encode_findings(several), allow_unicode=True,
                                                          sort_keys=False))
