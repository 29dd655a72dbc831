"""tools/slope study SITE: weighted by known events where a set covers the mass, else by the paper's method; said."""
from types import SimpleNamespace

import numpy as np
import pytest

from run_helpers import called
from test_site import gis  # noqa: F401
from test_site_anew import inside, mine, once  # noqa: F401
from tiny_collapse import LMP

from slope_tools.ensembles import known_study
from slope_tools.mobility import body, exceedance, known
from slope_tools.sites import site_budget, site_choices
from slope_tools.studies import site_study
from slope_tools.survey import rasters

CELL = 20.0


@pytest.fixture
def large(inside, gis):  # noqa: F811
    """A site of 0.3 million m3 on a slope of 25 degrees and a plain, without a trial run."""
    x = np.arange(0, 3000, CELL) + CELL / 2
    heights = np.maximum(900 - 0.47 * x, 430 - 0.02 * x)
    rows = "\n".join(" ".join(f"{z:.2f}" for z in heights) for _ in range(40))
    (gis / "large.asc").write_text(f"ncols {len(x)}\nnrows 40\nxllcorner 0\nyllcorner 0\ncellsize {CELL:g}\n{rows}\n")
    (gis / "large.csv").write_text("200,300\n500,300\n500,500\n200,500\n")
    inside("--terrain large.asc --crs EPSG:6677 --release large.csv --shape ellipsoid --volume 3e5 --balls 100 -o big")
    return gis / "big"


def study(capsys, monkeypatch, words):
    monkeypatch.setenv("LMP", LMP)
    return called(capsys, ["study", *words.split(), "--dry-run"])


def test_a_mass_that_known_events_cover(large, capsys, monkeypatch):
    status, out, err = study(capsys, monkeypatch, "big")
    assert status == 0, err
    assert out.startswith("weighted by known events of this volume and height, rock_avalanches; --paper takes the ")
    assert "64 runs" in out
    assert study(capsys, monkeypatch, "big --unconfined")[0] == 0
    status, _, err = study(capsys, monkeypatch, "big --paper --unconfined")
    assert status == 2 and "must be given with --known" in err
    status, out, _ = study(capsys, monkeypatch, "big --paper")
    assert status == 0 and out.startswith("by the paper's method, as asked for\n") and "64 runs" not in out


def test_a_mass_that_no_set_covers(mine, capsys, monkeypatch):  # noqa: F811
    status, out, err = study(capsys, monkeypatch, "mine")
    assert status == 0, err
    volume = site_choices.found(mine)["body"]["volume"]
    assert out.startswith("by the paper's method; no set of known events covers this volume, "
                          f"{volume:,.0f} m3; ours has 0.1 to 498 million m3\n")


def test_other_grounds_at_both_ends_of_rolling(mine, capsys, monkeypatch):  # noqa: F811
    """One position each, beside the rolling resistances and positions on the site's own ground."""
    status, out, err = study(capsys, monkeypatch, "mine")
    assert status == 0, err
    runs = [line.split(":")[0] for line in out.splitlines() if line.startswith("rolling_") and "_spacing_" in line]
    assert runs == [*(f"rolling_{rolling}_spacing_0.9{more}" for rolling in ("0", "0.05", "0.1")
                      for more in ("", "_xoffset_0.5", "_yoffset_0.5")),
                    *(f"rolling_{rolling}_spacing_{spacing}" for spacing in ("0.5", "0.7") for rolling in ("0", "0.1"))]
    # three sizes of balls, of which one is the site's own, and half the step
    assert sum("_d_" in line for line in out.splitlines()) == 6 and "20 runs, 0 of them finished" in out
    choices = site_choices.read(mine)
    choices["study"].update(spacing=[0.5, 0.9], rolling=[0.2])      # its own ground is none of the others
    assert site_choices.other_grounds(choices) == [(0.5, 0.2)]


@pytest.mark.parametrize("words, line", [
    ("mine --paper --sample 8", "--paper: must not be given with --sample or --from"),
    ("mine --paper --from fit", "--paper: must not be given with --sample or --from"),
    ("mine --vary friction=5:9", "--vary: must not be given with the folder of a site"),
    ("mine/in.site --paper --set rolling=0 -o o", "--paper: must be given with the folder of a site, got mine/in")])
def test_refused(mine, capsys, monkeypatch, words, line):  # noqa: F811
    status, _, err = study(capsys, monkeypatch, words)
    assert status == 2 and err.count("\n") == 1 and err.startswith(f"slope study: {line}"), err


def test_why_not(large, monkeypatch):
    assert known_study.why_not(large, 3e5, False, "unknown") == ""
    assert "a mapped deposit is given" in known_study.why_not(large, 3e5, True, "unknown")
    for volume in (9e4, 6e8):
        assert "no set of known events covers this volume" in known_study.why_not(large, volume, False, "unknown")
        assert known_study.points(volume) == 0
    asked = []
    monkeypatch.setattr(known, "one_of_body",
                        lambda _, choice: asked.append(choice.confined) or SimpleNamespace(outside=[]))
    assert known_study.why_not(large, 3e5, False, "yes") == "" and asked == ["yes"]     # as its ensemble is weighted
    monkeypatch.undo()
    monkeypatch.setattr(exceedance, "of_body",
                        lambda *_: exceedance.Mobility(None, 0.3, None, {}, "", None, ["the fall is small"]))
    assert known_study.why_not(large, 3e5, False, "unknown") == "the fall is small"


def test_the_estimate_is_of_the_study_that_is_made(large):
    choices = site_choices.read(large)
    assert site_choices.found(large)["study"]["runs"] == known_study.POINTS == 64
    plan = site_budget.plan(choices, 64)
    assert plan.runs == 64 and not plan.half_step and "up to half as many more" in plan.text
    plan = site_budget.plan(choices)
    assert plan.runs == 19 and not plan.half_step       # no road: nothing to compare
    assert site_budget.plan({**choices, "road": {**choices["road"], "file": "road.csv"}}).half_step
    assert plan.text == ("19 runs: 3 rolling resistances x 3 lattice positions, 4 on other grounds, 2 other sizes of "
                         "balls x 3")
    assert site_budget.plan({**choices, "study": {**choices["study"], "spacing": []}}).runs == 15


def test_the_method_is_in_the_results(mine, monkeypatch, capsys):  # noqa: F811
    """It goes from the command to study.yaml through the questions."""
    seen = []
    monkeypatch.setattr(site_study.results, "collect", lambda setup, questions, *_: seen.append(questions.method))
    monkeypatch.setattr(site_study.study, "perform", lambda setup, settings, todo, collect: collect(todo, None))
    monkeypatch.setattr(site_study, "sizes", lambda *_: site_study.NOT_ASKED)
    monkeypatch.setattr(site_study, "step_of", lambda *_: None)
    _, out, _ = study(capsys, monkeypatch, "mine")
    assert seen == [out.splitlines()[0]] and seen[0].startswith("by the paper's method; ")


def test_a_site_of_a_mass_on_top_of_the_terrain(large, inside):  # noqa: F811
    """Its ground before is the sum; what is said of known events stands in site.yaml, no without quotes, too."""
    ground = rasters.read_asc_local(large / "terrain.asc")
    mass = np.where(np.hypot(*(values - 400 for values in np.meshgrid(
        CELL * (np.arange(150) + 0.5), CELL * (39.5 - np.arange(40))))) < 100, 8.0, 0.0)
    rows = "\n".join(" ".join(f"{value:g}" for value in row) for row in mass)
    head = f"ncols 150\nnrows 40\nxllcorner 0\nyllcorner 0\ncellsize {CELL:g}"
    (large.parent / "mass.asc").write_text(f"{head}\n{rows}\n")
    inside("--terrain large.asc --crs EPSG:6677 --scar mass.asc --scar-is height --confined no --known rockfalls "
           "--balls 100 -o top")
    top = large.parent / "top"
    before, depth = (rasters.read_asc_local(top / name) for name in ("terrain.asc", "release.depth.asc"))
    assert before.z == pytest.approx(ground.z + mass, abs=2e-3) and (before.crs, before.offset) == (ground.crs,
                                                                                                    ground.offset)
    assert np.nan_to_num(depth.z) == pytest.approx(mass, abs=2e-3)
    assert body.of_site(top).base == pytest.approx(ground.z, abs=2e-3)
    text = (top / "site.yaml").read_text()
    assert "confined: 'no'" in text and "set: rockfalls" in text
    (top / "site.yaml").write_text(text.replace("confined: 'no'", "confined: yes"))
    assert site_choices.read(top)["known"] == {"set": "rockfalls", "confined": "yes"}
    inside("top --name again")
    assert rasters.read_asc_local(top / "terrain.asc").z == pytest.approx(before.z, abs=1e-6)      # once, not twice
