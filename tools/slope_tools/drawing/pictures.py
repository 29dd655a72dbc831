"""Writing a figure as a picture, whole or not at all."""
import io

import matplotlib

from .. import disk

matplotlib.use("Agg")  # no display is needed

from matplotlib import pyplot as plt  # noqa: E402  (after the backend is set)

DPI = 150       # of charts that are looked at on a screen


def save(figure, path, **options):
    """Write the figure as a PNG and close it; options: of savefig.

    It is drawn in memory first: matplotlib writes as it draws, and leaves half a picture if it is stopped.
    """
    drawn = io.BytesIO()
    try:
        # without the version of matplotlib: the same figure is the same file
        figure.savefig(drawn, **{"format": "png", "dpi": DPI, "metadata": {"Software": None}, **options})
    finally:
        plt.close(figure)
    disk.write(path, drawn.getvalue())
