"""The claims that the package is held to: a module per case or question, with runs, closed forms, tolerances, controls.

`slope verify` runs them all, tests/decks/test_verification.py the quick ones. A module has a docstring, whose first
line is its title, CASE, the folder in inputs/ that it is about, and CLAIMS; SEEN, if it has one, are the other numbers
of the case's README. A new one is one more name in MODULES.
"""
import importlib

MODULES = ("restitution", "timestep", "slide_roll", "rolling_resistance", "apparent_restitution", "oblique_impact",
           "sticking_impact", "rolling", "collisions", "rough_gas", "tochigi", "column_collapse", "heap",
           "resting_heap", "ground_direction", "repose_walls", "axisymmetric", "flume", "pyramid", "penetration",
           "wall_force", "embankment")


def cases():
    """The modules of all cases, in the order of the report."""
    return [importlib.import_module(f"{__name__}.{name}") for name in MODULES]


def all_claims():
    """All claims, in the order of the report."""
    return [claim for case in cases() for claim in case.CLAIMS]


def all_seen():
    """All other numbers that READMEs of the cases show, in that order."""
    return [one for case in cases() for one in getattr(case, "SEEN", ())]
