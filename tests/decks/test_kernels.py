"""The contact kernels: one program for many processors, the same collapse with each kernel."""

import os
import re
import subprocess
from pathlib import Path

import numpy
import pytest
from deck_helpers import ENVIRONMENT, collapse_deck, run_deck, write_collapse

BUILD = Path(os.environ.get("SLOPE_BUILD", Path(__file__).resolve().parents[2] / "build"))
X86_LEVELS = "x86_64_v3", "x86_64_v4"


def run_with(kernel, folder, monkeypatch, np=1, steps=200, **settings):
    folder.mkdir()
    write_collapse(folder, balls=401, mixed=True)
    if kernel is not None:
        monkeypatch.setitem(ENVIRONMENT, "SLOPE_KERNEL", kernel)
    else:
        monkeypatch.delitem(ENVIRONMENT, "SLOPE_KERNEL", raising=False)
    log = run_deck(collapse_deck(f"run {steps}", every=50), folder, np=np, **settings)
    if "expect_error" in settings:
        return numpy.array([]), log
    rows = [[float(word) for word in line.split()] for line in (folder / "out.dump").read_text().splitlines()
            if len(line.split()) == 16 and not line.startswith("ITEM")]
    return numpy.array(rows), log


def kernels_that_run(tmp_path, monkeypatch):
    """From the error that names them."""
    run_with("none", tmp_path / "names", monkeypatch, expect_error="SLOPE_KERNEL")
    log = (tmp_path / "names" / "log.deck").read_text()
    return re.search(r"runs on this processor \((.*?)\), got none", log).group(1).split(", ")


def test_each_kernel_gives_the_same_collapse(tmp_path, monkeypatch):
    names = kernels_that_run(tmp_path, monkeypatch)
    assert names[0] in ("baseline", "native")
    first, _ = run_with(names[0], tmp_path / names[0], monkeypatch)
    assert len(first) == 401 * 5
    for name in names[1:]:
        rows, log = run_with(name, tmp_path / name, monkeypatch)
        assert f"contact kernel {name}\n" in log
        # rounding grows slowly in so short a run; a lane that went wrong would not
        assert numpy.allclose(rows, first, rtol=1e-7, atol=1e-7)


def test_without_a_name_the_last_one_and_the_same_again(tmp_path, monkeypatch):
    names = kernels_that_run(tmp_path, monkeypatch)
    rows, log = run_with(None, tmp_path / "first", monkeypatch)
    assert f"contact kernel {names[-1]}\n" in log
    again, _ = run_with(None, tmp_path / "second", monkeypatch)
    assert len(rows) and numpy.array_equal(rows, again)


def test_unknown_kernel_on_two_ranks(tmp_path, monkeypatch):
    run_with("x86-64-v9", tmp_path / "two", monkeypatch, np=2,
             expect_error="environment variable SLOPE_KERNEL must name a kernel that runs on this processor (")


@pytest.mark.parametrize("level", X86_LEVELS)
def test_no_code_of_a_kernel_can_stand_in_for_other_code(level):
    """Whatever the linker could share between sources has the kernel's name in it; else code for a newer
    processor might run where nobody has asked whether the processor is new enough."""
    objects = list(BUILD.rglob(f"contact_kernel_{level}.cpp.o"))
    if not objects:
        pytest.skip("no objects of the build here")
    for object in objects:
        lines = subprocess.run(["nm", "-C", "--defined-only", object], capture_output=True, text=True,
                               check=True).stdout.splitlines()
        symbols = [line.split(maxsplit=2) for line in lines]
        shared = [name for _, kind, name in symbols if kind.isupper() or kind in "uvw"]
        foreign = [name for name in shared if level not in name]
        if shared:    # empty on other processors than x86-64
            assert not foreign, foreign
