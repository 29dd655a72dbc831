"""The numbers of a site and its scenarios by one method: of those of both studies that all of them have."""
from dataclasses import replace
from pathlib import Path
from shlex import quote
from typing import Dict, List, Mapping, NamedTuple, Optional, Sequence

from ..deposits import travel_shares
from ..ensembles import known_study
from ..sites import site_roads
from ..sites.site_choices import Site
from ..statistics.entries import Headline
from ..studies import outdated
from ..tables import headline, how_far, study_file, study_types
from ..tables.rows import Finished, finished_of

# folders of study_file.INSIDE, what they are of
WORDS = dict(zip(study_file.INSIDE, ("a sweep", "runs that are weighted by known events")))
Studies = Mapping[str, study_types.Study]       # by folder


class Studied(NamedTuple):
    """Of a site with a study of it as it is now; roads: {name of a road, "" of the only one: its studies}; governs:
    folder of the one whose number is that of the site."""
    roads: Mapping[str, Studies]
    governs: Path

    @property
    def names(self) -> List[str]:
        """Folders of the studies that every road has."""
        return [name for name in study_file.INSIDE if all(name in one for one in self.roads.values())]


def read_method(site: Site) -> Optional[Studied]:
    """None without a study of the site as it is now."""
    governs = study_file.study_in(site.folder)
    if governs is None or outdated.changed(site.folder, governs):
        return None
    roads = {name: studies_in(site_roads.results(replace(site, road=name))) for name in site_roads.names(site)}
    if not roads or not all(roads.values()):
        roads = {"": studies_in(site.folder)}
    return Studied(roads, governs)


def studies_in(folder: Path) -> Dict[str, study_types.Study]:
    """Those whose number is one: both, where one command made them, else the one that governs."""
    governs = study_file.study_in(folder)
    if governs is None:
        return {}
    about = study_file.load_study(governs / study_file.STUDY)
    names = study_file.INSIDE if about.study.method in known_study.OF_BOTH else (governs.name,)
    return {name: about if name == governs.name else study_file.load_study(folder / name / study_file.STUDY)
            for name in names if (folder / name / study_file.STUDY).is_file()}


def common(several: Sequence[Optional[Studied]]) -> List[str]:
    """Folders of the studies that all have that have any; none where each has another one."""
    there = [one.names for one in several if one]
    return [name for name in study_file.INSIDE if there and all(name in one for one in there)]


def taken(studies: Studies, names: Sequence[str]) -> List[study_types.Study]:
    """Those that count; names: of common()."""
    return [about for name, about in studies.items() if name in names or not names]


def difference(named: Mapping[str, Optional[Studied]], folders: Mapping[str, Path]) -> str:
    """That not all have the same studies, in sentences; "" if they have. folders: of the sites."""
    there = {name: one.names for name, one in named.items() if one}
    names = common(list(named.values()))
    if all(one == names for one in there.values()):
        return ""
    if not names:
        return "These numbers are not of one method, and do not compare: " + "; ".join(
            f"{name}: {WORDS[one[0]] if one else 'several'}" for name, one in there.items()) + "."
    lack = [name for name, one in there.items() if one == names]
    again = ", ".join(f"slope study {quote(str(folders[name]))}" for name in lack)
    other = next(WORDS[one] for one in study_file.INSIDE if one not in names)
    return (f"Compared is {WORDS[names[0]]}, which all have: {', '.join(lack)} without {other} ({again} makes both). "
            "With these the numbers of the others may be larger, as the first pages of their reports say.")


# --- numbers ---

def headline_of(studies: Studies, names: Sequence[str]) -> Optional[Headline]:
    """That of a road by some of its studies, as page 1 has it where these are all."""
    mine = taken(studies, names)
    if len(mine) == len(studies):
        return mine[0].headline if mine else None
    [about] = mine
    rows, road = finished_of(about.runs), about.headline.road if about.headline else None
    return headline.make_headline([replace(about, at_road=road and replace(
        road, longest_m=how_far.longest(rows), brought=how_far.count_brought(rows)))])


def list_finished_rows(studies: Studies, names: Sequence[str]) -> List[Finished]:
    """The runs that finished."""
    return [row for about in taken(studies, names) for row in finished_of(about.runs)]


def find_farthest_reach(studies: Studies, names: Sequence[str]) -> Optional[float]:
    """m, within which 99 % of the volume of all runs stay; None: it is not known of all."""
    found = [about.largest.get(travel_shares.DISTANCE) for about in taken(studies, names)]
    return max(one.value for one in found if one) if found and all(found) else None
