#!/usr/bin/python3
"""Whether a run with balls of half the size lies where a study's size error says: not in the suite, it takes minutes.

    tests/size_error_check.py SITE...

Each SITE is a folder of `slope site` with a road. Its study by the paper's method is made (finished runs are kept),
then the combination that governs with balls of half its size, at three positions of the lattice. Printed: the mean
volume to remove, what the line of the size error has for half the size, with its 95 % interval and the scatter of the
mean of three runs, and whether the runs lie within; and whether the size error is withheld, and why.
"""
import subprocess
import sys
from pathlib import Path

TOP = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(TOP / "tools"))

import numpy as np  # noqa: E402  (after the path is set)
import yaml  # noqa: E402
from slope_tools.case import decks  # noqa: E402
from slope_tools.errors import SlopeError  # noqa: E402
from slope_tools.sites import site_choices, site_deck, site_layers  # noqa: E402
from slope_tools.statistics.convergence import error_of_line  # noqa: E402
from slope_tools.tables.size_error import SizeErrors  # noqa: E402

QUANTITY = "remove_m3"


def slope(*words):
    """A command of SLOPE; a failed run is told by what it leaves out."""
    subprocess.run([TOP / "tools" / "slope", *map(str, words)], check=True, stdout=subprocess.DEVNULL)


def volumes(folder):
    """Mean of the governing combination, its values, the scatter of a run, and the whole study.yaml."""
    about = yaml.safe_load((folder / "study.yaml").read_text())
    best = about["conservative"]
    return best["mean_m3"], best["set"], best["scatter_m3"], about


def check(site):
    slope("study", site, "--paper")
    mean, chosen, scatter, about = volumes(site / "study")
    deck, road = site / site_deck.NAME, site_choices.read(site)["road"]
    d = float(chosen.get("d", decks.index_variables(deck)["d"]))
    half = site / "half"
    others = [word for name, value in chosen.items() if name != "d" for word in ("--set", f"{name}={value}")]
    slope("study", deck, "--set", f"d={d / 2:.10g}", *others, "--repeat", "xoffset=0.25,0.5", "--road",
          site / site_layers.ROAD, "--cut-angle", road["cut_angle"], "--mesh", road["mesh"], "-o", half)
    finer, _, chance, _ = volumes(half)
    print(f"{site}: {mean:,.0f} m3 with balls of {d:g} m, {finer:,.0f} m3 with balls of {d / 2:g} m (runs scatter by "
          f"{scatter:,.0f} and {chance:,.0f} m3)")
    try:
        errors = SizeErrors(site / "sizes" / "converge.yaml", QUANTITY)
        line = error_of_line(errors.small, errors.slope, errors.covariance, errors.quantile, d / 2)
        expected = errors.small.value * (1 + line.share)
        if line.half is None:
            print("  the line has no interval")
        else:
            room = float(np.hypot(line.half * errors.small.value, errors.quantile * (chance or 0) / 3 ** 0.5))
            within = abs(finer - expected) <= room
            where = "within" if within else "beyond"
            print(f"  the line of the size error: {expected:,.0f} +- {room:,.0f} m3: the runs lie {where}")
    except SlopeError as error:
        print(f"  no line: {error}")
    reasons = [one["text"] for one in about["conservative"]["withheld"] if one["kind"] == "size"]
    reasons = reasons or [about["size_error_unusable"] or ""]
    print(f"  the size error is withheld: {reasons[0]}" if reasons[0] else "  the size error counts")


def main(sites):
    if not sites:
        sys.exit(__doc__)
    for site in sites:
        check(Path(site))


if __name__ == "__main__":
    main(sys.argv[1:])
