"""Volumes and limits in words: as many digits as a reader can use."""
import math

DIGITS = 5      # of a number in a message; more is known of none


def _place(value: float, digits: int) -> int:
    """Decimals of a number with so many digits, at least 0."""
    return max(0, digits - 1 - math.floor(math.log10(abs(value)))) if value and math.isfinite(value) else 0


def rounded(value: float, digits: int = DIGITS) -> str:
    """A number >= 0 with so many digits, never without its whole part: 30,490 or 523.27."""
    text = f"{value:,.{_place(value, digits)}f}"
    return text.rstrip("0").rstrip(".") if "." in text else text


def at_most(value: float, digits: int = DIGITS) -> str:
    """An upper limit as a number that may be given: rounded towards 0, to whole ones if it is large."""
    power = 10 ** _place(value, digits)
    return f"{math.floor(value * power) / power:.15g}"


def at_least(value: float, digits: int = DIGITS) -> str:
    """A lower limit as a number that may be given."""
    power = 10 ** _place(value, digits)
    return f"{math.ceil(value * power) / power:.15g}"
