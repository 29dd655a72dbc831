#!/usr/bin/env python3
"""Apparent restitution of the balls of in.apparent_restitution: tables (CSV, and printed) and a picture.

    python3 plot.py [OUT ...]         OUT as in the deck's variable out (default bounce)
    python3 plot.py --means OUT ...   runs of several cells: mean rebound over the speed at the start, and its deviation

Writes OUT.table.csv for each OUT, and apparent_restitution.png: the first OUT in detail, the means of all.
"""

import csv
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

SHOWN = (1.0, 1.2, 1.4, 2.0, 3.0)    # spacings whose distributions are drawn


def snapshots(path):
    """The rows of each snapshot of a dump, as arrays."""
    for text in Path(path).read_text(encoding="ascii").split("ITEM: TIMESTEP\n")[1:]:
        columns, rows = text.split("ITEM: ATOMS ")[1].split("\n", 1)
        yield np.array(rows.split(), float).reshape(-1, len(columns.split()))


def flights(out, row, balls):
    """Vertical velocities, m/s: after the first contact; at the start of the first flight that weight ends, or 0."""
    frames = list(snapshots(f"{out}.{row['spacing']}.dump"))
    vz = np.full((len(frames), balls), np.nan)
    for frame, snapshot in zip(vz, frames):
        frame[snapshot[:, 0].astype(int) - 1] = snapshot[:, 1]
    free, ball = np.isfinite(vz), np.arange(balls)
    # a flight is first seen half an interval late, on the average
    began = vz + 0.5 * float(row["g"]) * float(row["tdump"])
    begins = free & ~np.vstack([np.zeros_like(free[:1]), free[:-1]])
    begin = np.maximum.accumulate(np.where(begins, np.arange(len(vz))[:, None], 0), axis=0)
    apex = (vz[:-1] >= 0) & (vz[1:] < 0)
    top = apex.argmax(axis=0)
    return (np.where(free.any(axis=0), began[free.argmax(axis=0), ball], np.nan),
            np.where(apex.any(axis=0), began[begin[top, ball], ball], 0))


def means(out):
    """A line for each spacing: mean first rebound over the speed at the start, and its standard deviation."""
    with open(f"{out}.csv", newline="", encoding="ascii") as rows:
        for row in csv.DictReader(rows):
            start, = snapshots(f"{out}.{row['spacing']}.start.dump")
            rebound = flights(out, row, len(start))[1] / abs(start[0, 4])
            yield f"{out}, s/d {row['spacing']}: {rebound.mean():.3f} ({rebound.std():.3f})"


class Drop:
    """The balls at one spacing: where they touch first, and vertical velocities over that of the first touch.

    r: horizontal distance of the first touch from the middle of the fixed ball, over d; >= 1 is on the floor
    first: after the first contact, up or down
    rebound: at the start of the first flight that rises until weight ends it, not another ball; 0 if there is none
    closed: e cos^2(b) - sin^2(b), for what does not fall on the floor
    alone: touches one fixed ball and, if it were hard, no other one in twice the time of a contact
    """

    def __init__(self, out, row):
        self.spacing, self.e, self.friction = (float(row[key]) for key in ("spacing", "e", "friction"))
        d, g = float(row["d"]), float(row["g"])
        start, = snapshots(f"{out}.{row['spacing']}.start.dump")
        at = start[:, 1:3] / d
        self.r = np.hypot(*at.T)
        self.closed = self.e * (1 - self.r ** 2) - self.r ** 2
        height = np.sqrt(np.clip(1 - self.r ** 2, 0, None))
        impact = np.sqrt(start[:, 4] ** 2 + 2 * g * (start[:, 3] - d * height))
        self.alone = self.is_alone(np.column_stack([at, height]), impact * 2 * float(row["contact"]) / d)

        first, rebound = flights(out, row, len(start))
        self.first, self.rebound = first / impact, rebound / impact

    def is_alone(self, place, way):
        """place: of the first touch; way: what a ball travels at the speed of impact; both over d."""
        speed = np.outer(np.ones(len(place)), [0, 0, -1.0])
        speed += ((1 + self.e) * place[:, 2])[:, None] * place       # the normal is the place itself
        cells = np.arange(-3, 4)
        others = [(self.spacing * i, self.spacing * j, 0) for i in cells for j in cells if i or j]
        along = place + np.linspace(0, 1, 30)[:, None, None] * (way[:, None] * speed)
        clear = np.min([np.linalg.norm(along - other, axis=2).min(axis=0) for other in others], axis=0) > 1.02
        return (self.r < 1) & clear & (along[:, :, 2].min(axis=0) > 0.02)

    def table(self):
        """Name and value of each column of the table."""
        error = np.abs(self.first - self.closed)[self.alone]
        p5, p50, p95 = np.percentile(self.rebound, (5, 50, 95))
        return {"spacing": self.spacing, "balls": len(self.r), "mean": self.rebound.mean(), "sd": self.rebound.std(),
                "p5": p5, "p50": p50, "p95": p95, "no_rebound": (self.rebound == 0).mean(),
                "first_impact_mean": np.nanmean(self.first), "first_impact_sd": np.nanstd(self.first),
                "first_impact_up": (self.first > 0).mean(), "first_on_floor": (self.r >= 1).mean(),
                "alone": int(self.alone.sum()), "median_error": np.median(error) if len(error) else np.nan,
                "largest_error": error.max() if len(error) else np.nan}


def read(out):
    """The Drops of a run of the deck."""
    with open(f"{out}.csv", newline="", encoding="ascii") as rows:
        return [Drop(out, row) for row in csv.DictReader(rows)]


def write_table(out, drops):
    with open(f"{out}.table.csv", "w", newline="", encoding="ascii") as table:
        writer = csv.writer(table, lineterminator="\n")
        writer.writerow(drops[0].table())
        for drop in drops:
            writer.writerow(f"{value:.4g}" for value in drop.table().values())
    print(Path(f"{out}.table.csv").read_text(encoding="ascii"), end="")


def draw(runs):
    figure, (ball, share, means) = plt.subplots(1, 3, figsize=(13, 4.2))
    drops = next(iter(runs.values()))
    r = np.linspace(0, 1, 101)
    ball.plot(r, drops[0].e * (1 - r ** 2) - r ** 2, "k", linewidth=1, zorder=3, label="e cos$^2$b - sin$^2$b")
    for name, alone in (("several contacts", False), ("one contact", True)):
        kept = [(drop, (drop.alone == alone) & (drop.r < 1)) for drop in drops]
        ball.plot(*(np.concatenate([getattr(drop, what)[keep] for drop, keep in kept]) for what in ("r", "first")),
                  ".", markersize=3, label=name)
    ball.set(title=f"after the first contact, e {drops[0].e:g}, friction {drops[0].friction:g}", xlabel="r / d = sin b",
             ylabel="vertical velocity / that of impact", ylim=(-1.05, 0.55))
    ball.legend(fontsize=8, loc="lower left")

    for drop in drops:
        if drop.spacing in SHOWN:
            share.plot(np.sort(drop.rebound), (np.arange(len(drop.rebound)) + 0.5) / len(drop.rebound), linewidth=1.2,
                       label=f"s/d = {drop.spacing:g}")
    share.set(title="first rebound", xlabel="apparent restitution", ylabel="cumulative share", ylim=(0, 1))
    share.set_xlim(0, 2 * drops[0].e)
    share.legend(fontsize=8)

    for run in runs.values():
        x, mean, sd = np.transpose([(drop.spacing, drop.rebound.mean(), drop.rebound.std()) for drop in run])
        line, = means.plot(x, mean, "o-", markersize=4, label=f"e {run[0].e:g}, friction {run[0].friction:g}")
        if run is drops:
            means.fill_between(x, mean - sd, mean + sd, alpha=0.2, color=line.get_color(), label="its spread (sd)")
    means.set(title="mean of the first rebound", xlabel="spacing s/d", ylabel="apparent restitution")
    means.set_ylim(0, 1.6 * means.get_ylim()[1])
    means.legend(fontsize=8, loc="upper left")
    figure.tight_layout()
    figure.savefig("apparent_restitution.png", dpi=80)


def main():
    alone = sys.argv[1:2] == ["--means"]
    outs = sys.argv[2:] if alone else sys.argv[1:] or ["bounce"]
    for out in outs:
        if not Path(f"{out}.csv").is_file():
            sys.exit(f"plot.py: no {out}.csv here, run lmp -in in.apparent_restitution -var out {out} first")
    if alone:
        print("\n".join(line for out in outs for line in means(out)))
        return
    runs = {out: read(out) for out in outs}
    for out, drops in runs.items():
        write_table(out, drops)
    draw(runs)


if __name__ == "__main__":
    main()
