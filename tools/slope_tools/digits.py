"""Volumes and limits in words: as many digits as a reader can use."""
import math
import re
from typing import Tuple

DIGITS = 5      # of a number in a message; more is known of none
SIGNIFICANT = 3     # of a number for those who read
UNITS = re.compile(r"\b(m)([23])\b")


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


def format_plain(text: str) -> str:
    """A number as text, never as a power of ten above 1: 100 of 1e+02."""
    return f"{float(text):.0f}" if re.fullmatch(r"-?[\d.]+e\+\d+", text) else text


def cents(share: float, digits: int = 2) -> str:
    """A share with so many digits, as it is: 0.02 %, 100 %."""
    return f"{format_plain(f'{100 * share:.{digits}g}')} %"


def percent(share: float, exact: bool = False) -> str:
    """A share with two digits, from 10 % on in whole per cents, near 100 % in tenths.

    exact: of something that was counted or measured, which may be none or all of it; else a probability, or a share
    that stands for one: never a certain 0 or 100 %.
    """
    value, least = 100 * share, 0.01 if exact else 0.1
    if exact and value in (0, 100):
        return f"{value:.0f} %"
    if abs(value) < least:
        return f"less than {least:g} %"
    if value > 99.9:
        return "more than 99.9 %"
    return f"{value:.2g} %" if abs(value) < 9.95 else f"{value:.0f} %" if value < 99 else f"{value:.1f} %"


def format_measured_share(share: float) -> str:
    """percent() of something that was counted or measured."""
    return percent(share, exact=True)


def chance(share: float, low: float, high: float) -> str:
    """A probability that so many of some runs show, with its bounds; where none or all of them do, the bound alone."""
    if share <= 0:
        return f"at most {percent(high)}"
    return f"at least {percent(low)}" if share >= 1 else f"{percent(share)} ({percent(low)} to {percent(high)})"


def three_at_least(value: float) -> str:
    """A number as lengths are written, on the console as on a page: 0.523, 167, 1,234."""
    return rounded(value, SIGNIFICANT)


def metres(value: float) -> str:
    """A length with its unit."""
    return f"{three_at_least(value)} m"


# --- the rule of reports: three significant digits, SI prefixes, words for nothing ---

PREFIXES = ((1e12, "T"), (1e9, "G"), (1e6, "M"), (1e3, "k"), (1.0, ""))
MILLION = 1e6       # m³, from which volumes are in millions


def three(value: float) -> str:
    """A number with three significant digits and commas, never as a power of ten: 16.3, 6,130, 0.0212."""
    value = to_three(value)
    return f"{value:,.{_place(value, SIGNIFICANT)}f}"


def to_three(value: float) -> float:
    return float(f"{value:.{SIGNIFICANT - 1}e}")


def si(value: float, unit: str) -> str:
    """A quantity with three digits and the prefix that suits it: 16.3 GN, 6.00 GJ, 0 N."""
    value = to_three(value)
    if value == 0:
        return f"0 {unit}"
    factor, prefix = next(((factor, prefix) for factor, prefix in PREFIXES if abs(value) >= factor), PREFIXES[-1])
    return f"{three(value / factor)} {prefix}{unit}"


def prefix(largest: float) -> Tuple[float, str]:
    """The factor and the prefix of an axis with values up to the largest."""
    return next(((factor, name) for factor, name in PREFIXES if largest >= factor), PREFIXES[-1])


def format_volume(value: float) -> str:
    """A volume with its unit, for messages: 33,885 m3, 4.52 million m3."""
    return f"{rounded(value / MILLION)} million m3" if value >= MILLION else f"{rounded(value)} m3"


def cubic(value: float) -> str:
    """A volume with its unit, for those who read: 6,130 m³, 4.52 million m³."""
    if abs(value) >= MILLION:
        return f"{three(value / MILLION)} million m³"
    return f"{three(value) if value else '0'} m³"


def typeset(text: str) -> str:
    """A text of the tools as a page and a picture have it; files and the console are ASCII."""
    return UNITS.sub(lambda match: f"{match[1]}{'²' if match[2] == '2' else '³'}", text)
