"""What the log of a run says."""
import functools
import re
from pathlib import Path
from typing import FrozenSet, Iterable, List, Optional, Sequence, Tuple

from . import decks

LOG = "log.lammps"
# lines in which SLOPE's styles and LAMMPS report what they made
NOTES = ("Region terrain", "Fix wall/gran/balls", "Fix deposit/grid", "Delete_balls:", "Create_balls:", "Created ")
TIMES = ("Time", "v_time")             # thermo columns; LAMMPS' own time restarts at 0 after read_restart
NUMBER = re.compile(r"\d[\d.,]*(?:[eE][+-]?\d+)?")
REMOVED = re.compile(r"Delete_balls: ([\d.]+) balls of group .*?; ([\d.]+) balls left")
REMOVED_SHARE = re.compile(r"Delete_balls: ([\d.]+) % of the volume of group")
FILLED = re.compile(r"Create_balls: \d+ balls of diameter \S+ fill region ")
LOST = re.compile(r"Fix deposit/grid \S+: ball \d+ left the box")
INPUT_PLACE = re.compile(r"\s*\([^()]*\.(?:cpp|h):\d+\)\s*$")     # LAMMPS names its source line at the end of a message


@functools.lru_cache(maxsize=4096)
def read_of(line: str) -> Tuple[Sequence[str], FrozenSet[str]]:
    """The words of a command, and those of them that may name files; the runs of a study have nearly the same."""
    said = decks.words_of(line)
    return said, frozenset(decks.read_words([said]) if said else ())


class Log:
    """What the log of a run says; update() reads what LAMMPS has added since.

    step, time, first, last: of the run command under way; time (s) is None without a thermo column time or v_time,
    last None before a run. thermo: number of lines of output since the command began. halted: the step at which fix
    halt ended a run. reading: a restart file was begun and not read to its end. The logs of a run that was cut and
    continued, see part(), are read as one.
    """

    def __init__(self, path):
        self.path = Path(path)
        self.place, self.rest = 0, ""
        self.parts = None         # logs of the parts before this one, as long as they are not read
        self.halted, self.reading = None, False
        self.lammps = self.wall = self.error = self.step = self.time = self.last = self.terrain = None
        self.density = None       # of the balls that the deck set first, kg/m3
        self.first, self.steps, self.thermo = 0, None, 0
        self.header: List[str] = []           # words of the thermo output under way
        self.warnings, self.settings, self.notes, self.table = [], [], [], []
        self.names = set()        # words of the commands that may name files which they read
        self.environment = set()  # environment variables that they read
        self.in_table = False

    def update(self):
        """Read on; a log that is not there yet is an empty one."""
        if self.parts is None:
            self.parts = earlier = parts(self.path)
            for path in earlier:
                self._read(path)
                self.place, self.rest = 0, ""
                self._new_part()
        self._read(self.path)
        return self

    def _read(self, path):
        try:
            with open(path, "rb") as log:
                log.seek(self.place)
                new = log.read()
        except OSError:
            return
        self.place += len(new)
        *lines, self.rest = (self.rest + new.decode("utf-8", "replace")).split("\n")
        for line in lines:
            self._line(line)

    def _new_part(self):
        """Forget what counts only in the last line of the log."""
        self.error = self.steps = self.last = None
        self.header = []
        self.thermo, self.reading = 0, False

    def _line(self, line):
        words = line.split()
        if not words:
            return
        if self.in_table and line.startswith("  "):
            self.table.append(line)
            return
        self.in_table = False
        if self.header and self._is_output(words):
            return
        if line.startswith("LAMMPS ("):
            self.lammps = self.lammps or line.strip()
            self._new_part()
        elif words[0] == "ERROR:" or line.startswith("ERROR on proc"):
            self.error = self.error or message(line)
        elif words[0] == "WARNING:":
            add(self.warnings, message(line).removeprefix("WARNING: "))
        elif line.startswith("Pair gran/restitution: contact coefficients"):
            self.table, self.in_table = [line], True
        elif line.startswith("Total wall time:"):
            self.wall = words[-1]
        elif line.startswith("Fix halt condition") and (match := re.search(r" on step (\d+)", line)):
            self.halted = int(match[1])
        elif line.startswith(NOTES):
            add(self.notes, line.strip())
        elif words[0] == "Step":
            self.header, self.thermo = words, 0
        elif words[0] == "Loop":
            self.header = []
        else:
            self._command(words, line)

    def _is_output(self, words):
        """Take a line of thermodynamic output; False if it is none."""
        if len(words) != len(self.header) or not re.fullmatch(r"\d+", words[0]):
            return False
        self.step = int(words[0])
        for name in TIMES:
            if name in self.header:
                self.time = float(words[self.header.index(name)])
        if self.thermo == 0:
            self.first = self.step
            if self.steps is not None:
                self.last = self.steps[0] if self.steps[1] else self.first + self.steps[0]
        self.thermo += 1
        return True

    def _command(self, words, line):
        """A command as the log echoes it; the last of its echoes has all variables replaced."""
        said, read = read_of(line)
        if said:
            self.names |= read
            if said[0] == "variable" and said[2:3] == ["getenv"] and len(said) > 3:
                self.environment.add(said[3])
        if "${" in line:
            return
        if words[0] == "run" and len(words) > 1 and words[1].isdigit():
            self.steps = int(words[1]), "upto" in words
        elif words[0] == "read_restart":
            self.reading = words[1] != "CPU"       # LAMMPS says last how long it took
        elif words[0] == "region" and words[2:3] == ["terrain"] and len(words) > 3 and self.terrain is None:
            self.terrain = words[3].strip("\"'")
        elif words[0] == "set" and "density" in words[:-1] and self.density is None:
            self.density = density_of(words[words.index("density") + 1])
        elif words[0] == "create_balls" and words[4:5] == ["fill"] and self.density is None:
            self.density = density_of(words[3])
        if (words[0] in ("pair_style", "pair_coeff", "timestep", "units", "lattice", "create_balls",
                         "neighbor")
                or (words[0] == "fix" and len(words) > 3)):
            add(self.settings, " ".join(line.split("#")[0].split()))


def density_of(word):
    """A density as a command has it; None where it is no number, such as a variable by atom."""
    try:
        return float(word)
    except ValueError:
        return None


def add(lines, line):
    """Append a line that is not among them."""
    if line not in lines:
        lines.append(line)


def parts(path):
    """The logs that part() put aside for a log, the oldest first."""
    path = Path(path)
    name = re.compile(rf"{re.escape(path.stem)}\.(\d+){re.escape(path.suffix)}")
    found = [(int(match[1]), other) for other in path.parent.glob("*") if (match := name.fullmatch(other.name))]
    return [other for _, other in sorted(found)]


def part(path):
    """Rename a log, log.lammps to log.1.lammps and so on: the run continues with a new one."""
    path = Path(path)
    path.rename(path.with_name(f"{path.stem}.{len(parts(path)) + 1}{path.suffix}"))


def message(line):
    """A message of LAMMPS without the place in its source."""
    return INPUT_PLACE.sub("", line.strip())


# --- what our own styles and LAMMPS say in words, which nothing but this file reads ---

def kind(line: str) -> str:
    """What a warning is about: removed (balls, at the start), lost (mass), or its words without their numbers."""
    return "removed" if REMOVED_SHARE.match(line) else "lost" if LOST.match(line) else NUMBER.sub("#", line)


def packed(lines: Iterable[str]) -> bool:
    """Whether balls began in a disordered packing, by the lines of a log."""
    return any(FILLED.match(line) for line in lines)


def removed(lines: Iterable[str]) -> Optional[float]:
    """Share of the balls that delete_balls took away, by the lines of a log; None if they do not tell."""
    lines = list(lines)
    for line in lines:
        if match := REMOVED.search(line):
            gone, left = float(match[1]), float(match[2].rstrip("."))
            return gone / (gone + left) if gone + left > 0 else None
    for line in lines:
        if match := REMOVED_SHARE.search(line):
            return min(float(match[1]), 99.0) / 100
    return None
