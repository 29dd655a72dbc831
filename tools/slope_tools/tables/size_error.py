"""The error of a volume by the size of the balls, from what `slope sensitivity --converge` found."""
from pathlib import Path
from typing import Any, Dict, Iterable, List, Mapping, Optional, Sequence

from .. import disk, schemas
from ..case.settings import as_number
from ..digits import three
from ..errors import SlopeError
from ..findings import Finding
from ..schemas import ABOVE_0, FLAG, MAYBE, NUMBER, OBJECT, TEXT, listed, mapping, named
from ..sites.ground import SCALED
from ..statistics.convergence import Estimate, error_of_line
from ..statistics.headline import SizeError

WHAT = "a converge.yaml of `slope sensitivity --converge`"
ESTIMATE = {"value": NUMBER, "standard_error": MAYBE}
NAME: Dict[str, Any] = {**TEXT, "minLength": 1}
CONVERGE = mapping({
    "study": mapping({"variable": TEXT, "deck": TEXT, "base": OBJECT, "finished": NUMBER},
                     road={"type": ["object", "null"]}),
    "quantities": named(mapping({
        "name": NAME, "unit": TEXT, "errors_known": FLAG, "small_balls": mapping({**ESTIMATE, "low": MAYBE,
                                                                                  "high": MAYBE}),
        "slope": mapping(ESTIMATE), "supported": {"type": ["boolean", "null"]}, "covariance": MAYBE, "quantile": MAYBE,
        "sizes": listed(mapping({"value": ABOVE_0, "mean": NUMBER, "scatter": MAYBE, "error_percent": MAYBE,
                                 "standard_error_percent": MAYBE}), 1)}), 1)})
# what may differ between the runs of the fit and those of the study without a word
UNIMPORTANT = {"out", "ranks", "seed"}
TRUSTED = 0.15          # share: a larger error is that of balls which are too large, however narrow its interval


def falls(path: Path, quantity: str) -> bool:
    """Whether the quantity falls with each step to smaller balls, down to some below the size of the field's, unless
    that is the same as theirs.

    A volume is then not too small for the size of its balls, however badly the size of its error is known.
    """
    about = schemas.load(path, WHAT, CONVERGE)
    if quantity not in about["quantities"]:
        raise SlopeError(path, f"must be {WHAT}, with {quantity}")
    sizes = sorted((entry["value"], entry["mean"]) for entry in about["quantities"][quantity]["sizes"])
    field = as_number(about["study"]["base"].get("field_d", ""))
    below = field == SCALED or isinstance(field, float) and sizes[0][0] < field * (1 - 1e-9)
    means = [mean for _, mean in sizes]
    return (about["study"]["variable"] == "d" and below and len(means) > 1 and means[0] > 0
            and all(low <= high for low, high in zip(means, means[1:])))


class SizeErrors:
    """The errors of one quantity (a column of the study's table) at the values of one variable."""

    def __init__(self, path: Path, quantity: str):
        self.path, self.quantity = path, quantity
        about = schemas.load(path, WHAT, CONVERGE)
        study, quantities = about["study"], about["quantities"]
        if quantity not in quantities:
            raise SlopeError(path, f"must have {quantity}, which `slope sensitivity --converge` finds with --road "
                             f"and --of {quantity}", ", ".join(map(str, quantities)) or "none")
        entry = quantities[quantity]
        self.variable, self.deck, self.road = study["variable"], study["deck"], study.get("road") or {}
        self.base: Dict[str, str] = {str(name): str(value) for name, value in study["base"].items()}
        self.supported: Optional[bool] = entry["supported"]
        self.small, self.slope = (Estimate(entry[key]["value"], entry[key]["standard_error"])
                                  for key in ("small_balls", "slope"))
        self.covariance: Optional[float] = entry["covariance"]
        self.quantile: Optional[float] = entry["quantile"]
        self.sizes: List[Mapping[str, Any]] = entry["sizes"]
        self.known = entry["errors_known"] and all(size["error_percent"] is not None for size in self.sizes)
        if not self.known:
            sure = self.quantile and self.small.standard_error and self.quantile * self.small.standard_error
            raise SlopeError(path, f"must have a value of {quantity} for small {self.variable} that is clearly above "
                             "0, so that errors are shares of it", three(self.small.value)
                             + (f" +- {three(sure)} (95 %)" if sure else ""))

    def at(self, value: str, option: str = "--size-error") -> SizeError:
        """The error at a value of the variable: of its own runs if there are some, else of the line."""
        size = as_number(value)
        largest = max(entry["value"] for entry in self.sizes)
        if not (isinstance(size, float) and 0 < size <= largest):
            raise SlopeError(option, f"must know the error of all values of {self.variable}; {self.path} does from 0 "
                             f"to {largest:g}", value)
        for entry in self.sizes:
            if abs(entry["value"] - size) <= 1e-9 * size:
                deviation = entry["standard_error_percent"]
                half = None if deviation is None or self.quantile is None else self.quantile * deviation / 100
                found = SizeError(entry["error_percent"] / 100, half)
                break
        else:
            found = error_of_line(self.small, self.slope, self.covariance, self.quantile, size)
        if found.share <= -1:
            raise SlopeError(self.path, f"must have an error of more than -100 % at {self.variable} {size:g}",
                             f"{100 * found.share:.3g} %")
        return found

    def check(self, settings: Mapping[str, Sequence[str]], defaults: Mapping[str, str]) -> None:
        """Raise SlopeError unless the variable is one of the deck, and the error of all its values is known."""
        if self.variable not in defaults and self.variable not in settings:
            raise SlopeError("--size-error", f"must be of a variable of the deck; {self.path} is of", self.variable)
        for value in settings.get(self.variable) or [defaults[self.variable]]:
            self.at(value)

    def distrust(self, values: Iterable[str]) -> List[str]:
        """Why these errors, at values of the variable, must not count; empty: they may."""
        found = []
        if self.supported is False:
            found.append("its own runs do not support the line that it rests on")
        if any(entry["mean"] == 0 for entry in self.sizes):
            found.append(f"it rests on runs with nothing to remove, at {self.variable} "
                         + ", ".join(f"{entry['value']:g}" for entry in self.sizes if entry["mean"] == 0))
        share = max((self.at(value).share for value in values), key=abs)
        if abs(share) > TRUSTED:
            found.append(f"it is {100 * share:.0f} %, and beyond {100 * TRUSTED:.0f} % a line through these sizes is "
                         "not reliable")
        field = as_number(self.base.get("field_d", ""))
        smallest = min(entry["value"] for entry in self.sizes)
        if self.variable == "d" and isinstance(field, float) and smallest >= field * (1 - 1e-9):
            found.append(f"none of its runs has balls smaller than the field's, {field:g} m, below which the trend may "
                         "reverse")
        return found

    def doubts(self, deck: str, variables: Mapping[str, str], free: Sequence[str],
               road: Mapping[str, Any]) -> List[Finding]:
        """The caveats on these errors for runs with these variables; free: names that may differ."""
        found = []
        if self.deck != deck:
            found.append(Finding("deck of sizes", {"deck": self.deck}))
        other = [f"{name} {value} instead of {variables[name]}" for name, value in self.base.items()
                 if name in variables and name not in UNIMPORTANT and name not in free and name != self.variable
                 and as_number(value) != as_number(variables[name])]
        other += [f"{key.replace('_', ' ')} {self.road[key]:g} instead of {road[key]:g}"
                  for key in ("cut_angle", "mesh")
                  if disk.is_number(self.road.get(key)) and self.road[key] != road.get(key)]
        if other:
            more = f" and {len(other) - 3} more" if len(other) > 3 else ""
            found.append(Finding("base of sizes", {"other": ", ".join(other[:3]) + more}))
        return found
