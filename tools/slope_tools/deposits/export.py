"""The rasters of a run as GeoTIFFs in the survey's coordinates."""
import re
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ..case.run_folders import RASTERS
from ..errors import SlopeError
from ..survey import rasters

NAME = re.compile(r"(?:(\d+)\.)?(%s)\.asc" % "|".join(RASTERS))    # after PREFIX and a point


class Layer(NamedTuple):
    """A raster of a run."""
    path: Path
    kind: str           # key of RASTERS
    step: int           # of a numbered copy (series yes of the fix), -1: none


def layers(prefix):
    """The rasters of a prefix, in the order of RASTERS, numbered copies last."""
    prefix = Path(prefix)
    found = []
    for path in prefix.parent.glob("*.asc"):
        match = NAME.fullmatch(path.name[len(prefix.name) + 1:]) if path.name.startswith(f"{prefix.name}.") else None
        if match:
            found.append(Layer(path, match[2], -1 if match[1] is None else int(match[1])))
    return sorted(found, key=lambda layer: (layer.step, list(RASTERS).index(layer.kind)))


def file_of(layer):
    """The name of its GeoTIFF."""
    return f"{layer.path.stem}.tif"


def write_layer(folder, layer, place, tags):
    """Write a layer as a GeoTIFF on the grid of place (a Raster with CRS and offset); what export.yaml tells of it.

    tags: {name: text} of its metadata.
    """
    raster = rasters.read_raster(layer.path, heights=False)
    if raster.z.shape != place.z.shape or raster.transform != place.transform:
        raise SlopeError(layer.path, "must have the grid of the run's thickness: is it of another run?")
    quantity, unit = RASTERS[layer.kind]
    rasters.write_geotiff(folder / file_of(layer), {f"{quantity} ({unit})": raster.z}, place, tags)
    there = raster.z[np.isfinite(raster.z)]
    about = {"file": file_of(layer), "quantity": quantity, "unit": unit}
    if layer.step >= 0:
        about["step"] = layer.step
    return {**about, "nodata_cells": int(raster.z.size - there.size), "min": there.min() if there.size else None,
            "max": there.max() if there.size else None}
