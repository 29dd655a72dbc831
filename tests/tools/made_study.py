"""A study, as study_types has it, for tests that need a few of its entries: the others say that there is nothing.

Entries are given as study.yaml has them, or as study_types has them.
"""
import dataclasses
import typing
from types import NoneType

import yaml

from slope_tools import records
from slope_tools.findings import Finding, finding
from slope_tools.statistics.entries import Headline
from slope_tools.tables import ensemble_types, study_file, study_types

HEADER = {"deck": "in.site", "known": {}, "set": {}, "repeat": {}, "runs": 1, "finished": 1, "method": "", "ranks": 1,
          "jobs": 1, "package": None, "governs": "study", "balls_thick": None, "collected": "", "machine": {}}
NOTHING = {"largest": {}, "farthest": None, "conservative": None, "size": None, "ensemble": None, "step": None,
           "largest_restitution": None, "scatter": {}, "combinations": [], "envelope": None, "exceedance": None,
           "observed": None, "roads": [], "warnings": [], "runs": [], "headline": None, "stretches": None,
           "chain": None, "intensity": None, "next_step": None}


def made(kind, entries):
    """A record of plain entries, or of records; what is not given says nothing."""
    return records.read_record(kind, filled(kind, records.encode_record(entries)))


def filled(kind, value):
    if kind is Finding:
        return finding(value).entry()
    origin, parts = typing.get_origin(kind), typing.get_args(kind)
    if origin is typing.Union:
        several = [one for one in parts if one is not NoneType]
        fits = [one for one in several if isinstance(value, dict) and is_record(one) and value.keys() <= names(one)]
        fits.sort(key=lambda one: names(one) != value.keys())
        return None if value is None else filled([*fits, several[-1]][0], value)
    if isinstance(value, dict) and is_record(kind):
        unknown = value.keys() - names(kind)
        assert not unknown, f"{kind.__name__} has no {unknown}"
        types = typing.get_type_hints(kind)
        return {**{name: nothing(types[name]) for name in names(kind)},
                **{name: filled(types[name], one) for name, one in value.items()}}
    if isinstance(value, dict) and parts:
        return {name: filled(parts[1], one) for name, one in value.items()}
    return [filled(parts[0], one) for one in value] if isinstance(value, list) and parts else value


def is_record(kind):
    return dataclasses.is_dataclass(kind) or hasattr(kind, "_fields") and kind is not Finding


def names(kind):
    return typing.get_type_hints(kind).keys()


def nothing(kind):
    if typing.get_origin(kind) is typing.Union:
        return None
    kind = typing.get_origin(kind) or kind
    return {str: "", bool: False, int: 0, float: 0.0, list: []}.get(kind, {})


def study(header=None, **entries):
    return made(study_types.Study, {"study": {**HEADER, **(header or {})}, **NOTHING, **entries})


def conservative(volume, **entries):
    """Of one run, that is not withheld."""
    parts = {"volume_m3": volume, "mean_m3": volume, "chance_m3": None}
    return made(study_types.Conservative, {
        **parts, "rounded": dict(parts), "place_m3": 1.0, "kind": "largest of 1 run; chance unknown",
        "combination": "base", "set": {}, "label": "", "ground": None, "repeats": 1, "runs": 1, "combinations": 1,
        "scatter_m3": None, "degrees_of_freedom": None, "quantile": None, "starts_m3": None, "run": "one",
        "remove_m3": volume, "differences": [], "doubts": [], "withheld": [], "zero": None, **entries})


def ensemble(known=None, **entries):
    """known: entries of what known events say of it, which weigh it unless reached is None."""
    return made(ensemble_types.Ensemble, {
        "design": {"kind": "sobol", "seed": 1, "points": 64, "variables": {}}, "runs": 64, "finished": 64,
        "failed": 0, "points": 64, "confidence": 0.9, "of": None, "quantities": {}, "influence": {}, "doubts": [],
        "maps": [], "known_events": None if known is None else weighted(**known), "withheld": [], **entries})


def weighted(**entries):
    """Known events that weigh the runs; with reached=None they do not."""
    known = {"set": "rock_avalanches", "events": 69, "left_out": [], "confined": None, "path": "", "volume_Mm3": 1.0,
             "outside": [], "reached": 0.95, "doubts": []}
    weighs = {"short": 0.0, "far": 0.0, "runs": 64, "failed": 0, "effective": 50.0, "distance": 0.0, "far_by_lobe": [],
              "gaps": [], "shortest_m": 1.0, "longest_m": 9.0, "half_beyond_m": None, "path_m": 100.0,
              "beyond_path": 0.0, "added": {"points": 0, "stopped": None, "batches": []}, "quantities": {},
              "to_remove": None, "variables": {}, "influence": {}, "weights": {}, "maps": []}
    if entries.get("reached", 1) is None:
        return made(ensemble_types.Known, {**known, **{name: entries[name] for name in known.keys() & entries.keys()}})
    return made(ensemble_types.Weighted, {**known, **weighs, **entries})


def headline(**entries):
    return made(Headline, {
        "kind": "number", "volume_m3": None, "share": None, "low_m3": None, "high_m3": None, "source": None,
        "paper": None, "ensemble": None, "road": None, "reasons": [], "band": [], **entries})


def write(folder, rows, header=None, **entries):
    """study.yaml of rows (made_rows), whose first one has the farthest ball unless entries say otherwise."""
    given = {"largest": {"front_m": {"value": 1.0, "run": rows[0].run}}, **entries}
    if given.get("conservative"):
        header = {"road": {"cut_angle": 30, "mesh": 10, "local": "road.csv"}, **(header or {})}
    about = study({"runs": len(rows), "finished": len(rows), **(header or {})}, runs=list(rows), **given)
    (folder / "study.yaml").write_text(yaml.safe_dump(study_file.encode_study(about)))
