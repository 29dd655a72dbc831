"""The warnings of a report: one line for each kind, with the runs concerned."""
import re
from typing import Any, Dict

from ..deposits.travel_shares import BEYOND
from ..deposits.volume import MUCH_BELOW
from ..digits import rounded, to_three
from ..sites.site_warnings import LARGE
from ..statistics import headline

SMALL = 1e-6            # of the released volume
NAMED = 4               # runs that a line names
NUMBER = re.compile(r"\d[\d.,]*(?:[eE][+-]?\d+)?")
# what the page says in its own words here, or beside the maps: about single runs, and about all of them
SAID_OF_RUNS = ("failed: ", "still moves", "left the grid or the box", "has no CRS")
SAID_OF_ALL = re.compile(r"\d+ of \d+ deposits are not at rest at the end|.*has no CRS")
OF_SIZES = re.compile(r"sizes of balls: \S+?: (.*)")     # of one of the runs with balls of several sizes
LEFT = "left the box"     # in the lines of fix deposit/grid
SAID_TOO = re.compile(r"runs failed$|deposits are not at rest$")
RED, AMBER = "red", "amber"


def warnings(data):
    """(red or amber, text) of a data.Data, the most serious first."""
    found = failures(data)
    found += not_at_rest(data)
    found += (gone := lost(data))
    found += releases(data)
    found += below_ground(data)
    found += large(data)
    if data.study:
        for text in (data.study["conservative"] or {}).get("doubts") or ():
            if not SAID_TOO.search(text):
                found.append((AMBER, f"The volume to remove: {text}"))
        ensemble = data.study.get("ensemble") or {}
        for what, about in (("ensemble", ensemble), ("known events", ensemble.get("known_events") or {})):
            found += [(AMBER, f"The {what}: {text}") for text in about.get("doubts") or ()]
        found += of_study(data)
    found += from_logs(data, any("released mass" in text for _, text in found), bool(gone))
    return sorted(found, key=lambda one: one[0] != RED)


def of_study(data):
    """The warnings of study.yaml: those of the study as a whole, each in red, and those of single runs."""
    names = {row["run"]: data.label_of(row) for row in data.rows}
    whole, entries = [], []
    for text in map(str, data.study.get("warnings") or ()):
        who, colon, rest = text.partition(": ")
        runs = who.split(", ")
        if not (colon and all(run in names for run in runs)):
            whole += [] if SAID_OF_ALL.match(text) else [text]
        elif not any(said in rest for said in SAID_OF_RUNS):
            entries += [(rest, names[run]) for run in runs]
    return [*((RED, text) for text in of_sizes(whole)), *by_kind(entries, len(data.finished))]


def of_sizes(texts):
    """The same lines, but one for each kind of those on the single runs with balls of several sizes."""
    found: Dict[str, Any] = {}
    for text in texts:
        match = OF_SIZES.fullmatch(text)
        kind = NUMBER.sub("#", match[1]) if match else text
        found.setdefault(kind, []).append(match[1] if match else text)
    return [f"sizes of balls: {mine[0]} ({plural(len(mine), 'run')}, other numbers in the others)"
            if len(mine) > 1 and kind not in texts else f"sizes of balls: {mine[0]}" if kind not in texts else mine[0]
            for kind, mine in found.items()]


def failures(data):
    """Runs that failed, by their error."""
    failed = [(str(row.get("error")), data.label_of(row)) for row in data.rows if row["status"] != "finished"]
    return [(RED, f"{plural(len(names), 'run')} failed: {text}" + of_runs(names, None))
            for text, names in kinds(failed).values()]


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
    entries = [(release.doubt, name) for name, release in data.releases() if release.doubt]
    return by_kind(entries, len(data.finished))


def large(data):
    """A mass whose run-out the defaults underestimate."""
    volume = data.largest_release()
    if volume < LARGE:
        return []
    return [(AMBER, f"The run-out: {volume / 1e6:,.3g} million m3 are released, and such masses are known to run "
                    "farther than laboratory friction suggests. With the default parameters the run-out is not "
                    "conservative; calibrate them with a past event (page on events of the documentation).")]


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


def from_logs(data, released, gone):
    """The warnings of LAMMPS and its styles; released, gone: whether other lines cover released and lost mass."""
    entries = []
    if data.study:
        for row in data.rows:
            entries += [(f"LAMMPS: {text}", data.label_of(row)) for text in row.get("log_warnings") or ()]
    else:
        entries = [(f"LAMMPS: {text}", None) for text in data.result.log.warnings]
    entries = [(text, name) for text, name in entries
               if not (released and text.startswith("LAMMPS: Delete_balls") or gone and LEFT in text)]
    return by_kind(entries, len(data.rows))


# --- kinds ---

def kinds(entries):
    """{kind: (its first text, names of its runs)} of (text, name or None); texts that differ only in numbers are of one
    kind.
    """
    found: Dict[str, Any] = {}
    for text, name in entries:
        found.setdefault(NUMBER.sub("#", text), (text, []))[1].append(name)
    return found


def by_kind(entries, runs):
    """A line for each kind; runs: how many there are."""
    texts: Dict[str, Any] = {}
    for text, _ in entries:
        texts.setdefault(NUMBER.sub("#", text), set()).add(text)
    found = []
    for kind, (text, names) in kinds(entries).items():
        several = len(texts[kind]) > 1
        known = list(dict.fromkeys(name for name in names if name is not None))
        if known:
            text += of_runs(known, runs, "; other numbers in some" if several else "")
        elif len(names) > 1:
            text += f" ({len(names)} times, with other numbers)" if several else f" ({len(names)} times)"
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
