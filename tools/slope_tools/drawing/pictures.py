"""Figures in memory, drawn with the same settings whatever a user's are, and written whole or not at all.

No pyplot: it would open windows, and a script that calls this package may have figures and settings of its own there.
"""
import io
import warnings
from contextlib import contextmanager
from typing import Any, Iterator, Mapping, Optional

import matplotlib
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from .. import disk

DPI = 150       # of charts that are looked at on a screen
SALT = "slope"  # of the names in an SVG: the same figure is the same file
# a letter that no font of matplotlib has is a box in the picture; a mask may have no rim
NO_HELP = ("Glyph .* missing from", "No contour levels were found")


@contextmanager
def settings(style: Optional[Mapping[str, Any]] = None) -> Iterator[None]:
    """matplotlib's defaults and a style meanwhile, not what the user or a script has set; all drawing is in here.

    A matplotlibrc may turn the rows of a map (image.origin), or need LaTeX (text.usetex).
    """
    with matplotlib.rc_context(), warnings.catch_warnings():
        for text in NO_HELP:
            warnings.filterwarnings("ignore", text, UserWarning)
        matplotlib.rcdefaults()
        matplotlib.rcParams.update({"svg.hashsalt": SALT, **(style or {})})
        yield


def require_settings() -> None:
    """Raise RuntimeError outside of settings()."""
    if matplotlib.rcParams["svg.hashsalt"] != SALT:
        raise RuntimeError("pictures are drawn within settings(), or they would be those of the user")


def figure(**options: Any) -> Figure:
    """A new figure; options: matplotlib's."""
    require_settings()
    made = Figure(**options)
    FigureCanvasAgg(made)
    return made


def subplots(rows: int = 1, columns: int = 1, *, figsize: Any, dpi: Optional[float] = None, **options: Any) -> Any:
    """A new figure with rows x columns of axes; options: of matplotlib's subplots."""
    made = figure(figsize=figsize, dpi=dpi)
    return made, made.subplots(rows, columns, **options)


def encode_figure(figure_: Figure, **options: Any) -> bytes:
    """A figure as the content of a file; options: of savefig, without them a PNG.

    Without the version of matplotlib: the same figure is the same file.
    """
    require_settings()
    out = io.BytesIO()
    figure_.savefig(out, **{"format": "png", "dpi": DPI, "metadata": {"Software": None}, **options})
    return out.getvalue()


def save(figure_: Figure, path: Any, **options: Any) -> None:
    """Write a figure as a PNG, complete or not at all; options: of savefig."""
    disk.write_file(path, encode_figure(figure_, **options))
