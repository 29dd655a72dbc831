"""Types of options on the command line."""
import argparse
import math
import re

MOST = 10 ** 9      # of anything counted; more exceeds any memory or time


def add_overwrite(parser):
    """--overwrite, for disk.check_standing()."""
    parser.add_argument("--overwrite", action="store_true", help="replace files of the same names that are not the "
                        "result of the same input (default: refuse)")


def number(text):
    """argparse type: a finite number."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(f"must be a finite number, got {text!r}")
    return value


def whole(text):
    """argparse type: a whole number, of either sign."""
    if not re.fullmatch(r"[-+]?0*[0-9]{1,18}", text):
        raise argparse.ArgumentTypeError(f"must be a whole number of at most 18 digits, got {text!r}")
    return int(text)


def count(text):
    """argparse type: a whole number from 1 to MOST."""
    if not re.fullmatch(r"0*[1-9][0-9]*", text):
        raise argparse.ArgumentTypeError(f"must be a whole number >= 1, got {text!r}")
    if len(text.lstrip("0")) > len(str(MOST)) or int(text) > MOST:
        raise argparse.ArgumentTypeError(f"must be a whole number <= {MOST}, got {text!r}")
    return int(text)
