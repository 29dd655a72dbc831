"""Values that take long to compute, kept in a file beside what they were made of, and made again when that changes."""
import contextlib
import dataclasses
import functools
import hashlib
import json
import time
from pathlib import Path
from typing import Any, Callable, Dict, Iterable, Iterator, Optional

from . import disk
from .errors import SlopeError

TOOLS = Path(__file__).resolve().parent
FILE = ".files.json"        # what is known of the files of a site or a study
SETTLED = 2.0               # s; a file that changed less ago may change again without another time of change

_said: Optional[Dict[Any, Any]] = None          # what was computed once by this command


@functools.lru_cache(maxsize=1)
def tools() -> str:
    """Digest of the package's own files."""
    found = sorted(path for path in TOOLS.rglob("*") if path.is_file() and "__pycache__" not in path.parts)
    return hashlib.sha256("".join(disk.sha256(path) for path in found).encode("ascii")).hexdigest()


def digest(made_of: Any) -> str:
    """Of values that JSON knows, dataclasses of them, and what has a text; and of these tools. 0 and 0.0 are one."""
    text = json.dumps([tools(), disk.make_plain(made_of)], sort_keys=True,
                      default=lambda part: disk.make_plain(vars(part)) if dataclasses.is_dataclass(part) else str(part))
    text = json.dumps(json.loads(text, parse_float=by_value))
    return hashlib.sha256(text.encode("utf-8")).hexdigest()


def by_value(number: str) -> float:
    value_ = float(number)
    return int(value_) if value_.is_integer() else value_


def value(path: Path, made_of: Any, make: Callable[[], Any], written: Callable[[], Iterable[Path]] = list) -> Any:
    """What make() gives, numbers, texts, lists, and mappings with texts as keys; from the file, if that is of the same.

    written: names the files that make() writes, too, and that must be as it left them.
    """
    mine = digest(made_of)

    def seal(text: str) -> str:
        """Of a value as it stands in the file, below this."""
        parts = [mine, *(part for one in written() for part in (one.name, disk.sha256(one))), text]
        return hashlib.sha256("\n".join(parts).encode("utf-8")).hexdigest()

    with contextlib.suppress(OSError, ValueError):      # none, or damaged
        before, _, text = path.read_text(encoding="utf-8").partition("\n")
        if before == seal(text):
            return json.loads(text)
    text = json.dumps(disk.make_plain(make()))
    with contextlib.suppress(OSError, SlopeError):      # the folder is somebody else's: it is made again next time
        disk.write_file(path, f"{seal(text)}\n{text}")
    return json.loads(text)     # the same as when it is read


# --- what a command knows ---

@contextlib.contextmanager
def remembered(folder: Path) -> Iterator[None]:
    """For a command that has a folder for itself: what it reads of files is known to the next command, as long as they
    do not change, and what is computed for make_once() is computed once."""
    global _said
    path, before = folder / FILE, _said
    recall(path)
    _said = {} if before is None else before
    try:
        yield
    finally:
        _said = before
        with contextlib.suppress(OSError, SlopeError):      # a folder of somebody else: they are read next time
            remember(path)


def make_once(key: Any, make: Callable[[], Any]) -> Any:
    """What make() gives, once for each key in a command; outside of remembered() each time."""
    if _said is None:
        return make()
    if key not in _said:
        _said[key] = make()
    return _said[key]


def recall(path: Path) -> None:
    """Know what a command before knew of files; but for digests, only of the same tools."""
    with contextlib.suppress(OSError, ValueError, LookupError, TypeError):      # none, or damaged
        made_by, entries = json.loads(path.read_text(encoding="utf-8"))
        for kind, name, stamp, when, value_ in sorted(entries, key=lambda entry: entry[0] != disk.DIGEST):
            if kind == disk.DIGEST or made_by == tools():
                disk.known.setdefault((kind, name), disk.Known(tuple(stamp), when, value_))


def remember(path: Path) -> None:
    """Write what is known of files that are as they were.

    Of a digest that was made at once after the file was written: it is made anew, as it may have changed in between.
    """
    entries, now = [], time.time()
    for (kind, name), entry in sorted(disk.known.items()):
        with contextlib.suppress(OSError):
            stamp = disk.stamp_of(name)
            changed = stamp[-1] / 1e9
            if stamp != entry.stamp or now - changed < SETTLED:
                continue
            if entry.when - changed >= SETTLED:
                entries.append([kind, name, stamp, entry.when, entry.value])
            elif kind == disk.DIGEST:
                entries.append([kind, name, stamp, now, disk.digest_of(name)])
    text = json.dumps([tools(), entries])
    if not path.is_file() or path.read_text(encoding="utf-8") != text:
        disk.write_file(path, text)
