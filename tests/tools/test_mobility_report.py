"""What a report says of known events: where its runs lie, or that no set covers them."""
from types import SimpleNamespace

import numpy as np
import pytest

from test_mobility_path import ALL, disc, hillside

from slope_tools.mobility import exceedance  # noqa: E402
from slope_tools.mobility.results import percent  # noqa: E402
from slope_tools.report import mobility_part  # noqa: E402
from slope_tools.report.numbers import Numbers  # noqa: E402


def case(lengths, volume=0.78e6, study=True, scar=1):
    """data, ground and numbers of runs whose connected deposits have these lengths (m)."""
    mass = disc(hillside(), (300, 300))
    ground = SimpleNamespace(raster=mass.raster._replace(z=np.zeros_like(mass.depth)), before=mass.raster.z,
                             slip_depth=scar * mass.depth)
    rows = [{"connected_m": length, "released_m3": volume} for length in lengths]
    one = SimpleNamespace(distance=lengths[0]) if lengths and lengths[0] else None
    data = SimpleNamespace(study=study or None, finished=rows, result=None, label=lambda one: "run",
                           largest_release=lambda: volume, connected=lambda: one)
    return data, ground, Numbers()


@pytest.fixture(scope="module")
def known():
    return exceedance.of_body(disc(hillside(), (300, 300)), ALL)


def test_a_run_lies_where_its_length_does(known):
    length = known.length_at(0.96, False)
    data, ground, numbers = case([length], study=False)
    (what, text), = mobility_part.content(data, ground, numbers)
    share = known.where_lies(length, False).at_most
    assert share == pytest.approx(0.04) and what == mobility_part.WHAT
    assert "as far as 4 % of rock avalanches of this volume and height do" in text
    assert f"({percent(known.where_lies(length, True).at_most)} where the path is laterally confined)" in text
    assert [row[4] for row in numbers.rows][1] == pytest.approx(4) and "safe side" in text


def test_several_runs_lie_between(known):
    ends = [known.length_at(share, False) for share in (0.98, 0.89)]
    data, ground, numbers = case([ends[1], None, ends[0], (ends[0] + ends[1]) / 2])
    text = mobility_part.content(data, ground, numbers)[0][1]
    assert "deposits of the runs reach" in text and "as far as 2 % to 11 % of rock avalanches" in text


def test_beyond_the_path_is_at_least(known):
    text = mobility_part.content(*case([known.path.length[-1] + 100]))[0][1]
    assert f"as far as at least {percent(1 - known.beyond_path(False))} of rock" in text


@pytest.mark.parametrize("columns, length", [(500, None), (340, None), (150, 1340)])
def test_a_terrain_that_ends_before_half_of_the_events(columns, length):
    data, ground, numbers = case([900.0])
    part = {"raster": ground.raster._replace(z=ground.raster.z[:, :columns]), "before": ground.before[:, :columns],
            "slip_depth": ground.slip_depth[:, :columns]}
    text = mobility_part.content(data, SimpleNamespace(**part), numbers)[0][1]
    if length is None:
        assert "leaves the terrain" not in text
        return
    found = exceedance.of_body(disc(hillside(), (300, 300)), ALL)
    shares = [percent(found.exceedance(length, kind)) for kind in (False, True)]
    assert f"leaves the terrain after 1,340 m, where {shares[0]} ({shares[1]}) of them go on" in text


@pytest.mark.parametrize("change, words", [
    ({"volume": 49e3}, ("No set of known events covers", "0.049 million m3", "0.1 to 498")),
    ({"lengths": [None]}, ("No run has a connected deposit",)),
    ({"scar": 0}, ("cannot be compared", "a body")),
])
def test_otherwise_it_says_why(change, words):
    (_, text), = mobility_part.content(*case(**{"lengths": [900.0], **change}))
    assert all(word in text for word in words) and "rock avalanches of this" not in text


def test_a_height_that_no_event_has():
    data, ground, numbers = case([500.0])
    low = ground.before.min()
    text = mobility_part.content(data, SimpleNamespace(**{**vars(ground), "before": low + (ground.before - low) / 8}),
                                 numbers)[0][1]
    assert "No set of known events covers this height" in text and "220 to 1720 m" in text
