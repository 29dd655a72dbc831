"""Runs LAMMPS decks for the tests in this folder; the environment says LMP=<binary>."""

import functools
import os
import re
import subprocess
from pathlib import Path

import numpy
import pytest

LMP = os.environ.get("LMP", str(Path(__file__).resolve().parents[2] / "build" / "lmp"))

ENVIRONMENT = {
    **os.environ,
    "OMP_NUM_THREADS": "1",
    "OMPI_ALLOW_RUN_AS_ROOT": "1",
    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
}


@functools.lru_cache
def serial():
    """Whether LMP was built with LAMMPS' stand-in for MPI, which knows one rank."""
    help = subprocess.run([LMP, "-h"], env=ENVIRONMENT, stdin=subprocess.DEVNULL, capture_output=True, text=True)
    return "LAMMPS MPI STUBS" in help.stdout


def run_deck(text, tmp_path, np=1, vars={}, expect_error=None, timeout=300):
    """Run a deck in tmp_path on np ranks and return its log.

    vars are passed as -var NAME VALUE. Without expect_error the run must succeed; with it the
    run must fail, with exactly one ERROR line, and this line must contain expect_error.
    Several ranks: the test is skipped where LMP is serial.
    """
    if np > 1 and serial():
        pytest.skip("LMP is serial: built with BUILD_MPI=OFF")
    tmp_path = Path(tmp_path)
    (tmp_path / "in.deck").write_text(text)
    command = [LMP, "-in", "in.deck", "-log", "log.deck"]
    for name, value in vars.items():
        command += ["-var", name, str(value)]
    if np > 1:
        # bind-to none: tests that run side by side would all be bound to the same cores
        command = ["mpirun", "--oversubscribe", "--bind-to", "none", "-np", str(np)] + command
    run = subprocess.run(command, cwd=tmp_path, env=ENVIRONMENT, timeout=timeout, text=True,
                         stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                         stderr=subprocess.STDOUT)
    log = tmp_path / "log.deck"
    log = log.read_text() if log.exists() else ""
    errors = [line for line in run.stdout.splitlines() if line.startswith("ERROR")]

    if expect_error is None:
        assert run.returncode == 0 and not errors, f"the deck failed:\n{run.stdout[-3000:]}"
    else:
        assert run.returncode != 0, f"exit status 0, expected the error: {expect_error}"
        assert len(errors) == 1, f"expected one ERROR line, got {errors}\n{run.stdout[-3000:]}"
        assert expect_error in errors[0], f"expected: {expect_error}\ngot:      {errors[0]}"
    return log


def write_asc(path, heights, xlo=0.0, ylo=0.0, cell=1.0, nodata=-9999):
    """Write an ESRI ASCII grid; heights[0] is the row in the south, NaN is NODATA."""
    heights = numpy.asarray(heights, float)
    rows, columns = heights.shape
    lines = [f"ncols {columns}", f"nrows {rows}", f"xllcorner {xlo!r}", f"yllcorner {ylo!r}",
             f"cellsize {cell!r}", f"NODATA_value {nodata}"]
    for row in heights[::-1]:
        lines.append(" ".join(str(nodata) if numpy.isnan(z) else repr(float(z)) for z in row))
    Path(path).write_text("\n".join(lines) + "\n")


def read_asc(path):
    """Values of an ESRI ASCII grid, [0] is the row in the south, NODATA is NaN; and its header."""
    lines = Path(path).read_text().splitlines()
    header = {key: float(value) for key, value in (line.split() for line in lines[:6])}
    values = numpy.array([[float(word) for word in line.split()] for line in lines[6:]])
    assert values.shape == (header["nrows"], header["ncols"])
    values[values == header["NODATA_value"]] = numpy.nan
    return values[::-1], header


def doc_examples(page):
    """The commands in the Examples section of doc/src/PAGE.rst, without the indentation."""
    folder = Path(__file__).resolve().parents[2] / "doc" / "src"
    text = (folder / f"{page}.rst").read_text()
    block = re.search(r'Examples\n"+\n\n\.\. code-block:: LAMMPS\n\n((?:   .*\n|\n)+)', text)
    return "\n".join(line[3:] for line in block.group(1).splitlines())
