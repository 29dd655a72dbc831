"""Files as they are downloaded: layers of a GIS and rasters in a .zip, which GDAL reads without unpacking."""
import gzip
import io
import lzma
import os
import re
import tarfile
import zipfile
import zlib
from contextlib import ExitStack, contextmanager, nullcontext
from pathlib import Path, PurePosixPath
from typing import Iterator, List, Optional, Sequence, TextIO, Tuple

from ..errors import SlopeError

LAYERS = (".shp", ".geojson", ".json", ".gpkg", ".kml", ".gml")
RASTERS = (".tif", ".tiff", ".asc", ".xyz", ".img", ".hgt", ".bil", ".flt", ".dem", ".dt0", ".dt1", ".dt2", ".grd",
           ".bt", ".jp2", "w001001.adf")
TEXTS = (".txt", ".csv")        # which may be points, or say something about the data
POINT = re.compile(rb"^[-+.\d]+([ \t;,]+[-+.\d]+){2,}", re.MULTILINE)
# other data of a survey, and what makes a raster of them
CLOUDS = (".las", ".laz", ".e57", ".pcd", ".pts", ".ptx", ".xyz", ".txt", ".csv")
MESHES = (".xml", ".ply", ".obj", ".stl", ".dxf", ".dwg", ".tin", ".gltf", ".glb", ".dae", ".3ds", ".off", ".2dm")
SHAPES = (".shp", ".geojson", ".json", ".gpkg", ".kml", ".kmz", ".gml", ".tab")
ARCHIVES = (".zip", ".gz", ".tgz", ".tar", ".7z", ".rar", ".bz2", ".xz", ".zst")
OF_POINTS = "points: make a raster of them with pdal (writers.gdal), gdal_grid -a linear, or TIN interpolation of QGIS"
OF_MESH = "a mesh or TIN: rasterize its heights with QGIS (Rasterize mesh dataset) or CloudCompare"
OF_LAYER = "points or contours: gdal_grid -a linear, or TIN interpolation of QGIS, makes a raster of them"
OF_ARCHIVE = "an archive: unpack it first"
SHOWN = 6           # names of members in a message
# what damaged archives, and those with a password, raise; ValueError: a member that begins before the file does
FAULTS = (zipfile.BadZipFile, tarfile.TarError, lzma.LZMAError, zlib.error, OSError, EOFError, RuntimeError, ValueError)


@contextmanager
def check_archive(name: str) -> Iterator[None]:
    """Raise SlopeError if an archive turns out to be damaged, or to have a password."""
    try:
        yield
    except FAULTS as error:
        raise SlopeError(name, f"must be a whole archive without a password ({error})") from error


def is_of_macos(member: str) -> bool:
    """Whether a member is what Finder adds beside each file."""
    place = PurePosixPath(member)
    return "__MACOSX" in place.parts or place.name.startswith("._")


def check_length(name: str, size: int, head: bytes) -> None:
    """Raise SlopeError if a .shp, .shx or .dbf has fewer bytes than its head (32 bytes) says: features are lost."""
    if PurePosixPath(name).suffix.lower() == ".dbf":
        records, first, each = (int.from_bytes(head[k:k + n], "little") for k, n in ((4, 4), (8, 2), (10, 2)))
        wanted = first + records * each
    else:
        wanted = 2 * int.from_bytes(head[24:28], "big")
    if size < wanted:
        raise SlopeError(name, f"must have the {wanted} bytes that its head says, it is cut short: copy all of the "
                         "shapefile again", size)


def some(names: Sequence[str]) -> str:
    return ", ".join(names[:SHOWN]) + ", ..." * (len(names) > SHOWN)


def layer_in(path: str, layer: Optional[str] = None) -> Optional[str]:
    """The member of a .zip that holds the layers, of several the one that has a layer's name.

    None if it is no .zip, or has no such member, and GDAL may know what it is. SlopeError if there are several.
    """
    if Path(path).suffix.lower() != ".zip" or not zipfile.is_zipfile(path):
        return None
    with check_archive(path), zipfile.ZipFile(path) as archive:
        names = archive.namelist()
        layers = [name for name in names if name.lower().endswith(LAYERS) and not is_of_macos(name)]
        if len(layers) > 1 and layer is not None:
            layers = [name for name in layers if PurePosixPath(name).stem == layer] or layers
        if len(layers) > 1:
            raise SlopeError(path, "must hold one layer, or one must be named (--layer, FILE|layername=NAME): "
                             + some([PurePosixPath(name).stem for name in layers]),
                             f"{len(layers)} files of layers")
        require_open(archive, layers)
        if layers and layers[0].lower().endswith(".shp"):
            index = layers[0].lower()[:-4] + ".shx"
            if index not in map(str.lower, names):
                raise SlopeError(path, f"must have all files of the shapefile, {PurePosixPath(index).name} is missing")
            for name in names:
                if name.lower()[:-4] == index[:-4] and name.lower().endswith((".shp", ".shx", ".dbf")):
                    with archive.open(name) as member:
                        check_length(f"{path}/{name}", archive.getinfo(name).file_size, member.read(32))
        return layers[0] if layers else None


def require_open(archive: zipfile.ZipFile, names: Sequence[str]) -> None:
    """Raise one of FAULTS if a member has a password, of which GDAL does not know."""
    for name in names:
        archive.open(name).close()


# --- rasters ---

def suggest_zip_remedy(name: str) -> str:
    """What can be done about a file of this name that is no raster, after a semicolon; nothing of others."""
    ending = Path(name).suffix.lower()
    for endings, way in ((CLOUDS, OF_POINTS), (MESHES, OF_MESH), (SHAPES, OF_LAYER), (ARCHIVES, OF_ARCHIVE)):
        if ending in endings:
            return f"; {way}"
    return ""


def rasters_in(path: str, alone: bool = False) -> List[str]:
    """The rasters in a .zip, each as ZIP/MEMBER; none of other files, or, alone, of one that holds a layer, too."""
    if not zipfile.is_zipfile(path):
        return []
    with check_archive(path), zipfile.ZipFile(path) as archive:
        names = [name for name in archive.namelist() if not is_of_macos(name)]
        if alone and any(name.lower().endswith(LAYERS) for name in names):
            return []
        found = [name for name in names if name.lower().endswith(RASTERS)]
        require_open(archive, found)
        texts = [name for name in names if name.lower().endswith(TEXTS)]
        found = found or [name for name in texts if POINT.search(archive.open(name).read(2000))]
        return [f"{path}/{name}" for name in found]


def split(name: str) -> Tuple[str, str]:
    """ZIP and MEMBER of a name ZIP/MEMBER; the member is empty of any other name."""
    for slash in re.finditer("/+", name):
        if os.path.isfile(name[:slash.start()]):
            return name[:slash.start()], name[slash.end():]
    return name, ""


def gdal_name(name: str) -> str:
    """What GDAL calls a file, one in a .zip, or one that is packed by gzip."""
    path, member = split(name)
    if member:
        return f"/vsizip/{{{os.path.abspath(path)}}}/{member}"
    return f"/vsigzip/{os.path.abspath(path)}" if path.lower().endswith(".gz") else path


@contextmanager
def open_text(name: str) -> Iterator[TextIO]:
    """A file, one in a .zip, or one that is packed by gzip, as text; what is no UTF-8 becomes U+FFFD."""
    path, member = split(name)
    packed = path.lower().endswith(".gz")
    with check_archive(name) if member or packed else nullcontext(), ExitStack() as opened:
        if member:
            data = opened.enter_context(opened.enter_context(zipfile.ZipFile(path)).open(member))
        else:
            data = opened.enter_context(gzip.open(path) if packed else open(path, "rb"))    # type: ignore[arg-type]
        yield io.TextIOWrapper(data, encoding="utf-8-sig", errors="replace")
