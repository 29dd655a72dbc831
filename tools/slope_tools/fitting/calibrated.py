"""The sets of values that a calibration found equally good, as the points of an ensemble."""
import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple

from .. import disk, schemas
from ..ensembles.sample import Sample
from ..errors import SlopeError
from ..findings import Finding, finding
from ..schemas import FINDINGS, MAYBE, TEXT, list_of, mapping, dict_of
from ..statistics import distributions
from ..tables import ensemble_types
from .fit import ABOUT

NUMBER = 32             # of the sets, unless --sample says otherwise
WHAT = "what `slope calibrate` wrote, with its sets"
TEXTS = dict_of(TEXT, 1)
SCHEMA = mapping({"calibration": mapping({"variables": TEXTS}, balls_thick=MAYBE, set=dict_of(TEXT),
                                         model=dict_of(TEXT)),
                  "sets": list_of(TEXTS, 2)}, misfit=MAYBE, doubts=FINDINGS)
PART = "calibration"    # of a study, that its doubts are of


@dataclass(frozen=True)
class Calibrated(Sample):
    """A Sample whose points are the sets of a calibration, in their order."""
    sets: Tuple[Mapping[str, str], ...] = ()
    fit: str = ""           # SHA-256 of its file

    @property
    def about(self) -> ensemble_types.Design:
        return replace(super().about, fit=self.fit)

    def combinations(self) -> List[Dict[str, str]]:
        return [dict(one) for one in self.sets[:self.number]]


def texts_of(folder: Path) -> Dict[str, str]:
    """{variable: distribution} of a calibration's folder."""
    return load_calibration(folder)["calibration"]["variables"]


def doubts_of(calibration: Mapping[str, Any]) -> Tuple[Finding, ...]:
    """What was said of the values, and whether they give what was observed."""
    misfit = calibration.get("misfit") or 0.0
    missed = [Finding("observation missed", {"times": math.sqrt(misfit)})] * (misfit > 1)
    return tuple(one._replace(part=PART) for one in (*missed, *map(finding, calibration.get("doubts") or ())))


def load_calibration(folder: Path) -> Dict[str, Any]:
    """What a calibration's folder holds; SlopeError if it is none."""
    path = folder / ABOUT
    if not path.is_file():
        raise SlopeError("--from", f"must be a folder with {ABOUT}, which slope calibrate writes", folder)
    return schemas.load_checked(path, WHAT, SCHEMA)


def sample(folder: Path, number: Optional[int], deck: Path, fixed: Mapping[str, str],
           repeated: Mapping[str, Sequence[str]]) -> Calibrated:
    """The sets of a calibration's folder for a deck that has its variables; number: of them (None: NUMBER)."""
    path, calibration = folder / ABOUT, load_calibration(folder)
    texts = calibration["calibration"]["variables"]
    variables = distributions.parse([f"{name}={text}" for name, text in texts.items()], deck, "--from", True)
    for option, names in (("--set", fixed), ("--repeat", repeated)):
        both = sorted(texts.keys() & set(names))
        if both:
            raise SlopeError("--from", f"must not have a variable of {option}", ", ".join(both))
    if any(list(one) != list(texts) for one in calibration["sets"]):
        raise SlopeError(path, f"must be {WHAT}, each of them with {', '.join(texts)}")
    different = list({tuple(one.values()): one for one in calibration["sets"]}.values())
    if number is not None and not len(variables) < number <= len(different):
        raise SlopeError("--sample", f"must be from {len(variables) + 1} to {len(different)} with --from {folder}, of "
                         "which that many sets differ", number)
    made = calibration["calibration"]
    beside = {**made.get("model", {}), **made.get("set", {})}
    return Calibrated(number or min(NUMBER, len(different)), ensemble_types.CALIBRATED, made.get("seed", 1),
                      tuple(variables), made.get("balls_thick"), beside, doubts_of(calibration), tuple(different),
                      disk.sha256(path))
