"""What a run says of structures (fix wall/gran/mesh ... output) and control lines: read back, and tabled over a study.

Which ones a run had is known from the commands in its log, so that files which an earlier run left are not taken for
this one's. Forces in N, times in s, pressures in Pa, volumes in m3 of ground, energies in J.
"""
import csv
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Dict, Iterator, List, Mapping, Optional, Sequence, Tuple
from xml.etree import ElementTree

import numpy as np
from rich.table import Table
from shapely.geometry import MultiPoint

from .. import disk, schemas
from ..errors import SlopeError
from ..quantiles import within
from .rows import Finished

WINDOW = 0.5            # s, of the mean force: single impacts are those of the model's balls, what lasts is the mass's
SHARES = (0.5, 0.9, 0.95, 0.99)
FEW = 5                 # balls: on a shorter length, or a lower structure, loads are those of one ball after another
BORNE = 0.9             # of the impulse: what comes onto either end of a structure is of stray balls
PARTS = 10              # of a length, of which those that bear least do not count
SERIES = ("time", "fx", "fy", "fz", "jx", "jy", "jz", "contacts", "largest_force", "largest_moment")
OLDER = ": of an older version? Then make the run again (a study with --anew)"
FILES = {"structures": "structures.csv", "lines": "lines.csv"}
SIDE = schemas.mapping(schemas.number_keys("volume", "crossings"))
LINE = schemas.mapping({"forward": SIDE, "back": SIDE, "net_volume": schemas.NUMBER})


@dataclass(frozen=True)
class Series:
    """What acted on a structure at times (n): force, impulse (n, 3), contacts, of force and moment the largest
    since the time before."""
    time: np.ndarray
    force: np.ndarray
    impulse: np.ndarray
    contacts: np.ndarray
    largest: np.ndarray
    largest_moment: np.ndarray

    def mean_force(self, window=WINDOW):
        """Times, and size of the mean force over the window (s) that ends then: the change of the impulse over it.

        All that came since the time before, where that is longer ago: it may have come within a window.
        """
        if not len(self.time):      # a run that was stopped before its first output
            return self.time, np.zeros(0)
        begin = np.minimum(self.time - window, np.concatenate([[0.0], self.time[:-1]]))
        before = np.stack([np.interp(begin, self.time, column, left=0.0) for column in self.impulse.T], axis=-1)
        return self.time, np.linalg.norm(self.impulse - before, axis=1) / window


def outputs(settings: Sequence[str], style: str) -> Dict[str, str]:
    """{ID: PREFIX} of the fixes of a style with an output, from the commands of a log; those of a terrain left out."""
    found = {}
    for line in settings:
        words = line.split()
        if words[0] == "fix" and words[3:4] == [style] and "output" in words[:-1] and words[5:6] != ["terrain"]:
            found[words[1]] = words[words.index("output") + 1]
    return found


def table_of(path: Path, columns: Sequence[str], remedy: str = "") -> Dict[str, np.ndarray]:
    """Columns of a CSV that a fix wrote; remedy: where its head has not all of them."""
    try:
        with open(path, encoding="ascii", newline="") as file:
            reader = csv.DictReader(file)
            if not set(columns) <= set(reader.fieldnames or ()):
                lacks = ", ".join(name for name in columns if name not in (reader.fieldnames or ()))
                raise ValueError(f"a first line without {lacks}{remedy}")
            rows = list(reader)
        # a height is empty where the terrain has none
        return {name: np.array([row[name] or "nan" for row in rows], float) for name in columns}
    except (OSError, ValueError, TypeError, csv.Error) as error:
        raise SlopeError(path, f"must be what the run wrote, with {', '.join(columns)}",
                         getattr(error, "strerror", None) or error) from error


def series(folder: Path, prefix: str) -> Series:
    found = table_of(folder / f"{prefix}.csv", SERIES, OLDER)
    force, impulse = (np.stack([found[f"{letter}{axis}"] for axis in "xyz"], axis=-1) for letter in "fj")
    return Series(found["time"], force, impulse, found["contacts"], found["largest_force"], found["largest_moment"])


def pressures(folder: Path, prefix: str) -> Dict[str, np.ndarray]:
    """Of the triangles that were touched: middle x, y, z (m) and largest pressure (Pa)."""
    return table_of(folder / f"{prefix}.triangles.csv", ("x", "y", "z", "largest_pressure"))


def polydata(path: Path, what="largest_pressure") -> Tuple[np.ndarray, np.ndarray]:
    """Corners of the triangles (n, 3, 3), m, and their largest pressure (n), Pa, of the .vtp that the fix wrote; or
    what else it has of each."""
    try:
        arrays = {one.get("Name"): np.array(one.text.split(), float)
                  for one in ElementTree.parse(path).iter("DataArray") if one.text}
        corners, values = arrays["corners"].reshape(-1, 3, 3), arrays[what]
        if len(corners) != len(values):
            raise ValueError(f"{len(corners)} triangles, {len(values)} values")
    except (OSError, ElementTree.ParseError, KeyError, ValueError) as error:
        raise SlopeError(path, f"must be what fix wall/gran/mesh wrote ({error})") from error
    return corners, values


def crossings(folder: Path, prefix: str) -> Dict[str, np.ndarray]:
    """Of all crossings of a line: time, direction (1 forward, -1 back), speed, height, energy, volume."""
    return table_of(folder / f"{prefix}.line.csv", ("time", "direction", "speed", "height", "energy", "volume"))


def bearing_length(corners: np.ndarray, impulse: np.ndarray) -> Tuple[float, float]:
    """m in plan: the width of a structure across its load, and that of the part that bears this; of triangles
    (n, 3, 3) with an impulse per area (n), even on each.

    The part: as long as an even load is that has BORNE of it, in the middle, on the same length; and of that length
    the PARTS that bear BORNE again, as two streams load no wall between them.
    """
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(normal, axis=1) / 2
    load = np.maximum(impulse * area, 0.0)
    along = corners[..., :2] @ across_load(corners, normal / np.maximum(2 * area[:, None], 1e-30), load)
    length = float(np.ptp(along))
    if not (length > 0 and load.sum() > 0):
        return length, 0.0
    low, high = along.min(axis=1), along.max(axis=1) + 1e-6 * length    # upright across it: no length
    at, index = np.unique(np.concatenate([low, high]), return_inverse=True)
    rate = np.cumsum(np.bincount(index, np.concatenate([load / (high - low), -load / (high - low)])))[:-1]
    before = np.concatenate([[0.0], np.cumsum(rate * np.diff(at))])
    ends = np.interp(load.sum() * np.array([(1 - BORNE) / 2, (1 + BORNE) / 2]), before, at)
    parts = np.sort(np.diff(np.interp(np.linspace(ends[0], ends[1], PARTS + 1), at, before)))[::-1]
    most = np.interp(BORNE, np.concatenate([[0.0], np.cumsum(parts) / parts.sum()]), np.arange(PARTS + 1) / PARTS)
    return length, float(min(length, most * (ends[1] - ends[0]) / BORNE ** 2))


def across_load(corners: np.ndarray, normal: np.ndarray, load: np.ndarray) -> np.ndarray:
    """Direction in plan, of length 1: across what the triangles, by their normals, are loaded from; along the longest
    side of the structure where that comes from all around."""
    (less, most), directions = np.linalg.eigh((load * normal[:, :2].T) @ normal[:, :2])
    if most > 2 * less:
        return np.asarray(directions[:, 0])
    outline = MultiPoint(corners[..., :2].reshape(-1, 2)).minimum_rotated_rectangle
    sides = np.diff(np.asarray(getattr(outline, "exterior", outline).coords), axis=0)
    lengths = np.hypot(*sides.T)
    return np.asarray(sides[lengths.argmax()] / lengths.max()) if lengths.max(initial=0.0) > 0 else np.zeros(2)


# --- a run ---

def of_structure(folder: Path, prefix: str) -> Dict[str, Any]:
    """Numbers of a structure."""
    forces, pressure = series(folder, prefix), pressures(folder, prefix)
    time, mean = forces.mean_force()
    numbers: Dict[str, Any] = {"largest_force_n": 0.0, "at_s": None, "mean_force_n": 0.0, "mean_at_s": None,
                               "end_force_n": 0.0, "end_contacts": 0, "impulse_ns": 0.0, "moment_nm": 0.0,
                               "length_m": None, "bearing_m": None, "largest_pressure_pa": 0.0, "pressure_at": None}
    if len(time) and forces.largest.max() > 0:
        numbers.update(largest_force_n=float(forces.largest.max()), at_s=float(time[forces.largest.argmax()]),
                       mean_force_n=float(mean.max()), mean_at_s=float(time[mean.argmax()]),
                       end_force_n=float(np.linalg.norm(forces.force[-1])), end_contacts=int(forces.contacts[-1]),
                       impulse_ns=float(np.linalg.norm(forces.impulse[-1])),
                       moment_nm=float(forces.largest_moment.max()))
    largest = pressure["largest_pressure"]
    if len(largest) and largest.max() > 0:
        k = int(largest.argmax())
        length, bearing = bearing_length(*polydata(folder / f"{prefix}.vtp", "impulse"))
        numbers.update(length_m=length, bearing_m=bearing, largest_pressure_pa=float(largest[k]),
                       pressure_at=[float(pressure[axis][k]) for axis in "xyz"])
    return numbers


def per_metre(numbers: Mapping[str, Any], ball: float) -> Optional[float]:
    """N/m: the largest lasting force of a structure over the length that bears it, FEW balls (m) at least, if it is as
    long; None where nothing touched it. A least: what bears the largest force may be shorter than what bears the
    impulse of the whole run, and than long triangles."""
    length = numbers.get("length_m")
    return numbers["mean_force_n"] / max(numbers["bearing_m"], min(FEW * ball, length)) if length else None


def of_line(folder: Path, prefix: str) -> Dict[str, Any]:
    """Numbers of a control line; speeds, heights, energies of the crossings in the direction of the mass, all alike."""
    about = schemas.load_checked(folder / f"{prefix}.line.yaml", "what fix control/line wrote", LINE)
    crossings_ = crossings(folder, prefix)
    forward, back = about["forward"]["volume"], about["back"]["volume"]
    main = "back" if back > forward else "forward"      # as the fix has it
    numbers: Dict[str, Any] = {"forward_m3": forward, "back_m3": back, "net_m3": about["net_volume"],
                               "direction": main, "crossings": about[main]["crossings"]}
    mine = in_direction(crossings_, main)
    times = crossings_["time"][mine]
    numbers["first_s"] = float(times.min()) if len(times) else None
    for name, unit in (("speed", "m_s"), ("height", "m"), ("energy", "j")):
        values = crossings_[name][mine]
        values = values[np.isfinite(values)]
        for share in SHARES:
            numbers[f"{name}_{100 * share:.0f}_{unit}"] = within(values, np.ones(len(values)), share) if len(values) \
                else None
        numbers[f"largest_{name}_{unit}"] = float(values.max()) if len(values) else None
    return numbers


def in_direction(crossings_: Mapping[str, np.ndarray], main: str) -> np.ndarray:
    """Mask of the crossings forward, or back."""
    return crossings_["direction"] * (1 if main == "forward" else -1) > 0


def read_run_structures(folder, settings: Sequence[str]) -> Dict[str, Dict[str, Dict[str, Any]]]:
    """{"structures": {ID: numbers}, "lines": {ID: numbers}} of a run with these commands in its log."""
    folder = Path(folder)
    return {"structures": {name: of_structure(folder, prefix)
                           for name, prefix in outputs(settings, "wall/gran/mesh").items()},
            "lines": {name: of_line(folder, prefix) for name, prefix in outputs(settings, "control/line").items()}}


# --- a study ---

def scatter_at_rest(rows: Sequence[Finished]) -> Dict[str, Tuple[float, int]]:
    """{structure: (scatter of its force at the end between runs with equal values, a share of the mean; runs)}.

    Pooled over the values that vary; none where no run was repeated.
    """
    forces: Dict[str, Dict[tuple, List[float]]] = {}
    for row in rows:
        for name, numbers in row.structures.items():
            forces.setdefault(name, {}).setdefault(tuple(row.set.values()), []).append(numbers["end_force_n"])
    scatters = {}
    for name, groups in forces.items():
        several = [np.array(one) / np.mean(one) for one in groups.values() if len(one) > 1 and np.mean(one) > 0]
        if several:
            free = sum(len(one) - 1 for one in several)
            scatters[name] = float(np.sqrt(sum(((one - 1) ** 2).sum() for one in several) / free)), sum(map(len,
                                                                                                            several))
    return scatters


def tabulate_structures(rows: Sequence[Finished], what: str) -> str:
    """The CSV over all runs: a row for each structure, or line, of each; '' if there is none."""
    entries = [(row, name, numbers) for row in rows for name, numbers in row.value(what).items()]
    if not entries:
        return ""
    columns = [key for key in entries[0][2] if key != "pressure_at"]
    place = ["pressure_x_m", "pressure_y_m", "pressure_z_m"] if what == "structures" else []
    return disk.csv_text(["run", *entries[0][0].set, what[:-1], *columns, *place], (
        [row.run, *row.set.values(), name, *(numbers[key] for key in columns),
         *((numbers["pressure_at"] or [None] * 3) if place else [])] for row, name, numbers in entries))


SHOWN: Dict[str, Tuple[Tuple[str, str, float], ...]] = {
    "structures": (("largest kN", "largest_force_n", 1e3), (f"in {WINDOW:g} s kN", "mean_force_n", 1e3),
                   ("at the end kN", "end_force_n", 1e3), ("on contacts", "end_contacts", 1),
                   ("impulse kN s", "impulse_ns", 1e3), ("pressure kPa", "largest_pressure_pa", 1e3)),
    "lines": (("forward m3", "forward_m3", 1), ("back m3", "back_m3", 1), ("speed 95 % m/s", "speed_95_m_s", 1),
              ("height 95 % m", "height_95_m", 1), ("energy 95 % kJ", "energy_95_j", 1e3),
              ("largest kJ", "largest_energy_j", 1e3))}
TITLES = {"structures": f"forces on structures: the largest, and the largest mean over {WINDOW:g} s",
          "lines": "what crossed the lines; quantiles in the direction in which more crossed"}


def format_structure_cell(value, unit):
    return "-" if value is None else f"{value / unit:,.3g}" if abs(value) < 999.5 * unit else f"{value / unit:,.0f}"


def list_structure_tables(rows: Sequence[Finished]) -> Iterator[Table]:
    """The tables on the screen."""
    for what, heads in SHOWN.items():
        if not any(row.value(what) for row in rows):
            continue
        table = Table(title=TITLES[what])
        for head in ("run", what[:-1], *(head for head, _, _ in heads)):
            table.add_column(head, justify="right")
        for row in rows:
            for name, numbers in row.value(what).items():
                table.add_row(row.run, name, *(format_structure_cell(numbers.get(key), unit) for _, key, unit in heads))
        yield table
