"""An ensemble that is weighted by known events: what study.yaml says of it, and its tables.

Order of the work: where known events end on the path of this mass (mobility), the weights that make the runs end there,
curves and quantiles of the weighted runs (conditioned), the parameters that they have, maps
(ensemble_maps). The numbers of the ensemble as its distributions have it are not touched.
"""
import functools
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Callable, Dict, Iterable, List, Mapping, NamedTuple, Optional, Sequence

import numpy as np

from .. import disk
from ..case import logs, run_folders
from ..digits import metres, percent, three_at_least
from ..errors import SlopeError
from ..findings import Finding, texts
from ..mobility import body, known, run_length
from ..mobility.known import WORDS, Mobility
from ..quantiles import within
from ..statistics import dependent, emulator, hazard
from ..statistics.entries import Analysis, KnownQuantile
from ..survey.rasters import Place
from ..tables import answer_words, combinations, ensemble_types, headline, how_far, quantities, sizes
from ..tables.quantities import REMOVE
from ..tables.rows import Row, finished_of
from . import conditioned, ensemble_maps, farther
from .sample import Sample

FOLDER, HAZARD, WEIGHTS = "known_events", "hazard_known_events.csv", "weights.csv"
LEAST_EFFECTIVE = 20    # runs; fewer say little
LEFT = 0.01             # share of the released volume beyond the grid, from which on a run's length is not its own
MIDDLE = 0.05, 0.5, 0.95        # quantiles of the parameters of the weighted runs
NOT_FARTHER = "released_m3", "stop_time_s"      # columns that a mass that goes farther need not exceed; nor any angle


@dataclass(frozen=True)
class Condition:
    """What --known asks for; found: of the site; None: of the body of the first run that finished; named: whether a set
    was asked for by its name, so that no landslides stand for it."""
    asked: known.Choice
    found: Optional[known.Found]
    named: bool = True


def check_condition(asked: known.Choice, name: Optional[str], site: Optional[Path]) -> Condition:
    """The Condition of a choice; SlopeError if a set that was named (name; None: none was) does not cover the body of a
    site's folder, if there is one: of others the landslides count then."""
    bodies = None
    if site:
        bodies = known.compute_known_mobility(body.read_mobility_body(site), asked)
        if name is not None and not bodies.strict:
            assert bodies.by_set
            raise SlopeError("--known", f"must be a set that covers the mass: {'; '.join(bodies.by_set.outside)}", name)
    return Condition(asked, bodies, name is not None)


def mobility_of(condition: Condition, folder: Path, summary: Path) -> Mobility:
    """The Mobility by which runs count; folder, summary: of a run, of whose body it is if there is no site."""
    among = condition.found
    if among is None:
        log = logs.Log(folder / logs.LOG).update()
        terrain = log.terrain and folder / log.terrain
        if not terrain or not terrain.is_file():
            raise SlopeError(folder, "must have a deck with region terrain, for the ground before the collapse")
        mass = how_far.known_of(run_folders.prefix_of(summary), terrain, condition.asked.about())
        if mass.found is None:
            raise SlopeError(folder, f"must have a mass that can be compared with known events: {mass.why}")
        among = mass.found
    return among.by_set if condition.named and among.by_set else among.decides


# --- evaluation ---

class Runs:
    """Those runs of an ensemble that have a length: rows; point: of the design; failed: number of others."""

    def __init__(self, sample: Sample, added: Sequence[farther.Batch], rows: Sequence[Row],
                 mobility: Mobility):
        self.sample, self.added = sample, added
        self.rows = [row for row in finished_of(rows) if row.length_m is not None]
        self.failed = len(rows) - len(self.rows)
        first = combinations.same_as(self.rows)         # the same run, to the last digit, is one point
        self.point = [tuple(self.rows[k].set[name] for name in sample.names) for k in first]
        self.lengths = self.column("length_m") if self.rows else np.empty(0)
        self.exceedance = mobility.exceedance
        self.beyond = np.asarray(mobility.exceedance(self.lengths), float)
        if len(self.rows) >= 2:
            ratio = farther.ratio(self.places, [row.batch for row in self.rows], added) if added else None
            self.weights = conditioned.compute_weights(self.lengths, self.beyond, ratio)
            self.mass = conditioned.masses(self.weights)

    def column(self, name: str) -> np.ndarray:
        return np.array([float(row.value(name)) for row in self.rows])

    def comparable(self, names: Iterable[str]) -> List[str]:
        """Those of which all have a value, which grows with the length; the distance of the last per cents has none
        where they left the terrain."""
        return [name for name in names if name not in NOT_FARTHER and not name.endswith("_deg")
                and all(row.value(name) is not None for row in self.rows)]

    @functools.cached_property
    def places(self) -> np.ndarray:
        return self.sample.places(self.rows)

    @property
    def several(self) -> float:
        return len(self.rows) / len(set(self.point))

    @property
    def failed_share(self) -> float:
        return self.failed / (len(self.rows) + self.failed)

    def design(self) -> Optional[conditioned.Design]:
        """What tells how even the design is; None where it cannot be told, which makes the bounds wider."""
        if self.added or self.failed or self.several > 1 or len(self.rows) > conditioned.MOST_EMULATED or \
                not emulator.enough(len(self.rows), len(self.sample.names)):
            return None
        return conditioned.Design(self.sample.kind, self.places, self.lengths, self.exceedance,
                                  self.sample.snap)


def find_runs_of_quantiles(runs: Runs) -> List[str]:
    """Names of the runs on which the quantiles of the headline rest."""
    found = within(runs.column(REMOVE), runs.mass.share, headline.choose_known_shares(runs.weights.far), runs.mass.far)
    return [sizes.nearest(runs.rows, REMOVE, one).run for one in found if np.isfinite(one)]


def weighs(mobility: Mobility, runs: Runs) -> bool:
    """Whether known events weigh the runs."""
    return not mobility.outside and len(runs.rows) >= 2


class Evaluated(NamedTuple):
    """about: what study.yaml says of the weighted runs, but for their maps; runs: None where nothing weighs them."""
    about: ensemble_types.Known
    runs: Optional[Runs]
    curves: Mapping[str, hazard.Curve]


@dataclass(frozen=True)
class Emulated:
    """What emulators of the weighted runs say: quantities whose dependence counts, values of them and
    the factors that their design makes of the bounds there, and how they depend on the variables."""
    main: List[str]
    effects: Dict[str, List[List[float]]]
    influence: Dict[str, Analysis]


def emulate(sample: Sample, added: farther.Added, rows: Sequence[Row], mobility: Mobility,
            main: Sequence[str]) -> Emulated:
    """main: quantities whose dependence counts, the one of the curve first."""
    runs = Runs(sample, added.batches, rows, mobility)
    comparable = runs.comparable(main) if weighs(mobility, runs) else []
    design = runs.design() if comparable else None
    effects = {name: design.effect(runs.column(name)) for name in comparable} if design else {}
    return Emulated(comparable, {name: [np.asarray(side).tolist() for side in both] for name, both in effects.items()},
                    {name: evaluate_influence(runs, name) for name in comparable[:1]})


def select_planned_rows(rows: Sequence[Row]) -> List[Row]:
    """The rows of the design, without those that were added."""
    return [row for row in rows if not row.batch]


def evaluate_known_events(condition: Condition, sample: Sample, added: farther.Added, rows: Sequence[Row],
                          mobility: Mobility, emulated: Emulated, draw: Optional[sizes.Draw] = None) -> Evaluated:
    """What the weighted runs say.

    rows: of study.csv, finished and failed; mobility: the mass among known events; emulated: of emulate(); draw: of
    runs that are transferred to the finest balls.
    """
    names = quantities.name_asked(finished_of(select_planned_rows(rows)))
    asked = condition.asked
    known = ensemble_types.Known(
        asked.name(mobility), asked.number(mobility), list(asked.left_out), asked.confined,
        WORDS[mobility.chosen], mobility.volume, mobility.outside, None, [])
    runs = Runs(sample, added.batches, rows, mobility)
    if not weighs(mobility, runs):
        said = [Finding("no event", {"text": text}) for text in mobility.outside] or [Finding("few lengths")]
        return Evaluated(replace(known, doubts=said), None, {})
    curves = {name: conditioned.compute_known_curve(runs.column(name), runs.mass, emulated.effects.get(name),
                                                    runs.several, runs.failed_share) for name in runs.comparable(names)}
    weights_, longest = runs.weights, float(runs.lengths.max())
    weighted = ensemble_types.Weighted(
        **vars(replace(known, reached=weights_.reached)), short=weights_.short, far=weights_.far, runs=len(runs.rows),
        failed=runs.failed, effective=weights_.effective, distance=weights_.distance,
        far_by_lobe=far_by_lobe(runs, mobility), gaps=weights_.gaps,
        shortest_m=float(runs.lengths.min()), longest_m=longest, half_beyond_m=mobility.length_at(0.5),
        path_m=mobility.end(longest), beyond_path=mobility.beyond_path(), added=added.about(),
        quantities={name: ensemble_types.OfKnown(*names[name], list_known_quantiles(curve, runs, name, hazard.SHARES))
                    for name, curve in curves.items()},
        to_remove=transferred(list_known_quantiles(curves[REMOVE], runs, REMOVE,
                                                   headline.choose_known_shares(weights_.far)),
                              runs, draw)
        if REMOVE in curves else None,
        variables={name: variable(runs, k, emulated.main) for k, name in enumerate(sample.names)},
        influence=emulated.influence, maps=[], weights={row.run: float(one) for row, one in zip(
            runs.rows, conditioned.weigh_runs(runs.mass))},     # with those beyond the longest
        path_end_m=end if (end := float(mobility.path.length[-1])) < longest else None)
    return Evaluated(replace(weighted, doubts=find_known_caveats(weighted, runs)), runs, curves)


def write_known_events(evaluated: Evaluated, levels: ensemble_maps.Thresholds, output: Path, place: Optional[Place],
                       grids: Optional[str]) -> ensemble_types.Known:
    """Tables and maps; what study.yaml says, with the entries of the maps. levels, place, grids: see
    ensemble.write_ensemble."""
    runs = evaluated.runs
    if runs is None:
        for name in (HAZARD, WEIGHTS):
            (output / name).unlink(missing_ok=True)         # of a study before this one
        return evaluated.about
    disk.write_file(output / HAZARD, hazard.tabulate_hazard(evaluated.curves))
    disk.write_file(output / WEIGHTS, weights_table(runs))
    prefixes = [run_folders.prefix_of(run_folders.summary_of(output, row.summary)) for row in runs.rows]
    return replace(evaluated.about, maps=[] if grids else ensemble_maps.write_ensemble_maps(
        output / FOLDER, prefixes, conditioned.Standing(runs.mass, runs.several, runs.failed_share), levels, place))


def list_known_quantiles(curve: hazard.Curve, runs: Runs, name: str, shares: Sequence[float]) -> List[KnownQuantile]:
    """What study.yaml says of those of a quantity."""
    found = conditioned.compute_known_quantiles(curve, shares, runs.column(name), runs.mass)
    if len(set(runs.point)) == 1:       # one run has no bounds
        found = [one._replace(low=None, high=None) for one in found]
    return found


def transferred(several: Sequence[KnownQuantile], runs: Runs, draw: Optional[sizes.Draw]) -> List[KnownQuantile]:
    """Quantiles of the volume to remove with what lengths and volumes of transferred runs may be: with each draw the
    runs have other weights, too. That may raise the quantile itself."""
    if draw is None:
        return list(several)
    lengths, volumes = (draw(runs.rows, key) for key in ("length_m", REMOVE))
    masses = [conditioned.masses(conditioned.compute_weights(one, np.asarray(runs.exceedance(one), float),
                                                             runs.weights.ratio)) for one in lengths]
    quantiles = []
    for quantile in several:
        low, high = np.quantile([np.fmin(within(volume, mass.share, quantile.share, mass.far), volume.max())
                                 for volume, mass in zip(volumes, masses)], hazard.TAILS).tolist()
        if quantile.value is not None:     # errors of runs raise a high quantile: it is no lower than it is with them
            value = max(quantile.value, low)
            quantile = quantile._replace(value=value, transfer=[value - min(value, low), max(value, high) - value])
        quantiles.append(quantile)
    return quantiles


def far_by_lobe(runs: Runs, mobility: Mobility) -> List[float]:
    """The shares of known events beyond the runs if other lobes count."""
    return [float(mobility.exceedance(max(row.length_by_lobe_m[k] for row in runs.rows if row.length_by_lobe_m)))
            for k in range(len(run_length.OTHERS))]


def variable(runs: Runs, k: int, main: Sequence[str]) -> ensemble_types.KnownVariable:
    """Of a variable of the weighted runs: quantiles, and rank correlations with the main quantities."""
    places = runs.places[:, k]
    one = runs.sample.variables[k]
    return ensemble_types.KnownVariable(
        [one.value(place) for place in within(places, runs.mass.share, MIDDLE)],
        {name: rank(places, runs.column(name), runs.mass.share) for name in main})


def rank(x: np.ndarray, y: np.ndarray, share: np.ndarray) -> Optional[float]:
    """Rank correlation (Spearman) of weighted values; None where one of them is the same in all."""
    if share.sum() <= 0:
        return None
    w = share / share.sum()
    both = []
    for values in (x, y):
        ranks = (values[:, None] > values) @ w + (values[:, None] == values) @ w / 2
        both.append(ranks - w @ ranks)
    scale = float((w @ both[0] ** 2) * (w @ both[1] ** 2))
    return float(w @ (both[0] * both[1])) / scale ** 0.5 if scale > 1e-18 else None


def find_known_caveats(weighted: ensemble_types.Weighted, runs: Runs) -> List[Finding]:
    """The caveats, in the order of their weight."""
    caveats, stopped, reached = [], weighted.added.stopped, weighted.reached or 0.0
    if weighted.far >= 1 - farther.REACHED:
        remedy = answer_words.describe_reason(stopped) if stopped else "vary towards more mobile masses"
        caveats.append(Finding("events beyond", {
            "length": metres(weighted.longest_m), "share": answer_words.describe_share_beyond(weighted.far,
                                                                                              weighted.path_end_m),
            "remedy": remedy}))
    if reached < farther.REACHED and weighted.short > (1 - farther.REACHED) / 2:
        caveats.append(Finding("events before", {"length": metres(weighted.shortest_m),
                                                 "share": percent(weighted.short)}))
    caveats += [Finding("gap", {"low": three_at_least(gap.low_m), "high": metres(gap.high_m),
                                "share": percent(gap.share)}) for gap in weighted.gaps]
    if weighted.effective < LEAST_EFFECTIVE:
        caveats.append(Finding("few effective", {"effective": weighted.effective}))
    if runs.failed:
        caveats.append(Finding("no length", {"failed": runs.failed, "runs": len(runs.rows) + runs.failed}))
    left = sum(row.off_grid_m3 + row.lost_m3 > LEFT * row.released_m3 for row in runs.rows)
    if left:
        caveats.append(Finding("lengths lost", {"lost": left, "runs": len(runs.rows), "percent": 100 * LEFT}))
    return caveats


# --- on which variables a quantity depends ---

def evaluate_influence(runs: Runs, quantity: str) -> Analysis:
    """What study.yaml says of the quantity that counts: Sobol indices on emulators.

    The weight of a place in the unit cube is that of the runs of its length, which an emulator of log10 L gives: share
    of the known events over the density of the distributions. So the variables depend on each other.
    """
    values = runs.column(quantity)
    _, point = np.unique(np.array(runs.point), axis=0, return_inverse=True)
    names = runs.sample.names
    weighting, text = None, "the runs are too few for an emulator of their lengths"
    if emulator.enough(int(point.max()) + 1, len(names)) and np.ptp(runs.lengths) > 0:
        length = emulator.validated(runs.places, np.log10(runs.lengths), point)
        text = f"the emulator of the length explains {percent(length.check.explained)} of the variance of unseen runs"
        if length.check.verdict != "bad":
            weighting = dependent.Weighting(weight(runs, length.whole), [weight(runs, one) for one in length.parts],
                                            length.check.unseen)
    if weighting is None:
        return Analysis(f"no indices: {text}", None, {})
    return emulator.analyse(names, runs.places, values, point, runs.sample.snap, weighting)


def weight(runs: Runs, length: emulator.Emulator) -> Callable[[np.ndarray], np.ndarray]:
    """The weight of places (n, d): that of the runs of this length, without what their batch makes of it."""
    order = runs.mass.order
    lengths = np.log10(runs.lengths)[order]
    each = (runs.mass.share / runs.weights.ratio)[order]
    return lambda places: np.interp(length.at(places), lengths, each)


# --- tables ---

def weights_table(runs: Runs) -> str:
    """The CSV of the runs' weights; they add up to what is reached."""
    numbers = np.column_stack([runs.beyond, runs.weights.ratio, runs.weights.weights])
    return disk.csv_text(["run", "length_m", "beyond", "ratio", "weight"], (
        [row.run, f"{length:.3f}", *(f"{one:.6g}" for one in several)]
        for row, length, several in zip(runs.rows, runs.lengths, numbers)))


# --- words ---

def describe_known_events(ensemble: ensemble_types.Ensemble) -> List[str]:
    """The weighted ensemble in a few lines: what is reached, by how many runs, the quantiles, the caveats."""
    lines, about, known, of = [], ensemble_types.weighted(ensemble), ensemble.known_events, ensemble.of
    if about:
        lines = ["known events: " + summarise_weights(about)]
        if of and of in about.quantities:
            entry = about.quantities[of]
            lines.append(f"{entry.name}: " + "; ".join(
                quantile_text(one, entry.unit, "known events") for one in entry.quantiles))
    return lines + [f"caveat: known events: {text}" for text in texts(known.doubts if known else ())]


def summarise_weights(weighted: ensemble_types.Weighted) -> str:
    added = weighted.added.points
    more = f" (those of {added} points towards longer ones among them)" if added else ""
    reached, far = percent(weighted.reached or 0.0), answer_words.describe_share_beyond(weighted.far,
                                                                                        weighted.path_end_m)
    return (f"the runs reach from {three_at_least(weighted.shortest_m)} to {metres(weighted.longest_m)}, where "
            f"{reached} of {weighted.events} events of {weighted.set} end ({percent(weighted.short)} "
            f"before, {far} beyond{by_lobe(weighted)}; {weighted.path}); weighted by them the {weighted.runs} "
            f"runs{more} say as " f"much as {weighted.effective:.0f}")


def by_lobe(weighted: ensemble_types.Weighted) -> str:
    """What share lies beyond if other lobes count, where that is another one."""
    shares = [percent(one) for one in weighted.far_by_lobe]
    if all(one == percent(weighted.far) for one in shares):
        return ""
    least = " and ".join(percent(one) for one in run_length.OTHERS)
    return f" (with lobes of {least} {' and '.join(shares)})"


def quantile_text(quantile: KnownQuantile, unit: str, whose: str) -> str:
    """A quantile with its bounds; without a value, what is known instead."""
    share = f"{100 * quantile.share:g} % of {whose}"
    if quantile.value is None:
        return f"{share}: unknown, they go beyond the runs"
    low, high = ("?" if side is None else quantities.format_quantity(side) for side in (quantile.low, quantile.high))
    if gap := quantile.gap:
        first, last = map(quantities.format_quantity, gap)
        return f"{share}: between {first} and {last} {unit}, as no run ends where they do ({low} to {high})"
    at_most = quantities.share_within(share, unit)
    return f"{at_most} {quantities.format_quantity(quantile.value)} {unit} ({low} to {high})"
