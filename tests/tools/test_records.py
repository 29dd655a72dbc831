"""Typed values to and from what files have, the rows of a study among them: both ways, and what is wrong in a line."""
from dataclasses import MISSING, dataclass, fields, replace
from pathlib import Path
from typing import Any, Mapping, NamedTuple, Optional, Sequence, Tuple

import numpy as np
import pytest
import yaml

import made_rows
import made_study
from run_helpers import called
from tiny_collapse import edit

from slope_tools import disk, records
from slope_tools.errors import SlopeError
from slope_tools.findings import Finding
from slope_tools.studies import results
from slope_tools.tables import ensemble_types, quantities, rows, study_file
from slope_tools.tables.rows import Failed, Finished, Mapped, OnRoad

ROAD = {"remove_m3": 12.5, "lane_hours": 3.0, "stretches": [{"from": 1.0, "to": 2.5}], "clearing": {"hours": 4.0},
        "road_warnings": [Finding("no CRS", {"file": "road.csv", "coordinates": "local"}, ("one",)).entry()]}
DEPOSIT = {"overlap": 0.625, "beyond_mapped_m": -3.5}
ROWS = {"failed": {"status": "failed", "log_warnings": ["late"]}, "alone": {}, "road": ROAD, "mapped": DEPOSIT,
        "both": {**ROAD, **DEPOSIT, "length_by_lobe_m": [3.0, 1.5], "left": [{"side": "east", "volume": 3.0}],
                 "ranks": 2, "structures": {"wall": {"largest_force_n": 1e6, "at_s": None}}}}


class Pair(NamedTuple):
    low: float
    high: float = 2.0


@dataclass(frozen=True)
class Thing:
    name: str
    pairs: Sequence[Pair]
    of: Mapping[str, Optional[int]]
    right: bool
    ends: Tuple[float, float]
    more: Optional[Sequence[str]] = None
    any: Any = None


THING = Thing("a", [Pair(1.5)], {"x": 3, "y": None}, True, (0.25, 4.0), ["b"], {"c": [1]})
PLAIN = {"name": "a", "pairs": [{"low": 1.5, "high": 2.0}], "of": {"x": 3, "y": None}, "right": True,
         "ends": [0.25, 4.0], "more": ["b"], "any": {"c": [1]}}


def test_there_and_back():
    assert records.encode_record(THING) == PLAIN and list(records.encode_record(THING)) == list(PLAIN)
    found = records.read_record(Thing, yaml.safe_load(yaml.safe_dump(records.encode_record(THING))))
    assert found == THING and isinstance(found.ends, tuple) and isinstance(found.pairs[0], Pair)


def test_what_is_missing_has_its_default_and_more_does_not_count():
    about = {key: value for key, value in PLAIN.items() if key not in ("more", "any")}
    found = records.read_record(Thing, {**about, "pairs": [{"low": 7, "middle": 1}], "unknown": 1})
    assert (found.more, found.any, found.pairs) == (None, None, [Pair(7, 2.0)])


def test_nothing_of_numpy_is_left():
    """safe_dump() knows none of its types."""
    thing = Thing("a", (Pair(np.float64(1.5), np.float32(2.0)),), {"x": np.int64(3)}, np.bool_(True),
                  (np.float64(0.25), 4.0), ("b",), np.array([1.0, 2.0]))
    found = records.encode_record(thing)
    assert yaml.safe_load(yaml.safe_dump(found)) == found
    assert found == {**PLAIN, "of": {"x": 3}, "any": [1.0, 2.0]}
    for value in (found["pairs"][0]["low"], found["pairs"][0]["high"], found["ends"][0]):
        assert type(value) is float


@pytest.mark.parametrize("change, said", [
    ({"name": 1}, "name: must be a text, got 1"), ({"name": None}, "name: must be a text, got None"),
    ({"pairs": [{"low": 1.0}, {}]}, "pairs: second value: must have low"),
    ({"pairs": [{"low": "x"}]}, "pairs: first value: low: must be a finite number, got 'x'"),
    ({"pairs": [{"low": True}]}, "low: must be a finite number, got True"),
    ({"pairs": [{"low": float("nan")}]}, "low: must be a finite number, got nan"),
    ({"pairs": [{"low": 10 ** 400}]}, "low: must be a finite number, got 1000"),
    ({"pairs": {"low": 1.0}}, "pairs: must be a list in brackets, got {'low': 1.0}"),
    ({"pairs": [5]}, "pairs: first value: must be a section with keys, got 5"),
    ({"more": "text"}, "more: must be a list in brackets, got 'text'"),
    ({"of": [1]}, "of: must be a section with keys, got [1]"),
    ({"of": {"x": 1.5}}, "of: x: must be a whole number, got 1.5"),
    ({"of": {"x": True}}, "of: x: must be a whole number, got True"),
    ({"right": 1}, "right: must be true or false, got 1"),
    ({"ends": 3.0}, "ends: must be a list in brackets, got 3.0")])
def test_what_is_none_is_said_with_its_place(change, said):
    with pytest.raises(records.NoRecord) as caught:
        records.read_record(Thing, {**PLAIN, **change})
    assert said in str(caught.value) and str(caught.value).startswith(f"{list(change)[0]}: ")
    assert len(str(caught.value)) < 150


def test_all_that_is_missing_is_named():
    with pytest.raises(records.NoRecord, match="^must have name and right and ends$"):
        records.read_record(Thing, {"pairs": [], "of": {}})
    with pytest.raises(records.NoRecord, match="^must be a section with keys, got 'a'$"):
        records.read_record(Thing, "a")


# --- the rows of a study ---

@pytest.mark.parametrize("name", ROWS)
def test_a_row_there_and_back(name):
    row = made_rows.row(**ROWS[name])
    about = rows.encode_row(row)
    assert rows.read_row(yaml.safe_load(disk.yaml_text("a row", about))) == row
    assert isinstance(row, Failed if name == "failed" else Finished)
    assert list(about)[:2] == ["run", "status"] and not {"road", "mapped"} & about.keys()
    assert ("remove_m3" in about, "overlap" in about) == (name in ("road", "both"), name in ("mapped", "both"))
    for key, value in ROWS[name].items():
        assert about[key] == value


@pytest.mark.parametrize("name, lacks", [(name, one.name) for name, kind in (
    ("failed", Failed), ("both", Finished), ("both", OnRoad), ("both", Mapped)) for one in fields(kind)
    if one.default is MISSING and one.name != "run"])       # without it the schema of the file is not met
def test_a_row_that_lacks_something_is_one_line(name, lacks):
    """With file, run, and the key as the file has it."""
    about = rows.encode_row(made_rows.row(**ROWS[name]))
    del about[lacks]
    with pytest.raises(SlopeError) as caught:
        study_file.row_of(Path("out/study.yaml"), about)
    assert str(caught.value) == f"out/study.yaml: run one: must be {study_file.WHAT}: must have {lacks}"


@pytest.mark.parametrize("change, said", [
    ({"front_m": "far"}, "front_m: must be a finite number, got 'far'"),
    ({"moving": "no"}, "moving: must be true or false, got 'no'"),
    ({"remove_m3": None}, "remove_m3: must be a finite number, got None"),
    ({"overlap": "much"}, "overlap: must be a finite number, got 'much'"),
    ({"set": {"rolling": 0.1}}, "set: rolling: must be a text, got 0.1"),
    ({"stretches": [{"from": "x"}]}, "stretches: first value: from: must be a finite number, got 'x'"),
    ({"release": {"released": 1.0}}, "release: must have body and factor and from_cubic and removed"),
    ({"status": "done"}, "status: must be failed or finished, got 'done'")])
def test_a_row_of_a_wrong_type_is_one_line(change, said):
    about = {**rows.encode_row(made_rows.row(**ROWS["both"])), **change}
    with pytest.raises(SlopeError) as caught:
        study_file.row_of(Path("out/study.yaml"), about)
    assert str(caught.value) == f"out/study.yaml: run one: must be {study_file.WHAT}: {said}"


def test_every_quantity_is_a_field_of_a_row():
    """Those of a road are fields of OnRoad, and so on; a number that a run may lack is one that may be unknown."""
    types = {one.name: (kind, one.type) for kind in (Finished, OnRoad, Mapped) for one in fields(kind)}
    row = made_rows.row(**ROWS["both"])
    for key, one in quantities.ALL.items():
        kind, of = types[key]
        assert row.value(key) == rows.encode_row(row)[key]
        assert kind is (Finished if one in quantities.OF_RUN else OnRoad if one in quantities.OF_ROAD else kind)
        assert not one.maybe or of == Optional[float], key
        if quantities.On.MEAN in one.on:
            assert of in (float, Optional[float]), key


def test_a_key_of_one_part_is_of_no_other():
    """They are beside each other in a file, and value() takes the first that has it."""
    names = [one.name for kind in (Finished, OnRoad, Mapped) for one in fields(kind)]
    assert len(names) == len(set(names)) and "status" not in names
    assert made_rows.row().value("remove_m3") is None


def test_a_record_of_several_kinds_is_the_smallest_that_has_all_keys():
    """An entry that lacks a key is refused, and not taken for a smaller one: of known events that weigh nothing."""
    weighted, known = made_study.weighted(), made_study.weighted(reached=None)
    for one in (weighted, known):
        entry = records.encode_record(made_study.ensemble(dict(vars(one))))
        assert records.read_record(ensemble_types.Ensemble, entry).known_events == one
    entry = records.encode_record(made_study.ensemble({}))
    for name in entry["known_events"].keys() - vars(known).keys():      # but for what is none by default
        lacks = {key: value for key, value in entry["known_events"].items() if key != name}
        with pytest.raises(records.NoRecord, match=f"known_events: must have {name}"):
            records.read_record(ensemble_types.Ensemble, {**entry, "known_events": lacks})


def test_what_is_none_by_default_is_not_written():
    design = ensemble_types.Design("sobol", 1, 64, {})
    assert records.encode_record(design) == {"kind": "sobol", "seed": 1, "points": 64, "variables": {}}
    assert records.encode_record(replace(design, fit="a"))["fit"] == "a"
    assert records.encode_record(ensemble_types.KnownVariable([], {"a": None})) == {"quantiles": [],
                                                                                    "rank": {"a": None}}
    assert records.read_record(ensemble_types.Design, records.encode_record(design)) == design


@pytest.mark.filterwarnings("ignore::rasterio.errors.NotGeoreferencedWarning")
def test_a_study_is_read_as_it_was_written(tiny_case, monkeypatch, capsys):
    """The rows of runs, one of which failed, before they are written, and after."""
    made, write = [], results.write_abouts
    monkeypatch.setattr(results, "write_abouts", lambda abouts: made.extend(abouts.values()) or write(abouts))
    Path("case/road.csv").write_text("13,0\n18,0\n18,24\n13,24\n")
    edit("case/in.tiny", "group       soil", 'if "${rolling} == 0.5" then "nonsense"\ngroup       soil')
    status, _, err = called(capsys, ["study", "case/in.tiny", "--set", "rolling=0,0.3,0.5", "--set", "steps=300",
                                     "--road", "case/road.csv", "--local", "-o", "out"])
    assert status == 2 and "1 of 3 runs failed" in err, err
    [about] = made
    kinds = [(type(row), getattr(row, "road", None) is not None) for row in about.runs]
    assert kinds == [(Finished, True)] * 2 + [(Failed, False)]
    assert study_file.load_study(Path("out/study.yaml")).runs == about.runs
    assert study_file.Study.read("out").runs == [rows.encode_row(row) for row in about.runs]
