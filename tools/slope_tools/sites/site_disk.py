"""How much of the disk the study of a site takes: copies of its input, snapshots, restart files and rasters."""
from pathlib import Path
from typing import Sequence

import numpy as np

from ..case.data_files import OUTPUTS
from ..digits import three
from ..errors import SlopeError
from ..releases import packing
from ..survey import rasters
from . import site_budget, site_trial
from .site_found import Found
from .site_sections import OfMass

FRAME = 100.0           # bytes of a ball in a snapshot
RESTART = 1000.0        # of a ball in a restart file, with its contacts
BASE = 45e3             # of a restart file without balls
FILES = 2               # restart files, written in turn
CELL = 60.0             # of a cell in all rasters of a run
ROOM = 1.5              # times as many cells have a run's rasters as those that the trial run reached
RUN = 200e3             # of logs, and the volume on the road, with its map
PAGES = 12e6            # of maps, reports and film


def study(folder: Path, choices: OfMass, site_found: Found, numbers: Sequence[int]) -> float:
    """Bytes of all runs of a study, without those that may be added, and of its pages; of a site that is made.

    numbers: of points with each of the finer balls.
    """
    d, body, plan = choices.balls.diameter, site_found.body, site_budget.plan_budget(choices)
    assert d and body and choices.model.duration and choices.model.film and choices.model.cell
    of_site = packing.count_balls(body.volume, d)
    inputs = sum(path.stat().st_size for path in folder.iterdir() if path.is_file() and not OUTPUTS.search(path.name))
    rest = site_found.trial and site_found.trial.rest or choices.model.duration / site_budget.PATIENCE
    frames = 1 + rest / choices.model.film
    cells = reached(folder) / choices.model.cell ** 2

    def run(factor: float) -> float:
        balls = of_site / factor ** 3
        return inputs + RUN + CELL * cells + FILES * (BASE + RESTART * balls) + FRAME * balls * frames
    return PAGES + (plan.runs + plan.half_step) * run(1.0) + sum(
        number * run(0.5 ** k) for k, number in enumerate(numbers, 1))


def reached(folder: Path) -> float:
    """Area (m2) of the rectangle that a run's rasters cover."""
    try:
        raster = rasters.read_raster(folder / site_trial.REACHED, heights=False)
    except SlopeError:
        return 0.0
    rows, columns = np.nonzero(np.nan_to_num(raster.z) > 0)
    if not len(rows):
        return 0.0
    return ROOM * float(np.ptp(rows) + 1) * float(np.ptp(columns) + 1) * raster.transform.a ** 2


def format_disk_size(size: float) -> str:
    """In words."""
    return f"{three(size / 1e9)} GB" if size >= 1e9 else f"{three(size / 1e6)} MB"
