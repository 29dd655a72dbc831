"""The chain of a study: what `slope fragility` wrote, its bodies as a variable of the runs, and what they say together.

The mathematics are in chain.py; here are the checks, the tables, the entry of study.yaml and its words.
"""
import math
from dataclasses import replace
from pathlib import Path
from typing import Any, Dict, Iterable, List, Mapping, NamedTuple, Sequence, Tuple

import numpy as np

from .. import disk
from ..digits import percent
from ..errors import SlopeError
from ..findings import Finding, finding, texts
from ..sites.site_bodies import VARIABLE
from ..sites.site_found import SlipBody
from ..statistics import hazard
from ..tables import intensity, study_types
from ..tables.rows import Row, finished_of
from . import chain
from .fragility_files import Fragility

CURVES, PER_YEAR = "chain.csv", "chain_per_year.csv"
QUANTITY = intensity.QUANTITY
LEVELS = 41             # volumes of the curves, beside those that are asked for
BEYOND = 0.1            # of a frequency; if peaks above the curve's last may add more, it is said


class Chain(NamedTuple):
    """What is asked of the runs of a study."""
    fragility: Fragility
    weights: Dict[str, float]       # {body: how likely it fails, given that one does}
    volumes: Dict[str, float]       # {body: m3}
    more_than: Sequence[float]      # m3; none: three round ones


# --- before the runs ---

def check_chain(found: Fragility, here: Mapping[str, SlipBody], site: Path, more_than: Sequence[float]) -> Chain:
    """The Chain of a site whose bodies (site.yaml: found) are those of a fragility; SlopeError if they are not."""
    if not here:
        raise SlopeError("--fragility", "needs a site with bodies of slope stability, which slope site --slips makes",
                         site)
    share = chain.weights(found.capacity, found.peaks, found.rate)
    weights = {name: float(one) for name, one in zip(found.bodies, share) if one > 0}
    if not weights:
        raise SlopeError("--fragility", "must have a body that fails at one of its peaks", found.folder)
    for name, digest in zip(found.bodies, found.bases):
        if name in weights and name not in here:
            raise SlopeError("--fragility", f"must be of the bodies of {site}, {', '.join(here)}: body {name} may "
                             "fail, too; slope site --slips without --body has all of them", found.folder)
        if name in here and here[name].base_sha256 != digest:
            raise SlopeError("--fragility", f"must be of the bodies of {site}: body {name} is another one there",
                             found.folder)
    for name in here:
        if name not in found.bodies:
            raise SlopeError("--fragility", f"must have all bodies of {site}, but has no body {name}", found.folder)
    return Chain(found, weights, {name: float(here[name].volume_m3) for name in weights}, more_than)


def options(asked: Chain) -> Tuple[List[str], List[str]]:
    """The bodies as values of a variable of the study: of --set if one alone may fail, else of --vary."""
    if len(asked.weights) == 1:
        return [f"{VARIABLE}={next(iter(asked.weights))}"], []
    return [], [f"{VARIABLE}=list:" + ",".join(f"{name}@{max(one, 1e-9):.6f}" for name, one in asked.weights.items())]


# --- after them ---

def list_left_volumes(asked: Chain, rows: Sequence[Row]) -> List[chain.Left]:
    """What each body leaves on the road; of those that never fail nothing."""
    found = []
    for name in asked.fragility.bodies:
        if name not in asked.weights:
            found.append(chain.compute_left_volume([0.0], [0], 0.0))
            continue
        mine = [row for row in rows if row.set[VARIABLE] == name]
        done = finished_of(mine)
        point = [tuple(row.set.values()) for row in done]
        known = {one: k for k, one in enumerate(dict.fromkeys(point))}
        found.append(chain.compute_left_volume([row.at_road.remove_on_road_m3 for row in done],
                                               [known[one] for one in point],
                                               asked.volumes[name], len(mine) - len(done)))
    return found


class Evaluated(NamedTuple):
    """about: the entry of study.yaml; tables: {name of a file: its text}."""
    about: study_types.Chain
    tables: Dict[str, str]


def evaluate_chain(asked: Chain, rows: Sequence[Row], withheld: Sequence[Finding], sizes: bool) -> Evaluated:
    """What the runs say; rows: of study.csv; withheld: why their volumes may not be used; sizes: whether several were
    run."""
    found, bodies = asked.fragility, list_left_volumes(asked, rows)
    seen = [row.at_road.remove_on_road_m3 for row in finished_of(rows)]
    more_than = list(asked.more_than) or intensity.round_volumes(max(seen)) or [0.0]
    largest = sum(float(one.value.volumes[1:].max(initial=0.0)) for one in bodies)
    volumes = np.unique([*np.linspace(0.0, max(largest, 1.0), LEVELS), *more_than])
    at = np.searchsorted(volumes, more_than)
    family = chain.family(found.capacity, found.peaks, bodies, volumes)
    tables = {CURVES: format_chain_table(
        ("peak_gal", "volume_m3", "probability", "low", "high"),
        ((peak, volume, *(side[i, k] for side in family)) for i, peak in enumerate(found.peaks)
         for k, volume in enumerate(volumes)))}
    curves = [study_types.ChainCurve(volume, *(side[:, k].tolist() for side in family))
              for volume, k in zip(more_than, at)]
    per_year = None
    if found.rate is not None:
        yearly = chain.frequency(found.capacity, found.rate, found.peaks, bodies, volumes)
        tables[PER_YEAR] = format_chain_table(("volume_m3", "per_year", "low", "high"), zip(volumes, *yearly.total))
        per_year = [of_year(yearly, volume, k) for volume, k in zip(more_than, at)]
    about = study_types.Chain(
        found.folder.name, QUANTITY, hazard.CONFIDENCE, [summarise_chain_body(asked, name, rows) for name
                                                         in found.bodies],
        more_than, found.peaks.tolist(), curves, per_year, list(withheld), list(tables), [])
    coarse = [] if sizes else [Finding("chain size")]
    return Evaluated(replace(about, doubts=[*find_chain_caveats(about, found.warnings), *coarse]), tables)


def write_chain(found: Evaluated, output: Path) -> None:
    """The tables."""
    (output / PER_YEAR).unlink(missing_ok=True)      # of a study before this one in the folder
    for name, text in found.tables.items():
        disk.write_file(output / name, text)


def summarise_chain_body(asked: Chain, name: str, rows: Sequence[Row]) -> study_types.ChainBody:
    """What study.yaml says of a body."""
    mine = [row for row in rows if row.set[VARIABLE] == name]
    return study_types.ChainBody(name, asked.weights.get(name, 0.0), asked.volumes.get(name), len(mine),
                                 len(finished_of(mine)))


def of_year(yearly: chain.Frequency, volume: float, k: int) -> study_types.PerYear:
    """What study.yaml says of how often a volume is exceeded, the k-th."""
    total = yearly.total
    return study_types.PerYear(
        volume, float(total.value[k]), float(total.low[k]), float(total.high[k]), float(yearly.beyond[k]),
        [{"from_gal": a, "to_gal": None if math.isinf(b) else b, "per_year": float(part[k])}
         for a, b, part in yearly.parts])


def find_chain_caveats(about: study_types.Chain, warnings: Sequence[Any]) -> List[Finding]:
    """The caveats; warnings: of the fragility."""
    return [*(finding(one)._replace(part="fragility") for one in warnings),
            *(Finding("body without run", {"body": one.body, "volume": one.volume_m3})
              for one in about.bodies if one.weight > 0 and not one.finished),
            *(Finding("more per year", {"per_year": one.more_at_most, "volume": one.more_than_m3})
              for one in about.per_year or () if one.more_at_most > BEYOND * one.value)]


def format_chain_table(head: Sequence[str], rows: Iterable[Sequence[float]]) -> str:
    return disk.csv_text(head, ([f"{value:.6g}" for value in row] for row in rows))


# --- words ---

def sentences(about: study_types.Chain) -> List[str]:
    """How often, or at which peaks, the road is blocked by more than each of the volumes."""
    sure = f"{100 * about.confidence:g} %"
    if about.per_year:
        return [f"the road is blocked by more than {one.more_than_m3:,.6g} m3 with {one.value:.2g} per year "
                f"({sure}: {one.low:.2g} to {one.high:.2g})" for one in about.per_year]
    found = []
    for one in about.curves:
        k = int(np.argmin(np.abs(np.array(one.probability) - 0.5)))
        low, value, high = (percent(side[k]) for side in (one.low, one.probability, one.high))
        found.append(f"an earthquake of {about.peaks_gal[k]:.4g} gal blocks the road by more than "
                     f"{one.more_than_m3:,.6g} m3 with {value} ({sure}: {low} to {high})")
    return found


def describe_chain(about: study_types.Chain, output: Path) -> List[str]:
    """The lines of the console; ensemble.describe_ensemble() says why volumes are withheld."""
    lines = [f"caveat: {text}" for text in texts(about.doubts)]
    if about.withheld:
        lines.append("how likely the road is blocked is withheld, as the volumes are")
    else:
        lines = [*sentences(about), *lines]
    return [*lines, f"{', '.join(str(output / name) for name in about.files)}: how likely which volume is exceeded"]
