"""The page of a report as HTML, and its pictures as files."""
import base64
import re
from pathlib import Path

from .. import disk
from ..errors import SlopeError


def write_pictures(output, html):
    """The page's PNG pictures, its maps, as files beside it."""
    pictures = re.findall(r"data:image/png;base64,([A-Za-z0-9+/=]+)", html)
    for place, picture in enumerate(pictures, 1):
        disk.write(output.with_suffix(f".{place}.png"), base64.b64decode(picture))
    print(f"{output.with_suffix('.1.png')} to {len(pictures)}: its maps")


def make(args):
    """The Page and its HTML. What `slope study` wrote is trusted to be of the right kind: if it is not, one line."""
    import jinja2
    from .page import Page
    try:
        page = Page(args)
        return page, render(page.content())
    except (jinja2.TemplateError, ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
        raise SlopeError(args.folder, "must hold what a run or `slope study` wrote, unchanged",
                         f"{type(error).__name__}: {error}"[:200]) from error


def render(content):
    """The page, from the template beside this file."""
    import jinja2
    loader = jinja2.FileSystemLoader(Path(__file__).parent)
    environment = jinja2.Environment(loader=loader, autoescape=True, trim_blocks=True, lstrip_blocks=True,
                                     undefined=jinja2.StrictUndefined)
    environment.filters.update(percent=lambda value: f"{100 * value:.1f} %",
                               fixed=lambda value, digits=1: f"{value:,.{digits}f}")
    return environment.get_template("report.html.j2").render(content)
