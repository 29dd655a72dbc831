"""Grids in text whose heads have the value before the key, as GeoClaw and D-Claw write them: what to do about it."""
from ..heads import number

KEYS = {"ncols": "ncols", "mx": "ncols", "nrows": "nrows", "my": "nrows", "xllcorner": "xllcorner",
        "yllcorner": "yllcorner", "xllcenter": "xllcenter", "yllcenter": "yllcenter", "xlower": "xllcenter",
        "ylower": "yllcenter", "cellsize": "cellsize", "dx": "dx", "dy": "dy", "nodata_value": "NODATA_value"}


def remedy(path: str) -> str:
    """Of a file that GDAL does not read, for a message; "" of any other."""
    try:
        with open(path, encoding="ascii") as lines:
            head = [line.split()[:2] for _, line in zip(range(6), lines)]
    except (OSError, UnicodeDecodeError):
        return ""
    turned = [f"{KEYS[words[1].lower()]} {words[0]}" for words in head
              if len(words) == 2 and words[1].lower() in KEYS and number(words[0]) == number(words[0])]
    return f"; its head has the values before the keys, as GeoClaw: write {', '.join(turned)}, a line each" * (
        len(turned) >= 4)
