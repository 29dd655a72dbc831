"""The request for a set of runs: deck, folder, program, and what is measured of each run."""
from pathlib import Path
from typing import Any, Callable, Dict, List, NamedTuple, Optional

from ..sites import site_folder
from ..survey.roads import NOTHING, Asked, read_local
from ..survey.vectors import ignore


RUNS = "runs"                                       # in a site's folder
OLDER = ("study", "sizes", "step", "ensemble")      # where earlier versions had them


class Road(NamedTuple):
    """A road, and how the volume to remove from it is measured; see deposits/volume.Wanted."""
    file: Path
    cut_angle: float = 30.0     # degrees
    mesh: float = 10.0          # m
    local: bool = False         # in local metres
    asked: Asked = NOTHING      # width of a line, lane, hours
    name: str = ""              # of one of several

    def about(self) -> Dict[str, Any]:
        """What a study keeps of it."""
        return {"file": self.file.name, "name": self.name, "cut_angle": self.cut_angle, "mesh": self.mesh,
                **self.asked.about()}

    def read(self, raster, warn=ignore):
        """The roads.Road, in the local metres of a raster or place."""
        return read_local(self.file, raster, self.asked, self.local, warn=warn)


class Setup(NamedTuple):
    """How the runs of a deck are made."""
    deck: Path
    output: Path                        # folder of the study
    ranks: int = 1                      # MPI ranks of each run
    jobs: Optional[int] = None          # runs at a time; None: as many as the cores allow
    road: Optional[Road] = None
    lmp: Optional[str] = None           # the LAMMPS program; None: programs.find_lmp
    launcher: Optional[str] = None      # what starts the ranks; None: mpirun
    engine: str = "local"               # or slurm
    slurm: str = ""                     # options of sbatch
    dry_run: bool = False               # only list the runs
    anew: bool = False                  # make finished runs of another program, deck or data again
    site: Optional[Path] = None         # folder of the site whose runs they are
    given: Any = None                   # the request of the command, which it can be given once more with
    tell: Callable[[Any], None] = lambda line: None     # what gets lines for the user, and tables (rich.table.Table)
    warn: Callable[[Any], None] = lambda finding: None     # what gets warnings, Finding or text

    @property
    def home(self) -> Path:
        """The folder in which one command works at a time."""
        return self.site or self.output

    @property
    def body(self) -> Optional[Path]:
        """The folder of the site, if all of its runs have one body."""
        return site_folder.only_one(self.site)

    @property
    def runs(self) -> Path:
        """The folder of the runs: a study's own, one for all studies of a site."""
        return self.site / RUNS if self.site else self.output

    @property
    def older(self) -> List[Path]:
        """The folders in which earlier versions had runs of a site."""
        return [self.site / name for name in OLDER] if self.site else []
