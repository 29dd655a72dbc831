"""The commands of README.md, each copied into a shell, with quick sizes."""
import os
import re
import subprocess

import pytest

from run_helpers import TOP
from tiny_collapse import LMP

# what a command gets after its own words, so that it takes seconds; without --dry-run: long
QUICK = {"tools/slope site": "--balls 60", "tools/slope study mine": "--dry-run",
         "tools/slope study $e": "--set d=4 --set duration=0.5", "mpirun": "-var d 4 -var duration 0.1"}
WHOLE = {**QUICK, "tools/slope study mine": "--paper"}
BUILDERS = "tools/demo.sh", "tests/run.sh"      # the machine, and the whole package: the build and this suite run them


def commands():
    """The lines of the indented blocks, continued ones joined."""
    lines = re.sub(r" \\\n +", " ", (TOP / "README.md").read_text(encoding="utf-8")).splitlines()
    return [line.strip() for line in lines if re.match(r" {4}\S", line)]


@pytest.mark.parametrize("quick", [QUICK, pytest.param(WHOLE, marks=pytest.mark.long)], ids=["short", "whole"])
def test_every_command_of_the_front_page_runs(tmp_path, quick):
    for name in ("tools", "inputs", "doc", "tests"):
        (tmp_path / name).symlink_to(TOP / name)
    (tmp_path / "build").mkdir()
    (tmp_path / "build" / "lmp").symlink_to(LMP)
    script = []
    for command in commands():
        words = command.split("#")[0].strip()
        if words.startswith(BUILDERS):
            assert os.access(TOP / words, os.X_OK), words
            continue
        more = next((more for start, more in quick.items() if words.startswith(start)), "")
        script.append(f"echo '== {words}' && {words} {more}")
    assert len(script) >= 6
    environment = {**os.environ, "LMP": str(tmp_path / "build" / "lmp"), "OMPI_MCA_rmaps_base_oversubscribe": "1"}
    done = subprocess.run(["bash", "-e", "-o", "pipefail", "-c", "\n".join(script)], cwd=tmp_path, env=environment,
                          stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          check=False)
    assert done.returncode == 0, done.stdout[-3000:]
    assert done.stdout.count("| to remove |") == 2      # paper_table.py, by both bulk factors


def test_a_file_that_says_what_runs_it_can_be_run():
    wrong = [str(path.relative_to(TOP)) for folder in ("inputs", "tools", "tests", "src") for path in
             (TOP / folder).rglob("*") if path.is_file() and path.suffix in (".py", ".sh", "")
             and path.read_bytes()[:2] == b"#!" and not os.access(path, os.X_OK)]
    assert wrong == []
