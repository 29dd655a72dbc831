"""The ground of scattered balls has no direction, a plan grid has one

inputs/13_ground_direction: a body slides down a plane of 35 degrees onto a flat, all of it turned about the vertical.
Two layers of balls, 8 m wide, at three azimuths with four seeds each; in full in tests/ground_direction.py.
"""
import numpy as np

from .claims import AtMost, Claim, Control, Run

CASE = "13_ground_direction"
AZIMUTHS = 0, 22.5, 45              # degrees
SEEDS = 1, 2, 3, 4
SMALL = Run("13_ground_direction/in.ground_direction")(layers=2, wide=8)


def turn_ground_deck(deck):
    return tuple(deck(azimuth=azimuth, seed=seed) for azimuth in AZIMUTHS for seed in SEEDS)


def average_by_azimuth(name, results):
    """Means over the seeds by azimuth, m."""
    found = [result.number(name, "travel") for result in results]
    return np.reshape(found, (len(AZIMUTHS), -1)).mean(axis=1)


def measure_direction_spread(*results):
    """Largest difference of the mean travel at an azimuth from that of all, over the latter."""
    travel = average_by_azimuth("travel", results)
    return np.abs(travel - travel.mean()).max() / travel.mean()


def aside(*results):
    """Largest mean way aside at an azimuth over the travel."""
    return np.abs(average_by_azimuth("aside", results)).max() / average_by_azimuth("travel", results).mean()


CLAIMS = [
    Claim("ground_direction_travel",
          "Travel at azimuths 0, 22.5, 45 degrees: largest difference from the mean, over that", "", "isotropy",
          turn_ground_deck(SMALL), measure_direction_spread, AtMost(0.04),
          Control("plan grid, spacing 1 d", turn_ground_deck(SMALL(pattern="grid", spacing=1)))),
    Claim("ground_direction_aside", "Way aside at azimuths 0, 22.5, 45 degrees over the travel", "", "symmetry",
          turn_ground_deck(SMALL), aside, AtMost(0.02),
          Control("plan grid, spacing 1 d", turn_ground_deck(SMALL(pattern="grid", spacing=1)))),
]
