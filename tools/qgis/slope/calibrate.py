"""The values of a deck's variables that give a deposit that was mapped: slope calibrate."""
from pathlib import Path

from .algorithm import Algorithm
from .options import Option, of
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
        of("calibrate", "front", "How far the mass went, in plan from the highest released ball (m)"),
        of("calibrate", "front_is", "What of a run is compared with it", advanced=True),
        of("calibrate", "area", "Area that was covered at any time (m2)"),
        of("calibrate", "road_volume", "Volume on the road (m3)", key="VOLUME"),
        of("calibrate", "road", "Road, for that volume", kind="road"), ROAD_WIDTH, CUT_ANGLE, MESH,
        of("calibrate", "tolerance",
           "Standard deviation of what was observed, as a share of it (default: 0.05), or NAME=SHARE per line",
           kind="words", advanced=True),
        THRESHOLD,
        of("calibrate", "vary", "Ranges of the deck's variables, one NAME=LO:HI per line", kind="words"),
        of("calibrate", "runs", "Number of runs", default=40),
        of("calibrate", "set", "Values of other variables, one NAME=VALUE per line", kind="words"),
        of("calibrate", "repeat", "Repeats, one NAME=V1,V2,... per line", kind="words"),
        of("calibrate", "seed", "Seed of the first runs (default: 1)", default=None, advanced=True), RANKS, JOBS,
        of("calibrate", "local", "The road is in the local metres of the run, not in a CRS", advanced=True),
        of("calibrate", "output", "Folder of the study", kind="new folder"))
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
