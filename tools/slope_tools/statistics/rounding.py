"""Numbers rounded to what is known of them: to a power of ten, by their uncertainty or to three digits."""
import math

from ..digits import SIGNIFICANT, to_three

NOISE = dict.fromkeys(("m", "m2", "m3", "m/s"), 1e-6)      # of a unit: what sums of areas and lengths leave


def choose_rounding(uncertainty: float) -> float:
    """The power of ten that a number with this standard deviation (> 0) is rounded to: a 5th to a 50th of it."""
    return 10.0 ** math.floor(math.log10(uncertainty / 5) + 1e-9)


def place_of_digits(value: float, unit: str = "") -> float:
    """The power of ten that leaves three digits of a value; 1 of 0, and of less than the noise of its unit."""
    return 10.0 ** (math.floor(math.log10(abs(to_three(value))) + 1e-9) - SIGNIFICANT + 1) \
        if abs(value) > NOISE.get(unit, 0.0) else 1.0


def up(value: float, step: float) -> float:
    """A value rounded up to a multiple of a power of ten; a value within rounding of a multiple stays there."""
    return nearest(math.ceil(value / step - 1e-9) * step, step)


def down(value: float, step: float) -> float:
    """The same rounded down."""
    return nearest(math.floor(value / step + 1e-9) * step, step)


def nearest(value: float, step: float) -> float:
    """A value rounded to a multiple of a power of ten."""
    return round(value, -math.floor(math.log10(step) + 0.5))


def format_rounded(value: float, step: float) -> str:
    """A value rounded to a power of ten, with commas: 14,760 of 14757.3 and 10."""
    digits = max(0, -math.floor(math.log10(step) + 0.5))
    return f"{nearest(value, step):,.{digits}f}"
