"""What a report shows of the chain: how likely which volume reaches the road at a peak acceleration, and per year."""
import csv
from typing import Any, List, Optional

import numpy as np

from ..drawing import figures, pictures
from ..drawing.figures import COLOURS
from ..digits import cents
from ..errors import SlopeError
from ..findings import texts
from ..plots.ensemble_charts import THOUSANDS
from ..seismic import chain_files
from ..tables import study_types
from .data import Data
from .numbers import Numbers
from .sections import Cell, Figures, Listing, Picture, Section, Table, Text, strong

MOST_ROWS = 12          # of the contributions; smaller ones are joined
HOW = ("The runs release one body each. Bodies that fail together in an earthquake have their volumes added, the "
       "largest with the largest or as independent ones, whichever is the likelier to exceed a volume. The bounds hold "
       "for any dependence between them, and show whether there are enough runs and samples, not the doubt in "
       "strengths, hazard and model, nor what the masses do to each other on their way.")


def make_chain_section(data: Data, numbers: Numbers):
    """Of a data.Data; None without a chain, or where the volumes of its runs are withheld."""
    chain = data.study.chain if data.study else None
    if not chain or chain.withheld:
        return None
    for one in chain.per_year or ():
        for name, value in (("value", one.value), ("low", one.low), ("high", one.high)):
            numbers.rows.append((f"more than {one.more_than_m3:,.6g} m3 on the road: {name}", "per year", "",
                                 f"{value:.2g}", value))
    title = "How likely the road is blocked"
    caption = "P(V > v) at a peak acceleration, for volumes v on the road, with bounds of 90 %."
    if chain.per_year:
        caption += " Right: how often per year a volume is exceeded."
    doubts = texts(chain.doubts)
    return Section("chain", "From the earthquake to the road", [
        *(Text(strong(f"{text[0].upper()}{text[1:]}.")) for text in chain_files.sentences(chain)), Text(HOW),
        Figures([Picture(draw_chain(chain, per_year(data, chain), title), title, caption)]),
        Table("The bodies of slope stability. Share: of the failures in which a body takes part, how many are its.",
              ["body", Cell("volume", "m3"), "share", "runs", "finished"], bodies(chain, numbers)),
        parts(chain), Listing(doubts) if doubts else None])


def bodies(chain: study_types.Chain, numbers: Numbers) -> List[List[Any]]:
    """Rows of the table of bodies."""
    return [[one.body, "" if one.volume_m3 is None else
             numbers("volume", "m3", one.volume_m3, f"body {one.body}"),
             cents(one.weight), one.runs, one.finished] for one in chain.bodies]


def parts(chain: study_types.Chain) -> Optional[Table]:
    """The table of the contributions, neighbours joined to MOST_ROWS at most; None without a hazard curve."""
    if not chain.per_year:
        return None
    each = [one.contributions for one in chain.per_year]
    groups = np.array_split(np.arange(len(each[0])), min(len(each[0]), MOST_ROWS))
    rows = []
    for group in groups:
        low, high = each[0][group[0]]["from_gal"], each[0][group[-1]]["to_gal"]
        rows.append([f"{low:g} and more" if high is None else f"{low:g} to {high:g}",
                     *(f"{sum(one[k]['per_year'] for k in group):.2g}" for one in each)])
    return Table("Where the annual frequency comes from: contributions by peak acceleration, per year.",
                 [Cell("peak acceleration", "gal"), *(Cell(f"> {one:,.6g}", "m3") for one in chain.more_than_m3)],
                 rows)


def per_year(data: Data, chain: study_types.Chain):
    """Volume, frequency per year and its bounds (rows), of the file; None without a hazard curve."""
    if not chain.per_year:
        return None
    path = data.folder / chain_files.PER_YEAR
    try:
        with open(path, newline="", encoding="ascii") as lines:
            rows = csv.DictReader(lines)
            return np.array([[float(row[name]) for name in ("volume_m3", "per_year", "low", "high")]
                             for row in rows]).T.reshape(4, -1)
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise SlopeError(path, f"must be what `slope study --fragility` wrote ({error})") from error


def draw_chain(chain: study_types.Chain, yearly, title: str) -> str:
    """Left the curves against the peak, one for each volume; right the annual frequency against the volume."""
    with pictures.settings(figures.STYLE):
        figure, axes = pictures.subplots(1, 1 if yearly is None else 2, squeeze=False,
                                         figsize=(figures.WIDE if yearly is None else figures.FULL, 2.7))
        left, peaks = axes[0, 0], chain.peaks_gal
        for one, colour in zip(chain.curves, COLOURS):
            left.fill_between(peaks, one.low, one.high, color=colour, alpha=0.18, lw=0)
            left.plot(peaks, one.probability, color=colour, lw=1.4, label=f"more than {one.more_than_m3:,.6g} m3")
        left.set(xlim=(peaks[0], peaks[-1]), ylim=(0, 1.02), xlabel="peak acceleration (gal)",
                 ylabel="probability of more on the road")
        left.set_title(title, loc="left")
        left.legend(loc="upper left")
        if yearly is not None and (yearly[1] > 0).any():
            right, (volume, value, low, high) = axes[0, 1], yearly[:, yearly[1] > 0]
            least = 0.1 * value.min()
            right.fill_between(volume, np.maximum(low, least), high, color=COLOURS[0], alpha=0.18, lw=0)
            right.plot(volume, value, color=COLOURS[0], lw=1.4)
            right.set(yscale="log", ylim=(least, None), xlabel="volume on the road (m3)", ylabel="exceeded, per year")
            right.xaxis.set_major_formatter(THOUSANDS)
        for axis in axes[0]:
            axis.grid(color="#dddddd", lw=0.5)
            axis.set_axisbelow(True)
            axis.spines[["top", "right"]].set_visible(False)
        return figures.data_uri(figure, "svg")
