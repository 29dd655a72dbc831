"""site.yaml: every choice of a site, read, checked against its schema, and written with a comment on each.

site_schema.json beside this module has the keys, their ranges, defaults and meaning; nothing else has them. That is of
a mass; a site of another kind says so (`kind`), and the room of that name has a site_schema.json with its own sections
and the names of those that it shares.
"""
import copy
import functools
import hashlib
import json
import math
import os
import re
from pathlib import Path
from typing import Any, Collection, Dict, Iterator, List, Mapping, NamedTuple, Optional, Tuple

import yaml

from .. import disk, schemas, written_yaml
from ..errors import SlopeError
from ..releases import packing
from ..survey import vectors
from ..survey.crs import as_crs

NAME = "site.yaml"
VERSION = 1             # of site.yaml, also in its schema
LONGEST_TEXT = 200      # letters of a name in the heading of a report
PACKING = "packing"     # variable of the deck, and of the study: its repeats
SCHEMA = Path(__file__).with_name("site_schema.json")
MASS, KINDS = "", ("blocks",)       # of sites
WHAT = "a site.yaml of `slope site`"
FOUND = schemas.mapping({}, found=schemas.mapping({}, null=True))       # of any version
# keys that hold one file, and lists of files
FILES = (("terrain", "files"), ("release", "polygon"), ("release", "scar"), ("release", "bodies"), ("road", "file"),
         ("road", "others"), ("ground", "file"), ("ground", "table"), ("structures", "files"), ("structures", "walls"),
         ("lines", "files"), ("motion", "file"), ("observed", "file"))

WITHOUT_CRS = (("ground", "table"), ("structures", "files"), ("motion", "file"))

# beside a raster, a shapefile or a table: CRS, place, attributes
BESIDE = (".prj", ".shx", ".dbf", ".cpg", ".tfw", ".hdr", ".yaml")

# keys that slope site fills in with what it finds
DERIVED = (("balls", "diameter"), ("balls", "number"), ("model", "speed"), ("model", "duration"), ("model", "film"),
           ("model", "cell"), ("motion", "peak_friction"))

# keys that came later: those who made a folder before did not count them
LATER = (("ground", "file"), ("ground", "table"), ("model", "film"), ("structures", "walls"), ("structures", "height"),
         ("structures", "width"), ("model", "least_speed"), ("model", "least_thick"), ("road", "others"))

# keys of section model, and of others, that make the model's balls, cells and stiffness; not what is asked for
OF_MODEL = (*DERIVED, ("model", "least_speed"), ("model", "least_thick"))

# keys of model in older sites, whose ground was a plan grid of one diameter; their decks keep it
RETIRED = ("field_diameter", "field_ratio")
# keys of study, and variables of the deck, in older sites, whose balls began on a cubic lattice; their decks keep it
OFFSETS = ("xoffset", "yoffset", "zoffset")

# keys that older versions had, and that have no meaning any more
DROPPED = {"study": ("sizes",)}

# sections that `slope study` and the report read when they run, except for files, of which the folder has copies
READ_LATER = ("project", "road", "study", "known")
Choices = Dict[str, Any]        # {section: {key: value}}, complete
Derived = Dict[str, Any]        # {"section.key": value} of DERIVED


@functools.lru_cache
def schema(kind: str = MASS) -> Dict[str, Any]:
    """The JSON schema of site.yaml; of another kind, sections that its file does not describe are those of a mass."""
    about = json.loads(SCHEMA.read_text(encoding="utf-8"))
    if kind == MASS:
        return about
    own = json.loads((SCHEMA.parents[1] / kind / SCHEMA.name).read_text(encoding="utf-8"))
    shared = about["properties"]
    return {**about, **own, "properties": {name: one or shared[name] for name, one in own["properties"].items()}}


def sections(kind: str = MASS) -> Iterator[Tuple[str, Dict[str, Any]]]:
    """(name, schema) of the sections that hold choices."""
    for name, about in schema(kind)["properties"].items():
        if "properties" in about:
            yield name, about


def kind_of(given: Any) -> str:
    """Of the site that choices, or what a file holds, are of."""
    kind = given.get("kind", MASS) if isinstance(given, dict) else MASS
    return kind if kind in KINDS else MASS


def defaults(kind: str = MASS) -> Choices:
    """The choices of a site of which nothing is given; files of the terrain are missing."""
    return {name: {key: copy.deepcopy(entry["default"]) for key, entry in about["properties"].items()
                   if "default" in entry} for name, about in sections(kind)}


def complete(given: Choices) -> Choices:
    """Choices with the defaults of all that is not given; with those of an older site's ground, if it has some."""
    old = {"model": dict.fromkeys(RETIRED)} if has_old_ground(given) else {}
    kind = kind_of(given)
    found_ = {name: {**entries, **old.get(name, {}), **(given.get(name) or {})}
              for name, entries in defaults(kind).items()}
    known = found_.get("known", {})
    if isinstance(known.get("confined"), bool):        # yes and no without quotes
        known["confined"] = "yes" if known["confined"] else "no"
    return {**({"kind": kind} if kind else {}), **found_}


def has_old_ground(given: Choices) -> bool:
    """Whether the choices are of an older site, see RETIRED."""
    model = given.get("model")
    return isinstance(model, dict) and any(key in model for key in RETIRED)


def without_old_ground(given: Choices) -> Choices:
    """Choices without keys of older sites, and with a spacing that is possible now."""
    if not has_old_ground(given):
        return given
    model = {key: value for key, value in given["model"].items() if key not in RETIRED}
    if disk.is_number(model.get("spacing")):
        model["spacing"] = min(model["spacing"], widest())
    return {**given, "model": model}


def without_dropped(given: Any) -> Any:
    """What a file holds, without the keys that have no meaning any more."""
    if not isinstance(given, dict):
        return given
    return {name: {key: value for key, value in entries.items() if key not in DROPPED.get(name, ())}
            if isinstance(entries, dict) else entries for name, entries in given.items()}


def has_lattice(given: Choices) -> bool:
    """Whether the choices are of an older site, see OFFSETS."""
    study = given.get("study")
    return isinstance(study, dict) and any(key in study for key in OFFSETS)


def without_lattice(given: Choices) -> Choices:
    """Choices without the lattice of older sites: as many repeats, and the ground as heavy as before."""
    if not has_lattice(given):
        return given
    study = {key: value for key, value in given["study"].items() if key not in OFFSETS}
    moved = sum(len(several) for key in OFFSETS if isinstance(several := given["study"].get(key), list))
    model = given.get("model")
    if isinstance(model, dict) and disk.is_number(model.get("density")):
        model = {**model, "density": round(model["density"] * math.pi / 6 * packing.BULK, 1)}
    return {**given, **({"model": model} if model else {}), "study": {**study, PACKING: list(range(2, 2 + moved))}}


def chance(variables: Mapping[str, str]) -> str:
    """--vary of what differs between runs by chance alone, of a deck with these index variables."""
    return f"{PACKING}=1:1000000" if PACKING in variables else f"{OFFSETS[0]}=0:0.99"


def not_varied(choices: Choices, varied: Collection[str]) -> Dict[str, str]:
    """Values of the runs of an ensemble that varies variables of these names: of lists of the study that it does not,
    the first one, as the deck has none.
    """
    return {} if "rolling" in varied else {"rolling": f"{choices['study']['rolling'][0]:.10g}"}


def widest() -> float:
    """The largest spacing of the ground's balls, in diameters: through a wider one balls fall."""
    return schema()["properties"]["model"]["properties"]["spacing"]["maximum"]


def other_grounds(choices: Choices) -> List[Tuple[float, float]]:
    """(spacing, rolling resistance) of the study's runs on other grounds than the model's."""
    rolling = choices["study"]["rolling"]
    return [(spacing, one) for spacing in choices["study"]["spacing"] if spacing != choices["model"]["spacing"]
            for one in sorted({min(rolling), max(rolling)})]


def check(given: Any, where: str, options: Optional[Mapping[Tuple[str, str], str]] = None) -> None:
    """Raise SlopeError, which names the key, unless it is a site.yaml of this version.

    options: what to name instead of a section and key, such as an option that gave it.
    """
    if not isinstance(given, dict) or "slope_site" not in given:
        raise SlopeError(where, f"must be {WHAT}, with slope_site")
    if given["slope_site"] != VERSION:
        raise SlopeError(f"{where}: slope_site", f"must be {VERSION}, the version that this program reads: make a new "
                         "site from its files, or use the program that made it", given["slope_site"])
    if wrong := schemas.first_error(given, schema(kind_of(given))):
        place, rule = wrong
        key = ".".join(str(part) for part in place if isinstance(part, str))
        at = "".join(f": {schemas.nth(part)}" for part in place if isinstance(part, int))
        option = (options or {}).get((str(place[0]), str(place[1])) if len(place) > 1 else ("", ""))
        raise SlopeError((option or (f"{where}: {key}" if key else where)) + at, rule)
    for key, text in (given.get("project") or {}).items():      # now, as the report comes last
        check_text((options or {}).get(("project", key), f"{where}: project.{key}"), text)


def check_text(where: str, text: Any) -> None:
    """Raise SlopeError unless a text, or None, fits the heading of a report."""
    if text is not None and not (isinstance(text, str) and text.isprintable() and len(text) <= LONGEST_TEXT):
        raise SlopeError(where, f"must be one line of at most {LONGEST_TEXT} letters", repr(text))


def content(path: str) -> str:
    """Digest of a file, with the files beside it that say what it means."""
    beside = [str(Path(path).with_suffix(suffix)) for suffix in BESIDE] + [f"{path}.aux.xml"]
    parts = [os.path.basename(one) + disk.sha256(one) for one in (path, *beside) if os.path.isfile(one)]
    return hashlib.sha256("\n".join(parts).encode("utf-8")).hexdigest()


class Site(NamedTuple):
    """A site's folder, and its site.yaml: a command reads it once, and passes it on."""
    folder: Path
    choices: Choices        # complete; paths of files relative to the working folder
    written: Choices        # the same with the paths that the file has, which are those from the folder
    found: Dict[str, Any]   # what slope site found when it made the folder
    content: Dict[str, Any]     # of the file
    road: str = ""          # which of several is asked now (site_roads); none of a single one, or of the worst

    @classmethod
    def of(cls, choices: Choices, folder: Path) -> "Site":
        """The same of choices that were not read."""
        return cls(folder, choices, with_files(choices, lambda name: in_folder(name, folder)), {}, {})

    def fingerprint(self) -> str:
        """Of all choices that the deck and its data depend on; not of those that `slope study` takes from site.yaml.

        Files count by the paths that site.yaml has: the folder may have moved.
        """
        made = with_files(self.written, os.path.normpath)
        for name in (name for name in READ_LATER if name in made):
            made[name] = {key: value for key, value in made[name].items() if (name, key) in FILES}
        for name, key in LATER:
            if made.get(name, {}).get(key, True) in (None, []):
                del made[name][key]
        made = {name: section for name, section in made.items() if section or name in READ_LATER}
        return hashlib.sha256(json.dumps(disk.plain(made), sort_keys=True).encode("utf-8")).hexdigest()

    def sources(self) -> Dict[str, str]:
        """{path as in site.yaml: digest} of the files that the choices name and that exist, with the files beside them
        that say what they mean."""
        digests: Dict[str, str] = {}
        for place, name in zip(source_files(self.choices), source_files(self.written)):
            path = vectors.source(place).path
            if os.path.isfile(path):
                digests[os.path.normpath(vectors.source(name).path)] = content(path)
        return digests


def load(folder: Path, kind: str = MASS) -> Site:
    """The Site of a folder; SlopeError unless its site.yaml is one of this version, and of a kind."""
    path = folder / NAME
    if not path.is_file():
        raise SlopeError(folder, f"must be a folder with {NAME}, which slope site makes")
    content = disk.parse_yaml(path, WHAT)
    if kind_of(content) != kind:
        raise SlopeError(folder, f"must be a site of {kind or 'a mass'} here", f"one of {kind_of(content) or 'a mass'}")
    given = without_dropped(content)
    check(without_lattice(without_old_ground(given)) if isinstance(given, dict) else given, str(path))
    schemas.check(content, FOUND, path, WHAT)
    written, place = complete(given), real(folder)
    return Site(folder, with_files(written, lambda name: os.path.normpath(place / name)), written,
                content.get("found") or {}, content)


def around(deck: Path) -> Optional[Site]:
    """The Site in whose folder a deck lies; None of any other deck."""
    return load(deck.parent) if (deck.parent / NAME).is_file() else None


def read(folder: Path, kind: str = MASS) -> Choices:
    """The complete choices of a site's folder; paths of files relative to the working folder."""
    return load(folder, kind).choices


def kind_in(folder: Path) -> str:
    """The kind of the site in a folder by a look at its text, which picks who reads and checks it; else of a mass."""
    path = Path(folder) / NAME
    text = path.read_text(encoding="utf-8", errors="replace") if path.is_file() else ""
    said = re.search(r"^kind:\s*[\"']?(\w+)", text, re.MULTILINE)
    return said[1] if said and said[1] in KINDS else MASS


def found(folder: Path) -> Dict[str, Any]:
    """What slope site found when it made a folder."""
    return schemas.load(folder / NAME, WHAT, FOUND).get("found") or {}


def real(folder: Path) -> Path:
    """A folder from which `..` leads where the system goes: without symbolic links on the way to it."""
    place = os.path.realpath(folder)
    return folder if place == os.path.abspath(folder) else Path(place)


def in_folder(name: str, folder: Path) -> str:
    """The path of a file as site.yaml in a folder has it."""
    return Path(os.path.relpath(name, real(folder))).as_posix()


def derived(before: Choices, after: Choices, known: Derived) -> Derived:
    """The choices that the user left open and the command determined: now, or earlier (known) and unchanged since."""
    names = {f"{section}.{key}": (before[section][key], after[section][key]) for section, key in DERIVED
             if key in before.get(section, {})}
    return {name: now for name, (was, now) in names.items()
            if now is not None and (was is None or (name in known and known[name] == now))}


def forget(choices: Choices, known: Derived) -> None:
    """Set to null what the command determined and the user did not change, so that it is determined again."""
    for section, key in DERIVED:
        name = f"{section}.{key}"
        if name in known and known[name] == choices.get(section, {}).get(key):
            choices[section][key] = None


def with_files(choices: Choices, change) -> Choices:
    """The choices with all names of files changed by a function."""
    new = copy.deepcopy(choices)
    about = schema(kind_of(choices))["properties"]
    for section, key in FILES:
        if key not in about.get(section, {"properties": ()})["properties"]:
            continue
        value = new[section].get(key)
        new[section][key] = [change(one) for one in value] if isinstance(value, list) else value and change(value)
    return new


def source_files(choices: Choices) -> List[str]:
    """All files that the choices name."""
    return [name for section, key in FILES for name in listed(choices, section, key)]


def listed(choices: Choices, section: str, key: str) -> List[str]:
    """The files of a key, also of one that holds one file or none."""
    value = choices.get(section, {}).get(key)
    return value if isinstance(value, list) else [value] if value else []


def assigned(choices: Choices, name: str) -> Optional[str]:
    """The CRS that the choices assign to a file, None if they assign none; a key is the end of its path."""
    parts = Path(vectors.source(name).path).parts
    own = choices["crs"]["assigned"]
    fit = [key for key in own if parts[-len(Path(key).parts):] == Path(key).parts]
    return own[max(fit, key=len)] if fit else None


def check_assigned(choices: Choices) -> None:
    """Raise SlopeError unless every key of crs.assigned is the end of the path of a file that has a CRS."""
    named = [name for place in FILES if place not in WITHOUT_CRS for name in listed(choices, *place)]
    for key, crs in choices["crs"]["assigned"].items():
        if all(assigned({"crs": {"assigned": {key: crs}}}, name) is None for name in named):
            raise SlopeError("--assign-crs", "FILE=EPSG:n must name a file of the site that has coordinates, "
                             + ", ".join(Path(vectors.source(name).path).name for name in named), key)
        as_crs(f"--assign-crs {key}", crs)


def text(choices: Choices, found_: Dict[str, Any], folder: Path) -> str:
    """site.yaml for a folder: the choices, each with its meaning, and what was found; checked before it is given."""
    seen = with_files(choices, lambda name: in_folder(name, folder))
    kind = kind_of(choices)
    about = schema(kind)
    lines = [f"# {about['description']}.", "# `slope site FOLDER` rebuilds the folder from it, `slope study FOLDER` "
             "runs it.", "", f"slope_site: {VERSION}    # version of this file", *([f"kind: {kind}"] if kind else [])]
    for name, section in sections(kind):
        lines += ["", f"{name}:    # {section['description']}"]
        for key, entry in section["properties"].items():
            comment = f"    # {entry['description']}" if "description" in entry else ""
            lines.append(f"  {key}: {flow(seen[name][key])}{comment}")
    lines += ["", f"found:    # {about['properties']['found']['description']}"]
    lines += [f"  {line}" for line in yaml.safe_dump(disk.plain(found_), sort_keys=False, allow_unicode=True,
                                                     width=1000).splitlines()]
    whole = "\n".join(lines) + "\n"
    check(written_yaml.load(whole), NAME)
    return whole


def flow(value: Any) -> str:
    """A value as YAML on one line."""
    return yaml.safe_dump(disk.plain(value), default_flow_style=True, allow_unicode=True,
                          width=10 ** 9).strip().removesuffix("...").strip()
