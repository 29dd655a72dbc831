"""LAMMPS input decks: the commands, variables and files of one."""
import collections
import re
from pathlib import Path
from typing import Any, Callable, Dict, Iterable, List, Mapping, Sequence, Set, Tuple

from ..errors import SlopeError
from ..findings import Finding

WORD = re.compile(r'"""(.*?)"""|"([^"]*)"|\'([^\']*)\'|(\S+)')
PATHS = re.compile(r"[^\s\"'(),=]+")        # what may be a path in a word such as is_file(/data/a.asc)
# where a variable is used: ${name}, $x, v_name
USED = re.compile(r"\$\{(\w+)\}|\$(\w)|\bv_(\w+)")
DEEPEST = 10            # variables that name variables
# words of a command that name files which it writes
WRITTEN_AT = {"restart": (2, 4), "write_restart": (1, 2), "write_data": (1, 2), "write_dump": (3, 4), "dump": (5, 6),
              "log": (1, 2)}


def words_of(line: str) -> List[str]:
    """The words of a line, without quotes and comment."""
    words: List[str] = []
    for match in WORD.finditer(line):
        if match.lastindex == 4 and "#" in match[4]:
            return words + [match[4].split("#")[0]] * (not match[4].startswith("#"))
        words.append(match[match.lastindex or 0])
    return words


def without_comments(deck: Path, defaults=True) -> List[List[str]]:
    """What tells two decks apart: lines of words without comments and blanks, left as they are where quotes or
    continued lines make it uncertain what is a comment.

    defaults: False leaves out the value of each index variable that has one of one word, for those who compare values.
    """
    text = deck.read_text(encoding="utf-8", errors="surrogateescape")
    uncertain = any(line.count('"""') % 2 for line in text.splitlines())        # quotes over several lines
    lines = [[line] if uncertain or any(c in line for c in "\"'&") else line.split("#")[0].split()
             for line in text.splitlines()]
    if not defaults:
        defined = collections.Counter(words[1] for words in commands(deck) if words[0] == "variable" and len(words) > 1)
        lines = [line[:3] if len(line) == 4 and line[0] == "variable" and line[2] == "index" and defined[line[1]] == 1
                 else line for line in lines]
    return [line for line in lines if line]


def commands(deck):
    """The commands of a deck and of the files that it includes by name: lists of words, comments taken off."""
    words_of_lines, waiting, seen = [], [Path(deck)], set()
    while waiting:
        path = waiting.pop(0)
        seen.add(path)
        try:
            text = path.read_text(encoding="utf-8", errors="replace")
        except OSError as error:
            raise SlopeError(path, f"must be a LAMMPS input deck ({error.strerror})") from error
        for line in re.sub(r"&[ \t]*\n", " ", text).splitlines():
            words = words_of(line)
            if not words:
                continue
            words_of_lines.append(words)
            included = Path(deck).parent / words[-1]
            if words[0] == "include" and included.is_file() and included not in seen:
                waiting.append(included)
    return words_of_lines


def variables(deck):
    """{name: (style, text)} of a deck's `variable` commands; the first of a name counts, as for index variables."""
    found: Dict[str, Tuple[str, str]] = {}
    for words in commands(deck):
        if words[0] == "variable" and len(words) > 2:
            found.setdefault(words[1], (words[2], " ".join(words[3:])))
    return found


def quoted(path: str) -> str:
    """A path as one word of a deck."""
    return f'"{path}"' if any(c.isspace() or c in "#$&" for c in path) else path


def warn_of_name(path: object, warn: Callable[[Finding], Any]) -> None:
    """Warn of a path that no deck can name: LAMMPS changes what is not ASCII before it opens a file."""
    odd = sorted({c for c in str(path) if not c.isascii() or c == '"'})
    if odd:
        warn(Finding("file name", {"file": str(path), "characters": " ".join(odd)}))


def filled(word: str, values: Mapping[str, str]) -> str:
    """A word with the values of the variables that it names, as ${name} or, of one letter, as $x."""
    for _ in range(DEEPEST):
        before = word
        word = re.sub(r"\$(?:\{(\w+)\}|(\w))", lambda match: values.get(match[1] or match[2], match[0]), word)
        if word == before:
            break
    return word


def named_files(deck):
    """Words of a deck that may name files which it reads, and those with which it names files that it writes.

    Variables of style index or string are filled in; a word that stands in both places is in both sets.
    """
    values = {name: text for name, (style, text) in variables(deck).items() if style == "string"}
    values |= index_variables(deck)

    read: Set[str] = set()
    written: Set[str] = set()
    for words in commands(deck):
        for k, word in enumerate(words):
            (written if names_output(words, k) else read).update((word, filled(word, values)))
    return read, written


def read_words(commands_: Iterable[Sequence[str]]) -> Set[str]:
    """The words of commands that may name files which they read."""
    return {word for words in commands_ for k, word in enumerate(words) if not names_output(words, k)}


def names_output(words, k):
    """Whether word k of a command names a file that the command writes."""
    first, last = WRITTEN_AT.get(words[0], (0, 0))
    keyword = words[k - 1] if k and words[0] in ("fix", "print") else ""
    return first <= k < last or keyword in ("write", "append") or (
        keyword == "file" and (words[0] == "print" or bool(re.match("ave/|print|vector", " ".join(words[3:4])))))


def only_in_outputs(deck) -> Set[str]:
    """The variables that stand in names, or prefixes, of files that a deck writes, and in nothing else that matters."""
    there: Set[str] = set()
    elsewhere: Set[str] = set()
    for words in commands(deck):
        for k, word in enumerate(words):
            of_output = names_output(words, k) or (words[0] == "fix" and words[k - 1] == "output")
            names = {match[1] or match[2] or match[3] for match in USED.finditer(word)}
            if of_output:
                there |= names
            elif words[0] != "print":
                elsewhere |= names
    return there - elsewhere


def index_variables(deck):
    """{name: default} of the variables that -var can set."""
    return {name: text.split()[0] if text else "" for name, (style, text) in variables(deck).items()
            if style == "index"}
