"""A finding: what is wrong or doubtful, as a value that console, files and pages show; its words: finding_words."""
import json
import sys
from typing import Any, Callable, Dict, Iterable, List, Mapping, NamedTuple, Optional, Sequence, Tuple, Union

from . import digits
from .finding_words import LIMIT, NOTE, OTHER, WARNING, words_of

__all__ = ["LIMIT", "NOTE", "OTHER", "WARNING", "Finding", "finding", "encode_findings", "texts", "gathered", "who"]
NAMED = 4               # runs that a line names


class _Shown(float):
    """A number that is written with three digits where the words ask for none."""

    def __format__(self, spec):
        if spec == "cubic":
            return digits.cubic(float(self))
        return digits.format_plain(format(float(self), spec)) if spec else digits.rounded(self, 3)


class Finding(NamedTuple):
    """kind: of finding_words; numbers: and names, that its words take; runs: concerned, none if it is about all.

    numbers may have `of`, how many runs there are, and `differ`: they are those of the first run, the gravest. part:
    of a study, before the words; remedy: what to do, after them.
    """
    kind: str
    numbers: Mapping[str, Any] = {}
    runs: Sequence[str] = ()
    part: str = ""
    remedy: str = ""

    @property
    def level(self) -> str:
        return words_of(self.kind).level

    @property
    def text(self) -> str:
        """Its words, without runs and remedy."""
        return f"{self.part}: " * bool(self.part) + self._filled(words_of(self.kind).text)

    def client(self) -> str:
        """Its words for the first page of a report, "" if it has none."""
        numbers = {"who": who(len(self.runs), self.numbers.get("of", 1)), **self.numbers}
        return self._replace(numbers=numbers)._filled(words_of(self.kind).client)

    def _filled(self, words: str) -> str:
        return words.format(**{name: _Shown(value) if isinstance(value, float) else value
                               for name, value in self.numbers.items()})

    def shown(self, names: Mapping[str, str]) -> str:
        """Words, runs by their names (those without one as they are) and remedy: what is read."""
        return f"{self.text}{self._which([names.get(run, run) for run in self.runs])}" + (
            f"; {self.remedy}" if self.remedy else "")

    def __str__(self):
        return self.shown({})

    def _which(self, names: Sequence[str]) -> str:
        """Which runs, in brackets."""
        runs, more = self.numbers.get("of"), "; other numbers in some" if self.numbers.get("differ") else ""
        if not names:
            return ""
        if runs == len(names):
            return f" (all {runs} runs{more})" if runs > 1 else ""
        named = "; ".join(names[:NAMED]) + (f"; and {len(names) - NAMED} more" if len(names) > NAMED else "")
        count = "" if runs is None else f"{len(names)} of {runs} runs: "
        return f" ({count}{named}{more})"

    def entry(self) -> Dict[str, Any]:
        """What a YAML file and JSON have of it."""
        found = {"kind": self.kind, "level": self.level, "text": str(self._replace(remedy="")),
                 "numbers": dict(self.numbers), "runs": list(self.runs), "part": self.part, "remedy": self.remedy}
        return {key: value for key, value in found.items() if value}


Said = Union[str, Mapping[str, Any], Finding]


def who(count: int, runs: int) -> str:
    """How many of the runs, as the subject of a sentence."""
    return "The run" if runs == 1 else f"All {runs} runs" if count == runs else f"{count} of {runs} runs"


def finding(entry: Said) -> Finding:
    """The Finding of one, of its entry in a file, or of a line; a file of another version may have unknown kinds."""
    if isinstance(entry, Finding):
        return entry
    if not isinstance(entry, Mapping):
        return Finding(OTHER, {"text": str(entry)})
    remedy = str(entry.get("remedy") or "")
    try:
        found = Finding(str(entry.get("kind")), entry.get("numbers") or {}, tuple(entry.get("runs") or ()),
                        str(entry.get("part") or ""), remedy)
        str(found)
    except (KeyError, ValueError, TypeError, AttributeError):
        return Finding(OTHER, {"text": str(entry.get("text"))}, remedy=remedy)
    return found


def encode_findings(several: Iterable[Said]) -> List[Dict[str, Any]]:
    """The same of several, as a file has them."""
    return [finding(one).entry() for one in several]


def texts(several: Iterable[Said]) -> List[str]:
    """Several as they are read."""
    return [str(finding(one)) for one in several]


def _alike(finding_: Finding):
    return finding_.part, finding_.kind, finding_.text if finding_.kind == OTHER else None


def gathered(several: Iterable[Finding], of: Optional[int] = None,
             alike: Callable[[Finding], Any] = _alike) -> List[Finding]:
    """One for all that are alike, with the numbers of the first; of: how many runs there are, None: as they have it."""
    groups: Dict[Any, List[Finding]] = {}
    for finding_ in several:
        groups.setdefault(alike(finding_), []).append(finding_)
    merged = []
    for first, *others in groups.values():
        runs = tuple(dict.fromkeys(run for one in (first, *others) for run in one.runs))
        numbers = {**first.numbers, **({"of": of} if runs and of is not None else {})}
        if any(dict(one.numbers) != dict(first.numbers) for one in others):
            numbers["differ"] = True
        merged.append(first._replace(numbers=numbers, runs=runs))
    return merged


# --- on standard error: words, or after `slope --progress json` an object a line ---

as_json = False     # pylint: disable=invalid-name


def say_json(level: str, **values) -> None:
    """level: progress, error, or that of a finding."""
    print(json.dumps({"level": level, **values}), file=sys.stderr, flush=True)


def printer(command: str) -> Callable[[Said], None]:
    """A function that prints a finding of a command, once."""
    told = set()

    def tell(entry):
        finding_ = finding(entry)
        if str(finding_) in told:
            return
        told.add(str(finding_))
        if as_json:
            say_json(**{"command": command, **finding_.entry()})
        else:
            print(f"slope {command}: {finding_.level}: {finding_}", file=sys.stderr)
    return tell


def keeper(tell: Callable[[Said], Any]) -> Tuple[Callable[[Said], None], List[Finding]]:
    """A function that keeps findings and tells them, and the list of those that it kept."""
    kept: List[Finding] = []

    def keep(entry: Said) -> None:
        kept.append(finding(entry))
        tell(entry)
    return keep, kept


def warner(command: str) -> Tuple[Callable[[Said], None], List[Dict[str, Any]]]:
    """The same, and the list of what a file has of those that it printed."""
    tell, kept = printer(command), []

    def warn(message):
        entry = finding(message).entry()
        if entry not in kept:
            kept.append(entry)
            tell(message)
    return warn, kept
