"""What runs say is computed once, and again when a run, the road, what is asked or the tools are others: kept.py."""
import json
import os
import shutil
import time
from pathlib import Path

import numpy as np
import pytest

from test_conditioned import write_set
from tiny_collapse import loaded

from slope_tools import disk, kept
from slope_tools.ensembles import conditioned, ensemble, ensemble_maps
from slope_tools.statistics import emulator
from slope_tools.studies import run_rows
from slope_tools.tables import study_maps

pytestmark = pytest.mark.filterwarnings("ignore::rasterio.errors.NotGeoreferencedWarning")
COMMAND = "study case/in.tiny"
ROAD = "--road case/road.csv --local"
ENSEMBLE = ("--sample 8 --vary friction=2:40 --vary rolling=0:0.3 --set steps=900 --mobility small.csv --unconfined "
            f"--exceed 0.1 {ROAD} -o out")
KEPT = ".emulated.json", ".maps.json", "ensemble/.maps.json", "known_events/.maps.json"


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
        return kept.value(tmp_path / "value.json", {"of": made_of, "path": tmp_path}, make, lambda: [beside])
    first = value()
    assert first == value() == {"x": [0.1 + 0.2, None, float("inf")], "n": 1} and made == [0]
    assert value(2)["n"] == 2 and value(2)["n"] == 2        # of something else
    beside.write_text("of the user")
    assert value(2)["n"] == 3 and beside.read_text() == "3"
    beside.unlink()
    assert value(2)["n"] == 4
    whole = (tmp_path / "value.json").read_text()
    for text in ("", "{", "[]", json.dumps({"made_of": "x"}), whole[:-1], whole.replace("0.30000000000000004", "0.3")):
        (tmp_path / "value.json").write_text(text)
        assert value(2)["n"] == len(made)
    (tmp_path / "value.json").write_bytes(b"\xff" + whole.encode())
    assert value(2)["n"] == len(made) == 11
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
    for name in ("measure_run", "measured_on"):
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
    assert calls[6:] == ["measure_run", "measured_on"]
    Path("out/rolling_0.3/volume/volume.tif").write_bytes(b"")
    succeed(words)
    assert calls[8:] == ["measured_on"] and Path("out/rolling_0.3/volume/volume.tif").stat().st_size


def test_a_second_study_reads_only_what_changed(succeed, monkeypatch):
    """In a process of its own; an edit of the same size, with its time set back, is seen."""
    monkeypatch.setattr(kept, "SETTLED", 0.0)
    words, read = f"--set rolling=0,0.3 {ROAD} -o out", []
    really, load = disk.digest_of, disk.parse_yaml
    monkeypatch.setattr(disk, "digest_of", lambda path: read.append(Path(path)) or really(path))
    monkeypatch.setattr(disk, "parse_yaml", lambda path, what: read.append(Path(path)) or load(path, what))

    def again():
        disk.known.clear()
        kept.tools.cache_clear()
        read.clear()
        succeed(words)
        mine = {Path(os.path.relpath(path, "out")) for path in read}
        return {path for path in mine if path.parts[0] != ".."}
    succeed(words)
    again()
    left = {path for path in again() if path.parts[0] != ".inputs"}
    assert left == {Path("rolling_0/tiny.summary.yaml")}        # of the body, of the first run
    raster = Path("out/rolling_0.3/volume/volume.tif")
    was = raster.stat()
    raster.write_bytes(b"0" * was.st_size)
    os.utime(raster, ns=(was.st_atime_ns, was.st_mtime_ns))
    assert raster.relative_to("out") in again() and raster.read_bytes()[:1] != b"0"
    marker = Path("out/rolling_0/finished.yaml")
    marker.write_text(marker.read_text() + "# edited\n")
    assert marker.relative_to("out") in again()
    Path("out", kept.FILE).write_text("[1, 2]")
    assert marker.relative_to("out") in again()


def test_a_file_that_may_change_unseen_is_not_remembered(tmp_path, monkeypatch):
    """At once after it was written: not within the resolution of the time of change."""
    file, path = tmp_path / "file", tmp_path / kept.FILE
    monkeypatch.setattr(disk, "known", {})
    file.write_text("x")
    first = disk.sha256(file)
    kept.remember(path)
    assert str(file) not in path.read_text()
    monkeypatch.setattr(kept, "SETTLED", 0.02)
    time.sleep(0.03)
    disk.known[disk.DIGEST, str(file)] = disk.known[disk.DIGEST, str(file)]._replace(value="too early")
    kept.remember(path)
    assert first in path.read_text() and "too early" not in path.read_text()


def test_numbers_count_by_their_values():
    assert kept.digest({"width": 0, "start": 2.5}) == kept.digest({"width": 0.0, "start": 2.5})
    assert kept.digest(["[1.0]"]) != kept.digest(["[1]"]) and kept.digest([0]) != kept.digest([False])


def test_arrays_and_dataclasses_count_in_full():
    """A text of theirs would be cut short."""
    one = np.arange(5000.0)
    other = one.copy()
    other[2500] += 1e-9
    assert kept.digest(one) != kept.digest(other)
    levels, mass = ensemble_maps.Thresholds([0.1], [5.0], [1e5]), [conditioned.Masses(each, 0.1, each, 3.0, 1, each)
                                                                   for each in (one, other)]
    assert len({kept.digest([levels, each]) for each in mass}) == 2
    assert kept.digest([levels, mass[0]]) == kept.digest([levels, conditioned.Masses(one, 0.1, one, 3.0, 1, one)])


@pytest.fixture
def again(here, succeed, monkeypatch):
    """again(WORDS): an ensemble that is weighted by known events; gives what was made anew, and all of its files."""
    write_set("small.csv")
    monkeypatch.setattr(emulator, "SMOOTHNESS", (2.5,))     # how good they are does not matter here
    made = []
    for name, module, function in (("emulators", ensemble, "emulate"), ("over all", study_maps.Maps, "write"),
                                   ("", ensemble_maps, "of_kind")):
        def counted(*given, name=name, really=getattr(module, function), **more):
            made.append(name or given[0].name)
            return really(*given, **more)
        monkeypatch.setattr(module, function, counted)

    def study(words=ENSEMBLE):
        made.clear()
        succeed(words)
        files = {str(path): path.read_bytes() for folder in ("out", "out/ensemble", "out/known_events")
                 for path in Path(folder).iterdir() if path.is_file() and not path.name.startswith(".")}
        about = files.pop("out/study.yaml").decode().splitlines()
        files["study.yaml"] = [line for line in about if not line.startswith("  collected: ")]
        return set(made), files
    return study


def test_a_second_ensemble_fits_nothing_and_maps_nothing(again):
    """And says the same; what the user did to a file, a run that changed or was added, and other events are seen."""
    everything = {"emulators", "over all", "ensemble", "known_events"}
    made, before = again()
    assert made == everything and {"out/exceedance_0.1m.asc", "out/ensemble/thickness_q50.asc",
                                   "out/known_events/thickness.tif", "out/influence.csv"} <= set(before)
    assert again() == (set(), before)
    for k, name in enumerate(KEPT):      # gone, or no file of ours
        Path("out", name).unlink()
        if k % 2:
            shutil.copy("case/in.tiny", Path("out", name))
    assert again() == (everything, before)

    # files of the user's
    Path("out/exceedance_0.1m.asc").write_text("mine")
    Path("out/known_events/arrival_reached.asc").rename("out/known_events/arrival_reachec.asc")
    Path("out/exceedance_7m.asc").write_text("of another study")
    assert again() == ({"over all", "known_events"}, before)
    Path("out/envelope_thickness.yaml").unlink()
    assert again() == ({"over all"}, before)
    with open("out/ensemble/max_speed.tif", "ab") as out:
        out.write(b"0")
    assert again() == ({"ensemble"}, before)

    # other questions
    made, other = again(f"{ENSEMBLE} --except 'event 3'")
    assert made == {"emulators", "known_events"} and other["out/hazard.csv"] == before["out/hazard.csv"]
    assert other["out/weights.csv"] != before["out/weights.csv"]
    made, other = again(ENSEMBLE.replace("--exceed 0.1", "--exceed 0.2"))
    assert made == everything and "out/exceedance_0.1m.asc" not in other
    assert again() == (everything - {"emulators"}, before)

    # other runs
    raster = next(Path("out").glob("steps_*/*.max_speed.asc"))
    text = raster.read_text().splitlines(True)
    raster.write_text("".join(text[:6] + [line.replace("0", "9") for line in text[6:]]))
    made, other = again()
    assert made >= {"ensemble", "known_events"} and "over all" not in made
    assert other["out/ensemble/max_speed.tif"] != before["out/ensemble/max_speed.tif"]
    made, other = again(ENSEMBLE.replace("--sample 8", "--sample 12"))
    assert made == everything and len(other["out/study.csv"].splitlines()) > len(before["out/study.csv"].splitlines())
