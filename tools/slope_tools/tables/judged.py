"""What is wrong or doubtful with runs, judged from the rows of their table: here, and nowhere else.

A finding has the numbers of the gravest run, which is the first of its runs.
"""
from typing import Any, Dict, Iterable, List, Mapping, Optional, Sequence

from ..case.logs import kind
from ..deposits import left_words, rest
from ..deposits.travel_shares import BEYOND
from ..findings import Finding, gathered
from ..sites.site_warnings import of_volume
from . import study_types
from .released import release
from .rows import Failed, Finished, Row, finished_of

BALANCE = 1e-9          # of the released volume
LOST = 1e-6             # of the released volume
SOFT = 1e4              # stiffness number: with softer contacts a mass goes too far
VERSIONS = ("slope_version", "lammps_version", "lmp_sha256")


def list_ending_columns(summary: Mapping[str, Any], log) -> Dict[str, Any]:
    """What a row has, beside its quantities, of how a run ended, by its summary and its Log."""
    state, motion = rest.state(summary), summary["motion"]
    return {"at_rest": state.at_rest, "end": state.text, "end_short": state.short, "moves_share": state.share,
            "moving_share": motion["moving_share"], "fast_share": motion.get("fast_share"),
            "stiffness_number": (summary.get("release") or {}).get("stiffness_number"),
            "fast_volume_m3": motion.get("fast_volume"), "fast_speed_m_s": motion.get("fast_speed"),
            "release": release(summary, [*log.notes, *log.warnings])._asdict(), "log_warnings": log.warnings}


def of_runs(rows: Sequence[Row]) -> List[Finding]:
    """On runs, finished or failed."""
    finished = finished_of(rows)
    return [*failed(rows), *not_at_rest(finished), *lost(finished), *released(finished), *soft(finished),
            *large(finished), *balance(finished), *programs(finished), *judge_road(finished)]


def name_row(row: Row) -> Sequence[str]:
    """The name of a row's run; a run alone has none."""
    return (row.run,) if row.run else ()


def failed(rows: Sequence[Row]) -> List[Finding]:
    """By their errors, whose numbers may differ."""
    return gathered((Finding("failed", {"error": row.error}, name_row(row)) for row in rows
                     if isinstance(row, Failed)), len(rows), lambda finding: kind(finding.numbers["error"]))


def not_at_rest(finished: Sequence[Finished]) -> List[Finding]:
    findings = []
    for name, moving in (("in motion", True), ("moving", False)):
        mine = sorted((row for row in finished if not row.at_rest and row.moving == moving),
                      key=lambda row: -row.moves_share)
        cut = sum(row.stop_reason == rest.CUT for row in mine)
        among = f", {cut} of them stopped at their duration" if cut and len(mine) > 1 else ""
        findings += [Finding(name, {"end": row.end, "time": row.stop_time_s, "share": row.moves_share,
                                    "among": among}, name_row(row)) for row in mine]
    return gathered(findings, len(finished))


def lost(finished: Sequence[Finished]) -> List[Finding]:
    """Mass that is not on the maps."""
    volume = {id(row): row.off_grid_m3 + row.lost_m3 for row in finished}
    gone = sorted((row for row in finished if volume[id(row)] > LOST * row.released_m3),
                  key=lambda row: -volume[id(row)])
    if not gone:
        return []
    much = any(volume[id(row)] > BEYOND * row.released_m3 for row in gone)
    most, left = float(volume[id(gone[0])]), gone[0].left or ()
    return [Finding("lost much" if much else "lost", {
        "volume": most, "percent": 100 * most / gone[0].released_m3, "up_to": "up to " * (len(gone) > 1),
        "where": f" ({left_words.where(left)})" if left else "",
        "add": f" by {left_words.to_add(left)}" if left else "",
        "of": len(finished)}, tuple(name for row in gone for name in name_row(row)))]


def released(finished: Sequence[Finished]) -> List[Finding]:
    return gathered((one._replace(runs=name_row(row)) for row in finished for one in row.release.doubts),
                    len(finished))


def soft(finished: Sequence[Finished]) -> List[Finding]:
    """Contacts that are too soft for the weight on them; none is known of runs of older versions, and others."""
    found = sorted(((row.stiffness_number or SOFT, row) for row in finished), key=lambda pair: pair[0])
    return gathered((Finding("soft", {"number": float(number), "limit": SOFT}, name_row(row))
                     for number, row in found if number < SOFT), len(finished))


def large(finished: Sequence[Finished]) -> List[Finding]:
    return of_volume(max((row.released_m3 for row in finished), default=0.0))


def balance(finished: Sequence[Finished]) -> List[Finding]:
    found = sorted((row for row in finished if not abs(row.mass_error) <= BALANCE),
                   key=lambda row: -abs(row.mass_error))
    return gathered((Finding("balance", {"share": float(row.mass_error)}, name_row(row)) for row in found),
                    len(finished))


def programs(finished: Sequence[Finished]) -> List[Finding]:
    """Runs of different ones."""
    return [Finding("programs", {"what": what, "which": ", ".join(sorted(several))}) for what in VERSIONS
            if len(several := {str(row.value(what)) for row in finished}) > 1]


def judge_road(finished: Sequence[Finished]) -> List[Finding]:
    """What `slope volume` said."""
    found = gathered((one._replace(runs=name_row(row)) for row in finished if row.road
                      for one in row.road.road_warnings), len(finished))
    return [one._replace(runs=()) if len(one.runs) == len(finished) else one for one in found]


def of_logs(rows: Sequence[Row], covered: Iterable[str]) -> List[Finding]:
    """What LAMMPS and its styles warned of; covered: kinds of lines that other findings cover."""
    return gathered((Finding("LAMMPS", {"line": line}, name_row(row)) for row in rows
                     for line in row.log_warnings if kind(line) not in covered), len(rows),
                    lambda finding: kind(finding.numbers["line"]))


def limits(study: Optional[study_types.Study], repeats: bool) -> List[Finding]:
    """What no run of a study, or a run alone, can tell; repeats: whether runs were repeated."""
    sampled = study.ensemble if study else None
    found = [] if repeats or sampled else [Finding("no repeats")]
    if not (study and study.size):
        found.append(Finding("no sizes"))
    return [*found, Finding("slip assumed")]
