"""Where the energy of a run went: the last line of what fix ave/time writes of fix energy/ledger."""
import re
from pathlib import Path
from typing import Any, Dict, List, Optional, Sequence

import numpy as np

from ..digits import format_measured_share, si
from ..errors import SlopeError

SUFFIX = "energy"       # of the file, after the run's prefix
# columns after the step, J; one line each second (doc/src/fix_energy_ledger.rst)
ITEMS = ("kinetic", "gravity", "other_forces", "stored", "normal_dashpots", "sliding", "rolling", "begin_end",
         "residual", "ground_motion", "left")
TAKEN = {"sliding": "sliding", "rolling": "rolling resistance", "normal_dashpots": "impacts (normal dashpots)",
         "begin_end": "the finite step at the start and end of contacts"}


def read_energies(path: Path) -> Optional[Dict[str, Any]]:
    """Energies in J at the last full second of a run, with a sentence; None where the run was continued.

    A ledger is not in restart files, so that of a continued run lacks what came before. Raises SlopeError if the file
    cannot be read.
    """
    try:
        table = np.loadtxt(path, ndmin=2)
        joules = dict(zip(items_of(path, table.shape[1] - 1), table[-1, 1:].tolist(), strict=True))
        if not np.isfinite(table).all():
            raise ValueError("a number that is not finite")
    except (OSError, IndexError, ValueError) as error:
        raise SlopeError(path, f"must be what the run wrote of its energy ({error})") from error
    if table[0, 0] != 0:
        return None
    return {**joules, "text": describe_energy(joules)}


def items_of(path: Path, count: int) -> Sequence[str]:
    """ITEMS in the order of the columns that the head of fix ave/time names, TimeStep f_ID[1] ...; or ValueError."""
    with open(path, encoding="utf-8", errors="replace") as lines:
        heads = [line[1:].split()[1:] for line in lines if line.startswith("#") and "TimeStep" in line]
    head: List[str] = heads[0] if heads else []
    found = [re.fullmatch(r"f_(\w+)\[(\d+)\]", name) for name in head]
    places = [int(one[2]) if one else 0 for one in found]
    if not all(found) or len({one[1] for one in found if one}) > 1 or len(set(places)) < len(places) or (
            places and not 1 <= min(places) <= max(places) <= len(ITEMS)):
        raise ValueError(f"columns {' '.join(head)[:60]!r} instead of those of fix energy/ledger")
    if len(places) == count == len(ITEMS):
        return [ITEMS[place - 1] for place in places]
    if places != list(range(1, len(places) + 1)):
        raise ValueError(f"{count} columns under {len(places)} names")
    return ITEMS


def describe_energy(joules: Dict[str, float]) -> str:
    taken = sum(joules[name] for name in TAKEN)
    if not taken > 0:
        return "nothing has moved"
    gained = joules["gravity"] + joules["ground_motion"]
    shares = ", ".join(f"{format_measured_share(joules[name] / taken)} by {what}" for name, what in TAKEN.items())
    left = f"; {si(joules['left'], 'J')} left with balls" if joules["left"] > 0 else ""
    return (f"of {si(gained, 'J')} that weight and ground motion put in, {si(taken, 'J')} was taken: {shares}{left}; "
            f"not accounted for: {format_measured_share(abs(joules['residual']) / taken)}")
