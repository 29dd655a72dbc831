"""The study of a site of blocks: its runs, their outcome, files and page."""
from typing import Any, List, NamedTuple, Sequence

from ..case import decks
from ..errors import SlopeError
from ..findings import Finding
from ..runs import repeats
from ..sites import site_deck
from ..sites.site_choices import Folder
from ..sites.site_sections import OfBlocks
from ..studies import site_study, study
from ..studies.setup import RUNS, Setup
from . import files, outcome, page, runs


class Known(NamedTuple):
    """A site and what its finished runs say."""
    site: Folder[OfBlocks]
    terrain: runs.Terrain
    runs: Sequence[runs.Run]
    outcome: outcome.Outcome
    doubts: Sequence[Finding]


def settings_of(site: Folder[OfBlocks]):
    """{variable of the deck: its values}."""
    return {"rolling": site_study.words(site.choices.study.rolling),
            "ground": [str(k) for k in range(1, site.choices.blocks.grounds + 1)]}


def planned(site: Folder[OfBlocks]) -> List[repeats.Repeat]:
    return repeats.plan(site.folder / RUNS, settings_of(site), {}, decks.index_variables(site.folder / site_deck.NAME))


def run(site: Folder[OfBlocks], engine: Setup) -> None:
    """Make or continue all runs and show the outcome; raises SlopeError on bad input, and last if a run failed."""
    setup = engine._replace(deck=site.folder / site_deck.NAME, output=site.folder / site_study.STUDY, site=site.folder,
                            road=None)

    def collect(todo, _) -> None:
        if all(one.error for one in todo):
            raise study.failure(setup.output, todo) or SlopeError(setup.output, "must have a run")
        known = read(site, todo)
        files.write(setup.output, known)
        for line in page.sentences(known):
            setup.tell(line)
        for one in known.outcome.doubts():
            setup.warn(one)
        setup.tell(page.write(known, site.folder / page.NAME))
    with study.alone(site.folder, setup.dry_run):
        study.perform(setup, settings_of(site), planned(site), collect)


def read(site: Folder[OfBlocks], todo: Sequence[Any]) -> Known:
    """What those of these runs say that finished; SlopeError if none did."""
    terrain = runs.terrain_of(site)
    found = [runs.read(one.name, one.folder, one.chosen, terrain) for one in todo if one.finished]
    if not found:
        raise SlopeError(site.folder, f"must hold a finished run: `slope study {site.folder}` makes them")
    of = outcome.evaluate(found)
    failed = [Finding("failed", {"error": one.error}, (one.name,)) for one in todo if one.error]
    return Known(site, terrain, found, of, [*site_study.warnings_of(site.folder), *failed, *of.doubts()])
