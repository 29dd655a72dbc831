"""The roads of a site: one, or several that share all runs, and each of which has studies of its own.

The studies of one of several lie in roads/NAME; those of the worst, from which most is to be removed, in the site's
folder too, as if it were alone: whatever takes the folder of a site takes them.
"""
import os
import re
import shutil
from dataclasses import replace
from pathlib import Path
from typing import Dict, List, Optional, Set, Tuple

from ..errors import SlopeError
from ..survey import roads
from ..survey.rasters import Raster
from . import site_choices
from .site_choices import Site
from .site_sections import Choices

ROAD, FOLDER = "road.csv", "roads"      # in a site's folder: the road, or the worst; what is known of each of several
ONE = "must be one with single blocks; --line takes others"
LONGEST = 60            # letters of a name
TABLE = "roads.csv"     # of each run, for each road


def names(site: Site) -> List[str]:
    """Of several roads; none of a single one."""
    return list(site.found.roads)


def results(site: Site) -> Path:
    """The folder of the studies of the road that is asked."""
    return site.folder / FOLDER / site.road if site.road else site.folder


def file_of(site: Site) -> Path:
    """The road that is asked, in local metres."""
    return site.folder / file_name(site.road)


def file_name(name: str) -> str:
    return f"{name}.{ROAD}" if name else ROAD


def worst(site: Site, name: str) -> Site:
    """The site as if this road were alone; studies of another one in its folder are none of it any more (outdated)."""
    shutil.copyfile(site.folder / file_name(name), site.folder / ROAD)
    return replace(site, road="")


def name_road(name: str, taken: Set[str]) -> str:
    """The name of a road that no other has, for its files and pages; case does not count."""
    name = re.sub(r"[^\w.-]+", "_", name).strip("._-")[:LONGEST] or "road"
    found, k = name, 1
    while found.casefold() in taken:
        k += 1
        found = f"{name}_{k}"
    taken.add(found.casefold())
    return found


def home(study: Path) -> Optional[Path]:
    """The folder of the site whose study is in a folder; None of any other study."""
    above = Path(os.path.abspath(study)).parents
    places = [above[0], *([above[2]] if above[1].name == FOLDER else [])]
    found = next((place for place in places if (place / site_choices.NAME).is_file()), None)
    return found if found is None or study.is_absolute() else Path(os.path.relpath(found))


def list_road_files(choices: Choices) -> List[str]:
    """The files of roads."""
    return choices.files("road", "file") + choices.files("road", "others")


def read_site_roads(choices: Choices, raster: Raster, crs, advice, warn) -> Dict[str, Tuple[str, roads.Road]]:
    """{name: (file, road in local metres)}; crs, advice: functions of a file, see site_layers."""
    taken: Set[str] = set()
    asked, roads_ = choices.road.asked, {}
    roads.check_road(asked)
    for path in list_road_files(choices):
        for name, road in roads.read_each(path, raster, asked, crs(path), advice(path), warn).items():
            roads_[name_road(name, taken)] = path, road
    if len(roads_) > 1 and choices.KIND:
        raise SlopeError("--road", ONE, ", ".join(roads_))
    for said in roads.meetings(roads_, raster):
        warn(said)
    return roads_
