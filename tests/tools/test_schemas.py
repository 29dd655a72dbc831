"""YAML files that the tools read: each is checked against a schema; what is wrong with one is a line with its place."""
import json
import re
from pathlib import Path
from types import SimpleNamespace

import pytest

import made_study
from made_rows import row

from slope_tools import records
from slope_tools.case import run_folders
from slope_tools.ensembles import farther, sample
from slope_tools.errors import SlopeError
from slope_tools.fitting import calibration
from slope_tools.report import convergence_part, heading, reference
from slope_tools.seismic import fragility_files
from slope_tools.survey import rasters
from slope_tools.tables import ensemble_types, named_run, rows, structures, study_file

TOP = Path(__file__).resolve().parents[2]
TOOLS = TOP / "tools" / "slope_tools"
LHS = SimpleNamespace(about=ensemble_types.Design("lhs", 1, 4, {}), kind="lhs", number=4, seed=1)
SIDECAR = ("{crs: null, origin: {east: 0, north: 0}, size: {rows: 3, columns: 4}, extent: {xlo: 0, xhi: 4, ylo: 0, "
           "yhi: %s}}")


def study(runs=(), **entries):
    """The text of a study.yaml."""
    largest = {"front_m": {"run": "one", "value": 100.0}}
    return json.dumps({**study_file.encode_study(made_study.study(largest=largest)), **entries, "runs": list(runs)})


def weighted(**entries):
    """An ensemble's entry, whose known events have these."""
    about = records.encode_record(made_study.ensemble({}))
    return {**about, "known_events": {**about["known_events"], **entries}}


def without(about, name):
    return {key: value for key, value in about.items() if key != name}


FILES = {       # file: (its reader, a text, what must be said)
    "calibrate.ledger.yaml": (lambda folder: calibration.Ledger(folder, {"seed": 1}, [SimpleNamespace(name="a")]), (
        ("about: {seed: 1}", "must have points"),
        ("{about: {seed: 1}, points: [{a: '1'}, {b: '1'}]}", "second value: must have a"),
        ("{about: {seed: 1}, points: [{a: 1}]}", "first value: a: must be a text, got 1"),
        ("{about: {seed: 2}, points: []}", "must be of the same observation, variables and seed"))),
    "added.yaml": (lambda folder: farther.read_added_runs(folder, LHS), (
        ("variables: {}", "(remove it): must have batches"),
        ("{variables: {}, batches: [{box: [[0, 1]]}]}", "batches: first value: must have points"),
        ("{variables: {}, batches: [{box: [[0]], points: [{a: '1'}]}]}", "must have at least 2 items"))),
    "design.yaml": (lambda folder: sample.check_growth(folder, LHS), (("- 1", "must be a section with keys"),)),
    "run.line.yaml": (lambda folder: structures.of_line(folder, "run"), (
        ("net_volume: 1", "must have forward and back"),
        ("{forward: {volume: 1, crossings: 2}, back: {volume: .nan, crossings: 0}, net_volume: 1}",
         "back: volume: must be a finite number, got nan"))),
    "terrain.yaml": (lambda folder: rasters.read_sidecar(folder / "terrain.asc"), (
        ("{", "must be a sidecar that `slope terrain` wrote"),
        (SIDECAR % "high", "extent: yhi: must be a finite number, got 'high'"),
        ((SIDECAR % "3").replace("rows: 3", "rows: 0"), "size: rows: must be >= 1, got 0"),
        ((SIDECAR % "3").replace("null", "{wkt: nowhere}"), "must be a sidecar that `slope terrain` wrote (The WKT"))),
    "fragility.yaml": (fragility_files.read_fragility, (
        ("{bodies: [], peaks_gal: [1], hazard_curve: null, warnings: []}", "bodies: must not be empty"),
        ("{bodies: [{body: '1', base_sha256: a}], peaks_gal: [a], hazard_curve: null, warnings: []}",
         "peaks_gal: first value: must be a finite number, got 'a'"))),
    "variables.yaml": (run_folders.begun, (("inputs: [1]", "inputs: must be a section with keys or null, got [1]"),
                                           ("set: {d: 2}", "set: d: must be a text, got 2"),
                                           ("ranks: two", "ranks: must be a whole number, got 'two'"),
                                           ("package: 1.0", "package: must be a text or null, got 1.0"),
                                           ("lmp_sha256: [a]", "lmp_sha256: must be a text or null, got ['a']"))),
    "finished.yaml": (run_folders.ended, (("wall_seconds: 1", "must have summary"),)),
    "study.yaml": (named_run.governing_run, (
        ("runs: []", "must have study and largest and farthest and conservative and"),
        (study(), "must have a finished run, got 0 that failed"),
        (study([rows.encode_row(row(status="failed"))]), "must have a finished run, got 1 that fail"),
        (study(ensemble={**weighted(), "of": 1}), "ensemble: of: must be a text, got 1"),
        (study(headline={**records.encode_record(made_study.headline()), "share": "a"}),
         "headline: share: must be a finite number, got 'a'"),
        (study(ensemble=weighted(to_remove=[{}])), "to_remove: first value: must have share and value"),
        (study(ensemble={**weighted(), "known_events": without(weighted()["known_events"], "weights")}),
         "known_events: must have weights"),
        (study(conservative={"run": 1}), "conservative: must have volume_m3 and"),
        (study(ensemble={**weighted(), "withheld": ["why"]}),
         "withheld: first value: must be a section with keys, got 'why'"),
        (study([rows.encode_row(row())], ensemble={**weighted(), "withheld": [{"kind": "of another version",
                                                                               "text": "a"}]}),
         "withheld must have reasons of this version"),
        (study([{"run": "one", "status": "finished", "set": {}}]),
         f"study.yaml: run one: must be {study_file.WHAT}: must have repeat and batch and variables and"),
        (study([{**rows.encode_row(row()), "front_m": "far"}]),
         f"study.yaml: run one: must be {study_file.WHAT}: front_m: must be a finite number, got 'far'"),
        (study([{"run": "one", "status": "running", "set": {}}]), "status: must be failed or finished, got 'run"))),
    "site.yaml": (heading.site_of, (("project: [1]", "project: must be a section with keys or null, got [1]"),
                                    ("terrain: {files: [1]}", "terrain: files: first value: must be a text, got 1"))),
    "converge.yaml": (lambda folder: convergence_part.Sizes(folder / "converge.yaml"), (
        ("study: {variable: d}", f"must be {convergence_part.WHAT}: must have quantities"),
        ("{study: {variable: d, deck: a, finished: 1}, quantities: {}}", "quantities: must not be empty"))),
    "r.yaml": (lambda folder: reference.read_reference(folder / "r.yaml", {"a": "it"}), (
        ("{title: T, quantities: {a: {levels: {b: 1}, 7: 1, more: 1}}}", "must have no 7, more, which is unknown"),
        ("{title: T, quantities: {a: {variable: v, series: {-9: 1}}}}", "series: -9: must be a section with keys"),
        ("{title: T, quantities: {7: {levels: {b: 1}}}}", "must be columns that all runs have, a, got 7"),
        ("{title: '', quantities: {a: {levels: {b: 1}}}}", "title: must not be empty"),
        ("{title: T, quantities: {a: {variable: v, series: {b: {c: 1}}}}}", "must be a finite number, got 'c'"),
        ("{title: T, quantities: {a: {levels: {b: 1}, more: 1}}}", "must have no more, which is unknown"))),
}


@pytest.mark.parametrize("name, reader, text, said", [
    (name, reader, text, said) for name, (reader, several) in FILES.items() for text, said in several])
def test_what_is_wrong_with_a_file_is_one_line(tmp_path, name, reader, text, said):
    (tmp_path / name).write_text(text + "\n")
    with pytest.raises(SlopeError) as caught:
        reader(tmp_path)
    assert str(tmp_path / name) in str(caught.value) and said in str(caught.value)
    assert "\n" not in str(caught.value)


def test_reference_values(tmp_path):
    path = tmp_path / "reference.yaml"
    path.write_text("{title: ' T  U ', quantities: {a: {levels: {b: 1}, variable: v, series: {c: {2: 5, 0.5: 4}}}}}")
    found = reference.read_reference(path, {"a": "it"})
    assert (found.title, found.remark) == ("T U", "")
    assert found.quantities == {"a": reference.Quantity("v", {"c": [(0.5, 4.0), (2.0, 5.0)]}, {"b": 1.0})}


def test_yaml_is_read_by_its_schema_only():
    """disk.parse_yaml() checks nothing: site.yaml has its own check, its version first."""
    calls = {path.relative_to(TOOLS).as_posix() for path in TOOLS.glob("**/*.py")
             if re.search(r"parse_yaml\(", path.read_text())}
    assert calls == {"disk.py", "schemas.py", "sites/site_choices.py"}
