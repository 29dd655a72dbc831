"""When the conservative volume is withheld: each rule alone, none, and several; the words; what left before a road."""
import argparse
import re
import shlex
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest

import made_study
from made_rows import changed, row

from run_helpers import TOP

from slope_tools import cli, options
from slope_tools.commands.study import Request
from slope_tools.case.settings import check_settings, one_value_each
from slope_tools.deposits.passed import CLOSE
from slope_tools.ensembles import sample
from slope_tools.statistics import distributions, withheld
from slope_tools.statistics.entries import Code
from slope_tools.statistics.withheld import Facts, Kind
from slope_tools.studies import outcome
from slope_tools.tables import combinations, next_step, usable
from slope_tools.tables.how_far import EventsAtRoad
from slope_tools.tables.usable import Case

GOOD = Facts(volume=5000.0, on_road=3000.0, ball=10.0, runs=20, failed=0, moving=0, left=0.0, length=900.0,
             median=800.0)
STUDY = Request(deck=Path("my site"))
SITE = Case(Path("site/in.site"), Path("my site"), {"friction": "30", "rolling": "0.1", "d": "2"}, 1000, given=STUDY)
PAPER, SAMPLED = SITE._replace(given=replace(STUDY, paper=True)), SITE._replace(sampled=True, given=None)
DECK = Case(Path("in.slope"), None, {"d": "2", "duration": "60"}, 1000)


@pytest.mark.parametrize("changed, kinds", [
    ({}, []),
    ({"on_road": 99.0}, [Kind.BALLS]),                                  # 9.9 balls
    ({"on_road": 100.0}, []),
    ({"length": 799.0}, [Kind.MOBILITY]),
    ({"length": 100.0, "median": None}, []),                            # no set covers the mass
    ({"left": 0.011}, [Kind.LEFT]),
    ({"left": 0.01}, []),
    ({"failed": 1, "moving": 2}, [Kind.RUNS]),                          # 15 %
    ({"moving": 2}, []),                                                # 10 %
    ({"volume": 0.0, "on_road": 0.0}, []),                              # nothing to count balls of
    ({"volume": 0.0, "on_road": 0.0, "length": 1.0, "left": 0.5, "failed": 20},
     [Kind.MOBILITY, Kind.LEFT, Kind.RUNS])])
def test_each_rule(changed, kinds):
    assert [one.kind for one in withheld.reasons(GOOD._replace(**changed))] == kinds


ANEW = "tools/slope site 'my site'{} && tools/slope study 'my site' --anew"


@pytest.mark.parametrize("changed, case, text, remedy", [
    ({"on_road": 50.0}, SITE, "on the road lies the volume of 5 balls, fewer than 10", ANEW.format(" --balls 2200")),
    ({"on_road": 95.0}, SITE._replace(balls=120), "9.5 balls", ANEW.format(" --balls 240")),
    ({"on_road": 99.0}, DECK, "9.9 balls", "the same command with --set d=1.59"),
    ({"on_road": 50.0}, DECK, "5 balls", "the same command with --set d=1.54"),
    ({"length": 700.0}, SITE, "no run reaches 800 m, as half of known events of this volume and height do; the longest "
     "one ends at 700 m", "tools/slope study 'my site' --sample 64 --known rock_avalanches"),
    ({"length": 700.0}, DECK, "no run reaches", "a calibration with a past event: tools/slope calibrate --help"),
    ({"length": None}, DECK, "no run reaches 800 m, as half of known events of this volume and height do; there is no "
     "deposit", "a calibration with a past event: tools/slope calibrate --help"),
    ({"length": 700.0}, DECK._replace(variables={"friction": "30"}), "no run reaches", "the same command with "
     "--sample 64 --known rock_avalanches --vary friction=10:30 instead of --set"),
    ({"left": 0.3}, SITE, "30 % of the released volume left the terrain before, beside or on the road, more than 1 %",
     "a larger elevation model (terrain.files, terrain.bounds) in 'my site'/site.yaml, then: " + ANEW.format("")),
    ({"on_road": 10.0}, PAPER, "the volume of 1 ball, fewer than 10",
     ANEW.format(" --balls 11000").replace("--anew", "--anew --paper")),
    ({"left": 0.3}, SAMPLED, "30 %", "a larger elevation model (terrain.files, terrain.bounds) in "
     "'my site'/site.yaml, then: tools/slope site 'my site'; the same command with --anew"),
    # of the ensemble that `slope study SITE` makes
    ({"moving": 5}, SITE._replace(sampled=True), "5 of 20 runs failed or are not at rest",
     "more time (model.duration) in 'my site'/site.yaml, then: " + ANEW.format("")),
    ({"moving": 5}, DECK, "5 of 20 runs failed or are not at rest at the end, more than 10 %",
     "the same command with --set duration=120"),
    ({"failed": 5}, DECK, "5 of 20 runs", "once the cause of the failures is removed: the same command again")])
def test_the_reason_and_the_command_that_mends_it(changed, case, text, remedy):
    [entry] = usable.with_remedies(withheld.reasons(GOOD._replace(**changed)), case)
    assert text in entry.text and entry.remedy == remedy


@pytest.mark.parametrize("case", [SITE, PAPER, SAMPLED, DECK,
                                  DECK._replace(variables={"friction": "30", "rolling": "0"})])
@pytest.mark.parametrize("changed", [{"on_road": 50.0}, {"length": 700.0}, {"left": 0.3}, {"moving": 5}])
def test_the_commands_are_ones_that_the_tools_take(case, changed):
    [entry] = usable.with_remedies(withheld.reasons(GOOD._replace(**changed)), case)
    typed = re.findall(r"tools/slope (?:'[^']*'|[^&;,])*", entry.remedy)
    assert typed or case.site is None or case.sampled
    for words in map(shlex.split, typed):
        parser = argparse.ArgumentParser()
        cli.add_command(parser.add_subparsers(), words[1], cli.module_of(words[1], parser))
        try:
            parser.parse_args(words[1:])
        except SystemExit as error:
            assert error.code == 0 and words[2:] == ["--help"]


# --- every command that is proposed, on every kind of answer ---

REASONS = [("terrain ends", {"share": 0.1, "path_m": 100.0}), ("no more runs", {"points": 8}), ("too few runs", {}),
           ("range ends", {"ends": {"friction": "20", "packing": "1"}}), ("range ends", {"ends": {}}),
           *(("size of balls", {"sizes": sizes, "grown": grown}) for sizes, grown in ((1, None), (3, 0.3))),
           *(("rule", {"source": source, "rule": rule.value, "number": 5, "bound": 10}) for rule in Kind
             for source in ("paper", "ensemble"))]
DECK_OF_ALL = ("variable  rolling  index 0.1  # 0 <= rolling\nvariable  friction index 30  # 0 <= friction < 90\n"
               "variable  packing  index 1  # 1 <= packing <= 1000000\nvariable  d index 2\n"
               "variable  duration index 60\n"
               "variable  spacing  index 0.8\nfix a all deposit/grid 1 1 cell 1 terrain a output a\n")
ASKED = ["in.all --set rolling=0:0.2:0.1 --repeat packing=5,6 -o out --equally-good packing --road road.csv",
         "in.all --set rolling=0,0.1 --levels d=2,1 --road road.csv --road-width 7.5 --more-than 5,10 -o out",
         "in.all --sample 8 --vary friction=20:40 --vary packing=1:1000000 --set rolling=0 --road 'a road.csv' -o out",
         "in.all --sample 8 --vary friction=triangular:10:20:30 --vary rolling=0:0.2 --known rock_avalanches "
         "-o 'my out' --slurm=--time=1 --engine slurm --road road.csv", "'my site'", "'my site' --paper --np 2",
         "'my site' --sample 8 --vary friction=5:30 --vary packing=1:1000000 --known own --levels 2"]


def typed_in(text):
    """The commands in a line, as a shell would split them."""
    return [shlex.split(one) for one in re.findall(r"tools/slope (?:'[^']*'|[^&;'])*", text)]


def parsed(words):
    parser = argparse.ArgumentParser()
    cli.add_command(parser.add_subparsers(), words[1], cli.module_of(words[1], parser))
    return options.request(cli.module_of(words[1], parser).Request, parser.parse_args(words[1:]))


def check_proposed(text):
    """Each command is taken by its parser, and a study's settings by the checks of the deck; no placeholder is left."""
    assert not re.search(r"tools/slope.*(\.\.\.|\b(ROAD|DIR|DECK|SITE)\b)", text), text
    for words in typed_in(text):
        if words[2:] == ["--help"]:
            continue
        asked = parsed(words)
        if words[1] != "study" or asked.deck.suffix != ".all":
            assert words[2] == "my site"
            if words[1] == "study":
                [distributions.distribution(*one.split("=", 1), "--vary", one) for one in asked.vary]
            continue
        fixed, repeated = (check_settings(getattr(asked, name), asked.deck, f"--{name}") for name in ("set", "repeat"))
        if asked.sample or asked.vary:
            sample.check_sample(asked.sample, "sobol", 1, asked.vary, asked.deck,
                                one_value_each(fixed, "--set", "--vary"), repeated)
        else:
            assert fixed and not asked.known


@pytest.mark.parametrize("given", ASKED)
def test_what_is_proposed_can_be_run(here, given):
    Path("in.all").write_text(DECK_OF_ALL)
    asked = parsed(["tools/slope", "study", *shlex.split(given)])
    assert parsed(["tools/slope", "study", *options.words_of(asked)]) == asked
    site = asked.deck if asked.deck.name == "my site" else None
    if site:
        site.mkdir()
        (site / "site.yaml").touch()
    variables = {"friction": "30", "rolling": "0.1", "d": "2", "duration": "60"}
    case = Case(Path("in.all"), site, variables, 1000, given=asked, sampled=bool(asked.sample))
    found = [one for facts in ({"on_road": 50.0}, {"length": 700.0}, {"left": 0.3}, {"moving": 5}, {"failed": 15})
             for one in usable.with_remedies(withheld.reasons(GOOD._replace(**facts)), case)]
    ranges = dict(one.split("=", 1) for one in asked.vary) or {
        "friction": "uniform:20:40", "rolling": "0:0.2", "spacing": "0.3:0.95", "packing": "uniform:1:1000000"}
    whole = made_study.ensemble({"set": "rock_avalanches.csv"}, withheld=found, design={
        "points": 8, "variables": ranges}) if site or asked.sample else None
    made = next_step.Made(made_study.study({"deck": "in.all"}, runs=[row(variables=variables)], ensemble=whole,
                                           conservative=made_study.conservative(1.0, withheld=found)),
                          (site or Path()) / "out", given=asked)
    for one in found:
        check_proposed(one.remedy)
    for code, numbers in REASONS:
        step = next_step.of_studies([made], made_study.headline(
            kind="floor", source="ensemble", reasons=[{"code": code, "numbers": numbers}]))
        check_proposed(str(step or ""))
        if step is None:
            assert whole is None or code == "range ends"
        else:
            assert step.line or "--vary of more mobile" in step.command, step


def test_a_range_is_made_wider_where_it_ends(here):
    """Not the seed of a packing, which has no resistance: 0.5 is none; the same ranges once more are no step."""
    whole = made_study.ensemble({"set": "rock_avalanches.csv"}, design={"points": 8, "variables": {
        "friction": "uniform:5:30", "rolling": "uniform:0:0.15", "packing": "uniform:1:1000000"}})
    made = next_step.Made(made_study.study({"deck": "in.all"}, ensemble=whole), Path("out"))
    for ends, friction in (({}, "2.5:30"), ({"friction": "5"}, "2.5:30"),
                           ({"friction": "5", "packing": "1"}, "2.5:30")):
        command = next_step.make_next_step(made, Code.RANGE, {"ends": ends}).command
        assert f"--vary friction={friction} " in command and command.endswith("--vary packing=uniform:1:1000000")
    for ends in ({"rolling": "0"}, {"packing": "friction"}):
        assert next_step.make_next_step(made, Code.RANGE, {"ends": ends}) is None


# --- of the rows of a study ---

def rows(*volumes, **more):
    return [row(**{"run": f"seed_{k}", "set": {"rolling": "0"}, "repeat": {"seed": str(k)}, "remove_m3": volume,
                   "remove_on_road_m3": volume / 2, "left_before_road_m3": 0.0, "on_road_m3": volume / 2,
                   "beyond_road_m3": 0.0, "length_m": 500.0, **more}) for k, volume in enumerate(volumes)]


def events(median, reached):
    """Known events, of which a share reaches the near edge of the road."""
    return EventsAtRoad(median, 300.0, 310.0, (reached / 2, reached), (0.0, reached / 2))


def judged(several, events=None):
    read = SimpleNamespace(rows=several, finished=several, events=events, case=SITE, draw=None, defaults={})
    return outcome.judge_conservative(outcome.Questions({"rolling": ["0"]}, {}, ()), read,
                                      combinations.grouped(several))[0]


def test_a_number_that_may_stand():
    best = judged(rows(90.0, 100, 110), events(400.0, 0.6))
    assert best.withheld == [] and best.volume_m3 > 110 and best.zero is None
    [first, *_] = combinations.describe_combinations(best)
    assert first.startswith("conservative volume to remove: ")


def test_a_number_that_is_withheld_is_nowhere():
    best = judged(rows(90.0, 100, 110), events(600.0, 0.6))
    assert best.volume_m3 is None and best.rounded["volume_m3"] is None
    lines = combinations.describe_combinations(best)
    assert lines[0] == "not usable as a number to design with:" and "no run reaches 600 m" in lines[1]
    assert not any("m3" in line for line in lines)


def test_lengths_of_runs_that_were_cut_short_are_withheld():
    """Of an ensemble without a road."""
    for short in (1, 2):
        several = [row(at_rest=k >= short) for k in range(10)]
        found = usable.reasons_of_ensemble(several, None, SITE)
        assert [one.numbers["number"] for one in found] == [2] * (short == 2)


def test_zero_has_a_probability():
    best = judged(rows(0.0, 0, 0), events(400.0, 0.25))
    assert best.volume_m3 == 0 and best.zero.exceeded_at_most == pytest.approx(1 - 0.05 ** (1 / 3))
    assert combinations.describe_combinations(best)[1] == (
        "nothing is to be removed in any of 3 runs: in another one something is with a probability of at most 63 % "
        "(95 % confidence); 25 % of known events of this volume and height go as far as the road")


# --- what left the terrain before it reached the road ---

LEFT = [{"side": "east", "volume": 30.0, "balls": 30, "where": "past", "distance": 5.0, "add": 900.0},
        {"side": "north", "volume": 12.0, "balls": 12, "where": "before", "distance": 123.4, "add": 170.0},
        {"side": "south", "volume": 8.0, "balls": 8, "where": "before", "distance": 40.0, "add": 60.0}]


def test_what_left_before_the_road_withholds_and_what_passed_it_does_not():
    several = rows(90.0, 100, 110, lost_m3=50.0, left_before_road_m3=9.0)
    assert judged(several, events(400.0, 0.6)).withheld == []
    several[1] = changed(several[1], left_before_road_m3=20.0, left=LEFT)
    [entry] = judged(several, events(400.0, 0.6)).withheld
    assert entry.text == ("2 % of the released volume left the terrain before, beside or on the road, more than 1 %: "
                          "12 m3 in the north, 123 m before the road; 8 m3 in the south, 40 m before the road")
    assert entry.remedy == ("a larger elevation model, by about 170 m in the north, about 60 m in the south "
                            "(terrain.files, terrain.bounds) in 'my site'/site.yaml, then: " + ANEW.format(""))
    several[1] = changed(several[1], left=[{**one, "where": where} for one, where in zip(LEFT, (CLOSE, "on", "past"))])
    [entry] = judged(several, events(400.0, 0.6)).withheld
    assert "30 m3 in the east" in entry.text and "12 m3 in the north" in entry.text and "south" not in entry.text


def test_where_it_is_not_known_what_left_all_of_it_withholds():
    several = rows(90.0, 100, 110, off_grid_m3=6.0, lost_m3=5.0, left_before_road_m3=None)
    [entry] = judged(several, events(400.0, 0.6)).withheld
    assert entry.text.endswith("more than 1 %: it is not known where, as the runs are of an older version")
    several = rows(90.0, 100, 110, off_grid_m3=5.0, lost_m3=5.0, left_before_road_m3=None)
    assert judged(several, events(400.0, 0.6)).withheld == []


# --- what reaches the road ---

def test_a_run_reaches_the_road_by_what_lies_there_however_small_the_lobe():
    """By a ball at least, on the road or beyond it; the length does not count."""
    several = [changed(one, on_road_m3=on, beyond_road_m3=past) for one, (on, past) in zip(
        rows(0.0, 0, 0, 0, length_m=200.0), ((0.6, 0.0), (0.6, 0.5), (0.0, 40.0), (0.0, 0.99)))]
    road = events(400.0, 0.6).road(several)
    assert road.brought._asdict() == {"runs": 4, "reach": 2, "passing": 1, "volume": 40.0, "balls": 40.0,
                                      "least_m3": 0.0, "most_m3": 0.0}
    assert not road.missed and road.longest_m == 200 < road.near_m
    several = [changed(one, on_road_m3=0.4, beyond_road_m3=0.5, length_m=900.0) for one in several]
    assert events(400.0, 0.6).road(several).missed


def test_a_run_of_which_something_is_to_be_removed_reaches_the_road():
    """By a part of a ball, or beside the road; "none reaches it" would deny what the number says."""
    several = [changed(one, on_road_m3=on, beyond_road_m3=0.0)
               for one, on in zip(rows(0.0, 19.7, 400.0), (0.0, 0.1, 0.0))]
    road = events(400.0, 0.6).road(several)
    assert (road.brought.reach, road.brought.least_m3, road.brought.most_m3) == (2, 19.7, 400.0) and not road.missed


# --- what the sources name ---

def test_commands_and_options_that_messages_name_are_there():
    """Of all commands that a text of the tools proposes: `slope NAME --option`, tools/slope NAME --option."""
    found = {}
    for path in (TOP / "tools" / "slope_tools").rglob("*.py"):
        text = re.sub(r'"\s*\n\s*f?"', "", path.read_text(encoding="utf-8"))
        for name, words in re.findall(r"(?:`slope|tools/slope) (\w+)((?:\{[^{}]*\}|[^`\"'\\\n;&{}])*)", text):
            if name in cli.COMMANDS:
                found.setdefault(name, set()).update(re.findall(r"(?<![\w-])--[a-z][\w-]*", words))
    assert len(found) > 5 and {"--anew"} <= found["study"]
    for name, named in found.items():
        parser = argparse.ArgumentParser()
        known = cli.add_command(parser.add_subparsers(), name, cli.module_of(name, parser))._option_string_actions
        assert named <= {*known, "--help"}, (name, named - {*known})
