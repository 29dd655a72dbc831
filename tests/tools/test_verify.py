"""tools/slope verify: what it judges, writes and says; on claims made up here and a program that stands for lmp."""
import csv
import types
from pathlib import Path

import pytest
import yaml

from run_helpers import TOP, run_command, examples

from slope_tools.errors import SlopeError
from slope_tools.validation import verification, verify
from slope_tools.validation.verification import claims
from slope_tools.validation.verification.claims import AtLeast, AtMost, Between, Claim, Control, Near, Run, Verdict
from slope_tools.validation.verification.errata import errata
from slope_tools.validation.verification.restitution import observed

LMP = """#!/bin/sh
# prints what -var e says; fails on e none
while [ $# -gt 1 ]; do [ "$1" = -var ] && [ "$2" = e ] && e=$3; shift; done
echo "LAMMPS (29 Sep 2021)" > log.lammps
[ $e = none ] && { echo "ERROR: there is no e (src/input.cpp:1)" >> log.lammps; exit 1; }
echo x >> ../../../count
echo "restitution: observed $e" >> log.lammps
"""
DROP = Run("01_restitution/in.restitution")


def claim(name="bounce", e=0.25, broken=0.3, **more):
    return Claim(name, "A ball <bounces>", "m", "paper, Table 2", (DROP(e=e),), observed, Near(0.25, 0.003),
                 Control("another e", (DROP(e=broken),)), **more)


@pytest.fixture
def slope(here, capsys, monkeypatch):
    """Run `slope verify ARGUMENTS` on claims; gives status, stdout, stderr."""
    lmp = here / "lmp"
    lmp.write_text(LMP)
    lmp.chmod(0o755)
    monkeypatch.setenv("LMP", str(lmp))

    def run(arguments, *made):
        doc = "A ball rebounds\n\nIt falls on\nanother one."
        case = types.SimpleNamespace(CASE="01_restitution", CLAIMS=made or (claim(),), __doc__=doc)
        monkeypatch.setattr(verification, "cases", lambda: [case])
        return run_command("verify", arguments, capsys)
    return run


def told():
    return yaml.safe_load(Path("verification/verification.yaml").read_text())


def lines_of(path):
    return Path(path).read_text().count("x") if Path(path).exists() else 0


def test_what_is_finished_is_kept(slope):
    """The same runs are not made again; those of another program, deck or value are."""
    slope("-o verification")
    assert lines_of("count") == 2 and told()["kept"] == 0
    slope("-o verification")
    assert lines_of("count") == 2 and told()["kept"] == 2 and told()["passed"] == 1
    assert "2, 2 of them made before" in Path("verification/verification.html").read_text()
    slope("-o verification", claim(broken=0.35))
    assert lines_of("count") == 3 and told()["kept"] == 1
    slope("-o verification", Claim("bounce", "A ball", "m", "paper", (DROP(("0.25", "0.250"), e=0.25),), observed,
                                   Near(0.25, 0.003), Control("another e", (DROP(e=0.3),))))
    assert lines_of("count") == 4       # its folder has another name
    program = Path("lmp")
    program.write_text(program.read_text() + "# another one\n")
    slope("-o verification")
    assert lines_of("count") == 6 and told()["kept"] == 0


def test_a_run_that_failed_is_made_again(slope):
    status, _, err = slope("-o verification", claim(broken="none"))
    assert status == 2 and "there is no e" in err
    finished = {path.parent.name for path in Path("verification/runs").glob("*/finished")}
    assert finished == {"01_restitution.restitution_e_0.25"}
    Path("verification/runs/01_restitution.restitution_e_0.25/finished").write_text("of another program\n")
    slope("-o verification")
    assert lines_of("count") == 3


def test_all_is_well(slope):
    status, out, err = slope("-o verification")
    assert status == 0 and "all 1 claims hold" in out and "FAIL" not in out, err
    about = told()
    assert (about["claims"], about["passed"], about["controls_that_fail"], about["runs"]) == (1, 1, 1, 2)
    assert about["lammps"] == "LAMMPS (29 Sep 2021)" and len(about["lmp_sha256"]) == 64 and about["processor"]
    row, = about["results"]
    assert (row["got"], row["control_got"], row["passed"], row["control_fails"]) == (0.25, 0.3, True, True)
    assert (row["expected"], row["tolerance"], row["source"]) == ("0.25", "0.003", "paper, Table 2")
    assert row["commands"] == ["lmp -in in.restitution -var e 0.25"]
    with open("verification/verification.csv", newline="", encoding="ascii") as lines:
        line, = csv.DictReader(lines)
    assert float(line["got"]) == 0.25 and line["passed"] == "True" and line["claim"] == "A ball <bounces>"
    assert Path("verification/runs/01_restitution.restitution_e_0.25/in.restitution").is_file()


def test_the_pages(slope):
    assert slope("-o verification", claim(remark="Seen & noted."))[0] == 0
    html, rst = (Path(f"verification/verification.{kind}").read_text() for kind in ("html", "rst"))
    assert "A ball &lt;bounces&gt;" in html and "Seen &amp; noted." in html and "FAIL" not in html
    assert "<h2>01_restitution: A ball rebounds</h2>" in html and "It falls on another one." in html
    assert rst.isascii() and "A ball rebounds\n---------------\n" in rst and "* A ball <bounces>: Seen & noted." in rst
    assert "`A ball rebounds`_\n     - 1\n     - 1\n     - 1\n" in rst
    assert '"A ball <bounces> (m)","paper, Table 2","0.25","0.003","0.25","yes","another e: 0.3"' in rst
    assert "lmp -in in.restitution -var e 0.25" in html
    for page in (html, rst):
        assert "0.344" in page and "8.41e+05" in page and "3.5 tan(10) = 0.617" in page and "1.19e+06 N s/m" in page


PEERS = """\
crosscheck: {finished: today, package: v1, versions: {granular: LAMMPS 1, slope: SLOPE 1}, compared: 1, failed: 1}
checks:
- {case: bounce, quantity: "rebound of <two>", code: granular, value: 0.51234, against: plain, expected: 0.48,
   tolerance: 0.01, passed: false}
- {case: roll, quantity: threshold, code: slope, value: rolls, against: plain, expected: rolls, tolerance: null,
   passed: null}
differs: {granular: [in the dashpots]}
"""


def test_comparisons_with_other_codes_go_into_the_report(succeed):
    Path("peers.yaml").write_text(PEERS)
    succeed("--crosscheck peers.yaml")
    for name, wrong in (("verification.rst", "**NO**"), ("verification.html", "FAIL")):
        page = Path("verification", name).read_text()
        assert "0 of 1 comparisons are within their tolerance" in page and wrong in page
        assert "0.51234" in page and "granular: in the dashpots" in page and "granular: LAMMPS 1" in page
    assert "rebound of &lt;two&gt;" in page


def test_a_broken_comparison_is_one_line(slope):
    Path("peers.yaml").write_text("crosscheck: {}\nchecks: 3\n")
    status, _, err = slope("--crosscheck peers.yaml")
    assert status == 2 and err.startswith("slope verify: peers.yaml: must be what `slope crosscheck` wrote")
    assert len(err.splitlines()) == 1 and not Path("verification").exists()


@pytest.mark.parametrize("wrong", [claim(e=0.26), claim(broken=0.251), claim(broken="nan")],
                         ids=["the claim", "its control passes", "its control gives nothing"])
def test_what_does_not_hold_is_status_2(slope, wrong):
    status, out, err = slope("-o verification", claim("good"), wrong._replace(name="bad"))
    assert status == 2
    assert err.splitlines()[-1].endswith("1 of 2 claims do not hold or have a control that does not fail: bad")
    assert "FAIL 01_restitution bad" in out and "pass 01_restitution good" in out
    assert "fail" in Path("verification/verification.html").read_text()
    assert [row["passed"] and row["control_fails"] for row in told()["results"]] == [True, False]


def test_a_run_of_several_claims_is_run_once(slope):
    assert slope("--jobs 3", claim("a"), claim("b"), claim("c", broken=0.4))[0] == 0
    assert Path("count").read_text() == "x\n" * 3


def test_two_modules_of_one_folder(slope, capsys, monkeypatch):
    cases = [types.SimpleNamespace(CASE="01_restitution", CLAIMS=(claim(name),), __doc__=f"Title {name}\n\nIt falls.")
             for name in "ab"]
    monkeypatch.setattr(verification, "cases", lambda: cases)
    assert run_command("verify", "-o verification", capsys)[0] == 0
    assert [row["name"] for row in told()["results"]] == ["a", "b"]
    html = Path("verification/verification.html").read_text()
    assert html.count("A ball &lt;bounces&gt;") == 2 and html.index("Title a") < html.index("Title b")


def test_quick_leaves_out_what_takes_minutes(slope):
    assert slope("--quick", claim("a"), claim("b", quick=False))[0] == 0
    assert [row["name"] for row in told()["results"]] == ["a"]
    assert told()["command"] == "tools/slope verify --quick"


def test_a_run_that_fails_is_one_line(slope):
    status, out, err = slope("--jobs 1", claim(e="none"))
    assert (status, out) == (2, "") and err.splitlines()[-1].startswith(
        "slope verify: verification/runs/01_restitution.restitution_e_none/log.lammps: must end without an error: "
        "ERROR: there is no e, got status 1")
    assert not Path("verification/verification.yaml").exists()


@pytest.mark.parametrize("arguments, message", [
    ("--only 99_none", "--only: must be of 01_restitution, got 99_none"),
    ("--lmp none", "--lmp: must lead to the LAMMPS program"),
    ("-o lmp", "-o: must be a folder, got lmp"),
    ("--quick --only 01_restitution", "--only: has no claims that are quick, got 01_restitution"),
])
def test_bad_input_is_one_line(slope, arguments, message):
    status, out, err = slope(arguments, claim(quick=False))
    assert (status, out) == (2, "") and err.count("\n") == 1 and message in err
    assert not Path("verification").exists()


# --- claims ---

@pytest.mark.parametrize("bound, good, bad, texts", [
    (Near(2.0, 0.1), (1.91, 2.09), (1.89, 2.11, float("nan")), ("2", "0.1")),
    (Near(-2.0, 0.1, True), (-1.81, -2.19), (-1.79, -2.21), ("-2", "10 %")),
    (Between(2.0, 4.0), (2.0, 4.0), (1.99, 4.01), ("2 to 4", "in the range")),
    (Between(2.0, 4.0, 0.1), (1.8, 4.4), (1.79, 4.41), ("2 to 4", "10 %")),
    (AtMost(1e-3), (0.0, 1e-3), (2e-3, float("nan")), ("0", "0.001")),
    (AtLeast(2.0), (2.0, 3.0), (1.9, float("nan")), (">= 2", "one-sided")),
    (Verdict("stays"), ("stays",), ("rolls",), ("stays", "the same")),
])
def test_bounds(bound, good, bad, texts):
    assert all(bound.holds(got) for got in good) and not any(bound.holds(got) for got in bad)
    assert bound.texts() == texts


def test_a_run(tmp_path):
    one = DROP(("timestep        ${dt}", "timestep 1e-6"), e=0.3)(g=1)
    assert one.options == ["-var", "e", "0.3", "-var", "g", "1"]
    assert one.command == "lmp -in in.restitution -var e 0.3 -var g 1   # timestep        ${dt} -> timestep 1e-6"
    assert one.name.startswith("01_restitution.restitution_e_0.3_g_1_changed_")
    one.write(tmp_path / "run")
    assert sorted(path.name for path in (tmp_path / "run").iterdir()) == ["fixed_ball.xyz", "in.restitution"]
    assert "\ntimestep 1e-6\n" in (tmp_path / "run" / "in.restitution").read_text()
    with pytest.raises(SlopeError, match="in.restitution: must have what a control replaces, got 'none of it'"):
        DROP(("none of it", "")).write(tmp_path / "other")


def test_frames(tmp_path):
    (tmp_path / "a.dump").write_text("".join(
        f"ITEM: TIMESTEP\n{step}\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS ff ff ff\n0 1\n0 1\n0 1\n"
        f"ITEM: ATOMS id x\n1 {step}\n2 7\n" for step in (0, 5)))
    assert claims.read_claim_frames(tmp_path / "a.dump")["x"].tolist() == [[0, 7], [5, 7]]


# --- the page ---

def test_the_page_holds_every_claim_against_its_present_bound():
    lines = (TOP / "doc" / "src" / "verification.rst").read_text(encoding="ascii").splitlines()
    page = {row[0]: tuple(row[2:4]) for row in csv.reader(line.strip() for line in lines if line.startswith('   "'))}
    for one in verification.all_claims():
        assert page[one.text + f" ({one.unit})" * bool(one.unit)] == one.bound.texts(), one.name


def test_the_page_has_every_erratum():
    page = (TOP / "doc" / "src" / "verification.rst").read_text(encoding="ascii")
    shown = page[page.index("Errata of the paper"):page.index("\nA dropped ball")]
    assert shown.count("  Printed: ") == len(errata())
    assert all(f"**{one.title}.**  Printed: {one.printed}  {one.right}\n" in shown for one in errata())


def test_the_page_has_the_second_table_of_the_paper():
    """As a report has it, of the case's file of reference values."""
    page = (TOP / "doc" / "src" / "verification.rst").read_text(encoding="ascii")
    section = page[page.index("The paper's second Table 5\n---"):page.index("\nA dropped ball")]
    shown = list(csv.reader(line.strip() for line in section.splitlines() if line.startswith('   "')))
    about = verify.second_table()
    assert shown == about["rows"] and ["company J", "24,048", "26,009", "22,340"] in shown
    assert len(shown) >= 5 and about["remark"] in " ".join(section.split())


@pytest.mark.parametrize("command", examples("verify"))
def test_every_example_of_the_page_and_the_help_runs(succeed, command):
    command = command.replace("11_column_collapse", "01_restitution")
    succeed(command)
