"""A site's folder: terrain, body, layers, deck, map and site.yaml; all of it or nothing.

Order of the work: terrain and body (survey), layers (site_inputs), trial run and size of the balls (site_budget), deck
(site_deck), map (site_map), site.yaml (site_choices). It is built in a folder of its own; then its files take their
places (site_folder).
"""
import contextlib
import os
import shutil
from dataclasses import replace
from pathlib import Path
from shlex import quote
from typing import Any, Callable, Dict, List, Mapping, NamedTuple, Optional, Tuple

import numpy as np

from .. import disk, geometry, provenance
from ..case import decks, settings
from ..digits import rounded
from ..errors import SlopeError
from ..findings import Finding, keeper
from ..quakes import motion_file
from ..releases import release, release_files, release_toe
from ..survey import local_terrain, polygons, rasters
from ..survey.rasters import Raster, crs_name
from . import (site_bodies, site_budget, site_choices, site_deck, site_folder, site_inputs, site_layers, site_trial,
               site_warnings)
from .site_budget import Size, Trial
from .site_choices import Derived
from .site_folder import BODY, BODY_DECK, MAP, TERRAIN
from .site_layers import Layers, Shown, advice, read_layers, swapped
from .site_sections import Choices, MassModel, OfMass
from .site_trial import Tried


class Machine(NamedTuple):
    """With what a site is tried, and its study will run."""
    lmp: Optional[Path]     # None: there is none, nothing is tried
    jobs: int               # runs at a time


class Made(NamedTuple):
    """What was made."""
    folder: Path
    files: List[str]


def check_target(folder: Path, again: bool) -> None:
    """Raise SlopeError unless a site can be made in a folder; again: rebuilt from its own site.yaml."""
    if not folder.absolute().parent.is_dir():
        raise SlopeError("-o", "must be in an existing folder", folder)
    if again:
        deck = folder / site_deck.NAME
        known = site_choices.found(folder).deck_sha256
        if deck.is_file() and known != disk.sha256(deck):
            raise SlopeError(deck, "must not have been changed by hand, the changes would be lost: rename or remove it "
                             "first")
    elif site_folder.was_not_made(folder):
        return
    elif (folder / site_choices.NAME).is_file():
        raise SlopeError("-o", f"must be a new folder; `slope site {quote(str(folder))}` rebuilds this one from its "
                         f"{site_choices.NAME}", folder)
    elif folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise SlopeError("-o", "must be a new folder, or an empty one", folder)


Draw = Callable[[Path, Shown, str], None]       # of the map: file, what it shows, title
Build = Callable[..., Made]     # arguments of build()


def make_site(choices: Choices, folder: Path, machine: Machine, tell: Callable[[str], Any],
              warn: Callable[[str], Any], draw: Draw, again: bool = False,
              known: Optional[Derived] = None, how: Optional[Build] = None) -> Made:
    """Make a site's folder, or rebuild it, from complete choices whose paths are relative to the working folder.

    tell and warn are called with lines for the user, draw draws the map; again: the folder is a site, which is
    rebuilt; known: the choices that were determined when it was made before; how: what makes the files, if not build(),
    that of a mass. Raises SlopeError on bad input; the folder
    is then as it was, and a new one has site.yaml alone, to be changed.
    """
    place = folder.absolute()
    new = disk.beside_folder(place)
    check_target(folder, again)
    known_files = again or site_folder.was_not_made(folder)
    old = set(site_choices.found(folder).files) if known_files else set()
    site_folder.check_site_folder(choices, folder, old)
    try:
        with disk.alone_in(folder) if again else contextlib.nullcontext():
            new.mkdir()
            try:
                made = built(how or build, choices, known or {}, new, folder, machine, tell, warn, draw)
                site_folder.exchange(new, place, old)
            except SlopeError as error:
                if not again and site_folder.is_free(folder):       # no other one has made it meanwhile
                    site_folder.keep_choices(choices, folder, error)
                    tell(f"{folder / site_choices.NAME} was kept: change it, then: tools/slope site "
                         f"{quote(str(folder))}; or repeat the command")
                raise
            finally:
                shutil.rmtree(new, ignore_errors=True)
    except OSError as error:
        raise SlopeError(folder, f"cannot be written: {error.strerror or error}") from None
    return made


def built(how: Build, choices: Choices, known: Derived, new: Path, folder: Path, machine: Machine, tell, warn,
          draw: Draw) -> Made:
    """How it is built; messages do not name the temporary folder."""
    try:
        return how(choices, known, new, folder, machine, tell, warn, draw)
    except SlopeError as error:
        error.args = (str(error).replace(f"{new}/", ""),)
        raise


def build(given: OfMass, known: Derived, new: Path, folder: Path, machine: Machine, tell, warn, draw: Draw) -> Made:
    """Everything, into the folder `new`, which will be `folder`."""
    keep, warnings = keeper(warn)
    wanted = site_layers.with_missing(given, lambda: wanted_body(given, new))
    raster, terrain_entries = terrain(given, new, tell, keep)
    surveyed = terrain_entries["surveyed_cell"]
    released = body_of(given, wanted, raster, keep)
    if released.choices.get("scar_is") == "height":
        steps = [*terrain_entries["steps"], f"the height of the mass in {wanted.scar} added"]
        rasters.write_asc_local(new / TERRAIN, released.raster, {"filled_cells": terrain_entries["filled_cells"],
                                                                 "sources": terrain_entries["sources"], "steps": steps},
                                exact=True)
        raster = released.raster
    tell(release.describe_body(released))
    for line in released.warnings:
        keep(line)
    several = site_bodies.write_site_bodies(given, new, BODY, wanted, keep)
    body = site_bodies.widen_body(write_body(new, wanted, released), BODY, several)
    body = body._replace(thick=max(body.thick, given.model.least_thick or 0.0))
    layers = read_layers(given, raster, new, tell, keep)
    site_inputs.check_beside_body(layers.structures, new, raster, released.depth)
    if layers.roads:
        geometry.make_mesh(given.road.mesh, raster)
    title = given.project.name or folder.absolute().name
    parts = site_deck.Parts(title, ", ".join(Path(name).name for name in given.terrain.files), body,
                            layers.structures, layers.lines, layers.motion, room_of(raster), layers.zones)
    choices = with_peak(given, parts, released)
    first = tried(choices, known, parts, released, new, folder, machine, tell)
    trial = first and first.trial
    if first:
        site_trial.write_trial(new, first, raster)
    choices, size = settled(choices, parts, released, trial, machine, raster)
    for doubt in check_site_road(choices, released, layers, size):
        keep(doubt)
    derived = site_choices.derived(given, choices, known)
    say_size(choices, size, released, machine, tell)
    for doubt in (*site_warnings.of_resistance(choices), *site_warnings.of_zones(layers.zones),
                  *site_warnings.site_warnings(released.measures, size, trial),
                  *(motion_file.find_across(layers.motion.values, released.measures.bearing, given.motion.file)
                    if layers.motion else ()),
                  *site_warnings.of_cells(released.area.z - released.slip, released.area.cell, surveyed),
                  *(one for name, road in layers.roads.items() for one in site_warnings.check_road_resolution(
                    road, choices.road.width, size.diameter, max(released.area.cell, choices.model.cell or 0.0),
                    name)),
                  *site_warnings.of_walls(layers.structures, size.diameter, choices.structures)):
        keep(doubt)
    site_warnings.write_site_warnings(new, warnings)
    deck = site_deck.make_site_deck(choices, parts, find_deck_numbers(choices, soil_of(choices.model, parts), trial,
                                                                      size))
    disk.write_file(new / site_deck.NAME, deck)
    draw(new / MAP, Shown(released.raster, released.depth, released.geometry, layers.road, layers.observed,
                          layers.structures, layers.lines, first and first.reached, layers.zones,
                          {"set": choices.known.set, "confined": choices.known.confined}),
         f"{title}: {released.measures.volume:,.0f} m\u00b3")
    terrain_entries = {**about_made(choices, new, folder, raster, layers), "derived": derived,
                       "body": released.measures._asdict(), "bodies": site_bodies.summarise_site_bodies(several),
                       "balls": size.balls, "trial": trial and trial._asdict(), "trial_of": first and first.about,
                       "study": {"runs": size.runs, "seconds": size.seconds, "gigabytes": size.gigabytes,
                                 "at_a_time": machine.jobs}}
    disk.write_file(new / site_choices.NAME, site_choices.make_site_file(choices, terrain_entries, folder.absolute()))
    return Made(folder, terrain_entries["files"])


def about_made(choices: Choices, new: Path, folder: Path, raster: Raster, layers: Layers) -> Dict[str, Any]:
    """What site.yaml says of what was made, of whatever kind: files, digests, place, zones."""
    site = site_choices.unread(choices, folder)
    return {"slope_version": provenance.version(), "made": provenance.now(),
            "files": sorted([path.name for path in new.iterdir()] + [site_choices.NAME]),
            "deck_sha256": disk.sha256(new / site_deck.NAME), "choices_sha256": site.fingerprint(),
            "sources_sha256": site.sources(), "crs": crs_name(raster.crs),
            "origin": {"east": float(raster.offset[0]), "north": float(raster.offset[1])},
            "zones": [zone.about(raster) for zone in layers.zones],
            "roads": list(layers.roads) if len(layers.roads) > 1 else []}


def check_site_road(choices: OfMass, released: release.Body, layers: Layers, size: Size) -> List[Finding]:
    """That a road, or a part of it, lies on the body, or that the slip surface comes out under it."""
    raster, findings = released.raster, []
    for name, road in layers.roads.items():
        file = name if len(layers.roads) > 1 else str(choices.road.file)
        on = release_toe.on_body(released.depth > 0, raster, road,
                                 release_toe.rim(size.diameter ** 3, raster.transform.a))
        under = None if on and on.wholly else release_toe.under(released.area, released.slip, road)
        findings += [on.finding(file)] if on else []
        findings += [Finding("under road", {"file": file, **under._asdict()})] if under else []
    return findings


# --- ground ---

def wanted_body(choices: OfMass, new: Path) -> release.Wanted:
    """What is asked of the body, checked before anything is read."""
    asked = choices.release
    where = asked.polygon or asked.scar
    if not where:
        raise SlopeError("--release", "must be given, a polygon, or --scar, a raster")
    site_choices.check_assigned(choices)
    crs, scar_crs, foundation_crs = (isinstance(path, str) and site_choices.assigned(choices, path) or None
                                     for path in (asked.polygon, asked.scar, asked.foundation))
    return release.check_wanted_release(release.Wanted(
        str(new / TERRAIN), asked.polygon, asked.shape, asked.depth, asked.volume, asked.curvature, asked.dip,
        asked.direction, asked.scar, asked.scar_is, asked.least, crs, scar_crs, asked.foundation, foundation_crs,
        advice=advice(choices, where)))


def terrain(choices: Choices, new: Path, tell, warn) -> Tuple[Raster, Dict[str, Any]]:
    """Write the terrain and read it back, as the deck will; what its sidecar says."""
    given = choices.terrain
    own = {path: crs for path in given.files if (crs := site_choices.assigned(choices, path))}
    nodata = given.nodata if isinstance(given.nodata, tuple) else () if given.nodata is None else (given.nodata,)
    wanted = local_terrain.Wanted(given.crs, None, given.cell, given.bounds, given.fill, given.assign_crs, own,
                                  given.z_unit, nodata, pits=False, differ=given.differ)
    about = local_terrain.make_local_terrain(given.files, new / TERRAIN, wanted, tell, warn)
    tell(local_terrain.describe_terrain(TERRAIN, about))
    return rasters.read_asc_local(new / TERRAIN), about


def body_of(choices: OfMass, wanted: release.Wanted, raster: Raster, warn) -> release.Body:
    """The body; SlopeError, in other words where release area and road seem to be swapped."""
    try:
        body = release.body_of(wanted)
    except SlopeError:
        if line := swapped(choices, raster):
            raise SlopeError("--release, --road", "must not be swapped, the mass falls from the release area onto the "
                             "road", line) from None
        raise
    if line := swapped(choices, raster, wholly=True):
        warn(Finding("swapped", {"grounds": line}))
    return body


def write_body(new: Path, wanted: release.Wanted, body: release.Body):
    """The body's files, and what the deck needs to know of it."""
    name = new / BODY
    release_files.write_body(name, wanted._replace(terrain=TERRAIN), body)
    name.with_name(BODY_DECK).unlink()
    if body.geometry is not None:
        polygons.write_polygon(new / f"{BODY}.csv", body.geometry, body.raster)
    return release_files.deck_body(name, wanted.terrain, body.raster, body.area, body.slip)


# --- balls ---

def room_of(raster: Raster) -> float:
    """Of the box around a terrain, m3."""
    return geometry.box_of(raster).area * max(float(np.nanmax(raster.z) - np.nanmin(raster.z)), raster.transform.a)


def soil_of(model: MassModel, parts: site_deck.Parts) -> site_budget.Soil:
    """What the step depends on; of the trial run, where the speed is still unknown, by weight alone."""
    spacing = min([model.spacing, *(zone.values.get("spacing", model.spacing) for zone in parts.zones)])
    return site_budget.Soil(model.density, parts.body.thick, model.speed or site_budget.SLOW, spacing)


def find_deck_numbers(choices: OfMass, soil: site_budget.Soil, trial: Optional[Trial], size: Optional[Size],
                      diameter: Optional[float] = None):
    """What the choices leave open, for the deck."""
    model = choices.model
    d = diameter or (size.diameter if size else 0.0)
    seconds = None
    if trial and size:
        seconds = trial.run(d, size.balls, soil, trial.typical)
    return site_deck.Numbers(d, soil.speed,
                             model.duration or site_budget.LONGEST, model.cell or 1.0, model.film or 1.0,
                             choices.motion.peak_friction or site_deck.LEAST_PEAK, trial and trial.typical,
                             seconds)


def with_peak(choices: OfMass, parts: site_deck.Parts, body: release.Body) -> OfMass:
    """With a strength that holds the body until it is shaken."""
    if choices.motion.peak_friction is not None or not parts.motion:
        return choices
    return replace(choices, motion=replace(choices.motion, peak_friction=site_deck.peak_friction(
        body.measures.slip_slope)))


def tried(choices: OfMass, known: Derived, parts: site_deck.Parts, body: release.Body, new: Path,
          folder: Path, machine: Machine, tell) -> Optional[Tried]:
    """Trial runs with coarse balls; what the site's folder has of them, if that is still right; None where there is no
    LAMMPS. They know nothing of what is determined from them, but that the third one has the study's step.
    """
    if machine.lmp is None:
        return None
    own = replace(site_choices.forgotten(choices, known), motion=choices.motion)
    least, middle = min(choices.study.rolling), settings.middle(choices.study.rolling)
    fixed = all((choices.model.speed, choices.model.duration, choices.model.film, choices.model.cell,
                 choices.balls.diameter))
    place = trial_folder(site_trial.trial_diameter(own.balls, parts.body.volume), own, parts, body, new)
    smooth = min([choices.model.spacing, *choices.study.spacing])
    summary = site_trial.summarise_trial(place, site_deck.NAME, machine.lmp, [least, middle], smooth)
    before = site_trial.kept(folder, summary, fixed)
    if before and (fixed or not own.balls.minutes):
        shutil.rmtree(place)
        tell(f"the trial run is there: {trial_text(before.trial)}")
        return before
    trial, reached = tried_with(place, {"rolling": least}, own, body, machine.lmp, tell)
    other_d = site_trial.other_diameter(own.balls, trial)
    if other_d is None:
        return Tried(trial, reached, summary)
    place = trial_folder(other_d, own, parts, body, new)
    second, its_reach = tried_with(place, {"rolling": middle}, own, body, machine.lmp, tell, "another")
    both = site_trial.joined(trial, second)
    speed = choices.model.speed or site_budget.stiff_to(both)
    place = trial_folder(trial.diameter, own, parts, body, new)
    soil = soil_of(own.model, parts)._replace(speed=speed)
    try:
        third, _ = tried_with(place, {"rolling": least, "spacing": smooth, "speed": speed}, own, body, machine.lmp,
                              tell, "a third one")
        both = site_trial.corrected(both, third, soil._replace(spacing=min(soil.spacing, smooth)))
    except SlopeError as error:     # the site is right without it, its forecast a guess
        shutil.rmtree(place)
        tell(f"a third one, spacing {smooth:g}: {error}; how long the study takes is a guess")
    return Tried(both, its_reach if other_d < trial.diameter else reached, summary)


def trial_folder(d: float, choices: OfMass, parts: site_deck.Parts, body: release.Body, new: Path) -> Path:
    """A folder with the deck of a trial run with balls of diameter d (m)."""
    coarse = replace(choices, model=replace(choices.model, cell=max(body.area.cell, d / 2)))
    folder = new / "trial"
    folder.mkdir()
    for path in list(new.iterdir()):
        if path.suffix in (".asc", ".stl", ".csv", ".txt"):
            os.symlink(f"../{path.name}", folder / path.name)
    soil = soil_of(coarse.model, parts)
    disk.write_file(folder / site_deck.NAME, site_deck.make_site_deck(coarse, parts,
                                                                      find_deck_numbers(coarse, soil, None, None, d)))
    return folder


def tried_with(folder: Path, values: Mapping[str, float], choices: OfMass, body: release.Body, lmp: Path, tell,
               what="trial run"):
    """The Trial of a run in a folder, which is removed, with values of the deck's variables, and its largest
    thickness."""
    deck = folder / site_deck.NAME
    d = float(decks.index_variables(deck)["d"])
    try:
        trial = site_trial.measure(folder, deck.name, lmp, values)._replace(diameter=d)
    except SlopeError as error:
        if choices.motion.file and choices.motion.peak_friction is not None:
            site_warnings.require_standing(error, choices.motion.peak_friction, body.measures.mean_slope)
        raise
    reached = rasters.read_raster(next(iter(folder.glob("*.max_thickness.asc"))), heights=False)
    shutil.rmtree(folder)
    said = ", ".join(f"{name} {value:g}" for name, value in values.items())
    tell(f"{what}, {said}: {trial_text(trial)}; took {trial.seconds:.1f} s")
    return trial, reached


def trial_text(trial: Trial) -> str:
    """What a trial run showed, in words."""
    return (f"{trial.balls} balls of {trial.diameter:g} m: {'at rest' if trial.at_rest else 'not at rest'} after "
            f"{trial.rest:.0f} s, up to {trial.speed:.0f} m/s")


def settled(choices: OfMass, parts: site_deck.Parts, body: release.Body, trial: Optional[Trial], machine: Machine,
            raster: Raster) -> Tuple[OfMass, Size]:
    """With what they leave open, and with it the size of the balls."""
    model, balls = choices.model, choices.balls
    duration = model.duration or site_budget.duration(trial)
    model = replace(model, speed=model.speed or max(site_budget.stiff_to(trial), model.least_speed or 0.0),
                    duration=duration, film=model.film or site_deck.frame(trial.typical if trial else duration / 3))
    size = site_budget.size(choices, parts.body.volume, body.measures.mean_depth, soil_of(model, parts), trial,
                            machine.jobs, raster.z.size)
    cell = model.cell or max(body.area.cell, site_budget.three_digits(size.diameter / 2))
    return replace(choices, model=replace(model, cell=cell), balls=replace(balls, diameter=size.diameter)), size


def say_size(choices: OfMass, size: Size, body: release.Body, machine: Machine, tell):
    """Tell the user the size of the balls, and the time and memory of the study."""
    thick = body.measures.mean_depth / size.diameter, body.measures.largest_depth / size.diameter
    tell(f"balls of {size.diameter:g} m: {size.balls:,} of them, the body is {thick[0]:.1f} balls thick on average, "
         f"{thick[1]:.1f} at most")
    tell(f"the ground: scattered balls as large as those of the soil, spacing {choices.model.spacing:g}")
    took = ""
    if size.seconds is not None and size.most is not None:
        took = f", about {site_budget.duration_text(size.seconds)} if nothing else runs"
        if size.most > size.seconds:
            took += f", {site_budget.duration_text(size.most)} with all that may be added"
    tell(f"the study: {size.text}; {machine.jobs} at a time{took}, {rounded(size.gigabytes, 2)} GB")
