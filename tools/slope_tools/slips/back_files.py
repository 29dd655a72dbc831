"""What `slope stability --failed` writes: the line as a table, its numbers, a picture."""
import csv
from pathlib import Path
from typing import Any, Dict, Optional, Tuple

import numpy as np

from .. import disk
from ..drawing import figures, pictures
from .back import Line

FILES = ["back.csv", "back.png", "back.yaml"]


def write_back_analysis(folder: Path, line: Line, far: Optional[Line], summary: Dict[str, Any]) -> None:
    """back.csv, .png and .yaml, all of them or none; far: the line about a far axis."""
    with disk.complete(folder, FILES[-1]) as new:
        with open(new / FILES[0], "w", encoding="ascii", newline="") as out:
            rows = csv.writer(out, lineterminator="\n")
            rows.writerow(["friction_degrees", "cohesion_pa"])
            rows.writerows([f"{phi:.8g}", f"{c:.8g}"] for phi, c in zip(*line))
        draw_back_analysis(new / FILES[1], line, far, summary)
        disk.write_yaml(new / FILES[2], summary, "slope stability --failed: F = 1 on the line; Pa, degrees, m")


def draw_back_analysis(path: Path, line: Line, far: Optional[Line], summary: Dict[str, Any]) -> None:
    with pictures.settings(figures.STYLE):
        figure, axes = pictures.subplots(figsize=(figures.WIDE, 2.9))
        unit, name = unit_of(line)
        axes.plot(line.friction, line.cohesion / unit, color=figures.COLOURS[0], lw=1.4,
                  label="F = 1" + (", axis of the nearest sphere" if far else ""))
        axes.fill_between(line.friction, 0, line.cohesion / unit, color=figures.COLOURS[1], alpha=0.15, lw=0,
                          label="it fails")
        if far:
            axes.plot(far.friction, far.cohesion / unit, color=figures.COLOURS[0], lw=0.9, ls="--", label="a far axis")
        axes.set(xlabel="friction angle (degrees)", ylabel=f"cohesion ({name})", xlim=(0, None), ylim=(0, None))
        axes.set_title(f"{summary['volume']:.5g} m3, k {summary['seismic'][0]:g}")
        axes.legend(loc="best")
        axes.grid(color="#dddddd", lw=0.4)
        pictures.save(figure, path)


def unit_of(line: Line) -> Tuple[float, str]:
    """In which the cohesion is shown, Pa and its name; files have Pa."""
    return (1e6, "MPa") if line.cohesion.max() >= 2e6 else (1e3, "kPa")


def describe_back_analysis(line: Line, summary: Dict[str, Any]) -> str:
    """Points of the line for the user."""
    unit, name = unit_of(line)
    lines = [f"body of {summary['volume']:.6g} m3, sliding to {summary['bearing']:.1f} degrees",
             f"F = 1 with   friction, degrees   cohesion, {name}"]
    places = [*np.arange(0.0, line.friction[-1], 10.0), line.friction[-1]]
    for phi in places:
        lines.append(f"             {phi:17.2f}   {np.interp(phi, *line) / unit:12.5g}")
    return "\n".join(lines)
