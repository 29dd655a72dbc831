#!/usr/bin/python3
"""What fix wall/gran/mesh costs: user time of 1,000 steps of 21,000 balls on a floor.

field: on fixed balls; mesh: with a mesh of 100,352 triangles around them that none touches; smooth: on a smooth
terrain in place of the fixed balls.  Usage: tests/mesh_cost.py LMP FOLDER [REPEATS]
"""

import re
import resource
import subprocess
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent / "decks"))
from deck_helpers import write_asc  # noqa: E402
from mesh_helpers import bowl, mesh_deck, rule_step, write_case  # noqa: E402

FIELD = "fix field all wall/gran/balls 2 1.0 file floor.xyz\n"
WALLS = {"field": FIELD, "mesh": FIELD + "fix wall all wall/gran/mesh 2 mesh.stl",
         "smooth": "fix wall all wall/gran/mesh 2 terrain flat.asc"}


def write_decks(folder):
    grid = np.array([(i, j, k) for k in range(10) for j in range(42) for i in range(50)], float)
    x = (grid - (24.5, 20.5, 0)) * 1.02 + (0, 0, 0.52) + np.random.default_rng(1).uniform(-0.004, 0.004, grid.shape)
    write_case(folder, bowl(45.0, 112) + np.array([0, 0, 15.0]), x, (0, 0, 0), box_size=80.0)
    write_asc(folder / "flat.asc", np.zeros((160, 160)), -80.0, -80.0)
    np.savetxt(folder / "floor.xyz", [(i, j, -0.5) for i in range(-60, 61) for j in range(-60, 61)])
    for name, wall in WALLS.items():
        deck = mesh_deck("run ${n}", wall=wall, exclude=False, g=9.81, columns="ke", every=1000, dt=rule_step(0.8),
                         coeff="restitution 0.4 friction 30 rolling 0.1")
        (folder / f"in.{name}").write_text(re.sub(r"dump.*\n", "", deck))


def user_time(lmp, folder, name, steps):
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    command = [lmp, "-in", f"in.{name}", "-var", "n", str(steps), "-log", f"log.{name}"]
    subprocess.run(command, cwd=folder, check=True, stdout=subprocess.DEVNULL)
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before


def main():
    lmp, folder = Path(sys.argv[1]).resolve(), Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    write_decks(folder)
    for _ in range(int(sys.argv[3]) if len(sys.argv) > 3 else 3):
        times = {name: user_time(lmp, folder, name, 1000) - user_time(lmp, folder, name, 0) for name in WALLS}
        print("  ".join(f"{name} {time:.2f} s" for name, time in times.items()), flush=True)


if __name__ == "__main__":
    main()
