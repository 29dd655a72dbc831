"""What a report shows of structures and control lines: forces against time, the largest pressures, energies."""
from pathlib import Path
from typing import Any, Dict

import numpy as np

from ..ensemble import structures
from . import figure_structures

COLUMNS = {
    "structures": (("largest force", "kN", "largest_force_n", 1e3), ("at", "s", "at_s", 1),
                   (f"largest mean over {structures.WINDOW:g} s", "kN", "mean_force_n", 1e3),
                   ("at the end", "kN", "end_force_n", 1e3), ("impulse", "kN s", "impulse_ns", 1e3),
                   ("largest moment", "kN m", "moment_nm", 1e3),
                   ("largest pressure", "kPa", "largest_pressure_pa", 1e3)),
    "lines": (("forward", "m3", "forward_m3", 1), ("back", "m3", "back_m3", 1), ("net", "m3", "net_m3", 1),
              ("first", "s", "first_s", 1), ("speed 95 %", "m/s", "speed_95_m_s", 1),
              ("height 95 %", "m", "height_95_m", 1), ("energy 50 %", "kJ", "energy_50_j", 1e3),
              ("energy 95 %", "kJ", "energy_95_j", 1e3), ("largest energy", "kJ", "largest_energy_j", 1e3))}


class Structures:
    """Draws what hit the structures of a data.Data, and what crossed its lines; picture makes the template's."""

    def __init__(self, data, numbers, picture):
        self.data, self.numbers, self.picture = data, numbers, picture
        self.runs = data.drawn

    def content(self):
        """For the template; None without any."""
        walls = self.by_name("wall/gran/mesh")
        lines = self.by_name("control/line")
        if not walls and not lines:
            return None
        return {"structures": self.table("structures"), "lines": self.table("lines"),
                "forces": [self.forces(name, found) for name, found in walls.items()],
                "pressures": [one for one in map(self.pressures, self.mine("wall/gran/mesh").items()) if one],
                "energies": [one for one in (self.energies(name, found) for name, found in lines.items()) if one]}

    def mine(self, style):
        return structures.outputs(self.data.result.log.settings, style)

    def by_name(self, style):
        """{ID: [(run, PREFIX)]} of the runs that are drawn."""
        found: Dict[str, Any] = {}
        for run in self.runs:
            for name, prefix in structures.outputs(run.log.settings, style).items():
                found.setdefault(name, []).append((run, prefix))
        return found

    def label(self, run):
        return self.data.label(run) if len(self.runs) > 1 else ""

    def table(self, what):
        """Heads and rows over the runs; None where no run has any."""
        rows = []
        each = [(self.data.label_of(row), row.get(what) or {}) for row in self.data.finished] or [
            ("", structures.of_run(self.data.result.folder, self.data.result.log.settings)[what])]
        for label, found in each:
            for name, numbers in found.items():
                cells = ["-" if numbers[key] is None else
                         self.numbers(f"{name}: {head}", unit, numbers[key] / factor, of=label)
                         for head, unit, key, factor in COLUMNS[what]]
                rows.append({"run": label, "name": name, "cells": cells})
        heads = [(head, unit) for head, unit, _, _ in COLUMNS[what]]
        return {"heads": heads, "rows": rows} if rows else None

    def forces(self, name, found):
        """The mean force on a structure against time, of each run."""
        curves = []
        for run, prefix in found:
            time, force = structures.series(run.folder, prefix).mean_force()
            curves.append((self.label(run), time, force / 1e6))
        title = f"Force on {name}"
        return self.picture(figure_structures.curves(curves, "time (s)", "force (MN)", title), title,
                            f"{title}, its mean over the preceding {structures.WINDOW:g} s. Single impacts depend on "
                            "the size of the model's balls; the table has the largest.")

    def pressures(self, item):
        """The map of the largest pressure on a structure of the shown run; None where nothing touched it."""
        name, prefix = item
        folder = Path(self.data.result.folder)
        corners, pressure = structures.polydata(folder / f"{prefix}.vtp")
        if not pressure.any():
            return None
        load = structures.series(folder, prefix).impulse[-1:].sum(axis=0)       # none without any output
        direction = load if np.hypot(*load[:2]) > 1e-6 * np.linalg.norm(load) else np.array([1.0, 0.0, 0.0])
        title = f"Largest pressure on {name}"
        return self.picture(figure_structures.pressure_map(corners, pressure / 1e3, direction, title), title,
                            f"{title}, of each triangle at any time, seen along the load; grey: never touched. Force "
                            "of the model's balls in one step over the triangle's area: smaller triangles and larger "
                            "balls make it larger.")

    def energies(self, name, found):
        """Share of the forward crossings of a line with more than an energy, of each run."""
        curves = []
        for run, prefix in found:
            crossings = structures.crossings(Path(run.folder), prefix)
            energy = np.sort(crossings["energy"][(crossings["direction"] > 0) & (crossings["energy"] > 0)]) / 1e3
            if len(energy):
                share = 1 - np.arange(len(energy) + 1) / len(energy)
                curves.append((self.label(run), np.concatenate([0.8 * energy[:1], energy]), share))
        if not curves:
            return None
        title = f"Energies at the line {name}"
        return self.picture(figure_structures.curves(curves, "energy of a ball (kJ)", "share with more (-)", title,
                                                     falling=True), title,
                            f"{title}: share of the forward crossings with more than an energy (translation and "
                            "rotation).")
