"""The folder of a route whose runs were made by hand: terrain, road, bodies, and what their runs and studies leave."""
from pathlib import Path

import numpy as np
import yaml
from affine import Affine
from rasterio.crs import CRS
from shapely.geometry import LineString

import made_rows
import made_study
import run_helpers

from slope_tools.route import choices, corridor, runs, search  # noqa: E402
from slope_tools.survey import rasters  # noqa: E402

PLACE = {"crs": CRS.from_user_input(run_helpers.CRS_M), "offset": (run_helpers.EAST, run_helpers.NORTH)}


def raster(z, cell, xlo=0.0, ylo=0.0):
    return rasters.Raster(z, Affine(cell, 0, xlo, 0, -cell, ylo + cell * len(z)), **PLACE)


def make(folder, shape, cell, bodies, y_road=50.0, points=None, **given):
    """bodies: of each (x, y) of its middle, [thickness rasters of its runs], their cell, xlo, ylo, and of each run the
    ranges of chainage that it blocks."""
    ground = raster(np.add.outer(np.linspace(100.0, 0.0, shape[0]), np.zeros(shape[1])), cell)
    line = LineString(points or [(cell, y_road), (cell * (shape[1] - 1), y_road)])
    choices.settle(folder, {"terrain": ["dem.tif"], "road": "axis.csv", "road_width": 8.0, "corridor": 40.0,
                            "cohesion": 9e3, "friction": 30.0, "density": 1900.0, **given})
    rasters.write_asc_local(folder / corridor.TERRAIN, ground, {})
    corridor.write_line(folder / corridor.ROAD, line, ground)
    table = []
    for number, ((x, y), several, size, xlo, ylo, blocked) in enumerate(bodies, 1):
        table.append({"body": number, "name": f"body {number}", "chainage_m": x - cell, "x": x, "y": y, "factor": 1.2,
                      "volume_m3": 1000.0, "area_m2": 400.0, "depth_m": 4.0, "road_from_m": 0.0, "known_share": 0.5,
                      "known_law": "landslides", "why_not": ""})
        slips = folder / search.SLIPS / str(number)
        slips.mkdir(parents=True)
        rasters.write_asc_local(slips / f"body.{number}.base.asc", raster(np.full((2, 2), 5.0), cell, x, y), {})
        rasters.write_asc_local(slips / "terrain.asc", raster(np.full((2, 2), 9.0), cell, x, y), {})
        place = runs.folder_of(folder, number)
        (place / runs.STUDY).mkdir(parents=True)
        rasters.write_asc_local(place / "terrain.asc", raster(np.zeros((2, 2)), cell), {})
        rows = []
        for k, (thickness, ranges) in enumerate(zip(several, blocked)):
            run = place / "runs" / f"run_{k}"
            run.mkdir(parents=True)
            for kind in ("thickness", "max_thickness", "max_speed"):
                run_helpers.write_asc(run / f"run.{kind}.asc", thickness, size, xlo, ylo)
            entries = [{"from": low, "to": high, "passable_width": 2.0, "remove": 10.0 * (k + 1)}
                       for low, high in ranges]
            rows.append(made_rows.row(
                run=f"run_{k}", set={"rolling": str(k)}, remove_on_road_m3=10.0 * k, stretches=entries,
                by_10_m=[[20.0, 5.0 * k], [50.0, 4.0 * number]],
                summary=f"../runs/run_{k}/run.summary.yaml",
                clearing={"road_width": 8.0, "blocked_length": sum(b - a for a, b in ranges),
                          "remove": sum(one["remove"] for one in entries)}))
        made_study.write(place / runs.STUDY, rows, {"set": {"rolling": ["0"]}})
    found = {"bodies": table, "left_out": []}
    (folder / search.TABLE).write_text(yaml.safe_dump(found))
    return Path(folder), found
