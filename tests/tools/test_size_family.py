"""The family of slides whose balls were made smaller: its table, the growth that it tells, and two of it in small."""
import importlib.util
import shutil
import subprocess

import pytest

from run_helpers import TOP
from tiny_collapse import LMP

from slope_tools.statistics import size_family

spec = importlib.util.spec_from_file_location("family", TOP / "tests" / "size_family.py")
family = importlib.util.module_from_spec(spec)
spec.loader.exec_module(family)


def slides(*rows):
    return size_family.read(["case,balls,remove,beyond,length", *rows])


def test_the_growth_by_hand():
    """Between two sizes in the logarithm of the balls; slides that are no finer tell nothing."""
    three = slides("a,8,120,0,1", "a,2,100,0,1", "b,4,50,5,2", "b,16,100,10,2", "c,2,7,1,1")
    found = size_family.growth(4.0, slides=three)
    assert found == pytest.approx((0.5 * (120 / 110 + 2), 120 / 110, 2.0, 2, 16.0))
    assert found.covered(30.0) == pytest.approx(60.0)
    assert size_family.growth(8.0, slides=three) == pytest.approx((100 / 75, 100 / 75, 100 / 75, 1, 16.0))
    assert size_family.growth(1.0, slides=three) == pytest.approx((1.2, 1.0, 2.0, 3, 16.0))     # as from the coarsest
    assert size_family.growth(16.0, slides=three) is None
    assert size_family.growth(4.0, "beyond_road_m3", three) == pytest.approx((2.0, 2.0, 2.0, 1, 16.0))      # a has none
    # what became less is no reason to take something off
    assert size_family.growth(2.0, slides=slides("a,2,100,1,1", "a,4,90,1,1")).covered(30.0) == 30.0


def test_the_table_of_the_package():
    for rows in size_family.family().values():
        assert len(rows) > 1 and (rows["balls"][1:] > rows["balls"][:-1]).all() and (rows["remove"] > 0).all()
    for quantity in size_family.QUANTITIES:
        found = size_family.growth(4.0, quantity)
        assert 0.5 < found.low <= found.median <= found.high < 4 and found.finest > 4


def test_the_table_is_made_of_the_runs(tmp_path):
    """Means of each case and size; what page 1 would have said of them by hand."""
    runs = tmp_path / "size.csv"
    number = {"thin": (100, 110, 130), "wide": (200, 240, 360)}
    runs.write_text(family.HEAD + "\n" + "".join(
        f"{name},{finer},{seed},1,800,{2 * finer},{volumes[k] + 2 * (seed - 2)},0,5,9,1,1,800,1,1\n"
        for name, volumes in number.items() for k, finer in enumerate((1, 2, 4)) for seed in (1, 2, 3)))
    assert family.table(runs)[1:] == ["thin,2,100,5,9", "thin,4,110,5,9", "thin,8,130,5,9",
                                      "wide,2,200,5,9", "wide,4,240,5,9", "wide,8,360,5,9"]


@pytest.mark.parametrize("name, road", [("thin", 10.0), pytest.param("compact", 4.0, marks=pytest.mark.long)])
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
