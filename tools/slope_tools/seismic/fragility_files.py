"""What `slope fragility` reads and writes: the curve of a hazard, tables, numbers, a picture."""
import csv
import math
from pathlib import Path
from typing import Any, Dict, List, NamedTuple, Optional, Sequence

import numpy as np
from scipy import stats

from .. import disk, schemas
from ..errors import SlopeError
from ..schemas import FINDINGS, NUMBER, TEXT, list_of, mapping
from .fragility import REPLICATES, Band, Fit, Frequency, Hazard

ANY = "any"
ABOUT, CAPACITIES = "fragility.yaml", "capacities.csv"
FILES = ["fragility.csv", "fragility.png", CAPACITIES, ABOUT]
WHAT = "what `slope fragility` wrote"
SCHEMA = mapping({"bodies": list_of(mapping({"body": TEXT, "base_sha256": TEXT}), 1), "peaks_gal": list_of(NUMBER, 1),
                  "hazard_curve": list_of(list_of(NUMBER, 2), 2, null=True), "warnings": FINDINGS})


class Curve(NamedTuple):
    """Of one body, or of any of them."""
    name: str
    band: Band
    fit: Optional[Fit]
    frequency: Optional[Frequency]
    at_rest: float      # share of the samples that fail without an earthquake
    half: float         # gal, from which on half of the strengths fail

    @property
    def title(self) -> str:
        return "any body" if self.name == ANY else f"body {self.name}"


class Fragility(NamedTuple):
    """Of the bodies of a search."""
    folder: Path
    bodies: List[str]               # their ranks
    bases: List[str]                # digests of their surfaces
    capacity: np.ndarray            # gal: samples, records, bodies
    peaks: np.ndarray               # gal
    rate: Optional[Hazard]
    warnings: List[Any]


def read_fragility(folder: Path) -> Fragility:
    """What `slope fragility` left in a folder; SlopeError if it is not whole."""
    about = schemas.load_checked(folder / ABOUT, WHAT, SCHEMA)
    path, curve = folder / CAPACITIES, about["hazard_curve"]
    names = [one["body"] for one in about["bodies"]]
    try:
        with open(path, encoding="ascii") as lines:
            head = next(csv.reader([lines.readline()]))
            rows = np.loadtxt(lines, delimiter=",", ndmin=2)
        capacity = rows[:, 2:].reshape(-1, int(rows[:, 1].max()), len(names))
        if head != ["sample", "record", *names] or len(capacity) % REPLICATES or not (capacity >= 0).all():
            raise ValueError("other bodies or samples than in " + ABOUT)
    except (OSError, LookupError, ValueError) as error:
        raise SlopeError(path, f"must be {WHAT}, with {ABOUT}: repeat that command ({error})") from error
    return Fragility(folder, names, [one["base_sha256"] for one in about["bodies"]], capacity,
                     np.array(about["peaks_gal"], float), Hazard(*np.array(curve, float).T) if curve else None,
                     about["warnings"])


def about_curve(one: Curve) -> Dict[str, Any]:
    """The numbers of a curve for the YAML."""
    about: Dict[str, Any] = {"body": one.name, "fails_without_earthquake": one.at_rest, "lognormal": None}
    if one.fit:
        about["lognormal"] = {
            "median_gal": one.fit.median, "beta": one.fit.beta, "beta_r": one.fit.beta_r, "beta_u": one.fit.beta_u,
            "hclpf_gal": one.fit.hclpf, "median_standard_error": one.fit.median_error,
            "beta_standard_error": one.fit.beta_error, "largest_difference": one.fit.off,
            "probability_at_hclpf": one.fit.at_hclpf, "probability_at_hclpf_fitted": one.fit.at_hclpf_fitted}
    if one.frequency:
        total = one.frequency.total
        about["annual_frequency"] = {
            "value": float(total.value), "low": float(total.low), "high": float(total.high),
            "more_at_most": one.frequency.beyond,
            "contributions": [{"from_gal": a, "to_gal": None if math.isinf(b) else b, "frequency": part}
                              for a, b, part in one.frequency.parts]}
    return about


def write_fragility(folder: Path, peaks: np.ndarray, curves: Sequence[Curve], capacity: np.ndarray,
                    about: Dict[str, Any]) -> None:
    """FILES, all of them or none; capacity (gal): samples, records, bodies."""
    with disk.complete(folder, ABOUT) as new:
        with open(new / "fragility.csv", "w", encoding="ascii", newline="") as out:
            rows = csv.writer(out, lineterminator="\n")
            rows.writerow(["body", "peak_gal", "probability", "low", "high", "lognormal"])
            for one in curves:
                fitted = fitted_at(one.fit, peaks)
                for k, peak in enumerate(peaks):
                    band = (f"{value[k]:.6g}" for value in one.band)
                    rows.writerow([one.name, f"{peak:g}", *band, "" if fitted is None else f"{fitted[k]:.6g}"])
        draw_fragility(new / "fragility.png", peaks, curves)
        samples, records = capacity.shape[:2]
        sample, record = (one.ravel() + 1 for one in np.indices((samples, records)))
        np.savetxt(new / CAPACITIES, np.column_stack([sample, record, capacity.reshape(samples * records, -1)]),
                   "%.7g", ",", header=",".join(["sample", "record", *(one["body"] for one in about["bodies"])]),
                   comments="")
        disk.write_yaml(new / ABOUT, {**about, "curves": [about_curve(one) for one in curves], "files": FILES},
                        "slope fragility: peaks in gal, rates per year")


def fitted_at(fit: Optional[Fit], peaks: np.ndarray) -> Optional[np.ndarray]:
    """Probabilities of the lognormal fit."""
    return None if fit is None else stats.norm.cdf(np.log(peaks / fit.median) / fit.beta)


def draw_fragility(path: Path, peaks: np.ndarray, curves: Sequence[Curve]) -> None:
    """The curves with their bands and fits; with a hazard curve also where the frequency of the last one comes from."""
    from ..drawing import figures, pictures
    parts = curves[-1].frequency
    with pictures.settings(figures.STYLE):
        figure, axes = pictures.subplots(1, 2 if parts else 1, figsize=(figures.FULL, 2.9), squeeze=False,
                                         width_ratios=[3, 2] if parts else None)
        left = axes[0, 0]
        for k, one in enumerate(curves):
            colour = "black" if one.name == ANY else figures.COLOURS[k % len(figures.COLOURS)]
            left.fill_between(peaks, one.band.low, one.band.high, color=colour, alpha=0.2, linewidth=0)
            label = one.title + (f": median {one.fit.median:.0f} gal, HCLPF {one.fit.hclpf:.0f} gal" if one.fit else "")
            left.plot(peaks, one.band.value, color=colour, linewidth=1.2, label=label)
            if one.fit:
                left.plot(peaks, fitted_at(one.fit, peaks), color=colour, linewidth=0.8, linestyle="--")
        left.set(xlim=(peaks[0], peaks[-1]), ylim=(0, 1), xlabel="peak acceleration (gal)",
                 ylabel="probability of failure")
        left.set_title("with bands of the sampling (90 %); dashed: lognormal", loc="left")
        left.legend(loc="best")
        if parts:
            right = axes[0, 1]
            ends = [(a, b if math.isfinite(b) else 1.1 * a) for a, b, _ in parts.parts]
            widths = [b - a for a, b in ends]
            right.bar([a for a, _ in ends], [part / wide for wide, (*_, part) in zip(widths, parts.parts)], widths,
                      align="edge", color=figures.COLOURS[0], edgecolor="white", linewidth=0.3)
            right.set(xlabel="peak acceleration (gal)", ylabel="failures per year and gal")
            right.set_title(f"{curves[-1].title}: {float(parts.total.value):.3g} per year", loc="left")
        pictures.save(figure, path)
