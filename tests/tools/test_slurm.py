"""tools/slope study --engine slurm, on a real Slurm in a folder: three nodes on this machine; and --launcher."""
import getpass
import os
import re
import shlex
import shutil
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest

import tiny_collapse

from messages import is_one

from slope_tools import cli, processes
from slope_tools.errors import SlopeError
from slope_tools.runs import job_display, jobs, launcher, slurm as engine

TOP = tiny_collapse.TOP
TOOLS = Path(os.environ.get("SLOPE_TOOLS", TOP / "tools"))
PROGRAM = [sys.executable, str(TOOLS / "slope")]
PATH = f"{os.environ['PATH']}:/usr/sbin:/sbin"
CONF = """\
ClusterName=test
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={ports[0]}
AuthType=auth/munge
AuthInfo=socket={folder}/munge/s
CredType=cred/munge
SlurmUser={user}
SlurmdUser={user}
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool-%n
SlurmctldPidFile={folder}/ctld.pid
SlurmdPidFile={folder}/slurmd-%n.pid
SlurmctldLogFile={folder}/ctld.log
SlurmdLogFile={folder}/slurmd-%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
MpiDefault=none
ReturnToService=2
SchedulerParameters=sched_interval=2
JobAcctGatherType=jobacct_gather/none
NodeName=n1 NodeHostname={host} NodeAddr=127.0.0.1 Port={ports[1]} CPUs=1 State=UNKNOWN
NodeName=n2 NodeHostname={host} NodeAddr=127.0.0.1 Port={ports[2]} CPUs=1 State=UNKNOWN
NodeName=n3 NodeHostname={host} NodeAddr=127.0.0.1 Port={ports[3]} CPUs=1 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""


def free_ports(number):
    several = [socket.socket() for _ in range(number)]
    for one in several:
        one.bind(("127.0.0.1", 0))
    ports = [one.getsockname()[1] for one in several]
    for one in several:
        one.close()
    return ports


def slurm(*words):
    return subprocess.run(words, capture_output=True, text=True, check=True, timeout=60).stdout


@pytest.fixture
def here(tiny_case):
    return tiny_case


class Stub:
    """Of a task of an array: whether it runs."""

    def __init__(self, running):
        self.running = running


def test_the_end_of_all_is_reckoned_with_the_tasks_that_run(here):
    """Not with the cores of this machine; --jobs, which study.yaml has, stays what it was."""
    program = here / "lmp"
    program.write_bytes(b"")
    (here / "out").mkdir()
    (here / "out" / ".inputs").symlink_to(here / "case")
    work = engine.Work(here / "case" / "in.tiny", {}, here / "out" / ".inputs", program, 1, 2)
    todo = [jobs.Run(here / "out", {"rolling": str(i)}) for i in range(30)]
    display = job_display.Display(todo, todo, work.at_a_time)
    display.walls, display.queue = {1.0: [60.0, 120.0]}, todo[:20]
    for running, ends in ((0, 1800), (6, 300), (10, 180)):
        work.active = [jobs.Active(one, Stub(i < running), 0.0) for i, one in enumerate(todo)]
        assert len(work._shown()) == running
        assert display._ends(20) == pytest.approx(ends)
        assert work.jobs == 2


@pytest.fixture
def cluster(here, monkeypatch):
    """munged, slurmctld and three slurmd; SLURM_CONF leads to them."""
    monkeypatch.setenv("PATH", PATH)
    for name in ("munged", "slurmctld", "slurmd", "sbatch"):
        if not shutil.which(name, path=PATH):
            pytest.skip(f"{name} is not installed (Debian: slurm-wlm, munge)")
    folder = here / "slurm"
    for name in ("munge", "state", "spool-n1", "spool-n2", "spool-n3"):
        (folder / name).mkdir(parents=True, mode=0o755)
    key = folder / "munge" / "key"
    key.write_bytes(os.urandom(64))
    key.chmod(0o600)
    conf = folder / "slurm.conf"
    conf.write_text(CONF.format(host=socket.gethostname().split(".")[0], ports=free_ports(4), folder=folder,
                                user=getpass.getuser()))
    monkeypatch.setenv("SLURM_CONF", str(conf))
    munge = folder / "munge"
    daemons = [["munged", "--foreground", "--force", f"--key-file={key}", f"--socket={munge}/s",
                f"--pid-file={munge}/pid", f"--log-file={munge}/log", f"--seed-file={munge}/seed"],
               ["slurmctld", "-D", "-f", str(conf)], *(["slurmd", "-D", "-N", f"n{i}", "-f", str(conf)]
                                                       for i in (1, 2, 3))]
    running = []
    try:
        for words in daemons:
            running.append(subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                            stderr=subprocess.DEVNULL))
            time.sleep(1)
        end = time.monotonic() + 60
        while subprocess.run(["sinfo", "-h", "-o", "%t %D"], capture_output=True, text=True,
                             check=False).stdout.split() != ["idle", "3"]:
            if time.monotonic() > end or any(one.poll() is not None for one in running):
                pytest.skip("Slurm does not start here: " + (folder / "ctld.log").read_text()[-200:]
                            if (folder / "ctld.log").exists() else "Slurm does not start here")
            time.sleep(0.5)
        yield folder
    finally:
        for one in reversed(running):
            one.terminate()
        for one in running:
            try:
                one.wait(20)
            except subprocess.TimeoutExpired:
                one.kill()


def table(folder):
    return [{key: value for key, value in row.items() if key != "wall_s"}
            for row in tiny_collapse.rows_of(Path(folder) / "study.csv")]


def states():
    return dict(line.split()[:2] for line in slurm("squeue", "-h", "-r", "-o", "%F_%K %T").splitlines())


def test_an_array_goes_on_when_runs_are_cancelled_and_a_node_is_drained(cluster, here, monkeypatch):
    """No run begins before one was cancelled: the program waits for a file."""
    held = here / "lmp"
    held.write_text(f"""#!/bin/bash
while ! [[ "$*" == *-h* || -e {here}/begin ]]; do sleep 0.1; done
exec {tiny_collapse.LMP} "$@"
""")
    held.chmod(0o755)
    monkeypatch.setenv("LMP", str(held))
    lists = "study case/in.tiny --set rolling=0:0.11:0.01"
    process = subprocess.Popen([*PROGRAM, *shlex.split(f"{lists} --engine slurm -o out")], stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE, text=True)
    end = time.monotonic() + 120
    while list(states().values()).count("RUNNING") < 3:
        assert time.monotonic() < end and process.poll() is None
        time.sleep(0.2)
    assert len(states()) == 12
    running = [name for name, state in states().items() if state == "RUNNING"]
    waiting = [name for name, state in states().items() if state == "PENDING"]
    slurm("scancel", running[0], waiting[-1])
    slurm("scontrol", "update", "nodename=n2", "state=drain", "reason=test")
    while running[0] in states():
        assert time.monotonic() < end and process.poll() is None
        time.sleep(0.2)
    (here / "begin").touch()
    out, err = process.communicate(timeout=500)
    assert process.returncode == 0, err

    # both that were cancelled are submitted again; under load another one, too, whose status comes late
    tasks = re.findall(r"\] (\S+): .*task (\d+) of Slurm's array (\d+)", out)
    of = {f"{array}_{task}": name for name, task, array in tasks}
    again = [name for name, _, array in tasks if array != tasks[0][2]]
    assert {of[running[0]], of[waiting[-1]]} <= set(again) and len(tasks) - len(again) == 12
    assert cli.main(shlex.split(f"{lists} -o local")) == 0
    assert table("out") == table("local") and len(table("out")) == 12
    assert not states()


def test_an_interruption_cancels_the_array(cluster, here):
    process = subprocess.Popen([*PROGRAM, *shlex.split("study case/in.tiny --set rolling=0,0.1 --set steps=200000 "
                                                       "--engine slurm -o out")], stdout=subprocess.DEVNULL)
    end = time.monotonic() + 60
    while "RUNNING" not in states().values():
        assert time.monotonic() < end and process.poll() is None
        time.sleep(0.2)
    process.terminate()
    assert process.wait(90) == 130
    assert not states()


# --- programs in place of Slurm's ---

SBATCH = """\
for word; do case $word in --array=*) array=${word#--array=};; esac; script=$word; done
range=${array%%%*}; last=${range#0-}
if [ -n "$MAX" ] && [ $last -ge $MAX ]; then echo "sbatch: error: $REFUSAL" >&2; exit 1; fi
queued=$(find QUEUE -name '*_*' | wc -l)
if [ -n "$MOST" ] && [ $((queued + last + 1)) -gt $MOST ]; then echo "sbatch: error: $REFUSAL" >&2; exit 1; fi
number=$(($(cat QUEUE/number) + 1)); echo $number > QUEUE/number
echo "$array" >> QUEUE/arrays
for ((i = 0; i <= last; i++)); do
  touch QUEUE/${number}_$i
  (SLURM_ARRAY_TASK_ID=$i bash "$script"; rm QUEUE/${number}_$i) > /dev/null 2>&1 < /dev/null &
done
printf -- "$ANSWER" $number
"""
SQUEUE = """\
printf -- "$BANNER"
cd QUEUE
for file in *_*; do
  [ -e $file ] && case "$*" in *%T*) echo $file RUNNING;; *) echo ${file%_*};; esac
done
true
"""
BANNER = "-----\\n    Welcome to the machine of 2026\\n\\n--> Valid submit host...OK\\n"


@pytest.fixture
def stand_ins(here, monkeypatch):
    """sbatch, squeue and scancel of a folder, which gets the numbers of the arrays; variables say what they answer."""
    place = here / "queue"
    place.mkdir()
    (place / "number").write_text("100")
    for name, words in {"sbatch": SBATCH, "squeue": SQUEUE, "scancel": 'echo "$*" >> QUEUE/cancelled'}.items():
        (place / name).write_text("#!/bin/bash\n" + words.replace("QUEUE", str(place)))
        (place / name).chmod(0o755)
    monkeypatch.setenv("PATH", f"{place}:{os.environ['PATH']}")
    monkeypatch.setenv("ANSWER", "%d\\n")
    monkeypatch.setenv("REFUSAL", "Batch job submission failed: Invalid job array specification")
    return place


def study(words, rolling=(0, 0.1, 0.2), out="out"):
    several = ",".join(map(str, rolling))
    return cli.main(["study", "case/in.tiny", "--set", "steps=20", "--set", f"rolling={several}", "--engine", "slurm",
                     "-o", out, *words])


def error_of(capsys):
    """The one line of a command that was refused."""
    [line] = [line for line in capsys.readouterr().err.splitlines() if "warning: " not in line]
    return line


def arrays(place):
    return (place / "arrays").read_text().split()


@pytest.mark.parametrize("answer", [
    BANNER + "%d\\n", "%d;cluster\\n", "sbatch: INFO: project quota is at 90 %%%%\\n%d\\n", "\\n  %d  \\n\\n",
    "Submitted batch job %d\\n", BANNER + "Submitted batch job %d on cluster main\\n", "%d\\n" + BANNER])
def test_a_banner_around_the_number(stand_ins, monkeypatch, answer):
    monkeypatch.setenv("ANSWER", answer)
    monkeypatch.setenv("BANNER", BANNER)        # of squeue
    assert study([], (0, 0.1)) == 0 and arrays(stand_ins) == ["0-1"]
    assert (Path("out") / engine.FOLDER / engine.KNOWN).read_text().split() == ["101"]


@pytest.mark.parametrize("answer", ["", "Welcome\\n", "17\\n%d\\nWelcome\\n", "job %d is queued\\n"])
def test_an_answer_without_one_number_is_shown(stand_ins, monkeypatch, capsys, answer):
    monkeypatch.setenv("ANSWER", answer)
    assert study([], (0,)) == 2 and arrays(stand_ins) == ["0-0"]
    line = error_of(capsys)
    assert "--engine slurm: sbatch must answer with the number" in line and answer.split("\\n")[0][:4] in line


@pytest.mark.parametrize("option", [
    "--array=0-3%1", "--array 0-3", "--arr=0-3", "-a0-3", "-a 0-3", "-Ha0-3", "--parsable", "--wait", "-W", "-QW",
    "--test-only", "--test", "--wrap=ls"])
def test_options_that_the_study_sets_are_refused(stand_ins, capsys, option):
    assert study([f"--slurm=--partition=all {option}"], (0,)) == 2
    assert error_of(capsys).endswith(f"got {option.split()[0]}")
    assert not (stand_ins / "arrays").exists() and not Path("out").exists()


def test_other_options_are_not():
    for words in ("--account=a -A a", "-p all --partition all", "--wait-all-nodes=1 -w n1", "--acctg-freq=1"):
        try:
            engine.check_slurm(words)
        except SlopeError as error:
            assert not str(error).startswith("--slurm")


@pytest.mark.parametrize("words, wanted", [([], ["0-1", "0-0"]), (["--jobs", "2"], ["0-1%2", "0-0%2"])])
def test_an_array_that_is_too_large_is_submitted_in_parts(stand_ins, monkeypatch, words, wanted):
    monkeypatch.setenv("MAX", "2")
    assert study(words) == 0 and arrays(stand_ins) == wanted
    assert len(list(Path("out").glob("*/finished.yaml"))) == 3


@pytest.mark.parametrize("refusal", [
    "QOSMaxSubmitJobPerUserLimit", "Batch job submission failed: Job violates accounting/QOS policy (job submit limit, "
    "user's size and/or time limits)"])
def test_a_limit_of_submitted_jobs_is_waited_for(stand_ins, monkeypatch, refusal):
    monkeypatch.setenv("MOST", "2")
    monkeypatch.setenv("REFUSAL", refusal)
    assert study([], (0, 0.1, 0.2, 0.3)) == 0 and len(list(Path("out").glob("*/finished.yaml"))) == 4


@pytest.mark.parametrize("refusal, tries", [("Invalid partition name specified", 1),
                                            ("Requested time limit is invalid", 2)])
def test_another_refusal_is_said(stand_ins, monkeypatch, capsys, refusal, tries):
    monkeypatch.setenv("MAX", "0")
    monkeypatch.setenv("REFUSAL", refusal)
    assert study([], (0, 0.1)) == 2
    assert f"--engine slurm: sbatch failed: sbatch: error: {refusal}" in error_of(capsys)
    assert len(list((Path("out") / engine.FOLDER).glob("*.runs"))) == tries


@pytest.mark.parametrize("name", ["a\tb", "a\nb", "it's \\t $HOME `x`", "grün"])
def test_any_name_of_a_folder(stand_ins, name):
    Path(name).mkdir()
    assert study([], (0,), f"{name}/out") == 0 and arrays(stand_ins) == ["0-0"]


def test_a_task_beyond_the_array_leaves_nothing(stand_ins, monkeypatch):
    assert study([], (0,)) == 0
    script = next((Path("out") / engine.FOLDER).glob("*.sh")).resolve()
    Path("empty").mkdir()
    monkeypatch.setenv("SLURM_ARRAY_TASK_ID", "5")
    subprocess.run(["bash", script], cwd="empty", check=False)
    assert not list(Path("empty").iterdir())


# --- a queue that does not answer ---

@pytest.fixture
def queue(monkeypatch):
    """A Queue whose squeue answers with what is put into `says`: text, or None where it fails."""
    one = engine.Queue()
    one.says = None

    def call(*words):
        if one.says is None:
            raise SlopeError("--engine slurm", f"{words[0]} failed: Socket timed out on send/recv operation")
        return one.says
    monkeypatch.setattr(engine, "call", call)
    monkeypatch.setattr(engine, "LOOK", -1.0)
    return one


def test_a_queue_that_is_silent_for_a_while_cancels_nothing(queue, tmp_path, monkeypatch):
    monkeypatch.setattr(engine, "PATIENCE", -1.0)
    known, new = (engine.Task(name, tmp_path / name, queue) for name in ("7_0", "8_0"))
    queue.says = "7_0 RUNNING\n"
    assert known.poll() is None and known.running
    queue.says = None
    for _ in range(3):      # the new one was never seen, which is no sign that it left the queue
        assert known.poll() is None and new.poll() is None and known.running and not new.lost
    queue.says = "7_0 RUNNING\n8_0 PENDING\n"
    assert new.poll() is None and queue.states()["8_0"] == "PENDING" and queue.silent is None
    queue.says = "8_0 PENDING\n"
    assert [known.poll(), known.poll()][-1] == -9 and known.lost and new.poll() is None


def test_a_queue_that_is_silent_for_long_ends_the_study(queue, monkeypatch):
    assert queue.states() == {}
    monkeypatch.setattr(engine, "SILENCE", -1.0)
    with pytest.raises(SlopeError, match="squeue failed: Socket timed out"):
        queue.states()


def test_cancelling_does_not_hide_the_first_error(queue, monkeypatch):
    monkeypatch.setattr(engine.processes, "PATIENCE", 0.1)
    engine.Work._cancel(["7", "8"])


# --- what starts the ranks ---

@pytest.mark.parametrize("start, ranks, expected", [
    (None, 1, []), (None, 2, ["mpirun", "-np", "2", "--bind-to", "none"]),
    (None, 4, ["mpirun", "-np", "4", "--bind-to", "none", "--oversubscribe"]),
    ("srun --mpi=pmix", 4, ["srun", "--mpi=pmix", "-n", "4"]),
    ("mpiexec -n {np} -genv 'A B'", 2, ["mpiexec", "-n", "2", "-genv", "A B"]),
])
def test_words_of_a_launcher(start, ranks, expected):
    assert launcher.list_launcher_words(start, ranks, 2) == expected


def test_messages_go_at_once_in_every_open_mpi(monkeypatch):
    """The kind of memory that ranks share has another name since Open MPI 5; a user's own limit stands."""
    for name in processes.EAGER:
        monkeypatch.delenv(name, raising=False)
    assert [processes.environment()[name] for name in processes.EAGER] == ["131072"] * 2
    monkeypatch.setenv(processes.EAGER[1], "4096")
    assert [processes.environment().get(name) for name in processes.EAGER] == [None, "4096"]


def test_more_ranks_than_tasks_of_slurm(tmp_path, monkeypatch):
    """In `sbatch -n 1 -c 2`, of whose variables Open MPI makes one slot."""
    host = socket.gethostname()
    for name, value in (("JOB_ID", "1"), ("JOBID", "1"), ("NODELIST", host), ("JOB_NODELIST", host), ("NNODES", "1"),
                        ("NTASKS", "1"), ("TASKS_PER_NODE", "1"), ("CPUS_PER_TASK", "2")):
        monkeypatch.setenv(f"SLURM_{name}", value)
    monkeypatch.delenv("OMPI_MCA_rmaps_base_oversubscribe", raising=False)
    with open(tmp_path / "screen", "w", encoding="ascii") as screen:
        started = processes.start([*launcher.list_launcher_words(None, 2, jobs.slots()), "true"], tmp_path, screen)
    assert started.wait(60) == 0, (tmp_path / "screen").read_text()
    monkeypatch.setenv("SLURM_TASKS_PER_NODE", "16(x2),3")
    assert jobs.slots() == 16


def test_pages_bind_no_run_to_cores():
    """Open MPI binds the ranks of each run to the same cores."""
    pages = (TOP / "README.md", *(TOP / "doc" / "src").glob("*.rst"), *(TOP / "inputs").glob("*/README.md"))
    lines = [line for path in pages for line in path.read_text(encoding="utf-8").splitlines() if "mpirun -np" in line]
    assert len(lines) > 3 and [line for line in lines if "--bind-to none" not in line] == []


def test_a_run_is_started_by_the_launcher(here):
    Path("mine").write_text("#!/bin/sh\nprintf '%s ' \"$@\" > started\nshift 2\nexec \"$@\"\n")
    Path("mine").chmod(0o755)
    assert cli.main(shlex.split(f"study case/in.tiny --set steps=20 --launcher {here}/mine -o out")) == 0
    assert (here / "out" / "steps_20" / "started").read_text().startswith(f"-n 1 {tiny_collapse.LMP} -in in.tiny")


def test_a_launcher_of_the_working_folder_is_found_from_that_of_a_run(here, monkeypatch):
    Path("mine.sh").write_text("#!/bin/sh\nshift 2\nexec \"$@\"\n")
    Path("mine.sh").chmod(0o755)
    assert launcher.list_launcher_words("./mine.sh --fast", 2, 2) == [f"{here}/mine.sh", "--fast", "-n", "2"]
    assert launcher.list_launcher_words("./mine.sh {np}", 2, 2) == [f"{here}/mine.sh", "2"]
    assert cli.main(shlex.split("study case/in.tiny --set steps=20 --launcher ./mine.sh -o out")) == 0


@pytest.mark.parametrize("words, message", [
    ("--launcher nonsense", "--launcher: must begin with a program on the PATH, got nonsense"),
    ("--launcher '\"'", "--launcher: must be a command"),
    ("--slurm=--time=1", "--slurm: must be given with --engine slurm, got --time=1"),
])
def test_wrong_launchers_are_one_line(here, capsys, words, message):
    assert cli.main(shlex.split(f"study case/in.tiny --set steps=20 {words} -o out")) == 2
    err = capsys.readouterr().err
    assert is_one(err, f"slope study: {message}"), err


def test_without_slurm_it_is_said(here, capsys, monkeypatch):
    monkeypatch.setenv("PATH", "/nowhere")
    assert cli.main(shlex.split("study case/in.tiny --set steps=20 --engine slurm -o out")) == 2
    assert capsys.readouterr().err == ("slope study: --engine slurm: needs sbatch of Slurm, which is not on the "
                                       "PATH\n")
