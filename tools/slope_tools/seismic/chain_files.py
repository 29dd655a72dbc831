"""The chain of a study: what `slope fragility` wrote, its bodies as a variable of the runs, and what they say together.

The mathematics are in chain.py; here are the checks, the tables, the entry of study.yaml and its words.
"""
import math
from dataclasses import replace
from pathlib import Path
from typing import Any, Dict, Iterable, List, Mapping, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from .. import disk
from ..digits import percent
from ..errors import SlopeError
from ..findings import Finding, finding, texts
from ..sites.site_bodies import VARIABLE
from ..sites.site_found import SlipBody
from ..statistics import ball_sizes, hazard
from ..tables import intensity, study_types
from ..tables.rows import Row, finished_of
from ..tables.sizes import VARIABLE as SIZE
from . import chain
from .fragility import BEYOND, Frequency
from .fragility_files import Fragility

CURVES, PER_YEAR = "chain.csv", "chain_per_year.csv"
QUANTITY = intensity.QUANTITY
LEVELS = 41             # volumes of the curves, beside those that are asked for


class Chain(NamedTuple):
    """What is asked of the runs of a study."""
    fragility: Fragility
    weights: Dict[str, float]       # {body: how likely it fails, given that one does}
    volumes: Dict[str, float]       # {body: m3}
    more_than: Sequence[float]      # m3; none: three round ones


# --- before the runs ---

def check_chain(fragility: Fragility, here: Mapping[str, SlipBody], site: Path, more_than: Sequence[float]) -> Chain:
    """The Chain of a site whose bodies (site.yaml: found) are those of a fragility; SlopeError if they are not."""
    if not here:
        raise SlopeError("--fragility", "needs a site with bodies of slope stability, which slope site --slips makes",
                         site)
    share = chain.weights(fragility.capacity, fragility.peaks, fragility.rate)
    weights = {name: float(one) for name, one in zip(fragility.bodies, share) if one > 0}
    if not weights:
        raise SlopeError("--fragility", "must have a body that fails at one of its peaks", fragility.folder)
    for name, digest in zip(fragility.bodies, fragility.bases):
        if name in weights and name not in here:
            raise SlopeError("--fragility", f"must be of the bodies of {site}, {', '.join(here)}: body {name} may "
                             "fail, too; slope site --slips without --body has all of them", fragility.folder)
        if name in here and here[name].base_sha256 != digest:
            raise SlopeError("--fragility", f"must be of the bodies of {site}: body {name} is another one there",
                             fragility.folder)
    for name in here:
        if name not in fragility.bodies:
            raise SlopeError("--fragility", f"must have all bodies of {site}, but has no body {name}", fragility.folder)
    return Chain(fragility, weights, {name: float(here[name].volume_m3) for name in weights}, more_than)


def options(asked: Chain) -> Tuple[List[str], List[str]]:
    """The bodies as values of a variable of the study: of --set if one alone may fail, else of --vary."""
    if len(asked.weights) == 1:
        return [f"{VARIABLE}={next(iter(asked.weights))}"], []
    return [], [f"{VARIABLE}=list:" + ",".join(f"{name}@{one:.6f}" for name, one in asked.weights.items())]


# --- after them ---

def list_left_volumes(asked: Chain, rows: Sequence[Row], finer: Optional[ball_sizes.Left]) -> List[chain.Left]:
    """What each body leaves on the road; of those that never fail nothing. The bounds have those of runs at the finest
    size, and what finer balls would change."""
    volumes = []
    for name in asked.fragility.bodies:
        if name not in asked.weights:
            volumes.append(chain.compute_left_volume([0.0], [0], 0.0))
            continue
        mine = [row for row in rows if row.set[VARIABLE] == name]
        done = finished_of(mine)
        point = [tuple(row.set.values()) for row in done]
        known = {one: k for k, one in enumerate(dict.fromkeys(point))}
        on_road = [row.at_road.remove_on_road_m3 for row in done]
        bands = [(row.bands or {}).get(QUANTITY, (volume, volume)) for row, volume in zip(done, on_road)]
        value, low, high = (chain.compute_left_volume(
            volumes_, [known[one] for one in point], asked.volumes[name], len(mine) - len(done))
            for volumes_ in (on_road, [low for low, _ in bands], [high for _, high in bands]))
        change = (finer.low, finer.high) if finer else (0.0, 0.0)
        volumes.append(chain.Left(value.value, *(
            one._replace(volumes=np.minimum((1 + by) * one.volumes, max(asked.volumes[name], one.volumes.max())))
            for one, by in zip((low.low, high.high), change))))
    return volumes


class Evaluated(NamedTuple):
    """about: the entry of study.yaml; tables: {name of a file: its text}."""
    about: study_types.Chain
    tables: Dict[str, str]


def evaluate_chain(asked: Chain, rows: Sequence[Row], withheld: Sequence[Finding],
                   finer: Optional[ball_sizes.Left]) -> Evaluated:
    """What the runs say; rows: of study.csv; withheld: why their volumes may not be used; finer: what finer balls would
    change of a volume on the road, None: not known."""
    fragility, bodies = asked.fragility, list_left_volumes(asked, rows, finer)
    seen = [row.at_road.remove_on_road_m3 for row in finished_of(rows)]
    more_than = list(asked.more_than) or intensity.round_volumes(max(seen)) or [0.0]
    largest = sum(float(one.value.volumes[1:].max(initial=0.0)) for one in bodies)
    volumes = np.unique([*np.linspace(0.0, max(largest, 1.0), LEVELS), *more_than])
    at = np.searchsorted(volumes, more_than)
    family = chain.family(fragility.capacity, fragility.peaks, bodies, volumes)
    tables = {CURVES: format_chain_table(
        ("peak_gal", "volume_m3", "probability", "low", "high"),
        ((peak, volume, *(side[i, k] for side in family)) for i, peak in enumerate(fragility.peaks)
         for k, volume in enumerate(volumes)))}
    curves = [study_types.ChainCurve(volume, *(side[:, k].tolist() for side in family))
              for volume, k in zip(more_than, at)]
    per_year = None
    if fragility.rate is not None:
        yearly = chain.frequency(fragility.capacity, fragility.rate, fragility.peaks, bodies, volumes)
        tables[PER_YEAR] = format_chain_table(("volume_m3", "per_year", "low", "high"), zip(volumes, *yearly.total))
        per_year = [of_year(yearly, volume, k) for volume, k in zip(more_than, at)]
    entry = study_types.Chain(
        fragility.folder.name, QUANTITY, hazard.CONFIDENCE, [summarise_chain_body(asked, name, rows) for name
                                                             in fragility.bodies],
        more_than, fragility.peaks.tolist(), curves, per_year, list(withheld), list(tables), [])
    coarse = [Finding("body size", {"body": name}) for name in bodies_without_finer(rows)] if finer else \
        [Finding("chain size")]
    return Evaluated(replace(entry, doubts=[*find_chain_caveats(entry, fragility.warnings), *coarse]), tables)


def bodies_without_finer(rows: Sequence[Row]) -> List[str]:
    """Of which no run has the finest balls, so that theirs are corrected by what other bodies tell."""
    done = finished_of(rows)
    sizes = {row.run: float(row.variables[SIZE]) for row in done if SIZE in row.variables}
    with_finest = {row.set[VARIABLE] for row in done if sizes.get(row.run, 0.0) == min(sizes.values(), default=0.0)}
    return sorted({row.set[VARIABLE] for row in done} - with_finest)


def summarise_chain_body(asked: Chain, name: str, rows: Sequence[Row]) -> study_types.ChainBody:
    """What study.yaml says of a body."""
    mine = [row for row in rows if row.set[VARIABLE] == name]
    return study_types.ChainBody(name, asked.weights.get(name, 0.0), asked.volumes.get(name), len(mine),
                                 len(finished_of(mine)))


def of_year(yearly: Frequency, volume: float, k: int) -> study_types.PerYear:
    """What study.yaml says of how often a volume is exceeded, the k-th."""
    total = yearly.total
    return study_types.PerYear(
        volume, float(total.value[k]), float(total.low[k]), float(total.high[k]), float(yearly.beyond[k]),
        [{"from_gal": a, "to_gal": None if math.isinf(b) else b, "per_year": float(part[k])}
         for a, b, part in yearly.parts])


def find_chain_caveats(chain_: study_types.Chain, warnings: Sequence[Any]) -> List[Finding]:
    """The caveats; warnings: of the fragility."""
    return [*(finding(one)._replace(part="fragility") for one in warnings),
            *(Finding("body without run" if one.weight > chain.LEAST else "body beyond the curve",
                      {"body": one.body, "volume": one.volume_m3})
              for one in chain_.bodies if one.weight > 0 and not one.finished),
            *(Finding("more per year", {"per_year": one.more_at_most, "volume": one.more_than_m3})
              for one in chain_.per_year or () if is_more(one))]


def format_chain_table(head: Sequence[str], rows: Iterable[Sequence[float]]) -> str:
    return disk.csv_text(head, ([f"{value:.6g}" for value in row] for row in rows))


# --- words ---

def sentences(chain_: study_types.Chain) -> List[str]:
    """How often, or at which peaks, the road is blocked by more than each of the volumes."""
    sure = f"{100 * chain_.confidence:g} %"
    if chain_.per_year:
        before = any(finding(one).kind == "before the curve" for one in chain_.doubts)
        return [f"the road is blocked by more than {one.more_than_m3:,.6g} m3 with " +
                describe_yearly(one, sure, before) for one in chain_.per_year]
    words = []
    for one in chain_.curves:
        k = int(np.argmin(np.abs(np.array(one.probability) - 0.5)))
        low, value, high = (percent(side[k]) for side in (one.low, one.probability, one.high))
        words.append(f"an earthquake of {chain_.peaks_gal[k]:.4g} gal blocks the road by more than "
                     f"{one.more_than_m3:,.6g} m3 with {value} ({sure}: {low} to {high})")
    return words


def describe_yearly(rate: study_types.PerYear, sure: str, before: bool) -> str:
    """How often; before: peaks below the hazard curve's first, which are not counted, make bodies fail, too."""
    if not rate.value:
        aside = ", but for peaks below the hazard curve's first" * before
        return f"at most {rate.high + rate.more_at_most:.2g} per year ({sure}{aside})"
    least = "at least " * (before or is_more(rate))
    return f"{least}{rate.value:.2g} per year ({sure}: {rate.low:.2g} to {rate.high:.2g})"


def is_more(rate: study_types.PerYear) -> bool:
    """Whether peaks above the hazard curve's last may add much."""
    return rate.more_at_most > BEYOND * rate.value


def describe_chain(chain_: study_types.Chain, output: Path) -> List[str]:
    """The lines of the console; ensemble.describe_ensemble() says why volumes are withheld."""
    lines = [f"caveat: {text}" for text in texts(chain_.doubts)]
    if chain_.withheld:
        lines.append("how likely the road is blocked is withheld, as the volumes are")
    else:
        lines = [*sentences(chain_), *lines]
    return [*lines, f"{', '.join(str(output / name) for name in chain_.files)}: how likely which volume is exceeded"]
