"""Comparison of a run's deposit with a mapped one: all that `slope score` does."""
from pathlib import Path
from typing import Optional

from .. import disk, findings, geometry
from ..errors import SlopeError
from ..survey.rasters import crs_name
from . import deposit
from .score import (THRESHOLD, balls, connected_runout, draw_score, mesh_table, overlap, read_observed, compare_runout,
                    compare_volumes, write_score_csv)

FILES = ("score.csv", "score.png", "score.yaml")


def make_score(prefix: str, mapped: Path, folder: Path, threshold: float = THRESHOLD, mesh: Optional[float] = None,
               terrain: Optional[Path] = None, local: bool = False, overwrite: bool = False) -> str:
    """Write score.yaml, score.csv and score.png of a run to a folder; returns what the user needs to know.

    mapped: a file, outline or raster; threshold: m; mesh: side of the cells of score.csv, m, None: the run's; terrain:
    whose sidecar has the CRS; local: mapped is in local metres. Raises SlopeError on bad input.
    """
    if threshold < 0:
        raise SlopeError("--threshold", "must be >= 0", f"{threshold:g}")
    if mesh is not None and mesh <= 0:
        raise SlopeError("--mesh", "must be > 0", f"{mesh:g}")
    warn, warnings = findings.warner("score")
    run_ = deposit.read_deposit(prefix, terrain, warn)
    disk.check_folder(folder, FILES, [run_.prefix, mapped], overwrite)
    squares = geometry.make_mesh(mesh or run_.cell, run_.raster)
    observed = read_observed(mapped, run_.raster, threshold, local, warn)
    if observed.outside > 0:
        warn(findings.Finding("outside of grid", {"file": str(mapped), "area": observed.outside}))
    simulated = run_.raster.z > threshold
    if not simulated.any():
        warn(findings.Finding("nowhere thicker", {"file": f"{run_.prefix}.thickness.asc", "threshold": threshold}))
    summary = {"prefix": run_.prefix, "observed": mapped, "terrain": run_.terrain,
               "crs": None if run_.raster.crs is None else crs_name(run_.raster.crs),
               "run": {"slope_version": run_.summary.get("slope_version"), "time": run_.summary["time"],
                       "moving": run_.summary["moving"]},
               "threshold": threshold, "cell": run_.cell, "mesh": squares.size,
               "area": overlap(simulated, observed, run_.cell),
               "runout": {**compare_runout(run_, simulated, observed), "balls": balls(run_),
                          "connected": connected_runout(run_, threshold, observed)}}
    table = mesh_table(run_, simulated, observed, squares)
    if observed.thickness is not None:
        summary["bulk_factor"] = run_.bulk
        summary["volume"] = compare_volumes(observed, table)
    summary["warnings"] = warnings
    with disk.complete(folder, "score.yaml") as new:
        write_score_csv(new / "score.csv", run_, squares, table)
        draw_score(new / "score.png", run_, simulated, observed, summary)
        summary["files"] = list(FILES)
        disk.write_yaml(new / "score.yaml", summary, "slope score: simulated against mapped; m, m2, m3, degrees")
    return describe_score(summary, folder)


def describe_score(summary, folder):
    """What the user needs to know."""
    area, out = summary["area"], summary["runout"]
    jaccard = "none" if area["jaccard"] is None else f"{area['jaccard']:.3f}"
    lines = [f"thicker than {summary['threshold']:g} m: {area['true_positive']:.1f} m2 in both, "
             f"{area['false_positive']:.1f} m2 simulated only, {area['false_negative']:.1f} m2 mapped only; "
             f"Jaccard {jaccard}"]
    if out["difference"] is not None:
        lines.append(f"run-out: {out['simulated']:.1f} m simulated, {out['observed']:.1f} m mapped: "
                     f"{out['difference']:+.1f} m")
    if out["connected"] is not None and "difference" in out["connected"]:
        part = out["connected"]
        lines.append(f"connected deposit, {100 * part['share_of_volume']:.1f} % of the volume: "
                     f"{part['distance']:.1f} m, {part['difference']:+.1f} m")
    if out.get("quantiles"):
        most = out["quantiles"][-1]
        which = f"{100 * most['share']:g} % of the {out['quantiles_of']}"
        lines.append(f"{which}: simulated beyond the grid, mapped within {most['observed']:.1f} m"
                     if most["simulated"] is None else
                     f"{which}: within {most['simulated']:.1f} m "
                     f"simulated, {most['observed']:.1f} m mapped: {most['difference']:+.1f} m")
    if "volume" in summary:
        volume = summary["volume"]
        lines.append(f"volume: {volume['simulated']:.1f} m3 simulated (bulk factor {summary['bulk_factor']:.6g}), "
                     f"{volume['observed']:.1f} m3 mapped: {volume['error']:+.1f} m3")
    lines.append(f"written to {folder}: {' '.join(summary['files'])}")
    return "\n".join(lines)
