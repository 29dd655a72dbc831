"""What the studies of the several roads of a site say: a number of each, the worst, and the table of all runs.

The worst is the one with the largest volume; a road whose number is no upper one, or none, counts as the largest of
its runs, if that is more. Of equal ones that is worse whose number may be larger, then the one that more known events
reach.
"""
from dataclasses import replace
from pathlib import Path
from typing import Any, Callable, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from rich.table import Table

from .. import digits, disk, records
from ..errors import SlopeError
from ..sites import site_roads
from ..sites.site_choices import Site
from ..statistics.entries import Kind
from ..tables import answer_words, study_types
from ..tables.quantities import OF_ROAD
from ..tables.rows import finished_of

PAGE = "report.html"    # in that of a road
PAGES = "report", "paper", "ensemble"
SUFFIXES = ".html", ".pdf", ".section.csv", ".numbers.csv", ".mp4"      # of what lies beside a page
KEYS = [one.key for one in OF_ROAD]
HEAD = ",".join(["run", "road", *KEYS])     # of roads.csv


class Made(NamedTuple):
    """Studies of one road: what their study.yaml say, the one that governs first, none of a dry run; what failed beside
    them; their page."""
    abouts: Sequence[study_types.Study]
    failed: Optional[Exception]
    page: str = PAGE


class Number(NamedTuple):
    """Of a road; kind: of its headline (tables.headline), None without one; volume_m3: of it; most_m3: of a run.

    reaching, runs: how many runs of both studies bring something onto it, and how many finished; reached: the share of
    known events that does, the larger probability, 0 where nobody knows; page: in its folder.
    """
    road: str
    kind: Optional[Kind]
    volume_m3: Optional[float]
    most_m3: float
    reaching: int
    runs: int
    reached: float = 0.0
    page: str = PAGE

    @property
    def counts_m3(self) -> float:
        if self.volume_m3 is None or self.kind is Kind.WITHHELD:
            return self.most_m3
        return max(self.volume_m3, self.most_m3) if self.kind in (Kind.FLOOR, Kind.OPEN) else self.volume_m3

    @property
    def order(self) -> Tuple[float, int, float]:
        """The worst has the largest."""
        may_be_more = 0 if self.kind is Kind.NOTHING else 1 if self.kind is Kind.NUMBER else 2
        return self.counts_m3, may_be_more, self.reached

    @property
    def text(self) -> str:
        """The number with its unit, as the first page of the road has it."""
        if self.volume_m3 is None and self.kind is not Kind.WITHHELD:
            return f"no number, up to {digits.three(self.most_m3)} m3 in a run"
        return answer_words.describe_volume(self.kind, self.volume_m3, "m3")


def evaluate_all_roads(site: Site, several: bool, tell: Callable[[Any], Any],
                       make: Callable[[Site, Sequence[Mapping[str, Any]], bool], Made]) -> Made:
    """The studies of a site by make(site with the road that is asked, entries of all roads, whether it is quiet).

    several: whether each of several roads is asked, then the worst as if it were alone; else the first one.
    """
    names = site_roads.names(site)
    if several:
        check_table(site.folder, bool(names))
        remove_former_pages(site.folder, names)
    if not names or not several:
        return make(replace(site, road=names[0]) if names else site, (), False)
    made = {name: make(replace(site, road=name), (), True) for name in names}
    if not all(one.abouts for one in made.values()):
        return next(one for one in made.values() if not one.abouts)
    found = in_order([choose_road_number(name, one) for name, one in made.items()])
    write_road_numbers(site.folder, {name: one.abouts for name, one in made.items()})
    worst = make(site_roads.worst(site, found[0].road), records.encode_record(found), False)
    tell(tabulate_road_numbers(found))
    tell(f"{site.folder / site_roads.TABLE}: each run, for each road; {site.folder / worst.page} is of the worst, "
         f"{found[0].road}")
    return worst._replace(failed=next((one.failed for one in (*made.values(), worst) if one.failed), None))


def choose_road_number(road: str, made: Made) -> Number:
    """Of a road, whose study that governs tells it; the largest of the runs of all its studies."""
    about, *_ = made.abouts
    said, rows = about.headline, finished_of(about.runs)
    on_road = [row.at_road.remove_on_road_m3 for row in rows]
    most = max((row.at_road.remove_m3 for each in made.abouts for row in finished_of(each.runs)), default=0.0)
    kind, volume, at = (said.kind, said.volume_m3, said.road) if said else (None, None, None)
    reaching, runs = (at.brought.reach, at.brought.runs) if at else (sum(one > 0 for one in on_road), len(rows))
    return Number(road, kind, volume, most, reaching, runs, max(at.reached if at else [0.0]), made.page)


def in_order(numbers: Sequence[Number]) -> List[Number]:
    """The worst first."""
    return sorted(numbers, key=lambda number: number.order, reverse=True)


def read_road_numbers(study: study_types.Study) -> List[Number]:
    """Those of a study; none of a site with one road."""
    return [records.read_record(Number, one) for one in study.roads]


def tabulate_road_numbers(numbers: Sequence[Number]) -> Table:
    """A table for the console."""
    found = Table(title="to remove from each road")
    for head in ("road", "to remove", "runs that reach it", "page"):
        found.add_column(head)
    for one in numbers:
        found.add_row(one.road, one.text, f"{one.reaching} of {one.runs}", f"{site_roads.FOLDER}/{one.road}/{one.page}")
    return found


def check_table(folder: Path, needed: bool) -> None:
    """Raise SlopeError if roads.csv is needed and a file of the user's has its name; one of ours that is not needed
    any more goes.
    """
    path = folder / site_roads.TABLE
    ours = path.is_file() and path.read_text(encoding="utf-8", errors="replace").startswith(HEAD)
    if needed and path.exists() and not ours:
        raise SlopeError(path, "must not exist, slope study makes a file of that name: rename or move it")
    if ours and not needed:
        path.unlink()


def remove_former_pages(folder: Path, names: Sequence[str]) -> None:
    """Remove the pages of roads that are no choice of the site any more; their studies stay, which nothing takes."""
    for place in (folder / site_roads.FOLDER).glob("*"):
        if place.name not in names and any((place / one / "study.yaml").is_file() for one in ("study", "ensemble")):
            for path in (place / f"{page}{suffix}" for page in PAGES for suffix in SUFFIXES):
                path.unlink(missing_ok=True)


def write_road_numbers(folder: Path, studies: Mapping[str, Sequence[study_types.Study]]) -> None:
    """roads.csv: a line for each road and finished run; studies: {road: what its study.yaml say}."""
    lines = []
    for road, several in studies.items():
        rows = {row.run: row for about in several for row in finished_of(about.runs)}
        lines += [[run, road, *(row.value(key) for key in KEYS)] for run, row in rows.items()]
    disk.write_file(folder / site_roads.TABLE, disk.csv_text(HEAD.split(","), lines))
