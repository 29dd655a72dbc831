"""A deck, or a site, over lists of values: slope study."""
import datetime
from pathlib import Path

from qgis.core import QgsProcessingException

from .algorithm import Algorithm
from .options import Option, of
from .results import load
from .volume import CLEARING, CUT_ANGLE, MESH

DECK = Option("DECK", "", "file", "Deck, or site.yaml of a site", needed=True)
RANKS = of("study", "np", "MPI ranks of each run", key="RANKS")
JOBS = of("study", "jobs", "Runs at a time (default: as many as the cores allow)")
NOT_CONSERVATIVE = {"floor": "AT_LEAST", "open": "NO_BOUND"}     # kinds of numbers
WITH_A_SITE = ("RANKS", "JOBS")     # all other choices are in its site.yaml


class Study(Algorithm):
    """slope study"""

    command = "study"
    title = "Study"
    about = """
    One deck over lists of its variables, several runs at a time; each run has a folder of its own, and the same
    call continues after an interruption.

    Values: one NAME=V1,V2,... per line; A:B:STEP stands for A, A + STEP, ... up to B. Repeats name what is
    chance (a variable called seed, packing or ...offset), and give the scatter. Of a site, take site.yaml: it says
    all of this, and the site's folder gets the results.

    Layers: largest thickness over all runs (m), and the share of the runs with a deposit thicker than 0.1, 0.5,
    1 m. Tables study.csv and combinations.csv: volumes in m3 of ground, lengths in m, times in s."""
    options = (
        DECK,
        of("study", "set", "Values of the deck's variables, one NAME=V1,V2,... per line", kind="words"),
        of("study", "repeat", "Repeats, one NAME=V1,V2,... per line", kind="words"),
        of("study", "road", "Road: the volume to remove from it", kind="road"),
        *CLEARING, CUT_ANGLE, MESH, RANKS, JOBS,
        of("study", "exceed", "Thicknesses of the maps of exceedance, with commas between (m)", default="0.1,0.5,1",
           advanced=True),
        of("study", "local", "The road is in the local metres of the run, not in a CRS", advanced=True),
        of("study", "output", "Folder of the study", kind="new folder"))
    outputs = (("raster", "THICKNESS", "Largest final thickness over all runs (m)"),
               ("raster", "MAX_THICKNESS", "Largest thickness over all runs and times (m)"),
               ("number", "CONSERVATIVE", "Conservative volume to remove (m3)"),
               ("number", "AT_LEAST", "Volume to remove, at least (m3)"),
               ("number", "NO_BOUND", "Volume to remove by these runs, no bound (m3)"),
               ("file", "TABLE", "Table of all runs"),
               ("file", "REPORT", "Report of a site"))

    def site(self, asked):
        """The folder of the site if the deck is a site.yaml, else None."""
        path = Path(asked.text(DECK.key))
        return path.parent if path.name == "site.yaml" else None

    def words(self, asked):
        folder = self.site(asked)
        if folder is None:
            return super().words(asked)
        for option in self.options:
            value = asked.parameters.get(option.key)
            if option.key not in (DECK.key, "OUTPUT", *WITH_A_SITE) and value not in (None, "", False, option.default):
                raise QgsProcessingException(f"{option.key}: must not be given with a site, whose site.yaml has it")
        return [str(folder), *(word for option in self.options if option.key in WITH_A_SITE
                               for word in option.words(asked)), *self.extra(asked)]

    def collect(self, asked, results):
        folder = self.site(asked)
        shown = governing(folder) if folder else Path(asked.output("OUTPUT"))
        show(shown, results)
        if folder:
            page = next((path for path in (folder / "report.html", shown / "report.html") if path.exists()), None)
            results.put(REPORT=page and str(page))


def governing(site):
    """The folder of the study of a site that has its number: what both files say, or else the one made last by them."""
    there = {site / name: load(site / name / "study.yaml")["study"] for name in ("ensemble", "study")
             if (site / name / "study.yaml").exists()}
    names = {about.get("governs") for about in there.values()}
    named = [folder for folder in there if names == {folder.name}]
    return named[0] if named else max(there, key=lambda folder: made(there[folder]))


def made(about):
    """When a study was made."""
    return datetime.datetime.fromisoformat(about["collected"]).astimezone(datetime.timezone.utc)


def show(folder, results):
    """The layers and numbers of a study's folder."""
    about = load(folder / "study.yaml")
    for one in reversed(about["exceedance"] or []):
        results.layer(None, place(folder, one), "exceedance", f"share of runs above {one['threshold_m']:g} m")
    for kind, one in (about["envelope"] or {}).items():
        results.layer(kind.upper(), place(folder, one), "thickness", one["what"])
    number = about.get("headline") or about.get("conservative") or {}
    results.put(OUTPUT=str(folder), TABLE=str(folder / "study.csv"),
                **{NOT_CONSERVATIVE.get(number.get("kind"), "CONSERVATIVE"): number.get("volume_m3")})


def place(folder, one):
    """The GeoTIFF of a map where the study's place is known, else the .asc."""
    path = folder / one["file"]
    return path.with_suffix(".tif") if path.with_suffix(".tif").is_file() else path
