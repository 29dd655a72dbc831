"""What all algorithms of SLOPE share: parameters from a table, the command line from it, the run, the results."""
from qgis.core import (QgsProcessingAlgorithm, QgsProcessingOutputFile, QgsProcessingOutputFolder,
                       QgsProcessingOutputNumber, QgsProcessingOutputRasterLayer, QgsProcessingOutputString,
                       QgsProcessingOutputVectorLayer)

from . import process
from .options import EXTRA, LOAD, Asked, split
from .results import Results

OUTPUTS = {"raster": QgsProcessingOutputRasterLayer, "vector": QgsProcessingOutputVectorLayer,
           "number": QgsProcessingOutputNumber, "file": QgsProcessingOutputFile, "folder": QgsProcessingOutputFolder,
           "text": QgsProcessingOutputString}


class Algorithm(QgsProcessingAlgorithm):
    """A command of tools/slope. A subclass has its name, its texts, its tables, and collects its results."""

    command = ""        # of tools/slope, and the algorithm's id
    title = ""
    about = ""          # short help with the units; a blank line between two paragraphs
    options = ()        # Options in the order of the dialogue
    outputs = ()        # (kind of OUTPUTS, key, label)

    def createInstance(self):
        return type(self)()

    def name(self):
        return self.command

    def displayName(self):
        return self.title

    def shortHelpString(self):
        return "\n".join(" ".join(paragraph.split()) for paragraph in self.about.split("\n\n"))

    def initAlgorithm(self, configuration=None):
        layers = any(kind in ("raster", "vector") for kind, _, _ in self.outputs)
        for option in (*self.options, EXTRA, *([LOAD] if layers else [])):
            self.addParameter(option.parameter())
        for kind, key, label in self.outputs:
            self.addOutput(OUTPUTS[kind](key, label))

    def processAlgorithm(self, parameters, context, feedback):
        asked = Asked(self, parameters, context, feedback)
        results = Results(asked, asked.switch(LOAD.key))
        self.work(asked, results)
        return results.values

    def work(self, asked, results):
        """Run the command and collect its results."""
        process.run([self.command, *self.words(asked)], asked.feedback)
        self.collect(asked, results)

    def words(self, asked):
        """The words of the command line behind the command."""
        words = [word for option in self.options if not option.own for word in option.words(asked)]
        return [*words, *self.extra(asked)]

    def extra(self, asked):
        """The words of the parameter for further options."""
        return split(EXTRA.key, asked.text(EXTRA.key))

    def collect(self, asked, results):
        """Put into the Results what the command wrote."""
        raise NotImplementedError
