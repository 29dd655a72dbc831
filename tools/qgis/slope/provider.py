"""The plugin and its Processing provider, with the two settings of Settings > Options > Processing > Providers."""
from processing.core.ProcessingConfig import ProcessingConfig, Setting
from qgis.core import QgsApplication, QgsProcessingProvider

from . import process
from .calibrate import Calibrate
from .export import Export
from .fragility import Fragility
from .mobility import Mobility
from .quake import Quake
from .release import Release
from .report import Report
from .score import Score
from .site import Site
from .stability import Stability
from .study import Study
from .terrain import Terrain
from .volume import Volume

ALGORITHMS = (Terrain, Release, Site, Study, Report, Volume, Export, Mobility, Score, Calibrate, Quake, Stability,
              Fragility)


class Provider(QgsProcessingProvider):
    """The algorithms of SLOPE."""

    def id(self):
        return "slope"

    def name(self):
        return "SLOPE"

    def longName(self):
        return "SLOPE: slope collapses in LAMMPS"

    def load(self):
        for name, text in ((process.PROGRAM, "Program tools/slope (empty: beside the plugin, else on the PATH)"),
                           (process.LAMMPS, "LAMMPS program with SLOPE (empty: the one that belongs to the tools)")):
            ProcessingConfig.addSetting(Setting(self.name(), name, text, "", valuetype=Setting.FILE))
        ProcessingConfig.readSettings()
        self.refreshAlgorithms()
        return True

    def unload(self):
        for name in (process.PROGRAM, process.LAMMPS):
            ProcessingConfig.removeSetting(name)

    def loadAlgorithms(self):
        for algorithm in ALGORITHMS:
            self.addAlgorithm(algorithm())


class Plugin:
    """What QGIS loads and unloads."""

    def __init__(self):
        self.provider = None

    def initProcessing(self):
        """Called by qgis_process, and by initGui()."""
        self.provider = Provider()
        QgsApplication.processingRegistry().addProvider(self.provider)

    def initGui(self):
        self.initProcessing()

    def unload(self):
        QgsApplication.processingRegistry().removeProvider(self.provider)
