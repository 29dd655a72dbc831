"""The picture of a motion: acceleration, velocity, displacement against time, intensity, response spectrum."""
from ..drawing import pictures
from ..drawing.figures import COLOURS, DPI, STYLE
from .quake_motion import AXES, DAMPING, PERIODS, husid, integrals, spectrum
from .quake_records import GAL


def draw_motion(path, motion, title):
    """Write the picture as PNG."""
    v, d = integrals(motion)
    with pictures.settings(STYLE):
        figure = pictures.figure(figsize=(9.0, 5.4))
        axes = figure.subplot_mosaic([["a", "s"], ["v", "s"], ["d", "h"]], width_ratios=[2, 1])
        curves = (("a", motion.a / GAL, "acceleration (gal)"), ("v", v, "velocity (m/s)"), ("d", d, "displacement (m)"),
                  ("h", husid(motion), "Arias intensity (m/s)"))
        for key, values, label in curves:
            for k, axis in enumerate(AXES):
                axes[key].plot(motion.t, values[:, k], color=COLOURS[k], linewidth=0.6, label=axis)
            axes[key].set(ylabel=label, xlim=(0, motion.t[-1]))
        for key in "dh":
            axes[key].set_xlabel("time (s)")
        for k, values in enumerate(spectrum(motion).T):
            axes["s"].plot(PERIODS, values / GAL, color=COLOURS[k], linewidth=1.0, label=AXES[k])
        axes["s"].set(xscale="log", xlim=(PERIODS[0], PERIODS[-1]), ylim=(0, None), xlabel="period (s)",
                      ylabel=f"response acceleration, {100 * DAMPING:g} % (gal)")
        axes["s"].legend()
        figure.suptitle(title, fontsize=8.5)
        pictures.save(figure, path, dpi=DPI)
