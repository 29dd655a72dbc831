"""What is asked of a report, and its heading: project, client, author and survey, asked for or of the site's file."""
from pathlib import Path
from typing import Any, Dict, NamedTuple, Optional, Sequence

from .. import schemas
from ..schemas import TEXT, list_of, mapping
from ..sites import site_roads
from ..sites.site_choices import check_text
from ..tables import study_types

SITE = "site.yaml"          # of `slope site`; its study is a folder in the site's
SECTIONS = mapping({}, project=mapping({}, null=True), terrain=mapping({}, null=True, files=list_of(TEXT, null=True)),
                   release=mapping({}, null=True), found=mapping({}, null=True, body=mapping({}, null=True)))
FIELDS = {"project": "name", "client": "client", "author": "author"}      # option: key below `project` in that file


class Asked(NamedTuple):
    """A page on a folder; all else may be left to the tools."""
    folder: Path                                # of a study, or of a run
    shown: Optional[str] = None                 # the run of a study whose maps are shown
    section: Optional[Sequence[str]] = None     # X1 Y1 X2 Y2, the file of a line, or fall
    local: bool = False                         # that line is in local metres
    reference: Optional[Path] = None            # numbers from elsewhere
    converge: Optional[Path] = None             # of slope sensitivity --converge
    project: Optional[str] = None               # these three: the heading
    client: Optional[str] = None
    author: Optional[str] = None
    film: Optional[Path] = None                 # file of the film, which is made, but written by the caller
    study: Optional[study_types.Study] = None   # what study.yaml says; None: it is read
    site: Optional[Dict[str, Any]] = None       # what site.yaml says; None: it is read


def heading(folder: Path, given: Dict[str, Optional[str]],
            site: Optional[Dict[str, Any]] = None) -> Dict[str, Optional[str]]:
    """{field: text, None where unknown} of project, client, author and survey; given: the options, which come first.

    site: what the file of the folder's site says; None: it is read.
    """
    for name, text in given.items():
        check_text(f"--{FIELDS.get(name, name)}", text)
    found = read_site_heading(folder, site_of(folder) if site is None else site)
    return {name: given.get(name) or found.get(name) for name in (*FIELDS, "survey")}


def site_file(folder: Path) -> Optional[Path]:
    """The file of the site of a folder, in it or above it; None without one."""
    place = folder if (folder / SITE).is_file() else site_roads.home(folder.absolute())
    return place / SITE if place else None


def site_of(folder: Path) -> Dict[str, Any]:
    """The file of the site of a folder, of whatever version; empty without one."""
    path = site_file(folder)
    return schemas.load_checked(path, "a file of `slope site`", SECTIONS) if path else {}


def read_site_heading(folder: Path, site: Dict[str, Any]) -> Dict[str, str]:
    """What the file of the site says, in the folder or in the one above it; a site without a name has its folder's."""
    path = site_file(folder)
    if path is None:
        return {}
    about = site.get("project") or {}
    found = {"project": path.absolute().parent.name, "survey": survey(site)}
    for name, key in FIELDS.items():
        check_text(f"{path}: project: {key}", about.get(key))
        if about.get(key):
            found[name] = about[key]
    return found


def survey(site: Dict[str, Any]) -> str:
    """Names of the files of heights; "" if the site has none."""
    names = [Path(file).name for file in (site.get("terrain") or {}).get("files") or ()]
    return ", ".join(names[:2]) + (f" and {len(names) - 2} more" if len(names) > 2 else "")
