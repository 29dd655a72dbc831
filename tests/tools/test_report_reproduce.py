"""slope report --reproduce, the settings on the page, the table of what a report must hold against page and tests."""
import argparse
import ast
import hashlib
import html
import re
import subprocess
from pathlib import Path

import pytest
import yaml

import test_report
from tiny_collapse import TOP

from slope_tools import cli
from slope_tools.report import run_part

made, here, slope = test_report.made, test_report.here, test_report.slope       # its fixtures
REQUIREMENTS = TOP / "doc" / "src" / "report_requirements.rst"


def test_what_a_reviewer_needs(slope, here):
    before = set(here.rglob("*"))
    status, out, err = slope("repeated --reproduce")
    assert (status, err) == (0, "") and set(here.rglob("*")) == before       # no page
    about = yaml.safe_load(Path("repeated/study.yaml").read_text())
    command = next(line for line in out.splitlines() if line.startswith("tools/slope study"))
    assert command == ("tools/slope study in.tiny --set rolling=0,0.3 --set steps=1200 --repeat seed=1,2 --road "
                       "road.csv --local --cut-angle 30 --mesh 4 -o repeated")
    for k, row in enumerate(about["runs"], 1):
        told = yaml.safe_load(Path(f"repeated/{row['run']}/variables.yaml").read_text())["command"]
        assert f"cd repeated/{row['run']} && {told}    # run {k}, " in out
    for word in ("LAMMPS: ", "numpy: ", "SHA-256 of the program: "):
        assert word in out
    listed = dict(reversed(line.split("  ")) for line in out.splitlines() if re.match(r"[0-9a-f]{64}  ", line))
    assert {"study.yaml", "study.csv"} < set(listed) and any(name.endswith("in.tiny") for name in listed)
    for name, digest in listed.items():
        assert hashlib.sha256((here / "repeated" / name).read_bytes()).hexdigest() == digest
    checked = subprocess.run(["sha256sum", "-c"], input=out[out.index("# checksums"):], cwd="repeated", text=True,
                             check=False, capture_output=True)
    assert checked.returncode == 0 and checked.stdout.count(": OK") == len(listed)


def test_a_run_by_hand_is_listed_too(slope, here):
    status, out, _ = slope("one --reproduce")
    assert status == 0 and "by hand" in out and "tiny.summary.yaml" in out


def test_a_site_is_made_again_from_its_file(slope, here):
    (here / "site.yaml").write_text(yaml.safe_dump({"found": {"sources_sha256": {"../dem.tif": "ab" * 32}}}))
    status, out, _ = slope("out --reproduce")
    assert status == 0 and "tools/slope site ." in out.splitlines() and "ab" * 32 + "  ../dem.tif" in out.splitlines()


def test_settings_have_a_meaning(slope, here):
    assert slope("out")[0] == 0
    _, reader = test_report.read("out/report.html")
    rows = {row[0]: row[1:] for table in reader.tables for row in table if len(row) == 3}
    assert rows["friction"] == ["30", "degrees"] and rows["cell"] == ["1.0", "m"]
    assert run_part.with_meanings({"d": "2", "seed (deck's default)": "0"}, "variable  d index 1 # ball, m\n") == [
        ("d", "2", "ball, m"), ("seed (deck's default)", "0", run_part.TERMS["seed"])]


def test_provenance_on_the_page(slope, here):
    assert slope("out")[0] == 0
    text = html.unescape(Path("out/report.html").read_text(encoding="utf-8"))
    part = text[text.index('id="provenance"'):]
    run = yaml.safe_load(Path("out/study.yaml").read_text())["conservative"]["run"]
    about = yaml.safe_load(Path(f"out/{run}/variables.yaml").read_text())
    inputs = yaml.safe_load(Path(f"out/{run}/finished.yaml").read_text())["inputs"]
    for value in (about["lmp_sha256"], about["command"], *inputs.values()):
        assert value in part


# --- what a report must hold ---

def rows():
    """(requirement, where, test) of the table."""
    table = REQUIREMENTS.read_text(encoding="ascii").split(".. list-table::")[1].split('"""')[0]
    found = [tuple(" ".join(cell.split()) for cell in re.split(r"\n     - ", row))
             for row in re.split(r"\n   \* - ", table)[2:]]
    return [(what, where, test.split("``")[1]) for what, where, test in found]


def test_there_is_a_table():
    assert len(rows()) >= 20 and len({what for what, _, _ in rows()}) == len(rows())


@pytest.mark.parametrize("what, where, test", rows(), ids=lambda text: text[:30])
def test_the_table_names_tests_and_places_that_are_there(what, where, test):
    file, name = test.split("::")
    tree = ast.parse((TOP / "tests" / "tools" / file).read_text(encoding="utf-8"))
    assert name in {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}, what
    if where.startswith("``#"):
        place, page = where.strip("`#"), Path(run_part.__file__).parent
        assert any(f'id="{place}"' in file.read_text(encoding="utf-8") for file in page.glob("*.j2")) or any(
            f'Section("{place}"' in file.read_text(encoding="utf-8") for file in page.glob("*_part.py")), what
    elif where.startswith("*--"):
        parser = cli.add_command(argparse.ArgumentParser().add_subparsers(), "report", cli.module_of("report", None))
        assert where.strip("*") in parser.format_help().split(), what
