"""The heading of a report: project, client, author and survey, from the command line or from the site's file."""
from pathlib import Path
from typing import Any, Dict, Optional

from .. import disk
from ..errors import SlopeError
from ..sites.site_choices import check_text

SITE = "site.yaml"          # of `slope site`; its study is a folder in the site's
FIELDS = {"project": "name", "client": "client", "author": "author"}      # option: key below `project` in that file


def heading(folder: Path, given: Dict[str, Optional[str]]) -> Dict[str, Optional[str]]:
    """{field: text, None where unknown} of project, client, author and survey; given: the options, which come first."""
    for name, text in given.items():
        check_text(f"--{name}", text)
    found = of_site(folder)
    return {name: given.get(name) or found.get(name) for name in (*FIELDS, "survey")}


def site_file(folder: Path) -> Optional[Path]:
    """The file of the site of a folder, in it or above it; None without one."""
    return next((place / SITE for place in (folder, folder.absolute().parent) if (place / SITE).is_file()), None)


def of_site(folder: Path) -> Dict[str, str]:
    """What the file of the site says, in the folder or in the one above it; a site without a name has its folder's."""
    path = site_file(folder)
    if path is None:
        return {}
    site = disk.load_yaml(path, "a file of `slope site`")
    about = site.get("project") or {}
    if not isinstance(about, dict):
        raise SlopeError(path, "project must have name, client and author", repr(about)[:60])
    found = {"project": path.absolute().parent.name, "survey": survey(site)}
    for name, key in FIELDS.items():
        check_text(f"{path}: project: {key}", about.get(key))
        if about.get(key):
            found[name] = about[key]
    return found


def survey(site: Dict[str, Any]) -> str:
    """Names of the files of heights; "" if the site has none."""
    terrain = site.get("terrain")
    files = terrain.get("files") if isinstance(terrain, dict) else None
    names = [Path(str(file)).name for file in files] if isinstance(files, list) else []
    return ", ".join(names[:2]) + (f" and {len(names) - 2} more" if len(names) > 2 else "")
