"""The number of the first page, from the headline of study.yaml (statistics.answer), in a client's words.

Never only "unknown": a number, a floor, or a share of the known events; why; and the next step, with its command and
how long it takes.
"""
from pathlib import Path
from shlex import quote
from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Tuple

from .. import digits
from ..mobility import events
from ..mobility.results import percent
from ..sites import site_choices
from ..sites.site_budget import duration_text
from ..statistics.answer import Code, Kind, Source
from ..statistics.withheld import Kind as Rule
from ..tables.withheld_words import FINER

REMOVE = "Volume to remove from the road"
WHO = "known events of this volume and height"
MORE = 2            # times the runs, where more are needed
RULES = {
    Rule.BALLS: "fewer than ten of the model's balls come to lie on the road, which are single blocks and no volume",
    Rule.MOBILITY: f"no run goes as far as half of {WHO}",
    Rule.LEFT: "a part of the mass left the elevation model before it came to the road, and is not counted",
    Rule.RUNS: "more than a tenth of the runs failed, or had not come to rest when they ended",
    Rule.SIZE: "the runs do not tell what smaller balls in the model would change"}


class Step(NamedTuple):
    """What to do next; seconds: of computing; None: not known."""
    text: str
    command: str
    seconds: Optional[float]

    @property
    def time(self) -> str:
        return "" if self.seconds is None else f", about {duration_text(self.seconds)} of computing on this machine"


def of_study(data, numbers) -> Optional[Dict[str, Any]]:
    """What the template takes; None without a headline, and where the paper's study says all, with its parts."""
    about = (data.study or {}).get("headline")      # none in older files
    if not about or not about["ensemble"]:
        return None
    kind = Kind(about["kind"])
    if kind is Kind.NUMBER and about["source"] == Source.PAPER.value:
        return None
    found = {Kind.NUMBER: number, Kind.FLOOR: floor, Kind.WITHHELD: withheld, Kind.NOTHING: nothing}[kind](
        about, numbers)
    step = next_step(data, about) if kind in (Kind.FLOOR, Kind.WITHHELD) else None
    return {"kind": kind.value, "reasons": reasons(about), "step": step, **found}


# --- what stands in the place of the number ---

def number(about: Mapping[str, Any], numbers) -> Dict[str, Any]:
    share = percent(about["share"])
    return {"title": f"{REMOVE}: {share} of known events stay within", "unit": "m3",
            "number": numbers(f"{REMOVE.lower()}, {share} of known events", "m3", about["volume_m3"]),
            "band": bounds(about, numbers) + of_paper(about, numbers)}


def bounds(about: Mapping[str, Any], numbers) -> str:
    """Its bounds, each with its unit."""
    low, high = (None if about[key] is None else numbers(f"{REMOVE.lower()}, {name} bound", "m3", about[key])
                 for key, name in (("low_m3", "lower"), ("high_m3", "upper")))
    if low is None and high is None:
        return "No bounds: the runs are too few for them."
    if high is None:
        return f"At least {low} m3 with 90 % confidence; an upper bound would need more runs."
    return f"Between {low or 0} m3 and {high} m3, with 90 % confidence."


def of_paper(about: Mapping[str, Any], numbers) -> str:
    """The conservative volume of the other study, where it has one and does not govern."""
    volume = (about["paper"] or {}).get("volume_m3")
    if volume is None or about["source"] != Source.ENSEMBLE.value:
        return ""
    return (" A study that takes the largest of few settings, without known events, gives "
            f"{numbers('conservative volume', 'm3', volume)} m3.")


def floor(about: Mapping[str, Any], numbers) -> Dict[str, Any]:
    """At least so much; where no run reaches the road, how many known events do."""
    if not about["volume_m3"]:
        return not_reached(about)
    text = numbers(f"{REMOVE.lower()}, at least", "m3", about["volume_m3"])
    share = about["share"]
    if share:
        band = (f"{percent(share)} of {WHO} stay within {text} m3; the others bring more, how much these runs do not "
                "show.")
    elif about["source"] == Source.PAPER.value:
        band = ("A further run of the governing settings stays below, in 97.5 % of such studies; more mobile masses "
                "may bring more.")
    else:
        band = ""
    title = f"{REMOVE}, with {percent(share)}" if share else REMOVE
    return {"title": title, "number": f"at least {text}", "unit": "m3", "band": band + of_paper(about, numbers)}


def not_reached(about: Mapping[str, Any]) -> Dict[str, Any]:
    road = about["road"]
    if not road:
        return {"title": REMOVE, "number": "more than 0", "unit": "m3", "band": ""}
    return {"title": "No run reaches the road, but known events do", "number": span(road["reached"]),
            "unit": "of known events reach it",
            "band": "More than 0 m3 is to be removed then; how much, these runs do not show."}


def withheld(about: Mapping[str, Any], numbers) -> Dict[str, Any]:
    del about, numbers
    return {"title": f"{REMOVE}: not usable", "number": None, "unit": "", "band": ""}


def nothing(about: Mapping[str, Any], numbers) -> Dict[str, Any]:
    road = about["road"]
    band = f"{span(road['reached'])} of {WHO} reach the road." if road else \
        "No known events can be compared with this mass."
    return {"title": REMOVE, "number": numbers(REMOVE.lower(), "m3", 0.0), "unit": "m3",
            "band": f"Nothing comes to lie on the road in any run. {band}"}


def span(shares) -> str:
    """Shares by the smaller and the larger scatter, as one text."""
    return " to ".join(dict.fromkeys(map(percent, shares)))


# --- why ---

def reasons(about: Mapping[str, Any]) -> List[str]:
    """A sentence each, without its full stop; the one that decides comes first."""
    return [text for one in about["reasons"] if (text := reason(Code(one["code"]), one["numbers"]))]


def reason(code: Code, of: Mapping[str, Any]) -> str:
    if code is Code.BEYOND:
        return (f"{percent(of['far'])} of {WHO} go farther than the longest run, which ends after "
                f"{metres(of['longest_m'])}")
    if code is Code.NOT_REACHED:
        ends = "no run leaves a deposit" if of["longest_m"] is None else \
            f"the longest run ends after {metres(of['longest_m'])}"
        return f"the road begins after {metres(of['near_m'])} along the fall path, and {ends}"
    if code is Code.ONE_SCATTER:
        return (f"{span((of['low'], of['high']))} of them reach the road, as their scatter is taken: only the larger "
                "of two estimates says more than 10 %")
    if code is Code.TERRAIN:
        return (f"the elevation model ends after {metres(of['path_m'])} along the fall path, where "
                f"{percent(of['share'])} of known events go on")
    if code is Code.RANGE:
        return "no values within the ranges that were tried are expected to go farther"
    if code is Code.RUNS:
        return f"{of['points']:g} runs were added towards longer ones, and no more"
    if code is Code.FEW:
        return "the runs are too few to tell which settings go farther"
    text = RULES[Rule(of["rule"])]
    return text if of["source"] == Source.PAPER.value else f"{text} (runs weighted by known events)"


def metres(value: float) -> str:
    return f"{digits.rounded(value, 3)} m"


# --- the next step ---

def next_step(data, about: Mapping[str, Any]) -> Optional[Step]:
    """What makes a number of it: by the first reason that something can be done about."""
    found = [step for one in about["reasons"] if (step := step_of(data, Code(one["code"]), one["numbers"]))]
    return found[0] if found else more_runs(data)


def step_of(data, code: Code, of: Mapping[str, Any]) -> Optional[Step]:
    if code is Code.TERRAIN:
        return Step(*larger_terrain(data), seconds(data))
    if code in (Code.RUNS, Code.FEW):
        return more_runs(data)
    if code is Code.RANGE:
        return Step("runs with less resistance than the least that was tried", ensemble(data, wider=True),
                    seconds(data))
    if code is not Code.RULE:
        return None
    rule = Rule(of["rule"])
    if rule is Rule.LEFT:
        return Step(*larger_terrain(data), seconds(data))
    mine = next((one for one in entries(data) if one["kind"] == rule.value), None)
    words = {Rule.BALLS: "smaller balls in the model", Rule.SIZE: "smaller balls in the model",
             Rule.RUNS: "more time for the mass to come to rest", Rule.MOBILITY: "runs with less resistance"}
    return Step(words[rule], mine["remedy"], times(data, rule, of)) if mine else None


def first_remedy(data) -> Optional[Step]:
    """Of a study whose number is withheld: what mends the first of its reasons."""
    found = [step_of(data, Code.RULE, {**one, "rule": one["kind"]}) for one in entries(data)]
    return found[0] if found else None


def entries(data) -> List[Mapping[str, Any]]:
    """Why the numbers of this study are withheld, as study.yaml has it."""
    study = data.study
    return [*((study["conservative"] or {}).get("withheld") or ()), *((study["ensemble"] or {}).get("withheld") or ())]


def times(data, rule: Rule, of: Mapping[str, Any]) -> Optional[float]:
    """Seconds of the study once more: steps are in proportion to the balls' diameter."""
    whole = seconds(data)
    factor = {Rule.RUNS: 2.0, Rule.SIZE: FINER ** (4 / 3)}.get(rule, 1.0)
    if rule is Rule.BALLS:
        factor = (of["bound"] / max(of["number"] or 0.0, 1.0)) ** (4 / 3) if of["bound"] else 1.0
    return None if whole is None else factor * whole


def seconds(data) -> Optional[float]:
    """How long all runs of this study took, as many at a time as they were."""
    walls = [row.get("wall_s") for row in data.finished]
    return None if None in walls or not walls else sum(walls) / max(1, data.study["study"].get("jobs") or 1)


def more_runs(data) -> Optional[Step]:
    if not data.study["ensemble"]:
        return None
    whole = seconds(data)
    return Step("more runs", ensemble(data, MORE), None if whole is None else (MORE - 1) * whole)


def site_of(data) -> Optional[Path]:
    """The site's folder, if the study is one of a site."""
    folder = data.folder.parent
    return folder if (folder / site_choices.NAME).is_file() else None


def larger_terrain(data) -> Tuple[str, str]:
    site = site_of(data)
    if site is None:
        return ("a larger elevation model, and the box of the deck with it",
                f"tools/slope study {quote(str(data.study['study']['deck']))} ... --anew")
    return (f"a larger elevation model (terrain of {site / site_choices.NAME})",
            f"tools/slope site {quote(str(site))} && tools/slope study {quote(str(site))} --anew")


def ensemble(data, factor: int = 1, wider: bool = False) -> str:
    """The command of an ensemble like this one: more points, or wider ranges of what resists."""
    design = (data.study["ensemble"] or {}).get("design") or {}
    known = ((data.study["ensemble"] or {}).get("known_events") or {}).get("set")
    site = site_of(data)
    where = quote(str(site)) if site else f"{quote(str(data.study['study']['deck']))} -o {quote(str(data.folder))}"
    words = [f"tools/slope study {where} --sample {factor * int(design.get('points') or 64)}"]
    words += [f"--known {events.OWN.stem if known == events.OWN.name else quote(str(known))}"] if known else []
    for name, text in design.get("variables", {}).items():
        words.append(f"--vary {quote(f'{name}={widened(text) if wider else text}')}")
    return " ".join(words)


def widened(text: str) -> str:
    """A range with half its least value."""
    low, colon, high = text.removeprefix("uniform:").partition(":")
    try:
        return f"{float(low) / 2:g}:{float(high):g}" if colon else text
    except ValueError:
        return text
