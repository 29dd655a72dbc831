"""Decks, and the folders in which they ran: what a deck asks for, what its log says, what fix deposit/grid wrote."""
import datetime
import math
import os
import platform
import re
import struct
import subprocess
from pathlib import Path

import yaml

from . import rasters
from .errors import SlopeError

LOG = "log.lammps"
VARIABLES = "variables.yaml"       # what `slope study` runs, written before the run
MARKER = "finished.yaml"           # written when the run is complete
# what our styles and LAMMPS say of what they made
NOTES = ("Region terrain", "Fix wall/gran/balls", "Fix deposit/grid", "Delete_balls:", "Create_balls:", "Created ")
TIMES = ("Time", "v_time")             # thermo columns; LAMMPS' own time begins anew after read_restart
MAGIC = b"LammpS RestartT\0"           # the first and the last bytes of a restart file
WORD = re.compile(r'"""(.*?)"""|"([^"]*)"|\'([^\']*)\'|(\S+)')
INPUT_PLACE = re.compile(r"\s*\([^()]*\.(?:cpp|h):\d+\)\s*$")     # LAMMPS names its source line at the end of a message
SUMMARY_KEYS = {"volume": ("released", "on_grid", "off_grid", "lost", "residual"),
                "travel": ("front", "front_at_release", "centroid", "reach_angle"),
                "largest": ("thickness", "max_thickness", "max_speed", "max_energy"),
                "stop": ("step", "time", "reason"), "grid": ("cell", "extent"), "balls": ("released", "lost"),
                "motion": ("moving_share", "threshold"), "moving": (), "ranks": (), "dt": (), "bulk_factor": (),
                "slope_version": (), "lammps_version": (), "change_rate": (),
                "guards": ("largest_overlap", "deep_contacts", "energy_growth", "dangerous_builds")}
OPTIONAL = {"change_rate", "guards"}        # among them: older summaries, and other pair styles, have none
NO_NUMBERS = {"reason", "extent", "moving", "slope_version", "lammps_version"}    # among them
ABOVE_ZERO = {("volume", "released"), ("balls", "released"), ("grid", "cell"), ("dt", None), ("bulk_factor", None)}


# --- decks ---

# words of a command that name files which it writes
WRITTEN_AT = {"restart": (2, 4), "write_restart": (1, 2), "write_data": (1, 2), "write_dump": (3, 4), "dump": (5, 6),
              "log": (1, 2)}


def commands(deck):
    """The commands of a deck and of the files that it includes by name: lists of words, comments taken off."""
    found, waiting, seen = [], [Path(deck)], set()
    while waiting:
        path = waiting.pop(0)
        seen.add(path)
        try:
            text = path.read_text(encoding="utf-8", errors="replace")
        except OSError as error:
            raise SlopeError(path, f"must be a LAMMPS input deck ({error.strerror})") from error
        for line in re.sub(r"&[ \t]*\n", " ", text).splitlines():
            words = []
            for match in WORD.finditer(line):
                if match.lastindex == 4 and "#" in match[4]:
                    words += [match[4].split("#")[0]] * (not match[4].startswith("#"))
                    break
                words.append(match[match.lastindex])
            if not words:
                continue
            found.append(words)
            included = Path(deck).parent / words[-1]
            if words[0] == "include" and included.is_file() and included not in seen:
                waiting.append(included)
    return found


def variables(deck):
    """{name: (style, text)} of a deck's `variable` commands; the first of a name counts, as for index variables."""
    found = {}
    for words in commands(deck):
        if words[0] == "variable" and len(words) > 2:
            found.setdefault(words[1], (words[2], " ".join(words[3:])))
    return found


def named_files(deck):
    """Words of a deck that may name files which it reads, and those with which it names files that it writes.

    Variables of style index or string are filled in; a word that stands in both places is in both sets.
    """
    values = {name: text for name, (style, text) in variables(deck).items() if style == "string"}
    values |= index_variables(deck)

    def fill(word):
        return re.sub(r"\$(?:\{(\w+)\}|(\w))", lambda match: values.get(match[1] or match[2], match[0]), word)

    read, written = set(), set()
    for words in commands(deck):
        first, last = WRITTEN_AT.get(words[0], (0, 0))
        for k, word in enumerate(words):
            keyword = words[k - 1] if k and words[0] in ("fix", "print") else ""
            writes = first <= k < last or keyword in ("write", "append") or (
                keyword == "file" and (words[0] == "print" or re.match("ave/|print|vector", " ".join(words[3:4]))))
            (written if writes else read).update((word, fill(word)))
    return read, written


def index_variables(deck):
    """{name: default} of the variables that -var can set."""
    return {name: text.split()[0] if text else "" for name, (style, text) in variables(deck).items()
            if style == "index"}


# --- logs ---

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
        self.first, self.steps, self.thermo, self.header = 0, None, 0, None
        self.warnings, self.settings, self.notes, self.table = [], [], [], []
        self.names = set()        # words of the commands: which files they name
        self.in_table = False

    def update(self):
        """Read on; a log that is not there yet is an empty one."""
        if self.parts is None:
            self.parts = parts(self.path)
            for path in self.parts:
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
        """Forget what counts only if it is the last that was heard."""
        self.error = self.header = self.steps = self.last = None
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
            self.error = self.error or told(line)
        elif words[0] == "WARNING:":
            add(self.warnings, told(line).removeprefix("WARNING: "))
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
            self.header = None
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
        self.names.update(words)
        if "${" in line:
            return
        if words[0] == "run" and len(words) > 1 and words[1].isdigit():
            self.steps = int(words[1]), "upto" in words
        elif words[0] == "read_restart":
            self.reading = words[1] != "CPU"       # LAMMPS says last how long it took
        elif words[0] == "region" and words[2:3] == ["terrain"] and len(words) > 3 and self.terrain is None:
            self.terrain = words[3].strip("\"'")
        if (words[0] in ("pair_style", "pair_coeff", "timestep", "units", "lattice", "neighbor")
                or (words[0] == "fix" and len(words) > 3)):
            add(self.settings, " ".join(line.split("#")[0].split()))


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
    """Put a log aside, log.lammps as log.1.lammps and so on: the run goes on with a new one."""
    path = Path(path)
    path.rename(path.with_name(f"{path.stem}.{len(parts(path)) + 1}{path.suffix}"))


def told(line):
    """A message of LAMMPS without the place in its source."""
    return INPUT_PLACE.sub("", line.strip())


# --- restart files ---

def restarts(folder):
    """(step, path) of the complete restart files of LAMMPS in a folder and below, the latest step first."""
    found = [(restart_step(path), path) for path in sorted(Path(folder).rglob("*")) if path.is_file()]
    return sorted(((step, path) for step, path in found if step is not None), reverse=True)


def restart_step(path):
    """The step of a restart file of LAMMPS; None for another file, and for one that was cut while it was written."""
    try:
        with open(path, "rb") as file:
            head = file.read(4096)
            if not head.startswith(MAGIC) or len(head) < 2 * len(MAGIC):
                return None
            file.seek(-len(MAGIC), os.SEEK_END)
            if file.read() != MAGIC:
                return None
        # byte order and format; then numbered entries (lmprestart.h): 0 and 4 are texts, 3 is the size of a step
        at, entry, size = len(MAGIC) + 8, None, 8
        while entry != 5:
            entry, value = struct.unpack_from("=ii", head, at)
            at += 8 + max(0, value) * (entry in (0, 4))
            size = value if entry == 3 else size
        return max(0, struct.unpack_from("=q" if size == 8 else "=i", head, at - 4)[0])
    except (OSError, struct.error):
        return None


# --- provenance ---

def now():
    return datetime.datetime.now().astimezone().isoformat(timespec="seconds")


def machine():
    """Name, processor and cores of this machine."""
    try:
        model = re.search(r"model name\s*:\s*(.*)", Path("/proc/cpuinfo").read_text(encoding="ascii", errors="replace"))
    except OSError:
        model = None
    return {"name": platform.node(), "system": f"{platform.system()} {platform.release()}",
            "processor": model[1] if model else platform.machine(), "cores": len(os.sched_getaffinity(0))}


def package_version():
    """What `git describe` calls the package, None where it is no git checkout."""
    try:
        done = subprocess.run(["git", "-C", Path(__file__).parent, "describe", "--always", "--tags", "--dirty"],
                              text=True, check=False, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
    except OSError:
        return None
    return done.stdout.strip() or None


# --- results ---

def summaries(folder):
    """The summaries of fix deposit/grid in a folder."""
    return sorted(Path(folder).glob("*.summary.yaml"))


def prefix_of(summary):
    """PREFIX of the rasters that belong to a summary."""
    return Path(str(summary).removesuffix(".summary.yaml"))


def write(path, content):
    """Write a file of text or bytes: complete, or not touched."""
    path = Path(path)
    new = path.with_name(f".{path.name}.{os.getpid()}.new")
    try:
        new.write_bytes(content.encode("utf-8") if isinstance(content, str) else content)
        os.replace(new, path)
    except OSError as error:
        raise SlopeError(path, f"cannot be written: {error.strerror}") from error
    finally:
        new.unlink(missing_ok=True)


def parse_yaml(path, what):
    """What is in a YAML file, of whatever type."""
    try:
        # safe_load makes no objects, and what an alias stands for is there once
        return yaml.safe_load(Path(path).read_text(encoding="utf-8"))
    except RecursionError:
        raise SlopeError(path, f"must be {what} (its nesting is too deep)") from None
    except (OSError, ValueError, yaml.YAMLError) as error:
        raise SlopeError(path, f"must be {what} ({getattr(error, 'strerror', None) or error})") from error


def is_number(value):
    """Whether it is a finite number, as YAML has them."""
    try:
        return not isinstance(value, bool) and math.isfinite(value)
    except (TypeError, OverflowError):
        return False


def load_yaml(path, what):
    """A YAML file that holds a mapping; what says what it must be."""
    about = parse_yaml(path, what)
    if not isinstance(about, dict):
        raise SlopeError(path, f"must be {what}")
    return about


def load_summary(path):
    """The summary of fix deposit/grid as a dict, with all that the tools need of it."""
    about = load_yaml(path, "a summary that fix deposit/grid wrote")
    for key, entries in SUMMARY_KEYS.items():
        if key in OPTIONAL and key not in about:
            continue
        for entry in entries or (None,):
            if key not in about or (entry and (not isinstance(about[key], dict) or entry not in about[key])):
                raise SlopeError(path, "must be a summary that fix deposit/grid wrote, with "
                                 + (f"{key}: {entry}" if entry else key))
            value = about[key][entry] if entry else about[key]
            name = f"{key}: {entry}" if entry else key
            if (entry or key) not in NO_NUMBERS and not is_number(value):
                raise SlopeError(path, f"{name} must be a finite number", repr(value)[:60])
            if (key, entry) in ABOVE_ZERO and not value > 0:
                raise SlopeError(path, f"{name} must be > 0", value)
    if not isinstance(about["moving"], bool):
        raise SlopeError(path, "moving must be true or false", repr(about["moving"])[:60])
    return about


def load_terrain(folder, log):
    """The terrain of a run, with its sidecar; None if the log names none or the file is not in reach."""
    path = log.terrain and Path(folder) / log.terrain
    return rasters.read_asc_local(path) if path and path.is_file() else None


def load_raster(prefix, name, heights=True):
    """One of the rasters of fix deposit/grid; heights: whether its values are checked as such."""
    path = Path(f"{prefix}.{name}.asc")
    if not path.is_file():
        raise SlopeError(path, "must be there: fix deposit/grid writes it beside its summary")
    return rasters.read(path, heights)
