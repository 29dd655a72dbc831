"""The rasters of a run as styled layers in the survey's coordinates: slope export."""
from pathlib import Path

from qgis.core import QgsProcessingException

from .algorithm import Algorithm
from .options import Option, of
from .results import load

STYLES = {"base": "ground", "surface": "ground", "thickness": "thickness", "max_thickness": "thickness",
          "max_speed": "speed", "max_energy": "energy", "arrival": "arrival", "last_motion": "arrival"}
NAMES = {"base": "ground without the body", "surface": "ground and deposit", "thickness": "thickness (m)",
         "max_thickness": "largest thickness (m)", "max_speed": "largest speed (m/s)",
         "max_energy": "largest energy of a ball (J)", "arrival": "arrival (s)", "last_motion": "last motion (s)"}
RUN = Option("RUN", "", "file", "Result of a run: any of PREFIX.thickness.asc, PREFIX.summary.yaml ...", needed=True,
             own=True, filter="Results of a run (*.asc *.summary.yaml)")
TERRAIN = of("export", "terrain", "Terrain of the run, if it is not terrain.asc beside it", filter="Terrain (*.asc)",
             advanced=True)


def prefix_of(asked):
    """PREFIX of the run of which the user named a file."""
    path = Path(asked.text(RUN.key))
    for end in (".summary.yaml", *(f".{kind}.asc" for kind in STYLES)):
        if path.name.endswith(end) and len(path.name) > len(end):
            return str(path)[:-len(end)]
    if Path(f"{path}.summary.yaml").is_file():
        return str(path)
    raise QgsProcessingException(f"{RUN.key}: must be a file that a run wrote, such as PREFIX.thickness.asc, got "
                                 f"{path}")


class Export(Algorithm):
    """slope export"""

    command = "export"
    title = "Rasters of a run as layers"
    about = """
    Every raster of a run as a GeoTIFF in the survey's coordinates, with a style.

    Ground without the body and ground with the deposit (m, shaded relief); thickness and largest thickness of
    the deposit (m); largest speed of a ball (m/s); largest kinetic energy of a ball (J, classes of 1 and 3); arrival
    of the first ball and last motion (s).

    CRS and origin come from the sidecar of the run's terrain. Without a CRS the layers are in the local metres
    of the run.

    Beside each GeoTIFF lies its style (.qml)."""
    options = (RUN, TERRAIN, of("export", "output", "Folder for the GeoTIFFs", kind="new folder"))
    outputs = tuple(("raster", kind.upper(), name[0].upper() + name[1:]) for kind, name in NAMES.items())

    def words(self, asked):
        return [prefix_of(asked), *super().words(asked)]

    def collect(self, asked, results):
        folder = Path(asked.output("OUTPUT"))
        for one in load(folder / "export.yaml")["rasters"]:
            kind = one["file"].split(".")[-2]
            step = f", step {one['step']}" if "step" in one else ""
            results.layer(None if step else kind.upper(), folder / one["file"], STYLES[kind], NAMES[kind] + step)
        results.put(OUTPUT=str(folder))
