"""Programs that run beside the tools: how they are started and ended. The one place that knows."""
import errno
import os
import shutil
import signal
import subprocess
import tempfile
import time
import weakref
from contextlib import suppress
from pathlib import Path
from typing import Dict, Iterable, Sequence

SESSION = "OMPI_MCA_orte_tmpdir_base"       # where Open MPI 4 makes its session folders
EAGER = ("OMPI_MCA_btl_vader_eager_limit", "OMPI_MCA_btl_sm_eager_limit")       # of Open MPI 4; from 5 on
PATIENCE = 10.0         # s that a program gets to end after SIGTERM


def environment() -> Dict[str, str]:
    """Of a program that may be run by mpirun."""
    values = {**os.environ, "OMP_NUM_THREADS": "1"}
    # Open MPI on one machine: what a rank sends each step goes at once, without a handshake
    if not any(name in values for name in EAGER):
        values.update(dict.fromkeys(EAGER, "131072"))
    if os.geteuid() == 0:
        values.update(OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
    return values


def start(words: Sequence[str], folder: Path, screen, alone: bool = False) -> subprocess.Popen:
    """Start a program in a folder; what it says goes to the open file `screen`. OSError if it is not there.

    It has a session of its own: Ctrl-C reaches the tools, which then end it. It does not outlive them.
    alone: it is one rank, which nothing launches: Open MPI 5 leaves the folder and the memory of such a rank behind.
    """
    if shutil.which(words[0]) is None:
        raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), words[0])
    values = environment()
    session = None
    if SESSION not in values:       # two programs that start at once fail now and then over the folder of both
        session = values[SESSION] = tempfile.mkdtemp(prefix="slope")       # short: sockets go there
        # a run without mpirun starts half a second sooner without a daemon for processes that it never adds
        values.setdefault("OMPI_MCA_ess_singleton_isolated", "1")
        if alone:
            values["TMPDIR"] = session
            values.setdefault("OMPI_MCA_btl_sm_backing_directory", session)
    guard = ["setpriv", "--pdeathsig", "TERM"] if shutil.which("setpriv") else []
    try:
        process = subprocess.Popen([*guard, *words], cwd=folder, env=values, stdin=subprocess.DEVNULL, stdout=screen,
                                   stderr=subprocess.STDOUT, start_new_session=True)
    except BaseException:
        if session:
            shutil.rmtree(session, ignore_errors=True)
        raise
    if session:
        weakref.finalize(process, shutil.rmtree, session, ignore_errors=True)
    return process


def stop_session(process: subprocess.Popen) -> None:
    """End a program that start() started, and all that it started and left."""
    stop([process])
    with suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)


def stop(running: Iterable) -> None:
    """End programs, each by its own process id; those that do not listen are killed."""
    waiting = [one for one in running if one.poll() is None]
    for process in waiting:
        process.terminate()
    deadline = time.monotonic() + PATIENCE
    for process in waiting:
        try:
            process.wait(max(0.1, deadline - time.monotonic()))
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
