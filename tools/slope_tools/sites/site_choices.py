"""site.yaml: every choice of a site, read, checked against its schema, and written with a comment on each.

Its sections as types: site_sections.py; what slope site found: site_found.py.
"""
import hashlib
import json
import os
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Callable, Collection, Dict, Generic, Iterable, List, Mapping, Optional, Tuple, Type, TypeVar

import yaml

from .. import disk, schemas, written_yaml
from ..errors import SlopeError
from ..survey import file_parts, vectors, zips
from ..survey.crs import as_crs
from . import site_found
from .site_found import Found
from .site_sections import KINDS, PACKING, VERSION, C, Choices, Key, OfMass, kind_of, schema, sections

NAME = "site.yaml"
LONGEST_TEXT = 200      # letters of a name in the heading of a report
WHAT = "a site.yaml of `slope site`"
# keys that hold one file, and lists of files
FILES = (("terrain", "files"), ("release", "polygon"), ("release", "scar"), ("release", "bodies"),
         ("release", "foundation"), ("road", "file"),
         ("road", "others"), ("ground", "file"), ("ground", "table"), ("structures", "files"), ("structures", "walls"),
         ("lines", "files"), ("motion", "file"), ("observed", "file"))

WITHOUT_CRS = (("ground", "table"), ("structures", "files"), ("motion", "file"))

# keys that slope site fills in with what it finds
DERIVED = (("balls", "diameter"), ("balls", "number"), ("model", "speed"), ("model", "duration"), ("model", "film"),
           ("model", "cell"), ("motion", "peak_friction"))

# keys that came later: those who made a folder before did not count them
LATER = (("ground", "file"), ("ground", "table"), ("model", "film"), ("structures", "walls"), ("structures", "height"),
         ("structures", "width"), ("model", "least_speed"), ("model", "least_thick"), ("road", "others"),
         ("terrain", "differ"), ("release", "foundation"))

# keys of section model, and of others, that make the model's balls, cells and stiffness; not what is asked for
OF_MODEL = (*DERIVED, ("model", "least_speed"), ("model", "least_thick"))

# --vary of what differs between runs by chance alone
CHANCE = f"{PACKING}=1:1000000"

# sections that `slope study` and the report read when they run, except for files, of which the folder has copies
READ_LATER = ("project", "road", "study", "known")
Derived = Mapping[str, Any]     # {"section.key": value} of DERIVED
K = TypeVar("K", bound=Choices, covariant=True)


def not_varied(choices: OfMass, varied: Collection[str]) -> Dict[str, str]:
    """Values of the runs of an ensemble that varies variables of these names: of lists of the study that it does not,
    the first one, as the deck has none.
    """
    return {} if "rolling" in varied else {"rolling": f"{choices.study.rolling[0]:.10g}"}


def check_site_file(given: Any, where: str, options: Optional[Mapping[Tuple[str, str], str]] = None) -> None:
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
        older = rule.startswith(schemas.NO_OTHERS)
        remedy = "; if an older version wrote it, make the site anew from its files" * older
        raise SlopeError((option or (f"{where}: {key}" if key else where)) + at, f"{rule}{remedy}")
    for key, text in (given.get("project") or {}).items():      # now, as the report comes last
        check_text((options or {}).get(("project", key), f"{where}: project.{key}"), text)


def check_text(where: str, text: object) -> None:
    """Raise SlopeError unless a text, or None, fits the heading of a report."""
    if text is not None and not (isinstance(text, str) and text.isprintable() and len(text) <= LONGEST_TEXT):
        raise SlopeError(where, f"must be one line of at most {LONGEST_TEXT} letters", repr(text))


@dataclass(frozen=True)
class Folder(Generic[K]):
    """A site's folder, and its site.yaml: a command reads it once, and passes it on."""
    folder: Path
    choices: K              # paths of files relative to the working folder
    written: K              # the same with the paths that the file has, which are those from the folder
    found: Found
    content: Dict[str, Any]         # of the file
    road: str = ""          # which of several is asked now (site_roads); none of a single one, or of the worst

    def fingerprint(self) -> str:
        """Of all choices that the deck and its data depend on; not of those that `slope study` takes from site.yaml.

        Files count by the paths that site.yaml has: the folder may have moved.
        """
        made = with_files(self.written, os.path.normpath).entries()
        for name in (name for name in READ_LATER if name in made):
            made[name] = {key: value for key, value in made[name].items() if (name, key) in FILES}
        for name, key in LATER:
            if made.get(name, {}).get(key, True) in (None, []):
                del made[name][key]
        made = {name: section for name, section in made.items() if section or name in READ_LATER}
        return hashlib.sha256(json.dumps(made, sort_keys=True).encode("utf-8")).hexdigest()

    def sources(self) -> Dict[str, str]:
        """{path as in site.yaml: digest} of the files that the choices name and that exist, with the files beside them
        that say what they mean."""
        digests: Dict[str, str] = {}
        for place, name in zip(source_files(self.choices), source_files(self.written)):
            path, member = zips.split(os.path.normpath(vectors.source(place).path))
            if os.path.isfile(path):
                own = os.path.normpath(vectors.source(name).path)
                digests[own.removesuffix(f"/{member}")] = file_parts.digest_content(path)
        return digests


Site = Folder[OfMass]


def unread(choices: C, folder: Path) -> Folder[C]:
    """The same of choices that were not read."""
    return Folder(folder, choices, with_files(choices, lambda name: in_folder(name, folder)), Found(), {})


def load_site(folder: Path) -> Site:
    """The Site of a mass in a folder; SlopeError unless its site.yaml is one of this version."""
    return load_kind(folder, OfMass)


def load_kind(folder: Path, kind: Type[C]) -> Folder[C]:
    """The same of any kind."""
    path = folder / NAME
    if not path.is_file():
        raise SlopeError(folder, f"must be a folder with {NAME}, which slope site makes")
    content = disk.parse_yaml(path, WHAT)
    if kind_of(content) != kind.KIND:
        raise SlopeError(folder, f"must be a site of {kind.KIND or 'a mass'} here",
                         f"one of {kind_of(content) or 'a mass'}")
    check_site_file(content, str(path))
    schemas.check_schema(content, site_found.SCHEMA, path, WHAT)
    written, place = kind.of(content), real(folder)
    return Folder(folder, with_files(written, lambda name: os.path.normpath(place / name)), written,
                  Found.of(content), content)


def kind_in(folder: Path) -> Type[Choices]:
    """The kind of the site in a folder by a look at its text, which picks who reads and checks it; else a mass."""
    path = Path(folder) / NAME
    text = path.read_text(encoding="utf-8", errors="replace") if path.is_file() else ""
    said = re.search(r"^kind:\s*[\"']?(\w+)", text, re.MULTILINE)
    return KINDS.get(said[1] if said else "", OfMass)


def found(folder: Path) -> Found:
    """What slope site found when it made a folder."""
    return Found.of(schemas.load_checked(folder / NAME, WHAT, site_found.SCHEMA))


def real(folder: Path) -> Path:
    """A folder from which `..` leads where the system goes: without symbolic links on the way to it."""
    place = os.path.realpath(folder)
    return folder if place == os.path.abspath(folder) else Path(place)


def in_folder(name: str, folder: Path) -> str:
    """The path of a file as site.yaml in a folder has it."""
    return Path(os.path.relpath(name, real(folder))).as_posix()


def derived(before: Choices, after: Choices, known: Derived) -> Derived:
    """The choices that the user left open and the command determined: now, or earlier (known) and unchanged since."""
    names = {f"{section}.{key}": (before.value(section, key), after.value(section, key)) for section, key in DERIVED}
    return {name: now for name, (was, now) in names.items()
            if now is not None and (was is None or (name in known and known[name] == now))}


def forgotten(choices: C, known: Derived) -> C:
    """With null for what the command determined and the user did not change, so that it is determined again."""
    return choices.changed({(section, key): None for section, key in DERIVED if (name := f"{section}.{key}") in known
                            and choices.has(section, key) and known[name] == choices.value(section, key)})


def with_files(choices: C, change: Callable[[str], str]) -> C:
    """The choices with all names of files changed by a function."""
    new: Dict[Key, Any] = {}
    for section, key in FILES:
        if (value := choices.value(section, key)) and not disk.is_finite_number(value):
            new[section, key] = change(value) if isinstance(value, str) else [change(one) for one in value]
    return choices.changed(new)


def source_files(choices: Choices) -> List[str]:
    """All files that the choices name."""
    return [name for section, key in FILES for name in choices.files(section, key)]


def assigned(choices: Choices, name: str) -> Optional[str]:
    """The CRS that the choices assign to a file, None if they assign none; a key is the end of its path."""
    parts = Path(vectors.source(name).path).parts
    own = choices.crs.assigned
    fit = [key for key in own if is_end(key, parts)]
    return own[max(fit, key=len)] if fit else None


def assigned_crs(words: Iterable[str]) -> Dict[str, Any]:
    """Options from the values of --assign-crs, [FILE=]EPSG:n: that of the elevation model, those of other files."""
    given: Dict[str, Any] = {}
    for word in words:
        name, _, crs = word.rpartition("=")
        if not name and "assign_crs" in given:
            raise SlopeError("--assign-crs", "must be given once without a FILE=", word)
        if name:
            parts = [part for part in Path(name).parts if part not in ("..", "/")]
            given.setdefault("assigned", {})[str(Path(*parts))] = crs
        else:
            given["assign_crs"] = crs
    return given


def is_end(key: str, parts: Tuple[str, ...]) -> bool:
    """Whether a path, in parts, ends in a key of crs.assigned."""
    return parts[-len(Path(key).parts):] == Path(key).parts


def check_assigned(choices: Choices) -> None:
    """Raise SlopeError unless every key of crs.assigned is the end of the path of a file that has a CRS."""
    named = [Path(vectors.source(name).path) for place in FILES if place not in WITHOUT_CRS
             for name in choices.files(*place)]
    for key, crs in choices.crs.assigned.items():
        if not any(is_end(key, path.parts) for path in named):
            raise SlopeError("--assign-crs", "FILE=EPSG:n must name a file of the site that has coordinates, "
                             + ", ".join(path.name for path in named), key)
        as_crs(f"--assign-crs {key}", crs)


def make_site_file(choices: Choices, found_: Mapping[str, Any], folder: Path) -> str:
    """site.yaml for a folder: the choices, each with its meaning, and what was found; checked before it is given."""
    seen, kind = with_files(choices, lambda name: in_folder(name, folder)), choices.KIND
    keys = schema(kind)
    lines = [f"# {keys['description']}.", "# `slope site FOLDER` rebuilds the folder from it, `slope study FOLDER` "
             "runs it.", "", f"slope_site: {VERSION}    # version of this file", *([f"kind: {kind}"] if kind else [])]
    for name, section in sections(kind):
        lines += ["", f"{name}:    # {section['description']}"]
        for key, entry in section["properties"].items():
            comment = f"    # {entry['description']}" if "description" in entry else ""
            lines.append(f"  {key}: {flow(seen.value(name, key))}{comment}")
    lines += ["", f"found:    # {keys['properties']['found']['description']}"]
    lines += [f"  {line}" for line in yaml.safe_dump(disk.make_plain(found_), sort_keys=False, allow_unicode=True,
                                                     width=1000).splitlines()]
    whole = "\n".join(lines) + "\n"
    check_site_file(written_yaml.load_yaml(whole), NAME)
    return whole


def flow(value: object) -> str:
    """A value as YAML on one line."""
    line: str = yaml.safe_dump(disk.make_plain(value), default_flow_style=True, allow_unicode=True, width=10 ** 9)
    return line.strip().removesuffix("...").strip()
