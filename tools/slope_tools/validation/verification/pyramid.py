"""On a pyramid the travel does not depend on how its raster lies

inputs/17_pyramid: a body on each of four faces of 35 degrees, the pyramid as it is and turned by 45 degrees; two seeds.
"""
import numpy as np

from .claims import AtMost, Claim, Control, Run

CASE = "17_pyramid"
AZIMUTHS, FACES = (0, 45), (1, 2, 3, 4)
DECK = Run("17_pyramid/in.pyramid")
SOURCE = "symmetry; the rotation test of AvaFrame"


def turn_pyramid_deck(deck, seeds=(1, 2)):
    return tuple(deck(azimuth=azimuth, seed=seed) for azimuth in AZIMUTHS for seed in seeds)


def travels(results):
    """Mean way down the face and to its left, m: azimuths by seeds by faces, twice."""
    distances = []
    for k, result in enumerate(results):
        azimuth = AZIMUTHS[k * len(AZIMUTHS) // len(results)]
        start, end = (result.frames(f"pyramid.{when}.dump") for when in ("start", "end"))
        for face in FACES:
            own = start["type"] == face                 # sorted by id, and none is lost
            dx, dy = ((end[axis] - start[axis])[own].mean() for axis in "xy")
            turn = np.radians(azimuth + 90 * (face - 1))
            distances.append((dx * np.cos(turn) + dy * np.sin(turn), dy * np.cos(turn) - dx * np.sin(turn)))
    return np.moveaxis(np.reshape(distances, (len(AZIMUTHS), -1, len(FACES), 2)), -1, 0)


def measure_face_spread(*results):
    """Largest difference of a face's mean travel from that of all eight, over the latter."""
    travel = travels(results)[0].mean(axis=1)
    return np.abs(travel - travel.mean()).max() / travel.mean()


CLAIMS = [
    Claim("pyramid_travel", "Four faces, turned by 0 and 45 degrees: largest difference of the travel from the mean, "
          "over that", "", SOURCE, turn_pyramid_deck(DECK), measure_face_spread, AtMost(0.04),
          Control("plan grid, spacing 1 d", turn_pyramid_deck(DECK(pattern="grid", spacing=1))), quick=False),
]
