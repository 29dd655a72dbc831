"""What a report says of known events: where its runs lie, or that no set covers them."""
import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any, Dict, NamedTuple

import numpy as np
import pytest
from shapely.geometry import LineString, Point

import made_rows
from test_mobility_path import SET, disc, hillside

from slope_tools.digits import three
from slope_tools.mobility import body, known as known_events
from slope_tools.mobility.fall_path import TERRAIN
from slope_tools.mobility.known import Known
from slope_tools.mobility.results import percent
from slope_tools.plots import known_reach
from slope_tools.report import mobility_part
from slope_tools.report.numbers import Numbers
from slope_tools.statistics.entries import Source
from slope_tools.studies import letter
from slope_tools.tables import how_far
from slope_tools.tables.rows import Failed


def case(lengths, volume=0.78e6, study=True, scar=1, **about):
    """data, ground and numbers of runs of these lengths (m); about: of the known events."""
    mass = disc(hillside(), (300, 300))
    ground = ground_of(mass.raster._replace(z=np.zeros_like(mass.depth)), mass.raster.z, scar * mass.depth, **about)
    rows = [made_rows.row(length_m=length, released_m3=volume) for length in lengths]
    one = SimpleNamespace(distance=lengths[0]) if lengths and lengths[0] else None
    data = SimpleNamespace(study=study or None, finished=rows, result=None, label=lambda one: "run",
                           largest_release=lambda: volume, length=one)
    return data, ground, Numbers()


def ground_of(raster, before, depth, **about):
    return SimpleNamespace(raster=raster, before=before, slip_depth=depth,
                           known=known_events.among_events(None, lambda: body.of_arrays(
                               raster._replace(z=before), depth, "the run"), about))


@pytest.fixture(scope="module")
def known():
    return known_events.compute_known_mobility(disc(hillside(), (300, 300)), known_events.choice()).by_set


def test_a_run_lies_where_its_length_does(known):
    length = known.length_at(0.96)
    data, ground, numbers = case([length], study=False)
    (what, text), = mobility_part.list_mobility_limits(data, ground, numbers)
    share = known.where_lies(length).at_most
    assert share == pytest.approx(0.04) and what == mobility_part.WHAT
    assert "as far as 4 % of rock avalanches of this volume and height do" in text
    for kind, words in (("confined", "of those on a laterally confined path"), ("unconfined", "of the others)")):
        assert f"{percent(known.where_lies(length, kind).at_most)} {words}" in text
    assert [row[4] for row in numbers.rows][1] == pytest.approx(4)


def test_several_runs_lie_between(known):
    ends = [known.length_at(share) for share in (0.98, 0.89)]
    data, ground, numbers = case([ends[1], None, ends[0], (ends[0] + ends[1]) / 2])
    text = mobility_part.list_mobility_limits(data, ground, numbers)[0][1]
    assert "deposits of the runs reach" in text and "as far as 2 % to 11 % of rock avalanches" in text


def test_beyond_the_path_is_at_least(known):
    text = mobility_part.list_mobility_limits(*case([known.path.length[-1] + 100]))[0][1]
    assert f"as far as at least {percent(1 - known.beyond_path())} of rock" in text


def test_three_digits():
    assert [three(value) for value in (0, 0.021249, 16.349, 6129.0)] == ["0", "0.0212", "16.3", "6,130"]


@pytest.mark.parametrize("columns, length", [(500, None), (340, None), (150, 1340)])
def test_a_terrain_that_ends_before_half_of_the_events(columns, length):
    data, ground, numbers = case([900.0])
    part = ground_of(ground.raster._replace(z=ground.raster.z[:, :columns]), ground.before[:, :columns],
                     ground.slip_depth[:, :columns])
    text = mobility_part.list_mobility_limits(data, part, numbers)[0][1]
    if length is None:
        assert "terrain shows the first" not in text
        return
    found = known_events.compute_mobility(disc(hillside(), (300, 300)), SET)
    shares = [percent(found.exceedance(length, kind)) for kind in ("unconfined", "confined")]
    assert f"terrain shows the first 1,340 m of the way, where {shares[0]} ({shares[1]}) of them go on" in text


@pytest.mark.parametrize("change, words", [
    ({"lengths": [None]}, ("No run has a deposit",)),
    ({"scar": 0}, ("cannot be compared", "a body")),
    ({"set": "gone.csv"}, ("cannot be compared", "gone.csv")),
])
def test_otherwise_it_says_why(change, words):
    (_, text), = mobility_part.list_mobility_limits(*case(**{"lengths": [900.0], **change}))
    assert all(word in text for word in words) and "of this volume" not in text


@pytest.mark.parametrize("scar, set_, name", [
    (0.05, None, "69 translational slides, all paths"),
    (1, "rockfalls", "rockfalls, all paths"), (1, "debris_flows:chan", "debris flows on channelized paths")])
def test_landslides_where_no_set_covers_the_mass_or_they_were_asked_for(scar, set_, name):
    """A small mass, or a row of site.yaml: as far as these, by the larger of both scatters, and by each."""
    data, ground, numbers = case([900.0], scar=scar, set=set_)
    one = ground.known.found.decides
    assert one.law.name in mobility_part.list_mobility_limits(data, ground, numbers)[0][1] and name in one.law.name
    text = mobility_part.list_mobility_limits(data, ground, numbers)[0][1]
    shares = [percent(one.where_lies(900.0, kind).at_most) for kind in (one.chosen, *one.law.both)]
    assert f"as far as {shares[0]} of landslides" in text and "not of cuts and embankments of roads" in text
    assert f"{shares[1]} by the smaller, {shares[2]} by the larger" in text and "rock avalanches" not in text


def test_a_height_that_no_event_has():
    data, ground, numbers = case([500.0])
    low = ground.before.min()
    lower = ground_of(ground.raster, low + (ground.before - low) / 8, ground.slip_depth)
    assert "220 to 1720 m" in lower.known.found.by_set.outside[0]
    assert "of landslides of this volume" in mobility_part.list_mobility_limits(data, lower, numbers)[0][1]


# --- the first page ---

class Lengths(NamedTuple):
    """What known events say: (length_at, at_most) of each share."""
    at: Dict[float, Any]
    path: Any = SimpleNamespace(length=[0.0, 100.0, 300.0], end=TERRAIN)

    def length_at(self, share):
        return self.at[share][0]

    def at_most(self, share):
        return self.at[share][1]


@pytest.mark.parametrize("runs, near, half, far, farther", [
    ((60, 70, 120), 80, 110, 200, None),                # the middle of each lies in the band of the other, or one does
    ((60, 70, 100), 80, 110, 200, "known events"),
    ((60, 90, 100), 80, 110, 200, None),
    ((60, 70, 100), 80, None, None, "known events"),    # beyond the terrain
    ((60, 70, 299), None, None, None, "known events"), ((60, 70, 310), None, None, None, None),
    ((150, 220, 250), 80, 110, 200, "the runs"), ((150, 190, 250), 80, 110, 200, None),
    ((150, 220, 250), 80, 110, None, None),
    ((150, 220, 250), -80, -110, 200, "the runs"),      # at most
    ((60, 70, 100), -80, -110, 200, None)])
def test_both_answers_differ_by_more_than_their_bands(runs, near, half, far, farther):
    known_ = Lengths({share: (None, None) if length is None else (length, None) if length > 0 else (1.0, -length)
                      for share, length in ((0.9, near), (0.5, half), (0.1, far))})
    assert how_far.farther(runs, known_) == farther


def test_how_far_is_a_pool_of_runs_and_known_events(known):
    """Each counts half: quantiles lie between those of both, and grow with the share, whatever the runs do."""
    half = known.length_at(0.5)
    for lengths in ([half] * 4, [0.5 * half, 0.6 * half, 0.7 * half], [3 * half, 4 * half], [0.9 * half, math.inf]):
        one = how_far.pool(lengths, known, "paper")
        ends = [math.inf if end is None else end for end in (one.near_m, one.middle_m, one.far_m)]
        assert ends == sorted(ends) and one.events and one.runs == len(lengths)
        middle = float(np.median(lengths))
        assert min(half, middle) * 0.999 <= ends[1] <= max(half, middle) * 1.001
        for share, end in zip((how_far.TAIL, 0.5, 1 - how_far.TAIL), ends):
            # by hand: of runs and of events, half each, so many end there or before
            if math.isfinite(end):
                before = [(np.mean(np.array(lengths) <= at) + 1 - known.exceedance(at)) / 2 for at in
                          (end * (1 - 1e-9) - 1e-9, end)]
                assert before[0] - 1e-6 <= share <= before[1] + 1e-6
    assert how_far.pool([3 * half, 4 * half], known, "paper").farther in (None, "the runs")


def test_how_far_without_known_events(known):
    """The runs alone, and why; one that left the terrain goes beyond all that is known."""
    outside = known._replace(outside=["the set of known events does not cover this volume"])
    one = how_far.pool([60.0, 70.0, 80.0], outside, "ensemble")
    assert (one.near_m, one.middle_m, one.far_m, one.events) == (60.0, 70.0, 80.0, False)
    said = letter.describe_reach(one, letter.format_console_number)
    assert "70.0 m (60.0 to 80.0 m)" in said and "does not cover this volume" in said and "3 runs" in said
    one = how_far.pool([60.0, math.inf, math.inf], None, "paper", why="No path")
    assert (one.near_m, one.middle_m, one.far_m, one.end_m) == (60.0, None, None, None)      # not that of a run
    assert letter.describe_reach(one, letter.format_console_number).startswith("It goes 60.0 m or more")
    assert how_far.pool([], known) is None


def test_of_which_runs_the_reach_is():
    """Not of those that were added for their length, nor of one without a deposit; one that lost mass goes beyond."""
    rows = [made_rows.row(length_m=60.0), made_rows.row(length_m=None), made_rows.row(length_m=99.0, batch=1),
            made_rows.row(length_m=70.0, released_m3=100.0, lost_m3=1.5)]
    one = how_far.reach(rows, Source.SWEEP, Known(None, "no path"))
    assert (one.runs, one.near_m, one.far_m, one.source, one.why) == (2, 60.0, None, "paper", "no path")
    assert how_far.reach(rows[1:3], None, Known(None, "")) is None
    # all of the mass of a run left: no deposit, and farther than any
    gone = made_rows.row(length_m=None, length_is=None, lost_m3=1000.0)
    one = how_far.reach([*rows[1:3], made_rows.row(length_m=60.0), gone], Source.SWEEP, Known(None, ""))
    assert (one.runs, one.near_m, one.middle_m, one.far_m) == (2, 60.0, 60.0, None)
    assert how_far.reach([gone], None, Known(None, "")).middle_m is None
    # of more than a tenth that were cut short nobody knows
    for short, known_ in ((1, True), (2, False)):
        rows = [made_rows.row(length_m=60.0 + k, at_rest=k >= short) for k in range(10)]
        text = letter.describe_reach(how_far.reach(rows, Source.SWEEP, Known(None, "")), letter.format_console_number)
        assert text.startswith("It goes about") == known_ and (f"{short} of 10 runs had not come" in text) != known_


def test_of_more_than_a_tenth_that_failed_nobody_knows_how_far():
    bad = Failed("a", {}, {}, 0, "lost atoms")
    for failed, short, known_ in ((1, 0, True), (1, 1, False), (2, 0, False)):
        rows = [*[bad] * failed, replace(bad, batch=1), *(
            made_rows.row(length_m=60.0 + k, at_rest=k >= short) for k in range(10 - failed))]
        one = how_far.reach(rows, Source.SWEEP, Known(None, ""))
        text = letter.describe_reach(one, letter.format_console_number)
        assert (one.runs, one.failed, one.cut) == (10 - failed, failed, short)
        assert text.startswith("It goes about") == known_ and ("2 of 10 runs failed or had not come" in text) != known_


def test_nearer_than_events_tell_the_distance_may_be_less(known):
    """The curve falls at its first point of which they say something."""
    said, curve = np.zeros(len(known.path.length), bool), np.ones(len(known.path.length))
    k = len(said) // 2
    said[k:], curve[k:] = True, np.linspace(0.8, 0.0, len(said) - k)
    dropped = known._replace(said=said, curves={**known.curves, known.chosen: curve})
    least = known.path.length[k]
    one = how_far.pool([2 * least], dropped)
    assert one.least_m == least >= one.near_m and one.middle_m > least
    assert f"({three(least)} m or less to " in letter.describe_reach(one, letter.format_console_number)
    # where half of all go beyond the terrain, nothing nearer is said
    curve[k:] = np.linspace(0.8, 0.4, len(said) - k)
    one = how_far.pool([math.inf], dropped)
    text = letter.describe_reach(one, letter.format_console_number)
    assert (one.near_m <= least, one.middle_m) == (True, None) and text.startswith("It goes in half of all cases bey")


# --- on maps and section ---

def test_marks_lie_across_the_path_where_shares_of_the_events_go_farther(known):
    reach = known_reach.of_mobility(known)
    wanted = {share: length for share in (0.5, 0.1) if (length := known.length_at(share)) is not None}
    assert wanted and {mark.share: mark.length for mark in reach.marks} == wanted
    path = LineString(np.column_stack([known.path.x, known.path.y]))
    for mark in reach.marks:
        bar = LineString(mark.ends)
        assert path.project(Point(mark.middle)) == pytest.approx(mark.length, abs=1e-3 * mark.length)
        assert bar.centroid.distance(Point(mark.middle)) < 1e-6
        before, after = (np.array(path.interpolate(mark.length + step).coords[0]) for step in (-20, 20))
        across = mark.ends[1] - mark.ends[0]
        assert abs(across @ (after - before)) < 0.1 * np.hypot(*across) * np.hypot(*(after - before))
    assert LineString(reach.path).length == pytest.approx(max(wanted.values()), rel=1e-3)
    text = known_reach.describe_known_reach(reach)
    assert f"beyond them go half{' and a tenth' * (0.1 in wanted)} of known events" in text
    assert known_events.WORDS["mixture"] in text and ("would lie beyond the terrain" in text) == (len(reach.marks) < 2)
    fewer = known_reach.describe_known_reach(reach._replace(marks=reach.marks[:1]))
    assert "a tenth" not in fewer and fewer.endswith("; other marks would lie beyond the terrain.")


def test_a_section_shows_the_marks_that_it_passes(known):
    reach = known_reach.of_mobility(known)
    along = LineString(reach.path)
    beyond = LineString([along.coords[0], *[np.array(point) for point in along.coords[1:]],
                         2 * np.array(along.coords[-1]) - along.coords[-2]])
    assert [at for _, at in known_reach.on_line(reach, beyond)] == pytest.approx(
        [mark.length for mark in reach.marks], rel=1e-3)
    far = LineString(np.array(along.coords) + 0.5 * along.length)
    assert not list(known_reach.on_line(reach, far))


def test_where_no_set_covers_the_mass_there_are_no_marks():
    assert known_reach.describe_known_reach(known_reach.NOTHING) == "" and not list(
        known_reach.on_line(known_reach.NOTHING, LineString([(0, 0), (1, 1)])))
