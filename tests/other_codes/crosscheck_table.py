"""The paper's table in several codes: what is to be removed, lies on the road and beyond, at three rolling resistances.

Each code runs the same starts and the same fixed balls, three of them at each rolling resistance. One way of evaluation
serves all codes: the places of the balls at the end go back into the deck, whose fix deposit/grid makes the rasters
that `slope volume` reads. Two codes are compared start by start. The variance of a difference is taken in proportion to
the mean, by all starts together; there is an interval of each mean difference, and a verdict by a bound.

A control runs the first peer with twice the rolling resistance, which the table must find: with balls of 4 m, as larger
ones hide it less.
"""
import math
import re
from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Sequence

import numpy as np
from scipy import stats

from slope_tools import disk
from slope_tools.case import run_folders
from slope_tools.deposits import volume
from slope_tools.errors import SlopeError
from . import peer_runs
from .crosscheck_cases import INPUTS, OTHER_ROLLING as OTHER_LAW, START, Check, deposit, road_corners

DECK_NAME = "20_embankment/in.embankment"
DECK = INPUTS / DECK_NAME
ROAD = INPUTS / "20_embankment" / "road.csv"
ROLLING = 0.0, 0.05, 0.10
STARTS = 0.0, 0.25, 0.5         # of the lattice, in spacings: the repeats
SECONDS = 15.0                  # all have come to rest
CONFIDENCE = 0.95               # of all three intervals of a quantity and a code together
# quantity: unit, share that an interval must be within to agree; the displacement scatters least, and finds a wrong law
QUANTITIES = {"to remove": ("m3", 0.05), "on the road": ("m3", 0.05), "beyond": ("m3", 0.05),
              "displacement of the centroid": ("m", 0.01)}
FILE = "table.csv"
CUT, MESH = 30.0, 5.0           # degrees, m
WRONG = 2                       # times the rolling resistance, in the control
# variables of the deck: the paper's rule; what takes minutes, with which three starts find the control
PAPER: Mapping[str, Any] = {"rule": "paper", "d": 1.25}
QUICK: Mapping[str, Any] = {"rule": "ours", "d": 4.0}


class Difference(NamedTuple):
    """Of the means of two codes, as a share of the second: with its interval."""
    share: float
    low: float
    high: float

    def verdict(self, bound: float) -> str:
        if -bound <= self.low and self.high <= bound:
            return "agrees"
        return "differs" if self.low > bound or self.high < -bound else "cannot tell"


def differences(mine: Sequence[Sequence[float]], other: Sequence[Sequence[float]]) -> List[Difference]:
    """Of a code against another, whose values at each rolling resistance are rows, of the same starts."""
    pairs = [(np.asarray(a, float), np.asarray(b, float)) for a, b in zip(mine, other)]
    free = sum(len(a) - 1 for a, _ in pairs)
    # variance of a difference over the mean of both
    ratio = sum(len(a) * float((a - b).var()) / float((a + b).mean() / 2) for a, b in pairs if (a + b).any()) / free
    quantile = stats.t.ppf(1 - (1 - CONFIDENCE) / (2 * len(pairs)), free)
    found = []
    for a, b in pairs:
        if not b.mean() > 0:
            found.append(Difference(math.nan, -math.inf, math.inf))
            continue
        middle = float((a - b).mean() / b.mean())
        half = float(quantile * math.sqrt(ratio * (a + b).mean() / 2 / len(a)) / b.mean())
        found.append(Difference(middle, middle - half, middle + half))
    return found


def table(work, case):
    """All runs, and their comparison with ours."""
    deck = QUICK if work.quick else PAPER
    codes = [code for code in work.codes if not code.name.startswith("plain")]
    volumes: Dict[str, List[List[Dict[str, float]]]] = {code.name: [] for code in codes}
    for rolling in ROLLING:
        for code in codes:
            volumes[code.name].append([])
        for start in STARTS:
            name = f"{case}_{rolling:g}_{start:g}"
            settings = {**deck, "rolling": rolling, "xoffset": start, "yoffset": start}
            scene = work.scene(name, DECK_NAME, settings)._replace(headroom=30.0)
            found = work.run(name, scene, round(SECONDS / scene.dt), codes=codes)
            for code, (final, _) in found.items():
                volumes[code][-1].append(numbers_of(work, f"{name}.deck", settings, scene, final))
    work.about_table = about(volumes, deck)
    disk.write_file(work.output / FILE, csv_of(work.about_table))
    for row in work.about_table["rows"]:
        if row["verdict"]:
            work.checks.append(check_of(case, row))
    peer = next((code for code in codes[1:] if code.name not in OTHER_LAW), None)
    if peer:
        work.about_table["control"] = rows = control(work, case, peer, volumes["slope"][1:] if work.quick else None)
        found = [f"{row['quantity']} at {row['rolling']:g}" for row in rows if row["verdict"] == "differs"]
        work.checks.append(Check(case, "rolling doubled, as a control", peer.name, "found" if found else "not found",
                                 "SLOPE", "found", 0.0, f"{', '.join(found) or 'nothing'} differs"))


def control(work, case, peer, ours=None) -> List[Dict[str, Any]]:
    """The rows of a peer with a wrong law; ours: our volumes with the same balls, if they are there, of about()."""
    wrong: List[List[Dict[str, float]]] = []
    right: List[List[Dict[str, float]]] = []
    for rolling in ROLLING[1:]:
        wrong.append([])
        right.append([])
        for start in STARTS:
            settings = {**QUICK, "rolling": rolling, "xoffset": start, "yoffset": start}
            name = f"{case}_{rolling:g}_{start:g}" + "_coarse" * (ours is None)
            scene = work.scene(name, DECK_NAME, settings)._replace(headroom=30.0)
            steps = round(SECONDS / scene.dt)
            if ours is None:
                final, _ = work.run(name, scene, steps, codes=work.codes[:1])["slope"]
                right[-1].append(numbers_of(work, f"{name}.deck", settings, scene, final))
            laws = {kind: one._replace(rolling=WRONG * one.rolling) for kind, one in scene.contacts.items()}
            final, _ = work.run(f"{name}_control", scene._replace(contacts=laws), steps, codes=[peer])[peer.name]
            wrong[-1].append(numbers_of(work, f"{name}.deck", settings, scene, final))
    found = about({"slope": ours or right, peer.name: wrong}, QUICK, ROLLING[1:])
    return [row for row in found["rows"] if row["verdict"]]


def check_of(case, row) -> Check:
    """Of a row of about(); a code fails where it clearly differs, one of another law of rolling informs."""
    told = row["verdict"] == "cannot tell" or row["code"] in OTHER_LAW
    unit, bound = QUANTITIES[row["quantity"]]
    reason = (f"{row['mean']:,.6g} {unit}, {100 * row['low']:+.1f} to {100 * row['high']:+.1f} % off SLOPE's "
              f"{row['slope']:,.6g} {unit}, of three starts; within {100 * bound:g} % agrees")
    return Check(case, f"{row['quantity']}, mu_r {row['rolling']:g}", row["code"], row["verdict"], "SLOPE", "agrees",
                 None if told else 0.0, reason)


def about(volumes, deck: Mapping[str, Any], several=ROLLING) -> Dict[str, Any]:
    """What crosscheck.yaml has of it: volumes {code: rows of rolling resistances of repeats of volumes}."""
    rows = []
    for quantity, (unit, bound) in QUANTITIES.items():
        of = {code: [[one[quantity] for one in row] for row in each] for code, each in volumes.items()}
        for code, each in of.items():
            compared: List[Optional[Difference]] = [None] * len(each)
            if code != "slope":
                compared = [*differences(each, of["slope"])]
            for rolling, row, ours, one in zip(several, each, of["slope"], compared):
                rows.append({"quantity": quantity, "unit": unit, "code": code, "rolling": rolling, "runs": row,
                             "mean": float(np.mean(row)), "slope": float(np.mean(ours)),
                             "difference": one and one.share, "low": one and one.low, "high": one and one.high,
                             "verdict": one and one.verdict(bound)})
    return {**deck, "starts": list(STARTS), "seconds": SECONDS, "confidence": CONFIDENCE, "rows": rows}


def csv_of(found) -> str:
    """The rows of about(), a line each."""
    heads = ["quantity", "unit", "code", "rolling", "mean", "difference", "low", "high", "verdict"]
    return disk.csv_text([*heads, *(f"start_{start:g}" for start in STARTS)],
                         ([*(row[head] for head in heads), *row["runs"]] for row in found["rows"]))


def numbers_of(work, folder_name: str, settings, scene, final) -> Dict[str, float]:
    """Of the places of the balls at the end: volumes of the deck's own rasters of them, m3, and how far they went."""
    folder = work.folder(folder_name)
    ids = deck_ids(folder)
    if len(final) != len(ids):
        raise SlopeError(folder, "must be of a run that keeps all balls in its box", f"{len(final)} of {len(ids)}")
    corners = scene.box()
    disk.write_file(folder / "end.dump", "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n" + f"{len(ids)}\n"
                    + "ITEM: BOX BOUNDS ff ff ff\n" + "".join(f"{low} {high}\n" for low, high in zip(*corners))
                    + "ITEM: ATOMS id x y z\n" + "".join(f"{id_} {x!r} {y!r} {z!r}\n" for id_, (x, y, z)
                                                         in zip(ids, final[:, :3].tolist())))
    text = re.sub(r"&[ \t]*\n", " ", DECK.read_text(encoding="ascii"))
    before = re.split(r"^[ \t]*run\b", text, flags=re.MULTILINE)[0]
    before = re.sub(r"^[ \t]*(dump|dump_modify|restart)\b.*$", "", before, flags=re.MULTILINE)
    disk.write_file(folder / "in.end", before + "read_dump end.dump 0 x y z box no\nrun 0\n")
    bulk = run_folders.load_summary(folder / "embankment.summary.yaml", run_folders.OF_DEPOSIT)["bulk_factor"]
    options = [word for pair in {**settings, "bulk": bulk, "out": "end"}.items() for word in ("-var", *map(str, pair))]
    peer_runs.run_deck(work.lmp, folder, "in.end", 1, options)
    found = evaluated(work, folder_name)
    run_, told = found.run, found.about["volume"]
    columns = run_.raster.transform.a * (np.arange(run_.raster.z.shape[1]) + 0.5)
    far = columns < road_corners()[:, 0].min()      # the mass comes from larger x
    return {"to remove": float(told["remove"]), "on the road": float(told["remove_on_road"]),
            "beyond": float(run_.raster.z[:, far].sum() * run_.cell ** 2),
            "displacement of the centroid": deposit(scene, final)["displacement of the centroid m"]}


def evaluated(work, folder_name: str) -> volume.Removal:
    """What is to be removed of the places that numbers_of() took last."""
    folder = work.folder(folder_name)
    return volume.compute_removal(str(folder / "end"), volume.Wanted(ROAD, MESH, CUT, local=True), folder /
                                  "terrain.asc")


def deck_ids(folder) -> List[int]:
    """Of the moving balls, in the order of the states of all codes."""
    lines = (folder / START).read_text().splitlines()
    head = next(i for i, line in enumerate(lines) if line.startswith("ITEM: ATOMS id"))
    return [int(line.split()[0]) for line in lines[head + 1:]]
