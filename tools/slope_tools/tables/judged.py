"""What is wrong or doubtful with runs, judged from the rows of their table: here, and nowhere else.

A finding has the numbers of the gravest run, which is the first of its runs.
"""
from typing import Any, Dict, Iterable, List, Mapping, Optional, Sequence

from ..case.logs import kind
from ..deposits import left_words, rest
from ..deposits.travel_shares import BEYOND
from ..findings import Finding, finding, gathered
from ..sites.site_warnings import of_volume
from . import quantities
from .released import Release, release

BALANCE = 1e-9          # of the released volume
LOST = 1e-6             # of the released volume
SOFT = 1e4              # stiffness number: with softer contacts a mass goes too far
VERSIONS = ("slope_version", "lammps_version", "lmp_sha256")

Row = Mapping[str, Any]


def columns(summary: Mapping[str, Any], log) -> Dict[str, Any]:
    """What a row has of a run that is judged, by its summary and its Log."""
    state, motion = rest.state(summary), summary["motion"]
    return {**quantities.of_summary(summary), "at_rest": state.at_rest, "end": state.text, "end_short": state.short,
            "moves_share": state.share, "moving_share": motion["moving_share"], "fast_share": motion.get("fast_share"),
            "stiffness_number": (summary.get("release") or {}).get("stiffness_number"),
            "fast_volume_m3": motion.get("fast_volume"), "fast_speed_m_s": motion.get("fast_speed"),
            "release": release(summary, [*log.notes, *log.warnings])._asdict(), "log_warnings": log.warnings}


def of_runs(rows: Sequence[Row]) -> List[Finding]:
    """On runs, finished or failed."""
    finished = [row for row in rows if row["status"] == "finished"]
    return [*failed(rows), *not_at_rest(finished), *lost(finished), *released(finished), *soft(finished),
            *large(finished), *balance(finished), *programs(finished), *of_road(finished)]


def of(row: Row) -> Sequence[str]:
    """The name of a row's run; a run alone has none."""
    return (row["run"],) if row["run"] else ()


def failed(rows: Sequence[Row]) -> List[Finding]:
    """By their errors, whose numbers may differ."""
    return gathered((Finding("failed", {"error": str(row.get("error"))}, of(row)) for row in rows
                     if row["status"] != "finished"), len(rows), lambda one: kind(one.numbers["error"]))


def not_at_rest(finished: Sequence[Row]) -> List[Finding]:
    found = []
    for name, moving in (("in motion", True), ("moving", False)):
        mine = sorted((row for row in finished if not row["at_rest"] and row["moving"] == moving),
                      key=lambda row: -row["moves_share"])
        cut = sum(row["stop_reason"] == rest.CUT for row in mine)
        among = f", {cut} of them stopped at their duration" if cut and len(mine) > 1 else ""
        found += [Finding(name, {"end": row["end"], "time": row["stop_time_s"], "share": row["moves_share"],
                                 "among": among}, of(row)) for row in mine]
    return gathered(found, len(finished))


def lost(finished: Sequence[Row]) -> List[Finding]:
    """Mass that is not on the maps."""
    volume = {id(row): row["off_grid_m3"] + row["lost_m3"] for row in finished}
    gone = sorted((row for row in finished if volume[id(row)] > LOST * row["released_m3"]),
                  key=lambda row: -volume[id(row)])
    if not gone:
        return []
    much = any(volume[id(row)] > BEYOND * row["released_m3"] for row in gone)
    most, left = float(volume[id(gone[0])]), gone[0].get("left") or ()
    return [Finding("lost much" if much else "lost", {
        "volume": most, "percent": 100 * most / gone[0]["released_m3"], "up_to": "up to " * (len(gone) > 1),
        "where": f" ({left_words.where(left)})" if left else "",
        "add": f" by {left_words.to_add(left)}" if left else "",
        "of": len(finished)}, tuple(name for row in gone for name in of(row)))]


def released(finished: Sequence[Row]) -> List[Finding]:
    return gathered((one._replace(runs=of(row)) for row in finished for one in Release(**row["release"]).doubts),
                    len(finished))


def soft(finished: Sequence[Row]) -> List[Finding]:
    """Contacts that are too soft for the weight on them; none is known of runs of older versions, and others."""
    found = sorted((row for row in finished if (row.get("stiffness_number") or SOFT) < SOFT),
                   key=lambda row: row["stiffness_number"])
    return gathered((Finding("soft", {"number": float(row["stiffness_number"]), "limit": SOFT}, of(row))
                     for row in found), len(finished))


def large(finished: Sequence[Row]) -> List[Finding]:
    return of_volume(max((row["released_m3"] for row in finished), default=0.0))


def balance(finished: Sequence[Row]) -> List[Finding]:
    found = sorted((row for row in finished if not abs(row.get("mass_error", 0.0)) <= BALANCE),
                   key=lambda row: -abs(row["mass_error"]))
    return gathered((Finding("balance", {"share": float(row["mass_error"])}, of(row)) for row in found), len(finished))


def programs(finished: Sequence[Row]) -> List[Finding]:
    """Runs of different ones."""
    return [Finding("programs", {"what": what, "which": ", ".join(sorted(several))}) for what in VERSIONS
            if len(several := {str(row.get(what)) for row in finished}) > 1]


def of_road(finished: Sequence[Row]) -> List[Finding]:
    """What `slope volume` said."""
    found = gathered((finding(entry)._replace(runs=of(row)) for row in finished
                      for entry in row.get("road_warnings") or ()), len(finished))
    return [one._replace(runs=()) if len(one.runs) == len(finished) else one for one in found]


def of_logs(rows: Sequence[Row], said: Iterable[str]) -> List[Finding]:
    """What LAMMPS and its styles warned of; said: kinds of lines that other findings cover."""
    return gathered((Finding("LAMMPS", {"line": line}, of(row)) for row in rows
                     for line in row.get("log_warnings") or () if kind(line) not in said), len(rows),
                    lambda one: kind(one.numbers["line"]))


KINDS = {"failed", "in motion", "moving", "lost much", "lost", "bulk factor", "body volume", "balls removed", "soft",
         "large", "balance", "programs"}     # of the above: what a file says of them is judged from its rows


def limits(study: Optional[Mapping[str, Any]], repeats: bool) -> List[Finding]:
    """What no run of a study, or a run alone, can tell; repeats: whether runs were repeated."""
    sampled = study and study.get("ensemble")
    best: Any = study and study["conservative"]
    found = [] if repeats or sampled else [Finding("no repeats")]
    # where the size error is why there is no number, the number's place says so
    if not (sampled or best and (best["size_m3"] is not None
                                 or study and study.get("size_error_unusable") and best.get("withheld"))):
        found.append(Finding("no sizes"))
    return [*found, Finding("slip assumed")]
