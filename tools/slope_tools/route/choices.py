"""What is asked of a route, kept in its folder: route.yaml."""
import contextlib
import functools
import os
import shutil
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Dict, Iterator, List, Mapping, Optional, Tuple

import numpy as np

from .. import disk, schemas
from ..ensembles import sample
from ..errors import SlopeError
from ..sites.site_choices import check_text
from ..sites.site_keys import NEEDED, key, section_schema
from ..survey import file_parts, roads, vectors, zips

NAME = "route.yaml"
VERSION = 1
WHAT = "what `slope route` wrote"
# paths, kept as from the folder
FILES = ("terrain", "road", "bodies", "ground", "ground_table", "fragility")
READ = FILES[:-1]       # once: an edit of them afterwards is another question
SOURCES = "sources"     # in route.yaml: what these held
TABLE = "bodies.yaml"
RUNS = "bodies/*/runs/*"
# what is made before that table, and of which options
MADE = ("terrain.asc", "terrain.yaml", "road.csv", "windows")
OF = ("terrain", "crs", "assign_crs", "z_unit", "nodata", "differ", "cell", "fill", "road", "road_width", "corridor",
      "cohesion", "friction", "density", "water", "volume", "depth", "keep")
# may change once bodies are there: only the evaluation of their runs has it
LATER = ("sample", "fragility", "name", "client", "author", "blocked", "lane", "clearing", "loosening", "cut_angle",
         "mesh")
BEFORE_RUNS = ("vary",)         # may change until there is one
GIVEN = ("terrain", "road", "road_width", "corridor", "density")        # with the command, or before
STRENGTH = ("cohesion", "friction")     # not of bodies that are given: without them these have no factor of safety


@dataclass(frozen=True)
class Choices:
    """The options of the command, with their units; see its help."""
    terrain: List[str] = key(NEEDED, fewest=1)
    road: str = key(NEEDED)
    road_width: float = key(NEEDED, above=0)
    corridor: float = key(NEEDED, above=0)
    cohesion: Optional[float] = key(NEEDED)
    friction: Optional[float] = key(NEEDED)
    density: float = key(NEEDED, above=0)
    water: Optional[float] = key(None)
    crs: Optional[str] = key(None)
    assign_crs: Optional[str] = key(None)
    z_unit: Optional[str] = key(None)
    nodata: Optional[List[float]] = key(None)
    differ: Optional[float] = key(None)
    cell: Optional[float] = key(None, above=0)
    fill: int = key(0, least=0)
    road_from: float = key(0.0)
    blocked: float = key(roads.NOTHING.blocked, least=0)
    lane: Optional[float] = key(None, above=0)
    clearing: Optional[float] = key(None, above=0)
    loosening: Optional[float] = key(None, least=1)
    cut_angle: float = key(30.0, above=0, below=90)
    mesh: float = key(10.0, above=0)
    volume: Optional[List[float]] = key(None, fewest=2, most_items=2)
    depth: Optional[List[float]] = key(None, fewest=2, most_items=2)
    keep: int = key(3, least=1)
    below: float = key(1.5, above=0)
    bodies: Optional[str] = key(None)
    shape: Optional[str] = key(None)
    ground: Optional[str] = key(None)
    ground_table: Optional[str] = key(None)
    reach: float = key(0.01, least=0, below=1)
    confined: str = key("unknown", of=("yes", "no", "unknown"))
    sample: int = key(4, least=1)
    vary: List[str] = key(["rolling=0:0.1", "packing=1:1000000"])
    balls: Optional[int] = key(None, least=1)
    minutes: Optional[float] = key(None, above=0)
    fragility: Optional[str] = key(None)
    name: Optional[str] = key(None)
    client: Optional[str] = key(None)
    author: Optional[str] = key(None)

    @property
    def asked(self) -> roads.Asked:
        return roads.Asked(self.road_width, self.road_from, self.blocked, self.lane, self.clearing, self.loosening)


@functools.lru_cache
def schema() -> Dict[str, Any]:
    """Of route.yaml: the choices."""
    about = section_schema(Choices)
    return {**about, "required": ["slope_route", *about["required"]],
            "properties": {"slope_route": {"enum": [VERSION]}, **about["properties"], SOURCES: schemas.OBJECT}}


def option(name: str) -> str:
    return f"--{name.replace('_', '-')}"


def settle(folder: Path, given: Mapping[str, Any]) -> Choices:
    """The choices of a folder with those that are given now, checked and kept; SlopeError if they do not fit."""
    path = folder / NAME
    made, before = read_route(folder) if path.is_file() else (None, {})
    known = asdict(made) if made else {}
    changed = [name for name, value in given.items() if known and not is_same_choice(name, known[name], value)]
    for name in changed:
        if name not in LATER and (folder / TABLE).is_file() and not (name in BEFORE_RUNS and not any(
                folder.glob(RUNS))):
            raise SlopeError(option(name), f"must be that of {path}, whose bodies and runs it has made: take another "
                             "folder", given[name])
    for name in GIVEN:
        if name not in {**known, **given}:
            raise SlopeError(option(name), f"must be given, or the folder of a route with {NAME}")
    none: Dict[str, Any] = dict.fromkeys(STRENGTH)
    choices = Choices(**{**none, **known, **given})
    check_route_choices(choices)
    now = {name: digest for name in READ if (digest := content(getattr(choices, name)))}
    for name, digest in now.items():
        if name not in changed and before.get(name, digest) != digest:
            if (folder / TABLE).is_file():
                raise SlopeError(option(name), f"must not have changed since the bodies and runs of {folder} were made "
                                 "of it: take another folder", " ".join(np.ravel(getattr(choices, name))))
            changed.append(name)
    if not path.is_file() and folder.exists() and not (folder.is_dir() and {one.name for one in folder.iterdir()} <= {
            disk.LOCK}):
        raise SlopeError(folder, "must be a new folder, an empty one, or that of a route")
    folder.mkdir(parents=True, exist_ok=True)
    if set(changed) & set(OF):      # there are no bodies yet: what was made for them is begun anew
        remove_made(folder)
    write_route_choices(folder, choices, {**before, **now})
    return choices


@contextlib.contextmanager
def undone_if_refused(folder: Path, given: Mapping[str, Any]) -> Iterator[Choices]:
    """The choices of settle(); where a SlopeError says what is wrong with them, the folder has those of before again.

    Those of which bodies or windows of a search were made stay: the command goes on with these.
    """
    path, table = folder / NAME, folder / TABLE
    before, begun = path.read_text(encoding="utf-8") if path.is_file() else None, table.is_file()
    known = read_route(folder) if before is not None else None
    choices = settle(folder, given)
    try:
        yield choices
    except SlopeError:
        now = read_route(folder)
        if known is None and not (table.is_file() or (folder / "windows").exists()):
            remove_made(folder)
            path.unlink()
        elif known is not None and before is not None and table.is_file() == begun:
            if not begun and (known[1] != now[1] or any(getattr(known[0], name) != getattr(now[0], name)
                                                        for name in OF)):
                remove_made(folder)
            disk.write_file(path, before)
        raise


def remove_made(folder: Path) -> None:
    for place in MADE:
        shutil.rmtree(folder / place, ignore_errors=True)
        (folder / place).unlink(missing_ok=True)


def content(files: Any) -> str:
    """Digest of what files of an option hold; "" without any, and where one is gone, as a folder does without them."""
    paths = [zips.split(os.path.normpath(vectors.source(one).path))[0] for one in
             (files if isinstance(files, list) else [files]) if one]
    return " ".join(map(file_parts.digest_content, paths)) if all(map(os.path.isfile, paths)) else ""


def write_route_choices(folder: Path, choices: Choices, sources: Mapping[str, str]) -> None:
    """Write route.yaml, unless it says so already; sources: digests of the files of options."""
    path = folder / NAME
    about = {name: from_folder(value, folder) if name in FILES else value for name, value in asdict(choices).items()}
    text = disk.yaml_text("slope route: m, m3, Pa, degrees, kg/m3; paths as from here",
                          {"slope_route": VERSION, **about, SOURCES: dict(sources)})
    if not path.is_file() or path.read_text(encoding="utf-8") != text:
        disk.write_file(path, text)


def read_route(folder: Path) -> Tuple[Choices, Dict[str, str]]:
    """The choices of a route's folder, paths as from the working folder; and what the files of options held."""
    path = folder / NAME
    if not path.is_file():
        raise SlopeError(folder, f"must be the folder of a route, with {NAME}")
    about = schemas.load_checked(path, f"{WHAT} of this version", schema())
    del about["slope_route"]
    sources = about.pop(SOURCES, {})
    choices = Choices(**{name: to_here(value, folder) if name in FILES else value for name, value in about.items()})
    return choices, sources


def read_route_choices(folder: Path) -> Choices:
    return read_route(folder)[0]


def from_folder(value: Any, folder: Path) -> Any:
    if isinstance(value, list):
        return [from_folder(one, folder) for one in value]
    return value and Path(os.path.relpath(value, folder)).as_posix()


def to_here(value: Any, folder: Path) -> Any:
    if isinstance(value, list):
        return [to_here(one, folder) for one in value]
    return value and os.path.normpath(folder / value)


def is_same_choice(name: str, value: Any, other: Any) -> bool:
    if name in FILES:
        several = [value if isinstance(value, list) else [value] for value in (value, other)]
        return [[value and os.path.realpath(value) for value in values] for values in several][0] == \
            [value and os.path.realpath(value) for value in several[1]]
    return value == other


def check_route_choices(choices: Choices) -> None:
    """SlopeError, which names the option, unless they may be kept."""
    if wrong := schemas.first_error({"slope_route": VERSION, **asdict(choices)}, schema()):
        place, rule = wrong
        raise SlopeError(option(place[0]), rule)
    for name in ("name", "client", "author"):
        check_text(option(name), getattr(choices, name))
    sample.check_number(choices.sample, len(choices.vary))
    missing = [name for name in STRENGTH if getattr(choices, name) is None]
    if missing and (not choices.bodies or len(missing) < len(STRENGTH)):
        other = next((name for name in STRENGTH if name not in missing), None)
        raise SlopeError(option(missing[0]), f"must be given with {option(other)}" if other else
                         "must be given, unless --bodies are")
    if choices.shape and not choices.bodies:
        raise SlopeError(option("shape"), "must be given with --bodies", choices.shape)
    if choices.balls and choices.minutes:
        raise SlopeError("--minutes", "must be given without --balls", f"{choices.minutes:g}")
    roads.check_road(choices.asked)
