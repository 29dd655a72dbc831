"""What a report shows of a study over an intensity: volume on the road against it, and how likely more is."""
from ..digits import chance, format_measured_share, percent
from ..drawing.figures import HALF
from ..plots import figure_charts
from ..plots.figure_charts import Series
from ..tables import study_types
from .data import Data
from .numbers import Numbers
from .sections import Figures, Picture, Section, Table

AXIS = {"peak": "peak acceleration (gal)", "pga": "peak acceleration (gal)"}
MOST_CURVES = 4         # probabilities in the chart


def make_intensity_section(data: Data, numbers: Numbers):
    """The table and the two charts of a data.Data; None without an intensity."""
    about = data.study.intensity if data.study else None
    if not about:
        return None
    name = about.variable
    pictures = [draw_intensity_volumes(data, about)]
    if about.more_than_m3:
        pictures.append(exceedance(about))
    heads = [*about.lines[0].set, AXIS.get(name, name), "runs", "mean", "smallest", "largest", "of the released",
             *(f"P(V > {volume:,.6g})" for volume in about.more_than_m3)]
    return Section("intensity", "Volume on the road against the intensity", [
        Table("Volumes on the road, m3 of ground, and the probability that a volume is exceeded: the share of the "
              f"equivalent runs, with its {percent(about.confidence)} confidence interval.", heads,
              rows(about, numbers), ()), Figures(pictures, "columns")])


def rows(about: study_types.Intensity, numbers: Numbers):
    """Of each point the other variables, the intensity, the number of runs, volumes, and probabilities as text."""
    found = []
    for line in about.lines:
        for point in line.points:
            of = ", ".join([*(f"{other} {value}" for other, value in line.set.items()),
                            f"{about.variable} {point.at:g}"])
            cells = [numbers(f"on the road, {what}", "m3", value, of)
                     for what, value in (("mean", point.mean_m3), ("smallest", point.smallest_m3),
                                         ("largest", point.largest_m3))]
            cells.append(format_measured_share(point.share_of_released))
            cells += [chance(one.probability, one.low, one.high) for one in point.exceed]
            found.append([*line.set.values(), f"{point.at:g}", point.runs, *cells])
    return found


def rest_of(line: study_types.Line, about: study_types.Intensity):
    """The other variables of a line in words; '' if there is only one line."""
    return ", ".join(f"{other} {value}" for other, value in line.set.items() if len(about.lines) > 1)


def draw_intensity_volumes(data: Data, about: study_types.Intensity):
    """The volume on the road against the intensity: runs and means, without a common scatter."""
    name, series = about.variable, []
    for line in about.lines:
        mine = [row for row in data.finished if all(row.set[other] == value for other, value in line.set.items())]
        series.append(Series(rest_of(line, about), [float(row.set[name]) for row in mine],
                             [row.value(about.quantity) for row in mine]))
    title = "Volume on the road"
    return Picture(figure_charts.chart(series, AXIS.get(name, name), "on the road (m3)", title, width=HALF), title,
                   f"{title} against {name}; dots: runs, larger dots: their means.")


def exceedance(about: study_types.Intensity):
    """P(V > v) against the intensity, a line for each volume and each combination of the other variables."""
    series = []
    for line in about.lines:
        rest = rest_of(line, about)
        for k, volume in enumerate(about.more_than_m3):
            series.append(Series(f"more than {volume:,.6g} m3{', ' * bool(rest)}{rest}",
                                 [point.at for point in line.points],
                                 [point.exceed[k].probability for point in line.points]))
    title = "Probability of more on the road"
    runs = sorted({point.runs for line in about.lines for point in line.points})
    caption = (f"Share of the runs at each intensity with more than a volume on the road; "
               f"{' to '.join(map(str, runs[:1] + runs[1:][-1:]))} runs each. Lines join the points, and are no model.")
    shown = series[:MOST_CURVES]
    if len(shown) < len(series):
        caption += f" The first {MOST_CURVES} of {len(series)} curves."
    return Picture(figure_charts.chart(shown, AXIS.get(about.variable, about.variable),
                                       "share of the runs (-)", title, width=HALF), title, caption)
