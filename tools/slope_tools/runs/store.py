"""The folder of the runs of a study or a site: a run is known by the values of its deck's variables; none is twice."""
import contextlib
import hashlib
from pathlib import Path
from typing import Any, Dict, FrozenSet, Iterable, List, Mapping, Optional, Sequence, Tuple

from ..case import decks, run_folders
from ..errors import SlopeError
from . import dependencies

MOST_LETTERS = 200      # of a folder's name; file systems take 255
LETTERS = 6             # of a digest, where a name alone does not tell two runs apart

Values = FrozenSet[Tuple[str, Any]]     # of dependencies.by_value


def select_distinct_runs(todo: Iterable[Any]) -> List[Any]:
    """The first run (jobs.Run) of each folder."""
    first: Dict[Path, Any] = {}
    for run in todo:
        first.setdefault(run.folder, run)
    return list(first.values())


class Store:
    """The runs of a deck in a folder.

    older: folders of a site in which earlier versions made runs; anew: whether finished runs of another program, deck
    or data are made again.
    """

    def __init__(self, folder: Path, depends: dependencies.Dependencies, older: Sequence[Path] = (), anew=False):
        self.folder, self.depends, self.older, self.anew = folder, depends, older, anew
        self.defaults = decks.index_variables(depends.deck)
        self.places: Dict[Values, Path] = {}            # of the runs that were asked for
        self.made: Optional[Dict[Values, Path]] = None  # of those that are there, once they are looked at

    def admit(self, todo: Iterable[Any]) -> None:
        """Give runs (jobs.Run) their folders; SlopeError if a finished one may not be taken over."""
        for run in todo:
            values = self._values(run.chosen)
            if values not in self.places:
                self.places[values] = self._place(run, values)
            run.move(self.places[values])
            run.changed = self.depends.changed(run) if run.marker.exists() else None
            if run.changed and not self.anew:
                whose = f"that of {self.depends.source.parent}" if run.changed in self.depends.digests else \
                    "the present one"
                raise SlopeError(run.folder, f"was run with another {run.changed} than {whose}: --anew makes it again, "
                                 "with all others of which that holds")

    def _values(self, chosen: Mapping[str, Any]) -> Values:
        return dependencies.by_value({**self.defaults, **chosen})

    def _place(self, run, values: Values) -> Path:
        """The folder of a run: that of its name, or the one that has its values already."""
        usual = self.folder / run.name
        mine = usual not in self.places.values() and len(run.name) <= MOST_LETTERS
        if mine and usual.exists():
            if self._has(usual, run, values):
                return usual
            mine = False
        if not mine:
            digest = hashlib.sha256(repr(sorted(values, key=str)).encode("utf-8")).hexdigest()[:LETTERS]
            usual = self.folder / f"{run.name[:MOST_LETTERS]}_{digest}"
        found = self._made().get(values, usual)
        return usual if found in self.places.values() else found     # of another run, which will have other values

    def _has(self, folder: Path, run, values: Values) -> bool:
        """Whether a folder of a run's name is the run's: of the same values, or of a deck with other variables."""
        if not (folder / run_folders.VARIABLES).is_file():
            return False
        about = run_folders.begun(folder)
        had = about.get("variables") or {}
        return about.get("set") == run.chosen and (set(had) != {name for name, _ in values}
                                                   or dependencies.by_value(had) == values)

    def _made(self) -> Dict[Values, Path]:
        """The runs that are there, finished ones before others."""
        if self.made is None:
            self.made = {}
            found = [path.parent for folder in (self.folder, *self.older)
                     for path in sorted(folder.glob(f"[!.]*/{run_folders.VARIABLES}"))]
            for path in sorted(found, key=lambda path: not (path / run_folders.MARKER).exists()):
                with contextlib.suppress(SlopeError):       # no run of ours
                    about = run_folders.begun(path)
                    if about.get("deck") == self.depends.deck.name:
                        self.made.setdefault(self._values(about.get("variables") or {}), path)
        return self.made
