"""The files of a run: its summary and the rasters that fix deposit/grid wrote."""
from pathlib import Path

from ..disk import is_number, load_yaml
from ..errors import SlopeError
from ..survey import rasters

VARIABLES = "variables.yaml"       # what `slope study` runs, written before the run
MARKER = "finished.yaml"           # written when the run is complete
SUMMARY_KEYS = {"volume": ("released", "on_grid", "off_grid", "lost", "residual"),
                "travel": ("front", "front_at_release", "centroid", "reach_angle"),
                "largest": ("thickness", "max_thickness", "max_speed", "max_energy"),
                "stop": ("step", "time", "reason"), "grid": ("cell", "extent"), "balls": ("released", "lost"),
                "motion": ("moving_share", "threshold"), "moving": (), "ranks": (), "dt": (), "bulk_factor": (),
                "slope_version": (), "lammps_version": (), "change_rate": (),
                "guards": ("largest_overlap", "deep_contacts", "energy_growth", "dangerous_builds")}
OPTIONAL = {"change_rate", "guards"}        # among them: older summaries, and other pair styles, have none
NO_NUMBERS = {"reason", "extent", "moving", "slope_version", "lammps_version"}    # among them
ABOVE_ZERO = {("volume", "released"), ("balls", "released"), ("grid", "cell"), ("dt", None), ("bulk_factor", None)}


def summaries(folder):
    """The summaries of fix deposit/grid in a folder."""
    return sorted(Path(folder).glob("*.summary.yaml"))


def prefix_of(summary):
    """PREFIX of the rasters that belong to a summary."""
    return Path(str(summary).removesuffix(".summary.yaml"))


def load_summary(path):
    """The summary of fix deposit/grid as a dict, with all that the tools need of it."""
    about = load_yaml(path, "a summary that fix deposit/grid wrote")
    for key, entries in SUMMARY_KEYS.items():
        if key in OPTIONAL and key not in about:
            continue
        for entry in entries or (None,):
            if key not in about or (entry and (not isinstance(about[key], dict) or entry not in about[key])):
                raise SlopeError(path, "must be a summary that fix deposit/grid wrote, with "
                                 + (f"{key}: {entry}" if entry else key))
            value = about[key][entry] if entry else about[key]
            name = f"{key}: {entry}" if entry else key
            if (entry or key) not in NO_NUMBERS and not is_number(value):
                raise SlopeError(path, f"{name} must be a finite number", repr(value)[:60])
            if (key, entry) in ABOVE_ZERO and not value > 0:
                raise SlopeError(path, f"{name} must be > 0", value)
    if not isinstance(about["moving"], bool):
        raise SlopeError(path, "moving must be true or false", repr(about["moving"])[:60])
    return about


def load_raster(prefix, name, heights=True):
    """One of the rasters of fix deposit/grid; heights: whether its values are checked as such."""
    path = Path(f"{prefix}.{name}.asc")
    if not path.is_file():
        raise SlopeError(path, "must be there: fix deposit/grid writes it beside its summary")
    return rasters.read(path, heights)
