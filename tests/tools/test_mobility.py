"""Known events and their relation: against the figures found for the set beforehand, and wrong sets."""

import pytest


from slope_tools.errors import SlopeError
from slope_tools.mobility import events

ALL = events.read_events()


def test_relation_of_the_set():
    found = events.fit_relation(ALL)
    assert found.coefficients == pytest.approx([1.334, 0.134, 0.671, 0.144], abs=5e-4)
    assert (len(ALL), found.free) == (49, 45)
    assert found.deviation == pytest.approx(0.115, abs=5e-4)
    assert found.r2 == pytest.approx(0.79, abs=5e-3)


def test_one_more_event():
    found = events.fit_relation(ALL)
    assert found.quantile(0.5, 1, 1000) == pytest.approx(2226, abs=1)
    assert [found.quantile(share, 1, 1000) for share in (0.05, 0.95)] == pytest.approx([1380, 3590], abs=6)
    assert found.exceedance(found.quantile(0.3, 5, 800, True), 5, 800, True) == pytest.approx(0.7)
    assert found.exceedance([1000, 2226], 1, [500, 1000])[1] == pytest.approx(0.5, abs=1e-3)
    assert found.volumes == (0.1, 498.0) and found.falls == (220.0, 1720.0)


@pytest.mark.parametrize("level, inside", [(0.8, 38), (0.9, 46)])
def test_leave_one_out(level, inside):
    beyond = [float(events.fit_relation([*ALL[:i], *ALL[i + 1:]]).exceedance(
        one.length, one.volume, one.fall, one.confined)) for i, one in enumerate(ALL)]
    assert sum(abs(share - 0.5) < level / 2 for share in beyond) == inside


def test_frank():
    frank = next(one for one in ALL if one.name == "Frank Slide")
    place = frank.volume, frank.fall, frank.confined
    assert events.fit_relation(ALL).quantile(0.5, *place) == pytest.approx(2994, abs=1)
    blind = events.fit_relation([one for one in ALL if one is not frank])
    assert blind.quantile(0.5, *place) == pytest.approx(2990, abs=1)
    assert blind.quantile(0.1, *place) < frank.length == 3080 < blind.quantile(0.9, *place)
    assert blind.quantile(0.5, *place) < events.fit_relation(ALL).quantile(0.5, *place)      # drawn towards its length


HEAD = "name,fall_m,length_m,volume_Mm3,confinement\n"


@pytest.mark.parametrize("text, words", [
    ("name,fall_m\nA,1\n", ("length_m", "volume_Mm3", "confinement")),
    (HEAD + "A,900,2000,-1,lateral\n", ("line 2", "volume_Mm3", "-1")),
    (HEAD + "A,900,nan,1,lateral\n", ("line 2", "length_m", "nan")),
    (HEAD + "A,900,2,1,lateral\n", ("line 2", "length_m", "metres", "2 and 900")),
    (HEAD + "A,900,2000,1,narrow\n", ("line 2", "confinement", "narrow")),
    (HEAD.replace("volume_Mm3", "volume_Mm3,fall_m") + "A,900,2000,1,3,lateral\n", ("each column once", "fall_m")),
    (HEAD.replace("conf", "slope,conf") + "A,900,2000,1,5,3,lateral\n", ("line 2", "must have 6 cells", "7")),
    (HEAD + "A,9_0,200,1,lateral\n", ("line 2", "fall_m", "9_0")),
    (HEAD + "A,900,2000,1,lateral\n" + "A,900,2000,1,lateral\n", ("line 3", "name", "A")),
])
def test_wrong_sets(tmp_path, text, words):
    path = tmp_path / "set.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(SlopeError) as error:
        events.read_events(path)
    assert all(word in str(error.value) for word in (str(path), *words))


def test_sets_that_give_no_relation():
    with pytest.raises(SlopeError, match="at least 12 events.* got 3"):
        events.fit_relation(ALL[:3])
    with pytest.raises(SlopeError, match="laterally confined"):
        events.fit_relation([one for one in ALL if not one.confined])
