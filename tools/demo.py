#!/usr/bin/python3
"""Table and picture of the study that tools/demo.sh runs: demo.py OUT ROLLING..."""
import sys
from pathlib import Path

import matplotlib
matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
import yaml
from rich.console import Console
from rich.table import Table

from slope_tools import rasters

ROAD = (60.0, 80.0)     # inputs/20_embankment: x of the road's edges, m


def load(folder):
    """Summary, deposit thickness (m) and final surface (m) of one run."""
    summary = yaml.safe_load((folder / "embankment.summary.yaml").read_text())
    return (summary, rasters.read(folder / "embankment.thickness.asc"),
            rasters.read(folder / "embankment.surface.asc"))


def main(out, rolling):
    out = Path(out)
    runs = {r: load(out / f"rolling_{r}") for r in rolling}
    terrain = rasters.read(out / f"rolling_{rolling[0]}" / "terrain.asc")

    table = Table(title="Collapse of inputs/20_embankment, balls of 2.5 m; volumes in m3 of ground")
    for head in ("rolling", "released", "on the road", "beyond it", "lost", "balance", "time s"):
        table.add_column(head, justify="right")
    for r, (summary, thickness, _) in runs.items():
        x = thickness.transform.c + thickness.transform.a * (np.arange(thickness.z.shape[1]) + 0.5)
        column = thickness.z.sum(axis=0) * thickness.transform.a**2
        volume = summary["volume"]
        table.add_row(r, f"{volume['released']:.0f}", f"{column[(x > ROAD[0]) & (x < ROAD[1])].sum():.0f}",
                      f"{column[x < ROAD[0]].sum():.0f}", f"{volume['lost']:.0f}", f"{volume['residual']:.1e}",
                      f"{summary['time']:.1f}")
    Console(width=100).print(table)

    figure, axes = plt.subplots(2, len(runs), figsize=(4.6 * len(runs), 5.4), squeeze=False,
                                constrained_layout=True, height_ratios=[2, 1])
    light = matplotlib.colors.LightSource(azdeg=315, altdeg=40)
    rows, columns = terrain.z.shape
    cell = terrain.transform.a
    extent = (terrain.transform.c, terrain.transform.c + columns * cell,
              terrain.transform.f - rows * cell, terrain.transform.f)
    highest = max(thickness.z.max() for _, thickness, _ in runs.values())
    for (r, (summary, thickness, surface)), top, below in zip(runs.items(), axes[0], axes[1]):
        top.imshow(light.hillshade(terrain.z, vert_exag=1.5, dx=cell, dy=cell), cmap="gray", extent=extent)
        picture = top.imshow(np.ma.masked_less(thickness.z, 0.05), extent=extent, alpha=0.8, cmap="YlOrBr",
                             vmin=0.0, vmax=highest)
        for edge in ROAD:
            top.axvline(edge, color="tab:blue", lw=1)
        top.set(title=f"rolling resistance {r}: at rest after {summary['time']:.1f} s", xlabel="x (m)", ylabel="y (m)")
        middle = rows // 2
        x = extent[0] + cell * (np.arange(columns) + 0.5)
        below.plot(x, terrain.z[middle], "k", lw=1, label="before")
        below.plot(x, surface.z[middle], "saddlebrown", lw=1.5, label="after")
        below.fill_between(x, (surface.z - thickness.z)[middle], surface.z[middle], color="burlywood", label="deposit")
        below.axvspan(*ROAD, color="tab:blue", alpha=0.2, lw=0, label="road")
        below.set(xlabel="x (m)", ylabel="height (m)", aspect=1.5)
        below.legend(fontsize=7, loc="upper left")
    figure.colorbar(picture, ax=axes[0], label="thickness (m)", shrink=0.8)
    figure.savefig(out / "demo.png", dpi=110)
    print(f"picture: {out / 'demo.png'}")


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2:])
