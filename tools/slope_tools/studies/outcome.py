"""What the runs of a study say together: what is read of them (read_study), and the Outcome that is evaluated from it.

Nothing is told here, nor written but what is kept for the next time: files, console and pages are made side by side
(files, console; report of its Study), by results and commands/study.
"""
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from .. import kept, records
from ..case import run_folders
from ..case.settings import normalise_value
from ..deposits import travel_shares
from ..ensembles import ensemble, known_events
from ..errors import SlopeError
from ..findings import Finding, finding
from ..mobility import known
from ..mobility.known import Mobility
from ..runs import repeats
from ..seismic import chain_files
from ..sites.site_bodies import VARIABLE
from ..statistics.conservative_volume import Scatter
from ..statistics.entries import Source
from ..tables import (combinations, elastic, ensemble_types, how_far, intensity, judged, road_runs, sizes, step_check,
                      study_types, usable)
from ..tables.rows import Finished, Row, find_farthest_run, finished_of
from . import body_depth, mapped, size_runs
from .run_rows import placed, read_run_rows, terrain_of
from .setup import Setup
from .size_runs import AtFinest

# variables that calibrated values do not depend on: chance, time, what is written; of the size of the balls see LIKE
OF_ITS_OWN = ("d", "duration", "step", "packing", "seed", "ground_seed", "xoffset", "yoffset", "film", "out",
              "ledger", "each", "cell")
LIKE = 1.5              # times as many balls over the thickness: values found with fewer, or more, are of another model


class Questions(NamedTuple):
    """What is asked of the runs of a study together."""
    settings: Mapping[str, Sequence[str]]           # of --set: choices
    repeated: Mapping[str, Sequence[str]]           # of --repeat: chance
    thresholds: Sequence[float]                     # m, of the maps of exceedance
    order: Optional[ensemble.Order] = None          # that the runs were made for, None of lists
    intensity: Optional[str] = None                 # variable that is one; None: the one that is called so
    more_than: Sequence[float] = ()                 # m3, volumes exceeded at each intensity
    notes: Sequence[Any] = ()                       # warnings of what was before the study, which go into its results
    site: Optional[Path] = None                     # folder of the site whose study it is
    sizes: Optional[AtFinest] = None                # runs with finer balls; None: none were asked for
    step: Optional[step_check.Step] = None          # the run with half the time step
    most_elastic: Optional[elastic.Made] = None     # the runs with the largest restitution
    method: str = ""                                # of a site's study, in words
    chain: Optional[chain_files.Chain] = None       # of an ensemble: how likely its bodies fail in an earthquake
    known: Mapping[str, Any] = {}                   # of site.yaml: with which known events the runs are compared
    # of a site with several, whose worst is asked: road_numbers.Number
    roads: Sequence[Mapping[str, Any]] = ()
    alone: bool = True                              # else study.yaml waits for the other study of the site

    @property
    def among(self) -> Mapping[str, Any]:
        """With which known events the runs are compared: the ensemble's, or those of site.yaml (known.of_about)."""
        condition = self.order and self.order.condition
        return condition.asked.about() if condition else self.known


class Read(NamedTuple):
    """What was read of the runs of a study.

    rows: one for each run, finished or failed; road: whether there is one; among: the mass among known events; events:
    what these did at the road;
    mobility: of the mass, for the weights of an ensemble; emulated: ensemble.emulate() of it; observed: the mapped
    deposit, as study.yaml has it; size: what balls of several sizes say; draw: values of
    transferred runs as they may be, None of one size; elastic: those with the largest restitution;
    problem: why there are no maps over all runs; case: for the command that mends a reason, None where no run finished;
    balls_thick: over the thickness of the body; defaults: of the deck's variables.
    """
    rows: List[Row]
    road: bool
    among: known.Known
    events: Optional[how_far.EventsAtRoad]
    mobility: Optional[Mobility]
    emulated: Optional[ensemble.Emulated]
    observed: Optional[study_types.Observed]
    size: Optional[study_types.Size]
    draw: Optional[sizes.Draw]
    elastic: Optional[elastic.Runs]
    problem: Optional[str]
    case: Optional[usable.Case]
    balls_thick: Optional[float]
    defaults: Mapping[str, str]

    @property
    def finished(self) -> List[Finished]:
        return finished_of(self.rows)


@dataclass(frozen=True)
class Outcome:
    """about: what study.yaml says of it, but for the maps and what tables/headline makes of it, or of both studies."""
    questions: Questions
    read: Read
    groups: Sequence[combinations.Group]
    names: Sequence[str]                            # columns that a combination has a mean of
    scatters: Mapping[str, Optional[Scatter]]
    ensemble: Optional[ensemble.Evaluated]
    chain: Optional[chain_files.Evaluated]
    about: study_types.Study


def read_study(setup: Setup, questions: Questions, at: AtFinest, todo: Sequence[repeats.Repeat],
               defaults: Mapping[str, str]) -> Read:
    """What an Outcome is evaluated from, of runs of which the finest count."""
    raw = read_run_rows(setup, todo)
    rows, observed = mapped.compare(mapped.find_mapped_deposit(questions.site), setup.output, sizes.transfer_rows(
        at.sizes, raw), [terrain_of(run.folder, run.log) for run in todo])
    first, finished = next((run for run in todo if not run.error), None), finished_of(rows)
    row = finished[0] if finished else None
    events = mobility = None
    among = known.Known(None, "")
    if first and row:
        prefix = run_folders.prefix_of(run_folders.summary_of(setup.output, row.summary))
        try:
            among = how_far.known_of(prefix, terrain_of(first.folder, first.log), questions.among, setup.body)
        except SlopeError as error:     # a terrain that only LAMMPS finds, a raster that was changed
            if setup.road:
                raise
            among = known.Known(None, str(error))
        if setup.road:
            raster = placed(run_folders.load_raster(prefix, "thickness"), first)
            events = how_far.compute_events_at_road(among, setup.road.read(raster).polygon)
    if row and questions.order and questions.order.condition:
        summary = run_folders.summary_of(setup.output, row.summary)
        mobility = known_events.mobility_of(questions.order.condition, summary.parent, summary)
    emulated = emulated_of(setup, questions.order, rows, mobility) if questions.order else None
    most = elastic.read_elastic_runs(questions.most_elastic, rows,
                                     setup.output) if row and questions.most_elastic else None
    size = size_runs.summarise_finer_runs(setup, at) if row else None
    return Read(rows, setup.road is not None, among, events, mobility, emulated, observed, size,
                sizes.draw_rows(at.sizes, raw), most, None,
                usable.Case(setup.deck, questions.site, row.variables, round(row.released_m3 / row.ball_m3),
                            given=setup.given) if row else None,
                body_depth.in_balls(setup, finished), defaults)


def emulated_of(setup: Setup, order: ensemble.Order, rows: Sequence[Row],
                mobility: Optional[Mobility]) -> ensemble.Emulated:
    """What emulators say of the runs of an ensemble, kept with the study."""
    made_of = [order.sample.about, order.of, order.added and order.added.batches, rows,
               mobility and [mobility.outside, mobility.path.length, mobility.curves[mobility.chosen]]]
    return records.read_record(ensemble.Emulated, kept.value(
        setup.output / ".emulated.json", made_of, lambda: records.encode_record(
            ensemble.emulate(order, rows, mobility))))


# --- what they say together ---

def evaluate_study(questions: Questions, read: Read, header: study_types.Header) -> Outcome:
    """The Outcome of a study; of an ensemble one run at least has finished."""
    rows, finished, order = read.rows, read.finished, questions.order
    groups = combinations.grouped(rows)
    names, scatters = combinations.averaged(groups), combinations.scatters(groups)
    keys = ["front_m", "thickness_m", "max_thickness_m", "max_speed_m_s"]
    keys += [key for key in (travel_shares.DISTANCE, "length_m") if key in names]
    several = best = step = at_intensities = None
    if order:
        assert read.emulated is not None
        weighed = None
        if order.condition and read.emulated.known_events:
            assert order.added and read.mobility
            weighed = known_events.evaluate_known_events(order.condition, order.sample, order.added, rows,
                                                         read.mobility, read.emulated.known_events, read.draw)
        several = ensemble.evaluate_ensemble(order, rows, read.emulated, weighed)
        if several:
            several = several._replace(about=replace(several.about, withheld=reasons(read)))
    elif read.road and finished:
        best, step = judge_conservative(questions, read, groups)
    if finished and not order:      # drawn values have one run
        at_intensities = intensity.evaluate_intensity(questions.intensity, questions.more_than, questions.settings,
                                                      read.road, groups)
    if at_intensities and best:
        best = replace(best, doubts=[*best.doubts, *intensity.find_intensity_caveats(at_intensities)])
    effect = read.size.effects.get(chain_files.QUANTITY) if read.size else None
    chain = chain_files.evaluate_chain(questions.chain, rows, reasons(read), effect.left if effect else None) \
        if questions.chain and several and finished else None
    weighted = several.about if several else None
    source = Source.ENSEMBLE if order else Source.SWEEP
    study = study_types.Study(
        study=header, largest={key: find_largest_row(finished, key) for key in keys if finished},
        farthest=find_farthest_run(finished).run if finished else None, conservative=best, size=read.size,
        ensemble=weighted, step=step, largest_restitution=elastic.evaluate_elastic(read.elastic) if read.elastic
        else None,
        scatter={name: {"deviation": one.deviation, "degrees_of_freedom": one.degrees_of_freedom} if one else None
                 for name, one in scatters.items()},
        combinations=combinations.list_combination_entries(groups, names), envelope=None, exceedance=None,
        observed=read.observed,
        roads=[dict(one) for one in questions.roads], warnings=collect_study_warnings(questions, read), runs=rows,
        headline=None,
        reach=how_far.reach(rows, source, read.among),
        stretches=evaluate_stretches(
            finished, events.weights if (events := ensemble_types.weighted(weighted)) else None)
        if read.road and finished else None,
        chain=chain.about if chain else None, intensity=at_intensities, next_step=None,
        at_road=read.events and read.events.road(finished))
    return Outcome(questions, read, groups, names, scatters, several, chain, study)


def collect_study_warnings(questions: Questions, read: Read) -> List[Finding]:
    """Those of before the study, then those on its runs of other kinds."""
    findings = [finding(one) for one in questions.notes]
    warned = {one.kind for one in findings if not one.part}
    findings += [one for one in judged.of_runs(read.rows) if one.kind not in warned]
    if read.problem:
        findings.append(finding(read.problem))
    if questions.order and read.finished:
        plan = questions.order.sample
        others = (other_thickness(plan.balls_thick, read.balls_thick),
                  other_settings(plan.beside, read.finished[0].variables))
        findings += [*plan.doubts, *(one for one in others if one)]
    return findings


def other_thickness(balls: Optional[float], here: Optional[float]) -> Optional[Finding]:
    """That calibrated values were found with so many balls over the thickness of the body, and are used with others."""
    if balls is None or here is None or max(balls, here) <= LIKE * min(balls, here):
        return None
    return Finding("other thickness", {"found": balls, "here": here})


def other_settings(settings: Mapping[str, str], here: Mapping[str, str]) -> Optional[Finding]:
    """That they were found with such values of other variables of the deck, and are used with others; size and time of
    the runs have words of their own."""
    differ = [name for name in settings.keys() & here.keys() - {*OF_ITS_OWN}
              if normalise_value(settings[name]) != normalise_value(here[name])]
    said = (", ".join(f"{name} {one[name]}" for name in sorted(differ)) for one in (settings, here))
    return Finding("other settings", dict(zip(("found", "here"), said))) if differ else None


def reasons(read: Read) -> List[Finding]:
    """Why the numbers of an ensemble are withheld."""
    assert read.case
    return usable.reasons_of_ensemble(read.rows, read.events, read.case._replace(sampled=True))


def judge_conservative(questions: Questions, read: Read, groups: Sequence[combinations.Group]) -> Tuple[
        study_types.Conservative, Optional[study_types.HalfStep]]:
    """The entries of the conservative volume and of the run with half the time step.

    A volume that is withheld is None there, so that no reader takes it for one.
    """
    best = combinations.conservative(questions.settings, read.rows, groups, read.draw)
    doubts, step = [*best.doubts, *unseen(questions.repeated, read.defaults)], None
    if questions.step:
        step, more = step_check.compare(questions.step, groups)
        doubts += more
    assert read.case
    withheld, zero = usable.reasons_of_sweep(best, read.rows, read.events, read.case), None
    if withheld:
        best = replace(best, volume_m3=None, rounded={**best.rounded, "volume_m3": None})
    elif best.volume_m3 == 0:
        zero = usable.zero(len(read.finished), max(
            read.events.reached) if read.events and not read.events.behind else None)
    return replace(best, doubts=doubts, withheld=withheld, zero=zero), step


def unseen(repeated: Mapping[str, Sequence[str]], defaults: Mapping[str, str]) -> List[Finding]:
    """The caveat that the scatter is incomplete: only seeds were repeated, though the deck can place its balls anew."""
    offsets = repeats.unmoved(repeated, defaults) if repeated else []
    return [Finding("not repeated", {"repeated": ", ".join(repeated), "offsets": ", ".join(offsets)})] \
        if offsets else []


def evaluate_stretches(rows: Sequence[Finished], known: Optional[Mapping[str, float]]) -> study_types.Stretches:
    """Of the road that finished runs block; known: weights by known events, or None."""
    weights = known or {row.run: 1.0 for row in rows if not row.batch}
    stretches = road_runs.evaluate_road_runs([road_runs.Run(weights[row.run], row.at_road.stretches,
                                                            row.at_road.clearing)
                                              for row in rows if row.run in weights])
    bodies: Dict[str, List[Any]] = {}
    for row in rows:
        if row.run in weights and VARIABLE in row.variables:
            bodies.setdefault(row.variables[VARIABLE], []).append((weights[row.run], row.at_road.by_10_m))
    return replace(stretches, of_known_events=bool(known), bodies=road_runs.by_body(bodies) if len(bodies) > 1
                   else None)


def find_largest_row(rows: Sequence[Finished], key: str) -> study_types.Largest:
    """The largest value of a column and the first run that has it."""
    values = [float(row.value(key)) for row in rows]
    k = values.index(max(values))
    return study_types.Largest(values[k], rows[k].run)
