"""Runs that an ensemble adds towards longer ones, on a stand-in: how they count, when they are made, when they end."""
from types import SimpleNamespace

import numpy as np
import pytest
from scipy import stats

import known_twins as twins

from slope_tools.ensembles import conditioned, farther, known_study, sample
from slope_tools.errors import SlopeError
from slope_tools.statistics import designs, distributions
from slope_tools.statistics.entries import Code
from slope_tools.studies import ensemble_study
from slope_tools.tables import answer_words

RUNS, SEEDS, PATH = 64, 4, farther.End(1e5, 0.0)
LEVELS = np.array([5e3, 2e4, 4e4, 7e4])     # m3


def response(u, chance=None):
    """The twin's, of which one run in twenty is mobile."""
    v = u.copy()
    v[:, 0] = u[:, 0] ** 0.25
    return twins.response(v, False, chance)


def planned(number=RUNS, seed=0, high=1.0):
    return sample.Sample(number, designs.SOBOL, seed, tuple(
        distributions.Range(name, f"uniform:0:{high}", 0.0, high, stats.uniform(0, high), high) for name in "abc"))


def places_of(batch):
    return np.array([[float(value) for value in one.values()] for one in batch.points])


def proposed(added, u, lengths, beyond, path=PATH):
    """What is added next, None where nothing is; and the Added with it, or with the reason."""
    found = farther.next_runs(added, u, lengths, beyond, path, lambda: farther.longer(u, lengths, added.sample))
    return found.batches[-1] if len(found.batches) > len(added.batches) else None, found


class Ensemble:
    """A design and what is added to it."""

    def __init__(self, seed):
        rng = np.random.default_rng(seed)
        self.added = farther.Added(planned(seed=seed))
        self.u = designs.points(designs.SOBOL, 3, RUNS, seed)
        self.lengths, self.volumes = response(self.u, rng)
        self.batch = np.zeros(RUNS, int)
        while True:
            new, self.added = proposed(self.added, self.u, self.lengths, twins.exceedance(self.lengths))
            if new is None:
                break
            u = places_of(new)
            lengths, volumes = response(u, rng)
            self.u, self.batch = np.vstack([self.u, u]), np.append(self.batch, np.full(len(u), self.batch.max() + 1))
            self.lengths, self.volumes = np.append(self.lengths, lengths), np.append(self.volumes, volumes)

    def weights(self, ratio=True, first=False):
        part = slice(RUNS if first else None)
        given = farther.ratio(self.u, self.batch, self.added.batches) if ratio else None
        return conditioned.compute_weights(self.lengths[part], twins.exceedance(self.lengths[part]), given)


@pytest.fixture(scope="module")
def ensembles():
    return [Ensemble(seed) for seed in range(SEEDS)]


@pytest.fixture(scope="module")
def reference():
    u = designs.points(designs.SOBOL, 3, 20000, 10)
    lengths, volumes = response(u, np.random.default_rng(1))
    return u, volumes, conditioned.masses(conditioned.compute_weights(lengths, twins.exceedance(lengths)))


def test_more_is_reached(ensembles):
    for one in ensembles:
        before, after = one.weights(False, True), one.weights()
        assert before.reached < farther.REACHED and 0 < one.added.number <= farther.MOST * RUNS
        assert after.far < 0.7 * before.far and after.effective > before.effective
        assert after.weights.sum() == pytest.approx(after.reached) and after.reached == pytest.approx(
            1 - after.far - after.short)


def test_the_weighted_lengths_are_those_of_known_events(ensembles):
    for one in ensembles:
        found, logs = one.weights(), np.log10(one.lengths)
        at = np.linspace(one.lengths.min(), one.lengths.max(), 4000)
        share = -np.diff(twins.exceedance(at))
        wanted = share @ np.log10((at[1:] + at[:-1]) / 2) / share.sum()
        w = found.weights / found.reached
        deviation = np.sqrt(w @ (logs - w @ logs) ** 2)
        assert abs(w @ logs - wanted) < 2 * deviation / np.sqrt(found.effective)


def test_added_points_count_as_the_parameters_are_distributed(ensembles, reference):
    """Shares above volumes within their bounds; a parameter's mean nearer to the truth than without the ratios."""
    u, volumes, mass = reference
    truth = mass.share @ conditioned.are_above_levels(volumes, LEVELS) + mass.far
    held, wrong = 0, {True: [], False: []}
    for one in ensembles:
        curve = conditioned.compute_known_curve(one.volumes, conditioned.masses(one.weights()))
        bounds = np.array([curve.at(level) for level in LEVELS])
        held += int(((bounds[:, 1] <= truth) & (truth <= bounds[:, 2])).sum())
        # a box holds less of the second variable than the design, at the same length
        for ratio in wrong:
            w = one.weights(ratio).weights
            wrong[ratio].append(w @ one.u[:, 1] / w.sum() - mass.share @ u[:, 1] / mass.share.sum())
    assert held >= 0.9 * SEEDS * len(LEVELS)
    assert abs(np.mean(wrong[True])) < abs(np.mean(wrong[False]))


def test_ratios_by_hand():
    box = [[0.0, 0.5], [0.0, 0.2]]
    places = np.array([[0.1, 0.1], [0.3, 0.2], [0.9, 0.1], [0.2, 0.3], [0.4, 0.05]])
    ratio = farther.ratio(places, [0, 0, 0, 0, 1], [farther.Batch(box, [{}])])
    inside, outside = 5 / (4 + 1 / 0.1), 5 / 4
    assert ratio == pytest.approx([inside, inside, outside, outside, inside])
    lengths = np.random.default_rng(3).uniform(900, 4000, 60)
    plain = conditioned.compute_weights(lengths, twins.exceedance(lengths))
    same = conditioned.compute_weights(lengths, twins.exceedance(lengths), np.full(60, 0.3))
    assert same.weights == pytest.approx(plain.weights, rel=1e-12)


def test_nothing_is_added_where_the_runs_reach_far_enough():
    added = farther.Added(planned())
    u = designs.points(designs.SOBOL, 3, RUNS, 1)
    lengths = np.geomspace(500, 9000, RUNS)
    for far in (0.049, 0.0):        # though many are missing before the shortest
        assert proposed(added, u, lengths, np.linspace(0.7, far, RUNS)) == (None, added)
    lengths = response(u)[0]
    beyond = np.linspace(0.7, 0.051, RUNS)[np.argsort(np.argsort(lengths))]
    new, then = proposed(added, u, lengths, beyond)
    assert new is not None and (added.number, then.number, then.stopped) == (0, len(new.points), None)


def test_where_runs_are_longer_is_found_once(tmp_path, monkeypatch):
    """Of the same runs and distributions: it is kept with the study."""
    fitted, really = [], farther.longer
    monkeypatch.setattr(farther, "longer", lambda *given: fitted.append(1) or really(*given))
    u = designs.points(designs.SOBOL, 3, RUNS, 1)
    setup, order = SimpleNamespace(output=tmp_path), SimpleNamespace(sample=planned())
    for wanted, scale in ((1, 1.0), (1, 1.0), (2, np.linspace(0.99, 1, RUNS)), (2, np.linspace(0.99, 1, RUNS))):
        runs = SimpleNamespace(places=u, lengths=response(u)[0] * scale)
        assert ensemble_study.longer(setup, order, runs) == really(u, runs.lengths, planned()) and len(fitted) == wanted


def test_why_no_more_are_added():
    u = designs.points(designs.SOBOL, 3, RUNS, 1)
    lengths = response(u)[0]
    beyond = twins.exceedance(lengths)
    far, added = float(beyond.min()), farther.Added(planned())

    def stopped(added, runs=RUNS, lengths=lengths, path=PATH):
        new, then = proposed(added, u[:runs], lengths[:runs], beyond[:runs], path)
        assert new is None and then.batches == added.batches
        return then.stopped

    for path in (farther.End(float(lengths.max()), 0.0), farther.End(1e5, far - 0.02)):    # or hardly any are left
        assert stopped(added, path=path) == (Code.TERRAIN, {"share": path.share, "path_m": path.length})
    assert proposed(added, u, lengths, beyond, farther.End(1e5, far - 0.03))[0] is not None
    assert stopped(added, runs=7).code is Code.FEW
    u[0] = 0, 0, 1          # the corner where the longest run is: one may be that by chance
    assert proposed(added, u, response(u)[0], beyond)[0] is not None
    u[:2] = 0, 0, 1
    found = stopped(added, lengths=response(u)[0])
    assert found.code is Code.RANGE and found.numbers["ends"]["a"].startswith("0.0")
    assert "range" in answer_words.describe_reason(found) and "a 0.0" in answer_words.describe_reason(found)
    u[:2] = 0.5
    for _ in range(8):
        new, added = proposed(added, u, lengths, beyond)
        assert len(new.points) == 8
    assert stopped(added) == (Code.RUNS, {"points": 64})


# --- beyond the bounds of the distributions ---

def test_values_beyond_the_bounds():
    one = distributions.distribution("friction", "5:30", "--vary", "").widened(2.0, 30.0)
    assert one.places == pytest.approx((-0.12, 1)) and [one.value(u) for u in (-0.12, -0.04, 0, 0.5, 1, 1.1, -0.5)] == [
        "2", "4", "5", "17.5", "30", "30", "2"]
    assert [one.unit(text) for text in ("2", "4", "5", "17.5", "30")] == pytest.approx([-0.12, -0.04, 0, 0.5, 1])
    plain = distributions.distribution("friction", "5:30", "--vary", "")
    assert (plain.places, plain.value(-0.1), plain.unit("2")) == ((0, 1), "5", 0.0)
    known_ones = [distributions.distribution(*words.split("="), "--vary", "") for words in known_study.VARY]
    wide = sample.Sample(RUNS, designs.SOBOL, 1, tuple(known_ones)).widened(known_study.WIDE)
    assert wide.about.wide == {"friction": [2.0, 30.0], "spacing": [0.2, 0.95]}
    assert {one.name: (one.low, one.high) for one in known_ones} == {
        "friction": (5, 30), "rolling": (0, 0.15), "spacing": (0.3, 0.95), "field_e": (0.05, 0.5)}


def test_runs_are_added_beyond_the_bounds():
    """Where longer ones are, as far as the wider bounds, which are named where no values are left."""
    wide = planned().widened({"a": (-0.2, 1.0)})
    added = farther.Added(wide)
    u = designs.points(designs.SOBOL, 3, RUNS, 1)
    lengths = 10 ** (3 + 0.2 * (1 - u[:, 0]))
    beyond = np.linspace(0.9, 0.3, RUNS)[np.argsort(np.argsort(lengths))]
    batch, added = proposed(added, u, lengths, beyond)
    assert batch.box[0][0] == pytest.approx(-0.2) and batch.box[0][1] <= 0.1
    values = [float(one["a"]) for one in batch.points]
    assert min(values) < 0 and min(values) >= -0.2
    u[:8, 0] = -0.2
    lengths[:8], beyond[:8] = 10 ** (3 + 0.2 * 1.2), 0.2
    lengths[0] *= 1.1
    new, added = proposed(added, u, lengths, beyond)
    assert new is not None      # that one may be by chance
    lengths[1] *= 1.1
    new, added = proposed(added, u, lengths, beyond)
    assert new is None and added.stopped == (Code.RANGE, {"ends": {"a": "-0.20"}})


def test_the_design_has_no_points_beyond_the_bounds():
    """By hand: 4 points in the cube, 1 in a box half of which lies beyond."""
    batch = farther.Batch([[-0.1, 0.1], [0.0, 1.0]], [{}])
    places = np.array([[0.05, 0.5], [0.5, 0.5], [0.6, 0.5], [0.7, 0.5], [-0.05, 0.5]])
    assert farther.ratio(places, [0, 0, 0, 0, 1], [batch]) == pytest.approx(
        [5 / (4 + 1 / 0.2), 5 / 4, 5 / 4, 5 / 4, 5 / (1 / 0.2)])


def test_a_study_is_continued(tmp_path):
    added = farther.Added(planned(high=10.0))
    u = designs.points(designs.SOBOL, 3, RUNS, 1)
    lengths = response(u)[0]
    batch, added = proposed(added, u, lengths, twins.exceedance(lengths))
    assert added.line(batch, lengths, twins.exceedance(lengths)).startswith("no run goes beyond ")
    assert "8 more points towards a 0.0 to " in added.line(batch, lengths, twins.exceedance(lengths))
    farther.write_added_runs(tmp_path, added)
    assert farther.read_added_runs(tmp_path, planned(2 * RUNS, high=10.0)).batches == added.batches
    assert farther.read_added_runs(tmp_path, planned(high=9.0)).batches == []
    text = (tmp_path / farther.FILE).read_text()
    (tmp_path / farther.FILE).write_text(text.replace("box:", "bax:"))
    with pytest.raises(SlopeError, match="must be what `slope study --known` wrote"):
        farther.read_added_runs(tmp_path, planned(high=10.0))
