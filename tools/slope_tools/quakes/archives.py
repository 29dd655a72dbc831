"""Files in the archives in which records are downloaded (.zip, .tar, .tar.gz, .gz), and in these; nothing is unpacked
to the disk."""
import fnmatch
import gzip
import io
import re
import tarfile
import zipfile
from pathlib import Path, PurePosixPath
from typing import Iterator, List, Tuple

from ..errors import SlopeError
from ..survey.zips import is_of_macos, split, check_archive

LARGEST = 300_000_000       # bytes of a file; a record of ten minutes has some 3 million
DEEPEST = 3                 # archives in archives


def files(path) -> List[Tuple[str, bytes]]:
    """Name and content of a file, or of those of an archive; ARCHIVE/PATTERN: of those that it names."""
    archive, pattern = split(str(path))
    try:
        data = Path(archive).read_bytes()
    except OSError as error:
        raise SlopeError(path, f"cannot be read: {error.strerror}") from None
    members = list(unpacked(archive, data))
    names = [name[len(archive) + 1:] for name, _ in members]
    if pattern:
        pattern = pattern.removesuffix(".gz")       # which names are without
        members = [one for one, name in zip(members, names) if any(fnmatch.fnmatch(part, pattern) for part in
                                                                   (name, PurePosixPath(name).name))]
    if not members:
        raise SlopeError(path, "must be files of the archive" if pattern else "an archive must hold files",
                         ", ".join(names) or "none")
    return members


def unpacked(name: str, data: bytes, depth: int = 0) -> Iterator[Tuple[str, bytes]]:
    """A file, or those of an archive; SlopeError if it is damaged, or too large."""
    if depth > DEEPEST:
        raise SlopeError(name, f"archives must be in at most {DEEPEST} others")
    opened = io.BytesIO(data)
    with check_archive(name):
        if data[:4] == b"PK\3\4":
            with zipfile.ZipFile(opened) as archive:
                for info in archive.infolist():
                    if not info.is_dir() and not is_of_macos(info.filename):
                        with archive.open(info) as member:
                            yield from unpacked(f"{name}/{info.filename}", read_archive_member(name, member), depth + 1)
        elif data[:2] == b"\x1f\x8b":
            with gzip.open(opened) as member:
                found = unpacked(name, read_archive_member(name, member), depth + 1)
            yield from ((re.sub(r"\.gz$", "", one, flags=re.I) if one == name else one, text) for one, text in found)
        elif data[257:262] == b"ustar":
            with tarfile.open(fileobj=opened) as tar:
                for entry in tar:
                    if entry.isfile() and not is_of_macos(entry.name):
                        yield from unpacked(f"{name}/{entry.name}", read_archive_member(name, tar.extractfile(entry)),
                                            depth + 1)
        else:
            yield name, data


def read_archive_member(name: str, member) -> bytes:
    data = member.read(LARGEST + 1)
    if len(data) > LARGEST:
        raise SlopeError(name, f"must hold files of at most {LARGEST / 1e6:g} MB")
    return data
