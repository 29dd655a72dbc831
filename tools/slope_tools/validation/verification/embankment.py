"""How much of the 18 m body is released where its slip balls lie on the slip surface

inputs/20_embankment, at the start; the study of the case has its own numbers (paper_table.py).
"""
import math
import re
from typing import Tuple

import yaml

from .claims import Claim, Run, Seen

CASE = "20_embankment"
START = Run("20_embankment/in.embankment")(rule="ours", sink=0, bulk=f"{6 / math.pi:.13f}", duration=0.001)
CLAIMS: Tuple[Claim, ...] = ()      # the site is not the paper's


def released(result):
    """m3 of ground, a ball counting as a cube as wide as itself."""
    return yaml.safe_load((result.folder / "embankment.summary.yaml").read_text())["volume"]["released"]


def removed(result):
    """Number of balls that would start inside slip balls, and of all."""
    found, = re.findall(r"^Delete_balls: (\d+) balls .* removed .*; (\d+) balls left", result.log, re.MULTILINE)
    return int(found[0]), sum(map(int, found))


SEEN = [Seen(f"on_slip.{d}", (START(d=d),), released) for d in (1.25, 2.5, 4)]
SEEN += [Seen(f"on_slip.1.25.{name}", (START(d=1.25),), lambda result, k=k: removed(result)[k])
         for k, name in enumerate(("removed", "balls"))]
