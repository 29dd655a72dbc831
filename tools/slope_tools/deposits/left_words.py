"""What is said of the balls that left the terrain: how much where, and how much terrain to add."""
from typing import Any, Dict, Mapping, Optional, Sequence

from ..digits import rounded
from .gone import DUMPS, HOLE
from .passed import AROUND, AWAY, CLOSE
from .road_sides import BEFORE, ON, PAST

MOST = 3                # entries that are named
BESIDE = {BEFORE: "{:,.0f} m before the road", ON: "on the road", PAST: "{:,.0f} m beyond the road",
          CLOSE: "{:,.0f} m beyond the road, where it is cut",
          AWAY: "{:,.0f} m from the road, which is behind it", AROUND: "{:,.0f} m beyond the road, past its end"}

Entry = Mapping[str, Any]       # of gone.groups()


def where(entries: Sequence[Entry]) -> str:
    """How much left where."""
    named = [f"{rounded(one['volume'], 3)} m3 {side(one)}{describe_side(one)}" for one in entries[:MOST]]
    rest = sum(one["volume"] for one in entries[MOST:])
    return "; ".join([*named, *([f"{rounded(rest, 3)} m3 elsewhere"] if rest > 0 else [])])


def side(entry: Entry) -> str:
    return "in a hole of the terrain" if entry["side"] == HOLE else f"in the {entry['side']}"


def describe_side(entry: Entry) -> str:
    """On which side of the road; "" without one."""
    return ", " + BESIDE[entry["where"]].format(entry["distance"]) if "where" in entry else ""


def to_add(entries: Sequence[Entry]) -> str:
    """How much terrain on which side, the most first; "" where none is missing."""
    most: Dict[str, Optional[float]] = {}
    for one in entries:
        if one["side"] == HOLE or one["add"] is None:
            most.setdefault(HOLE, None)
        else:
            most[one["side"]] = max(most.get(one["side"]) or 0.0, one["add"])
    sides = sorted(((name, add) for name, add in most.items() if add is not None), key=lambda pair: -pair[1])
    named = [f"about {add:,.0f} m in the {name}" for name, add in sides]
    return ", ".join([*named, *(["heights in the hole (slope terrain --fill)"] if HOLE in most else [])])


def sentence(left: Optional[Mapping[str, Any]]) -> str:
    """Of `left` of volume.yaml, a sentence without its full stop; "" where nothing left."""
    if left is None or not left["sides"]:
        return ""
    known = f" (from dumps, to {left['within']:,.0f} m)" if left["source"] == DUMPS else ""
    return f"{where(left['sides'])}{known}; for what left to come to rest on the terrain add {to_add(left['sides'])}"
