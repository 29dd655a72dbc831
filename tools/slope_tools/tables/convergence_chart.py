"""The chart of `slope sensitivity --converge`: every run and the means, over the thickness in balls."""
from matplotlib.ticker import StrMethodFormatter

from ..drawing import pictures
from ..drawing.figures import COLOURS, FULL, GRAY, STYLE


def draw_convergence(path, variable, panels, title):
    """Write the chart (PNG); panels: list of (name, unit, Convergence, [(size, value of a run), ...])."""
    with pictures.settings(STYLE):
        width = FULL if len(panels) > 1 else 0.6 * FULL
        figure, axes = pictures.subplots(1, len(panels), figsize=(width, 2.9), squeeze=False)
        for axis, (name, unit, fit, points) in zip(axes[0], panels):
            thick = {size.d: size.balls for size in fit.sizes if size.balls is not None}
            at = (lambda d: thick[d]) if thick else (lambda d: d)
            axis.plot([at(size) for size, _ in points], [value for _, value in points], "o", color=GRAY, ms=3,
                      mfc="none", mew=0.7, label="runs")
            axis.errorbar([at(size.d) for size in fit.sizes], [size.mean for size in fit.sizes],
                          [size.scatter or 0.0 for size in fit.sizes], fmt="-D", color=COLOURS[1], ms=3.5, lw=0.9,
                          capsize=2.5, label="means, and the scatter of a run")
            axis.set_title(f"{name} ({unit})", loc="left")
            axis.set_xlabel("balls over the thickness of the body" if thick else variable)
            axis.set_xlim(left=0)
            axis.yaxis.set_major_formatter(StrMethodFormatter("{x:,.6g}"))
            axis.grid(color="#dddddd", lw=0.5)
            axis.set_axisbelow(True)
            axis.spines[["top", "right"]].set_visible(False)
            axis.legend(loc="best")
        figure.suptitle(title, fontsize=7.5, x=0.01, ha="left")
        pictures.save(figure, path)
