"""Several bodies of one site, those that slope stability found: values of the deck's variable body."""
from pathlib import Path
from typing import Any, Dict, NamedTuple, Set

import numpy as np

from .. import disk
from ..releases import release, release_deck, release_files
from ..slips.bodies import rank_of
from ..survey import rasters
from . import site_choices
from .site_sections import Choices, OfMass

VARIABLE = "body"


class Known(NamedTuple):
    """A body of a site."""
    deck: release_deck.Body
    base_sha256: str        # of the file that slope stability wrote
    mean_depth: float       # m


def slip_name(name: str, rank: object) -> str:
    """The ground without a body; name: first part of the names of the site's body."""
    return f"{name}.{rank}.slip.asc"


def list_body_files(choices: Choices, name: str) -> Set[str]:
    """Names of the files that write_site_bodies() makes."""
    slips = {slip_name(name, rank_of(Path(path))) for path in choices.files("release", "bodies")}
    return slips | {str(Path(one).with_suffix(".yaml")) for one in slips}


def write_site_bodies(choices: OfMass, folder: Path, name: str, wanted: release.Wanted, warn) -> Dict[int, Known]:
    """The ground without each of the bodies, in a folder; {rank: what is known of it}."""
    bodies = {}
    for path in choices.release.bodies:
        rank = rank_of(Path(path))
        body = release.body_of(wanted._replace(scar=path, scar_crs=site_choices.assigned(choices, path)))
        if path != wanted.scar:
            for line in body.warnings:
                warn(line._replace(part=f"body {rank}"))
        rasters.write_asc_local(folder / slip_name(name, rank),
                                body.raster._replace(z=release_files.ground_without(body.raster, body.area, body.slip)),
                                {"terrain": Path(wanted.terrain).name, "body": rank}, exact=True)
        deck = release_files.deck_body(folder / name, wanted.terrain, body.raster, body.area, body.slip)
        bodies[rank] = Known(deck, disk.sha256(Path(path)), body.measures.mean_depth)
    return bodies


def widen_body(body: release_deck.Body, name: str, several: Dict[int, Known]) -> release_deck.Body:
    """What the deck needs to know: of the site's body, with room for all others."""
    if not several:
        return body
    every = [body, *(one.deck for one in several.values())]
    low, high = np.min([one.box for one in every], axis=0), np.max([one.box for one in every], axis=0)
    return body._replace(slip=slip_name(name, f"${{{VARIABLE}}}"), lower=max(one.lower for one in every),
                         thick=max(one.thick for one in every),
                         box=(low[0], high[1], low[2], high[3], low[4], high[5]))


def summarise_site_bodies(several: Dict[int, Known]) -> Dict[int, Dict[str, Any]]:
    """What site.yaml says of them."""
    return {rank: {"volume_m3": one.deck.volume, "mean_depth_m": one.mean_depth, "base_sha256": one.base_sha256}
            for rank, one in several.items()}
