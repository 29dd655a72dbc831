"""The quantities of a run that studies evaluate, by their columns in the tables: names, units, and format."""
from ..deposits import travel_shares

NAMES = {"remove_m3": ("to remove", "m3"), "remove_on_road_m3": ("on the road", "m3"),
         "remove_beside_road_m3": ("beside the road", "m3"), "beyond_road_m3": ("beyond the road", "m3"),
         "blocked_m": ("blocked length", "m"), "axis_thickness_m": ("thickness on the road's axis", "m"),
         "released_m3": ("released", "m3"),
         **{f"distance_{share}_m": (f"{share} % within", "m") for share in travel_shares.SHARES},
         **{f"reach_{share}_deg": (f"reach angle of {share} %", "degrees") for share in travel_shares.SHARES},
         "connected_m": ("connected deposit", "m"),
         "connected_deg": ("reach angle of the connected deposit", "degrees"),
         "front_m": ("farthest ball", "m"), "reach_angle_deg": ("reach angle of the farthest ball", "degrees"),
         "centroid_m": ("travel of the centroid", "m"), "thickness_m": ("largest thickness", "m")}


def number(value, sign=""):
    """Whole numbers from 100 on, else three digits."""
    return f"{value:{sign},.0f}" if abs(value) >= 100 else f"{value:{sign}.3g}"
