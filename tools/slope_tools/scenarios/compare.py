"""A site and its scenarios: what each releases, what its study says, and in what its choices and its model differ."""
import math
import os
from pathlib import Path
from shlex import quote
from typing import Any, Iterator, List, Mapping, NamedTuple, Optional, Sequence

from .. import disk
from ..case import decks, run_folders
from ..case.settings import normalise_value
from ..digits import metres
from ..errors import SlopeError
from ..sites import site_choices, site_deck, site_folder, site_scenarios
from ..sites.site_choices import FILES, Site
from ..sites.site_sections import sections
from ..studies import site_ground
from ..tables import named_run
from . import method

# of the model: what stiffness depends on, and what the ground is
STIFFNESS = {"speed": ("the stiffness is for a speed of", "m/s"), "thick": ("the stiffness is for a thickness of", "m"),
             "density": ("a ball has", "kg/m3")}
GROUND = {"friction": ("friction of", "degrees"), "slip": ("friction on the slip surface of", "degrees"),
          "spacing": ("spacing of the ground's balls", "diameters"), "field_e": ("restitution on the ground", "")}
SAME_SIZE = 1.2         # ratio of diameters: finer balls are half as large
BALLS = {"d": ("balls of", "m"), "cell": ("cells of", "m"), "duration": ("runs of at most", "s")}


class One(NamedTuple):
    """A site of those that are compared.

    variables: of its deck, none where the site could not be made; studied: None without a study of it as it is now.
    """
    name: str
    site: Site
    variables: Mapping[str, str]
    studied: Optional[method.Studied]


def read_scenarios(folder: Path) -> List[One]:
    """The site of a folder, then its scenarios."""
    name = site_choices.load_site(folder).choices.project.name or folder.absolute().name
    return [one(folder, name), *(one(place, place.name) for place in site_scenarios.list_scenarios(folder))]


def one(folder: Path, name: str) -> One:
    site = site_choices.load_site(folder)
    deck = folder / site_deck.NAME
    return One(name, site, decks.index_variables(deck) if deck.is_file() else {}, method.read_method(site))


def run_of(studied: method.Studied, names: Sequence[str]) -> Path:
    """Prefix of the output of the run that represents the number by the studies that count (method.common)."""
    study = studied.governs
    if names and study.name not in names:
        study = study.parent / names[0]
    inside = run_folders.summaries(named_run.governing_run(study)[1])
    if len(inside) != 1:
        raise SlopeError(study, "must hold the governing run of the study, with its summary")
    return run_folders.prefix_of(inside[0])


def different_sizes(several: Sequence[One]) -> str:
    """That the numbers are of balls of different sizes, in a sentence, and what mends it; "" if they are of one."""
    names = method.common([one.studied for one in several])
    finest = {one.name: max(about.size.sizes[-1].d if about.size else float(one.variables["d"])
                            for studies in one.studied.roads.values() for about in method.taken(studies, names))
              for one in several if one.studied and one.variables}
    least = min(finest.values(), default=0.0)
    coarser = [one for one in several if finest.get(one.name, 0.0) > SAME_SIZE * least]
    if not coarser:
        return ""
    again = ", ".join(f"slope study {quote(str(one.site.folder))} --levels "
                      f"{1 + round(math.log2(float(one.variables['d']) / least))}" for one in coarser)
    return ("These numbers are of balls of different sizes, which may change them as much as what is asked for: " +
            ", ".join(f"{name} {metres(d)}" for name, d in finest.items()) + f" ({again}).")


def choices_that_differ(mine: Site, other: Site) -> List[str]:
    """Those of a scenario, in words: keys of site.yaml and their values."""
    differing = []
    for name, about in sections():
        if name in ("project", "balls"):
            continue
        for key in about["properties"]:
            if (name, key) in site_choices.OF_MODEL:
                continue
            was, now = (resolve_choice(site, name, key) for site in (mine, other))
            if was == now:
                continue
            if now not in (None, (), [], {}):
                differing.append(f"{key.replace('_', ' ')} {format_choice(now)}")
            elif (name, key) in FILES:
                differing.append(f"without {name} {key}")
    return differing


def resolve_choice(site: Site, section: str, key: str) -> Any:
    """A choice, with files by their places."""
    if (section, key) in FILES:
        return [os.path.abspath(one) for one in site.choices.files(section, key)]
    return site.choices.value(section, key)


def format_choice(value: Any) -> str:
    if isinstance(value, (list, tuple)):
        return ", ".join(map(format_choice, value))
    if isinstance(value, float):
        return f"{value:.10g}"
    return Path(value).name if isinstance(value, str) and os.sep in value else str(value)


def differences(mine: One, other: One) -> Iterator[str]:
    """In what the models differ, beside what is asked for: balls, stiffness, ground; a part of a sentence each."""
    if not other.variables:
        return
    for which in (BALLS, STIFFNESS, GROUND):
        for name, (what, unit) in which.items():
            was, now = (each.variables.get(name) for each in (mine, other))
            if was is not None and now is not None and normalise_value(was) != normalise_value(now):
                yield f"{what} {now}{unit and f' {unit}'} instead of {was}"
    if (digests := [terrain(each.site.folder) for each in (mine, other)])[0] != digests[1]:
        yield "another terrain"
    zones = [{zone.name: zone.variables for zone in each.site.found.zones} for each in (mine, other)]
    if zones[0] != zones[1]:
        yield "other zones of the ground"
    angles = [site_ground.stop_angles(each.site) for each in (mine, other)]
    if angles[0] != angles[1]:
        yield f"stop angles {degrees(angles[1])} instead of {degrees(angles[0])} degrees"


def terrain(folder: Path) -> Optional[str]:
    path = folder / site_folder.TERRAIN
    return disk.sha256(path) if path.is_file() else None


def degrees(angles: Mapping[str, Mapping[str, float]]) -> str:
    found = [f"{value:.1f}" for by_rolling in angles.values() for value in by_rolling.values()]
    return ", ".join(found) or "unknown"
