"""What a report is made of: the finished runs of a study, or one run, read back."""
import functools
from pathlib import Path
from typing import Any, Dict, List, Optional

import numpy as np
from affine import Affine

from .. import schemas
from ..case import logs, run_folders
from ..deposits import deposit, score
from ..errors import SlopeError
from ..schemas import OBJECT, mapping
from ..survey import rasters
from ..studies import run_rows
from ..tables import named_run, quantities, study_types
from ..tables.rows import Finished, Row, finished_of
from ..tables.study_file import load_study
from . import heading

MOST_SHOWN = 9          # runs that get a map and a line in the section


class Result:
    """A finished run, read back."""

    def __init__(self, folder: Path, summary: Path, row: Optional[Finished] = None):
        """row: of the table of its study; None of a run alone."""
        self.folder, self.path = Path(folder), Path(summary)
        self.prefix = run_folders.prefix_of(summary)
        self.summary = run_folders.load_summary(summary)
        of_study = (self.folder / run_folders.VARIABLES).is_file()
        self.about, self.marker = run_folders.begun(folder) if of_study else {}, run_folders.ended(folder)
        self.log = logs.Log(find_log(self.folder)).update()
        self.row = row or run_rows.alone(self.folder, self.path, self.log)
        self.name = self.row.run or self.prefix.name
        terrain = self.log.terrain and self.folder / self.log.terrain
        self.terrain_path = terrain if terrain and terrain.is_file() else None
        self.deposit = deposit.read_deposit(self.prefix, self.terrain_path, lambda text: None)

    def raster(self, name):
        """Values of one of its rasters; they must have the deposit's grid."""
        raster = run_folders.load_raster(self.prefix, name)
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
    found = sorted(path for path in Path(folder).glob("log.*") if path.name != "log.cite")
    usual = Path(folder) / logs.LOG
    return usual if usual in found or len(found) != 1 else found[0]


def find_deck(result):
    """The deck of a run: the one that the study copied, else the only in.* there is; None if that is not clear."""
    named = result.about.get("deck")
    decks = [result.folder / str(named)] if named else sorted(result.folder.glob("in.*"))
    return decks[0] if len(decks) == 1 and decks[0].is_file() else None


def same_grid(raster, other):
    return (raster.thickness.shape == other.thickness.shape
            and raster.deposit.raster.transform.almost_equals(other.deposit.raster.transform))


class Data:
    """A study or a run, with everything that a page needs of its files.

    study: study.yaml, None of a single run; rows: its runs, finished: those that finished; settings: its variables;
    repeats: the variables that are chance; result: the run of the maps, drawn: those beside it on maps and
    section, the same one among them; road: a polygon or None; removed: what is to be removed in the shown run, its
    thickness in the cells and a Raster of volumes in a mesh; volumes: those of its volume.yaml; mapped: the
    score.Observed of a mapped deposit, or None; over_all: {file: values} of the maps over all runs; site: what the
    site's file says.
    """

    def __init__(self, folder: Path, shown: Optional[str] = None, study: Optional[study_types.Study] = None, site=None):
        """study, site: what study.yaml and the site's file say; None: they are read."""
        self.folder, self.study = folder, study
        self.site = heading.site_of(folder) if site is None else site
        self.rows: List[Row] = []
        self.finished: List[Finished] = []
        self.settings: study_types.Settings = {}
        self.repeats: study_types.Settings = {}
        self.road: Any = None
        self.road_lines: Any = ()
        self.removed: Any = None
        self.mapped: Optional[score.Observed] = None
        self.over_all: Dict[str, np.ndarray] = {}
        self.volumes: Dict[str, float] = {}
        if study is not None or (folder / "study.yaml").is_file():
            self._read_study(shown)
        else:
            self._read_single(shown)

    def _read_study(self, shown):
        path = self.folder / "study.yaml"
        self.study = self.study or load_study(path)
        self.rows = self.study.runs
        self.finished = finished_of(self.rows)
        study = self.study.study
        self.settings, self.repeats = study.set, study.repeat
        names = [row.run for row in self.finished]
        shown = shown or named_run.governing(self.study)
        if shown not in names:
            raise SlopeError("--run", f"must be a finished run of {path}, such as {names[0]}", shown)
        self.result = self._load(self.finished[names.index(shown)])
        drawn = [self.result if name == shown else self._load(self.finished[names.index(name)])
                 for name in self._beside(shown)]
        self.drawn = [one for one in drawn if same_grid(one, self.result)]
        road = study.road
        if road:
            from ..survey import roads
            given = roads.read_local(self.folder / str(road["local"]), self.result.deposit.raster, roads.Asked.of(road),
                                     True)
            self.road, self.road_lines = given
        if self.study.observed:
            self.mapped = score.read_observed(self.folder / str(self.study.observed.file),
                                              self.result.deposit.raster, score.THRESHOLD, False)
        # everything is read before anything is drawn: drawing takes a while
        if len(self.finished) > 1 and self.study.envelope:
            for entry in (self.study.envelope["max_thickness"], *(self.study.exceedance or ())):
                self.over_all[entry["file"]] = self.read_map(entry["file"])
        if road:
            self.removed = self._removed()
            volume = self.result.folder / self._volume() / "volume.yaml"
            self.volumes = (schemas.load_checked(volume, "what `slope volume` wrote",
                                                 mapping({"volume": OBJECT}))["volume"]
                            if volume.is_file() else {})

    def _read_single(self, shown):
        if shown:
            raise SlopeError("--run", f"needs a study, with study.yaml, in {self.folder}", shown)
        found = run_folders.summaries(self.folder)
        if len(found) != 1:
            raise SlopeError(self.folder, "must be the folder of a study, with study.yaml, or of one run, with one "
                             "PREFIX.summary.yaml", f"{len(found)} summaries")
        self.result = Result(self.folder, found[0])
        self.drawn = [self.result]

    def _load(self, row):
        path = run_folders.summary_of(self.folder, row.summary)
        return Result(path.parent, path, row)

    def _volume(self) -> str:
        """Where runs have the volume to remove from the road of the study."""
        return quantities.volume_folder(self.of_study.study.the_road.get("name") or "")

    def _removed(self):
        volumes = []
        raster = self.result.deposit.raster
        for name in ("volume.tif", "volume_mesh.tif"):
            one = rasters.read_raster(self.result.folder / self._volume() / name, heights=False)
            east, north = raster.offset     # the files are in the CRS
            volumes.append(one._replace(transform=Affine.translation(-east, -north) @ one.transform,
                                        z=np.nan_to_num(one.z)))
        if volumes[0].z.shape != raster.z.shape:
            raise SlopeError(self.result.folder / self._volume() / "volume.tif",
                             f"must have the grid of {self.result.prefix}.thickness.asc")
        return volumes[0].z, volumes[1]

    @property
    def of_study(self) -> study_types.Study:
        """Of the page on one."""
        assert self.study is not None
        return self.study

    def read_map(self, name):
        """Values of a map over all runs; 0 where it has none."""
        path = self.folder / str(name)
        raster = rasters.read_asc_local(path, heights=False)
        if raster.z.shape != self.result.thickness.shape:
            raise SlopeError(path, f"must have the grid of {self.result.prefix}.thickness.asc")
        return np.where(np.isfinite(raster.z), raster.z, 0)

    def largest_release(self):
        """The released volume (m3), the largest of all runs."""
        return max((row.released_m3 for row in self.finished), default=self.result.summary["volume"]["released"])

    def below_ground(self):
        """Volume (m3) to remove in the shown run where the cut lies below the ground, and its share of all; or None."""
        below, whole = (self.volumes.get(key) for key in ("remove_where_cut_below_ground", "remove"))
        return (below, below / whole) if below and whole else None

    # --- how the runs began and ended ---

    @property
    def judged(self):
        """The rows that findings are of: those of the study, or that of a run alone, without a name."""
        return self.rows or [self.result.row]

    @property
    def compared(self):
        """Rows of the quantities of the finished runs; or that of a run alone."""
        return self.finished or [self.result.row]

    def names(self):
        """Labels of the runs by their folders."""
        return {row.run: self.label_of(row) for row in self.rows}

    @functools.cached_property
    def length(self):
        """The run_length.RunLength of the shown run; None where its deposit is nowhere thick enough."""
        from ..mobility import run_length
        return run_length.measure_run_length(self.result.deposit, self.result.terrain_path)

    # --- runs and their names ---

    def combinations(self):
        """{values of what was chosen: the finished runs}, which differ by what is repeated; in their order."""
        found: Dict[tuple, List[Finished]] = {}
        for row in self.finished:
            found.setdefault(tuple(row.set.items()), []).append(row)
        return found

    def _beside(self, shown):
        """Names of the runs that are drawn: one of each combination, evenly spread if there are many."""
        names = []
        for rows in self.combinations().values():
            mine = [row.run for row in rows]
            names.append(shown if shown in mine else mine[0])
        if len(names) > MOST_SHOWN:
            names = [names[round(i * (len(names) - 1) / (MOST_SHOWN - 1))] for i in range(MOST_SHOWN)]
        if shown not in names:
            names[-1] = shown
        return names

    def number(self, name):
        """The number of a run of a study in the report, from 1."""
        return next(k for k, row in enumerate(self.rows, 1) if row.run == name)

    def label(self, run):
        """A short name of a run: the values that differ in the study."""
        return self.label_of(run.row) if self.study else run.name

    def label_of(self, row):
        repeat = [f"{name} {value}" for name, value in row.repeat.items()]
        return ", ".join(self.varied(row) + repeat) or ("base" if self.repeats else row.run)

    def varied(self, row):
        return [f"{name} {value}" for name, value in row.set.items() if len(self.settings.get(name) or ()) > 1]
