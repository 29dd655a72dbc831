"""Twin experiments with small collapses of balls: hidden friction, rolling, spacing, found from the mapped thickness.

    LMP=build/lmp /usr/bin/python3 tests/statistics/collapses.py FOLDER [--seeds 10] [--runs 60] [--direct 400]

For each seed a run with hidden values and another lattice is the truth; `slope calibrate` looks for the values by so
many runs, and its 90 % intervals should hold them in 9 of 10 cases. What can be known at all is what --direct runs, the
same for all seeds, say of each truth. About an hour and a half on two cores that have other work, not a part of the
test suite; started again, it goes on.
"""
import argparse
import os
import shlex
import sys
from pathlib import Path

import numpy as np
import yaml

TOP = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(TOP / "tests" / "tools"), str(TOP / "tools")]

from tiny_collapse import LMP, write_case  # noqa: E402  (after the path is set)
from slope_tools import cli, provenance  # noqa: E402
from slope_tools.fitting import observations  # noqa: E402
from slope_tools.statistics import backanalysis, distributions  # noqa: E402
from slope_tools.tables import study_file  # noqa: E402
from slope_tools.tables.rows import finished_of  # noqa: E402

RANGES = {"friction": "10:40", "rolling": "0:0.3", "spacing": "0.5:1.4"}
CLOSE = np.array([2.0, 0.02, 0.1])
VARIABLES = [distributions.distribution(name, text, "--vary", text) for name, text in RANGES.items()]
LOW = np.array([one.low for one in VARIABLES])
WIDTH = np.array([one.high - one.low for one in VARIABLES])
VARY = " ".join(f"--vary {name}={text}" for name, text in RANGES.items())
DECK = "case/in.tiny"
END = "--set steps=3000"


def slope(words):
    """Run `slope WORDS`, quietly."""
    keep, sys.stdout = sys.stdout, open(os.devnull, "w", encoding="ascii")
    try:
        status = cli.main(shlex.split(words))
    finally:
        sys.stdout.close()
        sys.stdout = keep
    if status:
        raise SystemExit(f"slope {words}: status {status}")


def case():
    deck = write_case("case")
    text = deck.read_text()
    for old, new in (("index 150", "index 150\nvariable  xoffset index 0.0\nvariable  spacing index 1.0"),
                     ("sc 1.0", "sc 1.0 origin ${xoffset} 0 0"),
                     ("surface ground upper spacing 1.0", "surface ground upper spacing ${spacing}")):
        assert old in text
        text = text.replace(old, new)
    deck.write_text(text)


def wanted(seed):
    return observations.Wanted(Path(f"truth{seed}.asc"), None, None, None, 0.02, 0.1, True)


def direct(seed):
    """What all direct runs say of a truth."""
    study = study_file.load_study(Path("direct/study.yaml"))
    of, points, outputs = observations.Observations(wanted(seed)), [], []
    for row in finished_of(study.runs):
        points.append([one.unit(row.set[one.name]) for one in VARIABLES])
        outputs.append(of.measure(Path("direct") / row.summary, None, row))
    return backanalysis.posterior(np.array(points), np.array(outputs), of.targets)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    for name, default in (("seeds", 10), ("runs", 60), ("direct", 400)):
        parser.add_argument(f"--{name}", type=int, default=default)
    args = parser.parse_args()
    os.environ["LMP"] = str(Path(os.environ.get("LMP", LMP)).absolute())
    args.folder.mkdir(exist_ok=True)
    os.chdir(args.folder)
    case()
    slope(f"study {DECK} --sample {args.direct} {VARY} --vary xoffset=0:0.99 {END} -o direct")
    good = judged = inside = 0
    for seed in range(args.seeds):
        rng = np.random.default_rng(seed)
        hidden = LOW + WIDTH * (0.2 + 0.6 * rng.random(3))
        values = " ".join(f"--set {one.name}={value:.6g}" for one, value in zip(VARIABLES, hidden))
        slope(f"study {DECK} {values} --set xoffset=0.37 {END} -o truth{seed}")
        Path(f"truth{seed}/envelope_thickness.asc").rename(f"truth{seed}.asc")
        slope(f"calibrate {DECK} --observed truth{seed}.asc --local --tolerance 0.02 {VARY} {END} "
              f"--repeat xoffset=0.25,0.5,0.75 --runs {args.runs} --seed {seed} -o fit{seed}")
        found = yaml.safe_load(Path(f"fit{seed}/calibrate.yaml").read_text())
        best = np.array([found["variables"][name]["best"] for name in RANGES])
        known = direct(seed)
        widths = np.array([np.ptp(known.interval(i)) for i in range(3)]) * WIDTH
        can = widths < 2 * CLOSE
        hit = np.abs(best - hidden) <= CLOSE
        region = np.array([[found["variables"][name][end] for end in ("low", "high")] for name in RANGES])
        within = (region[:, 0] <= hidden) & (hidden <= region[:, 1])
        good += bool(hit[can].all())
        judged += 1
        inside += within.sum()
        print(f"seed {seed}: hidden {hidden.round(3)}, error {(best - hidden).round(3)}; direct runs know it to "
              f"{widths.round(3)}: {'recovered' if hit[can].all() else 'not recovered'} where identifiable "
              f"({can.tolist()}); inside its 90 % intervals {within.tolist()}; words: "
              f"{found['words']}", flush=True)
    print(f"{good} of {judged} recovered where identifiable; {inside} of {judged * len(RANGES)} hidden values inside "
          f"their 90 % intervals; package {provenance.package_version()}")


if __name__ == "__main__":
    main()
