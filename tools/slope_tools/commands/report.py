"""slope report: one self-contained HTML page on a study or a run, for the screen and for A4 paper.

Order of the work: find the runs and read their results (data.py), find what maps and section share
(ground.py, section.py), collect warnings and numbers (warnings.py, numbers.py), draw
(maps_part.py, charts.py), fill the template (page.py), write.
"""
import argparse
from pathlib import Path
from shlex import quote

from ..case import run_folders
from ..errors import SlopeError
from ..options import add_overwrite
from ..plots.section import FALL
from ..report import document, paper
from ..report.heading import Asked
from ..report.heading import SITE
from ..studies import site_study
from ..tables import answered

STUDY = "study.yaml"

DESCRIPTION = "One self-contained HTML page on a study or a run."
EPILOG = """\
units: metres; the ends of --section are local coordinates of the run's terrain.

example: the study that `slope study ... -o out` made, with a section along a line from a GIS:
  tools/slope report out -o report.html
  tools/slope report out --section thalweg.geojson --pdf

Writes report.html, with all pictures in it, and a 3-D view of a run that wrote dumps; report.section.csv, the heights
along the section; report.numbers.csv, the numbers on the page with all their digits; and report.mp4, a film of the run.
"""


def add_arguments(parser):
    parser.add_argument("folder", metavar="DIR", type=Path, nargs="?",
                        help="folder of a study (study.yaml), of a site with its study, or of a single run "
                             "(PREFIX.summary.yaml)")
    parser.add_argument("-o", dest="output", metavar="REPORT.html", type=Path,
                        help="the page (default DIR/report.html)")
    parser.add_argument("--section", nargs="+", metavar="X1 Y1 X2 Y2|LINE",
                        help="the section: its ends, local m; or a line of any shape: GeoJSON, shapefile, WKT, CSV; or "
                             f"the word {FALL}: through the centroid of the released mass, along the fall line "
                             "(default: along the path of the mass, or the fall line where that is about the same)")
    parser.add_argument("--local", action="store_true", help="the line of --section is in local metres, not in a CRS")
    parser.add_argument("--run", dest="shown", metavar="NAME",
                        help="the run of a study whose maps are shown (default: the run that determines the "
                             "conservative volume, or, without a road, the one with the longest run-out)")
    parser.add_argument("--reference", metavar="FILE.yaml", type=Path,
                        help="numbers from elsewhere, published or measured, shown beside those of the runs")
    parser.add_argument("--converge", metavar="DIR", type=Path,
                        help="effect of the size of the balls: the folder of `slope sensitivity --converge`, or its "
                             "converge.yaml (default: the one that the study took its size error from)")
    for name, what in (("name", "name of the project or the site, the title of the page"),
                       ("client", "recipient of the report"), ("author", "author of the report")):
        parser.add_argument(f"--{name}", metavar="TEXT", help=f"{what} (default: what {SITE} says, in DIR or above it)")
    parser.add_argument("--pdf", action="store_true",
                        help="also print the page to REPORT.pdf, with an installed browser: chromium, google-chrome or "
                             "microsoft-edge")
    parser.add_argument("--reproduce", action="store_true",
                        help="make no page; list the commands, versions and checksums with which a reviewer makes the "
                             "numbers again")
    parser.add_argument("--no-film", action="store_true",
                        help="make no film of the balls, REPORT.mp4 (default: one, where the run wrote dumps and "
                             "ffmpeg is installed)")
    parser.add_argument("--no-paper", action="store_true", help=argparse.SUPPRESS)    # in older scripts
    parser.add_argument("--pictures", action="store_true",
                        help="write the maps as files too, REPORT.1.png, REPORT.2.png, ... in the page's order; "
                             "charts, drawn as lines, stay in the page")
    add_overwrite(parser)


def study_of(folder: Path) -> Path:
    """The study inside the folder of a site; any other folder itself, as a site that holds a run made by hand only."""
    if not (folder / SITE).is_file() or (folder / STUDY).is_file():
        return folder
    inside = answered.governing(folder / site_study.STUDY, folder / site_study.ENSEMBLE)
    if (inside / STUDY).is_file():
        return inside
    if not run_folders.summaries(folder):
        raise SlopeError(folder, f"must hold the study of this site: `slope study {quote(str(folder))}` makes it and "
                         "the report", f"no {inside / STUDY}")
    return folder


def run(args):
    """Do the command; raises SlopeError on bad input. Prints what was written."""
    if args.folder is None:     # behind --section, which takes what comes
        if len(args.section or ()) not in (2, 5):
            raise SlopeError("DIR", "must be given, the folder of a study or of a run")
        args.folder = Path(args.section.pop())
    folder = study_of(args.folder)
    output = args.output or args.folder / "report.html"
    if output.suffix not in (".html", ".htm") or output.is_dir():
        raise SlopeError("-o", "must be a file that ends in .html", output)
    if not args.folder.is_dir():
        raise SlopeError(args.folder, "must be an existing folder")
    if not output.absolute().parent.is_dir():
        raise SlopeError("-o", "must be in an existing folder", output)
    if args.reproduce:
        print("\n".join(document.reproduce(folder)))
        return
    document.check_standing(output, folder, args.overwrite, inside=output.resolve().parent == args.folder.resolve())
    if args.pdf:
        paper.require_browser()
    asked = Asked(folder, args.shown, args.section, args.local, args.reference, args.converge, args.name,
                  args.client, args.author, None if args.no_film else output.with_suffix(".mp4"))
    first, *notes = document.write(asked, output)
    print(first)
    if args.pictures:
        document.write_pictures(output)
    if args.pdf:
        pdf = output.with_suffix(".pdf")
        paper.write(output, pdf)
        print(f"{pdf}: the page on A4, by {paper.browser()}")
    if args.no_paper:
        print("note: --no-paper is the default now; --reference FILE.yaml brings other numbers in")
    for line in notes:
        print(line)
