"""Arguments of the commands that run decks."""
from pathlib import Path

from ..options import count, number


def add_deck(parser):
    parser.add_argument("deck", metavar="DECK", type=Path,
                        help="LAMMPS input deck with one fix deposit/grid; the plain files beside it are its data")


def add_runs(parser, road=False):
    """Arguments of how the runs are made and what is measured; road: it must be given."""
    parser.add_argument("-o", dest="output", metavar="DIR", required=True, type=Path, help="the study's folder")
    parser.add_argument("--np", type=count, default=1, metavar="N", help="MPI ranks of each run (default 1)")
    parser.add_argument("--jobs", type=count, metavar="J",
                        help="runs at a time (default: as many as the cores of this machine allow)")
    parser.add_argument("--road", metavar="POLYGON", type=Path, required=road,
                        help="tell the volume to remove from this road too: GeoJSON, shapefile, CSV or WKT")
    parser.add_argument("--cut-angle", metavar="DEG", type=number, default=30.0,
                        help="rise of the cut surface from the road's edges, degrees (default 30); see `slope volume`")
    parser.add_argument("--mesh", metavar="SIZE", type=number, default=10.0,
                        help="side of the mesh cells of that volume, m (default 10)")
    parser.add_argument("--local", action="store_true", help="the road is in local metres, not in a CRS")
    parser.add_argument("--lmp", metavar="FILE", help="the LAMMPS program (default: LMP of the environment, then "
                        "build/lmp beside tools/)")
    parser.add_argument("--dry-run", action="store_true", help="only list the runs")
    parser.add_argument("--launcher", metavar="COMMAND",
                        help="what starts the ranks of a run instead of mpirun, such as 'srun --mpi=pmix' or 'mpiexec "
                             "-n {np}'; without {np}, -n N is added")
    parser.add_argument("--engine", choices=("local", "slurm"), default="local",
                        help="local (default): runs on this machine; slurm: job arrays of a Slurm cluster, whose nodes "
                             "see DIR")
    parser.add_argument("--slurm", metavar="OPTIONS", default="",
                        help="options of sbatch for --engine slurm, such as '--partition=long --time=2:00:00'")
