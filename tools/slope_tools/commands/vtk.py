"""slope vtk: the snapshots and rasters of a run as files for ParaView, by dump2vtk."""
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import Optional

from .. import programs
from ..case import run_folders
from ..deposits import flow_path
from ..errors import SlopeError
from ..findings import printer
from ..options import flag, option, positional
from ..studies import outdated
from ..tables import named_run

DESCRIPTION = "The snapshots of a run, its ground and its deposit as files for ParaView, as dump2vtk writes them."
EPILOG = """\
examples: the run of page 1 of a site's report; a run of a deck of your own:
  tools/slope vtk mine
  tools/slope vtk embankment/embankment -o pictures/embankment

Writes OUT.pvd, which is the one to open, OUT/OUT_STEP.vtp, OUT.terrain.vts and OUT.thickness.vts. The program is
build/dump2vtk, or DUMP2VTK in the environment; for other dumps and rasters call it by hand.
"""


@dataclass(frozen=True, kw_only=True)
class Request:
    prefix: str = positional(
        "folder of a site or a study, which stands for the run of its first page; or a run's folder, its PREFIX or one "
        "of its files", metavar="FOLDER|PREFIX")
    output: Optional[Path] = option("first part of the names of all files (default vtk/PREFIX in FOLDER, or beside the "
                                    "run)", "-o", metavar="OUT")
    single: bool = flag("values with 7 digits instead of 16")


def run_vtk(args: Request) -> None:
    """Do the command; raises SlopeError on bad input. Prints what was written."""
    named = named_run.read_named_run(args.prefix)
    outdated.check_study_current(Path(args.prefix), named.study)
    if named.study:
        print(f"{named.run}, the governing run of {named.study}: {named.prefix}")
    convert(named.prefix, args.output, named.folder or Path(named.prefix).parent, args.single)


def convert(prefix: str, output: Optional[Path], folder: Path, single: bool) -> None:
    """The files of the run of a prefix; without an output in folder/vtk. SlopeError where dump2vtk refuses."""
    summary = run_folders.load_summary(f"{prefix}.summary.yaml", run_folders.OF_DEPOSIT)
    program = programs.find_dump2vtk()
    if output is None:
        (folder / "vtk").mkdir(exist_ok=True)
        output = folder / "vtk" / Path(prefix).name
    if not output.parent.is_dir():
        raise SlopeError("-o", "must be in an existing folder", output)
    place, end = Path(prefix), (summary.get("stop") or {}).get("step", 10 ** 12)
    dumps = flow_path.snapshots(place.parent, end, f"{place.name}.") or flow_path.snapshots(place.parent, end)
    done = subprocess.run([program, *dumps, "--deposit", prefix, "-o", output, *["--single"] * single],
                          capture_output=True, text=True, check=False)
    *told, last = [line.replace("dump2vtk: ", "", 1) for line in done.stderr.splitlines()] or [""]
    if done.returncode:
        raise SlopeError("dump2vtk", last or f"must end without an error, got status {done.returncode}")
    for line in (*told, last):
        if line:
            printer("vtk")(line)
    print(f"{len(dumps)} snapshots written; open {output}.pvd" if dumps else
          f"no snapshots in {place.parent}: open {output}.thickness.vts")
