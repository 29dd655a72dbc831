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
    intensity = data.study.intensity if data.study else None
    if not intensity:
        return None
    name = intensity.variable
    pictures = [draw_intensity_volumes(data, intensity)]
    if intensity.more_than_m3:
        pictures.append(exceedance(intensity))
    heads = [*intensity.lines[0].set, AXIS.get(name, name), "runs", "mean", "smallest", "largest", "of the released",
             *(f"P(V > {volume:,.6g})" for volume in intensity.more_than_m3)]
    return Section("intensity", "Volume on the road against the intensity", [
        Table("Volumes on the road, m3 of ground, and the probability that a volume is exceeded: the share of the "
              f"equivalent runs, with its {percent(intensity.confidence)} confidence interval.", heads,
              rows(intensity, numbers), ()), Figures(pictures, "columns")])


def rows(intensity: study_types.Intensity, numbers: Numbers):
    """Of each point the other variables, the intensity, the number of runs, volumes, and probabilities as text."""
    table = []
    for line in intensity.lines:
        for point in line.points:
            of = ", ".join([*(f"{other} {value}" for other, value in line.set.items()),
                            f"{intensity.variable} {point.at:g}"])
            cells = [numbers(f"on the road, {what}", "m3", value, of)
                     for what, value in (("mean", point.mean_m3), ("smallest", point.smallest_m3),
                                         ("largest", point.largest_m3))]
            cells.append(format_measured_share(point.share_of_released))
            cells += [chance(one.probability, one.low, one.high) for one in point.exceed]
            table.append([*line.set.values(), f"{point.at:g}", point.runs, *cells])
    return table


def rest_of(line: study_types.Line, intensity: study_types.Intensity):
    """The other variables of a line in words; '' if there is only one line."""
    return ", ".join(f"{other} {value}" for other, value in line.set.items() if len(intensity.lines) > 1)


def draw_intensity_volumes(data: Data, intensity: study_types.Intensity):
    """The volume on the road against the intensity: runs and means, without a common scatter."""
    name, series = intensity.variable, []
    for line in intensity.lines:
        mine = [row for row in data.finished if all(row.set[other] == value for other, value in line.set.items())]
        series.append(Series(rest_of(line, intensity), [float(row.set[name]) for row in mine],
                             [row.value(intensity.quantity) for row in mine]))
    title = "Volume on the road"
    return Picture(figure_charts.chart(series, AXIS.get(name, name), "on the road (m3)", title, width=HALF), title,
                   f"{title} against {name}; dots: runs, larger dots: their means.")


def exceedance(intensity: study_types.Intensity):
    """P(V > v) against the intensity, a line for each volume and each combination of the other variables."""
    series = []
    for line in intensity.lines:
        rest = rest_of(line, intensity)
        for k, volume in enumerate(intensity.more_than_m3):
            series.append(Series(f"more than {volume:,.6g} m3{', ' * bool(rest)}{rest}",
                                 [point.at for point in line.points],
                                 [point.exceed[k].probability for point in line.points]))
    title = "Probability of more on the road"
    runs = sorted({point.runs for line in intensity.lines for point in line.points})
    caption = (f"Share of the runs at each intensity with more than a volume on the road; "
               f"{' to '.join(map(str, runs[:1] + runs[1:][-1:]))} runs each. Lines join the points, and are no model.")
    shown = series[:MOST_CURVES]
    if len(shown) < len(series):
        caption += f" The first {MOST_CURVES} of {len(series)} curves."
    return Picture(figure_charts.chart(shown, AXIS.get(intensity.variable, intensity.variable),
                                       "share of the runs (-)", title, width=HALF), title, caption)
