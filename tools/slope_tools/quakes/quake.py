"""A ground motion from records of its components, and its files."""
from typing import NamedTuple, Optional, Sequence

import numpy as np
import yaml

from .. import disk
from ..errors import SlopeError
from . import quake_motion as motions, quake_records as records
from .quake_records import GAL


class Processing(NamedTuple):
    """What is done to a record."""
    azimuth: float = 90.0                       # compass bearing of the deck's x axis
    baseline: str = "rest"                      # or mean, or none
    window: Optional[Sequence[float]] = None    # s, begin and end
    band: Optional[Sequence[float]] = None      # Hz, low and high
    peak: Optional[float] = None                # gal, largest horizontal acceleration
    scale: Optional[float] = None               # or a factor


def processed(components, wanted: Processing):
    """The motion, and what was done to it, in order."""
    motion = motions.combine(components, wanted.azimuth)
    steps = [f"x axis towards {wanted.azimuth:g} degrees"]
    if wanted.baseline != "none":
        motion = motions.Motion(motion.dt, motion.a - motion.a.mean(axis=0))
        steps.append("mean taken off")
    if wanted.window:
        motion = motions.window(motion, *wanted.window)
        steps.append(f"{wanted.window[0]:g} to {wanted.window[1]:g} s")
    if wanted.band:
        motion = motions.band_pass(motion, *wanted.band)
        steps.append(f"band-pass {wanted.band[0]:g} to {wanted.band[1]:g} Hz")
    if wanted.baseline == "rest":
        motion = motions.at_rest(motion)
        steps.append("straight line taken off: ends at rest where it began")
    if not motions.find_largest_acceleration(motion) > 0:
        raise SlopeError(components[0].source, "must hold a motion, the acceleration is constant")
    if wanted.peak and not motions.peak(motion) > 0:
        raise SlopeError("--peak", "needs a horizontal component, whose acceleration it is (--scale takes any)",
                         ", ".join(f"{one.source} ({one.name})" for one in components))
    factor = wanted.peak * GAL / motions.peak(motion) if wanted.peak else wanted.scale or 1.0
    if factor != 1.0:
        motion = motions.scaled(motion, factor)
        steps.append(f"scaled by {factor:.6g}")
    if motions.find_largest_acceleration(motion) > records.MOST:
        raise SlopeError("--peak" if wanted.peak else "--scale",
                         f"must give a largest acceleration of at most {records.MOST / GAL:g} gal",
                         f"{motions.find_largest_acceleration(motion) / GAL:.6g}")
    return motion, steps


def write_quake(path, motion, summary):
    """All files beside, then under their names: none is half-written."""
    from . import quake_charts      # matplotlib: only once the input is known to be good

    head = "# acceleration of the ground for fix ground/motion: t ax ay az (s, m/s2)\n"
    head += "".join(f"# {'; '.join(summary[key])}\n" for key in ("records", "processing"))
    rows = "".join(f"{t:.9g} {x:.12g} {y:.12g} {z:.12g}\n" for t, (x, y, z) in zip(motion.t, motion.a))
    spectrum = "period,x,y,z\n" + "".join(
        f"{period:g},{x:.6g},{y:.6g},{z:.6g}\n" for period, (x, y, z) in
        zip(motions.PERIODS, np.asarray(motions.spectrum(motion)) / GAL))
    texts = {path.with_suffix(".spectrum.csv"): spectrum,
             path.with_suffix(".yaml"): yaml.safe_dump(summary, sort_keys=False), path: head + rows}
    with disk.write_beside(path.with_suffix(".png"), *texts) as (picture, *new):
        for part, content in zip(new, texts.values()):
            part.write_text(content, encoding="utf-8")
        title = (f"{summary['peak_gal']:.4g} gal" if summary["peak_gal"] > 0 else
                 f"vertical only, {summary['axes']['z']['acceleration_gal']:.4g} gal")
        quake_charts.draw_motion(picture, motion, f"{path.name}: {title}")
