"""Datums of Japan, and the zones of its plane rectangular system."""
import math

from rasterio.crs import CRS

from ..errors import SlopeError

# srsName: what to call the datum, the EPSG number of its degrees and of zone I of its plane rectangular system.
# JGD2024 has new heights; its plan coordinates are those of JGD2011, and PROJ has no number for it yet.
DATUMS = {"fguuid:jgd2000.bl": ("JGD2000", 4612, 2443),
          "fguuid:jgd2011.bl": ("JGD2011", 6668, 6669),
          "fguuid:jgd2024.bl": ("JGD2024", 6668, 6669)}

# Places (latitude, longitude) in the zones of the plane rectangular system, which go by prefectures: seats of
# prefectures, towns near their borders, islands. The zone of a site is that of the nearest place.
ZONES = {
    1: [(32.74, 129.87), (33.17, 129.72), (34.20, 129.29), (32.70, 128.84), (31.83, 129.86), (29.85, 129.86),
        (28.38, 129.49), (27.37, 128.60), (27.04, 128.43)],
    2: [(33.61, 130.42), (33.88, 130.88), (33.25, 130.30), (32.79, 130.74), (33.24, 131.61), (31.91, 131.42),
        (31.56, 130.56), (30.34, 130.51), (32.21, 130.41), (32.58, 131.67)],
    3: [(34.19, 131.47), (33.96, 130.94), (34.05, 131.81), (35.47, 133.05), (34.90, 132.08), (34.40, 132.46),
        (34.49, 133.36), (34.81, 132.85), (36.20, 133.32)],
    4: [(34.34, 134.04), (33.84, 132.77), (33.22, 132.56), (34.07, 134.56), (33.56, 133.53), (32.94, 132.73)],
    5: [(34.69, 135.18), (35.54, 134.82), (35.50, 134.24), (35.43, 133.33), (34.66, 133.93), (34.99, 133.46),
        (34.82, 134.69)],
    6: [(35.02, 135.76), (35.47, 135.39), (34.69, 135.52), (36.07, 136.22), (35.65, 136.06), (35.00, 135.87),
        (35.38, 136.27), (34.73, 136.51), (34.07, 136.19), (34.69, 135.83), (34.23, 135.17), (33.72, 135.99)],
    7: [(36.59, 136.63), (37.39, 136.90), (36.70, 137.21), (35.39, 136.72), (36.15, 137.25), (35.18, 136.91),
        (34.77, 137.39), (35.49, 137.50)],
    8: [(37.90, 139.02), (37.15, 138.24), (38.22, 139.48), (38.02, 138.37), (37.13, 138.76), (36.65, 138.18),
        (36.24, 137.97), (35.51, 137.82), (36.25, 138.48), (35.66, 138.57), (34.98, 138.38), (34.71, 137.73),
        (35.10, 138.86)],
    9: [(35.69, 139.69), (37.75, 140.47), (37.05, 140.89), (37.49, 139.93), (37.35, 139.32), (36.57, 139.88),
        (36.34, 140.45), (35.86, 139.65), (35.99, 139.09), (35.61, 140.12), (36.39, 139.06), (36.65, 138.95),
        (35.45, 139.64), (35.26, 139.15), (34.75, 139.36), (33.11, 139.79)],
    10: [(40.82, 140.74), (39.72, 140.10), (38.24, 140.36), (37.92, 140.11), (38.73, 139.83), (39.70, 141.15),
         (38.27, 140.87), (38.00, 140.62), (40.51, 141.49)],
    11: [(43.19, 140.99), (41.77, 140.73), (42.47, 140.86), (41.87, 140.13), (42.90, 140.76)],
    12: [(43.06, 141.35), (43.77, 142.36), (45.42, 141.67), (42.32, 140.97), (42.63, 141.61), (42.17, 142.78),
         (44.36, 143.35), (43.94, 141.64), (43.34, 142.38)],
    13: [(42.98, 144.38), (42.92, 143.20), (43.80, 143.89), (44.02, 144.27), (43.33, 145.58), (42.29, 143.31)],
    14: [(27.09, 142.19), (24.78, 141.32)],
    15: [(26.21, 127.68), (26.59, 127.98), (26.34, 126.80)],
    16: [(24.34, 124.16), (24.81, 125.28), (24.47, 123.00)],
    17: [(25.95, 131.30)],
    18: [(20.42, 136.08)],
    19: [(24.29, 153.98)],
}
FARTHEST = 3.0     # degrees from the nearest place; beyond, a site is not in Japan


def zone(raster, datum):
    """Zone (1 to 19) of the plane rectangular system of the middle of a raster in degrees, and its CRS."""
    rows, columns = raster.z.shape
    lon, lat = raster.transform @ (columns / 2, rows / 2)
    distance, number = min((math.hypot(lat - y, (lon - x) * math.cos(math.radians(lat))), number)
                           for number, places in ZONES.items() for y, x in places)
    if distance > FARTHEST:
        raise SlopeError("--crs", "must be given: no zone of Japan's plane rectangular system is near the site",
                         f"latitude {lat:.4f}, longitude {lon:.4f}")
    first = next(first for name, _, first in DATUMS.values() if name == datum)
    return number, CRS.from_epsg(first + number - 1)


def nominal_cell(metres):
    """1, 2, 5 or 10 (times a power of ten), whichever is nearest in ratio: what a DEM5 is called, 5 m."""
    decade = 10 ** math.floor(math.log10(metres))
    return min((decade * step for step in (1, 2, 5, 10)), key=lambda size: abs(math.log(size / metres)))
