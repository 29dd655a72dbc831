"""The study of a site of blocks: its runs, their outcome, files and page."""
from typing import Any, List, NamedTuple, Optional, Sequence

from ..case import decks
from ..errors import SlopeError
from ..findings import Finding
from ..runs import repeats
from ..sites import site_deck
from ..sites.site_choices import Folder
from ..sites.site_roads import ROAD
from ..sites.site_sections import OfBlocks
from ..studies import site_study, study
from ..studies.setup import RUNS, Setup
from . import edges, files, outcome, page, runs


class Known(NamedTuple):
    """A site and what its finished runs say."""
    site: Folder[OfBlocks]
    terrain: runs.Terrain
    runs: Sequence[runs.Run]
    outcome: outcome.Outcome
    doubts: Sequence[Finding]


def settings_of(site: Folder[OfBlocks]):
    """{variable of the deck: its values}."""
    return {"rolling": site_study.format_deck_values(site.choices.study.rolling),
            "ground": [str(k) for k in range(1, site.choices.blocks.grounds + 1)]}


def plan_block_runs(site: Folder[OfBlocks]) -> List[repeats.Repeat]:
    return repeats.plan_repeats(site.folder / RUNS, settings_of(site), {},
                                decks.index_variables(site.folder / site_deck.NAME))


def run_block_study(site: Folder[OfBlocks], engine: Setup) -> None:
    """Make or continue all runs and show the outcome; raises SlopeError on bad input, and last if a run failed."""
    setup = engine._replace(deck=site.folder / site_deck.NAME, output=site.folder / site_study.STUDY, site=site.folder,
                            road=None)
    planned = plan_block_runs(site)

    def collect(todo, _) -> None:
        if all(one.error for one in todo):
            raise study.failure(setup.output, todo) or SlopeError(setup.output, "must have a run")
        known = read_block_runs(site, todo)
        files.write_block_files(setup.output, known)
        for line in page.sentences(known):
            setup.tell(line)
        for one in known.outcome.doubts():
            setup.warn(one)
        setup.tell(page.write_block_page(known, site.folder / page.NAME))
    with study.alone(site.folder, setup.dry_run):
        study.perform(follow_road(site, planned, setup), settings_of(site), planned, collect)


def follow_road(site: Folder[OfBlocks], planned: Sequence[repeats.Repeat], setup: Setup) -> Setup:
    """With the edges of road.csv as it is now, at which all runs are made again if they counted at others."""
    found = runs.terrain_of(site).edges
    if not edges.has_edges(site.folder, found):
        edges.check_number(site.folder, found, site.folder / ROAD, site.choices.road.file)
        if not setup.dry_run:
            edges.write_edges(site.folder, found)
    others = sum(not edges.has_edges(one.folder, found) for one in planned if one.finished)
    if others:
        setup.tell(f"{ROAD} is not that of {others} finished runs: they are made again")
    return setup._replace(anew=setup.anew or others > 0)


def read_block_runs(site: Folder[OfBlocks], todo: Optional[Sequence[Any]] = None) -> Known:
    """What those of these runs, or of all, say that finished; SlopeError if none did."""
    todo, terrain = todo or plan_block_runs(site), runs.terrain_of(site)
    if not all(edges.has_edges(one.folder, terrain.edges) for one in todo if one.finished):
        raise SlopeError(site.folder / ROAD, "must be the road at which the runs counted: `slope study "
                         f"{site.folder}` makes them again")
    found = [runs.read_block_run(one.name, one.folder, one.chosen, terrain) for one in todo if one.finished]
    if not found:
        raise SlopeError(site.folder, f"must hold a finished run: `slope study {site.folder}` makes them")
    of = outcome.evaluate_blocks(found)
    failed = [Finding("failed", {"error": one.error}, (one.name,)) for one in todo if one.error]
    return Known(site, terrain, found, of, [*site_study.read_site_warnings(site.folder), *failed, *of.doubts()])
