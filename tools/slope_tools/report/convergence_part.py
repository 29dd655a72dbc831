"""Effect of the size of the balls on the numbers: converge.yaml of `slope sensitivity --converge`, for a report."""
from pathlib import Path
from typing import Any, List

from .. import schemas
from ..errors import SlopeError
from ..findings import Finding
from ..plots import figure_charts
from ..plots.figure_charts import Convergence
from ..statistics import headline
from ..tables.size_error import CONVERGE, WHAT
from .charts import AXIS
from .sections import Cell, Figures, Picture, Section, Table, marked

FILE = "converge.yaml"
PLUS = "\N{PLUS-MINUS SIGN}"


def find(asked, data):
    """The file, or None: what --converge names, itself or its folder; else what the study took its size error from.

    With the warning that there is none where the study names it, or None.
    """
    if asked:
        path = asked / FILE if asked.is_dir() else asked
        if not path.is_file():
            raise SlopeError("--converge", f"must be {WHAT}, or its folder", asked)
        return path, None
    size = ((data.study or {}).get("conservative") or {}).get("size") or {}
    if not size.get("file"):
        return None, None
    named = Path(str(size["file"]))
    for path in (data.folder / named, named):       # older files name it from where `slope study` was called
        if path.is_file():
            return path, None
    return None, Finding("no file of sizes", {"file": str(data.folder / named)})


class Sizes:
    """The fits in a file."""

    def __init__(self, path):
        self.path = path
        about = schemas.load(path, WHAT, CONVERGE)
        study, entries = about["study"], about["quantities"]
        self.variable, self.deck, self.runs = study["variable"], study["deck"], study["finished"]
        for name, entry in entries.items():
            one = entry["small_balls"]
            ends = [one[side] for side in ("low", "high") if one[side] is not None]
            if len(ends) == 1 or ends and not ends[0] <= one["value"] <= ends[1]:
                raise SlopeError(path, f"must be {WHAT}: quantities: {name}: small_balls must have a value between low "
                                 "and high, or neither of these")
        self.fits = {name: fit(entry) for name, entry in entries.items()}
        self.about = {name: (entry["name"], entry["unit"]) for name, entry in entries.items()}
        self.errors = {name: [(size["value"], size["error_percent"], size["standard_error_percent"])
                              for size in entry["sizes"]] for name, entry in entries.items()}

    def section(self, numbers):
        return Section("sizes", "Size of the balls", [
            Table(f"Value extrapolated to small balls by a line through runs of several values of {self.variable} "
                  f"({self.deck}), and the error at each size, with its standard error.",
                  ["quantity", "small balls (95 %)", f"error at {self.variable}"], self.rows(numbers), (0, 2),
                  style=""),
            Figures(self.pictures(), "columns")])

    def pictures(self):
        """A chart for each quantity."""
        found = []
        for name, one in self.fits.items():
            what, unit = self.about[name]
            title = f"{what[0].upper()}{what[1:]} against {self.variable}"
            interval = "" if one.low is None else ", with its 95 % interval"
            bars = "; bars: one standard deviation of a run" if any(one.scatter) else ""
            caption = (f"{title}: the line through the means ends at the value for small balls{interval}{bars}; "
                       f"{self.runs} runs of {self.deck}.")
            found.append(Picture(figure_charts.convergence(one, AXIS.get(self.variable, self.variable),
                                                           f"{what} ({unit})", title), title, caption))
        return found

    def rows(self, numbers):
        """Of the table: quantity, value for small balls with interval, and the error at each size."""
        found: List[List[Any]] = []
        for name, one in self.fits.items():
            what, unit = self.about[name]
            half = None if one.low is None else (one.high - one.low) / 2
            step = headline.place(half / 2) if half else headline.place_of_digits(one.small)
            small = headline.text(one.small, step) + (f" {PLUS} {headline.text(half, step)}" if half else "")
            numbers.rows.append((f"small balls: {what}", unit, "", headline.text(one.small, step), one.small))
            errors = "; ".join(
                f"{size:g}: " + ("unknown" if error is None else f"{error:+.1f} %" + (
                    f" {PLUS} {deviation:.1f}" if deviation is not None else ""))
                for size, error, deviation in self.errors[name])
            if one.supported is False:
                errors += "; " + marked("the line is not supported by its runs", "status doubt")
            found.append([Cell(what, unit), small, errors])
        return found


def fit(entry):
    """The Convergence of a quantity."""
    sizes, small = entry["sizes"], entry["small_balls"]
    return Convergence([size["value"] for size in sizes], [size["mean"] for size in sizes],
                       [size["scatter"] for size in sizes], small["value"], entry["slope"]["value"], small["low"],
                       small["high"], entry["supported"])
