"""The family of slides whose balls were made smaller: how it is judged, and two of it in small."""
import importlib.util
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from run_helpers import TOP
from tiny_collapse import LMP

spec = importlib.util.spec_from_file_location("family", TOP / "tests" / "size_family.py")
family = importlib.util.module_from_spec(spec)
spec.loader.exec_module(family)


def test_the_finest_run_is_judged_by_what_coarser_ones_leave(tmp_path, capsys):
    """By hand: a factor that shrinks by half with each halving of the balls leaves 1.25 of the last one."""
    runs = tmp_path / "size.csv"
    by_case = {"thin": (1.0, 1.2, 1.32, 1.386), "deep": (1.0, 1.2, 1.32, 1.6), "oval": (1.0, 1.2, 1.32)}
    runs.write_text(family.HEAD + "\n" + "".join(
        f"{name},{finer},{seed},1,800,{2 * finer},{1000 * grown},500,500,90,1,1,9000,9000,1\n"
        for name, factors in by_case.items() for finer, grown in zip((0.5, 1, 2, 4), factors) for seed in (1, 2, 3)))
    family.judge(runs)
    lines = [line.split(",") for line in capsys.readouterr().out.splitlines()]
    [deep] = [line for line in lines if line[:2] == ["remove", "deep"]]
    assert deep[2:4] == ["4.0", "1320"] and float(deep[4]) == pytest.approx(1320, rel=1e-3)
    assert 1386 < float(deep[5]) < 1600 and deep[6:] == ["1600", "False"]
    assert ["remove: 1 of 2 within"] in lines and ["length: 2 of 2 within"] in lines


def test_finer_runs_lie_where_coarser_ones_leave_them(capsys):
    """Ten slides with 51,200 balls (doc/src/sensitivity.rst), by runs with 100, 800 and 6,400: what a study says of
    finer balls."""
    family.judge(Path(__file__).with_name("size_family.csv"))
    lines = capsys.readouterr().out.splitlines()
    assert {"remove: 10 of 10 within", "on_road: 10 of 10 within", "length: 10 of 10 within"} <= set(lines)
    rows = [line.split(",") for line in lines if line.startswith("remove,")]
    assert np.median([(float(high) - float(low)) / 2 / float(mean) for *_, mean, low, high, _, _ in rows]) < 0.11


@pytest.mark.long
@pytest.mark.parametrize("name, road", [("thin", 10.0), ("compact", 4.0)])
def test_two_slides_of_the_family_in_small(tmp_path, monkeypatch, name, road):
    """100 balls and half their diameter: what is released stays, the travel within 25 %, and the thickness doubles."""
    monkeypatch.setenv("LMP", LMP)
    one = family.ALL[name]._replace(balls=100)
    monkeypatch.setitem(family.ALL, name, one)
    folder = tmp_path / name
    family.make_site(one, folder)
    site, found = folder / "site", {}
    d = float(next(line.split()[3] for line in (site / "in.site").read_text().splitlines()
                   if line.split()[1:2] == ["d"]))
    for finer in (1, 2):
        subprocess.run([LMP, "-in", "in.site", "-screen", "none", "-var", "out", f"run{finer}", "-var", "d",
                        f"{d / finer}", "-var", "film", "1", "-var", "rolling", f"{one.rolling:g}"],
                       cwd=site, check=True, stdin=subprocess.DEVNULL)
        values = family.row(name, folder, site / f"run{finer}", str(finer), "1", d / finer)
        found[finer] = dict(zip(family.HEAD.split(","), values))
    coarse, fine = found[1], found[2]
    assert one.road == road and fine["balls_thick"] == pytest.approx(2 * coarse["balls_thick"])
    assert fine["released"] == pytest.approx(coarse["released"], rel=0.01) and fine["balls"] > 6 * coarse["balls"]
    assert fine["travel"] == pytest.approx(coarse["travel"], rel=0.25)
    assert 0 < fine["remove"] < fine["released"] and 0 < coarse["remove"] < coarse["released"]
    assert 0 < fine["inertial"] < coarse["inertial"]
    shutil.rmtree(folder)
