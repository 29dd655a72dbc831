"""Values that take long to compute, kept in a file beside what they were made of, and made again when that changes."""
import contextlib
import functools
import hashlib
import json
from pathlib import Path
from typing import Any, Callable, Sequence

from . import disk
from .errors import SlopeError

TOOLS = Path(__file__).resolve().parent


@functools.lru_cache(maxsize=1)
def tools() -> str:
    """Digest of the package's own files."""
    found = sorted(path for path in TOOLS.rglob("*") if path.is_file() and "__pycache__" not in path.parts)
    return hashlib.sha256("".join(disk.sha256(path) for path in found).encode("ascii")).hexdigest()


def digest(made_of: Any) -> str:
    """Of values that JSON knows, and of these tools."""
    text = json.dumps([tools(), disk.plain(made_of)], sort_keys=True, default=str)
    return hashlib.sha256(text.encode("utf-8")).hexdigest()


def value(path: Path, made_of: Any, make: Callable[[], Any], written: Sequence[Path] = ()) -> Any:
    """What make() gives, numbers, texts, lists, and mappings with texts as keys; from the file, if that is of the same.

    written: files that make() writes, too, and that must be as it left them.
    """
    mine = digest(made_of)
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        if content["made_of"] == mine and content["written"] == list(map(disk.sha256, written)):
            return content["value"]
    except (OSError, ValueError, KeyError, TypeError):
        pass        # none, or of something else
    found = json.loads(json.dumps(disk.plain(make())))      # the same as when it is read
    with contextlib.suppress(OSError, SlopeError):      # the folder is somebody else's: it is made again next time
        disk.write(path, json.dumps({"made_of": mine, "written": list(map(disk.sha256, written)), "value": found}))
    return found
