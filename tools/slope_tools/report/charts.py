"""The charts of a study: its values against the first variable that it varies, compared with chance."""
from typing import Any, Dict, Mapping, Optional

from ..deposits import travel_shares
from ..drawing.figures import FULL, HALF, WIDE
from ..heads import is_number
from ..plots import figure_charts
from ..plots.figure_charts import Series
from ..runs.repeats import key_of
from ..statistics import conservative_volume, rounding
from ..tables.quantities import ALL, REMOVE, name_quantity
from .data import Data
from .numbers import Numbers
from .sections import Picture

AXIS = {"rolling": "rolling resistance (-)", "friction": "friction angle (degrees)", "restitution": "restitution (-)",
        "d": "diameter of the balls (m)", "field_d": "diameter of the field balls (m)",
        "spacing": "spacing of the ground's balls (diameters)", "angle": "direction of the ground's grid (degrees)",
        "peak": "peak acceleration (gal)"}
TERMS = {"rolling": "coefficient of rolling resistance of the balls", "friction": AXIS["friction"], "d": AXIS["d"],
         "field_d": "diameter of the field balls, which make the ground (m)",
         "spacing": "distance between the fixed balls of the ground, in their diameters: its roughness",
         "angle": "angle by which the plan grid of the ground's balls is turned (degrees)",
         "ground_seed": "seed of the places of the ground's balls",
         "packing": "number of the packing in which the balls start",
         "xoffset": "shift along x of the lattice on which the balls start, in lattice spacings",
         "yoffset": "the same along y", "zoffset": "the same along z",
         "seed": "seed of random numbers, such as those that displace the balls at the start"}


class Charts:
    """Draws the charts of a data.Data; reference: a reference.Reference or None."""

    def __init__(self, data: Data, reference):
        self.data, self.reference = data, reference
        self.scatter: Mapping[str, Optional[Mapping[str, float]]] = data.study.scatter if data.study else {}

    def variable(self):
        """The first variable with several values, rolling if it has; None if they are no numbers."""
        varied = [name for name, several in self.data.settings.items()
                  if len(several) > 1 and all(is_number(value) for value in several)]
        return "rolling" if "rolling" in varied else varied[0] if varied else None

    def has_removal(self) -> bool:
        """Whether something is to be removed: else its chart would be empty."""
        return any(row.value(REMOVE) for row in self.data.finished)

    def all(self):
        """Pictures; the first one is that of the volume to remove, if there is any."""
        data = self.data
        if not data.study or len(data.finished) < 2 or data.study.ensemble:
            return []
        far = [travel_shares.DISTANCE] if all(row.value(travel_shares.DISTANCE) is not None for row in data.finished) \
            else [] if any(row.left_box for row in data.finished) else ["front_m"]
        wanted = [*([REMOVE] if self.has_removal() else []), *far, "thickness_m"]
        wanted += [name for name in (self.reference.quantities if self.reference else ()) if name not in wanted]
        name = self.variable()
        return [self.bars(key) if name is None else self.chart(key, name) for key in wanted]

    def title(self, key):
        what = name_quantity(key, self.data.finished)
        return ALL[key].title or what[0].upper() + what[1:]

    def label(self, key):
        return f"{name_quantity(key, self.data.finished)} ({ALL[key].unit})"

    def bars(self, key):
        rows, title = self.data.finished, self.title(key)
        return Picture(figure_charts.bars([self.data.label_of(row) for row in rows], [row.value(key) for row in rows],
                                          self.label(key), title, WIDE if key == REMOVE else HALF),
                       title, f"{title} of every run.")

    def chart(self, key, name):
        """A quantity against a variable: a line where the differences are larger than chance."""
        data, title = self.data, self.title(key)
        scatter = self.scatter_of(key)
        lines: Dict[Any, Any] = {}
        for row in data.finished:
            rest = ", ".join(f"{other} {row.set[other]}" for other, several in data.settings.items()
                             if other != name and len(several) > 1)
            lines.setdefault(rest, []).append(row)
        own = self.reference and self.reference.quantities.get(key)
        series, clear = [], []
        for rest, rows in lines.items():
            rows = sorted(rows, key=lambda row: float(row.set[name]))
            clear.append(self.is_clear(key, rows, scatter))
            series.append(Series(rest or ("this study" if own else ""), [float(row.set[name]) for row in rows],
                                 [row.value(key) for row in rows], scatter and scatter.deviation, bool(clear[-1])))
        others, levels, mark = [], [], None
        several = any(len(rows) > 1 for rows in data.combinations().values())
        caption = (f"{title} against {name}; {'dots: runs, ' * several}{'larger dots: means' * several}"
                   f"{', bars: one standard deviation of a run' * bool(scatter and scatter.deviation)}"
                   f"{'; ' * several}{chance_text(clear)}.")
        if key == REMOVE:
            mark, level = self.mark(name)
            levels += level
        if own:
            if own.variable == name:
                others = [Series(who, *zip(*points)) for who, points in own.series.items()]
            levels += own.levels.items()
            caption += f" Grey: {self.reference.title}."
        return Picture(figure_charts.chart(series, AXIS.get(name, name), self.label(key), title, others, levels,
                                           mark, WIDE if key == REMOVE else FULL if own else HALF),
                       title, caption)

    def mark(self, name):
        """The point of the conservative volume, and its level where it is more than the point."""
        best = self.data.of_study.conservative
        if not best:
            return None, []
        volume = best.rounded["volume_m3"]
        if best.withheld or volume is None:
            return (float(best.set[name]), best.mean_m3, "governing mean, not usable"), []
        number = rounding.format_rounded(volume, best.place_m3)
        x = float(best.set[name])
        if best.chance_m3 is None:
            return (x, best.mean_m3, f"{best.kind.split(';')[0]}, {number} m3"), []
        return (x, best.mean_m3, "governing mean"), [(f"conservative volume, {number} m3", best.volume_m3)]

    def scatter_of(self, key):
        """The scatter of a run in a column; None without repeats."""
        best = self.data.study.conservative if self.data.study else None
        if key == REMOVE and best and best.scatter_m3 is not None:   # that of the governing combination
            return conservative_volume.Scatter(best.scatter_m3, best.degrees_of_freedom or 0.0)
        found = self.scatter.get(key)
        if found:
            return conservative_volume.Scatter(found["deviation"], found["degrees_of_freedom"])
        return conservative_volume.pooled(list(combinations(self.data.finished, key).values()))

    def is_clear(self, key, rows, scatter):
        """Whether the means of rows, which differ in one variable, differ by more than chance; None if unknown."""
        line = list(combinations(rows, key).values())
        if scatter is None or len(line) < 2:
            return None
        return conservative_volume.is_clear(line, scatter)


def combinations(rows, key):
    """{values of what was chosen: conservative_volume.Combination of a column}."""
    found: Dict[Any, Any] = {}
    for row in rows:
        found.setdefault(tuple(row.set.items()), {})[key_of(row.repeat)] = row.value(key)
    return {chosen: conservative_volume.Combination(str(chosen), volumes) for chosen, volumes in found.items()}


def chance_text(clear):
    """What a chart says of its differences."""
    if all(one is None for one in clear):
        return "one run each, so chance is unknown and no line is drawn"
    if all(clear):
        return "the differences are larger than chance"
    if not any(clear):
        return "the differences are no larger than chance: no trend, no line"
    return "a line where the differences are larger than chance"


def differences(data: Data, numbers: Numbers):
    """Sentences on what the variables do to the conservative volume, against chance."""
    best = data.study.conservative if data.study else None
    bars = []
    for entry in best.differences if best else ():
        if entry.by_m3 == 0:
            bars.append(f"{entry.variable}: the means of all its values are the same, so that there is no trend.")
            continue
        by = numbers(f"difference over {entry.variable}", "m3", entry.by_m3)
        text = (f"{entry.variable}: the means at {entry.smallest_at} and {entry.largest_at} (the largest) "
                f"differ by {by} m3")
        if entry.clear is None:
            text += ", of one run each: chance unknown"
        else:
            chance = numbers(f"chance over {entry.variable}", "m3", entry.chance_m3)
            text += f", {'more than' if entry.clear else 'within'} chance ({chance} m3)"
            text += "" if entry.clear else ": no trend"
        bars.append(text + ".")
    return bars
