"""slope report: one self-contained HTML page on a study or a run, for the screen and for A4 paper.

Order of the work: find the runs and read their results (data.py), find what maps and section share
(ground.py, section.py), collect warnings and numbers (warnings.py, numbers.py), make the
sections (the parts, in the order of page.py), fill the template, write.
"""
import argparse
from dataclasses import dataclass
from pathlib import Path
from typing import List, Optional

from ..case import run_folders
from ..errors import SlopeError
from ..options import Overwrite, flag, option, positional
from ..plots.section import FALL
from ..report import document, printing
from ..report.heading import SITE, Asked
from ..sites import site_scenarios
from ..studies import outdated
from ..tables import study_file

OF_SITE = f" (default: what {SITE} says, in DIR or above it)"

DESCRIPTION = "One self-contained HTML page on a study or a run."
EPILOG = """\
units: metres; the ends of --section are local coordinates of the run's terrain.

example: the study that `slope study ... -o out` made, with a section along a line from a GIS:
  tools/slope report out -o report.html
  tools/slope report out --section thalweg.geojson --pdf

Writes report.html, with all pictures in it, and a 3-D view of a run that wrote dumps; report.section.csv, the heights
along the section; report.numbers.csv, the numbers on the page with all their digits; and report.mp4, a film of the run.
Of a site with scenarios (slope site --scenario) also scenarios.html, which sets them side by side.
"""


@dataclass(frozen=True, kw_only=True)
class Request(Overwrite):
    folder: Optional[Path] = positional(
        "folder of a study (study.yaml), of a site with its study, or of a single run (PREFIX.summary.yaml)",
        metavar="DIR", nargs="?")
    output: Optional[Path] = option("the page (default DIR/report.html)", "-o", metavar="REPORT.html")
    section: Optional[List[str]] = option(
        "the section: its ends, local m; or a line of any shape: GeoJSON, shapefile, WKT, CSV; or "
        f"the word {FALL}: through the centroid of the (largest) body, along the fall line "
        "(default: along the path of the mass, or the fall line where that is about the same)", nargs="+",
        metavar="X1 Y1 X2 Y2|LINE")
    local: bool = flag("the line of --section is in local metres, not in a CRS")
    shown: Optional[str] = option(
        "the run of a study whose maps are shown (default: the run that determines the conservative volume, or, "
        "without a road, the one with the longest run-out)", "--run", metavar="NAME")
    reference: Optional[Path] = option(
        "numbers from elsewhere, published or measured, shown beside those of the runs", metavar="FILE.yaml")
    converge: Optional[Path] = option(
        "effect of the size of the balls: the folder of `slope sensitivity --converge`, or its "
        "converge.yaml", metavar="DIR")
    name: Optional[str] = option(f"name of the project or the site, the title of the page{OF_SITE}", metavar="TEXT")
    client: Optional[str] = option(f"recipient of the report{OF_SITE}", metavar="TEXT")
    author: Optional[str] = option(f"author of the report{OF_SITE}", metavar="TEXT")
    pdf: bool = flag(
        "also print the page to REPORT.pdf, with an installed browser: chromium, google-chrome or microsoft-edge")
    reproduce: bool = flag(
        "make no page; list the commands, versions and checksums with which a reviewer makes the numbers again")
    no_film: bool = flag(
        "make no film of the balls, REPORT.mp4 (default: one, where the run wrote dumps and ffmpeg is installed)")
    no_paper: bool = flag(argparse.SUPPRESS)
    pictures: bool = flag(
        "write the maps as files too, REPORT.1.png, REPORT.2.png, ... in the page's order; charts, drawn as lines, "
        "stay in the page")


def study_of(folder: Path) -> Path:
    """The study inside the folder of a site, or of one of its roads; any other folder itself, as a site that holds a
    run made by hand only.
    """
    inside = study_file.study_in(folder)
    if inside:
        return inside
    if not (folder / SITE).is_file():
        return folder
    if not run_folders.summaries(folder):
        raise study_file.without_study(folder)
    return folder


def run_report(args: Request) -> None:
    """Do the command; raises SlopeError on bad input. Prints what was written."""
    given, section = args.folder, args.section
    if given is None:           # it stands behind --section, which takes what comes
        if section is None or len(section) not in (2, 5):
            raise SlopeError("DIR", "must be given, the folder of a study or of a run")
        *section, last = section
        given = Path(last)
    folder = study_of(given)
    outdated.check_study_current(given, folder)
    output = args.output or given / "report.html"
    if output.suffix not in (".html", ".htm") or output.is_dir():
        raise SlopeError("-o", "must be a file that ends in .html", output)
    if not given.is_dir():
        raise SlopeError(given, "must be an existing folder")
    if not output.absolute().parent.is_dir():
        raise SlopeError("-o", "must be in an existing folder", output)
    if args.reproduce:
        print("\n".join(document.reproduce(folder)))
        return
    document.check_standing(output, folder, args.overwrite, inside=output.resolve().parent == given.resolve())
    if args.pdf:
        printing.require_browser()
    asked = Asked(folder, args.shown, section, args.local, args.reference, args.converge, args.name,
                  args.client, args.author, None if args.no_film else output.with_suffix(".mp4"))
    first, *notes = document.write_report(asked, output)
    print(first)
    if (given / SITE).is_file() and site_scenarios.list_scenarios(given):
        from ..scenarios import page
        print(page.write_scenarios_page(given, output.with_name(page.PAGE), args.overwrite))
    if args.pictures:
        document.write_pictures(output)
    if args.pdf:
        pdf = output.with_suffix(".pdf")
        printing.print_page(output, pdf)
        print(f"{pdf}: the page on A4, by {printing.browser()}")
    if args.no_paper:
        print("note: --no-paper is the default now; --reference FILE.yaml brings other numbers in")
    for line in notes:
        print(line)
