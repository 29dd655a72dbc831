"""A record of an earthquake as the motion of the ground that decks read: slope quake."""
from .algorithm import Algorithm
from .options import Option, of
from .results import load


class Quake(Algorithm):
    """slope quake"""

    command = "quake"
    title = "Motion of the ground from a record"
    about = """
    Strong-motion records (NIED, PEER, ESM, AFAD, CWA, JMA, GeoNet, CSV) as the acceleration of the ground (s, m/s2)
    that decks and the algorithms Site and Fragility read: one file for each component, or one with all of them.

    The largest horizontal acceleration, of both components together, can be set (gal), or all of it scaled. The ground
    ends at rest where it began unless another baseline is wanted. The deck's x axis is east unless it has another
    compass bearing (degrees).

    Beside the motion: its numbers (.yaml), response spectrum (.spectrum.csv, s and gal) and a picture (.png)."""
    options = (
        Option("RECORD", "", "files", "Files of one record", needed=True),
        of("quake", "peak", "Largest horizontal acceleration (gal)"),
        of("quake", "scale", "Scale by this factor, instead", least=-1000000.0, advanced=True),
        of("quake", "azimuth", "Compass bearing of the deck's x axis (degrees; default: 90)", default=None),
        of("quake", "window", "Part of the record: begin and end (s)", kind="numbers"),
        of("quake", "band", "Band-pass: low and high frequency (Hz)", kind="numbers"),
        of("quake", "baseline", "Baseline (default: rest)", default=None, advanced=True),
        of("quake", "unit", "Unit of a CSV that names none", advanced=True),
        of("quake", "output", "The motion", kind="new file", filter="Motion (*.txt)"))
    outputs = (("number", "LARGEST", "Largest horizontal acceleration (gal)"), ("file", "NUMBERS", "Numbers, YAML"),
               ("file", "SPECTRUM", "Response spectrum, CSV"), ("file", "PICTURE", "Motion and spectrum"))

    def collect(self, asked, results):
        motion = asked.output("OUTPUT")
        stem = motion.rsplit(".", 1)[0]
        results.put(OUTPUT=motion, LARGEST=load(f"{stem}.yaml")["peak_gal"], NUMBERS=f"{stem}.yaml",
                    SPECTRUM=f"{stem}.spectrum.csv", PICTURE=f"{stem}.png")
