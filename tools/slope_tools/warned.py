"""A warning as a value: what kind it is of, its numbers, the runs concerned. Its words are made here, and only here."""
import json
import sys
from typing import Any, Callable, Dict, List, Mapping, NamedTuple, Sequence, Union

from .digits import rounded

OTHER = "other"         # of the kinds that no reader tells apart, and of what older files say
WORDS = {
    OTHER: "{text}",
    # of the files of a GIS
    "pits": "{cells} cells of {mark} lie at least {depth:.4g} m {side} all cells beside them, the first "
            "at {east:.10g} {north:.10g}: NODATA that the file does not declare? {remedy}",
    "no such cell": "--nodata {value}: no cell of the input has that value; its heights are {low:.6g} to {high:.6g} m",
    "picture": "all heights are whole numbers from {low:g} to {high:g}, as the values of a picture: is it a hillshade?",
    "in feet": "the ground falls by {degrees:.0f} degrees on average: are the heights in feet? Then --z-unit ft, which "
               "makes it {in_feet:.0f}",
    "no ground's slope": "the ground falls by {degrees:.0f} degrees on average, {in_feet:.0f} if it is in feet: are "
                         "these heights, and the cells in metres?",
    "stretched": "a metre in {crs} is {metres:.3f} m on the ground: choose a local CRS",
    "CRS of terrain": "{file} has no CRS: taken to be in that of the terrain{remedy}",
    "datums": "tiles of {datums} are mixed and not converted: {what} may differ where they meet",
    "cut to input": "--bounds reaches beyond the input, {extent}: cut to it",
    "outside": "{file}: {percent:.2g} % of the area lies outside of {terrain}",
    "no geometry": "{feature} has no geometry ({without} of {features} have none): left out",
    "file name": "{file}: LAMMPS cannot read {characters} in the name of a file: rename it before it goes into a deck",
    "swapped": "--release and --road may be swapped, the road lies above the release area: {grounds}",
    # of a body
    "bulges": "the ground bulges above the line from toe to shoulder, and so does the {shape}: a smaller polygon, or "
              "--shape slbl?",
    "no way out": "the plane dips {dip:.3g} degrees towards {direction:.3g}, where the ground falls by {ground:.3g}: "
                  "it does not come out of the ground below the body, which cannot slide out; a smaller --dip, or "
                  "another --direction?",
    "little": "the base level {form}takes {percent:.0f} % of the polygon, {depth:.3g} m deep on average: is this the "
              "intended body? A larger depth or a smaller polygon gives another one",
    "cliff": "the ground of the body falls by {degrees:.0f} degrees on average: a cliff, or heights in feet "
             "({in_feet:.0f} degrees)? slope terrain and site have --z-unit",
    "few cells": "the body covers {cells} cells of {cell:g} m: use a finer terrain",
    "hollow": "the slip surface has a closed hollow, {depth:.3g} m deep, out of which the mass cannot slide: {remedy}",
    "rim": "the body is {depth:.3g} m deep at the rim of its area, where it ends in a wall: {remedy}",
    "shift": "beside the body {file} lies {metres:.3g} m {side} the terrain (median), which counts in the depths: "
             "vertical datums are not compared, are they the same?",
    "parts": "the body is in {parts} parts that do not touch, of {volumes} m3: is that the body you mean?",
    # of a body and its balls
    "no program": "no LAMMPS program (LMP, --lmp, build/lmp): no trial run, time and speeds are unknown",
    "left terrain": "{percent:.2g} % of the mass left the terrain in the trial run: use a larger elevation model",
    "not at rest": "the trial run was not at rest after {seconds:.0f} s: the run time of the study is a guess",
    "large": "the body has {millions} million m3: masses of {limit:g} million m3 and more run farther than laboratory "
             "friction gives; how far is what the runs show that known events weigh, or a calibration with a past "
             "event of that size (slope calibrate)",
    "thin": "the body is {balls:.1f} balls thick on average, below {limit:g}: the numbers will be rough; use more "
            "balls (--balls, --minutes)",
    "first look": "the body is {balls:.1f} balls thick at most, below {limit:g}: a first look; to repeat it, use more "
                  "balls (--balls, --minutes)",
    "small angle": "{option} {degrees:g}: is it in degrees? A coefficient of {degrees:g} is {meant:.3g} degrees",
    "large rolling": "--rolling {rolling:g}: is it a coefficient? More than {limit:g} stands for bodies that do not "
                     "roll",
    # of runs
    "failed": "failed: {error}",
    "moving": "{moving} of {finished} deposits are not at rest at the end: {which}",
    "lost": "{volume} m3 left the grid or the box",
    "balance": "the volume in the thickness raster differs from released - off the grid - lost by {share:.1e} of the "
               "released volume",
    "programs": "the runs are of different programs: {what} {which}",
    "no effect": "a repeated variable has no effect, to the last digit, in {which}: left out",
    # of a run and its road, in the metres of its terrain
    "moves": "{file}: the mass was still moving at {seconds:g} s: these are not final numbers",
    "not counted": "{file}: {volume:.6g} m3 of the mass left the grid or the box and are not counted",
    "no terrain": "no --terrain and no {file}: no CRS, coordinates are the local metres of the run",
    "no CRS": "{file} has no CRS: coordinates are {coordinates}",
    "cut off": "{file}: {percent:.3g} % of the polygon lies outside of the grid of the run: cut off",
    "no ground": "{volume:.6g} m3 lie on cells without ground, beside the road: not in the volume to remove",
    "outside of grid": "{file}: {area:.6g} m2 of it lie outside of the grid of the run: counted as false negative",
    "nowhere thicker": "{file} is nowhere thicker than {threshold:g} m",
    "no base": "no {file}, as of a run by an older version: no ground without the body",
    # of where balls came to
    "not arrived": "{file}: {moving} of {balls} balls are faster than {speed:g} m/s: they have not arrived",
    "missing": "{file}: {missing} of {balls} balls of the start are not there: shares of the run-out count them as "
               "beyond all others, all else leaves them out",
    "beyond limits": "{option} {low:g} {high:g}: {outside} of {balls} balls lie beyond these limits",
    # of a slope's stability: bodies of a search, one that failed, fragility
    "in kPa": "--cohesion {value:g}: is it in Pa? Values in kPa are a thousand times smaller",
    "in kN": "--density {value:g}: is it in kg/m3? Values in kN/m3 are about a hundred times smaller",
    "bedrock": "body {body}: --bedrock has no value below {percent:.2g} % of its cells",
    "columns": "body {body} has {value:.0f} cells of the terrain, fewer than {limit:g}: its numbers are rough",
    "terrain": "body {body} is within {limit:g} cells of the edge of the terrain or of cells without a height: a "
               "larger terrain may have a lower factor",
    "within": "body {body} is at the edge of --within: beyond it the factor may be lower",
    "volume low": "body {body} has the least volume that is allowed, {limit:.6g} m3: a smaller body may have a lower "
                  "factor",
    "volume high": "body {body} has the largest volume that is allowed, {limit:.6g} m3: a larger body may have a lower "
                   "factor",
    "depth low": "body {body} has the least depth that is allowed, {limit:.6g} m: a shallower body may have a lower "
                 "factor",
    "depth high": "body {body} has the largest depth that is allowed, {limit:.6g} m: a deeper body may have a lower "
                  "factor",
    "flat": "body {body} is nearly a plane, radius {value:.4g} m for a length of {limit:.4g} m: at the edge of a "
            "search of spheres",
    "wide": "body {body} is {value:.3g} times as wide as a sphere, which is a limit of the search: another width may "
            "have a lower factor",
    "fails": "body {body} has a factor of {value:.3f}, below 1: with these numbers it does not stand",
    "few columns": "the body has {cells} cells, fewer than {limit}: the line is rough",
    "no sphere": "the body is no sphere, and the line depends on the axis of moments: a far one changes the cohesion "
                 "by {percent:+.0f} % without friction",
    "pseudo-static": "pseudo-static: a body that is at F < 1 for an instant with {factor:g} times the peak counts as "
                     "failed, which is {judged}",
    "one record": "one record: how much records differ is not seen, beta_r is 0",
    "at rest": "{which}: {percent:.2g} % of the strengths fail without an earthquake{makes}: if the slope stands, they "
               "are not its own; raise the lower bounds of the strengths",
    "no fit": "{which}: no lognormal fit, the peaks show fewer than three probabilities between 0 and 1",
    "peaks": "{which}: at {peak:g} gal, the {end} of --peaks, {percent:.2g} % fail, and half of the strengths at "
             "{half:.0f} gal: give {remedy} peaks",
    "fit is off": "{which}: the lognormal fit is off by up to {difference:.2f}",
    "HCLPF": "{which}: at the HCLPF {percent:.2g} % fail, the lognormal fit says {fitted:.2g} %: it is too favourable "
             "there",
    "beyond the curve": "{which}: peaks above the hazard curve's last may add up to {per_year:.2g} failures per year",
    # of a study
    "ranks": "{runs} runs of {ranks} ranks at a time on {cores} cores: they slow each other down",
    "size error": "the size error is unknown: {why}",
    "road on body": "{file}: a part of the road lies on the body, and goes with it: the volume to remove does not tell "
                    "what it takes to build the road anew",
}


class _Three(float):
    """A number that is written with three digits where the words ask for none."""

    def __format__(self, spec):
        return format(float(self), spec) if spec else rounded(self, 3)


class Warned(NamedTuple):
    """A warning; kind: of WORDS; numbers: and names, that its words take; runs: concerned, none if it is about all.

    part: of a study, before its words.
    """
    kind: str
    numbers: Mapping[str, Any] = {}
    runs: Sequence[str] = ()
    part: str = ""

    @property
    def text(self) -> str:
        """Its words, without the runs."""
        shown = {name: _Three(value) if isinstance(value, float) else value for name, value in self.numbers.items()}
        return f"{self.part}: " * bool(self.part) + WORDS[self.kind].format(**shown)

    def __str__(self):
        return f"{', '.join(self.runs)}: " * bool(self.runs) + self.text

    def entry(self) -> Dict[str, Any]:
        """What a YAML file and JSON have of it."""
        found = {"kind": self.kind, "text": str(self), "numbers": dict(self.numbers), "runs": list(self.runs),
                 "part": self.part}
        return {key: value for key, value in found.items() if value}


def warned(said: Union[str, Mapping[str, Any], Warned]) -> Warned:
    """The Warned of one, of its entry in a file, or of a line; a file of another version may have unknown kinds."""
    if isinstance(said, Warned):
        return said
    if not isinstance(said, Mapping):
        return Warned(OTHER, {"text": str(said)})
    found = Warned(str(said.get("kind")), said.get("numbers") or {}, tuple(said.get("runs") or ()),
                   str(said.get("part") or ""))
    try:
        str(found)
    except (KeyError, ValueError, TypeError, AttributeError):
        return Warned(OTHER, {"text": str(said.get("text"))})
    return found


def entries(several) -> List[Dict[str, Any]]:
    """The same of several, as a file has them."""
    return [warned(one).entry() for one in several]


# --- on standard error: words, or after `slope --progress json` an object a line ---

as_json = False     # pylint: disable=invalid-name


def say_json(level: str, **values) -> None:
    """level: progress, warning or error."""
    print(json.dumps({"level": level, **values}), file=sys.stderr, flush=True)


def printer(command: str) -> Callable[[Union[str, Warned]], None]:
    """A function that prints a warning of a command."""
    def tell(said):
        if as_json:
            say_json("warning", command=command, **warned(said).entry())
        else:
            print(f"slope {command}: warning: {said}", file=sys.stderr)
    return tell


def warner(command: str, kept: List[str]) -> Callable[[Union[str, Warned]], None]:
    """The same, which keeps the words in a list, too."""
    tell = printer(command)

    def warn(said):
        kept.append(str(said))
        tell(said)
    return warn
