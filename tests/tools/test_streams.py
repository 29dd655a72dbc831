"""Standard output and error that are closed, full or left by their reader: the work is done, the status says it."""
import fcntl
import json
import os
import subprocess
import sys
import threading

import numpy as np
import pytest

from run_helpers import TOOLS, write_tif

from slope_tools import streams
from slope_tools.survey import rasters

SLOPE = str(TOOLS / "slope")
TERRAIN = "terrain dem.tif -o terrain.asc"
NO_SPACE = "standard output: No space left on device"
PIPE = 4096     # bytes, the least that a pipe may hold


@pytest.fixture(autouse=True)
def dem(here):
    write_tif("dem.tif", np.full((6, 8), 100.0), 5.0)


def shell(words):
    """`slope WORDS` with redirections, by bash; gives status, stdout, stderr, status of slope before a pipe."""
    done = subprocess.run(["bash", "-c", f'"$0" {words}', SLOPE], capture_output=True, text=True, check=False)
    return done.returncode, done.stdout, done.stderr


def is_made():
    return rasters.read_asc_local("terrain.asc").z.shape == (6, 8)


@pytest.mark.parametrize("before, closed", [
    ("", ">&-"), ("", "2>&-"), ("", "<&- >&- 2>&-"), ("--progress json", "2>&-")])
def test_a_closed_stream_is_none(before, closed):
    status, out, err = shell(f"{before} {TERRAIN} {closed}")
    assert (status, err) == (0, "") and is_made()
    assert ("8 x 6 cells" in out) == (closed == "2>&-")


@pytest.mark.parametrize("closed", [">&-", "2>&-", ">&- 2>&-"])
def test_a_wrong_input_with_a_closed_stream(closed):
    status, out, err = shell(f"terrain none.tif -o terrain.asc {closed}")
    assert (status, out) == (2, "") and (err.count("none.tif") == 1) == (closed == ">&-")


def test_the_next_file_is_not_a_closed_stream():
    """It would receive what programs that are started print."""
    code = "import os, sys; sys.path.insert(0, sys.argv[1]); from slope_tools import streams; streams.replace();" \
           "file = open('file', 'w'); os.system('echo lost; echo lost >&2'); print(file.fileno(), file=file)"
    done = subprocess.run(["bash", "-c", '"$0" -c "$1" "$2" <&- >&- 2>&-', sys.executable, code, str(TOOLS)],
                          check=False)
    with open("file", encoding="ascii") as file:
        assert done.returncode == 0 and int(file.read()) > 2


@pytest.mark.parametrize("words", [TERRAIN, "--version", "stability --help", "terrain --describe"])
def test_a_full_disk_is_named(words):
    status, out, err = shell(f"{words} > /dev/full")
    assert status == 2 and NO_SPACE in err and len(err.splitlines()) == 1 and out == ""
    assert TERRAIN not in words or is_made()


def test_a_full_disk_is_named_in_json():
    status, _, err = shell(f"--progress json {TERRAIN} > /dev/full")
    assert status == 2 and json.loads(err) == {"level": "error", "command": "terrain", "text": NO_SPACE}


@pytest.mark.parametrize("where", ["2> /dev/full", "> /dev/full 2>&1", "> /dev/full"])
def test_a_wrong_input_keeps_its_status_on_a_full_disk(where):
    status, out, err = shell(f"terrain none.tif -o terrain.asc {where}")
    assert status == 2 and out == "" and len(err.splitlines()) == (where == "> /dev/full")


def test_a_warning_that_cannot_be_written_is_no_success():
    """polygon's option has another name now, of which a note tells."""
    with open("area.csv", "w", encoding="ascii") as area:
        area.write("5,5\n20,5\n20,20\n")
    assert shell(TERRAIN)[0] == 0
    words = "polygon area.csv --terrain terrain.asc --local -o out.csv"
    assert shell(f"{words} 2> /dev/full")[0] == 0 and shell(f"{words} --crs EPSG:6677 2> /dev/full")[0] == 2


@pytest.mark.parametrize("words, last", [(TERRAIN, "141"), ("--version", "141"),
                                         ("terrain none.tif -o terrain.asc", "2")])
def test_a_reader_that_went_away(words, last):
    status, out, err = shell(f"{words} | true; echo ${{PIPESTATUS[0]}}")
    assert (status, out) == (0, f"{last}\n") and len(err.splitlines()) == (last == "2")
    assert TERRAIN != words or is_made()


def test_a_reader_of_both_streams_that_went_away():
    assert shell(f"{TERRAIN} 2>&1 | true; echo ${{PIPESTATUS[0]}}")[1:] == ("141\n", "") and is_made()


def test_a_pipe_that_does_not_wait():
    """As of a parent that made it non-blocking: Python raises BlockingIOError once it is full."""
    whole = shell("study --describe")[1]
    assert len(whole) > 2 * PIPE
    read, write = os.pipe()
    fcntl.fcntl(write, fcntl.F_SETPIPE_SZ, PIPE)
    os.set_blocking(write, False)
    found = []
    reader = threading.Thread(target=lambda: found.append(os.fdopen(read, encoding="utf-8").read()))
    with subprocess.Popen([SLOPE, "study", "--describe"], stdout=write, stderr=subprocess.PIPE) as process:
        os.close(write)
        threading.Timer(0.5, reader.start).start()
        err = process.stderr.read()
    reader.join()
    assert (process.returncode, err) == (0, b"") and found == [whole]


def test_no_stream_is_no_terminal():
    assert not streams.is_terminal(None)


def test_runs_go_on_when_the_reader_goes_away(tiny_case):
    """With `| head -1`, after the first line, while runs are under way."""
    words = "study case/in.tiny --set rolling=0,0.1,0.2 --set steps=20 --jobs 1 -o out"
    status, out, err = shell(f"{words} | head -1; echo ${{PIPESTATUS[0]}}")
    assert status == 0 and len(out.splitlines()) == 2 and out.endswith("\n141\n")
    assert all("warning: " in line or "note: " in line for line in err.splitlines())        # of the runs, no error
    assert len(list((tiny_case / "out").glob("*/finished.yaml"))) == 3 and (tiny_case / "out/study.csv").is_file()


@pytest.mark.parametrize("where, said", [("> /dev/full", 2), (">&-", 0), (">&- 2>&-", 0)])
def test_runs_do_without_a_stream(tiny_case, where, said):
    status, _, err = shell(f"study case/in.tiny --set rolling=0.2 --set steps=20 -o out {where}")
    last = (err.splitlines() or [""])[-1]
    assert status == said and (last == f"slope study: {NO_SPACE}") == bool(said) and (err == "") == ("2>&-" in where)
    assert (tiny_case / "out/study.csv").is_file() and list((tiny_case / "out").glob("*/finished.yaml"))
