"""The chart of `slope calibrate`: what is known of each variable, and the regions over pairs of them."""
from pathlib import Path
from typing import Sequence

import numpy as np

from ..drawing import palettes, pictures
from ..drawing.figures import COLOURS, FULL, GRAY, STYLE
from ..statistics.backanalysis import Posterior, SHARE

BINS = 30


def draw_posterior(path: Path, posterior: Posterior, variables: Sequence, runs: np.ndarray, title: str) -> None:
    """Write the chart (PNG). runs: points of the unit cube where runs were made; variables: distributions.Range."""
    number = len(variables)
    with pictures.settings(STYLE):
        side = min(FULL, 2.1 * number + 0.6)
        figure, axes = pictures.subplots(number, number, figsize=(side, side), squeeze=False)
        for row in range(number):
            for column in range(number):
                axis = axes[row][column]
                if column > row:
                    axis.set_axis_off()
                elif column == row:
                    one_variable(axis, posterior, row, variables[row])
                else:
                    draw_variable_pair(axis, posterior, column, row, variables, runs)
                if row == number - 1:
                    axis.set_xlabel(variables[column].name)
                if column == 0 and row > 0:
                    axis.set_ylabel(variables[row].name)
        figure.suptitle(f"{title}; coloured: the {100 * SHARE:g} % region; cross: best values; dots: runs", fontsize=7,
                        x=0.01, ha="left")
        pictures.save(figure, path)


def map_to_values(variable, places: np.ndarray) -> np.ndarray:
    """Values of a variable at places from 0 to 1."""
    return np.array([float(variable.frozen.ppf(place)) for place in np.clip(places, 0, 1)])


def one_variable(axis, posterior: Posterior, i: int, variable) -> None:
    """How the weight lies over the range of a variable, with its interval."""
    edges = np.linspace(0, 1, BINS + 1)
    density = np.histogram(posterior.points[:, i], edges, weights=posterior.weights)[0]
    axis.stairs(density, map_to_values(variable, edges), color=COLOURS[0], fill=True, alpha=0.5)
    low, high = map_to_values(variable, np.array(posterior.interval(i)))
    axis.axvspan(low, high, color=COLOURS[0], alpha=0.12, lw=0)
    axis.axvline(float(map_to_values(variable, posterior.best[i:i + 1])[0]), color="#c1121f", lw=1)
    axis.set(xlim=(variable.low, variable.high), yticks=[])


def draw_variable_pair(axis, posterior: Posterior, i: int, j: int, variables: Sequence, runs: np.ndarray) -> None:
    """The region over two variables, the runs and the best values."""
    region = posterior.pair(i, j)
    edges = [map_to_values(variables[k], np.linspace(low, high, len(region.density) + 1))
             for k, low, high in zip((i, j), region.low, region.high)]
    shown = np.ma.masked_where(~region.inside, region.density)
    axis.pcolormesh(*edges, shown.T, cmap=palettes.DENSITY, vmin=0, vmax=region.density.max())
    axis.plot(map_to_values(variables[i], runs[:, i]), map_to_values(variables[j], runs[:, j]), ".", color=GRAY, ms=2.5,
              mew=0)
    best = [float(map_to_values(variables[k], posterior.best[k:k + 1])[0]) for k in (i, j)]
    axis.plot(*best, "+", color="#c1121f", ms=9, mew=1.4)
    axis.set(xlim=(variables[i].low, variables[i].high), ylim=(variables[j].low, variables[j].high))
