"""How layers look: one renderer per kind of quantity, with classes from the layer's own values."""
import math
from typing import List, Sequence, Tuple

from qgis.core import (QgsColorRampShader, QgsFillSymbol, QgsGraduatedSymbolRenderer, QgsHillshadeRenderer,
                       QgsLineSymbol, QgsPalLayerSettings, QgsProcessingException, QgsRasterDataProvider,
                       QgsRasterPipe, QgsRasterShader, QgsRendererRange, QgsSingleBandPseudoColorRenderer,
                       QgsSingleSymbolRenderer, QgsTextBufferSettings, QgsTextFormat, QgsVectorLayerSimpleLabeling)
from qgis.PyQt.QtGui import QColor

CLASSES = 7         # at most about so many
CLEAR = QColor(255, 255, 255, 0)

YELLOW_RED = ("#ffffb2", "#fed976", "#feb24c", "#fd8d3c", "#f03b20", "#bd0026", "#800026")
VIRIDIS = ("#fde725", "#90d743", "#35b779", "#21918c", "#31688e", "#443983", "#440154")
MAGMA = ("#fcfdbf", "#feb078", "#f1605d", "#b73779", "#721f81", "#2c115f", "#000004")
RED_BLUE = ("#d73027", "#fc8d59", "#fee090", "#ffffbf", "#e0f3f8", "#91bfdb", "#4575b4")
BLUES = ("#eff3ff", "#c6dbef", "#9ecae1", "#6baed6", "#4292c6", "#2171b5", "#084594")

# kind: colours from the smallest to the largest class, unit, scale, whether 0 is nothing and stays clear
RASTERS = {
    "thickness": (YELLOW_RED, "m", "thin to thick", True),
    "depth": (BLUES, "m", "even", True),
    "speed": (VIRIDIS[::-1], "m/s", "even", True),
    "energy": (MAGMA, "J", "powers", True),
    "arrival": (VIRIDIS, "s", "even", False),
    "removal": (YELLOW_RED, "m", "thin to thick", True),
    "exceedance": (YELLOW_RED, "of the runs", "shares", True),
    "factor": (RED_BLUE, "", "factors", False),
}
SERIES = {"thin to thick": (1, 2, 5), "powers": (1, 3)}     # upper bounds, times powers of ten
GROUND = "ground"               # as a shaded relief
STRETCHES = "stretches"         # of a road, lines
ZONES = "zones"                 # of the ground, polygons
MESH = "mesh cells"             # of `slope volume`, polygons
OF_MESH = "remove"              # their column, m3
# upper bounds that do not follow from the values
FIXED = {"shares": (0.05, 0.25, 0.5, 0.75, 1.0),
         "factors": (0.8, 0.9, 1.0, 1.1, 1.2, 1.3, 1.5, 2.0, 3.0, math.inf)}


def apply(layer, kind):
    """Give a layer the renderer of a kind: of RASTERS, GROUND, MESH, STRETCHES or ZONES."""
    if kind == ZONES:
        return layer.setRenderer(QgsSingleSymbolRenderer(QgsFillSymbol.createSimple(
            {"style": "no", "outline_color": "#7a4d1f", "outline_width": "0.4"})))
    if kind == STRETCHES:
        return layer.setRenderer(QgsSingleSymbolRenderer(QgsLineSymbol.createSimple(
            {"line_color": YELLOW_RED[-2], "line_width": "1.2"})))
    if kind == MESH:
        return mesh_cells(layer)
    if kind == GROUND:
        renderer = QgsHillshadeRenderer(layer.dataProvider(), 1, 315, 45)
        renderer.setMultiDirectional(True)
        # heights between the centres of the cells: without, a magnified relief shows the cells' edges
        layer.setResamplingStage(QgsRasterPipe.ResamplingStage.Provider)
        layer.dataProvider().enableProviderResampling(True)
        layer.dataProvider().setZoomedInResamplingMethod(QgsRasterDataProvider.ResamplingMethod.Bilinear)
    else:
        renderer = classes(layer, kind)
    layer.setRenderer(renderer)
    return None


def bounds_of(largest: float, scale: str, smallest: float = 0.0) -> List[float]:
    """Upper bounds of the classes, the last one at or above the largest value.

    even: round numbers at equal distances from the smallest value, or from 0; of SERIES: CLASSES numbers of the series
    up to the largest value, so that thin and thick, slow and fast can be distinguished on one map.
    """
    if scale in FIXED:
        return list(FIXED[scale])
    if not largest > 0:
        return [1.0]
    if scale in SERIES:
        steps, power = SERIES[scale], math.floor(math.log10(largest))
        numbers = [step * 10.0 ** p for p in range(power - CLASSES, power + 2) for step in steps]
        last = next(i for i, number in enumerate(numbers) if number >= largest * (1 - 1e-9))
        return numbers[last - CLASSES + 1:last + 1]
    step = round_up((largest - smallest) / CLASSES)
    first, last = math.floor(smallest / step + 1e-9), math.ceil(largest / step - 1e-9)
    return [step * i for i in range(first + 1, max(first + 1, last) + 1)]


def round_up(value: float) -> float:
    """The next 1, 2 or 5 times a power of ten."""
    if not value > 0:
        return 1.0
    power = 10.0 ** math.floor(math.log10(value))
    return next(step * power for step in (1, 2, 5, 10) if step * power >= value * (1 - 1e-9))


def shades(colours: Sequence[str], number: int) -> List[QColor]:
    """number colours, from the first to the last."""
    if number == 1:
        return [QColor(colours[-1])]
    places = [i * (len(colours) - 1) / (number - 1) for i in range(number)]
    return [between(QColor(colours[int(x)]), QColor(colours[min(int(x) + 1, len(colours) - 1)]), x - int(x))
            for x in places]


def between(one: QColor, other: QColor, share: float) -> QColor:
    mixed = [round(a + (b - a) * share) for a, b in zip(one.getRgb(), other.getRgb())]
    return QColor(*mixed)


def labels(bounds: Sequence[float], unit: str, smallest: float) -> List[str]:
    """What the legend says of each class."""
    below = [smallest, *bounds[:-1]]
    return [(f"above {low:g}" if high == math.inf else f"{low:g} to {high:g} {unit}").rstrip()
            for low, high in zip(below, bounds)]


def extremes(layer) -> Tuple[float, float]:
    """Smallest and largest value of a raster."""
    found = layer.dataProvider().bandStatistics(1)
    return found.minimumValue, found.maximumValue


def classes(layer, kind):
    """A renderer of one colour per class."""
    colours, unit, scale, zero_is_nothing = RASTERS[kind]
    smallest, largest = extremes(layer)
    bounds = bounds_of(largest, scale, 0.0 if zero_is_nothing else smallest)
    step = bounds[1] - bounds[0] if len(bounds) > 1 else bounds[0]
    start = 0.0 if zero_is_nothing or scale in FIXED else bounds[0] - step
    names = labels(bounds, unit, start)
    items = [QgsColorRampShader.ColorRampItem(0.0, CLEAR, "none")] if zero_is_nothing else []
    # the last class has no upper bound: a value that is rounded up is not left out
    items += [QgsColorRampShader.ColorRampItem(high, colour, name) for high, colour, name in
              zip([*bounds[:-1], math.inf], shades(colours, len(bounds)), names)]
    last = largest if bounds[-1] == math.inf else bounds[-1]
    ramp = QgsColorRampShader(start, last, None, QgsColorRampShader.Type.Discrete)
    ramp.setColorRampItemList(items)
    shader = QgsRasterShader()
    shader.setRasterShaderFunction(ramp)
    renderer = QgsSingleBandPseudoColorRenderer(layer.dataProvider(), 1, shader)
    renderer.setClassificationMin(start)
    renderer.setClassificationMax(last)
    renderer.setOpacity(0.8)
    return renderer


def mesh_cells(layer):
    """Squares by their volume to remove, with the number in them; clear where there is none."""
    index = layer.fields().indexOf(OF_MESH)
    if index < 0:
        raise QgsProcessingException(f"{layer.source()}: must have the column {OF_MESH}")
    bounds = bounds_of(float(layer.maximumValue(index) or 0), "even")
    below = [0.0, *bounds[:-1]]
    none = QgsFillSymbol.createSimple({"style": "no", "outline_color": "#808080", "outline_width": "0.1"})
    ranges = [QgsRendererRange(-1.0, 0.0, none, "none")]
    for low, high, colour, name in zip(below, bounds, shades(YELLOW_RED, len(bounds)), labels(bounds, "m3", 0.0)):
        symbol = QgsFillSymbol.createSimple({"color": colour.name(), "outline_color": "#404040",
                                             "outline_width": "0.1"})
        symbol.setOpacity(0.8)
        ranges.append(QgsRendererRange(low, high, symbol, name))
    layer.setRenderer(QgsGraduatedSymbolRenderer(OF_MESH, ranges))
    settings = QgsPalLayerSettings()
    settings.isExpression = True
    settings.fieldName = f'if("{OF_MESH}" > 0, round("{OF_MESH}", if("{OF_MESH}" < 10, 1, 0)), NULL)'
    look = QgsTextFormat()
    look.setSize(8)
    halo = QgsTextBufferSettings()
    halo.setEnabled(True)
    halo.setSize(0.6)
    look.setBuffer(halo)
    settings.setFormat(look)
    layer.setLabeling(QgsVectorLayerSimpleLabeling(settings))
    layer.setLabelsEnabled(True)
