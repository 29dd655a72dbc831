"""Rows of a study's table for tests that need a few of their numbers: the others are those of a run that nothing is
wrong with, or unknown."""
import dataclasses

from slope_tools.tables import rows

RELEASE = {"released": 1000.0, "body": None, "factor": 1.9, "from_cubic": 0.0, "removed": None}
USUAL = {
    "run": "one", "status": "finished", "set": {}, "repeat": {}, "batch": 0, "variables": {}, "ball_m3": 1.0,
    "mass_error": 0.0, "released_m3": 1000.0, "on_grid_m3": 1000.0, "off_grid_m3": 0.0, "lost_m3": 0.0,
    "residual_m3": 0.0, "front_m": 100.0, "reach_angle_deg": 30.0, "centroid_m": 50.0, "thickness_m": 2.0,
    "max_thickness_m": 3.0, "max_speed_m_s": 10.0, "stop_time_s": 20.0, "stop_reason": "rest", "moving": False,
    "at_rest": True, "end": "at rest", "end_short": "at rest", "moves_share": 0.0, "moving_share": 0.0,
    "release": RELEASE, "log_warnings": [], "wall_s": None, "summary": "one/site.summary.yaml", "slope_version": "1",
    "lammps_version": "1", "structures": {}, "lines": {}}
OF_PART = {"road": {"road_on_body_m2": 0.0, "remove_m3": 0.0, "remove_on_road_m3": 0.0, "remove_beside_road_m3": 0.0,
                    "blocked_m": 0.0, "stretches": [], "clearing": {}, "road_warnings": [], "by_10_m": []},
           "mapped": {"overlap": 0.5}}
FAILED = {"run": "one", "set": {}, "repeat": {}, "batch": 0, "error": "it diverged"}


def names(kind):
    return [one.name for one in dataclasses.fields(kind) if one.name not in rows.PARTS]


def row(**given):
    """A row of study.yaml with these entries, of a run with a road or a mapped deposit if one of them is of it."""
    if given.get("status") == "failed":
        return rows.read_row({**FAILED, **given})
    about = {**dict.fromkeys(names(rows.Finished)), **USUAL}
    for part, kind in rows.PARTS.items():
        if given.keys() & names(kind):
            about.update({**dict.fromkeys(names(kind)), **OF_PART[part]})
    unknown = given.keys() - about.keys()
    assert not unknown, f"no fields: {unknown}"
    return rows.read_row({**about, **given})


def changed(one, **given):
    """The same row with other entries."""
    return row(**{**rows.encode_row(one), **given})
