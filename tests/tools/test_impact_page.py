"""The table of forces of single boulders on the page of structures is what its formulas give."""
import re
from pathlib import Path

import numpy as np
import pytest

PAGE = Path(__file__).resolve().parents[2] / "doc/src/structures.rst"
ROW = re.compile(r"^([0-9.]+) +([0-9]+) +([0-9.]+) +([0-9.]+) +([0-9.]+)$", re.MULTILINE)
DENSITY, MODULUS, LAME, G = 2600.0, 20.8e9, 1000.0, 9.81      # kg/m3, Pa, kN/m2, m/s2


def forces(diameter, speed):
    """MN: this model with an overlap of a tenth of the radius, Hertz, a cushion of sand."""
    radius = diameter / 2
    mass = DENSITY * np.pi / 6 * diameter ** 3
    stiffness = 4 / 3 * MODULUS * np.sqrt(radius)
    return [10 * mass * speed ** 2 / radius / 1e6,
            stiffness * (5 * mass * speed ** 2 / (4 * stiffness)) ** 0.6 / 1e6,
            2.108 * (mass * G / 1e3) ** (2 / 3) * LAME ** 0.4 * (speed ** 2 / (2 * G)) ** 0.6 / 1e3]


def test_the_rows_follow_from_the_formulas():
    rows = [[float(cell) for cell in row] for row in ROW.findall(PAGE.read_text(encoding="utf-8"))]
    assert len(rows) == 6
    for diameter, speed, *shown in rows:
        assert shown == pytest.approx(forces(diameter, speed), rel=0.005)
