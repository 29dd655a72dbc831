"""Reading YAML, making CSV, and writing files whole or not at all."""
import csv
import fcntl
import glob
import hashlib
import io
import math
import os
import platform
import shutil
import time
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, Callable, Dict, List, NamedTuple, Tuple

import yaml
import numpy as np

from . import written_yaml
from .errors import SlopeError


def write_file(path, content):
    """Write a file of text or bytes: complete, or not touched."""
    with write_beside(path) as (new,):
        new.write_bytes(content.encode("utf-8") if isinstance(content, str) else content)


def is_utf8(name: str) -> bool:
    """Whether the name of a file, which may be any bytes, is UTF-8."""
    return not any("\ud800" <= letter <= "\udfff" for letter in name)


def escape_name(name: str) -> str:
    """A name in a message; bytes that are not UTF-8 as \\x93."""
    return os.fsencode(name).decode("utf-8", "backslashreplace")


def csv_text(columns, rows) -> str:
    """A CSV: a line of names, then the rows; None is an empty cell."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows([columns, *rows])
    return text.getvalue()


@contextmanager
def write_beside(*paths):
    """Names to write files under, beside those asked for, which they take in this order once all are complete.

    The last one is what makes them valid, and is named where they cannot be written.
    """
    places = [Path(path) for path in paths]
    new: List[Path] = []
    try:
        new += [on_its_way(path.parent, path.name) for path in places]
        yield new
        for part in new:
            flush(part)
        with renaming(places[-1].parent):
            for part, path in zip(new, places):
                os.replace(part, path)
        for folder in {path.parent for path in places}:
            flush(folder)
    except OSError as error:
        raise SlopeError(places[-1], f"cannot be written: {error.strerror or error}") from error
    finally:
        for part in new:
            with suppress(OSError):     # a read-only file system refuses this too
                part.unlink(missing_ok=True)


@contextmanager
def renaming(folder: Path):
    """No other process gives files of a folder their names meanwhile: of two sets one is there, not a mixture.

    It waits for the other process. A file system without locks does without.
    """
    handle = os.open(folder, os.O_RDONLY)
    try:
        with suppress(OSError):
            fcntl.flock(handle, fcntl.LOCK_EX)
        yield
    finally:
        os.close(handle)        # which ends the lock


LOCK = ".lock"      # in a folder in which one process works
DIGEST = "sha256"


class Known(NamedTuple):
    """What was read of a file; when: seconds since the epoch; stamp: of the file then."""
    stamp: Tuple[int, ...]
    when: float
    value: Any


def stamp_of(path) -> Tuple[int, ...]:
    """What every change of a file changes: its time of change (ctime) cannot be set back."""
    about = os.stat(path)
    return about.st_dev, about.st_ino, about.st_size, about.st_mtime_ns, about.st_ctime_ns


known: Dict[Tuple[str, str], Known] = {}        # {(kind of value, path): of a file}


def read_once(kind: str, path, read: Callable[[], Any]) -> Any:
    """What read() says of a file, which is read again when it changes; of a kind for each function."""
    key, stamp = (kind, os.path.abspath(path)), stamp_of(path)
    if key not in known or known[key].stamp != stamp:
        known[key] = Known(stamp, time.time(), read())
    return known[key].value


def sha256(path) -> str:
    """Of a file, in hexadecimal."""
    return read_once(DIGEST, path, lambda: digest_of(path))


def digest_of(path) -> str:
    digest = hashlib.sha256()
    with open(path, "rb") as data:
        for block in iter(lambda: data.read(1 << 20), b""):
            digest.update(block)
    return digest.hexdigest()


def flush(path: Path) -> None:
    """Return when a file, or the names in a folder, outlast a power cut."""
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def flush_all(folder: Path) -> None:
    """flush() of a folder with all that is in it."""
    for top, _, names in os.walk(folder):
        for name in names:
            if os.path.isfile(os.path.join(top, name)):
                flush(Path(top, name))
        flush(Path(top))


def parse_yaml(path: Any, what: str) -> Any:
    """What is in a YAML file, of whatever type."""
    try:
        return written_yaml.load_yaml(Path(path).read_text(encoding="utf-8"))
    except written_yaml.Misleading as error:
        raise SlopeError(f"{path}: line {error.line}", error.rule, error.got) from None
    except RecursionError:
        raise SlopeError(path, f"must be {what} (its nesting is too deep)") from None
    except (OSError, ValueError, yaml.YAMLError) as error:
        raise SlopeError(path, f"must be {what} ({getattr(error, 'strerror', None) or error})") from error


def is_finite_number(value: Any) -> bool:
    """Whether it is a finite number, as YAML has them."""
    try:
        return not isinstance(value, bool) and math.isfinite(value)
    except (TypeError, OverflowError):
        return False


@contextmanager
def alone_in(folder, what="study"):
    """No other process works in a folder meanwhile; the lock goes when the process does. SlopeError if one does."""
    with open(Path(folder) / LOCK, "w", encoding="ascii") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise SlopeError(folder, f"must not be in use by another {what}: wait for it, or end it") from None
        yield


def beside_folder(folder: Path) -> Path:
    """Name of a folder for files on their way to `folder`, on its disk, so that renames do."""
    if not folder.is_dir():
        return on_its_way(folder.parent, folder.name)
    on_its_way(folder.parent, folder.name)      # which removes what was left beside it
    return on_its_way(folder, folder.name)


def on_its_way(place: Path, name: str) -> Path:
    """Name in a folder for what is to be called `name`. Removes what processes of this machine that are gone left there
    under such names."""
    start = f".{name}.{platform.node()}."
    for path in list(place.glob(f"{glob.escape(start)}*.new")) if place.is_dir() else ():
        number = path.name[len(start):-len(".new")]
        if number.isdigit() and not is_alive(int(number)):
            if path.is_dir():
                shutil.rmtree(path, ignore_errors=True)
            else:
                with suppress(OSError):
                    path.unlink()
    return place / f"{start}{os.getpid()}.new"


def is_alive(process: int) -> bool:
    """Whether this machine has a process of that number."""
    try:
        os.kill(process, 0)
    except (ProcessLookupError, OverflowError):
        return False
    except OSError:     # another user's
        return True
    return True


def void_of(marker: Path) -> Path:
    """The file beside a marker that says of a set without it that it is void, and complete()'s."""
    return marker.with_name(f".{marker.name}.void")


@contextmanager
def complete(folder, marker, called=None):
    """A folder to write a set of results into; when all are there they move to `folder`, else nothing changes.

    marker: the file that makes the set valid. It goes first and comes last: a kill or a power cut between the renames
    leaves files without it, which are void. called: what errors name instead of the folder.
    """
    asked, folder = called or folder, Path(folder).resolve()
    new = beside_folder(folder)
    try:
        new.mkdir()
        yield new
        flush_all(new)
        folder.mkdir(exist_ok=True)
        names = sorted(path.name for path in new.iterdir() if path.name != marker)
        void = void_of(folder / marker)
        with renaming(folder):
            void.touch()
            (folder / marker).unlink(missing_ok=True)
            flush(folder)
            for name in names:
                os.replace(new / name, folder / name)
            flush(folder)
            os.replace(new / marker, folder / marker)
            flush(folder)
            void.unlink()
        flush(folder.parent)
    except OSError as error:
        raise SlopeError(asked, f"cannot be written: {error.strerror or error}") from error
    except SlopeError as error:
        # of write_file(), which names the file on its way: the user knows the folder that it goes to
        if isinstance(error.__cause__, OSError) and str(error).startswith(f"{new}{os.sep}"):
            raise SlopeError(asked, f"cannot be written: {error.__cause__.strerror}") from error.__cause__
        raise
    finally:
        shutil.rmtree(new, ignore_errors=True)


def texts(value):
    """All texts in what YAML holds."""
    if isinstance(value, str):
        yield value
    for inner in value.values() if isinstance(value, dict) else value if isinstance(value, list) else ():
        yield from texts(inner)


def check_standing(record, files, sources, overwrite, called=None):
    """Raise SlopeError if one of the files stands and is not the result of the same sources, before the work is done.

    record: the file that names the sources of a result; called: what they are called in the message, if not by their
    names. What complete() left void may be replaced.
    """
    standing = next((path for path in map(Path, files) if path.exists()), None)
    if overwrite or standing is None or void_of(Path(record)).exists():
        return
    try:
        text = Path(record).read_text(encoding="utf-8")
        known = set(texts(written_yaml.load_yaml(text))) if Path(record).suffix == ".yaml" else text
    except (OSError, ValueError, RecursionError, yaml.YAMLError):
        known = ""
    others = [name for name in map(str, sources) if name not in known]
    if others:
        raise SlopeError("-o", f"{standing} must be the result of {called or ', '.join(others)} to be replaced: give "
                         "another name, or --overwrite")


def check_folder(folder, files=(), sources=(), overwrite=False):
    """Raise SlopeError if results cannot go to that folder, before the work is done.

    files: their names, the last one that of the record of their sources, see check_standing().
    """
    if folder.exists() and not folder.is_dir():
        raise SlopeError("-o", "must be a folder", folder)
    if not folder.resolve().parent.is_dir():
        raise SlopeError("-o", "must be in an existing folder", folder)
    if files:
        check_standing(folder / files[-1], [folder / name for name in files], sources, overwrite)


def check_file(path, suffix, inputs=(), called="an input"):
    """Raise SlopeError if a result cannot have that name, before the work is done; inputs: what it must not be."""
    if path.suffix != suffix or path.is_dir():
        raise SlopeError("-o", f"must be a file that ends in {suffix}", path)
    if not path.parent.is_dir():
        raise SlopeError("-o", "must be in an existing folder", path)
    if any(path.exists() and Path(one).exists() and path.samefile(one) for one in inputs):
        raise SlopeError("-o", f"must not be {called}", path)


def make_plain(value: Any) -> Any:
    """numpy's numbers, tuples and paths as what YAML and JSON know."""
    if isinstance(value, dict):
        return {key: make_plain(inner) for key, inner in value.items()}
    if isinstance(value, (list, tuple, np.ndarray)):
        return [make_plain(inner) for inner in value]
    if isinstance(value, np.generic):
        return value.item()
    return str(value) if isinstance(value, Path) else value


def yaml_text(comment, content) -> str:
    """A YAML file with a comment on its first line; what is in it twice is written twice, not as an alias."""
    return f"# {comment}\n" + yaml.dump(make_plain(content), Dumper=written_yaml.DUMPER, sort_keys=False,
                                        allow_unicode=True)


def write_yaml(path, content, comment):
    Path(path).write_text(yaml_text(comment, content), encoding="utf-8")
