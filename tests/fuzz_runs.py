#!/usr/bin/python3
"""Random legal sequences of commands on a small collapse, continued in the run and from a restart file: the same.

What a run remembers from before, and a restart file does not (or the other way round), shows as a difference of more
than 1e-9 m (the balls are of 1 m) at most 200 steps later. A sequence that ends with a run is also compared with one
longer run: what is stale in the run may go into the restart file as it is. A sequence that fails is printed and made
shorter, command by command.

    LMP=build/lmp tests/fuzz_runs.py --count 100 --first 1        # seeds 1 to 100
    LMP=build/lmp tests/fuzz_runs.py --count 30 --day             # seeds of the day
"""

import argparse
import datetime
import random
import re
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent / "decks"))
from deck_helpers import collapse_deck, read_dump, run_deck, serial, write_collapse    # noqa: E402

BALLS, TOLERANCE = 200, 1e-9
WEIGHT = "fix weight soil gravity 9.80665 vector {}"
MOVE = "fix move soil nve/sphere"
WALL = "fix field soil wall/gran/balls 3 1.0 surface ground upper spacing 1.0"
# a new wall knows no contacts, and LAMMPS refuses this where a restart file waits for its fixes
REFUSED = "overlap at the start", "Cannot displace_atoms after reading restart file"


def draw(rng):
    """A case: ranks, scheme and newton of the deck, commands, steps that are compared."""
    case = {"ranks": 1 if serial() else rng.choice([1, 1, 3]),
            "scheme": rng.choice(["exact", "exact", "plain"]),
            "newton": rng.choice(["on", "off"]), "after": rng.choice([1, 20, 60, 200])}
    steps = [50, 100, 200]    # with reset_timestep their numbers come again
    first = rng.choice([*steps, rng.randint(100, 400), 600])
    commands = [("run", first)]
    kinds = ["run"] * 4 + ["reset"] * 3 + ["again"] * 2 + ["timestep", "weight", "move", "wall", "write"]
    kinds += ["restart", "balance", "delete", "spin", "speed", "displace", "zero", "pre no"]
    for _ in range(rng.randint(2, 9)):
        kind = rng.choice(kinds)
        number = {"run": rng.choice([*steps, rng.randint(1, 120)]), "pre no": rng.randint(1, 60),
                  "again": first, "reset": rng.choice([0, 0, 50, 100, 200]),
                  "timestep": rng.choice([0.001, 0.0012, 0.0015]), "weight": rng.choice(["0 0 -1", "-0.1 0 -1"]),
                  "delete": rng.choice(["yes", "no"])}.get(kind, rng.randint(1, BALLS))
        commands += [("reset", 0), ("run", number)] if kind == "again" else [(kind, number)]
    return {**case, "commands": commands}


def head(case, begin, now, out):
    """The deck before its first run, from a data or a restart file; without its dump, which forbids reset_timestep."""
    deck = collapse_deck("", begin=begin, scheme=case["scheme"], newton=case["newton"], out=out)
    deck = re.sub(r"^dump.*\n", "", deck, flags=re.MULTILINE)
    return (deck.replace("timestep 0.0015", f"timestep {now['dt']}")
            .replace(WEIGHT.format("0 0 -1"), WEIGHT.format(now["weight"])))


def sequence(case, out):
    """The deck as far as the state that is compared, and the settings that a deck from a restart file repeats."""
    now = {"dt": 0.0015, "weight": "0 0 -1"}
    parts, ran = [head(case, "read_data balls.data", now, out)], False
    for k, (kind, number) in enumerate(case["commands"]):
        if kind == "timestep":
            now["dt"] = number
        if kind == "weight":
            now["weight"] = number
        weight = WEIGHT.format(now["weight"])
        parts.append({
            "run": f"run {number}", "zero": "run 0", "pre no": f"run {number} pre {'no' if ran else 'yes'}",
            "reset": f"reset_timestep {number}", "timestep": f"timestep {number}",
            "weight": f"unfix weight\n{weight}", "move": f"unfix move\n{MOVE}",
            "wall": f"unfix field\nunfix move\nunfix weight\n{WALL}\n{MOVE}\n{weight}",
            "write": "write_restart side.restart", "balance": "balance 1.0 shift xyz 5 1.0",
            "delete": f"group gone id {BALLS // 4 + k}:{BALLS}:{7 + k}\ndelete_atoms group gone compress {number}\n"
                      "group gone delete",
            "spin": f"set atom {number} omega 0.5 -0.3 0.1", "speed": "velocity soil set 0 0 0.01 sum yes",
            "displace": "displace_atoms soil move 1e-4 2e-4 1e-4",
            "restart": "write_restart mid.restart\nclear\n" + head(case, "read_restart mid.restart", now, out)}[kind])
        ran = kind in ("run", "pre no", "zero")
    return "\n".join(parts), now


def differences(case, folder):
    """{what: largest difference of places, m, from the run that goes on}."""
    write_collapse(folder, BALLS)
    run, dump = f"\nrun {case['after']}", "\nwrite_dump all custom {} id x y z modify sort id format float %.17g\n"
    text, now = sequence(case, "out")
    decks = {"whole": text + run + dump, "first": text + "\nwrite_restart cut.restart\n",
             "from a restart file": head(case, "read_restart cut.restart", now, "out") + run + dump}
    if case["commands"][-1][0] == "run":
        *before, (_, number) = case["commands"]
        longer = {**case, "commands": [*before, ("run", number + case["after"])]}
        decks["in one run"] = sequence(longer, "out")[0] + dump
    found = {}
    for name, deck in decks.items():
        run_deck(deck.format(f"{name}.txt".replace(" ", "_")), folder, np=case["ranks"])
        if name != "first":
            found[name] = list(read_dump(folder / f"{name}.txt".replace(" ", "_")).values())[-1]
    whole = found.pop("whole")
    return {name: abs(whole - x).max() if x.shape == whole.shape and (x[:, 0] == whole[:, 0]).all() else float("inf")
            for name, x in found.items()}


def fails(case):
    """Why a case fails, or nothing."""
    with tempfile.TemporaryDirectory() as folder:
        try:
            found = differences(case, Path(folder))
        except subprocess.TimeoutExpired as error:
            return f"not at its end after {error.timeout:g} s"
        except AssertionError as error:
            lines = [line for line in str(error).splitlines() if "ERROR" in line]
            if any(words in line for line in lines for words in REFUSED):
                return None
            return lines[0] if lines else str(error)[-300:]
    apart = [f"{name} apart by {x:.3g} m" for name, x in found.items() if x > TOLERANCE]
    return ", ".join(apart) or None


def shorten(case):
    """The case without the commands that it fails without, too."""
    k = len(case["commands"]) - 1
    while k > 0:
        shorter = {**case, "commands": case["commands"][:k] + case["commands"][k + 1:]}
        if fails(shorter):
            case = shorter
        k -= 1
    return case


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=30)
    parser.add_argument("--first", type=int, default=1, help="the first seed")
    parser.add_argument("--day", action="store_true", help="seeds of the day instead")
    args = parser.parse_args()
    first = datetime.date.today().toordinal() * 1000 if args.day else args.first
    found = 0
    for seed in range(first, first + args.count):
        case = draw(random.Random(seed))
        why = fails(case)
        if not why:
            continue
        found += 1
        case = shorten(case)
        print(f"seed {seed}: {why}\n  shortened, {fails(case)}: {case}", flush=True)
    print(f"{args.count} sequences, {found} failed")
    return found > 0


if __name__ == "__main__":
    sys.exit(main())
