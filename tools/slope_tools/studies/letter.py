"""What an engineer writes into a letter, as typed parts: page 1 begins with it and the console ends with it. Words:
letter_words."""
from typing import NamedTuple, Optional, Sequence

from ..mobility.how_far import Reach
from ..statistics.entries import Headline
from ..tables import ensemble_types, judged, sizes, study_types
from ..tables.rows import finished_of
from .road_numbers import Number, read_road_numbers


class Letter(NamedTuple):
    """Volumes in m3 of ground, lengths in m along the fall path.

    released: what comes down; number: what must be cleared, None without a road; gap: of it, see entries.KnownQuantile;
    cut: degrees, of the road's edges, above which is removed; events: how many known events weigh the runs, None: none;
    reach: how far; roads: of a site with several, the worst first; lacks: kinds of findings, of what is not in it;
    size: what the size of the balls would change, a sentence without its full stop.
    """
    released: float
    number: Optional[Headline]
    gap: Optional[Sequence[float]]
    reach: Optional[Reach]
    roads: Sequence[Number]
    lacks: Sequence[str]
    size: str
    cut: Optional[float] = None
    events: Optional[int] = None


def of_study(study: study_types.Study) -> Letter:
    """Of a study with a finished run."""
    rows, number = finished_of(study.runs), study.headline
    known = ensemble_types.weighted(study.ensemble)
    gap = next((one.gap for one in known.to_remove or () if one.share == number.share), None) \
        if known and number and number.source == "ensemble" else None
    return Letter(max((row.released_m3 for row in rows), default=0.0), number, gap, study.reach,
                  read_road_numbers(study), [one.kind for one in judged.limits(study, bool(study.study.repeat))],
                  study.size.text if study.size else sizes.alone(max(
                      (row.released_m3 / row.ball_m3 for row in rows), default=0.0)),
                  study.study.road["cut_angle"] if study.study.road else None, known.events if known else None)
