"""The quantities of a run that studies evaluate, by their columns in the tables: names, units, and format."""
from typing import Any, Dict, Iterable, Mapping

from ..deposits import travel_shares
from ..mobility.run_length import ON_PATH, STRAIGHT

NAMES = {"remove_m3": ("to remove", "m3"), "remove_on_road_m3": ("on the road", "m3"),
         "remove_beside_road_m3": ("beside the road", "m3"), "beyond_road_m3": ("beyond the road", "m3"),
         "blocked_m": ("blocked length", "m"), "axis_thickness_m": ("thickness on the road's axis", "m"),
         "remove_lane_m3": ("to remove for a lane", "m3"), "lane_hours": ("until a lane is open", "hours"),
         "clear_hours": ("until the road is clear", "hours"),
         "released_m3": ("released", "m3"),
         **{f"distance_{share}_m": (f"{share} % within", "m") for share in travel_shares.SHARES},
         **{f"reach_{share}_deg": (f"reach angle of {share} %", "degrees") for share in travel_shares.SHARES},
         "length_m": ("length along the fall path", "m"),
         "length_deg": ("reach angle of that length", "degrees"),
         "front_m": ("farthest ball", "m"), "reach_angle_deg": ("reach angle of the farthest ball", "degrees"),
         "centroid_m": ("travel of the centroid", "m"), "thickness_m": ("largest thickness", "m")}


def name_of(key: str, rows: Iterable[Mapping[str, Any]]) -> str:
    """What a quantity of some runs is called: a length is straight where a run has no fall path."""
    if key != "length_m":
        return NAMES[key][0]
    kinds = {row["length_is"] for row in rows if row.get("length_is")}      # none in older files
    return "straight length" if kinds == {STRAIGHT} else \
        "length (straight in some runs)" if STRAIGHT in kinds else NAMES[key][0]


def of_run(summary, length) -> Dict[str, Any]:
    """Of a summary (run_folders.load_summary) and its run_length.RunLength, None where there is no deposit."""
    travel = summary["travel"]
    return {"released_m3": summary["volume"]["released"], "front_m": travel["front"],
            "reach_angle_deg": travel["reach_angle"], "centroid_m": travel["centroid"],
            **travel_shares.columns(summary), "length_m": length and length.distance,
            "length_is": length and (ON_PATH if length.on_path else STRAIGHT),
            "length_by_lobe_m": length and list(length.others),
            "length_deg": length and length.angle, "thickness_m": summary["largest"]["thickness"]}


def number(value, sign=""):
    """Whole numbers from 100 on, else three digits."""
    return f"{value:{sign},.0f}" if abs(value) >= 100 else f"{value:{sign}.3g}"
