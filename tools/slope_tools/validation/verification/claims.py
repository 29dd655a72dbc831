"""What a claim is made of: runs of decks, what is read from them, a bound set before, a control that must fail."""
import hashlib
import re
import shutil
from pathlib import Path
from typing import Callable, NamedTuple, Tuple, Union

import numpy as np

from ...case import logs
from ...deposits import dumps
from ...errors import SlopeError

INPUTS = Path(__file__).resolve().parents[4] / "inputs"
NO_DATA = (".md", ".png", ".py")        # files of a case that its deck does not read


# --- runs ---

class Run(NamedTuple):
    """A deck of inputs/ with some of its index variables set, and some of its text replaced."""
    deck: str                           # case/in.name
    values: Tuple[Tuple[str, str], ...] = ()
    swaps: Tuple[Tuple[str, str], ...] = ()

    def __call__(self, *swaps, **values):
        """The same with more values, and with more (old, new) texts."""
        settings = dict(self.values)
        settings.update((name, str(value)) for name, value in values.items())
        return self._replace(values=tuple(settings.items()), swaps=self.swaps + swaps)

    @property
    def source(self):
        return INPUTS / self.deck

    @property
    def name(self):
        """Of its folder."""
        parts = [self.deck.replace("/in.", "."), *("_".join(pair) for pair in self.values)]
        if self.swaps:
            parts.append("changed_" + hashlib.sha256(repr(self.swaps).encode()).hexdigest()[:6])
        return re.sub(r"[^A-Za-z0-9._+-]+", "-", "_".join(parts))

    @property
    def options(self):
        return [word for name, value in self.values for word in ("-var", name, value)]

    @property
    def command(self):
        """As one would type it in the folder of the deck."""
        changed = "".join(f"   # {old.strip()} -> {new.strip() or 'nothing'}" for old, new in self.swaps)
        return " ".join(["lmp", "-in", self.source.name, *self.options]) + changed

    def write(self, folder):
        """Put the deck and its data into a new folder."""
        folder.mkdir(parents=True)
        for path in self.data:
            shutil.copy(path, folder)
        (folder / self.source.name).write_text(self.text, encoding="ascii")

    @property
    def data(self):
        """The files that the deck may read, sorted."""
        return sorted(path for path in self.source.parent.iterdir()
                      if path.is_file() and path.suffix not in NO_DATA and path.name != "numbers.yaml"
                      and not path.name.startswith("in."))

    @property
    def text(self):
        """Of the deck, with what a control replaces."""
        text = self.source.read_text(encoding="ascii")
        for old, new in self.swaps:
            if old not in text:
                raise SlopeError(self.source, "must have what a control replaces", repr(old))
            text = text.replace(old, new)
        return text

    @property
    def identity(self):
        """Checksum of all that the run is made of, but for the program."""
        digest = hashlib.sha256(repr((self.text, self.options)).encode())
        for path in self.data:
            digest.update(path.name.encode() + path.read_bytes())
        return digest.hexdigest()


class Result:
    """A run that has ended: its folder, and what the deck wrote there."""

    def __init__(self, folder):
        self.folder = Path(folder)
        try:
            self.log = (self.folder / logs.LOG).read_text(encoding="utf-8", errors="replace")
        except OSError:
            self.log = ""

    def printed(self, start):
        """The lines that the deck printed with this start, without LAMMPS' echo of the command."""
        return [line for line in self.log.splitlines() if line.startswith(start)]

    def number(self, name, start):
        """The number after a name in the first line that was printed with this start."""
        return find_number(name, self.printed(start)[0])

    def curve(self, name):
        """A .csv file with a title: columns by name."""
        return np.genfromtxt(self.folder / name, delimiter=",", names=True)

    def frames(self, name):
        """A dump of a constant number of atoms, sorted: {column: array of frames by atoms}."""
        return read_claim_frames(self.folder / name)


def find_number(name, line):
    """The number after a name in a line."""
    return float(re.findall(rf"\b{name} (\S+)", line)[0].rstrip(":"))


def read_claim_frames(path):
    """See Result.frames."""
    found = dumps.frames(path)
    columns, values = found[0][0], np.array([values for _, values in found])
    return {column: values[:, :, i] for i, column in enumerate(columns)}


# --- bounds ---

class Near(NamedTuple):
    """Within a tolerance of a number; share: of its size."""
    expected: float
    tolerance: float
    share: bool = False

    def holds(self, got):
        return abs(got - self.expected) <= self.tolerance * (abs(self.expected) if self.share else 1.0)

    def texts(self):
        return f"{self.expected:.5g}", f"{100 * self.tolerance:g} %" if self.share else f"{self.tolerance:g}"


class Between(NamedTuple):
    """In a range, given by what is published or follows from theory; margin: a share by which it is widened."""
    low: float
    high: float
    margin: float = 0.0

    def holds(self, got):
        return self.low * (1 - self.margin) <= got <= self.high * (1 + self.margin)

    def texts(self):
        return f"{self.low:.4g} to {self.high:.4g}", f"{100 * self.margin:g} %" if self.margin else "in the range"


class AtMost(NamedTuple):
    """An error that must be 0 but for a tolerance."""
    most: float

    def holds(self, got):
        return got <= self.most

    def texts(self):
        return "0", f"{self.most:g}"


class AtLeast(NamedTuple):
    """Not below a number."""
    least: float

    def holds(self, got):
        return got >= self.least

    def texts(self):
        return f">= {self.least:g}", "one-sided"


class Verdict(NamedTuple):
    """A word."""
    expected: str

    def holds(self, got):
        return got == self.expected

    def texts(self):
        return self.expected, "the same"


# --- claims ---

class Control(NamedTuple):
    """Runs in which something is broken on purpose, so that the check of the claim must fail."""
    broken: str
    runs: Tuple[Run, ...]


class Claim(NamedTuple):
    """One number or word that runs of a case must give."""
    name: str                           # one word, unique
    text: str
    unit: str
    source: str
    runs: Tuple[Run, ...]
    got: Callable[..., Union[float, str]]       # of the Results of the runs
    bound: object
    control: Control
    quick: bool = True                  # seconds, not minutes
    remark: str = ""                    # where published values are not met, or met in another sense: why

    @property
    def case(self):
        return self.runs[0].deck.split("/")[0]


class Seen(NamedTuple):
    """A number or word that the README of a case shows beside its claims."""
    name: str
    runs: Tuple[Run, ...]
    got: Callable[..., Union[float, str]]
    quick: bool = True
    chance: float = 0.0                 # share by which builds that round otherwise differ

    @property
    def case(self):
        return self.runs[0].deck.split("/")[0]
