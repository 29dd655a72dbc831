"""Numbers that studies and other commands make for pages, against some of their runs made anew.

A law that changes them makes the pages old. Builds that round otherwise draw other runs: bounds are those of chance.
"""
import csv
import re
import shlex
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import yaml

from deck_helpers import ALONE, ENVIRONMENT, LMP, script_of

TOP = Path(__file__).resolve().parents[2]
INPUTS = TOP / "inputs"
SLOPE = [sys.executable, str(TOP / "tools" / "slope")]
pytestmark = pytest.mark.long


def kept(case):
    folder, = INPUTS.glob(f"{case}_*")
    return yaml.safe_load((folder / "numbers.yaml").read_text())["seen"]


def run(*words):
    subprocess.run([*map(str, words)], cwd=TOP, env={**ENVIRONMENT, **ALONE, "LMP": LMP}, check=True,
                   stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def study(case, out, *words):
    folder, = INPUTS.glob(f"{case}_*")
    deck, = folder.glob("in.*")
    run(*SLOPE, "study", deck, "--jobs", 1, "--road", folder / "road.csv", "--local", "-o", out, *words)
    return out


def rows(path):
    with open(path, encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def within(value, low, high, share):
    """In the range of the runs of the page, or beyond it by a share of its middle."""
    return low - share * (low + high) / 2 <= value <= high + share * (low + high) / 2


def test_the_paper_rule_with_coarse_balls(tmp_path):
    """Means of five lattices, within three standard errors."""
    numbers = kept("20")
    made = study("20", tmp_path / "quick", "--set", "d=2.5", "--set", "rolling=0,0.10", "--repeat",
                 "xoffset=0.2,0.4,0.6,0.8")
    script = script_of(INPUTS / "20_embankment" / "paper_table.py")
    for value, several in script.read(script.Study.read(made)).found.items():
        for what in ("to remove", "on the road"):
            volumes = [one[what] for one in several]
            error = np.std(volumes, ddof=1) / len(volumes) ** 0.5
            assert abs(np.mean(volumes) - numbers[f"quick.body.{script.KEYS[what]}.{float(value):g}"]) < 3 * error


def test_an_earthquake_and_a_wall(tmp_path):
    """One lattice of three."""
    road, = rows(study("21", tmp_path / "shaken", "--set", "peak=600") / "study.csv")
    numbers = kept("21")
    assert within(float(road["on_road_m3"]), *(numbers[f"study.600.on_road_m3.{end}"] for end in ("low", "high")), 0.05)
    numbers, made = kept("22"), study("22", tmp_path / "wall", "--set", "wall=1")
    behind, = (row for row in rows(made / "lines.csv") if row["line"] == "behind")
    wall, = (row for row in rows(made / "structures.csv") if row["structure"] == "wall")
    for row, name in ((behind, "lines.1.behind.forward_m3"), (behind, "lines.1.behind.speed_95_m_s"),
                      (wall, "structures.1.wall.mean_force_n")):
        assert within(float(row[name.split(".")[-1]]), numbers[f"{name}.low"], numbers[f"{name}.high"], 0.1), name


def test_slips_and_their_fragility(tmp_path):
    """The first two commands of the page, to the digits that it has."""
    text = re.sub(r" \\\n +", " ", (INPUTS / "23_fragility" / "README.md").read_text())
    first, second, *_ = re.findall(r"^    tools/slope (.*)$", text, re.MULTILINE)
    for command in (first.replace("-o slips", f"-o {tmp_path}/slips"),
                    second.replace("fragility slips", f"fragility {tmp_path}/slips")
                    .replace("-o fragility", f"-o {tmp_path}/fragility")):
        run(*SLOPE, *shlex.split(command))
    numbers = kept("23")
    found = {row["body"]: row for row in rows(tmp_path / "slips" / "stability.csv")}
    assert [float(found[body][name]) for body in "123" for name in ("factor", "yield", "volume")] == pytest.approx(
        [numbers[f"slips.{body}.{name}"] for body in "123" for name in ("factor", "yield", "volume")], rel=1e-3)
    about = yaml.safe_load((tmp_path / "fragility" / "fragility.yaml").read_text())
    curves = {one["body"]: one for one in about["curves"]}
    assert [curves[body]["lognormal"]["median_gal"] for body in "12"] == pytest.approx(
        [numbers[f"fragility.curves.{body}.lognormal.median_gal"] for body in "12"], rel=1e-3)


def test_few_blocks_run_as_far(tmp_path):
    """Twenty blocks, ten seeds of 25: within three standard errors."""
    numbers, okada = kept("26"), script_of(INPUTS / "26_okada" / "okada.py")
    (long, wide, high), _ = okada.NUMBERS[20]
    okada.LMP = LMP
    made = okada.row([okada.run(tmp_path / str(seed), seed=seed, long=long, wide=wide, high=high, **okada.HOW["loose"])
                      for seed in range(1, 11)])
    for k, name in enumerate(("mean_m", "p95_m", "travel_m")):
        value, error = map(float, made[2 * k:2 * k + 2])
        assert abs(value - numbers[f"square.20.loose.{name}"]) < 3 * error
