"""The same collapse on drawn numbers of ranks and settings, and on one rank with LAMMPS' defaults.

A case is a scene and a set-up: ranks, balancing, sorting, newton, boundaries, neighbor lists, ground of wall balls or
of atoms, pieces, a restart on other ranks. Trajectories, forces and torques (they show the history of contacts) agree
to rounding for as long as chaos leaves it small; so do the rasters, the balls that are left, the balance of volumes.

A case that fails is made smaller: options are set back to the defaults, steps and balls are bisected, while it fails.
The suite runs the seeds of the environment variable SLOPE_SEEDS. A long campaign, and a single case:

    /usr/bin/python3 tests/decks/test_ranks.py --seeds 100 --first 7
    /usr/bin/python3 tests/decks/test_ranks.py --case "ranks=4 newton=off steps=60"
"""

import argparse
import os
import random
import sys
import tempfile
from pathlib import Path

import numpy as np
import pytest
import yaml

from deck_helpers import collapse_deck, dump_difference, read_asc, read_dump, run_deck, serial, write_collapse

# what may be drawn; the first is the default

SCENE = {
    "balls": [160, 80, 320],
    "steps": [320, 640],
    "mixed": ["no", "yes"],         # balls of two sizes and types
    "scheme": ["exact", "plain"],
    "sides": ["far", "periodic", "near"],    # periodic in y; near: balls leave the box
    "seed": [1],
}
SETUP = {
    "ranks": [1, 2, 3, 4, 8],
    "processors": ["*,*,*", "1,*,*", "*,1,1", "*,*,1"],
    "layout": ["brick", "brick,shift", "tiled", "tiled,shift", "tiled,rcb"],
    "sort": ["default", "off", "often"],
    "newton": ["on", "off"],
    "x": ["f", "s", "m", "sf", "fm"],    # boundaries, where no ball leaves
    "z": ["f", "s", "m", "fs"],
    "neigh": ["every,1,delay,0,check,yes", "every,1,delay,0,check,no", "every,4,delay,0,check,no",
              "every,2,delay,4,check,yes"],
    "skin": ["0.2", "0.05", "0.6"],
    "ground": ["wall", "atoms"],
    "pieces": [1, 3],
    "cut": ["none", "restart", "write_restart"],
    "again": [1, 2, 3, 4, 8],    # ranks after the cut
}
OPTIONS = {**SCENE, **SETUP}
DEFAULT = {name: values[0] for name, values in OPTIONS.items()}
ROUNDING = 1e-10, 1e-7    # of positions, and of what depends on their differences
SEEDS = [int(word) for word in os.environ.get("SLOPE_SEEDS", "3 4 8 30 74").split()]


def draw(seed):
    """A case: half of the options at their defaults; never one rank before and after."""
    rng = random.Random(seed)
    case = {name: rng.choice(values) if rng.random() < 0.6 else values[0] for name, values in OPTIONS.items()}
    case["ranks"], case["seed"] = rng.choice(SETUP["ranks"][1:]), seed
    return sensible(case)


def sensible(case):
    """What cannot be had together is set back."""
    case = dict(case)
    if case["skin"] == "0.05" and "yes" not in case["neigh"] or "every,1" not in case["neigh"]:
        case["skin"] = max(case["skin"], "0.2")    # a ball must not cross half the skin unseen
    if case["sides"] == "near":
        case["x"] = "f"
    if case["ground"] == "atoms":    # create_balls needs room: a box that has not shrunk to the moving balls
        case["x"], case["z"] = ("m" if "s" in case[axis] else case[axis] for axis in "xz")
    if "tiled" in case["layout"]:
        case["newton"] = "off"
    if case["cut"] == "none":
        case["again"] = DEFAULT["again"]
    return case


def settings_of(case, out):
    y = {"far": "f", "periodic": "p", "near": "f"}[case["sides"]]
    style, _, method = case["layout"].partition(",")
    balance = {"": "", "shift": "fix spread all balance 20 1.0 shift xyz 10 1.0",
               "rcb": "fix spread all balance 20 1.0 rcb"}[method]
    within = {"far": "-9.5 30.5 -13.5 20.5", "periodic": "-9.5 30.5 -2.1 9.1", "near": "8.6 30.5 -13.5 20.5"}
    nodes = f"region within block {within[case['sides']]} INF INF units box\n"
    ground = f"{nodes}fix field soil wall/gran/balls 3 1.0 surface ground upper spacing 1.0 inside within"
    if case["sides"] == "periodic":    # fixed balls of a wall are not repeated: let there be more on both sides
        ground = ground.replace(" inside within", "")
    if case["ground"] == "atoms":
        ground = f"{nodes}create_balls 3 1.0 3411.4 surface ground upper spacing 1.0 inside within\n"
        ground = ground * (out == "out") + "group floor type 3\nfix freeze floor freeze"
    return dict(newton=case["newton"], processors=case["processors"].replace(",", " "), comm=style, balance=balance,
                sort={"default": "", "off": "sort 0 0", "often": "sort 10 1.0"}[case["sort"]],
                boundary=f"{case['x']} {y} {case['z']}", skin=case["skin"], neigh=case["neigh"].replace(",", " "),
                scheme=case["scheme"], ground=ground, out=out)


def run(case, folder):
    """Frames, rasters and summary of a case."""
    folder.mkdir()
    sides = {"far": {}, "periodic": {"box": ((-11, 33), (-2, 10), (-3, 25))},
             "near": {"box": ((8.5, 33), (-15, 23), (-3, 25))}}[case["sides"]]
    write_collapse(folder, case["balls"], case["seed"], case["mixed"] == "yes", fast=True, **sides)
    steps, pieces, cut = case["steps"], case["pieces"], case["steps"] // 2 + 3
    parts = [f"run {steps * (k + 1) // pieces - steps * k // pieces}" for k in range(pieces)]
    commands = {"none": "\n".join(parts), "write_restart": f"run {cut}\nwrite_restart cut.restart",
                "restart": f"restart {cut} cut.restart.*\nrun {cut + 5}"}[case["cut"]]
    run_deck(collapse_deck(commands, **settings_of(case, "out")), folder, np=case["ranks"], timeout=120)
    frames, last = read_dump(folder / "out.dump"), "out"
    if case["cut"] != "none":
        last, restart = "again", f"cut.restart.{cut}" if case["cut"] == "restart" else "cut.restart"
        deck = collapse_deck(f"run {steps - cut}", **{**settings_of(case, "again"), "begin": f"read_restart {restart}"})
        run_deck(deck, folder, np=case["again"], timeout=120)
        later = read_dump(folder / "again.dump")
        frames = {**{step: rows for step, rows in frames.items() if step <= cut}, **later}
    rasters = {name: read_asc(folder / f"{last}.{name}.asc")[0]
               for name in ("thickness", "max_thickness", "max_speed", "max_energy", "arrival")}
    return frames, rasters, yaml.safe_load((folder / f"{last}.summary.yaml").read_text())


def check(case, folder):
    """Compare a case with the same scene on one rank; an AssertionError says what differs."""
    for name in case:
        assert name in OPTIONS, f"no option {name}, must be one of {' '.join(OPTIONS)}"
    frames, rasters, summary = run(case, folder / "case")
    scene = {**DEFAULT, **{name: case[name] for name in SCENE}}
    frames_one, rasters_one, summary_one = run(scene, folder / "one")

    for found in (summary, summary_one):
        volume, balls = found["volume"], found["balls"]
        assert abs(volume["residual"]) < 1e-9 * volume["released"], f"the balance does not close: {volume}"
        assert balls["released"] == balls["present"] + balls["lost"] == case["balls"], f"balls: {balls}"
        assert found["step"] == case["steps"]
    assert summary["volume"]["released"] == pytest.approx(summary_one["volume"]["released"], rel=1e-12)
    assert set(frames_one) <= set(frames), "frames are missing"

    # balls leave when lists are rebuilt, which the set-up decides: compared up to the first
    lost = False
    for step, rows in sorted(frames_one.items()):
        lost = lost or len(rows) < case["balls"] or len(frames[step]) < case["balls"]
        if lost:
            assert case["sides"] == "near", f"balls are missing in step {step}: {len(frames[step])}, {len(rows)}"
            break
        found = dump_difference(rows, frames[step])
        text = " ".join(f"{value:.2g}" for value in found)
        assert found[0] < ROUNDING[0] and max(found) < ROUNDING[1], f"step {step}: x v omega f torque differ by {text}"
    if lost:
        return
    assert summary["balls"] == summary_one["balls"]
    for name, one in rasters_one.items():
        many = rasters[name]
        assert (np.isnan(one) == np.isnan(many)).all(), f"{name}: other cells without data"
        worst = np.nanmax(np.abs(one - many))
        assert worst < 1e-5 * np.nanmax(np.abs(one)), f"{name} differs by {worst:.2g}"


def failure(case):
    """What is wrong with it, in one line; None if nothing is."""
    with tempfile.TemporaryDirectory() as folder:
        try:
            check(case, Path(folder))
        except AssertionError as error:
            return " ".join(str(error).split("\nassert ")[0].split())[-600:]
    return None


def shrink(case, failing=failure):
    """The smallest case that fails: fewest options away from the defaults, fewest steps, fewest balls."""
    def try_it(**changes):
        nonlocal case
        smaller = sensible({**case, **changes})
        if smaller == case or not failing(smaller):
            return False
        case = smaller
        return True

    again = True
    while again:
        again = False
        for name in case:
            if name not in ("balls", "steps", "seed") and case[name] != DEFAULT[name]:
                again |= try_it(**{name: DEFAULT[name]})
        for name in ("ranks", "again"):
            for fewer in [value for value in SETUP[name] if value < case[name]][1:]:
                if try_it(**{name: fewer}):
                    again = True
                    break
    for name, least in (("steps", 10), ("balls", 1)):
        passes = 0
        while case[name] - passes > least:
            middle = (passes + case[name]) // 2 // least * least
            if not try_it(**{name: middle}):
                passes = middle
    return case


def words(case):
    """Options away from the defaults, as --case reads them."""
    return " ".join(f"{name}={value}" for name, value in case.items() if value != DEFAULT[name])


def command(case):
    return f'/usr/bin/python3 tests/decks/test_ranks.py --case "{words(case)}"'


def read_case(text):
    case = dict(DEFAULT)
    for word in text.split():
        name, _, value = word.partition("=")
        if name not in OPTIONS or not value:
            raise argparse.ArgumentTypeError(f"{word}: must be NAME=VALUE, NAME one of {' '.join(OPTIONS)}")
        case[name] = type(DEFAULT[name])(value)
    return case


# --- the suite ---


@pytest.mark.skipif(serial(), reason="LMP is serial: built with BUILD_MPI=OFF")
@pytest.mark.parametrize("seed", SEEDS)
def test_drawn_case(seed):
    case = draw(seed)
    print(command(case))
    message = failure(case)
    if message:
        smallest = shrink(case)
        pytest.fail(f"{failure(smallest) or message}\nrepeat it: {command(smallest)}\ndrawn as: {command(case)}",
                    pytrace=False)


@pytest.mark.skipif(serial(), reason="LMP is serial: built with BUILD_MPI=OFF")
def test_tiled_needs_newton_off(tmp_path):
    """LAMMPS cannot send the histories of ghosts back in this layout."""
    write_collapse(tmp_path, 20)
    run_deck(collapse_deck("run 10", comm="tiled"), tmp_path, np=2,
             expect_error="Pair gran/restitution with comm_style tiled requires newton off")


def test_shrinking():
    """A case that fails whenever newton is off, on more than 2 ranks, after 30 steps and with more than 9 balls."""
    def failing(case):
        return case["newton"] == "off" and case["ranks"] > 2 and case["steps"] >= 30 and case["balls"] > 9

    drawn = next(case for case in map(draw, range(1000)) if failing(case) and case["cut"] != "none")
    smallest = shrink(drawn, failing)
    assert words({**smallest, "seed": 1}) == "balls=10 steps=30 ranks=3 newton=off"
    assert read_case(words(smallest)) == smallest


def test_a_difference_is_seen(tmp_path):
    """Negative control: too thin a skin for lists that are rebuilt every 40 steps; contacts are found late."""
    case = {**DEFAULT, "steps": 200, "balls": 80}
    message = failure({**case, "neigh": "every,40,delay,0,check,no", "skin": "0.01"})
    assert message and "differ by" in message


def main():
    parser = argparse.ArgumentParser(description="Drawn collapses on many ranks against one rank.")
    parser.add_argument("--seeds", type=int, default=20, help="number of cases (default 20)")
    parser.add_argument("--first", type=int, default=1, help="seed of the first (default 1)")
    parser.add_argument("--case", type=read_case, help='one case: "NAME=VALUE ...", defaults for what is not named')
    args = parser.parse_args()
    failed = 0
    cases = [args.case] if args.case else map(draw, range(args.first, args.first + args.seeds))
    for case in cases:
        message = failure(case)
        print("FAIL" if message else "ok  ", words(case), flush=True)
        if message:
            failed += 1
            smallest = case if args.case else shrink(case)
            print(f"     {failure(smallest) or message}\n     repeat it: {command(smallest)}", flush=True)
    sys.exit(failed > 0)


if __name__ == "__main__":
    main()
