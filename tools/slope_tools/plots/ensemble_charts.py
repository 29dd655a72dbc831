"""The charts of an ensemble, as data URIs: the hazard curve, and which variables a quantity depends on."""
from typing import NamedTuple, Sequence

import numpy as np
from matplotlib.ticker import MaxNLocator, PercentFormatter, StrMethodFormatter

from ..drawing import figures, pictures
from ..drawing.figures import COLOURS, GRAY, HALF, STYLE
from ..statistics.entries import KnownQuantile

THOUSANDS = StrMethodFormatter("{x:,.6g}")


class Bar(NamedTuple):
    """What a variable does: first-order and total index, and the errors of both."""
    name: str
    first: float
    first_error: float
    total: float
    total_error: float


def hazard_curve(points, quantiles: Sequence[KnownQuantile], x_label: str, title: str, what: str) -> str:
    """The share of what is above values, with its bounds and the quantiles; points: values (they rise), share, bounds.
    """
    values, share, low, high = points
    with pictures.settings(STYLE):
        figure, axes = pictures.subplots(figsize=(figures.WIDE, 2.7))
        end = values[-1] + 0.04 * (values[-1] - values[0] or 1)
        at = np.append(values, end)
        axes.fill_between(at, np.append(low, low[-1]), np.append(high, high[-1]), step="post", color=COLOURS[0],
                          alpha=0.18, lw=0, label="bounds, 90 %")
        axes.step(at, np.append(share, share[-1]), where="post", color=COLOURS[0], lw=1.4, label=what)
        for one in quantiles:
            if one.gap:
                axes.plot(one.gap, [1 - one.share] * 2, "-", lw=2.5, color=COLOURS[1])
            else:
                axes.plot([one.value], [1 - one.share], "o", ms=4, color=COLOURS[1])
            axes.annotate(f"{100 * one.share:g} %", (one.value, 1 - one.share), xytext=(4, 3),
                          textcoords="offset points", fontsize=6)
        axes.set(xlim=(values[0], end), ylim=(0, 1.02), xlabel=x_label, ylabel=f"share of {what} above")
        finish(axes, title)
        axes.yaxis.set_major_formatter(PercentFormatter(1, 0))
        axes.legend(loc="upper right")
        return figures.data_uri(figure, "svg")


def influence(bars: Sequence[Bar], title: str) -> str:
    """First-order and total indices of the variables, the largest on top."""
    with pictures.settings(STYLE):
        figure, axes = pictures.subplots(figsize=(HALF, 0.9 + 0.32 * len(bars)))
        for y, bar in enumerate(sorted(bars, key=lambda bar: bar.total)):
            axes.barh(y, bar.total, 0.62, color=COLOURS[0], alpha=0.3, label="with others (total)" if y == 0 else None)
            axes.barh(y, bar.first, 0.34, color=COLOURS[0], label="alone (first order)" if y == 0 else None)
            axes.errorbar([bar.total], [y], xerr=[bar.total_error], fmt="none", ecolor=GRAY, elinewidth=0.9,
                          capsize=2.5)
        axes.set_yticks(range(len(bars)), [one.name for one in sorted(bars, key=lambda bar: bar.total)])
        axes.set(xlim=(0, max(1.0, 1.05 * max(one.total + one.total_error for one in bars))),
                 xlabel="share of the variance that the variables make")
        finish(axes, title, "x")
        axes.legend(loc="lower right")
        return figures.data_uri(figure, "svg")


def against(x: Sequence[float], y: Sequence[float], x_label: str, y_label: str, title: str) -> str:
    """A dot for each run."""
    with pictures.settings(STYLE):
        figure, axes = pictures.subplots(figsize=(HALF, 2.1))
        axes.plot(x, y, "o", ms=2.8, color=COLOURS[0], alpha=0.75, mew=0)
        axes.set(xlabel=x_label, ylabel=y_label)
        finish(axes, title)
        return figures.data_uri(figure, "svg")


def finish(axes, title: str, grid: str = "both") -> None:
    """What all charts have in common."""
    axes.set_title(title, loc="left")
    axes.xaxis.set_major_locator(MaxNLocator(6))
    axes.xaxis.set_major_formatter(THOUSANDS if grid != "x" else StrMethodFormatter("{x:.2g}"))
    if grid != "x":
        axes.yaxis.set_major_formatter(THOUSANDS)
    axes.grid(axis=grid, color="#dddddd", lw=0.5)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
