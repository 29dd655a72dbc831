"""Values that take long to compute, kept in a file beside what they were made of, and made again when that changes."""
import contextlib
import dataclasses
import functools
import hashlib
import json
from pathlib import Path
from typing import Any, Callable, Iterable

from . import disk
from .errors import SlopeError

TOOLS = Path(__file__).resolve().parent


@functools.lru_cache(maxsize=1)
def tools() -> str:
    """Digest of the package's own files."""
    found = sorted(path for path in TOOLS.rglob("*") if path.is_file() and "__pycache__" not in path.parts)
    return hashlib.sha256("".join(disk.sha256(path) for path in found).encode("ascii")).hexdigest()


def digest(made_of: Any) -> str:
    """Of values that JSON knows, dataclasses of them, and what has a text; and of these tools."""
    text = json.dumps([tools(), disk.plain(made_of)], sort_keys=True, default=lambda one: disk.plain(vars(one))
                      if dataclasses.is_dataclass(one) else str(one))
    return hashlib.sha256(text.encode("utf-8")).hexdigest()


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
    text = json.dumps(disk.plain(make()))
    with contextlib.suppress(OSError, SlopeError):      # the folder is somebody else's: it is made again next time
        disk.write(path, f"{seal(text)}\n{text}")
    return json.loads(text)     # the same as when it is read
