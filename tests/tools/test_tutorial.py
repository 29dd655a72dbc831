"""doc/src/tutorial.rst: its commands, typed one after the other, and what they print."""
import math
import os
import re
import subprocess
import warnings
from pathlib import Path

import pytest
import yaml

from tiny_collapse import LMP, TOP

pytestmark = pytest.mark.long
BUILD = Path(os.environ.get("SLOPE_BUILD", TOP / "build"))
NOT_HERE = ("tools/demo.sh", "FG-GML", "slope sensitivity")     # builds; the user's own file; runs for a minute
NUMBER = re.compile(r"-?\d[\d,]*(?:\.\d+)?(?:e[+-]?\d+)?")
OTHERS = re.compile(r" \(\S*\.cpp:\d+\)$| rolling_[\d.]+$|, about \S+ \w+ if nothing else runs"
                    r"(, \S+ \w+ with all that may be added)?")
# place in LAMMPS' source; the largest of runs; a time, in the unit that it takes
ABOUT = 0.2         # chance, between builds
MACHINE = ".. the numbers of the machine\n\n"      # before a block whose numbers are any


def commands():
    """The bash blocks of the page."""
    text = (TOP / "doc" / "src" / "tutorial.rst").read_text(encoding="ascii")
    blocks = re.findall(r"^( *)\.\. code-block:: bash\n\n((?:\1   .*\n|\n)+)", text, re.MULTILINE)
    return [block for _, block in blocks if not any(word in block for word in NOT_HERE)]


def printed():
    """(line, whether its numbers may be any) of the page's text blocks, without the rows of thermodynamic output."""
    text = (TOP / "doc" / "src" / "tutorial.rst").read_text(encoding="ascii")
    blocks = re.findall(rf"^({re.escape(MACHINE)})?\.\. code-block:: text\n\n((?:   .*\n|\n)+)", text, re.MULTILINE)
    lines = [(" ".join(line.split()), bool(any_)) for any_, block in blocks for line in block.splitlines()]
    return [(line, any_) for line, any_ in lines if re.search("[A-Za-z]", line)]


def same(line, wanted, share):
    """Whether a line is the wanted one, but for numbers that differ by at most a share."""
    if NUMBER.sub("#", line) != NUMBER.sub("#", wanted):
        return False
    pairs = [[float(number.replace(",", "")) for number in pair]
             for pair in zip(NUMBER.findall(line), NUMBER.findall(wanted))]
    return share == math.inf or all(abs(a - b) <= share * abs(b) for a, b in pairs)


def test_the_tutorial_leads_from_a_survey_file_to_a_report(tmp_path):
    for name in ("doc", "inputs", "tools"):
        (tmp_path / name).symlink_to(TOP / name)
    (tmp_path / "build").mkdir()
    (tmp_path / "build" / "lmp").symlink_to(Path(LMP).absolute())
    (tmp_path / "build" / "dump2vtk").symlink_to(BUILD / "dump2vtk")
    blocks = commands()
    assert len(blocks) == 11
    film = (BUILD / "dump2vtk").exists()
    if not film:
        warnings.warn("dump2vtk was not built: section Film is left out")
        blocks = [block for block in blocks if "dump2vtk" not in block]
    done = subprocess.run(["bash", "-c", "\n".join(["set -ex", *blocks])], cwd=tmp_path,
                          env={**os.environ, "LMP": str(Path(LMP).absolute())}, timeout=1800, stdin=subprocess.DEVNULL,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    assert done.returncode == 0, done.stdout[-2000:]
    site = tmp_path / "site"

    # what the page shows is what was printed: to the digit before the first step, after it about
    output = [" ".join(OTHERS.sub("", line).split()) for line in done.stdout.splitlines()]
    share = 0.0
    for line, any_ in printed():
        if line.startswith("Step "):
            share = ABOUT
        if film or not line.startswith("film."):
            assert any(same(one, OTHERS.sub("", line), math.inf if any_ else share) for one in output), line
    assert share == ABOUT
    mine = yaml.safe_load((site / "mine" / "study" / "study.yaml").read_text())
    assert mine["study"]["finished"] == 13
    assert mine["conservative"]["withheld"] == []
    assert (site / "mine" / "report.html").stat().st_size > 100_000

    study = yaml.safe_load((site / "study" / "study.yaml").read_text())
    assert study["study"]["finished"] == 3
    assert [one["kind"] for one in study["warnings"]] == ["soft"]       # the paper's stiffness
    assert study["conservative"]["volume_m3"] == max(row["remove_m3"] for row in study["runs"]) > 1000
    assert (site / "study" / "report.html").stat().st_size > 100_000
    # the run of step 5 is one of the study
    removal = yaml.safe_load((site / "removal" / "volume.yaml").read_text())["volume"]["remove"]
    assert removal == next(row["remove_m3"] for row in study["runs"] if row["set"]["rolling"] == "0.05")
    assert (site / "film.pvd").exists() == film and (site / "removal" / "volume.tif").exists()
