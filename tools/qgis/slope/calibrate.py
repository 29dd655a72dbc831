"""The values of a deck's variables that give a deposit that was mapped: slope calibrate."""
from pathlib import Path

from .algorithm import Algorithm
from .options import Option
from .results import load
from .score import OBSERVED, THRESHOLD
from .study import JOBS, RANKS
from .volume import CUT_ANGLE, MESH, ROAD_WIDTH


class Calibrate(Algorithm):
    """slope calibrate"""

    command = "calibrate"
    title = "Calibration"
    about = """
    Which values of a deck's variables give a deposit that was observed, and how well they are known. Observed: its
    outline or thickness (m), how far it went (m), the area that it covered (m2), the volume on the road (m3); one of
    them at least.

    Ranges: one NAME=LO:HI per line. The same call continues after an interruption; more runs add to the existing ones.

    Tables calibrate.csv and calibrate.yaml; pictures of the regions over pairs of variables, and of the prediction
    against the map."""
    options = (
        Option("DECK", "", "file", "Deck", needed=True), *OBSERVED,
        Option("FRONT", "--front", "number", "How far the mass went, in plan from the highest released ball (m)"),
        Option("FRONT_IS", "--front-is", "choice", "What of a run is compared with it (default: connected)",
               choices=("connected", "95", "99"), advanced=True),
        Option("AREA", "--area", "number", "Area that was covered at any time (m2)"),
        Option("VOLUME", "--road-volume", "number", "Volume on the road (m3)"),
        Option("ROAD", "--road", "road", "Road, for that volume"), ROAD_WIDTH, CUT_ANGLE, MESH,
        Option("TOLERANCE", "--tolerance", "words", "Standard deviation of what was observed, as a share of it "
               "(default: 0.05), or NAME=SHARE per line", advanced=True),
        THRESHOLD,
        Option("VARY", "--vary", "words", "Ranges of the deck's variables, one NAME=LO:HI per line", needed=True),
        Option("RUNS", "--runs", "whole", "Number of runs", 40, needed=True, least=1),
        Option("SET", "--set", "words", "Values of other variables, one NAME=VALUE per line"),
        Option("REPEAT", "--repeat", "words", "Repeats, one NAME=V1,V2,... per line"),
        Option("SEED", "--seed", "whole", "Seed of the first runs (default: 1)", advanced=True), RANKS, JOBS,
        Option("LOCAL", "--local", "switch", "The road is in the local metres of the run, not in a CRS", advanced=True),
        Option("OUTPUT", "-o", "new folder", "Folder of the study"))
    outputs = (("text", "BEST", "Best values, NAME=VALUE"), ("file", "TABLE", "Table of all runs"),
               ("file", "NUMBERS", "Numbers, YAML"), ("file", "PICTURE", "Regions over pairs of variables"),
               ("file", "MAP", "Prediction against the map"))

    def collect(self, asked, results):
        folder = Path(asked.output("OUTPUT"))
        best = load(folder / "calibrate.yaml")["best"]["set"]
        predicted = folder / "predicted.png"
        results.put(OUTPUT=str(folder), BEST=" ".join(f"{name}={value}" for name, value in best.items()),
                    TABLE=str(folder / "calibrate.csv"), NUMBERS=str(folder / "calibrate.yaml"),
                    PICTURE=str(folder / "calibrate.png"), MAP=str(predicted) if predicted.is_file() else None)
