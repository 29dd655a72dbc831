"""A run against a mapped deposit: slope score."""
from pathlib import Path

from .algorithm import Algorithm
from .export import RUN, TERRAIN, prefix_of
from .options import of
from .results import load

OBSERVED = (of("score", "observed", "Mapped deposit, outline", kind="polygons", needed=False),
            of("score", "observed", "Mapped deposit, thickness (m), instead", kind="raster", key="OBSERVED_THICKNESS",
               needed=False))
THRESHOLD = of("score", "threshold", "Thickness above which a cell counts as deposit (m)")


class Score(Algorithm):
    """slope score"""

    command = "score"
    title = "A run against a mapped deposit"
    about = """
    The deposit of a run against a mapped one, an outline or a thickness (m): areas in both and in one of them (m2),
    run-out (m), and, with a thickness, volumes (m3 of ground) and errors per mesh cell.

    Also score.yaml with all numbers, score.csv, one row per cell, and a picture."""
    options = (
        RUN, *OBSERVED, THRESHOLD,
        of("score", "mesh", "Side of the mesh cells of the table (m; default: the run's cells)"),
        TERRAIN,
        of("score", "local", "The mapped deposit is in the local metres of the run, not in a CRS", advanced=True),
        of("score", "output", "Folder for the results", kind="new folder"))
    outputs = (("number", "JACCARD", "Area in both over area in any of both (-)"),
               ("number", "DIFFERENCE", "Run-out, simulated less mapped (m)"),
               ("file", "TABLE", "Table of the cells"), ("file", "PICTURE", "Map"))

    def words(self, asked):
        return [prefix_of(asked), *super().words(asked)]

    def collect(self, asked, results):
        folder = Path(asked.output("OUTPUT"))
        about = load(folder / "score.yaml")
        results.put(OUTPUT=str(folder), JACCARD=about["area"]["jaccard"], DIFFERENCE=about["runout"]["difference"],
                    TABLE=str(folder / "score.csv"), PICTURE=str(folder / "score.png"))
