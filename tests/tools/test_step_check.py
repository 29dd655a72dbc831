"""What half the time step changes, against the runs that are otherwise the same."""

import pytest

from made_rows import row

from slope_tools.errors import SlopeError
from slope_tools.tables import combinations, step_check
from slope_tools.tables.step_check import Step


def groups():
    return combinations.grouped([
        row(run=f"{rolling}_{k}", set={"rolling": rolling}, repeat={"seed": str(k)}, remove_m3=volume, front_m=volume)
        for rolling, several in (("0", (90.0, 100, 110)), ("0.1", (56.0, 64, 72))) for k, volume in enumerate(several)])


@pytest.mark.parametrize("volume, within, words", [
    (120.0, True, "half the time step, rolling 0: 120 m3 instead of 100 to remove, +20.0 %; no more than chance "),
    (155.0, False, "+55.0 %; more than chance explains, "), (45.0, False, "-55.0 %; more than chance")])
def test_half_the_step_against_the_mean_and_chance(volume, within, words):
    entry, doubts = step_check.compare(Step("0", volume), groups())
    # s is 10, and 8 sqrt(100/64); all repeats are alike, 2 degrees of freedom: t(0.975, 2) s sqrt(1 + 1/3)
    assert entry.chance_m3 == pytest.approx(4.302653 * 10 * (4 / 3) ** 0.5)
    assert entry.mean_m3 == 100 and entry.within_chance is within and words in entry.text
    assert [(one.kind, one.text, one.numbers["volume"]) for one in doubts] == (
        [] if within else [("half step", entry.text, str(int(volume)))])


def test_runs_on_another_ground_are_not_compared():
    rows = [row(run=spacing, set={"rolling": "0", "spacing": spacing}, remove_m3=volume, front_m=volume)
            for spacing, volume in (("0.5", 300.0), ("0.9", 100.0))]
    both = combinations.grouped(rows)
    assert step_check.compare(Step("0", 100.0, spacing="0.9"), both)[0].mean_m3 == 100
    assert step_check.compare(Step("0", 100.0, spacing="0.7"), both)[0].mean_m3 is None
    assert step_check.compare(Step("0", 100.0, spacing="0.7"), groups())[0].mean_m3 == 100


def test_nothing_is_said_in_words():
    rows = [row(run=str(k), set={"rolling": "0"}, repeat={"seed": str(k)}, remove_m3=0.0) for k in range(3)]
    entry, _ = step_check.compare(Step("0", 0.0), combinations.grouped(rows))
    assert entry.text == "half the time step, rolling 0: nothing to remove, as with the whole step"
    assert entry.within_chance is True and entry.chance_m3 == 0


def test_without_repeats_chance_is_unknown():
    entry, _ = step_check.compare(Step("0.1", 65.0), [group for one in groups() for group in combinations.grouped(
        one.rows[1:2])])
    assert entry.within_chance is None and entry.text.endswith("instead of 64 to remove, +1.6 %; chance unknown")


def test_a_run_that_was_not_made_says_why():
    entry, _ = step_check.compare(Step("0", None, "the disk is full"), groups())
    assert entry.text == "half the time step: not tried: the disk is full"
    entry, _ = step_check.compare(Step("0.2", 5.0), groups())
    assert entry.text == "half the time step: not tried: no run with the same values finished"


def written(here, *rows):
    path = here / "site.energy"
    path.write_text("# Time-averaged data for fix spent\n# TimeStep f_ledger[1]\n"
                    + "".join(" ".join(map(str, row)) + "\n" for row in rows))
    return path


def test_where_the_energy_went(tmp_path):
    path = written(tmp_path, [0] + 11 * [0], [100, 1e6, 2e9, 0, 3e6, 1e8, 7e8, 1.9e8, 1e7, 1e3, 0, 5e5])
    spent = step_check.read_energies(path)
    assert (spent["sliding"], spent["residual"], spent["left"]) == (7e8, 1e3, 5e5)
    assert spent["text"] == (
        "of 2.00 GJ that weight and ground motion put in, 1.00 GJ was taken: 70 % by sliding, 19 % by rolling "
        "resistance, 10 % by impacts (normal dashpots), 1 % by the finite step at the start and end of contacts; "
        "500 kJ left with balls; not accounted for: less than 0.01 %")


def test_the_columns_of_an_energy_file_are_those_of_its_head(tmp_path):
    """Any order of f_ID[1] to f_ID[11] is right, other columns are refused."""
    values = [0, 1e6, 2e9, 0, 3e6, 1e8, 7e8, 1.9e8, 1e7, 1e3, 0, 5e5]
    order = [6, 1, 2, 3, 4, 5, 11, 7, 8, 9, 10]
    path = written(tmp_path, [0] + [values[k] for k in order])
    path.write_text(path.read_text().replace("f_ledger[1]", " ".join(f"f_ledger[{k}]" for k in order)))
    spent = step_check.read_energies(path)
    assert (spent["sliding"], spent["left"], spent["kinetic"]) == (7e8, 5e5, 1e6)
    for names in (" ".join(["v_kinetic"] + 10 * ["v_x"]), " ".join(11 * ["f_ledger[1]"]), "f_ledger[2] f_ledger[1]",
                  " ".join(f"f_ledger[{k}]" for k in range(2, 13)),
                  " ".join(["f_a[1]"] + [f"f_b[{k}]" for k in range(2, 12)])):
        path = written(tmp_path, values)
        path.write_text(path.read_text().replace("f_ledger[1]", names))
        with pytest.raises(SlopeError, match="site.energy: must be what the run wrote of its energy"):
            step_check.read_energies(path)


def test_the_energy_of_a_continued_run_is_not_known(tmp_path):
    assert step_check.read_energies(written(tmp_path, [300] + 11 * [1])) is None


def test_a_file_of_the_energy_that_is_damaged_is_named(tmp_path):
    for rows in ([[0] + 10 * [1]], [[0] + 10 * [1] + ["nan"]]):
        with pytest.raises(SlopeError, match="site.energy: must be what the run wrote of its energy"):
            step_check.read_energies(written(tmp_path, *rows))


@pytest.mark.parametrize("variables, half", [({"step": "1.0"}, "0.5"), ({"step": "1.5"}, "0.75"), ({}, "0.5")])
def test_half_the_step_is_half_of_the_decks(variables, half):
    assert step_check.half_of(variables) == half
    assert step_check.compare(Step("0", 100.0, step=float(half)), groups())[0].step == float(half)


def test_a_step_that_is_no_number_is_refused():
    with pytest.raises(SlopeError, match="^step of the deck: must be a number, got "):
        step_check.half_of({"step": "${fine}"})
