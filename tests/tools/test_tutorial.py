"""doc/src/tutorial.rst: its commands, typed one after the other, with balls of 4 m instead of 2.5 m."""
import os
import re
import subprocess
from pathlib import Path

import yaml

from tiny_collapse import LMP, TOP

BUILD = Path(os.environ.get("SLOPE_BUILD", TOP / "build"))
NOT_HERE = ("tools/demo.sh", "FG-GML", "slope sensitivity")     # builds; the user's own file; runs for a minute


def commands():
    """The bash blocks of the page."""
    text = (TOP / "doc" / "src" / "tutorial.rst").read_text(encoding="ascii")
    blocks = re.findall(r"^( *)\.\. code-block:: bash\n\n((?:\1   .*\n|\n)+)", text, re.MULTILINE)
    return [block for _, block in blocks if not any(word in block for word in NOT_HERE)]


def test_the_tutorial_leads_from_a_survey_file_to_a_report(tmp_path):
    for name in ("doc", "inputs", "tools"):
        (tmp_path / name).symlink_to(TOP / name)
    (tmp_path / "build").mkdir()
    (tmp_path / "build" / "lmp").symlink_to(Path(LMP).absolute())
    (tmp_path / "build" / "dump2vtk").symlink_to(BUILD / "dump2vtk")
    blocks = commands()
    assert len(blocks) == 8
    # the first one copies the deck
    coarse = "sed -i 's/^variable  d        index 2.5/variable d index 4/' in.collapse"
    script = "\n".join(["set -ex", blocks[0], coarse, *blocks[1:]])
    done = subprocess.run(["bash", "-c", script], cwd=tmp_path, env={**os.environ, "LMP": str(Path(LMP).absolute())},
                          timeout=300, stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-2000:]
    site = tmp_path / "site"
    study = yaml.safe_load((site / "study" / "study.yaml").read_text())
    assert study["study"]["finished"] == 3 and not study["warnings"]
    assert study["conservative"]["remove_m3"] == max(row["remove_m3"] for row in study["runs"]) > 1000
    assert (site / "study" / "report.html").stat().st_size > 100_000
    # the run of step 5 is one of the study
    removal = yaml.safe_load((site / "removal" / "volume.yaml").read_text())["volume"]["remove"]
    assert removal == next(row["remove_m3"] for row in study["runs"] if row["set"]["rolling"] == "0.05")
    assert (site / "film.pvd").exists() and (site / "removal" / "volume.tif").exists()
