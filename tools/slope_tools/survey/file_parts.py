"""Which files a file of a GIS consists of: a change of one of them is a change of it."""
import hashlib
import html
import os
import re
import sqlite3
from contextlib import closing, suppress
from pathlib import Path
from typing import Iterator, List

from .. import disk

# beside a raster, a shapefile or a table: CRS, place, attributes; none for overviews, which change no value
BESIDE = (".prj", ".shx", ".dbf", ".cpg", ".tfw", ".hdr", ".yaml", ".gfs", ".xsd", ".wld", ".tifw", ".tiffw", ".blw",
          ".ige", ".qpj", ".dat", ".map", ".id", ".mid")
AFTER = (".aux.xml", ".msk")        # behind the whole name: place and NODATA, mask
SQLITE, JOURNAL, LOG = b"SQLite format 3\0", "-journal", "-wal"
VIRTUAL = re.compile(r"\s*<(\?xml[^>]*>\s*<)?(OGR)?VRT(Dataset|DataSource)")
SOURCE = re.compile(r"<(?:Source(?:Filename|Dataset)|SrcDataSource)([^>]*)>([^<]+)<", re.IGNORECASE)
RELATIVE = re.compile(r"""relativetovrt\s*=\s*["']?(1|yes|true|on)""", re.IGNORECASE)


def digest_content(path: str) -> str:
    """Digest of a file, with the files that it reads and those beside it that say what it means."""
    parts = [os.path.basename(one) + digest(one) for one in of_file(path)]
    return hashlib.sha256("\n".join(parts).encode("utf-8")).hexdigest()


def of_file(path: str) -> List[str]:
    """The file, those beside it, and all of the sources of a virtual raster or layer; what is there of them."""
    files: List[str] = []
    todo = [path]
    while todo:
        one = todo.pop(0)
        stem = os.path.splitext(one)[0]
        ends = [same for end in BESIDE for same in (end, end.upper())]
        for part in (one, *(stem + end for end in ends), *(one + end for end in (*AFTER, JOURNAL))):
            if os.path.isfile(part) and part not in files:
                files.append(part)
                todo += sources(part)
    return files


def sources(path: str) -> Iterator[str]:
    """The files that a virtual raster or layer of GDAL (.vrt) names; none of any other file."""
    with open(path, "rb") as data:
        head = data.read(1024)
        if not VIRTUAL.match(head.decode("utf-8-sig", "replace")):
            return
        text = (head + data.read()).decode("utf-8-sig", "replace")
    for attributes, name in SOURCE.findall(text):
        name = re.sub(r"^(/vsi\w+/)+", "", html.unescape(name).strip()).strip("{}")
        place = Path(path).parent / name if RELATIVE.search(attributes) else Path(name)
        yield from (str(one) for one in (place, *place.parents) if one.is_file())   # it may be in an archive


def digest(path: str) -> str:
    """Of the content of a file; of a database, with what its log says: it goes to the file later, as QGIS closes."""
    log = path + LOG
    if os.path.isfile(log) and os.path.getsize(log) > 0:
        with open(path, "rb") as data:
            is_database = data.read(len(SQLITE)) == SQLITE
        with suppress(sqlite3.Error):
            if is_database:
                with closing(sqlite3.connect(f"{Path(path).absolute().as_uri()}?mode=ro", uri=True)) as database:
                    return hashlib.sha256(database.serialize()).hexdigest()
        return disk.sha256(path) + disk.sha256(log)
    return disk.sha256(path)
