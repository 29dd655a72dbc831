"""The page of a report as HTML, and its pictures as files."""
import base64
import functools
import hashlib
import re
import shutil
from contextlib import contextmanager
from pathlib import Path
from shlex import quote
from typing import List, Optional

from .. import digits, disk, kept
from ..case import run_folders
from ..errors import SlopeError
from ..findings import WARNING
from ..tables import study_file, study_types
from ..tables.rows import finished_of
from .heading import Asked, site_file


MADE_BY = "Made by tools/slope report"      # in each page
HEAD = 4096             # bytes of a page that hold its digest
MADE_OF = re.compile(rb'<meta name="slope-made-of" content="(\w+) ?([^"]*)">')
BESIDE = ("collected", "machine", "jobs")       # of a study: when and where its runs were evaluated


def mark(folder: Path) -> str:
    """What a page has of the folder that it is about: its path, as a digest."""
    return hashlib.sha256(str(folder.resolve()).encode()).hexdigest()[:16]


def check_standing(output: Path, folder: Path, overwrite: bool, inside: bool) -> None:
    """Raise SlopeError if files stand under the names of a page that are not those of a page on this folder.

    inside: the page is in the folder, which may have moved since: any page is replaced.
    """
    files = [output, *(output.with_suffix(suffix) for suffix in (".pdf", ".section.csv", ".numbers.csv", ".mp4"))]
    disk.check_standing(output, files, [MADE_BY, *([] if inside else [mark(folder)])], overwrite,
                        f"slope report {quote(str(folder))}")


def write_pictures(output):
    """The written page's PNG pictures, its maps, as files beside it."""
    pictures = re.findall(r"data:image/png;base64,([A-Za-z0-9+/=]+)", output.read_text(encoding="utf-8"))
    for place, picture in enumerate(pictures, 1):
        disk.write_file(output.with_suffix(f".{place}.png"), base64.b64decode(picture))
    print(f"{output.with_suffix('.1.png')} to {len(pictures)}: its maps")


def update(asked: Asked, output: Path) -> List[str]:
    """write_report() the page of a study, unless it is there, made of the same numbers and runs by the same tools."""
    assert asked.study
    made_of = digest_of(asked, asked.study)
    if is_made_of(output, made_of):
        return [f"{output}: unchanged, as all that it is made of"]
    return write_report(asked, output, made_of)


def write_report(asked: Asked, output: Path, made_of: Optional[str] = None) -> List[str]:
    """Write the page, its tables and its film, if one is asked for; returns lines for the user, the files first.

    made_of: digest_of() the page.
    """
    page, content = make_page(asked)
    tables = {output.with_suffix(".section.csv"): page.section.table(),
              output.with_suffix(".numbers.csv"): page.numbers.table()}
    films = {asked.film: page.film.content} if asked.film and page.film.content else {}
    beside = {**tables, **films}
    digest = made_of if films or not page.film.failed else None
    html = render({**content, "made_of": f"{digest} {'/'.join(path.name for path in beside)}" if digest else ""})
    for path, text in {**beside, output: html}.items():     # the page, which says what it is made of, last
        disk.write_file(path, text)
    view = ", a 3-D view" if 'id="scene"' in html else ""
    written = (f"{output}: {len(html) / 1e6:.1f} MB, {html.count('<figure')} pictures{view}; "
               f"{', '.join(map(str, [*tables, *films]))}")
    return [written, *([f"note: {page.film.text}"] if page.film.text and not films else []),
            *(f"{'WARNING' if level == WARNING else level}: {text}" for level, text in page.warnings)]


# --- whether a page would be drawn as it is ---

def digest_of(asked: Asked, study: study_types.Study) -> str:
    """Of the page that is asked for on a study: what its runs say, their files, the site, and these tools."""
    study_entries = study_file.encode_study(study)
    study_entries["study"] = {key: value for key, value in study_entries["study"].items() if key not in BESIDE}
    site = site_file(asked.folder)
    # however its folder is named on the command line
    film = asked.film.name if asked.film else None
    parts = {"asked": {**asked._asdict(), "study": None, "site": None, "folder": mark(asked.folder), "film": film},
             "about": study_entries,
             "site": asked.site if asked.site is not None else site and disk.sha256(site),
             "runs": {row.run: run_folders.state(run_folders.summary_of(asked.folder, row.summary).parent)
                      for row in finished_of(study.runs)},
             "film": str(shutil.which("ffmpeg")) if asked.film else ""}
    return kept.digest(parts)


def is_made_of(page: Path, made_of: str) -> bool:
    """Whether a page and what belongs to it is there, made of what has this digest."""
    try:
        with open(page, "rb") as file:
            found = MADE_OF.search(file.read(HEAD))
    except OSError:
        return False
    return found is not None and found[1].decode() == made_of and all(
        (page.parent / name).is_file() for name in found[2].decode().split("/") if name)


# --- the page ---

def make_page(asked: Asked):
    """The Page and what its template takes."""
    from .page import Page
    with trusted(asked.folder):
        page = Page(asked)
    return page, {**page.content(), "mark": mark(asked.folder), "made_of": ""}


def reproduce(folder: Path) -> List[str]:
    """Lines with the commands, versions and checksums of a folder."""
    from .reproduce import list_reproduce_commands
    with trusted(folder):
        return list_reproduce_commands(folder)


@contextmanager
def trusted(folder: Path):
    """While it is read, what `slope study` wrote is trusted to be of the right kind: if it is not, one line."""
    try:
        yield
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
        raise SlopeError(folder, "must hold what a run or `slope study` wrote, unchanged",
                         f"{type(error).__name__}: {error}"[:200]) from error


def typeset(value):
    """What the template writes: units as in print; Markup, such as decks and logs, stays as it is."""
    return digits.typeset(value) if type(value) is str else value


@functools.lru_cache
def templates(more=Path()):
    """Those beside this file, of the 3-D view and in one more folder, each compiled once."""
    import jinja2
    from ..animation import view
    from . import sections
    loader = jinja2.FileSystemLoader([Path(__file__).parent, view.HERE, more])
    environment = jinja2.Environment(loader=loader, autoescape=True, trim_blocks=True, lstrip_blocks=True,
                                     undefined=jinja2.StrictUndefined, finalize=typeset)
    environment.filters.update(verbatim=sections.verbatim, kind=sections.kind, cell=sections.make_cell)
    return environment


def render(content, template=Path("report.html.j2")):
    """A page; template: beside this file, or one that extends it, elsewhere."""
    return templates(template.parent).get_template(template.name).render(content)
