"""What the result of a run depends on: the program, its libraries, the deck, the files and variables that it reads.

One comparison decides both whether a finished run is taken over and whether an unfinished one is continued.
"""
import functools
import hashlib
import os
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any, Dict, FrozenSet, Iterable, Mapping, NamedTuple, Optional, Set, Tuple

import yaml

from .. import disk, written_yaml
from ..case import decks, run_folders
from ..case.settings import normalise_value

PLUGINS = "LAMMPS_PLUGIN_PATH"      # folders of plugins that LAMMPS loads when it starts
LIBRARIES = "LD_LIBRARY_PATH"       # folders in which a plugin that a deck loads by its bare name is looked for
SYSTEM = ("/lib", "/usr/lib")        # folders of the system's own libraries
BESIDE = (".yaml", ".prj")          # sidecars of a raster or a table: terrain.yaml of terrain.asc
HISTORY = ("sources", "steps")      # of a sidecar: from which files its raster was made, and how


class State(NamedTuple):
    """Digests of all that counts, by name."""
    program: Dict[str, str]         # the program and its libraries
    environment: Dict[str, str]
    files: Dict[str, str]           # by path in the run folder, or by absolute path


def program(lmp: Path) -> Dict[str, str]:
    """{name: digest} of the program, of the shared libraries that it loads, and of the plugins of the environment."""
    digests = {"LAMMPS program": disk.sha256(lmp)}
    plugins = [path for folder in os.environ.get(PLUGINS, "").split(":") if folder
               for path in sorted(Path(folder).glob("*plugin.so"))]
    for path in plugins:
        digests[path.name] = disk.sha256(path)
    for path in (lmp, *plugins):
        for library in linked(path):
            digests[library.name] = disk.sha256(library)
    return digests


def linked(path: Path) -> Set[Path]:
    """The shared libraries that a program or a library loads, but for the system's; none of a script."""
    if not shutil.which("ldd"):
        return set()
    done = subprocess.run(["ldd", str(path)], stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)
    names = re.findall(r"(/.+?) \(0x[0-9a-f]+\)$", done.stdout, re.MULTILINE)
    return {Path(name) for name in names if os.path.isfile(name) and
            (os.path.basename(name).startswith("liblammps") or not os.path.realpath(name).startswith(SYSTEM))}


class Dependencies:
    """What the runs of a deck depend on now.

    deck: that of which the runs have copies; digests: {path in the run folder: sha256} of all files that they get; lmp:
    the program, None if it does not count; source: where the deck was copied from.
    """

    def __init__(self, deck: Path, digests: Mapping[str, str], lmp: Optional[Path] = None,
                 source: Optional[Path] = None):
        self.deck, self.digests, self.source = deck, dict(digests), source or deck
        self.program = program(lmp) if lmp else None
        self._bases: Dict[str, Set[str]] = {}       # of a file and those whose sidecar it is
        commands = decks.commands(deck)
        self.values = {**{name: text for name, (style, text) in decks.variables(deck).items() if style == "string"},
                       **decks.index_variables(deck)}
        self.words = decks.read_words(commands)
        self.variables = {words[3] for words in commands if words[0] == "variable" and words[2:3] == ["getenv"]
                          and len(words) > 3}

    def now(self, run) -> State:
        """What a run depends on; of its files those that its deck, its values or its log so far name."""
        words = self._words(run)
        variables = {decks.filled(name, {**self.values, **run.chosen}) for name in self.variables | run.log.environment}
        environment = {name: hashlib.sha256(os.environ[name].encode("utf-8", "surrogateescape")).hexdigest()
                       for name in sorted(variables) if name in os.environ}
        here = {name: digest for name, digest in self.digests.items() if self._used(name, words)}
        return State(self.program or {}, environment, {**here, **outside(words, run.folder)})

    def changed(self, run) -> Optional[str]:
        """The first thing that a run depends on and that is not what it was when the run was made; None if all is."""
        begun, marker = run_folders.begun(run.folder), run_folders.ended(run.folder)
        run.log.update()
        now, words = self.now(run), self._words(run)
        before = {**(begun.get("program") or {})}
        if self.program is not None:
            for name in sorted({*now.program, *before}, key=lambda name: (name != "LAMMPS program", name)):
                if now.program.get(name) != before.get(name):
                    return name
        before = {**(begun.get("environment") or {}), **(marker.get("environment") or {})}
        for name in sorted({*now.environment, *before}):
            if now.environment.get(name) != before.get(name):
                return f"environment variable {name}"
        before = {**(begun.get("inputs") or {}), **(marker.get("inputs") or {})}
        before = {name: digest for name, digest in before.items() if os.path.isabs(name) or self._used(name, words)}
        for name in sorted({*now.files, *before}, key=lambda name: (name != self.deck.name, name)):
            if now.files.get(name) != before.get(name) and not self._means_the_same(run, name):
                return name
        return None

    def copies_changed(self, run) -> Optional[str]:
        """The first input that the folder of a run does not hold as it was given: a continued run would read it."""
        for name, digest in self.now(run).files.items():
            path = run.folder / name
            if os.path.isabs(name) or (path.is_file() and disk.sha256(path) == digest):
                continue
            if not self._means_the_same(run, name):
                return name
        return None

    def _means_the_same(self, run, name: str) -> bool:
        """Whether a run's copy of the deck, or of a sidecar, says the same as that of now in other words."""
        copy, now = run.folder / name, self.deck.parent / name
        if not (copy.is_file() and now.is_file()):
            return False
        if name == self.deck.name:
            return self._same_deck(run, copy)
        return name.endswith(".yaml") and bool(sidecar_of(name, self.digests)) and place_of(copy) == place_of(now)

    def _same_deck(self, run, copy: Path) -> bool:
        """Whether a run's copy of the deck differs at most in comments and blanks, and in values of index variables
        that the run has from elsewhere."""
        had = run_folders.begun(run.folder).get("variables") or {}
        defaults = by_value(had) != by_value({**decks.index_variables(self.deck), **run.chosen})
        return decks.without_comments(copy, defaults) == decks.without_comments(self.deck, defaults)

    def _words(self, run) -> str:
        """All words that may name files which a run reads, a line each."""
        values = {**self.values, **run.chosen}
        filled = {decks.filled(word, values) for word in self.words if "$" in word}
        return "\n".join(sorted({*self.words, *filled, *values.values(), *run.log.names}))

    def _used(self, name: str, words: str) -> bool:
        """Whether a file in the run folder counts: the deck, what a word names in whatever spelling, its sidecars."""
        if name not in self._bases:
            self._bases[name] = {os.path.basename(one) for one in (name, *sidecar_of(name, self.digests))}
        return name == self.deck.name or any(one in words for one in self._bases[name])


def by_value(variables: Mapping[str, str]) -> FrozenSet[Tuple[str, Any]]:
    """What a run is known by: its variables with numbers as numbers, so that 0.1 and 0.10 are one value."""
    return frozenset((name, normalise_value(str(value))) for name, value in variables.items())


def place_of(sidecar: Path) -> Any:
    """What a sidecar says of its raster, without where that came from; as it stands, where that is no mapping."""
    return parse_sidecar(sidecar.read_text(encoding="utf-8", errors="surrogateescape"))


@functools.lru_cache(maxsize=8)
def parse_sidecar(text: str) -> Any:
    """The same of its text; the runs of a study have copies of few."""
    try:
        about = written_yaml.load_yaml(text)
    except (yaml.YAMLError, ValueError, RecursionError):
        return text
    return {key: value for key, value in about.items() if key not in HISTORY} if isinstance(about, dict) else text


def sidecar_of(name: str, names: Iterable[str]) -> Set[str]:
    """The files among names whose sidecar this one is."""
    return {one for one in names if one != name and name in sidecars(one)}


def sidecars(name: str) -> Set[str]:
    """The names that sidecars of a file have."""
    return {str(Path(name).with_suffix(suffix)) for suffix in BESIDE} | {f"{name}.aux.xml"}


def outside(words: str, folder: Path) -> Dict[str, str]:
    """{absolute path: digest} of the files outside of the run folder that words name, and of their sidecars."""
    libraries = [one for one in os.environ.get(LIBRARIES, "").split(":") if one]
    top = os.path.abspath(folder)
    digests: Dict[str, str] = {}
    for word in {*words.split("\n"), *decks.PATHS.findall(words)}:
        if "/" in word:
            places = [os.path.normpath(os.path.join(top, word))]
        elif word.endswith(".so"):
            places = [os.path.join(os.path.abspath(one), word) for one in libraries]
        else:
            continue
        for place in places:
            if not place.startswith(f"{top}{os.sep}") and os.path.isfile(place):
                for path in (place, *sidecars(place)):
                    if os.path.isfile(path):
                        digests[path] = disk.sha256(path)
    return digests
