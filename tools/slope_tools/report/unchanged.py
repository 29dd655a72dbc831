"""Whether a page would be drawn as it is: by all that it is made of, whose digest it has."""
import hashlib
import json
import os
import re
import shutil
from pathlib import Path
from typing import Any, Dict, Mapping, Optional

from .. import disk
from ..case import run_folders
from .heading import Asked, site_file

TOOLS = Path(__file__).resolve().parents[1]
HEAD = 4096             # bytes of a page that hold its digest
MADE_OF = re.compile(rb'<meta name="slope-made-of" content="(\w+) ?([^"]*)">')
BESIDE = ("collected", "machine", "jobs")       # of a study: when and where its runs were evaluated


def digest(asked: Asked, study: Mapping[str, Any]) -> str:
    """Of the page that is asked for on a study: what its runs say, their files, the site, and these tools."""
    about = {**study, "study": {key: value for key, value in study["study"].items() if key not in BESIDE}}
    site = site_file(asked.folder)
    found = {"asked": disk.plain({**asked._asdict(), "study": None, "site": None}), "about": disk.plain(about),
             "site": asked.site if asked.site is not None else site and disk.sha256(site),
             "runs": {row["run"]: files_of(run_folders.summary_of(asked.folder, row).parent)
                      for row in study["runs"] if "summary" in row},
             "tools": tools(), "film": str(shutil.which("ffmpeg")) if asked.film else ""}
    return hashlib.sha256(json.dumps(found, sort_keys=True, default=str).encode("utf-8")).hexdigest()


def files_of(folder: Path) -> Dict[str, Any]:
    """What tells whether a run is the same: what was written at its end, and the sizes and times of its files."""
    marker = folder / run_folders.MARKER
    return {"marker": disk.sha256(marker) if marker.is_file() else None,
            "files": sorted((one.name, one.stat().st_size, one.stat().st_mtime_ns) for one in os.scandir(folder)
                            if one.is_file())}


def tools() -> str:
    """Digest of the package's own files."""
    found = sorted(path for path in TOOLS.rglob("*") if path.is_file() and "__pycache__" not in path.parts)
    return hashlib.sha256("".join(disk.sha256(path) for path in found).encode("ascii")).hexdigest()


def is_made_of(page: Path, made_of: str) -> bool:
    """Whether a page and what belongs to it is there, made of what has this digest."""
    try:
        with open(page, "rb") as file:
            found = MADE_OF.search(file.read(HEAD))
    except OSError:
        return False
    return found is not None and found[1].decode() == made_of and all(
        (page.parent / name).is_file() for name in found[2].decode().split("/") if name)


def mark(made_of: Optional[str], beside) -> str:
    """What the page has: the digest, and the names of the files beside it."""
    return " ".join([made_of, "/".join(path.name for path in beside)]) if made_of else ""
