"""What `slope fragility` reads and writes: the curve of a hazard, tables, numbers, a picture."""
import csv
import math
from pathlib import Path
from typing import Any, Dict, List, NamedTuple, Optional, Sequence

import numpy as np
from scipy import special

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
    content = schemas.load_checked(folder / ABOUT, WHAT, SCHEMA)
    path, curve = folder / CAPACITIES, content["hazard_curve"]
    names = [one["body"] for one in content["bodies"]]
    try:
        with open(path, encoding="ascii") as lines:
            head = next(csv.reader([lines.readline()]))
            rows = np.loadtxt(lines, delimiter=",", ndmin=2)
        capacity = rows[:, 2:].reshape(-1, int(rows[:, 1].max()), len(names))
        if head != ["sample", "record", *names] or len(capacity) % REPLICATES or not (capacity >= 0).all():
            raise ValueError("other bodies or samples than in " + ABOUT)
    except (OSError, LookupError, ValueError) as error:
        raise SlopeError(path, f"must be {WHAT}, with {ABOUT}: repeat that command ({error})") from error
    return Fragility(folder, names, [one["base_sha256"] for one in content["bodies"]], capacity,
                     np.array(content["peaks_gal"], float), Hazard(*np.array(curve, float).T) if curve else None,
                     content["warnings"])


def about_curve(curve: Curve) -> Dict[str, Any]:
    """The numbers of a curve for the YAML."""
    content: Dict[str, Any] = {"body": curve.name, "fails_without_earthquake": curve.at_rest, "lognormal": None}
    if curve.fit:
        content["lognormal"] = {
            "median_gal": curve.fit.median, "beta": curve.fit.beta, "beta_r": curve.fit.beta_r,
            "beta_u": curve.fit.beta_u, "hclpf_gal": curve.fit.hclpf, "median_standard_error": curve.fit.median_error,
            "beta_standard_error": curve.fit.beta_error, "largest_difference": curve.fit.off,
            "probability_at_hclpf": curve.fit.at_hclpf, "probability_at_hclpf_fitted": curve.fit.at_hclpf_fitted}
    if curve.frequency:
        total = curve.frequency.total
        content["annual_frequency"] = {
            "value": float(total.value), "low": float(total.low), "high": float(total.high),
            "more_at_most": curve.frequency.beyond,
            "contributions": [{"from_gal": a, "to_gal": None if math.isinf(b) else b, "frequency": part}
                              for a, b, part in curve.frequency.parts]}
    return content


def write_fragility(folder: Path, peaks: np.ndarray, curves: Sequence[Curve], capacity: np.ndarray,
                    content: Dict[str, Any]) -> None:
    """FILES, all of them or none; capacity (gal): samples, records, bodies."""
    with disk.complete(folder, ABOUT) as new:
        with open(new / "fragility.csv", "w", encoding="ascii", newline="") as out:
            rows = csv.writer(out, lineterminator="\n")
            rows.writerow(["body", "peak_gal", "probability", "low", "high", "lognormal"])
            for curve in curves:
                fitted = fitted_at(curve.fit, peaks)
                for k, peak in enumerate(peaks):
                    band = (f"{value[k]:.6g}" for value in curve.band)
                    rows.writerow([curve.name, f"{peak:g}", *band, "" if fitted is None else f"{fitted[k]:.6g}"])
        draw_fragility(new / "fragility.png", peaks, curves)
        samples, records = capacity.shape[:2]
        sample, record = (one.ravel() + 1 for one in np.indices((samples, records)))
        np.savetxt(new / CAPACITIES, np.column_stack([sample, record, capacity.reshape(samples * records, -1)]),
                   "%.7g", ",", header=",".join(["sample", "record", *(one["body"] for one in content["bodies"])]),
                   comments="")
        disk.write_yaml(new / ABOUT, {**content, "curves": [about_curve(one) for one in curves], "files": FILES},
                        "slope fragility: peaks in gal, rates per year")


def fitted_at(fit: Optional[Fit], peaks: np.ndarray) -> Optional[np.ndarray]:
    """Probabilities of the lognormal fit."""
    return None if fit is None else special.ndtr(np.log(peaks / fit.median) / fit.beta)


def draw_fragility(path: Path, peaks: np.ndarray, curves: Sequence[Curve]) -> None:
    """The curves with their bands and fits; with a hazard curve also where the frequency of the last one comes from."""
    from ..drawing import figures, pictures
    parts = curves[-1].frequency
    with pictures.settings(figures.STYLE):
        figure, axes = pictures.subplots(1, 2 if parts else 1, figsize=(figures.FULL, 2.9), squeeze=False,
                                         width_ratios=[3, 2] if parts else None)
        left = axes[0, 0]
        for k, curve in enumerate(curves):
            colour = "black" if curve.name == ANY else figures.COLOURS[k % len(figures.COLOURS)]
            left.fill_between(peaks, curve.band.low, curve.band.high, color=colour, alpha=0.2, linewidth=0)
            label = curve.title + (f": median {curve.fit.median:.0f} gal, HCLPF {curve.fit.hclpf:.0f} gal" if curve.fit
                                   else "")
            left.plot(peaks, curve.band.value, color=colour, linewidth=1.2, label=label)
            if curve.fit:
                left.plot(peaks, fitted_at(curve.fit, peaks), color=colour, linewidth=0.8, linestyle="--")
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
