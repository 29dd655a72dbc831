"""How likely bodies fail at a peak acceleration: slope fragility."""
from pathlib import Path

from .algorithm import Algorithm
from .options import Option, of
from .results import load


class Fragility(Algorithm):
    """slope fragility"""

    command = "fragility"
    title = "Fragility in earthquakes"
    about = """
    How likely the bodies of the algorithm Slip surfaces fail at a peak acceleration (gal), and with a hazard curve, how
    often per year.

    Strengths are distributions: cohesion (Pa) and friction (degrees) as a number, LO:HI, normal:MEAN:DEVIATION:LO:HI,
    lognormal:MEDIAN:DEVIATION_OF_LN:LO:HI. A body fails if it slides farther than a displacement (m) in one of the
    motions, each scaled to the peak; or, without motions, if its factor of safety is below 1 with a constant
    acceleration.

    Tables fragility.csv and fragility.yaml, and a picture."""
    options = (
        Option("SLIPS", "", "folder", "Folder of the slip surfaces", needed=True),
        of("fragility", "density", "Density of the bodies (kg/m3; default: as in the search)", advanced=True),
        of("fragility", "cohesion", "Cohesion (Pa), a number or a distribution"),
        of("fragility", "friction", "Friction angle (degrees), a number or a distribution"),
        of("fragility", "water", "Pore pressure over the weight per area (-), a number or a distribution (default: "
           "the water of the search)"),
        of("fragility", "correlation", "Between cohesion and friction, -1 to 1 (-)", default=None, least=-1.0,
           advanced=True),
        of("fragility", "peaks", "Peak accelerations LO:HI or LO:HI:STEP (gal)"),
        of("fragility", "record", "Motions of the ground, as slope quake wrote them (s, m/s2)", kind="files"),
        of("fragility", "vertical", "With the vertical component of the motions", advanced=True),
        of("fragility", "displacement", "A body fails if it slides farther than this (m; default: 0.1)"),
        of("fragility", "pseudo_static", "Instead of motions: this share of the peak, constant (-)"),
        of("fragility", "hazard", "Hazard curve: peak (gal) and exceedance per year", filter="Table (*.csv)"),
        of("fragility", "sample", "Samples of the strength (default: 4096)", default=None, advanced=True),
        of("fragility", "seed", "Seed of the samples (default: 1)", default=None, advanced=True),
        of("fragility", "output", "Folder for the results", kind="new folder"))
    outputs = (("number", "MEDIAN", "Peak at which failure is as likely as not (gal)"),
               ("number", "FREQUENCY", "Failures per year"), ("file", "TABLE", "Curves, CSV"),
               ("file", "NUMBERS", "Numbers, YAML"), ("file", "PICTURE", "Curves"))

    def collect(self, asked, results):
        folder = Path(asked.output("OUTPUT"))
        last = load(folder / "fragility.yaml")["curves"][-1]        # of any body
        results.put(OUTPUT=str(folder), MEDIAN=(last["lognormal"] or {}).get("median_gal"),
                    FREQUENCY=(last.get("annual_frequency") or {}).get("value"),
                    TABLE=str(folder / "fragility.csv"), NUMBERS=str(folder / "fragility.yaml"),
                    PICTURE=str(folder / "fragility.png"))
