"""What happens to a record before a deck gets it, and the numbers that describe it.

Between two points the acceleration is a straight line, here as in fix ground/motion: velocity, displacement and
intensity are exact integrals of that.
"""
from dataclasses import dataclass

import numpy as np
import scipy

from ..errors import SlopeError
from .quake_records import G, GAL, UP

AXES = ("x", "y", "z")
DAMPING = 0.05
PERIODS = np.round(np.geomspace(0.05, 10.0, 60), 4)    # s
POINTS = 40          # per period, at which the response of an oscillator is known: its largest to 0.3 %
ORDER = 4            # of the Butterworth band-pass, run forth and back
TAPER = 0.05         # of the record, at each end, before a band-pass


@dataclass
class Motion:
    """Accelerations along the deck's axes, (n, 3) in m/s2, every dt seconds from 0 on."""

    dt: float
    a: np.ndarray

    @property
    def t(self):
        return self.dt * np.arange(len(self.a))


def combine(components, azimuth):
    """Components of one event -> Motion; azimuth: compass bearing of the deck's x axis, in degrees."""
    first = components[0]
    for other in components[1:]:
        if abs(other.dt - first.dt) > 1e-9 * first.dt:
            raise SlopeError(other.source, f"must have the time step of {first.source}, {first.dt:g} s",
                             f"{other.dt:g} s")
        if other.begin != first.begin:
            raise SlopeError(other.source, f"must begin when {first.source} does, {first.begin or 'without a date'}",
                             other.begin or "no date")
        if other.sensor != first.sensor:
            raise SlopeError(other.source, f"must be of the sensor of {first.source}, {first.sensor or 'of K-NET'}",
                             other.sensor or "of K-NET")
    named = [c for c in components if c.of]
    for other in named[1:]:
        if other.of != named[0].of:
            raise SlopeError(other.source, f"must be of the earthquake and station of {named[0].source}, "
                             f"{named[0].of}", other.of)
    timed = [c for c in components if c.first_time is not None]
    for other in timed[1:]:
        if abs(other.first_time - timed[0].first_time) > 1e-3 * first.dt:
            raise SlopeError(other.source, f"must begin when {timed[0].source} does, {timed[0].first_time:g} s",
                             f"{other.first_time:g} s")
    flat = [c for c in components if c.direction != UP]
    if len(components) - len(flat) > 1 or len(flat) > 2:
        raise SlopeError(components[-1].source, "at most two horizontal components and a vertical one make a motion",
                         ", ".join(c.name for c in components))
    if len(flat) == 2 and abs(np.cos(np.radians(flat[0].direction - flat[1].direction))) > 0.02:
        raise SlopeError(flat[1].source, "two horizontal components must be at right angles",
                         " and ".join(c.name for c in flat))
    n = min(len(c.values) for c in components)    # those of PEER differ by some points
    a = np.zeros((n, 3))
    for c in components:
        if c.direction == UP:
            a[:, 2] += c.values[:n]
        else:
            turned = np.radians(azimuth - c.direction)    # from the component to the x axis, clockwise
            a[:, 0] += c.values[:n] * np.cos(turned)
            a[:, 1] += c.values[:n] * np.sin(turned)
    return Motion(first.dt, a)


def window(motion, begin, end):
    """The part between two times (s); it begins at time 0."""
    first, last = round(begin / motion.dt), round(end / motion.dt)
    if not 0 <= first < last - 1 or last > len(motion.a) - 1:
        raise SlopeError("--window", f"must be within the record, 0 to {motion.t[-1]:g} s, and three points long",
                         f"{begin:g} {end:g}")
    return Motion(motion.dt, motion.a[first:last + 1])


def band_pass(motion, low, high):
    """Without what is slower than low and faster than high (Hz); no delay; ends are tapered."""
    top = 0.5 / motion.dt
    if not 0 < low < high < top:
        raise SlopeError("--band", f"must be 0 < LOW < HIGH < {top:g} Hz, half of the sampling rate",
                         f"{low:g} {high:g}")
    sos = scipy.signal.butter(ORDER, [low, high], "bandpass", fs=1 / motion.dt, output="sos")
    n = len(motion.a)
    pad = min(n - 1, int(3 / low / motion.dt))
    tapered = motion.a * scipy.signal.windows.tukey(n, 2 * TAPER)[:, None]
    return Motion(motion.dt, scipy.signal.sosfiltfilt(sos, tapered, axis=0, padtype="constant", padlen=pad))


def at_rest(motion):
    """A straight line taken off each acceleration, so that the ground ends at rest where it began."""
    t = motion.t
    lines = Motion(motion.dt, np.stack([np.ones_like(t), t, 0 * t], axis=1))
    v, d = integrals(lines)
    matrix = np.array([v[-1, :2], d[-1, :2]])
    v, d = integrals(motion)
    return Motion(motion.dt, motion.a - lines.a[:, :2] @ np.linalg.solve(matrix, np.array([v[-1], d[-1]])))


def scaled(motion, factor):
    return Motion(motion.dt, factor * motion.a)


def peak(motion):
    """Largest horizontal acceleration, of both components together, m/s2."""
    return float(np.hypot(motion.a[:, 0], motion.a[:, 1]).max())


def find_largest_acceleration(motion):
    """Largest acceleration, horizontal or vertical, m/s2."""
    return max(peak(motion), float(np.abs(motion.a[:, 2]).max()))


# --- what describes a motion ---

def integrals(motion):
    """Velocity (m/s) and displacement (m) at the points."""
    a, h = motion.a, motion.dt
    v, d = np.zeros_like(a), np.zeros_like(a)
    v[1:] = np.cumsum(0.5 * h * (a[:-1] + a[1:]), axis=0)
    d[1:] = np.cumsum(h * v[:-1] + h * h * (2 * a[:-1] + a[1:]) / 6, axis=0)
    return v, d


def husid(motion):
    """Arias intensity (m/s) of each axis until each point."""
    a, total = motion.a, np.zeros_like(motion.a)
    total[1:] = np.cumsum(motion.dt * (a[:-1] ** 2 + a[:-1] * a[1:] + a[1:] ** 2) / 3, axis=0)
    return np.pi / (2 * G) * total


def duration(motion, until):
    """Time (s) in which the intensity `until`, one curve of husid(), rises from 5 to 95 % of its end."""
    if not until[-1] > 0:
        return 0.0
    early, late = np.interp([0.05, 0.95], until / until[-1], motion.t)
    return float(late - early)


def spectrum(motion, damping=DAMPING, periods=PERIODS):
    """Largest absolute acceleration (m/s2) of oscillators of these periods on each axis: (periods, 3)."""
    responses = np.empty((len(periods), 3))
    for k, period in enumerate(periods):
        w = 2 * np.pi / period
        parts = max(1, int(np.ceil(POINTS * motion.dt / period)))    # the largest may come between two points
        dt = motion.dt / parts
        fine = np.arange((len(motion.a) - 1) * parts + 1) / parts
        a = np.column_stack([np.interp(fine, np.arange(len(motion.a)), values) for values in motion.a.T])
        quiet = np.zeros((int(np.ceil(0.5 * period / dt)), 3))       # or after the end
        above, below, _ = scipy.signal.cont2discrete(([2 * damping * w, w * w], [1.0, 2 * damping * w, w * w]), dt,
                                                     "foh")
        responses[k] = np.abs(scipy.signal.lfilter(np.ravel(above), below, np.vstack([a, quiet]), axis=0)).max(axis=0)
    return responses


def measures(motion):
    """The numbers that are printed: per axis, by name."""
    v, d = integrals(motion)
    until = husid(motion)
    numbers = {}
    for k, axis in enumerate(AXES):
        numbers[axis] = {"acceleration_gal": float(np.abs(motion.a[:, k]).max() / GAL),
                         "velocity": float(np.abs(v[:, k]).max()), "displacement": float(np.abs(d[:, k]).max()),
                         "end_velocity": float(v[-1, k]), "end_displacement": float(d[-1, k]),
                         "arias": float(until[-1, k]), "duration_5_95": duration(motion, until[:, k])}
    return {"points": len(motion.a), "dt": float(motion.dt), "length": float(motion.t[-1]),
            "peak_gal": peak(motion) / GAL, "arias_horizontal": float(until[-1, 0] + until[-1, 1]),
            "duration_5_95_horizontal": duration(motion, until[:, 0] + until[:, 1]), "axes": numbers}
