"""The trial runs of a site, which measure this machine, and are kept as long as nothing that they depend on changes.

A run takes (steps) x ((time of a step) + (balls) x (time of a ball in it)). Two trial runs with different numbers of
balls measure these, as processor time, the seconds until the mass is at rest at the lowest and the middle rolling
resistance, and the largest speed, which sets the stiffness and with it the step. A third one has that step, and the
least rolling resistance on the smoothest ground: its mass rests as late as the ensemble's on average.
"""
import hashlib
import re
import resource
import subprocess
from pathlib import Path
from typing import Any, Dict, List, Mapping, NamedTuple, Optional

from rasterio.transform import Affine

from .. import disk, processes, provenance
from ..case import decks, last_words, logs, run_folders
from ..errors import SlopeError
from ..releases import packing
from ..survey import rasters
from ..survey.rasters import Raster
from . import site_budget, site_choices
from .site_budget import Soil, Trial
from .site_sections import Balls

REACHED = "trial.tif"       # largest thickness of the trial run, m
TRIAL = 400             # balls of the trial run
OTHER = 3               # times as many balls has the second trial run for a budget of time, otherwise as few
FINER_SHARE = 0.2       # of that budget, which it takes at most
LEAST_SHARE = 0.3       # of the time of the second trial's balls is that of the balls, not of the steps
TRIAL_LIMIT = 600.0     # s of waiting for it
TOO_LARGE = "box size << cutoff"        # LAMMPS, of a ball that is as large as the terrain

LOOP = re.compile(r"^Loop time of (\S+) on \d+ procs for (\d+) steps with (\d+) atoms", re.MULTILINE)
SHARE = re.compile(r"^(\S+)% CPU use", re.MULTILINE)


class Tried(NamedTuple):
    """What a trial run measured, where its mass went, and of what it was."""
    trial: Trial
    reached: Raster             # largest thickness, m, in local metres
    about: Mapping[str, Any]    # digest of deck, data and machine; values of runs, which those do not hold


def summarise_trial(folder: Path, deck: str, lmp: Path, rolling: List[float], spacing: float) -> Dict[str, Any]:
    """Of a trial run whose files are in a folder; rolling: of the first and the second, spacing: of the third."""
    named, _ = decks.named_files(folder / deck)     # a road or a mapped deposit is no matter
    parts = [repr(decks.without_comments(folder / deck)), disk.sha256(lmp), provenance.machine()["processor"]]
    parts += [path.name + disk.sha256(path) for path in sorted(folder.iterdir()) if path.name in named - {deck}]
    return {"sha256": hashlib.sha256("\n".join(parts).encode("utf-8", "surrogateescape")).hexdigest(),
            "rolling": rolling, "spacing": spacing}


def kept(folder: Path, wanted: Dict[str, Any], settled: bool) -> Optional[Tried]:
    """What a site's folder has of such a trial run; None: nothing.

    settled: nothing is to be determined from it, so that its values do not matter.
    """
    if not (folder / site_choices.NAME).is_file():
        return None
    site_found = site_choices.found(folder)
    had = site_found.trial_of
    if had.get("sha256") != wanted["sha256"] or not (settled or had == wanted) or site_found.trial is None:
        return None
    try:
        raster = rasters.read_raster(folder / REACHED, heights=False)
    except SlopeError:
        return None
    to_local = Affine.translation(-site_found.origin.east, -site_found.origin.north)
    return Tried(site_found.trial, raster._replace(transform=to_local @ raster.transform, crs=None), had)


def write_trial(folder: Path, tried: Tried, terrain: Raster) -> None:
    """Write where the mass went into a site's folder, in the terrain's CRS."""
    rasters.write_geotiff(folder / REACHED, {"largest thickness of the trial run, m": tried.reached.z},
                          tried.reached._replace(crs=terrain.crs, offset=terrain.offset))


def trial_diameter(balls: Balls, volume: float) -> float:
    """Of the trial's balls (m): TRIAL of them, or fewer if the site has fewer."""
    number: float = TRIAL
    if balls.diameter:
        site_budget.number_of(balls, volume, balls.diameter)
        number = min(number, packing.count_balls(volume, balls.diameter))
    elif balls.number:
        number = min(number, balls.number)
    return site_budget.three_digits(packing.compute_diameter(volume, max(number, 1)))


def other_diameter(balls: Balls, trial: Trial) -> Optional[float]:
    """Of the balls of a second trial run (m): finer where time allows it; None with too few balls."""
    if not balls.diameter and not balls.number and \
            trial.seconds * OTHER ** (4 / 3) <= FINER_SHARE * 60 * (balls.minutes or site_budget.MINUTES):
        return site_budget.three_digits(trial.diameter * OTHER ** (-1 / 3))
    if trial.balls < OTHER * site_budget.FEWEST:
        return None
    return site_budget.three_digits(trial.diameter * OTHER ** (1 / 3))


def joined(first: Trial, second: Trial) -> Trial:
    """The finer of two trials, with what each found: first at the lowest rolling resistance, second in the middle.

    The time of a ball and step falls with the number of balls n as step / n + cost.
    """
    fine, coarse = (first, second) if first.balls > second.balls else (second, first)
    step = 0.0
    if fine.balls > coarse.balls:
        step = max(0.0, (coarse.cost - fine.cost) / (1 / coarse.balls - 1 / fine.balls))
        step = min(step, (1 - LEAST_SHARE) * fine.cost * fine.balls)
    return fine._replace(rest=max(first.rest, second.rest), at_rest=first.at_rest and second.at_rest,
                         speed=max(first.speed, second.speed), left=max(first.left, second.left), middle=second.rest,
                         step=step, cost=fine.cost - step / fine.balls)


def corrected(trial: Trial, third: Trial, soil: Soil) -> Trial:
    """With what a third one took, which has the study's own step, over what it would take by the two."""
    computed = trial.run(third.diameter, third.balls, soil, third.rest) - trial.setup
    factor = (third.seconds - third.setup) / computed if computed > 0 else 1.0
    return trial._replace(step=factor * trial.step, cost=factor * trial.cost, late=third.rest)


def measure(folder: Path, deck: str, lmp: Path, values: Mapping[str, float]) -> Trial:
    """Run a site's deck with values of its variables in its folder and read what it measured; SlopeError with LAMMPS'
    own message if it fails.

    The caller sets the diameter and removes the files of the run.
    """
    log = folder / "log.lammps"
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    with open(folder / "screen.txt", "wb") as screen:
        try:
            given = [word for name, value in values.items() for word in ("-var", name, f"{value:.10g}")]
            process = processes.start([str(lmp), "-in", deck, "-log", log.name, *given], folder, screen, alone=True)
        except OSError as error:
            raise SlopeError(lmp, f"cannot be run: {error.strerror}") from None
        try:
            status = process.wait(TRIAL_LIMIT)
        except subprocess.TimeoutExpired:
            raise SlopeError("trial run", f"must end within {TRIAL_LIMIT:g} s") from None
        finally:
            processes.stop([process])
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    summaries = sorted(folder.glob("*.summary.yaml"))
    if status != 0 or not summaries:
        words = last_words.reason(logs.Log(log).update(), last_words.Screen(folder / "screen.txt", 0))
        if words and TOO_LARGE in words:
            raise SlopeError("trial run", "must have balls that are much smaller than the terrain: use more balls "
                             "(--balls), or a smaller --diameter, balls.diameter of site.yaml")
        raise SlopeError("trial run", f"must end without an error: {words or f'ended with status {status}'}")
    summary = run_folders.load_summary(summaries[0])
    text = log.read_text(encoding="utf-8", errors="replace")
    loops = LOOP.findall(text)
    work = sum(int(steps) * int(atoms) for _, steps, atoms in loops)
    computed = sum(float(took) * float(share) / 100 for (took, _, _), share in zip(loops, SHARE.findall(text)))
    volume = summary["volume"]
    return Trial(summary["balls"]["released"], 0.0, summary["stop"]["time"],
                 "halt" in str(summary["stop"]["reason"]), summary["largest"]["max_speed"], computed / max(work, 1),
                 seconds - computed, seconds, (volume["off_grid"] + volume["lost"]) / volume["released"])
