"""What a user may choose: one table entry is a parameter of Processing and the words of the command line."""
import json
import shlex
from dataclasses import dataclass
from pathlib import Path
from typing import Any, List, Sequence

from qgis.core import (QgsProcessing, QgsProcessingException, QgsProcessingParameterBoolean, QgsProcessingParameterCrs,
                       QgsProcessingParameterDefinition, QgsProcessingParameterEnum, QgsProcessingParameterExtent,
                       QgsProcessingParameterFeatureSource, QgsProcessingParameterFile,
                       QgsProcessingParameterFileDestination, QgsProcessingParameterFolderDestination,
                       QgsProcessingParameterMultipleLayers, QgsProcessingParameterNumber,
                       QgsProcessingParameterRasterLayer, QgsProcessingParameterString)

from . import layers

POLYGON, LINE = QgsProcessing.SourceType.TypeVectorPolygon, QgsProcessing.SourceType.TypeVectorLine
GEOMETRIES = {"polygons": (POLYGON,), "line": (LINE,), "road": (POLYGON, LINE)}


@dataclass(frozen=True)
class Option:
    """A parameter KEY of an algorithm and its option of the command line; flag "" is a positional argument.

    kind: number, whole, numbers (several, one flag), choice (of choices), switch, text, words (several, a flag before
    each), file, files (several, a flag before each), folder, polygons, line, road (one of these), raster, crs, extent,
    new folder, new file.
    own: its words are made by the algorithm. filter: of files.
    """
    key: str
    flag: str
    kind: str
    label: str
    default: Any = None
    needed: bool = False
    choices: Sequence[str] = ()
    least: float = 0.0
    filter: str = ""
    advanced: bool = False
    own: bool = False

    def parameter(self) -> QgsProcessingParameterDefinition:
        """What Processing shows of it."""
        found = self._parameter()
        if self.advanced:
            found.setFlags(found.flags() | QgsProcessingParameterDefinition.Flag.FlagAdvanced)
        return found

    def _parameter(self):
        names, optional = (self.key, self.label), not self.needed
        if self.kind in ("number", "whole"):
            kind = (QgsProcessingParameterNumber.Type.Double if self.kind == "number" else
                    QgsProcessingParameterNumber.Type.Integer)
            return QgsProcessingParameterNumber(*names, kind, self.default, optional, self.least)
        if self.kind == "choice":
            return QgsProcessingParameterEnum(*names, list(self.choices), False, self.default, optional, True)
        if self.kind == "switch":
            return QgsProcessingParameterBoolean(*names, bool(self.default), optional)
        if self.kind in ("text", "words", "numbers"):
            return QgsProcessingParameterString(*names, self.default, self.kind == "words", optional)
        if self.kind in GEOMETRIES:
            return QgsProcessingParameterFeatureSource(*names, list(GEOMETRIES[self.kind]), self.default, optional)
        if self.kind == "files":
            return QgsProcessingParameterMultipleLayers(*names, QgsProcessing.SourceType.TypeFile, self.default,
                                                        optional)
        if self.kind == "raster":
            return QgsProcessingParameterRasterLayer(*names, self.default, optional)
        if self.kind == "crs":
            return QgsProcessingParameterCrs(*names, self.default, optional)
        if self.kind == "extent":
            return QgsProcessingParameterExtent(*names, self.default, optional)
        if self.kind == "new folder":
            return QgsProcessingParameterFolderDestination(*names, self.default, optional)
        if self.kind == "new file":
            return QgsProcessingParameterFileDestination(*names, self.filter, self.default, optional)
        behaviour = (QgsProcessingParameterFile.Behavior.Folder if self.kind == "folder" else
                     QgsProcessingParameterFile.Behavior.File)
        return QgsProcessingParameterFile(*names, behaviour, defaultValue=self.default, optional=optional,
                                          fileFilter=self.filter)

    def given(self, asked) -> bool:
        """Whether there is a value, the user's or a default; asked: an Asked."""
        return asked.parameters.get(self.key) not in (None, "") or self.default is not None

    def words(self, asked) -> List[str]:
        """Its words of the command line, none if it was not given."""
        if self.kind == "switch":
            return [self.flag] if asked.algorithm.parameterAsBool(*asked.of(self.key)) else []
        if self.kind.startswith("new"):
            path = asked.output(self.key)
            return self._flagged(path) if path else []
        if not self.given(asked):
            return []
        if self.kind == "words":
            return [word for one in split(self.key, asked.text(self.key)) for word in (self.flag, one)]
        if self.kind == "numbers":
            return [self.flag, *split(self.key, asked.text(self.key))]
        if self.kind == "files":
            return [word for one in asked.algorithm.parameterAsFileList(*asked.of(self.key))
                    for word in self._flagged(one)]
        return self._flagged(self.value(asked))

    def _flagged(self, value) -> List[str]:
        return [*([self.flag] if self.flag else []), value]

    def value(self, asked) -> str:
        """Its value as a word."""
        if self.kind in ("number", "whole"):
            number = asked.algorithm.parameterAsDouble(*asked.of(self.key))
            return str(int(number)) if self.kind == "whole" else repr(number).removesuffix(".0")
        if self.kind == "choice":
            word = asked.algorithm.parameterAsEnumString(*asked.of(self.key))
            return self.choices[int(word)] if word.isdigit() and int(word) < len(self.choices) else word
        if self.kind in GEOMETRIES:
            return layers.vector_file(asked, self.key)
        if self.kind == "raster":
            return layers.raster_file(asked, self.key)
        if self.kind == "crs":
            crs = asked.algorithm.parameterAsCrs(*asked.of(self.key))
            return crs.authid() or crs.toWkt()
        return asked.text(self.key)


# {command: {name: option}}, what `slope COMMAND --describe` says; package.sh writes it, QGIS starts nothing to load it
COMMANDS = json.loads((Path(__file__).parent / "commands.json").read_text(encoding="utf-8"))
KINDS = {"count": "whole", "path": "file"}


def of(command: str, name: str, label: str, kind: str = "", **more) -> Option:
    """The Option of an option of a command; kind: where it is a layer, a folder or several; more: what is else here."""
    about = COMMANDS[command][name]
    kind = kind or KINDS.get(about["kind"], about["kind"])
    return Option(**{"key": name.upper(), "flag": about["option"], "kind": kind, "label": label,
                     "default": about["default"], "needed": about["needed"] and not kind.startswith("new"),
                     "choices": tuple(about["choices"]), "least": float(about["kind"] == "count"), **more})


def split(key: str, text: str) -> List[str]:
    """The words of a text; QgsProcessingException if a quotation mark is open."""
    try:
        return shlex.split(text)
    except ValueError as error:
        raise QgsProcessingException(f"{key}: must be words with blanks between ({error}), got {text}") from error


EXTRA = Option("EXTRA", "", "text", "Further options, as on the command line", advanced=True, own=True)
LOAD = Option("LOAD", "", "switch", "Open the layers in the project", True, own=True)


class Asked:
    """One call of an algorithm: its parameters, its context, its feedback."""

    def __init__(self, algorithm, parameters, context, feedback):
        self.algorithm, self.parameters, self.context, self.feedback = algorithm, parameters, context, feedback
        self.keep = None        # folder for copies of layers to which the results refer

    def of(self, key):
        """Arguments of parameterAs...()."""
        return self.parameters, key, self.context

    def text(self, key) -> str:
        return self.algorithm.parameterAsString(*self.of(key))

    def output(self, key) -> str:
        """The path of a new file or folder, a temporary one if the user left it to QGIS."""
        return self.algorithm.parameterAsFileOutput(*self.of(key))

    def switch(self, key) -> bool:
        return self.algorithm.parameterAsBool(*self.of(key))
