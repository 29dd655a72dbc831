"""Runs LAMMPS decks for the tests in this folder; the environment says LMP=<binary>."""

import functools
import importlib.util
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy
import pytest

from messages import says

LMP = os.environ.get("LMP", str(Path(__file__).resolve().parents[2] / "build" / "lmp"))

ENVIRONMENT = {
    **os.environ,
    "OMP_NUM_THREADS": "1",
    "OMPI_ALLOW_RUN_AS_ROOT": "1",
    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
    "OMPI_MCA_mpi_yield_when_idle": "1",    # see CMakeLists.txt
}

# of a run without mpirun: Open MPI 4 starts no daemon, which takes half a second, and has no folder, which runs that
# start at once would share; Open MPI 5 leaves no shared memory behind
ALONE = {"OMPI_MCA_ess_singleton_isolated": "1", "OMPI_MCA_orte_create_session_dirs": "0", "OMPI_MCA_btl": "self"}


@functools.lru_cache
def lammps_help():
    """What `lmp -h` prints; several workers ask at once."""
    return subprocess.run([LMP, "-h"], env={**ENVIRONMENT, **ALONE}, stdin=subprocess.DEVNULL, capture_output=True,
                          text=True).stdout


def serial():
    """Whether LMP was built with LAMMPS' stand-in for MPI, which knows one rank."""
    return "LAMMPS MPI STUBS" in lammps_help()


def script_of(path):
    """A script of a case as a module; the paths that it adds are forgotten."""
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(spec)
    before = list(sys.path)
    spec.loader.exec_module(module)
    sys.path[:] = before
    return module


def run_deck(text, tmp_path, np=1, vars={}, expect_error=None, timeout=300):
    """Run a deck in tmp_path on np ranks and return its log.

    vars are passed as -var NAME VALUE. Without expect_error the run must succeed; with it the
    run must fail, with exactly one ERROR line, which must say expect_error, see says().
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
        # ranks wait for each other, and a test on one of their cores holds up all: four took 93 s, not 28
        if os.geteuid() == 0:
            command = ["nice", "-n", "-10"] + command
    run = subprocess.run(command, cwd=tmp_path, env={**ENVIRONMENT, **(ALONE if np == 1 else {})}, timeout=timeout,
                         text=True, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    log = tmp_path / "log.deck"
    log = log.read_text() if log.exists() else ""
    errors = [line for line in run.stdout.splitlines() if line.startswith("ERROR")]

    if expect_error is None:
        assert run.returncode == 0 and not errors, f"the deck failed:\n{run.stdout[-3000:]}"
    else:
        assert run.returncode != 0, f"exit status 0, expected the error: {expect_error}"
        assert len(errors) == 1, f"expected one ERROR line, got {errors}\n{run.stdout[-3000:]}"
        assert says(errors[0], expect_error), f"expected: {expect_error}\ngot:      {errors[0]}"
    return log


def write_asc(path, heights, xlo=0.0, ylo=0.0, cell=1.0, nodata=-9999):
    """Write an ESRI ASCII grid; heights[0] is the row in the south, NaN is NODATA."""
    heights = numpy.asarray(heights, float)
    rows, columns = heights.shape
    lines = [f"ncols {columns}", f"nrows {rows}", f"xllcorner {float(xlo)!r}", f"yllcorner {float(ylo)!r}",
             f"cellsize {float(cell)!r}", f"NODATA_value {nodata}"]
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


def left_out(log):
    """Share of the balls that delete_balls removed."""
    gone, left = map(int, re.search(r"Delete_balls: (\d+) balls .* (\d+) balls left", log).groups())
    return gone / (gone + left)


def flat_numbers(summary, groups=("release", "volume", "travel", "largest")):
    """The numbers in some groups of a summary of fix deposit/grid, by their path: {"travel.top.0": 3.0}."""
    found = {}

    def add(path, value):
        if isinstance(value, (dict, list)):
            for key, inner in value.items() if isinstance(value, dict) else enumerate(value):
                add(f"{path}.{key}", inner)
        elif isinstance(value, (int, float)):
            found[path] = value

    for group in groups:
        add(group, summary[group])
    return found


def doc_examples(page):
    """The commands in the Examples section of doc/src/PAGE.rst, without the indentation."""
    folder = Path(__file__).resolve().parents[2] / "doc" / "src"
    text = (folder / f"{page}.rst").read_text()
    block = re.search(r'Examples\n"+\n\n\.\. code-block:: LAMMPS\n\n((?:   .*\n|\n)+)', text)
    return "\n".join(line[3:] for line in block.group(1).splitlines())


# --- balls that fly freely ---

FLIGHT = """
units si
atom_style sphere
atom_modify map array
boundary {boundary}
newton {newton}
comm_style {comm}
region ground terrain ground.asc
{regions}
read_data balls.data
neighbor 0.5 bin
neigh_modify every 1 delay 0 check no
comm_modify cutoff 3.0
pair_style none
timestep {dt}
fix move all nve/sphere
thermo_modify lost ignore
thermo 1000000
"""


def flight_head(boundary="f f f", newton="on", comm="brick", regions="", dt=0.001):
    """The head of a deck of balls that fly freely: no pair style, no wall; closed forms for everything."""
    return FLIGHT.format(boundary=boundary, newton=newton, comm=comm, regions=regions, dt=dt)


def write_balls(path, x, d, v=None, box=None, omega=None, density=1000.0):
    """A data file of balls: places x, diameters d, velocities v, spins omega."""
    x = numpy.atleast_2d(numpy.asarray(x, float))
    d = numpy.broadcast_to(numpy.asarray(d, float), len(x))
    v = numpy.zeros_like(x) if v is None else numpy.atleast_2d(v)
    omega = numpy.zeros_like(x) if omega is None else numpy.atleast_2d(omega)
    lines = ["balls", "", f"{len(x)} atoms", "1 atom types", ""]
    lines += [f"{lo!r} {hi!r} {a}lo {a}hi" for (lo, hi), a in zip(box, "xyz")]
    lines += ["", "Atoms # sphere", ""]
    lines += [f"{k + 1} 1 {float(d[k])!r} {density} " + " ".join(repr(float(c)) for c in x[k])
              for k in range(len(x))]
    lines += ["", "Velocities", ""]
    lines += [f"{k + 1} " + " ".join(repr(float(c)) for c in (*v[k], *omega[k]))
              for k in range(len(x))]
    Path(path).write_text("\n".join(lines) + "\n")


# --- a dense collapse: balls that let go above a rough slope of 32 degrees, in motion from the start ---

COLLAPSE = """
units si
newton {newton}
processors {processors}
atom_style sphere
atom_modify map array {sort}
boundary {boundary}
comm_style {comm}
comm_modify vel yes
{begin}
region ground terrain ground.asc depth 8 headroom 20
neighbor {skin} bin
neigh_modify {neigh}
pair_style gran/restitution scheme {scheme}
pair_coeff * * stiffness 2e7 2e7 restitution 0.4 friction 30 rolling 0.05
pair_coeff * 3 stiffness 2e7 2e7 restitution 0.3 friction 30 rolling 0.05
timestep 0.0015
group soil type 1 2
{ground}
{balance}
fix move soil nve/sphere
fix weight soil gravity 9.80665 vector 0 0 -1
fix deposit soil deposit/grid 10 0 cell 1.0 terrain ground output {out}
thermo 1000
thermo_modify lost ignore
dump path soil custom {every} {out}.dump id x y z vx vy vz omegax omegay omegaz fx fy fz tqx tqy tqz
dump_modify path sort id format float %.17g
{run}
"""
WALL_GROUND = "fix field soil wall/gran/balls 3 1.0 surface ground upper spacing 1.0"
DEFAULTS = dict(newton="on", processors="* * *", sort="", boundary="f f f", comm="brick", begin="read_data balls.data",
                skin=0.2, neigh="every 1 delay 0 check yes", scheme="exact", ground=WALL_GROUND, balance="", out="out",
                every=10)


def collapse_deck(run, **settings):
    """The deck of the collapse; settings replace what stands in DEFAULTS."""
    return COLLAPSE.format(**{**DEFAULTS, **settings, "run": run})


def write_collapse(tmp_path, balls=400, seed=1, mixed=False, fast=False, box=((-11, 33), (-15, 23), (-3, 25))):
    """ground.asc and balls.data of the collapse: that many balls of 1 m; mixed: three in ten are of type 2, 0.8 m.

    They move 1 m/s down the slope, or 3 m/s: then they cross more ranks, and rounding grows faster."""
    def height(x):
        return numpy.interp(x, [8, 26], [0, 18 * numpy.tan(numpy.radians(32))])

    write_asc(Path(tmp_path) / "ground.asc", numpy.tile(height(numpy.arange(-10, 32) + 0.5), (36, 1)), -10.0, -14.0)
    axes = [numpy.arange(low, high, 1.05) for low, high in ((9, 22), (0.7, 7.5), (0, 22))]
    x = numpy.stack(numpy.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    above = x[:, 2] - height(x[:, 0])
    x = x[numpy.argsort(numpy.where(above > 1.3, above, 1e9), kind="stable")][:balls]    # the lowest
    assert balls <= (above > 1.3).sum(), "more balls than places"
    rng = numpy.random.default_rng(seed)
    x = x + rng.uniform(-0.02, 0.02, x.shape)
    drift, spread = ([-3.0, 0.5, -2.0], 0.5) if fast else ([-1.0, 0.2, -0.5], 0.1)
    v = drift + rng.normal(0, spread, x.shape)
    kind = numpy.where(mixed & (rng.uniform(size=len(x)) < 0.3), 2, 1)
    lines = ["balls", "", f"{len(x)} atoms", "3 atom types", ""]
    lines += [f"{low} {high} {axis}lo {axis}hi" for (low, high), axis in zip(box, "xyz")]
    lines += ["", "Atoms # sphere", ""]
    lines += [f"{k} {t} {(1.0, 0.8)[t - 1]} 3411.4 {p[0]!r} {p[1]!r} {p[2]!r}"
              for k, (t, p) in enumerate(zip(kind, x.tolist()), 1)]
    lines += ["", "Velocities", ""]
    lines += [f"{k} {p[0]!r} {p[1]!r} {p[2]!r} 0 0 0" for k, p in enumerate(v.tolist(), 1)]
    (Path(tmp_path) / "balls.data").write_text("\n".join(lines) + "\n")


def read_dump(path):
    """Step -> rows of a text dump."""
    frames = {}
    lines = iter(Path(path).read_text().splitlines())
    for line in lines:
        if line == "ITEM: TIMESTEP":
            step = int(next(lines))
        elif line == "ITEM: NUMBER OF ATOMS":
            count = int(next(lines))
        elif line.startswith("ITEM: ATOMS"):
            frames[step] = numpy.array([next(lines).split() for _ in range(count)], float)
    return frames


def dump_difference(a, b):
    """Largest difference of rows "id x y z vx vy vz ...", each vector relative to the largest of its kind."""
    assert a.shape == b.shape and (a[:, 0] == b[:, 0]).all(), "other balls"
    vectors = [(a[:, k:k + 3], b[:, k:k + 3]) for k in range(1, a.shape[1], 3)]
    return [numpy.abs(p - q).max() / max(numpy.abs(p).max(), 1e-300) for p, q in vectors]
