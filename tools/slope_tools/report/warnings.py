"""The findings of a report: all of them, those of the list in the appendix, and those of the first page."""
from typing import List, Sequence, Tuple

from ..deposits.volume import MUCH_BELOW
from ..finding_words import WORDS, words_of
from ..findings import LIMIT, WARNING, Finding, gathered
from ..statistics import rounding
from ..tables import ensemble_types, judged
from . import structures_part
from .data import Data

MOST = 3                # on the first page
BESIDE_MAPS = "no CRS"  # the page says so there
LARGE = "large"         # known events that weigh the runs make up for it
WEIGHT = {kind: place for place, kind in enumerate(WORDS)}


def findings(data: Data, ground) -> List[Finding]:
    """All of a data.Data on its ground.Ground."""
    study = data.study
    of_runs = study.warnings if study else judged.of_runs(data.judged)
    several_findings = [*of_runs, *below_ground(data), *judged.limits(study, bool(data.repeats)),
                        *structures_part.coarse_walls(data, ground)[:1]]
    if study:
        ensemble, volume = study.ensemble, study.conservative
        known_events = ensemble.known_events if ensemble else None
        for part, doubts in (("The volume to remove", volume.doubts if volume else []),
                             ("The ensemble", ensemble.doubts if ensemble else []),
                             ("The known events", known_events.doubts if known_events else [])):
            several_findings += [one._replace(part=part) for one in doubts]
    kinds = {one.kind for one in of_runs if not one.part}
    covered = [line for line, those in (("removed", ("bulk factor", "body volume", "balls removed")),
                                        ("lost", ("lost", "lost much"))) if kinds.intersection(those)]
    beside = {BESIDE_MAPS, LARGE if study and ensemble_types.weighted(study.ensemble) else None}
    return [one for one in (*several_findings, *judged.of_logs(data.judged, covered)) if one.kind not in beside]


def rank_warnings(findings_: Sequence[Finding], names) -> List[Tuple[str, str]]:
    """(level, text) of those that are warnings, the most serious first; names: of the runs, by their folders."""
    return sorted(((one.level, one.shown(names)) for one in findings_ if one.level != LIMIT),
                  key=lambda entry: entry[0] != WARNING)


def first_page(findings_: Sequence[Finding]) -> List[str]:
    """What a client must know beside the number: a line for each kind of doubt, counted, the weightiest first."""
    mine = sorted((one for one in findings_ if words_of(one.kind).client and not one.part),
                  key=lambda finding: WEIGHT[finding.kind])
    return [one.client()
            for one in gathered(mine, alike=lambda finding: words_of(finding.kind).client)]


def rest_of(warnings: int) -> str:
    """What the first page says of all others."""
    first = f"The appendix has {'both warnings' if warnings == 2 else f'all {warnings} warnings'}, the" \
        if warnings > 1 else "The appendix has the warning, the" if warnings else \
        "The programs gave no warnings. The appendix has the"
    return f"{first} settings, the runs and the checks."


def below_ground(data: Data) -> List[Finding]:
    """A cut surface flatter than the hillside: much of the volume lies where that surface is below the ground."""
    below, share = data.below_ground() or (0, 0)
    if share <= MUCH_BELOW:
        return []
    known = rounding.nearest(below, rounding.place_of_digits(below))
    return [Finding("cut below ground", {"percent": 100 * share, "volume": known, "run": data.label(data.result),
                                         "angle": data.of_study.study.the_road["cut_angle"]})]
