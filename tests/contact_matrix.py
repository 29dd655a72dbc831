#!/usr/bin/python3
"""The long check of the contact law: one table of all that must hold at the rule's time step, for one lmp.

    LMP=build/lmp python3 tests/contact_matrix.py --quick          # a minute or two
    LMP=build/lmp python3 tests/contact_matrix.py                  # hours: the heaps
    ... --only impacts,gas,slot       ... --scheme plain       ... --part 0.5      ... --cells 5

Runs the decks of inputs/ by the readers of `slope verify`, whose claims hold the same limits, each with its control.
Here all numbers stand side by side, also where they do not hold. The exit status is 0 if all hold, else 1.
"""
import argparse
import os
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent / "tools"), str(HERE / "decks")]

from slope_tools.validation import verify  # noqa: E402
from slope_tools.validation.verification import energy, resting_heap, rough_gas, sticking_impact  # noqa: E402

GAS, SLOT = rough_gas.GAS, rough_gas.SLOT


class Table:
    """Lines of name, got, limit; how many do not hold."""

    def __init__(self):
        self.wrong = self.count = 0

    def line(self, name, got, limit, more=""):
        """got must be at most limit."""
        holds = bool(got <= limit)
        self.count += 1
        self.wrong += not holds
        print(f"  {'ok  ' if holds else 'FAIL'} {name:<46} {got:10.4g}  <= {limit:<8g} {more}", flush=True)

    def matrix(self, title, measures, bad, kinds, more):
        """One line of the largest of each measure, and of how many kinds of impact are beyond its limit."""
        self.count += len(bad)
        self.wrong += sum(map(bool, bad))
        cells = (f"{values.max():.4f} ({beyond})" if beyond else f"{values.max():.4f}"
                 for values, beyond in zip(measures, bad))
        print(f"  {'FAIL' if any(bad) else 'ok  '} {title:<23}" + "".join(f"{cell:>16}" for cell in cells)
              + f"  {more}", flush=True)


IMPACT_LIMITS = 0.02, 0.04, 0.02, 0.04, 1e-3, 0.002


def where(errors, values):
    """The case in which a value is largest."""
    law, angle = np.unravel_index(np.argmax(values), values.shape)
    case = errors.case
    return (f"worst {case.angle[law, angle]:g} degrees, friction {case.friction[law, 0]:g}, e {case.e[law, 0]:g}; "
            f"beta {errors.got['beta'][law, angle].mean():.3f} for {errors.wanted.beta[law, angle]:.3f}")


def one_matrix(table, title, runner, run, cells):
    errors = sticking_impact.Errors(runner.result(run))
    spin = {kind: np.maximum(getattr(errors, kind)["spin"], getattr(errors, kind)["partner_spin"])
            for kind in ("mean", "largest")}
    measures = (errors.mean["beta"], errors.largest["beta"], spin["mean"], spin["largest"],
                errors.largest["restitution"], errors.gain)
    bad = [int((values > limit).sum()) for values, limit in zip(measures, IMPACT_LIMITS)]
    table.matrix(title, measures, bad, errors.gain.size,
                 f"{errors.together} HAVE NOT ENDED" if errors.together else where(errors, errors.mean["beta"]))
    off = errors.mean["beta"]
    for _, law, angle in sorted(((off[at], *at) for at in np.ndindex(off.shape)), reverse=True)[:cells]:
        print(f"       {errors.case.angle[law, angle]:3g} degrees, friction {errors.case.friction[law, 0]:3g}, "
              f"e {errors.case.e[law, 0]:4g}: beta {errors.got['beta'][law, angle].mean():7.3f} "
              f"({errors.got['beta'][law, angle].min():.3f} to {errors.got['beta'][law, angle].max():.3f}) "
              f"for {errors.wanted.beta[law, angle]:7.3f}; gain {errors.gain[law, angle]:.4f}")


def head(title):
    """Of a table of matrices."""
    print(f"{title}: largest of 252 kinds of impact, by 20 times within a step (kinds beyond the limit)")
    names = ("beta mean", "beta most", "spin mean", "spin most", "e", "gain")
    print(" " * 30 + "".join(f"{name:>16}" for name in names))
    print(f"{'limit':>30}" + "".join(f"{limit:16g}" for limit in IMPACT_LIMITS))


def impacts(table, runner, args):
    head("impacts")
    for partner in sticking_impact.PARTNERS:
        for name, ratio in sticking_impact.RATIOS.items():
            one_matrix(table, f"{partner}, kt/kn {name}", runner,
                       sticking_impact.MATRIX(partner=partner, ktkn=ratio, **args.settings), args.cells)


def spins(table, runner, args):
    head("impacts of a spinning ball, kt/kn 1")
    for partner in sticking_impact.PARTNERS:
        for spin in (-0.5, 1.5):
            one_matrix(table, f"{partner}, R w/v {spin}", runner,
                       sticking_impact.MATRIX(partner=partner, spin=spin, **args.settings), args.cells)


def rolling(table, runner, args):
    head("impacts with rolling resistance 0.1")
    for partner in sticking_impact.PARTNERS:
        for name in ("2/7", "1"):
            one_matrix(table, f"{partner}, kt/kn {name}", runner,
                       sticking_impact.MATRIX(partner=partner, ktkn=sticking_impact.RATIOS[name], rolling=0.1,
                                              **args.settings), args.cells)


def rest(table, runner, args):
    print("a ball at rest on a fixed ball: overlap over m g/kn")
    got = resting_heap.overlaps(runner.result(resting_heap.REST(**args.settings)))
    print("       " + ", ".join(f"zeta {zeta:g}: {one:.4f}" for zeta, one in zip(resting_heap.ZETAS, got)))
    table.line("largest error", np.abs(got - 1).max(), 0.01)


def slot(table, runner, args):
    result = runner.result(SLOT(**args.settings, **args.longer(60000)))
    got = energy.slot(result)
    print(f"slot: {got.shape[1]} gaps")
    table.line("change of energy in gaps from 0.5", rough_gas.slot_change(result), 0.12)
    table.line("change that 37 of 40 gaps stay within", rough_gas.slot_most(result), 0.7)
    table.line("gain in all gaps", rough_gas.slot_gain(result), 1.0, f"{got.min():.3f} to {got.max():.3f}")


def gas(table, runner, args):
    print("rough gas, friction 80: energy over that at the start, largest in 10,000 steps of the rule")
    for ratio in (2 / 7, 1):
        for e in (1, 0.99, 0.95):
            got = energy.gas(runner.result(GAS(e=e, ktkn=ratio, **args.settings, **args.longer(10000))))
            table.line(f"kt/kn {ratio:.3g}, e {e}", got.max(), 1.02, f"at the end {got[-1]:.4f}")


def dense(table, runner, args):
    steps = 20000 if args.quick else 100000
    got = energy.gas(runner.result(GAS(e=1, friction=0, fraction=0.6, **args.settings, **args.longer(steps))))
    print(f"dense elastic gas: motion and springs after {steps} steps of the rule")
    table.line("loss", 1 - got[-1], 0.03, f"from {got[1]:.4f} to {got[-1]:.4f}, largest {got.max():.4f}")


def guard(table, runner, args):
    import test_energy_guard as decks
    print("energy guard: alarms where the energy does not rise")
    for name, deck in (("graze", decks.GRAZE), ("land", decks.LAND)):
        count = 0
        for e in (0.05, 0.1, 0.5):
            for part in (1, 0.1):
                folder = Path(runner.folder) / f"guard.{name}.{e}.{part}"
                folder.mkdir(parents=True)
                count += bool(decks.alarms(decks.run_deck(deck.format(e=e, part=part), folder)))
        table.line(f"{name}, of six runs", count, 0)
    folder = Path(runner.folder) / "guard.burst"
    folder.mkdir()
    table.line("energy rises: missing alarms", 1 - bool(decks.alarms(decks.run_deck(decks.BURST, folder))), 0)


def heap(table, runner, args):
    for large in (1, 3):
        for e in resting_heap.RESTITUTIONS:
            for filling in resting_heap.FILLINGS[:1] if args.quick else resting_heap.FILLINGS:
                if args.quick and (large, e) not in ((1, 0.05), (1, 0.1), (1, 0.3), (3, 0.05)):
                    continue
                begin, end = (6, 10) if args.quick else (10, 60)
                began = time.monotonic()
                run = resting_heap.HEAP(e=e, seed=filling, large=large, begin=begin, end=end, **args.settings)
                got = resting_heap.moved(runner.result(run))
                print(f"heap, e {e}, filling {filling}, diameters 1:{large}, from {begin} to {end} s: "
                      f"{got.creeping} balls creep, {got.lost} lost; {time.monotonic() - began:.0f} s")
                table.line("farthest ball over its radius", got.most, 1e-3)
                table.line("centroid over the radius", got.centroid, 1e-5)


SECTIONS = {one.__name__: one for one in (impacts, spins, rolling, rest, slot, gas, dense, guard, heap)}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="fewer and shorter heaps, a shorter dense gas")
    parser.add_argument("--only", metavar="SECTION,...", default=",".join(SECTIONS), help=f"of {', '.join(SECTIONS)}")
    parser.add_argument("--scheme", help="exact or plain (default: the decks' own, exact)")
    parser.add_argument("--part", type=float, default=1, help="time step over that of the rule (default 1)")
    parser.add_argument("--cells", type=int, default=0, help="list so many of the worst kinds of impact of each matrix")
    parser.add_argument("--lmp", default=os.environ.get("LMP", HERE.parent / "build" / "lmp"), help="LAMMPS program")
    args = parser.parse_args()
    args.settings = {"part": args.part, **({"scheme": args.scheme} if args.scheme else {})}
    args.longer = lambda steps: {"steps": round(steps / args.part)}
    os.environ["LMP"] = str(args.lmp)
    unknown = [name for name in args.only.split(",") if name not in SECTIONS]
    if unknown:
        parser.error(f"--only must be of {', '.join(SECTIONS)}, got {unknown[0]}")
    table = Table()
    began = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        runner = verify.Runner(Path(folder), Path(args.lmp).resolve())
        for name in args.only.split(","):
            SECTIONS[name](table, runner, args)
    print(f"{table.wrong} of {table.count} do not hold; {time.monotonic() - began:.0f} s")
    return 1 if table.wrong else 0


if __name__ == "__main__":
    sys.exit(main())
