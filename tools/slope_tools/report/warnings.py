"""The warnings of a report: one line for each kind, with the runs concerned."""
from typing import Any, Dict

from ..case.logs import kind
from ..deposits.travel_shares import BEYOND
from ..deposits.volume import MUCH_BELOW
from ..digits import rounded, to_three
from ..sites.site_warnings import LARGE
from ..statistics import headline
from ..warned import OTHER

SMALL = 1e-6            # of the released volume
NAMED = 4               # runs that a line names
# kinds of warnings of a study that the page says in its own words here; of all its parts, too: beside the maps
SAID, BESIDE = ("failed", "moving", "lost", "large"), "no CRS"
RED, AMBER = "red", "amber"


def warnings(data):
    """(red or amber, text) of a data.Data, the most serious first."""
    found = failures(data)
    found += not_at_rest(data)
    found += (gone := lost(data))
    found += (doubtful := releases(data))
    found += below_ground(data)
    found += large(data)
    if data.study:
        for text in (data.study["conservative"] or {}).get("doubts") or ():
            found.append((AMBER, f"The volume to remove: {text}"))
        ensemble = data.study.get("ensemble") or {}
        for what, about in (("ensemble", ensemble), ("known events", ensemble.get("known_events") or {})):
            found += [(AMBER, f"The {what}: {text}") for text in about.get("doubts") or ()]
        found += of_study(data)
    found += from_logs(data, ["removed"] * bool(doubtful) + ["lost"] * bool(gone))
    return sorted(found, key=lambda one: one[0] != RED)


def of_study(data):
    """The warnings of study.yaml: those of the study and of its parts, each kind in red, and those of runs."""
    names = {row["run"]: data.label_of(row) for row in data.rows}
    whole: Dict[Any, Any] = {}
    entries = []
    for one in data.warnings():
        if one.kind == BESIDE:
            continue
        if one.part or not one.runs:
            if one.part or one.kind not in SAID:
                whole.setdefault((one.part, one.kind, one.text if one.kind == OTHER else None), []).append(one)
        elif one.kind not in SAID:
            entries += [(one.text, one.text if one.kind == OTHER else one.kind, names.get(run, run))
                        for run in one.runs]
    return [*((RED, mine[0].text + (f" ({plural(len(mine), 'run')}, other numbers in the others)"
                                    if len(mine) > 1 else "")) for mine in whole.values()),
            *by_kind(entries, len(data.finished))]


def failures(data):
    """Runs that failed, by their error."""
    failed = [(text := str(row.get("error")), kind(text), data.label_of(row))
              for row in data.rows if row["status"] != "finished"]
    return [(RED, f"{plural(len(names), 'run')} failed: {texts[0]}" + of_runs(names, None))
            for texts, names in kinds(failed)]


def not_at_rest(data):
    """Deposits that move when their runs end, or whose runs reached their time limit."""
    found, ends = [], data.ends()
    for level, moving, note in ((RED, True, " More than 10 % of the volume is in motion: these numbers are not those "
                                            "of a deposit."), (AMBER, False, "")):
        mine = [end for end in ends if not end.at_rest and end.moving == moving]
        if not mine:
            continue
        worst = max(mine, key=lambda end: end.share)
        moment = f"{worst.text}, at {worst.time:.1f} s."
        if not data.study:
            found.append((level, f"The deposit is not at rest: {moment}{note}"))
            continue
        cut = sum(end.cut for end in mine)
        who = f"{len(mine)} of {plural(len(ends), 'deposit')} not at rest at the end"
        who += f", {cut} of them stopped at their duration" if cut and len(mine) > 1 else ""
        found.append((level, f"{who}{of_runs([end.name for end in mine], None) if len(mine) < len(ends) else ''}: "
                             f"{'most moves in ' * (len(mine) > 1)}{worst.name}: {moment}{note}"))
    return found


def lost(data):
    """Mass that is not on the maps."""
    rows = [(row["off_grid_m3"] + row["lost_m3"], row["released_m3"], data.label_of(row)) for row in data.finished]
    if not data.study:
        volume = data.result.summary["volume"]
        rows = [(volume["off_grid"] + volume["lost"], volume["released"], None)]
    gone = [row for row in rows if row[0] > SMALL * row[1]]
    if not gone:
        return []
    left, released, _ = max(gone)
    text = (f"{'up to ' * (len(gone) > 1)}{rounded(to_three(left))} m3 ({100 * left / released:.2g} % of the released "
            "volume) left the grid or the box and are not on the maps")
    many = any(volume > BEYOND * whole for volume, whole, _ in gone)
    if many:
        text += ", and how far they went is unknown: enlarge the terrain and the box"
    return [(RED if many else AMBER, text + of_runs([name for *_, name in gone], len(rows)) if data.study else text)]


def releases(data):
    """Reasons why the released mass may not be the body."""
    entries = [(release.doubt, kind(release.doubt), name) for name, release in data.releases() if release.doubt]
    return by_kind(entries, len(data.finished))


def large(data):
    """A mass whose run-out the defaults underestimate."""
    volume = data.largest_release()
    if volume < LARGE:
        return []
    return [(AMBER, f"The run-out: {volume / 1e6:,.3g} million m3 are released, and such masses are known to run "
                    "farther than laboratory friction suggests. The run-out is not conservative unless the friction "
                    "was calibrated with a past event of that size (page on events of the documentation).")]


def below_ground(data):
    """A cut surface flatter than the hillside: much of the volume lies where that surface is below the ground."""
    below, share = data.below_ground() or (0, 0)
    if share <= MUCH_BELOW:
        return []
    volume = headline.text(below, headline.place_of_digits(below))
    angle = data.study["study"]["road"]["cut_angle"]
    return [(AMBER, f"The volume to remove: {100 * share:.0f} % of it ({volume} m3 in the run "
                    f"{data.label(data.result)}) lies where the cut surface is below the ground before the collapse. "
                    f"The hillside is about as steep as the cut of {angle:g} degrees there, or steeper, so that all of "
                    "the deposit on it is counted; a steeper cut angle gives less.")]


def from_logs(data, said):
    """The warnings of LAMMPS and its styles; said: kinds that other lines cover."""
    lines = [(line, data.label_of(row)) for row in data.rows for line in row.get("log_warnings") or ()] \
        if data.study else [(line, None) for line in data.result.log.warnings]
    return by_kind([(f"LAMMPS: {line}", kind(line), name) for line, name in lines if kind(line) not in said],
                   len(data.rows))


# --- kinds ---

def kinds(entries):
    """(their different texts, names of their runs) of each kind, of (text, kind, name or None)."""
    found: Dict[str, Any] = {}
    for text, one, name in entries:
        texts, names = found.setdefault(one, ([], []))
        texts += [text] * (text not in texts)
        names.append(name)
    return found.values()


def by_kind(entries, runs):
    """A line for each kind; runs: how many there are."""
    found = []
    for (text, *others), names in kinds(entries):
        known = list(dict.fromkeys(name for name in names if name is not None))
        if known:
            text += of_runs(known, runs, "; other numbers in some" if others else "")
        elif len(names) > 1:
            text += f" ({len(names)} times, with other numbers)" if others else f" ({len(names)} times)"
        found.append((AMBER, text))
    return found


def of_runs(names, runs, more=""):
    """Which runs, in brackets; runs: how many there are, None if the number stands before."""
    if runs is not None and len(names) == runs:
        return f" (all {runs} runs{more})" if runs > 1 else ""
    named = "; ".join(names[:NAMED]) + (f"; and {len(names) - NAMED} more" if len(names) > NAMED else "")
    count = "" if runs is None else f"{len(names)} of {plural(runs, 'run')}: "
    return f" ({count}{named}{more})"


def plural(number, what):
    return f"{number} {what}{'s' * (number != 1)}"
