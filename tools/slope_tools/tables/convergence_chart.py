"""The chart of `slope sensitivity --converge`: every run, the line, and its end at size 0 with the 95 % interval."""
import numpy as np
from matplotlib.ticker import StrMethodFormatter

from ..drawing import pictures
from ..drawing.figures import COLOURS, FULL, GRAY, STYLE

NAMES = {"d": "diameter of the balls d (m)"}


def draw(path, variable, panels, title):
    """Write the chart (PNG); panels: list of (name, unit, Convergence, [(size, value of a run), ...])."""
    with pictures.settings(STYLE):
        width = FULL if len(panels) > 1 else 0.6 * FULL
        figure, axes = pictures.subplots(1, len(panels), figsize=(width, 2.9), squeeze=False)
        for axis, (name, unit, fit, points) in zip(axes[0], panels):
            largest = max(size for size, _ in points)
            d = np.linspace(0, 1.04 * largest, 200)
            line = [fit.line_at(one) for one in d]
            values = np.array([value for value, _ in line])
            if fit.quantile is not None and fit.small.standard_error is not None:
                half = fit.quantile * np.array([error for _, error in line])
                axis.fill_between(d, values - half, values + half, color=COLOURS[0], alpha=0.15, lw=0,
                                  label="95 % interval")
            axis.plot(d, values, color=COLOURS[0], lw=1.2, label="line" if fit.supported is not False
                      else "line, not supported by the runs")
            axis.plot(*zip(*points), "o", color=GRAY, ms=3, mfc="none", mew=0.7, label="runs")
            axis.plot([size.d for size in fit.sizes], [size.mean for size in fit.sizes], "D", color=COLOURS[1], ms=3.5,
                      label="means")
            interval = fit.interval
            axis.errorbar([0], [fit.small.value], None if interval is None else (interval[1] - interval[0]) / 2,
                          fmt="s", color=COLOURS[0], ms=4.5, capsize=3, lw=1.2, label=f"value for small {variable}",
                          clip_on=False)
            axis.set_title(f"{name} ({unit})", loc="left")
            axis.set_xlabel(NAMES.get(variable, variable))
            axis.set_xlim(0, 1.04 * largest)
            axis.yaxis.set_major_formatter(StrMethodFormatter("{x:,.6g}"))
            axis.grid(color="#dddddd", lw=0.5)
            axis.set_axisbelow(True)
            axis.spines[["top", "right"]].set_visible(False)
            axis.legend(loc="best")
        figure.suptitle(title, fontsize=7.5, x=0.01, ha="left")
        pictures.save(figure, path)
