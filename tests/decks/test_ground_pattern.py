"""Patterns of the fixed balls: scattered ones are the same on any rank, after a restart and as atoms; a plan
grid turns."""

import numpy
import pytest
from deck_helpers import dump_difference, read_dump, run_deck, write_asc
from test_ground_tiles import AGAIN, deck, heights

SCATTERED = "surface ground upper spacing 0.9 outside pit pattern scattered 5"
WHOLE = SCATTERED.replace(" outside pit", "")
TURNED = "surface ground upper spacing 0.9 outside pit angle 27 origin 3 4"


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """The runs with the balls of a file, which a rank looked for in all of the ground."""
    folder = tmp_path_factory.mktemp("patterns")
    write_asc(folder / "ground.asc", heights(), 0.0, 0.0, 2.0)
    for name, ground in (("scattered", SCATTERED), ("turned", TURNED)):
        run_deck(deck(ground=f"{ground} write {name}.xyz") + "run 0\n", folder)
        run_deck(deck(out=name, ground=f"file {name}.xyz") + "run 3000\n", folder)
    return folder


def places(path):
    return numpy.loadtxt(path)


@pytest.mark.parametrize("name, ground", [("scattered", SCATTERED), ("turned", TURNED)])
@pytest.mark.parametrize("np, settings", [
    (1, {}), (2, dict(boundary="s s fs", processors="2 1 1", balance="fix even all balance 200 1.0 shift x 5 1.05")),
    (4, dict(processors="4 1 1"))], ids=["one", "balanced", "four"])
def test_the_balls_of_the_file_are_there_wherever_a_ball_comes(site, name, ground, np, settings):
    run_deck(deck(out=f"{name}{np}", ground=ground, **settings) + "run 3000\n", site, np=np)
    expected, found = (read_dump(site / f"{name}{k}.dump") for k in ("", np))
    assert expected[3000][2, 1] - expected[0][2, 1] > 50.0
    for step in (1000, 2000, 3000):
        assert max(dump_difference(expected[step], found[step])) < 1e-6


def test_same_file_from_any_number_of_ranks(site):
    for np in (2, 4):
        run_deck(deck(ground=f"{SCATTERED} write {np}.xyz") + "run 0\n", site, np=np)
        assert (site / f"{np}.xyz").read_bytes() == (site / "scattered.xyz").read_bytes()


def test_one_ball_per_square_of_the_spacing_none_in_what_is_left_out(site):
    run_deck(deck(ground=f"{WHOLE} write whole.xyz") + "run 0\n", site)
    z = heights()
    area = (2.0 * numpy.hypot(numpy.hypot(numpy.diff(z, axis=1)[:-1], numpy.diff(z, axis=0)[:, :-1]), 2.0)).sum()
    area *= 162 * 122 / (160 * 120)     # the terrain goes on for half a cell beyond the outer heights
    assert len(places(site / "whole.xyz")) == pytest.approx(area / 0.9**2, rel=0.03)
    found = places(site / "scattered.xyz")
    assert not ((30.3 < found[:, 0]) & (found[:, 0] < 41.2) & (20.2 < found[:, 1]) & (found[:, 1] < 33.6)).any()


def test_a_grid_turns_about_its_origin(site):
    """Turned back, the balls on nodes are whole multiples of the spacing from the origin."""
    found = places(site / "turned.xyz")[:, :2] - [3, 4]
    c, s = numpy.cos(numpy.radians(27)), numpy.sin(numpy.radians(27))
    steps = numpy.c_[c * found[:, 0] + s * found[:, 1], c * found[:, 1] - s * found[:, 0]] / 0.9
    on_nodes = numpy.abs(steps - numpy.rint(steps)).max(axis=1) < 1e-9
    straight = run_deck(deck(ground=f"{TURNED.replace('27', '0')} write straight.xyz") + "run 0\n", site)
    assert "turned by" not in straight
    assert on_nodes.sum() == pytest.approx(160 * 120 / 0.9**2, rel=0.03)
    assert on_nodes.mean() > 0.9


def test_a_quarter_turn_of_a_grid_is_the_grid(site):
    for name, angle in (("none", 0), ("quarter", 90)):
        ground = f"surface ground upper spacing 1 origin 0.3 0.3 angle {angle} write {name}.xyz"
        run_deck(deck(ground=ground) + "run 0\n", site)
    none, quarter = (places(site / f"{name}.xyz") for name in ("none", "quarter"))
    inner = [rows[(rows[:, :2].min(axis=1) > 3) & (rows[:, 0] < 157) & (rows[:, 1] < 117)] for rows in (none, quarter)]
    inner = [rows[numpy.lexsort(rows.round(6).T)] for rows in inner]
    assert len(inner[0]) == len(inner[1]) > 15_000
    assert numpy.abs(inner[0] - inner[1]).max() < 1e-6


@pytest.mark.parametrize("ground", [SCATTERED, TURNED])
def test_restart_on_other_ranks(site, ground):
    run_deck(deck(out="whole", ground=ground) + "run 2000\nwrite_restart mid.restart\nrun 1000\n", site)
    run_deck(AGAIN.format(out="again", ground=ground, pit=33.7), site, np=2)
    whole, found = read_dump(site / "whole.dump")[3000], read_dump(site / "again.dump")[3000]
    assert max(dump_difference(whole, found)) < 1e-8


def test_the_same_balls_as_atoms(site):
    run_deck(deck(ground=f"{WHOLE} write whole.xyz") + f"create_balls 2 1.0 2500 {WHOLE}\n"
             "write_dump all custom atoms.dump id type x y z modify sort id format float %.17g\n", site)
    atoms = read_dump(site / "atoms.dump")[0]
    atoms, file = atoms[atoms[:, 1] == 2][:, 2:5], places(site / "whole.xyz")
    assert len(atoms) == len(file)
    assert numpy.abs(atoms - file).max() < 1e-9
