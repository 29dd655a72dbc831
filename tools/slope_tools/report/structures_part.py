"""What a report shows of structures and control lines: forces against time, the largest pressures, energies."""
from pathlib import Path
from typing import Any, Dict, List

import numpy as np

from .. import digits
from ..findings import Finding
from ..plots import figure_structures
from ..tables import structures
from .data import Data
from .numbers import Numbers
from .sections import Cell, Figures, Picture, Section, Table, Text

LENGTHWISE = "mean_force_n_m"       # the largest lasting force per metre of the structure that bears it
COLUMNS = {
    "structures": (("largest force", "N", "largest_force_n"), ("at", "s", "at_s"),
                   (f"largest mean over {structures.WINDOW:g} s", "N", "mean_force_n"),
                   ("the same per metre, at least", "N/m", LENGTHWISE), ("at the end", "N", "end_force_n"),
                   ("on contacts", "", "end_contacts"),
                   ("impulse", "N s", "impulse_ns"), ("largest moment", "N m", "moment_nm"),
                   ("largest pressure", "Pa", "largest_pressure_pa")),
    "lines": (("forward", "m3", "forward_m3"), ("back", "m3", "back_m3"), ("net", "m3", "net_m3"),
              ("counted", "", "direction"), ("first", "s", "first_s"), ("speed 95 %", "m/s", "speed_95_m_s"),
              ("height 95 %", "m", "height_95_m"),
              ("energy 50 %", "J", "energy_50_j"), ("energy 95 %", "J", "energy_95_j"),
              ("largest energy", "J", "largest_energy_j"))}
PREFIXED = ("N", "N/m", "N s", "N m", "Pa", "J")     # units that are written with a prefix, beside each number

CAPTIONS = {
    "structures": "Loads on the structures. A mean over time is that of the mass, per metre of the length that bears "
                  f"it ({100 * structures.BORNE:.0f} % of the impulse of the run, evenly, {structures.FEW} balls at "
                  "least; what bears the largest force may be shorter than this, and than long triangles); the "
                  "largest force, moment and pressure come from single impacts of the model's balls. The force at the "
                  "end depends on how the mass came to rest: about 0.5 times the pressure of a fluid of the same "
                  "weight where it stood before most of its weight came or where the structure gives way, 0.7 to 0.9 "
                  "where it sank or fell into place, near 3 "
                  "(the passive pressure) where the mass was stopped by it; it scatters by tens of per cent from run "
                  "to run where few balls touch.",
    "lines": "What crossed the lines, forward and back; volumes in m3 of ground. Times and quantiles are of the "
             "crossings in the direction in which more crossed, each ball with the same weight."}


class Structures:
    """Draws what hit the structures of a data.Data, and what crossed its lines."""

    def __init__(self, data: Data, numbers: Numbers, ground):
        self.data, self.numbers, self.ground = data, numbers, ground
        self.runs = data.drawn

    def section(self):
        """None without any."""
        walls = self.by_name("wall/gran/mesh")
        lines = self.by_name("control/line")
        if not walls and not lines:
            return None
        scatter = structures.scatter_at_rest(self.data.finished) if self.data.study else {}
        shares = "; ".join(f"{name}: {digits.cents(share)} over {runs} runs" for name, (share, runs) in scatter.items())
        points, coarse = "; ".join(self.points()), "; ".join(one.text for one in coarse_walls(self.data, self.ground))
        more = f" Moments are about (local x y z, m): {points}." * bool(points) + f" {coarse}." * bool(coarse)
        return Section("structures", "Structures and control lines", [
            self.table("structures", more), self.table("lines"),
            Text("Scatter of the force at the end between runs that differ by chance alone: "
                 f"{shares}.") if shares else None,
            Figures([self.forces(name, found) for name, found in walls.items()], "columns"),
            Figures([self.pressures(one) for one in self.mine("wall/gran/mesh").items()], "tall"),
            Figures([self.energies(name, found) for name, found in lines.items()], "columns")])

    def points(self) -> List[str]:
        """The reference points of the moments, as the commands of the shown run have them."""
        points = []
        for words in map(str.split, self.data.result.log.settings):
            if words[:1] == ["fix"] and words[3:4] == ["wall/gran/mesh"] and "point" in words[:-3]:
                at = words.index("point") + 1
                points.append(f"{words[1]} "
                              f"{' '.join(f'{float(word):.1f}' for word in words[at:at + 3])}")
        return points

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

    def table(self, what, more=""):
        """Over the runs; None where no run has any."""
        rows, study = [], self.data.study
        each = [(self.data.number(row.run), self.data.label_of(row), row.value(what), row.ball_m3)
                for row in self.data.finished] or [
            ("", "", structures.read_run_structures(self.data.result.folder, self.data.result.log.settings)[what],
             ball_of(self.data))]
        for number, label, found, ball in each:
            for name, numbers in found.items():
                if what == "structures":
                    numbers = {**numbers, LENGTHWISE: structures.per_metre(numbers, ball ** (1 / 3))}
                cells = [self.cell(f"{name}: {head}", unit, numbers.get(key), label)
                         for head, unit, key in COLUMNS[what]]
                rows.append([*([number] if study else []), name, *cells])
        heads = [*(["run"] if study else []), what[:-1],
                 *(Cell(head, "" if unit in PREFIXED else unit) for head, unit, _ in COLUMNS[what])]
        return Table(CAPTIONS[what] + more, heads, rows, (len(heads) - len(COLUMNS[what]) - 1,)) if rows else None

    def cell(self, what, unit, value, label):
        """A number of the table, with its unit where that has a prefix."""
        if value is None or isinstance(value, str):
            return value or "-"
        text = self.numbers(what, unit, value, of=label) if unit else self.numbers.whole(what, unit, value, of=label)
        return digits.si(value, unit) if unit in PREFIXED else text

    def forces(self, name, structure):
        """The mean force on a structure against time, of each run."""
        curves = []
        for run, prefix in structure:
            time, force = structures.series(run.folder, prefix).mean_force()
            curves.append((self.label(run), time, force))
        factor, prefix = digits.prefix(max((force.max(initial=0) for _, _, force in curves)))
        curves = [(label, time, force / factor) for label, time, force in curves]
        title = f"Force on {name}"
        return Picture(figure_structures.curves(curves, "time (s)", f"force ({prefix}N)", title), title,
                       f"{title}, its mean over the preceding {structures.WINDOW:g} s. Single impacts depend on "
                       "the size of the model's balls; the table has the largest.")

    def pressures(self, structure):
        """The map of the largest pressure on a structure of the shown run; None where nothing touched it."""
        name, prefix = structure
        folder = Path(self.data.result.folder)
        corners, pressure = structures.polydata(folder / f"{prefix}.vtp")
        if not pressure.any():
            return None
        load = structures.series(folder, prefix).impulse[-1:].sum(axis=0)       # none without any output
        direction = load if np.hypot(*load[:2]) > 1e-6 * np.linalg.norm(load) else np.array([1.0, 0.0, 0.0])
        title = f"Largest pressure on {name}"
        top = int(pressure.argmax())
        one, other = corners[top, 1] - corners[top, 0], corners[top, 2] - corners[top, 0]
        area = digits.three(0.5 * float(np.linalg.norm(np.cross(one, other))))
        return Picture(figure_structures.pressure_map(corners, pressure, direction, title), title,
                       f"{title}, of each triangle at any time, seen along the load; grey: never touched. Force "
                       f"of the model's balls in one step over the triangle's area: {area} m2 where it is "
                       "largest. Smaller triangles and larger balls make it larger.")

    def energies(self, name, line):
        """Share of the crossings of a line with more than an energy, of each run, in the direction of the mass."""
        curves = []
        for run, prefix in line:
            crossings = structures.crossings(Path(run.folder), prefix)
            main = structures.of_line(Path(run.folder), prefix)["direction"]
            energy = np.sort(crossings["energy"][structures.in_direction(crossings, main) & (crossings["energy"] > 0)])
            if len(energy):
                share = 1 - np.arange(len(energy) + 1) / len(energy)
                curves.append((self.label(run), np.concatenate([0.8 * energy[:1], energy]), share))
        if not curves:
            return None
        factor, prefix = digits.prefix(max(energy[-1] for _, energy, _ in curves))
        curves = [(label, energy / factor, share) for label, energy, share in curves]
        title = f"Energies at the line {name}"
        return Picture(figure_structures.curves(curves, f"energy of a ball ({prefix}J)", "share with more (-)",
                                                title, falling=True), title,
                       f"{title}: share of the crossings with more than an energy (translation and rotation), in "
                       "the direction in which more crossed.")


def coarse_walls(data: Data, ground) -> List[Finding]:
    """On structures of the shown run that are lower than FEW balls, the lowest first.

    A ball: the side of the cube of ground that it stands for. Not of structures below the ground or beside it.
    """
    findings = []
    ball = ball_of(data) ** (1 / 3)
    for name, corners in ground.obstacles.walls.items():
        x, y, z = corners.reshape(-1, 3).T
        above = z - ground.along(ground.before, x, y)
        tall = float(above[np.isfinite(above)].max(initial=0.0))
        if 0 < tall < structures.FEW * ball:
            findings.append(Finding("few balls high", {"name": name, "height": tall, "balls": tall / ball}))
    return sorted(findings, key=lambda finding: finding.numbers["balls"])


def ball_of(data: Data) -> float:
    """m3 of ground that a ball of the shown run stands for."""
    summary = data.result.summary
    return summary["volume"]["released"] / summary["balls"]["released"]
