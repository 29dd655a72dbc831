"""The section of a report on the ground: which zones it has, where, with which values in the shown run."""
from ..sites import site_zones
from ..studies import site_ground
from .sections import Cell, Section, Table

CAPTION = ("What the ground is, where: zones as on the map of the site, and the ground outside of them. Values are "
           "those of the shown run; the stop angle is that of a sheet of three balls whose soil has them, too.")


def section(data, numbers):
    """None without zones, or where the values of the run are not known."""
    site = data.site
    zones, variables = (site.get("found") or {}).get("zones") or [], data.result.row.get("variables") or {}
    if not zones or not set(site_zones.VALUES.values()) <= set(variables):
        return None
    rest = {"name": "outside of all zones", "variables": "", "share": 1 - sum(zone["share"] for zone in zones)}
    rows = []
    for zone in (*zones, rest):
        now = site_zones.now(zone, site["model"], variables)
        degrees = site_ground.of_zone(zone, site["model"], variables)
        numbers.rows.append((f"ground: {zone['name']}: share of the terrain", "%", "", f"{100 * zone['share']:.3g}",
                             100 * zone["share"]))
        rows.append((zone["name"], f"{100 * zone['share']:.3g}", *(f"{value:.3g}" for value in now.values()),
                     "" if degrees is None else f"{degrees:.1f}"))
    heads = ["zone", Cell("share of the terrain", "%"), Cell("friction", "degrees"), "rolling resistance",
             "restitution", Cell("spacing", "diameters"), Cell("stop angle", "degrees")]
    return Section("ground", "The ground", [Table(CAPTION, heads, rows)])
