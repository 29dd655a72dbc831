"""doc/src/tutorial.rst: its commands, typed one after the other, and what they print."""
import os
import re
import subprocess
import warnings
from pathlib import Path

import yaml

from tiny_collapse import LMP, TOP

BUILD = Path(os.environ.get("SLOPE_BUILD", TOP / "build"))
NOT_HERE = ("tools/demo.sh", "FG-GML", "slope sensitivity")     # builds; the user's own file; runs for a minute
NUMBER = re.compile(r"-?\d[\d,]*(?:\.\d+)?(?:e[+-]?\d+)?")
OTHERS = re.compile(r" \(\S*\.cpp:\d+\)$| rolling_[\d.]+$")      # place in LAMMPS' source; the largest of runs
ABOUT = 0.2         # chance, between builds


def commands():
    """The bash blocks of the page."""
    text = (TOP / "doc" / "src" / "tutorial.rst").read_text(encoding="ascii")
    blocks = re.findall(r"^( *)\.\. code-block:: bash\n\n((?:\1   .*\n|\n)+)", text, re.MULTILINE)
    return [block for _, block in blocks if not any(word in block for word in NOT_HERE)]


def printed():
    """The lines of the page's text blocks, without the rows of thermodynamic output."""
    text = (TOP / "doc" / "src" / "tutorial.rst").read_text(encoding="ascii")
    blocks = re.findall(r"^\.\. code-block:: text\n\n((?:   .*\n|\n)+)", text, re.MULTILINE)
    lines = [" ".join(line.split()) for block in blocks for line in block.splitlines() if line.strip()]
    return [line for line in lines if re.search("[A-Za-z]", line)]


def same(line, wanted, share):
    """Whether a line is the wanted one, but for numbers that differ by at most a share."""
    if NUMBER.sub("#", line) != NUMBER.sub("#", wanted):
        return False
    return all(abs(float(a.replace(",", "")) - float(b.replace(",", ""))) <= share * abs(float(b.replace(",", "")))
               for a, b in zip(NUMBER.findall(line), NUMBER.findall(wanted)))


def test_the_tutorial_leads_from_a_survey_file_to_a_report(tmp_path):
    for name in ("doc", "inputs", "tools"):
        (tmp_path / name).symlink_to(TOP / name)
    (tmp_path / "build").mkdir()
    (tmp_path / "build" / "lmp").symlink_to(Path(LMP).absolute())
    (tmp_path / "build" / "dump2vtk").symlink_to(BUILD / "dump2vtk")
    blocks = commands()
    assert len(blocks) == 8
    film = (BUILD / "dump2vtk").exists()
    if not film:
        warnings.warn("dump2vtk was not built: section Film is left out")
        blocks = [block for block in blocks if "dump2vtk" not in block]
    done = subprocess.run(["bash", "-c", "\n".join(["set -ex", *blocks])], cwd=tmp_path,
                          env={**os.environ, "LMP": str(Path(LMP).absolute())}, timeout=600, stdin=subprocess.DEVNULL,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    assert done.returncode == 0, done.stdout[-2000:]
    site = tmp_path / "site"

    # what the page shows is what was printed: to the digit before the first step, after it about
    output = [" ".join(OTHERS.sub("", line).split()) for line in done.stdout.splitlines()]
    share = 0.0
    for line in printed():
        if line.startswith("Step "):
            share = ABOUT
        if film or not line.startswith("film."):
            assert any(same(one, OTHERS.sub("", line), share) for one in output), line
    assert share == ABOUT

    study = yaml.safe_load((site / "study" / "study.yaml").read_text())
    assert study["study"]["finished"] == 3 and not study["warnings"]
    assert study["conservative"]["volume_m3"] == max(row["remove_m3"] for row in study["runs"]) > 1000
    assert (site / "study" / "report.html").stat().st_size > 100_000
    # the run of step 5 is one of the study
    removal = yaml.safe_load((site / "removal" / "volume.yaml").read_text())["volume"]["remove"]
    assert removal == next(row["remove_m3"] for row in study["runs"] if row["set"]["rolling"] == "0.05")
    assert (site / "film.pvd").exists() == film and (site / "removal" / "volume.tif").exists()
