"""inputs/16_flume/in.sarno: beads stay behind the gate, and flow below it; how deep they are at the gauge."""
import re
import shutil
from pathlib import Path

import numpy as np
import pytest

from deck_helpers import run_deck, script_of

CASE = Path(__file__).resolve().parents[2] / "inputs" / "16_flume"
COARSE = {"ratio": 6, "settle": 0.4, "duration": 1.4}


@pytest.fixture(scope="module")
def sarno():
    return script_of(CASE / "sarno.py")


def flow(folder, **variables):
    for path in CASE.glob("*.stl"):
        shutil.copy(path, folder)
    log = run_deck((CASE / "in.sarno").read_text(), folder, vars={**COARSE, **variables})
    (folder / "sarno.log").write_text(log)
    return log


def test_depth_of_layers(sarno):
    d = 0.01
    x, y = np.meshgrid(0.935 + d * np.arange(4), 0.005 + d * np.arange(8))
    layer = np.column_stack([x.ravel(), x.ravel(), y.ravel(), np.full(x.size, 1.0), np.ones(x.size)])
    three = np.concatenate([layer + [0, 0, 0, k * d - 1 + d, 0] for k in range(3)])
    assert sarno.depth(three, d) == pytest.approx(3 * d)
    assert sarno.depth(np.concatenate([three, three[:3] + [0, 0, 0, 0.1, 0]]), d) == pytest.approx(3 * d)   # in flight
    assert sarno.depth(layer[:10], d) == sarno.depth(layer[:0], d) == 0


def test_beads_wait_behind_the_gate_and_flow_below_it(sarno, tmp_path, monkeypatch):
    log = flow(tmp_path)
    beads = int(re.search(r"^sarno: d \S+ beads (\d+) opened", log, re.MULTILINE)[1])
    assert beads == round(2e5 / 6 ** 3)
    monkeypatch.chdir(tmp_path)
    time, deep, speed = sarno.history("sarno")
    assert time[0] < 0 and deep[time < -0.1].max() < sarno.ARRIVED
    assert 0.005 < deep[time > 0.3].mean() < 0.12 and speed[time > 0.3].mean() > 0.05
    frames = list(sarno.frames(tmp_path / "sarno.gauge.dump"))
    balls = np.concatenate([balls for _, balls in frames])
    assert ((balls[:, 1] > 0.93) & (balls[:, 1] < 0.97) & (balls[:, 2] > 0) & (balls[:, 2] < 0.08)).all()


@pytest.mark.long
def test_a_smooth_bed_is_faster_and_a_low_gate_holds_back(sarno, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    left = {}
    smooth = {"bed": "smooth"}
    for name, variables in (("rough", {}), ("smooth", smooth), ("low", {**smooth, "opening": 0.04})):
        log = flow(tmp_path, **variables)
        left[name] = int(re.search(r"^sarno: still on the chute (\d+)", log, re.MULTILINE)[1])
    assert left["smooth"] < 0.8 * left["rough"] and left["low"] > left["smooth"]
