"""Effect of the size of the balls on the numbers: converge.yaml of `slope sensitivity --converge`, for a report."""
from typing import Any, Dict, List

from .. import schemas
from ..errors import SlopeError
from ..plots import figure_charts
from ..plots.figure_charts import Convergence
from ..schemas import ABOVE_0, FLAG, MAYBE, NUMBER, TEXT, list_of, mapping, dict_of
from ..statistics import rounding
from .charts import AXIS
from .numbers import Numbers
from .sections import Cell, Figures, Picture, Section, Table, marked

FILE = "converge.yaml"
WHAT = "a converge.yaml of `slope sensitivity --converge`, of this version"
NAME: Dict[str, Any] = {**TEXT, "minLength": 1}
CONVERGE = mapping({
    "study": mapping({"variable": TEXT, "deck": TEXT, "finished": NUMBER}),
    "quantities": dict_of(mapping({
        "name": NAME, "unit": TEXT, "resolved": FLAG,
        "sizes": list_of(mapping({"value": ABOVE_0, "mean": NUMBER, "scatter": MAYBE, "balls_thick": MAYBE}), 1)}), 1)})


def find(asked):
    """The file that --converge names, itself or by its folder; None without it."""
    if not asked:
        return None
    path = asked / FILE if asked.is_dir() else asked
    if not path.is_file():
        raise SlopeError("--converge", f"must be {WHAT}, or its folder", asked)
    return path


class Sizes:
    """The quantities in a file."""

    def __init__(self, path):
        about = schemas.load_checked(path, WHAT, CONVERGE)
        study, self.entries = about["study"], about["quantities"]
        self.variable, self.deck, self.runs = study["variable"], study["deck"], study["finished"]

    def section(self, numbers: Numbers):
        return Section("sizes", "Size of the balls", [
            Table(f"Means of runs of several values of {self.variable} ({self.deck}). Nothing is said of smaller balls "
                  "than the smallest here.",
                  ["quantity", f"mean at {self.variable}", "resolved"], self.rows(numbers), (0,), style=""),
            Figures(self.pictures(), "columns")])

    def pictures(self):
        """A chart for each quantity."""
        pictures = []
        for entry in self.entries.values():
            what, unit, sizes = entry["name"], entry["unit"], entry["sizes"]
            thick = all(size["balls_thick"] is not None for size in sizes)
            label = "balls over the thickness of the body" if thick else AXIS.get(self.variable, self.variable)
            title = f"{what[0].upper()}{what[1:]} against the {'size of the balls' if thick else self.variable}"
            one = Convergence([size["balls_thick" if thick else "value"] for size in sizes],
                              [size["mean"] for size in sizes], [size["scatter"] for size in sizes])
            pictures.append(Picture(figure_charts.convergence(one, label, f"{what} ({unit})", title), title,
                                    f"{title}; {self.runs} runs of {self.deck}."))
        return pictures

    def rows(self, numbers: Numbers):
        """Of the table: quantity, the mean at each size, whether it is resolved."""
        rows: List[List[Any]] = []
        for entry in self.entries.values():
            texts = []
            for size in entry["sizes"]:
                text = rounding.format_rounded(size["mean"], rounding.choose_rounding(size["scatter"])
                                               if size["scatter"] else rounding.place_of_digits(size["mean"]))
                numbers.rows.append((f"{entry['name']} at {self.variable} {size['value']:g}", entry["unit"], "", text,
                                     size["mean"]))
                thick = size["balls_thick"]
                texts.append(f"{size['value']:g}{f' ({thick:.1f} balls thick)' if thick is not None else ''}: {text}")
            rows.append([Cell(entry["name"], entry["unit"]), "; ".join(texts),
                         "yes" if entry["resolved"] else marked("no", "status doubt")])
        return rows
