"""A full disk, a folder that cannot be written, a kill while files are written: what was complete stays so.

Three ways to make a disk full: a limit on the size of files (RLIMIT_FSIZE, for everybody), a small file system of its
own (tmpfs, for root; else skipped), and no folder at all.
"""
import errno
import contextlib
import csv
import json
import multiprocessing
import os
import platform
import random
import re
import resource
import signal
import subprocess
import time
from pathlib import Path

import matplotlib.image
import numpy as np
import pytest
import rasterio
import yaml

import run_helpers
from tiny_collapse import DECK, LMP, read_asc, write_case

from slope_tools import cli, disk  # noqa: F401
from slope_tools.case import restarts as files, run_folders  # noqa: F401
from slope_tools.errors import SlopeError
from slope_tools.drawing import figures, maps  # noqa: F401
from slope_tools.survey import rasters  # noqa: F401

WRITES = ("restart     50 ${out}.1.restart ${out}.2.restart\n"
          "dump all all custom 50 ${out}.dump id type diameter x y z\n"
          "run         ${steps}\n")
KILLS = 8
pytestmark = pytest.mark.filterwarnings("ignore::rasterio.errors.NotGeoreferencedWarning")
MARKERS = "volume.yaml", "score.yaml", "travel.yaml", "export.yaml"     # of sets of files that belong together
KEPT = {"study": "out", "sensitivity": "sensitivity", "calibrate": "calibrate"}     # commands with runs: their folders


@pytest.fixture(scope="module")
def case(tmp_path_factory):
    """A case, a finished study of it in out, and in run what a run of its own left."""
    folder = tmp_path_factory.mktemp("case")
    deck = write_case(folder / "case")
    deck.write_text(DECK.replace("run         ${steps}\n", WRITES))
    (folder / "mapped.csv").write_text("5,2\n30,2\n30,20\n5,20\n")
    for name, kept in KEPT.items():
        run_helpers.slope(folder, *TOOLS_OUTPUTS[name][0].format(kept).split()).check_returncode()
    return folder


@pytest.fixture
def here(case, tmp_path, monkeypatch):
    """The test's folder, with the case and the run in it."""
    for path in case.iterdir():
        (tmp_path / path.name).symlink_to(path)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("LMP", LMP)
    return tmp_path


def contents(folder):
    """{path: bytes} of the files in and below a folder, without hidden ones, and without the times in them."""
    return {str(path.relative_to(folder)): re.sub(rb"\d{4}-\d\d-\d\d[ T]\d\d:\d\d(:\d\d)?([+-]\d\d:\d\d)?", b"then",
                                                  path.read_bytes())
            for path in sorted(Path(folder).rglob("*"))
            if path.is_file() and "/." not in f"/{path.relative_to(folder)}"}


@contextlib.contextmanager
def file_limit(size):
    """No file may grow beyond so many bytes; what is beyond is refused as on a full disk."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


@pytest.fixture
def small_disk(tmp_path):
    """mount(kB): a file system of its own of that size, at the folder that it gives."""
    mounted = []

    def mount(kilobytes):
        folder = tmp_path / "disk"
        folder.mkdir()
        done = subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={kilobytes}k", "none", folder], check=False,
                              capture_output=True, text=True)
        if done.returncode != 0:
            pytest.skip(f"needs a file system of its own, which only root may mount: {done.stderr.strip()}")
        mounted.append(folder)
        return folder
    yield mount
    for folder in mounted:
        subprocess.run(["umount", "-l", folder], check=True)


def fill(folder, leave):
    """Leave so many kB in a file system."""
    free = os.statvfs(folder)
    size = free.f_bavail * free.f_bsize - 1024 * leave
    (folder / "filler").write_bytes(b"\0" * max(0, size))


# --- the tools ---

# a command, its other form, which gives other files; the first must leave the largest file that the second writes
TOOLS_OUTPUTS = {
    "terrain": ["terrain case/terrain.asc -o {0}/terrain.asc", "--bounds 1 1 39 23"],
    "polygon": ["polygon mapped.csv --local --terrain case/terrain.asc -o {0}/mapped.csv", ""],
    "volume": ["volume out/rolling_0/tiny --road case/road.csv --local --mesh 4 -o {0}", "--cut-angle 20"],
    "score": ["score out/rolling_0/tiny --observed mapped.csv --local -o {0}", "--threshold 0.3"],
    "travel": ["travel out/rolling_0/tiny.dump -o {0}", "--axis 30"],
    "report": ["report out/rolling_0 --pictures -o {0}/report.html", "--section 2 12 38 12"],
    "study": ["study case/in.tiny --set rolling=0,0.1 --road case/road.csv --local -o {0}", "--cut-angle 20"],
    "sensitivity": ["sensitivity case/in.tiny --set rolling=0 --try friction=25 --road case/road.csv --local -o {0}",
                    "--cut-angle 20"],
    "calibrate": ["calibrate case/in.tiny --observed mapped.csv --local --road-volume 5 --road case/road.csv "
                  "--vary rolling=0:0.1 --runs 5 -o {0}", "--cut-angle 20"],
}


def slope(command, folder, more=""):
    """Status of `slope COMMAND`."""
    return cli.main(f"{command.format(folder)} {more}".split())


@pytest.fixture
def before(here):
    """before(name, folder): what the command leaves in the folder, undisturbed."""
    def make(name, folder):
        if name in KEPT:
            subprocess.run(["cp", "-a", f"{(here / KEPT[name]).resolve()}/.", folder], check=True)
        assert slope(TOOLS_OUTPUTS[name][0], folder) == 0
        return contents(folder)
    return make


def check_whole(path, before):
    """That a file is no half of one, by what its kind must have; before: another one of that name."""
    data = path.read_bytes()
    if path.suffix == ".png":
        matplotlib.image.imread(path)
    elif path.suffix == ".html":
        assert data.rstrip().endswith(b"</html>")
    elif path.suffix in (".tif", ".asc"):
        with rasterio.open(path) as raster:
            raster.read()
    elif path.suffix == ".csv":
        with open(path, newline="", encoding="utf-8") as lines:
            assert len({len(row) for row in csv.reader(lines) if row and not row[0].startswith("#")}) == 1
        assert data.endswith(b"\n")
    elif path.suffix == ".geojson":
        assert json.loads(data).keys() == json.loads(before).keys()
    elif path.suffix == ".yaml":
        assert data.endswith(b"\n") and yaml.safe_load(data).keys() == yaml.safe_load(before).keys()
    else:
        raise AssertionError(f"{path}: nothing says when it is whole")


def test_half_a_file_is_noticed(case, before, here):
    """What check_whole says of files that end early."""
    (here / "results").mkdir()
    whole = before("sensitivity", "results")
    for path in map(Path, ("sensitivity.png", "sensitivity.csv", "sensitivity.yaml", "rolling_0/volume/volume.tif")):
        check_whole("results" / path, whole[str(path)])
        data = ("results" / path).read_bytes()
        ("results" / path).write_bytes(data[:len(data) // 2])
        with pytest.raises(Exception):
            check_whole("results" / path, whole[str(path)])


@pytest.mark.parametrize("name", TOOLS_OUTPUTS)
def test_a_tool_and_a_file_that_does_not_fit(before, here, capsys, name):
    (here / "results").mkdir()
    whole = before(name, "results")
    largest = max(len(data) for path, data in whole.items() if "rolling_" not in path or "volume/" in path)
    capsys.readouterr()
    with file_limit(largest // 2):
        assert slope(TOOLS_OUTPUTS[name][0], "results", TOOLS_OUTPUTS[name][1]) == 2
    err = capsys.readouterr().err.splitlines()
    assert re.fullmatch(rf"slope {name}: results\S*: cannot be (written|used): .*File too large.*", err[-1]), err
    found = contents("results")
    if name in KEPT or name == "report":        # a file at a time: each is the one before or the one after
        assert found.keys() == whole.keys()
        for path in found:
            if found[path] != whole[path]:
                check_whole(Path("results", path), whole[path])
    else:
        assert found == whole
    # and all is well when there is room again
    assert slope(TOOLS_OUTPUTS[name][0], "results") == 0 and contents("results") == whole


@pytest.mark.parametrize("name", ["volume", "report"])      # of all, see above
def test_a_tool_on_a_full_disk(before, small_disk, here, capsys, name):
    disk = small_disk(20000)
    whole = before(name, disk)
    fill(disk, 0)
    capsys.readouterr()
    assert slope(TOOLS_OUTPUTS[name][0], disk, TOOLS_OUTPUTS[name][1]) == 2
    err = capsys.readouterr().err.splitlines()
    assert re.fullmatch(rf"slope {name}: {disk}\S*: cannot be (written|used): .*No space left.*", err[-1]), err
    (disk / "filler").unlink()
    assert contents(disk) == whole


@pytest.mark.parametrize("name", TOOLS_OUTPUTS)
def test_a_tool_and_no_folder(here, capsys, name):
    """Where the folder should be is a file."""
    Path("results").write_text("not a folder\n")
    assert slope(TOOLS_OUTPUTS[name][0], "results", TOOLS_OUTPUTS[name][1]) == 2
    err = capsys.readouterr().err.splitlines()
    assert "results" in err[-1] and not any("Traceback" in line for line in err)
    assert Path("results").read_text() == "not a folder\n"


@pytest.mark.long
@pytest.mark.parametrize("name", sorted(TOOLS_OUTPUTS.keys() - {"report"}))      # slow, and written as study's
def test_a_tool_that_is_killed(before, here, name):
    """At any moment: every file is the one before or the one after, and no file is half of it.

    A set of results that was being exchanged has no yaml any more.
    """
    (here / "results").mkdir()
    (here / "resultz").mkdir()
    one = before(name, "results")
    before(name, "resultz")
    began = time.monotonic()
    assert slope(TOOLS_OUTPUTS[name][0], "resultz", TOOLS_OUTPUTS[name][1]) == 0
    lasts = time.monotonic() - began
    other = {path: data.replace(b"resultz", b"results") for path, data in contents("resultz").items()}
    chance = random.Random(f"{name} 1")
    for _ in range(KILLS):
        child = os.fork()
        if child == 0:
            with contextlib.suppress(BaseException):
                os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
                os.dup2(1, 2)
                slope(TOOLS_OUTPUTS[name][0], "results", TOOLS_OUTPUTS[name][1])
            os._exit(0)
        time.sleep(chance.uniform(0, lasts))
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
        found = contents("results")
        assert all(path.endswith(MARKERS) for path in one.keys() - found.keys())
        for path, data in found.items():
            if path.endswith((".png", ".html", "row.json", f"{name}.yaml")):    # with times or sizes that differ
                assert data[-8:] in (one[path][-8:], other[path][-8:]), path
            else:
                assert data in (one.get(path), other[path]), path


class Killed(BaseException):
    """By a signal that no program can catch."""


@pytest.mark.parametrize("after", range(1, 9))
def test_a_set_is_whole_or_void(tmp_path, monkeypatch, after):
    """Killed after so many changes of a folder: with its marker, all files are of one set."""
    folder, left = tmp_path / "volume", after

    def exchange(text):
        with disk.complete(folder, "volume.yaml") as new:
            for name in ("a.csv", "volume.yaml", "z.tif"):
                (new / name).write_text(text)

    def dies(do):
        def one(*words, **more):
            nonlocal left
            left -= 1
            if not left:
                raise Killed
            return do(*words, **more)
        return one
    exchange("old")
    with monkeypatch.context() as patch:
        for place, name in ((os, "replace"), (os, "fsync"), (Path, "unlink")):
            patch.setattr(place, name, dies(getattr(place, name)))
        with contextlib.suppress(Killed):
            exchange("new")
    found = {path.name: path.read_text() for path in folder.glob("[!.]*") if path.is_file()}
    assert "volume.yaml" not in found or set(found.values()) in ({"old"}, {"new"})
    exchange("newer")
    assert {path.read_text() for path in folder.iterdir()} == {"newer"} and len(list(folder.iterdir())) == 3


def many_sets(folder, name, number, failed):
    """Write a set of three files, and two files at once, again and again; what fails goes to a queue."""
    try:
        for _ in range(number):
            with disk.complete(folder, "marker") as new:
                for part in ("a", "b", "marker"):
                    (new / part).write_text(name)
            with disk.write_beside(folder / "c", folder / "d") as pair:
                for part in pair:
                    part.write_text(name)
    except Exception as error:
        failed.put(repr(error))


def test_processes_with_one_output_leave_one_of_their_sets(tmp_path):
    """They have temporary names of their own, and take turns in renaming."""
    context = multiprocessing.get_context("spawn")      # pytest has threads, with which a fork may hang
    failed = context.Queue()
    folder = tmp_path / "out"
    folder.mkdir()
    running = [context.Process(target=many_sets, args=(folder, name, 40, failed)) for name in "123"]
    for one in running:
        one.start()
    for one in running:
        one.join()
    assert failed.empty(), failed.get()
    assert sorted(os.listdir(folder)) == ["a", "b", "c", "d", "marker"] and os.listdir(tmp_path) == ["out"]
    for parts in (("a", "b", "marker"), ("c", "d")):
        assert len({(folder / part).read_text() for part in parts}) == 1, parts


def test_what_a_marker_promises_is_on_the_disk(tmp_path, monkeypatch):
    """The files of a set are flushed before its marker appears, and so is every single file before it gets its name."""
    done = []
    fsync, replace = os.fsync, os.replace

    def flushed(handle):
        done.append(Path(os.readlink(f"/proc/self/fd/{handle}")).name)
        fsync(handle)

    def renamed(old, new):
        done.append(f"to {Path(new).name}")
        replace(old, new)
    monkeypatch.setattr(os, "fsync", flushed)
    monkeypatch.setattr(os, "replace", renamed)
    with disk.complete(tmp_path / "set", "m.yaml") as new:
        for name in ("a.csv", "m.yaml"):
            (new / name).write_text("text")
    assert sorted(done[:3]) == sorted(["a.csv", "m.yaml", new.name])
    assert done[3:] == ["set", "to a.csv", "set", "to m.yaml", "set", tmp_path.name]
    done.clear()
    disk.write_file(tmp_path / "one", "text")
    assert done == [f".one.{platform.node()}.{os.getpid()}.new", "to one", tmp_path.name]


def test_a_folder_that_cannot_be_reached_is_one_line(tmp_path, monkeypatch):
    def is_dir(_):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))

    monkeypatch.setattr(Path, "is_dir", is_dir)
    with pytest.raises(SlopeError, match="one: cannot be written: Permission denied"):
        disk.write_file(tmp_path / "one", "text")


def test_what_a_killed_process_left_goes_with_the_next_file(tmp_path):
    """Not what another process, another machine, or another file has there."""
    with subprocess.Popen(["true"]) as ended:
        child = ended.pid
    left = tmp_path / f".one.{platform.node()}.{child}.new"
    others = [tmp_path / f".one.{platform.node()}.{os.getppid()}.new", tmp_path / f".one.elsewhere.{child}.new",
              tmp_path / f".two.{platform.node()}.{child}.new"]
    for path in (left, *others):
        path.write_text("half")
    disk.write_file(tmp_path / "one", "text")
    assert sorted(tmp_path.iterdir()) == sorted([*others, tmp_path / "one"])


# --- runs ---

def lmp(*words, limit=None):
    """Run the deck in the present folder."""
    def begin():
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)       # a write that is refused, not a signal
        if limit is not None:
            resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
    # Open MPI would have large files of its own, for ranks that talk to each other
    environment = {**os.environ, "PMIX_MCA_gds": "hash", "OMPI_MCA_btl": "self"}
    return subprocess.run([LMP, "-in", "in.tiny", "-log", "none", *words], env=environment, preexec_fn=begin,
                          restore_signals=False, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          check=False)


@pytest.fixture
def run_folder(here, monkeypatch):
    """make(folder): a run of 100 steps there; gives what it left, without the dump and the restart files."""
    def make(folder=here / "work"):
        folder.mkdir(exist_ok=True)
        for name in ("in.tiny", "terrain.asc"):
            (folder / name).write_bytes((here / "case" / name).read_bytes())
        monkeypatch.chdir(folder)
        done = lmp("-var", "steps", "100")
        assert done.returncode == 0, done.stdout
        return outputs(folder)
    return make


def error_of(done):
    """The one line with which a run failed."""
    errors = [line for line in done.stdout.splitlines() if line.startswith("ERROR")]
    assert done.returncode != 0 and len(errors) == 1, done.stdout
    return errors[0]


def outputs(folder):
    """The rasters and the summary of a run, with all that is beside them of that kind."""
    return {path: data for path, data in contents(folder).items() if re.search(r"\.(asc|yaml)(\.|$)", path)}


def test_a_run_whose_rasters_do_not_fit(run_folder):
    whole = run_folder()
    largest = max((len(data), path) for path, data in whole.items() if path.startswith("tiny"))
    deck = re.sub("^dump .*\n", "", Path("in.tiny").read_text(), flags=re.MULTILINE)
    Path("in.tiny").write_text(deck)        # a dump is larger, and LAMMPS of 2025 says so
    done = lmp("-var", "steps", "200", "-var", "rolling", "0.2", limit=largest[0] - 100)
    assert re.match(r"ERROR( on proc 0)?: Fix deposit/grid: cannot write tiny\.\w+\.asc: File too large",
                    error_of(done))
    assert outputs(".") == whole                # all of them, not only the one that did not fit


def test_a_run_on_a_full_disk(run_folder, small_disk):
    disk = small_disk(4000)
    whole = run_folder(disk)
    fill(disk, 8)
    done = lmp("-var", "steps", "200", "-var", "rolling", "0.2")
    assert re.search(r"cannot write tiny\..*No space left on device", error_of(done))
    (disk / "filler").unlink()
    assert outputs(disk) == whole
    assert lmp("-var", "steps", "100").returncode == 0 and outputs(disk) == whole


def test_a_run_without_a_folder_ends_before_it_begins(run_folder):
    run_folder()
    Path("file").write_text("not a folder\n")
    for out, why in (("none/tiny", "No such file or directory"), ("file/tiny", "Not a directory")):
        done = lmp("-var", "steps", "200", "-var", "out", out)
        assert f"Fix deposit/grid: cannot write {out}.summary.yaml: {why}" in error_of(done)
        assert "Loop time" not in done.stdout


def test_a_restart_file_that_does_not_fit_leaves_the_one_before(run_folder):
    run_folder()
    assert [step for step, _ in files.restarts(".")] == [100, 50]
    size = os.path.getsize("tiny.1.restart")
    done = lmp("-var", "steps", "200", limit=size // 2)     # step 50 goes to tiny.1.restart again
    assert [step for step, _ in files.restarts(".")] == [100]
    assert done.returncode != 0 and "ERROR: I/O error while writing restart" in done.stdout


@pytest.mark.long
def test_a_run_that_is_killed(run_folder):
    """At any moment: rasters and summary can be read, and one of the two restart files is complete."""
    whole = run_folder()
    Path("in.tiny").write_text(Path("in.tiny").read_text().replace("deposit/grid 10 50", "deposit/grid 5 5")
                               .replace("restart     50", "restart     5"))
    chance = random.Random(2)
    seen = set()
    for _ in range(KILLS):
        for path in Path(".").glob("*.restart"):
            path.unlink()
        process = subprocess.Popen([LMP, "-in", "in.tiny", "-log", "none", "-var", "steps", "100000"],
                                   stdout=subprocess.DEVNULL)
        while not Path("tiny.2.restart").exists():
            assert process.poll() is None
            time.sleep(0.01)
        time.sleep(chance.uniform(0, 0.3))
        process.kill()
        process.wait()
        for path in whole:
            if path.startswith("tiny") and path.endswith(".asc"):
                assert read_asc(path).shape == (24, 40), path
        about = run_folders.load_summary("tiny.summary.yaml")
        restarts = files.restarts(".")
        assert restarts and abs(restarts[0][0] - about["step"]) <= 5
        # thickness and summary are of one output, unless the kill fell between two renames
        held = np.nansum(read_asc("tiny.thickness.asc"))
        assert held == pytest.approx(about["volume"]["on_grid"], rel=1e-3)
        seen.add(about["step"])
    assert len(seen) > 1


def test_a_read_only_file_system_is_said(tmp_path, monkeypatch):
    """It refuses to remove a file, too, though there is none."""
    def refuse(*_, **__):
        raise OSError(errno.EROFS, "Read-only file system")
    monkeypatch.setattr(Path, "write_bytes", refuse)
    monkeypatch.setattr(Path, "unlink", refuse)
    with pytest.raises(SlopeError, match="report.html: cannot be written: Read-only file system"):
        disk.write_file(tmp_path / "report.html", "text")


def test_what_is_twice_in_a_yaml_is_written_twice():
    """Aliases are of no use to those who read a study with another program."""
    shared = {"rolling": "0.05"}
    text = disk.yaml_text("a study", {"set": shared, "runs": [{"set": shared, "at": (1, np.float64(2.5))}]})
    assert text == "# a study\nset:\n  rolling: '0.05'\nruns:\n- set:\n    rolling: '0.05'\n  at:\n  - 1\n  - 2.5\n"


@pytest.mark.parametrize("text", ["[" * 200000, "- " * 100000, "[\n" * 6000, '{"a": ' * 6000])
def test_a_yaml_file_of_many_levels_is_refused(tmp_path, text):
    """Not by the end of the program, which libyaml's recursion would be."""
    (tmp_path / "a.yaml").write_text(text)
    with pytest.raises(SlopeError, match="a.yaml: must be a list .*too deep"):
        disk.parse_yaml(tmp_path / "a.yaml", "a list")
