"""How far the runs of a study are: a table that renews itself on a terminal, else a line now and then."""
import datetime
import math
import sys
import time
from typing import Dict, List

from rich.console import Console
from rich.live import Live
from rich.progress_bar import ProgressBar
from rich.table import Table

from .. import findings, streams
from ..case.settings import normalise_value

DIAMETER = "d"          # variable of a deck: the size of the balls
TELL = 30.0             # s between two lines about a run, where there is no terminal


class Display:
    """Shows how far the runs are: a table that renews itself on a terminal, else a line now and then."""

    def __init__(self, todo, waiting, at_a_time, halts=False):
        """waiting: runs to make, without those that were started; at_a_time(): how many runs may be active at a time;
        halts: most end before their last step, a time limit, which says nothing of their end."""
        self.total, self.waiting, self.at_a_time, self.queue = len(todo), len(waiting), at_a_time, waiting
        self.numbers = {one.name: i for i, one in enumerate(todo, 1)}
        self.ended_runs = self.failed = 0
        self.walls: Dict[float, List[float]] = {}      # by the diameter of balls
        self.halts = halts
        self.printed = {}      # name -> when the last line about it was printed
        self.live = None
        self.share = 0.0       # done, as it was said last
        if streams.is_terminal(sys.stderr) and not findings.as_json:
            # without auto_refresh there is no thread, and the study may fork
            self.live = Live(console=Console(stderr=True), auto_refresh=False, transient=True)
        self.done_before = self.total - self.waiting

    def __enter__(self):
        if self.done_before:
            self.say(f"{self.done_before} of {self.total} runs are finished already")
            self._say_share()
        if self.live:
            self.live.start()
        return self

    def __exit__(self, kind, *_):
        if self.live:
            self.live.stop()
        if kind is not None and issubclass(kind, KeyboardInterrupt):
            done = self.done_before + self.ended_runs - self.failed
            self.say(f"stopped with {done} of {self.total} runs finished; the same command continues")

    def say(self, line):
        if self.live:
            self.live.console.print(line, markup=False, highlight=False)
        else:
            print(line, flush=True)

    def label(self, run):
        return f"[{self.numbers[run.name]}/{self.total}] {run.name}"

    def started(self, run, state):
        self.printed[run.name] = time.monotonic()
        if not self.live or state != "started":
            self.say(f"{self.label(run)}: {state}")

    def ended(self, active):
        run, wall = active.run, time.monotonic() - active.began
        self.ended_runs += 1
        self.walls.setdefault(read_run_diameter(run), []).append(wall)
        self._say_share()
        if run.error:
            self.failed += 1
            self.say(f"{self.label(run)}: failed: {run.error}")
        else:
            at = f" at {run.log.time:.1f} s" if run.log.time is not None else ""
            since = f" since step {run.restart[0]}" if run.restart else ""
            self.say(f"{self.label(run)}: finished{at}, wall time {duration(wall)}{since}{self._to_go()}")

    def _to_go(self):
        """How many runs are left and when they will have ended, for those who see no table."""
        left = self.waiting - self.ended_runs
        return "" if self.live or left <= 0 else f"; {left} to go, all by {clock(self._ends(left))}"

    def _ends(self, left):
        """Seconds that so many runs take, as those before of their sizes did."""
        waiting = [self._wall(read_run_diameter(run)) for run in self.queue]
        under_way = max(0, left - len(waiting)) * max(map(self._wall, self.walls)) / 2
        return (sum(waiting) + under_way) / self.at_a_time()

    def _wall(self, d):
        """Of a run with balls of a diameter; half of it makes 8 times the balls, and twice the steps."""
        like = min(self.walls, key=lambda diameter: abs(math.log(diameter / d)))
        return sum(self.walls[like]) / len(self.walls[like]) * (like / d) ** 4

    def update(self, active, waiting):
        if self.live:
            return self.live.update(self._table(active, waiting), refresh=True)
        self._say_share(active)
        for job in active:
            if time.monotonic() - self.printed[job.run.name] > TELL:
                self.printed[job.run.name] = time.monotonic()
                _, text, end = self._progress(job)
                self.say(f"{self.label(job.run)}: {text}" + (f", ends by {end}" if end else ""))
        return None

    def _say_share(self, active=()):
        """How much of all runs is done, for programs that call this one, if it has changed by 1 %."""
        if not findings.as_json:
            return
        share = (self.done_before + self.ended_runs + sum(self._progress(job)[0] or 0 for job in active)) / self.total
        if abs(share - self.share) >= 0.01:
            self.share = share
            findings.say_json("progress", share=share, runs=self.total, ended=self.done_before + self.ended_runs,
                              failed=self.failed)

    def _progress(self, job):
        """Share done (None if unknown), a text for the user, and when it ends, "" where it may rest before."""
        log = job.run.log
        if log.thermo == 0:
            return None, "setting up", ""
        text = f"step {log.step}" + (f" of {log.last}" if log.last else "")
        if log.time is not None:
            text += f", {log.time:.2f} s"
        if not log.last or log.last <= log.first:
            return None, text, ""
        share = (log.step - log.first) / (log.last - log.first)
        spent = time.monotonic() - job.began
        return share, text, clock(spent * (1 - share) / share) if share > 0 and not self.halts else ""

    def _table(self, active, waiting):
        table = Table(box=None, padding=(0, 2, 0, 0))
        table.add_column("run", no_wrap=True)
        table.add_column("", no_wrap=True)
        for head in ("step", "ends by"):
            table.add_column(head, no_wrap=True, min_width=8)
        for job in active:
            share, text, end = self._progress(job)
            table.add_row(f"[{self.numbers[job.run.name]}/{self.total}] {job.run.varied}",
                          ProgressBar(100, 100 * (share or 0), width=12), text, end)
        ends = ""
        if self.walls and waiting:
            ends = clock(self._ends(waiting + len(active)))
        table.add_row(f"{self.done_before + self.ended_runs - self.failed} of {self.total} finished"
                      + (f", {self.failed} failed" if self.failed else ""), "", f"{waiting} waiting", ends,
                      style="dim")
        return table


def read_run_diameter(run):
    """Of the balls of a run, m; 1 where its values do not say it."""
    value = normalise_value(run.chosen.get(DIAMETER, ""))
    return value if isinstance(value, float) and 0 < value < math.inf else 1.0


def duration(seconds):
    """Such as 1:02:03, or 4.5 s."""
    return f"{seconds:.1f} s" if seconds < 60 else str(datetime.timedelta(seconds=round(seconds)))


def clock(seconds):
    """The time of day in so many seconds, with the date if that is not today."""
    today = datetime.datetime.now()
    then = today + datetime.timedelta(seconds=seconds)
    return then.strftime("%H:%M:%S" if then.date() == today.date() else "%Y-%m-%d %H:%M")
