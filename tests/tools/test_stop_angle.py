"""The stop angle of a ground of fixed balls: the table of measured ones, and what lies between them."""
import csv

import numpy as np
import pytest


from slope_tools.errors import SlopeError
from slope_tools.sites import stop_angle as module
from slope_tools.sites.stop_angle import stop_angle

with open(module.TABLE, encoding="utf-8", newline="") as lines:
    ROWS = list(csv.DictReader(lines))
PARAMETERS = ("spacing_d", "friction_deg", "rolling", "restitution")
SHEETS_OF_3 = [row for row in ROWS if float(row["layers"]) == 3]


def numbers(row):
    return [float(row[name]) for name in PARAMETERS]


def of(row):
    return stop_angle(*numbers(row), pattern=row["pattern"])


def test_the_table():
    assert len(SHEETS_OF_3) >= 60
    grounds = [(row["pattern"], *numbers(row), row["layers"]) for row in ROWS]
    assert len(set(grounds)) == len(grounds)
    for row in ROWS:
        least, angle, greatest = (float(row[name]) for name in ("least_deg", "stop_angle_deg", "greatest_deg"))
        assert (5 if row in SHEETS_OF_3 else 0) < least <= angle <= greatest < 45 and int(row["seeds"]) >= 2, row
        assert greatest - least <= 2, row


BACK = 0.5      # degrees by which a value may be below the one before it: a seed is of whole degrees, and there are two


@pytest.mark.parametrize("name", ["spacing_d", "friction_deg", "rolling"])
@pytest.mark.parametrize("layers", [3, 0.3])
def test_more_of_it_stops_on_a_steeper_slope(name, layers):
    lines = {}
    for row in (row for row in ROWS if float(row["layers"]) == layers):
        others = (row["pattern"], *(row[other] for other in PARAMETERS if other != name))
        lines.setdefault(others, []).append((float(row[name]), float(row["stop_angle_deg"])))
    lines = [sorted(line) for line in lines.values() if len(line) > 2]
    assert lines or (layers, name) == (0.3, "friction_deg")
    for line in lines:
        angles = np.array(line)[:, 1]
        assert (np.diff(angles) >= -BACK).all(), line
        assert angles[-1] > angles[0] + 1, line


@pytest.mark.parametrize("row", SHEETS_OF_3, ids=lambda row: "-".join(list(row.values())[:5]))
def test_exact_where_it_was_measured(row):
    found = of(row)
    assert found.degrees == pytest.approx(float(row["stop_angle_deg"]), abs=1e-6)
    assert found.outside == ""


def test_between():
    """Between two measured grounds: between their angles, by about what a ground left out is off."""
    one, two = stop_angle(0.7, 30, 0.05).degrees, stop_angle(0.8, 30, 0.05).degrees
    middle = stop_angle(0.75, 30, 0.05)
    assert one < middle.degrees < two
    assert middle.error == pytest.approx(np.sqrt(np.mean(np.square(module.left_out()))))
    assert 0.2 < middle.error < 1.5
    assert len(module.left_out()) > 10


@pytest.mark.parametrize("changed, words", [
    (dict(spacing=1.0), ["spacing must be 0.35 to 0.95", "got 1"]),
    (dict(spacing=0.3), ["spacing must be 0.35 to 0.95", "got 0.3"]),
    (dict(friction=60), ["friction must be", "got 60"]),
    (dict(rolling=0.5), ["rolling must be 0 to", "got 0.5"]),
    (dict(restitution=0.9), ["restitution must be", "got 0.9"]),
    (dict(rolling=float("nan")), ["rolling must be", "got nan"]),
    (dict(spacing=0.4, pattern="grid"), ["spacing must be 0.5 to 1", "got 0.4"]),
    (dict(spacing=2, friction=60), ["spacing must be", "got 2", "friction must be", "got 60"])])
def test_outside_of_the_table_there_is_none(changed, words):
    found = stop_angle(**{**dict(spacing=0.8, friction=30, rolling=0.05), **changed})
    assert found.degrees is None
    assert all(word in found.outside for word in words), found.outside
    assert found.outside.count("must be") == sum("must be" in word for word in words)


def test_ranges():
    ranges = stop_angle(0.8, 30, 0.05).ranges
    assert ranges["spacing"] == (0.35, 0.95)
    for name, column in zip(module.AXES, PARAMETERS):
        values = [float(row[column]) for row in SHEETS_OF_3 if name != "spacing" or row["pattern"] == "scattered"]
        assert ranges[name] == (min(values), max(values))
    assert stop_angle(1, 30, 0.05, pattern="grid").ranges["spacing"] == (0.5, 1.0)


def test_another_pattern():
    with pytest.raises(SlopeError, match="pattern: must be scattered or grid, got hexagonal"):
        stop_angle(0.8, 30, 0.05, pattern="hexagonal")
