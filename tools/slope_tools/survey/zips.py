"""Layers of a GIS in a .zip, as they are downloaded: GDAL reads them without unpacking."""
import zipfile
from pathlib import Path, PurePosixPath
from typing import Optional

from ..errors import SlopeError

LAYERS = (".shp", ".geojson", ".json", ".gpkg", ".kml", ".gml")
SHOWN = 6           # names of members in a message


def is_of_macos(member: str) -> bool:
    """Whether a member is what Finder adds beside each file."""
    place = PurePosixPath(member)
    return "__MACOSX" in place.parts or place.name.startswith("._")


def layer_in(path: str, layer: Optional[str] = None) -> Optional[str]:
    """The member of a .zip that holds the layers, of several the one that has a layer's name.

    None if it is no .zip, or has no such member, and GDAL may know what it is. SlopeError if there are several.
    """
    if Path(path).suffix.lower() != ".zip" or not zipfile.is_zipfile(path):
        return None
    try:
        with zipfile.ZipFile(path) as archive:
            names = archive.namelist()
    except (zipfile.BadZipFile, OSError, ValueError, NotImplementedError) as error:
        raise SlopeError(path, f"must be a whole zip file ({error})") from error
    found = [name for name in names if PurePosixPath(name).suffix.lower() in LAYERS and not is_of_macos(name)]
    if len(found) > 1 and layer is not None:
        found = [name for name in found if PurePosixPath(name).stem == layer] or found
    if len(found) > 1:
        shown = ", ".join(PurePosixPath(name).stem for name in found[:SHOWN]) + ", ..." * (len(found) > SHOWN)
        raise SlopeError(path, f"must hold one layer, or one must be named (--layer, FILE|layername=NAME): {shown}",
                         f"{len(found)} files of layers")
    if found and found[0].lower().endswith(".shp"):
        beside = {name.lower() for name in names}
        index = found[0].lower()[:-4] + ".shx"
        if index not in beside:
            raise SlopeError(path, f"must have all files of the shapefile, {PurePosixPath(index).name} is missing")
    return found[0] if found else None
