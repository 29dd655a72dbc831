"""fix deposit/grid: what shares of the volume stay within, what is fast or at rest.

Balls are placed by hand and lie still, or fly freely, so that numpy gives every number."""

import math
from pathlib import Path

import numpy as np
import pytest
import yaml

from deck_helpers import flight_head, run_deck, write_asc, write_balls

SHARES = [0.5, 0.9, 0.95, 0.99]
BIN = (1 + 1e-6) / 8192
DEPOSIT = "fix dep all deposit/grid 10 0 cell 2 terrain ground output out\n"
BOX = [(0.0, 400.0), (0.0, 200.0), (-50.0, 200.0)]


def summary(folder):
    return yaml.safe_load((Path(folder) / "out.summary.yaml").read_text())


def ground(folder):
    write_asc(folder / "ground.asc", np.zeros((20, 40)), cell=10.0)


def seen_from(top, x):
    """Distance in plan and angle below the horizontal (degrees)."""
    distance = np.hypot(x[:, 0] - top[0], x[:, 1] - top[1])
    angle = np.degrees(np.arctan2(top[2] - x[:, 2], distance))
    return distance, np.where(distance > 0, angle, 90.0)


def within(values, weights, share):
    """The smallest value that this share of the weight lies at or below."""
    order = np.argsort(values)
    below = np.cumsum(weights[order])
    return values[order][np.searchsorted(below, share * below[-1] * (1 - 1e-12))]


def check_quantiles(found, x, d, lost=0.0):
    """To one bin, of which the range has 8192, and never on the short or the steep side; lost: from the box, d**3."""
    top = np.array(found["top"])
    distance, angle = seen_from(top, x)
    volume = d**3
    assert [row["share"] for row in found["quantiles"]] == SHARES
    for row in found["quantiles"]:
        share = row["share"] * (1 + lost / volume.sum())
        if share > 1:
            assert row["distance"] is None and row["reach_angle"] is None
            continue
        far = row["distance"] - within(distance, volume, share)
        flat = -within(-angle, volume, share) - row["reach_angle"]
        assert -1e-9 <= far <= BIN * distance.max(), row
        assert -1e-9 <= flat <= BIN * np.ptp(angle), row
    farthest = distance.argmax()
    assert found["farthest"]["distance"] == found["front"] == pytest.approx(distance.max())
    angle_there = math.degrees(math.atan2(top[2] - x[farthest, 2], distance[farthest]))
    assert found["farthest"]["reach_angle"] == found["reach_angle"] == pytest.approx(angle_there)


def deposit(n=3000):
    """Balls of three sizes, of which the small ones lie farther away, and the highest one."""
    rng = np.random.default_rng(5)
    d = rng.choice([0.4, 0.8, 1.6], n)
    x = np.column_stack([20 + rng.gamma(2.0, 30.0 / d, n).clip(0, 300), rng.uniform(20, 180, n), rng.uniform(0, 40, n)])
    x[0] = 21.0, 90.0, 81.0
    return x, d


@pytest.mark.parametrize("np_", [1, 4])
def test_a_deposit_made_by_hand(tmp_path, np_):
    ground(tmp_path)
    x, d = deposit()
    write_balls(tmp_path / "balls.data", x, d, None, BOX)
    run_deck(flight_head() + DEPOSIT + "run 0\n", tmp_path, np=np_)
    assert summary(tmp_path)["warnings"] == []
    found = summary(tmp_path)["travel"]
    assert found["top"] == x[0].tolist()
    check_quantiles(found, x, d)
    # by volume, not by number
    assert found["quantiles"][0]["distance"] < 0.8 * np.median(seen_from(x[0], x)[0])


def test_one_stray_ball_moves_the_front_alone(tmp_path):
    ground(tmp_path)
    x, d = deposit()
    x = x[x[:, 0] < 200]
    d = d[:len(x)]
    found = []
    for places in (x, np.vstack([x, [[399.0, 199.0, 1.0]]])):
        write_balls(tmp_path / "balls.data", places, np.append(d, 0.8)[:len(places)], None, BOX)
        run_deck(flight_head() + DEPOSIT + "run 0\n", tmp_path)
        found.append(summary(tmp_path)["travel"])
    before, after = found
    assert after["front"] > 1.5 * before["front"]
    for one, two in zip(before["quantiles"], after["quantiles"]):
        assert two["distance"] == pytest.approx(one["distance"], abs=3e-3 * after["front"])
        assert two["reach_angle"] == pytest.approx(one["reach_angle"], abs=0.2)


@pytest.mark.parametrize("np_", [1, 3])
def test_balls_in_flight(tmp_path, np_):
    """From the place where the highest ball was released, not from where it is now; lost balls went farthest."""
    ground(tmp_path)
    x, d = deposit(400)
    rng = np.random.default_rng(6)
    v = rng.normal(0, 20, x.shape)
    v[0] = 80, 10, -20
    write_balls(tmp_path / "balls.data", x, d, v, BOX)
    run_deck(flight_head() + DEPOSIT + "run 1000\n", tmp_path, np=np_)
    end = x + v
    inside = np.ones(len(x), bool)
    for step in range(1001):
        at = x + v * 0.001 * step
        inside &= np.all([(at[:, k] >= lo) & (at[:, k] < hi) for k, (lo, hi) in enumerate(BOX)], axis=0)
    found = summary(tmp_path)
    assert found["balls"]["present"] == inside.sum() < 400
    share = 100 * (d**3)[~inside].sum() / (d**3).sum()
    assert f" {share:.3g} % of it left, in {(~inside).sum()} of 400 balls," in found["warnings"][0]
    assert found["travel"]["top"] == x[0].tolist()
    assert 0.02 < 1 - (d**3)[inside].sum() / (d**3).sum() < 0.5
    check_quantiles(found["travel"], end[inside], d[inside], (d**3)[~inside].sum())


@pytest.mark.parametrize("n", [30, 50])
def test_a_share_that_is_just_what_is_left(tmp_path, n):
    """A tenth leaves: nine tenths stay within the place of the farthest that is left, whatever the rounding."""
    ground(tmp_path)
    x = np.column_stack([5 + 2 * np.arange(n), np.full(n, 100.0), np.full(n, 5.0)])
    v = np.where(np.arange(n)[:, None] % 10 == 9, [0, 0, 1e4], [0, 0, 0])
    write_balls(tmp_path / "balls.data", x, 0.9, v, BOX)
    run_deck(flight_head() + DEPOSIT + "run 100\n", tmp_path)
    found = summary(tmp_path)["travel"]
    assert found["quantiles"][1] == {"share": 0.9, **found["farthest"]}
    assert found["quantiles"][2]["distance"] is None


def test_no_ball_is_left(tmp_path):
    ground(tmp_path)
    write_balls(tmp_path / "balls.data", [[5, 5, 5]], 1.0, [[-1e3, 0, 0]], BOX)
    run_deck(flight_head() + DEPOSIT + "run 100\n", tmp_path)
    found = summary(tmp_path)
    assert found["balls"]["present"] == 0 and "100 % of it left, in 1 of 1 balls," in found["warnings"][0]
    assert found["travel"]["quantiles"] == [{"share": share, "distance": None, "reach_angle": None} for share in SHARES]
    assert found["motion"]["fast_share"] == found["motion"]["moving_share"] == 0.0


def test_one_ball_has_gone_nowhere(tmp_path):
    ground(tmp_path)
    write_balls(tmp_path / "balls.data", [[5, 5, 5]], 1.0, None, BOX)
    run_deck(flight_head() + DEPOSIT + "run 0\n", tmp_path)
    for row in summary(tmp_path)["travel"]["quantiles"]:
        assert row["distance"] == 0.0 and row["reach_angle"] == 90.0


# --- what moves ---


@pytest.mark.parametrize("np_", [1, 3])
@pytest.mark.parametrize("motion", ["", "motion 3.0"])
def test_fast_share(tmp_path, np_, motion):
    """By volume of what was released, above 0.1 m/s whatever *motion* is."""
    ground(tmp_path)
    x, d = deposit(500)
    rng = np.random.default_rng(7)
    speed = np.sort(10.0 ** rng.uniform(-6, 1, 500))[np.argsort(np.argsort(x[:, 0]))]    # not alike on all ranks
    speed[:3] = 0.0, 0.0999999, 0.1000001
    v = speed[:, None] * [0.6, 0.0, 0.8]
    v[7] = -1e5, 0, 0      # it leaves
    write_balls(tmp_path / "balls.data", x, d, v, BOX)
    log = run_deck(flight_head() + DEPOSIT.replace("\n", f" {motion}\n") + "run 10\n"
                   + 'print "fast: $(f_dep[11]:%.17g)"\n', tmp_path, np=np_)
    found = summary(tmp_path)
    volume = d**3 / (d**3).sum()
    fast = speed > 0.1
    fast[7] = False
    assert found["motion"]["fast_share"] == pytest.approx(volume[fast].sum(), rel=1e-9)
    assert found["motion"]["fast_volume"] == pytest.approx((d[fast]**3).sum(), rel=1e-9)
    assert found["motion"]["fast_speed"] == found["motion"]["largest_speed"] == pytest.approx(speed.max())
    assert float(log.rsplit("fast: ", 1)[1].split()[0]) == pytest.approx(found["motion"]["fast_share"], rel=1e-12)
    threshold = 3.0 if motion else 0.1
    still = np.delete(np.arange(500), 7)
    moving = speed[still] > threshold
    assert found["motion"]["moving_share"] == pytest.approx((volume[still] * moving).sum() / volume[still].sum())
    assert found["motion"]["median_speed"] == pytest.approx(np.median(speed[still]), rel=0.005)


def fly(folder, fast, ending, steps=300, rest=""):
    """One ball of a hundred at a speed, the others still; the run ends as the deck says."""
    ground(folder)
    x = np.column_stack([np.arange(100) + 20.5, np.full(100, 50.5), np.full(100, 1.0)])
    v = np.zeros((100, 3))
    v[0, 2] = fast
    write_balls(folder / "balls.data", x, 1.0, v, BOX)
    run_deck(flight_head() + DEPOSIT.rstrip() + f"{rest}\n{ending}\nrun {steps}\n", folder)
    return summary(folder)


HALT = 'variable rest equal "f_dep[11] < 0.5"\nfix stop all halt 100 v_rest == 1 error continue'


@pytest.mark.parametrize("fast, ending, reason, at_rest", [
    (0.05, HALT, "halted", True),
    (0.2, HALT, "halted", False),                 # 1 % of the volume is not less than 1 %
    (0.05, "", "run completed", False),           # its duration was over: nobody looked whether it rests
    (0.2, "", "run completed", False),
    (0.05, "timer timeout 0:00:01 every 10", "time limit", False),
    (0.05, HALT.replace("== 1", "== 2") + "\ntimer timeout 0:00:01 every 10", "time limit", False),
    (0.05, f"{HALT}\ntimer timeout 1:00:00 every 10", "halted", True),
])
def test_at_rest(tmp_path, fast, ending, reason, at_rest):
    found = fly(tmp_path, fast, ending, steps=100000000 if reason == "time limit" else 300)
    assert found["stop"]["reason"] == reason and found["at_rest"] is at_rest
    assert found["moving"] is False
    assert found["stop"]["step"] == {"halted": 100, "run completed": 300}.get(reason, found["step"]) < 100000000


@pytest.mark.parametrize("share, at_rest", [(None, False), (0.01, False), (0.0101, True), (0.1, True), (0.005, False)])
def test_the_limit_of_rest_is_the_decks(tmp_path, share, at_rest):
    """One ball of a hundred is fast."""
    found = fly(tmp_path, 0.2, HALT, rest="" if share is None else f" rest {share}")
    assert found["motion"]["fast_share"] == pytest.approx(0.01) and found["motion"]["rest_share"] == (share or 0.01)
    assert found["stop"]["reason"] == "halted" and found["at_rest"] is at_rest


@pytest.mark.parametrize("first, second", [(0.01, 0.03), (0.03, 0.01)])
def test_the_limit_of_rest_after_a_restart_is_that_of_its_deck(tmp_path, first, second):
    fly(tmp_path, 0.2, f"{HALT}\nrestart 100 cut.*.restart", rest=f" rest {first}")
    assert summary(tmp_path)["at_rest"] is (first > 0.01)
    again = flight_head().replace("read_data balls.data", "read_restart cut.100.restart")
    run_deck(again + DEPOSIT.rstrip() + f" rest {second}\n{HALT}\nrun 300\n", tmp_path)
    found = summary(tmp_path)
    assert found["motion"]["rest_share"] == second and found["at_rest"] is (second > 0.01)
    assert found["stop"]["reason"] == "halted"


def test_files_in_a_run_are_not_at_rest(tmp_path):
    ground(tmp_path)
    write_balls(tmp_path / "balls.data", [[50, 50, 1]], 1.0, None, BOX)
    run_deck(flight_head() + DEPOSIT.replace("10 0", "10 20")
             + "variable step equal step\nfix crash all halt 50 v_step >= 50 error hard\nrun 60\n", tmp_path,
             expect_error="Fix halt condition for fix-id crash")
    found = summary(tmp_path)
    assert found["stop"]["reason"] == "running" and found["at_rest"] is False
