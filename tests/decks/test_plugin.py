"""build/slopeplugin.so in an lmp that was built without the package; see doc/src/build.rst."""

import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest
import yaml

from deck_helpers import ENVIRONMENT, run_deck

TOP = Path(__file__).resolve().parents[2]
PLUGIN = os.environ.get("SLOPE_PLUGIN")

pytestmark = pytest.mark.skipif(not PLUGIN, reason="no plugin: build with -D SLOPE_PLUGIN=ON -D SLOPE_STOCK_LMP=<lmp>")


@pytest.fixture(autouse=True)
def no_automatic_load(monkeypatch):
    """The decks here load the plugin themselves, as they must in LAMMPS before 4May2022."""
    monkeypatch.delitem(ENVIRONMENT, "LAMMPS_PLUGIN_PATH", raising=False)


def run_with_plugin(case, tmp_path, **settings):
    """Run inputs/CASE's deck with `plugin load` before its first line; return the log."""
    folder = TOP / "inputs" / case
    for file in folder.iterdir():
        if file.suffix in (".xyz", ".asc"):
            shutil.copy(file, tmp_path)
    return run_deck(f"plugin load {PLUGIN}\n" + next(folder.glob("in.*")).read_text(), tmp_path, **settings)


def test_lmp_is_a_stock_one(tmp_path):
    """Otherwise the tests below would show nothing."""
    run_deck("pair_style gran/restitution", tmp_path, expect_error="nrecognized pair style 'gran/restitution'")


def test_every_style_is_registered(tmp_path):
    styles = set()
    for header in (TOP / "src").glob("*/*.h"):
        for kind, name in re.findall(r"^(Command|Fix|Pair|Region)Style\((\S+?), *\w+\)", header.read_text(), re.M):
            styles.add(f"{kind.lower()} style plugin {name}")
    log = run_deck(f"plugin load {PLUGIN}\nplugin list", tmp_path)
    assert styles and styles == set(re.findall(r"^ *\d+: (.*\S)", log, re.M))


def test_restitution(tmp_path):
    log = run_with_plugin("01_restitution", tmp_path)
    assert float(re.findall(r"^restitution: .* observed (\S+)", log, re.M)[-1]) == pytest.approx(0.249, abs=0.003)


@pytest.mark.parametrize("np", [1, 2])
def test_embankment(tmp_path, np):
    run_with_plugin("20_embankment", tmp_path, np=np, vars={"rule": "ours", "d": 4})
    volume = yaml.safe_load((tmp_path / "embankment.summary.yaml").read_text())["volume"]
    assert volume["released"] == pytest.approx(48858.3, abs=0.1)
    assert abs(volume["residual"]) <= 1e-9 * volume["released"]


@pytest.mark.parametrize("function, answer, what", [
    ("int lammps_version(void *lmp)", "20200101", "LAMMPS version must be "),
    ("int lammps_extract_setting(void *lmp, const char *what)", "2", "bytes of a tagint (LAMMPS_SIZES) must be "),
    ("int lammps_config_has_mpi_support(void)", "! original()", "MPI (BUILD_MPI) must be "),
])
def test_lmp_of_another_kind(tmp_path, monkeypatch, function, answer, what):
    """One line that says what differs, instead of a crash: the lmp's answer is replaced by a wrong one."""
    name = re.search(r"\w+(?=\()", function)[0]
    (tmp_path / "other.c").write_text(f"""\
#define _GNU_SOURCE
#include <dlfcn.h>
{function} {{
  int (*original)(void) = (int (*)(void)) dlsym(RTLD_NEXT, "{name}");
  (void) original;
  return {answer};
}}
""")
    subprocess.run(["cc", "-shared", "-fPIC", "-o", "other.so", "other.c", "-ldl"], cwd=tmp_path, check=True)
    monkeypatch.setitem(ENVIRONMENT, "LD_PRELOAD", str(tmp_path / "other.so"))
    run_deck(f"plugin load {PLUGIN}", tmp_path, expect_error=f"Plugin slope: {what}")
