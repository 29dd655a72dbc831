"""What a run says is computed once, and again when the run, the road or the tools are others: kept.py, run_rows.py."""
import json
from pathlib import Path

import numpy as np
import pytest

from tiny_collapse import loaded

from slope_tools import kept
from slope_tools.studies import run_rows

pytestmark = pytest.mark.filterwarnings("ignore::rasterio.errors.NotGeoreferencedWarning")
COMMAND = "study case/in.tiny"
ROAD = "--road case/road.csv --local"


@pytest.fixture
def here(tiny_case):
    Path("case/road.csv").write_text("13,0\n18,0\n18,24\n13,24\n")
    return tiny_case


def test_a_value_is_made_once(tmp_path, monkeypatch):
    made, beside = [], tmp_path / "beside"

    def make():
        made.append(len(made))
        beside.write_text(f"{len(made)}")
        return {"x": (np.float64(0.1) + 0.2, None, float("inf")), "n": np.int64(len(made))}

    def value(made_of=1):
        return kept.value(tmp_path / "value.json", {"of": made_of, "path": tmp_path}, make, [beside])
    first = value()
    assert first == value() == {"x": [0.1 + 0.2, None, float("inf")], "n": 1} and made == [0]
    assert value(2)["n"] == 2 and value(2)["n"] == 2        # of something else
    beside.write_text("of the user")
    assert value(2)["n"] == 3 and beside.read_text() == "3"
    beside.unlink()
    assert value(2)["n"] == 4
    for text in ("", "{", "[]", json.dumps({"made_of": "x"})):
        (tmp_path / "value.json").write_text(text)
        assert value(2)["n"] == len(made)
    assert kept.value(tmp_path / "nowhere" / "value.json", 1, lambda: 5) == 5      # which cannot be written
    before = len(made)
    monkeypatch.setattr(kept, "tools", lambda: "other tools")
    assert value(2)["n"] == before + 1


def test_a_second_study_measures_nothing(succeed, monkeypatch):
    """And says the same, to the digit; another road, or another cut, is measured, and a run that was made anew."""
    words = f"--set rolling=0,0.3 {ROAD} -o out"
    succeed(words)
    before, table = loaded(), Path("out/study.csv").read_text()
    calls = []
    for name in ("measured", "measured_on"):
        def counted(*given, name=name, really=getattr(run_rows, name)):
            calls.append(name)
            return really(*given)
        monkeypatch.setattr(run_rows, name, counted)
    succeed(words)
    assert not calls and Path("out/study.csv").read_text() == table and loaded()[0]["runs"] == before[0]["runs"]
    succeed(f"{words} --cut-angle 45")
    assert calls == ["measured_on"] * 2 and Path("out/study.csv").read_text() != table
    Path("case/road.csv").write_text("13,0\n17,0\n17,24\n13,24\n")
    succeed(words)
    assert calls == ["measured_on"] * 4
    Path("case/road.prj").write_text("another place")       # beside it
    succeed(words)
    assert calls == ["measured_on"] * 6
    Path("case/road.prj").unlink()
    succeed(words)
    del calls[6:]
    thickness, = Path("out/rolling_0").glob("*.thickness.asc")
    thickness.write_text(thickness.read_text() + "\n")
    succeed(words)
    assert calls[6:] == ["measured", "measured_on"]
    Path("out/rolling_0.3/volume/volume.tif").write_bytes(b"")
    succeed(words)
    assert calls[8:] == ["measured_on"] and Path("out/rolling_0.3/volume/volume.tif").stat().st_size
