"""slope study --fragility: the chain of a small embankment, from its slips to how often the road is blocked."""
import os
import shutil
from dataclasses import replace
from pathlib import Path

import fiona
import numpy as np
import pytest
import yaml

import made_rows
import made_study
from run_helpers import anew, called
from test_fragility import SOIL, write_slips
from tiny_collapse import rows_of

from slope_tools import cli, programs
from slope_tools.commands import study
from slope_tools.report import chain_part
from slope_tools.report.numbers import Numbers
from slope_tools.seismic import chain, chain_files, fragility_files
from slope_tools.seismic.together import Steps
from slope_tools.statistics import ball_sizes
from slope_tools.studies import letter
from slope_tools.tables import study_types
from slope_tools.tables.study_file import load_study

needs_lmp = pytest.mark.skipif(not os.environ.get("LMP"), reason="needs the LAMMPS program (LMP)")
ROAD = "10,0\n14,0\n14,51\n10,51\n"
FRAGILITY = f"slips {SOIL} --peaks 50:1500:50 --pseudo-static 1 --sample 256"
STUDY = "mine --levels 1 --sample 6 --vary rolling=0:0.1 --vary packing=1:1000000 --fragility fragility"


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A site of two bodies with a road at the toe, and their fragility; the folder."""
    folder = tmp_path_factory.mktemp("chain")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        write_slips()
        Path("road.csv").write_text(ROAD)
        for words in (f"fragility {FRAGILITY} --hazard hazard.csv -o fragility",
                      "site --terrain terrain.asc --slips slips --road road.csv --balls 60 -o mine"):
            assert cli.main(words.split()) == 0
    return folder


@pytest.fixture
def mine(made, here, monkeypatch):
    """The same in the test's folder; no report of the study."""
    shutil.copytree(made, here, dirs_exist_ok=True)
    monkeypatch.setattr(study, "write_site_report", lambda *_, **__: None)
    return here


def ran(capsys, words):
    return called(capsys, words.split())


def about():
    return yaml.safe_load(Path("mine/ensemble/study.yaml").read_text())


def rows(name):
    return rows_of(f"mine/ensemble/{name}", float)


@needs_lmp
def test_the_chain_of_two_bodies(mine, capsys):
    status, out, err = ran(capsys, f"study {STUDY}")
    assert status == 0, err
    of = about()
    found = of["chain"]
    assert [(one["body"], one["runs"]) for one in found["bodies"]] == \
        [(name, sum(row["set"]["body"] == name for row in of["runs"])) for name in ("1", "2")]
    weights = np.array([one["weight"] for one in found["bodies"]])
    given = yaml.safe_load(Path("fragility/fragility.yaml").read_text())["curves"]
    each = np.array([one["annual_frequency"]["value"] for one in given])
    assert weights == pytest.approx(each[:2] / each[:2].sum(), rel=1e-4)
    released = {row["set"]["body"]: row["released_m3"] for row in of["runs"]}
    assert released["2"] > 1.1 * released["1"]
    assert "collapse of one of 2 bodies on" in Path("mine/in.site").read_text().splitlines()[0]

    # of each body there is a run: less than the least of them is exceeded whenever one fails

    on_road = {name: [row["remove_on_road_m3"] for row in of["runs"] if row["set"]["body"] == name] for name in "12"}
    assert min(map(min, on_road.values())) > 1 and all(on_road.values())
    yearly = rows("chain_per_year.csv")
    assert yearly[0]["volume_m3"] == 0 and yearly[0]["per_year"] == pytest.approx(each[2], rel=1e-4)
    assert yearly[0]["low"] < yearly[0]["per_year"] < yearly[0]["high"] and yearly[-1]["per_year"] == 0
    any_body = {peak: p for body, peak, p in fragility_rows() if body == "any"}
    first = {row["peak_gal"]: row["probability"] for row in rows("chain.csv") if row["volume_m3"] == 0}
    assert first == pytest.approx(any_body, abs=1e-4) and max(any_body.values()) > 0.9
    for one in found["per_year"]:
        assert sum(part["per_year"] for part in one["contributions"]) == pytest.approx(one["value"], rel=1e-6)
    said = made_study.made(study_types.Chain, found)
    if not found["withheld"]:
        assert all(f"{text}\n" in out for text in chain_files.sentences(said))
    assert "the road is blocked by more than" in chain_files.sentences(said)[0]
    never = replace(said, per_year=[replace(said.per_year[0], value=0.0, low=0.0, high=1e-5, more_at_most=0.0)])
    assert "with at most 1e-05 per year (90 %)" in chain_files.sentences(never)[0]
    shown_in_the_report(of)
    told = letter.write_letter(letter.make_letter(load_study(Path("mine/ensemble/study.yaml"))))
    assert told.down.startswith("2 bodies of ") and "how likely" not in told.lacks
    assert found["withheld"] or told.clear.count("per year") == len(found["per_year"])

    # which body brings most, and what both leave: by hand from the runs

    along = of["stretches"]["bodies"]
    for one in along:
        means = {name: np.mean([dict(row["by_10_m"]).get(one["from_m"], 0.0) for row in of["runs"]
                                if row["set"]["body"] == name]) for name in "12"}
        assert one["body"] == max(means, key=means.get) and one["mean_m3"] == pytest.approx(max(means.values()))
    assert [float(row["from_m"]) for row in rows_of("mine/ensemble/bodies_along.csv")] == [
        one["from_m"] for one in along] != []
    for row in of["runs"]:
        assert sum(volume for _, volume in row["by_10_m"]) == pytest.approx(row["remove_on_road_m3"], rel=0.01)
    with fiona.open("mine/ensemble/bodies_along.gpkg") as layer:
        assert len(layer) == len(along)

    # the same again takes the runs that are there, other volumes are another question

    status, out, err = ran(capsys, f"study {STUDY} --more-than 20")
    assert status == 0 and ": started" not in out
    assert about()["chain"]["more_than_m3"] == [20.0]


def fragility_rows():
    return [(row["body"], float(row["peak_gal"]), float(row["probability"]))
            for row in rows_of("fragility/fragility.csv")]


def shown_in_the_report(of):
    chain = made_study.made(study_types.Chain, {**of["chain"], "withheld": []})

    class Data:
        study, folder = made_study.study(chain=chain), Path("mine/ensemble")

    *texts, figures, _, parts, _ = chain_part.make_chain_section(Data, Numbers()).blocks
    picture, = figures.pictures
    assert picture.uri.startswith("data:image/svg")
    assert len(texts) == len(of["chain"]["more_than_m3"]) + 1 and len(parts.rows) == chain_part.MOST_ROWS
    total = sum(float(row[1]) for row in parts.rows)
    assert total == pytest.approx(of["chain"]["per_year"][0]["value"], rel=0.05)
    Data.study = made_study.study(chain=replace(chain, withheld=["few balls"]))
    assert chain_part.make_chain_section(Data, Numbers()) is None


def test_bounds_have_the_transfer_and_what_finer_balls_would_change(monkeypatch):
    """By hand: of 100 and 200 m3 the bounds are those of 90 to 110 and of 180 to 220, 5 % less and 20 % more."""
    def row(of, band=None):
        return made_rows.row(set={"body": "1"}, remove_on_road_m3=of, bands=band and {
            chain_files.QUANTITY: band})

    class Given:
        weights, volumes = {"1": 1.0}, {"1": 500.0}

        class fragility:
            bodies = ["1"]

    monkeypatch.setattr(chain_files.chain, "compute_left_volume", lambda values, *_: chain.Left(*(
        Steps(np.array([500.0, *sorted(values)[::-1]]), np.ones(3)),) * 3))
    rows = [row(100.0, [90.0, 110.0]), row(200.0, [180.0, 220.0])]
    [left] = chain_files.list_left_volumes(Given, rows, ball_sizes.Left(-0.05, 0.05, 0.2, 0.1, 1.0, False))
    assert left.value.volumes.tolist() == [500, 200, 100]
    assert left.low.volumes == pytest.approx([475, 171, 85.5]) and left.high.volumes == pytest.approx([500, 264, 132])
    [left] = chain_files.list_left_volumes(Given, [row(100.0), row(200.0)], None)
    assert left.low.volumes.tolist() == left.high.volumes.tolist() == [500, 200, 100]


def test_a_body_without_the_finest_balls_is_named():
    def row(run, body, d, **entries):
        return made_rows.row(run=run, set={"body": body}, variables={"d": d} if d else {}, **entries)

    of_two = [row("a", "1", "2"), row("b", "1", "0.5"), row("c", "2", "1")]
    assert chain_files.bodies_without_finer(of_two) == ["2"]
    assert chain_files.bodies_without_finer([*of_two, row("e", "2", "0.5")]) == []
    assert chain_files.bodies_without_finer([row("a", "1", "2"), row("c", "2", "2")]) == []


@pytest.fixture
def bad(mine, capsys, monkeypatch):
    """Sites of all bodies, of one, and without a road, which nothing is run of; fragilities that do not fit."""
    monkeypatch.delenv("LMP", raising=False)
    monkeypatch.setattr(programs, "BESIDE", mine / "nowhere")
    for name, words in (("one", "--road road.csv --body 1"), ("free", "")):
        assert ran(capsys, f"site --terrain terrain.asc --slips slips --balls 60 {words} -o {name}")[0] == 0
    assert ran(capsys, f"fragility {anew(FRAGILITY, '--cohesion 1e6')} -o strong")[0] == 0
    for name, file, old in (("moved", fragility_files.ABOUT, "base_sha256: "),
                            ("short", fragility_files.CAPACITIES, "\n1,1,")):
        shutil.copytree("fragility", name)
        text = Path(name, file).read_text()
        assert old in text
        Path(name, file).write_text(text.replace(old, f"{old}f"))


def test_bad_input_is_one_line(bad, capsys):
    for words, rule in (
            ("mine --fragility fragility", "--sample: must be given with --fragility"),
            (f"{STUDY} --mobility rock_avalanches", "--known: must not be given with --fragility"),
            (f"{STUDY} --of remove_m3", "--of: must not be given with --fragility"),
            (f"{STUDY} --vary body=list:1,2", "--vary: must not have body"),
            ("mine/in.site --sample 8 --vary rolling=0:0.1 -o out --fragility fragility",
             "--fragility: must be given with the folder of a site"),
            ("mine --sample 8 --fragility nowhere", "nowhere/fragility.yaml"),
            ("mine --sample 3 --fragility fragility", "--sample: must be more runs than there are parameters"),
            ("one --sample 8 --fragility fragility", "body 2 may fail, too"),
            ("mine --sample 8 --fragility strong", "must have a body that fails"),
            ("mine --sample 8 --fragility moved", "body 1 is another one there"),
            ("mine --sample 8 --fragility short", "capacities.csv: must be what `slope fragility` wrote"),
            ("free --sample 8 --fragility fragility", "--fragility: needs a site with a road")):
        status, _, err = ran(capsys, f"study {words}")
        assert status == 2 and err.count("\n") == 1 and rule in err, (words, err)
    assert not Path("out").exists() and not list(Path().glob("*/ensemble"))
