#!/usr/bin/python3
"""Numbers of pages that are made, not typed: takes what commands wrote into inputs/, and fills the pages.

    tests/made_numbers.py [DIR]         DIR: of `slope verify -o DIR`; without it the pages are filled alone
    tests/made_numbers.py NN.NAME=FILE[:COLUMN,...] ...     what the pages have of a table that a command wrote

inputs/NN_case/numbers.yaml holds what runs gave; `slope verify` writes one for each case into DIR/numbers, for which
this script puts what is new into the file, and inputs/20_embankment/paper_table.py those of that case. In the text a
number has its name: NN.name or NN.name:format, NN being that of the case, the format Python's (default .5g); of a claim
NN.claim and NN.claim.control. A table of the case gives NN.TABLE.row.column, a row having the name of its first two
words; reference.yaml NN.reference.series.x, NN.reference.series.over (its largest over the level) and
NN.reference.level; seen() of a script of the case what its data have. Of a table that a command wrote elsewhere, CSV or
YAML, NN.NAME.row.column goes into numbers.yaml where a page has it; rows are named by COLUMN,... (default: the first),
and rows of one name are NN.NAME.row.column.mean, .low, .high, .sd, .above_0 and .count. A format may end with a
unit to divide by: .0f/1e6.

    Markdown    <!--01.restitution_0.25-->0.24873<!--/-->           the comments are not shown
    pages       :made:`0.24873<01.restitution_0.25>`                a role of doc/src/conf.py
    YAML        series: {0.0: 1, 0.05: 2}   # 20.paper.remove       a name and its keys

doc/src/verification.rst is made as a whole. tests/tools/test_made_numbers.py fails where text and file differ.
"""
import csv
import importlib.util
import re
import sys
from pathlib import Path

import numpy as np
import yaml

TOP = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(TOP / "tools"))

from slope_tools.validation import verify  # noqa: E402  (after the path is set)

INPUTS = TOP / "inputs"
VERIFICATION = TOP / "doc" / "src" / "verification.rst"
PAGES = sorted({TOP / "README.md", *INPUTS.glob("*/README.md"), *INPUTS.glob("*/reference.yaml"),
                *(TOP / "doc" / "src").glob("*.rst")} - {VERIFICATION})
NAME = r"(?P<case>\d\d)\.(?P<name>[^\s:<>`]+?)(?::(?P<form>[^\s<>`]+?))?"
MARKS = (re.compile(rf"(?P<start><!--{NAME}-->)(?P<shown>[^<]*)(?P<end><!--/-->)"),
         re.compile(rf"(?P<start>:made:`)(?P<shown>[^`<]*?)(?P<end><{NAME}>`)"))
SERIES = re.compile(r"(?P<start>\{)(?P<shown>[^}]*)(?P<end>\}\s+# (?P<case>\d\d)\.(?P<name>[\w.]+))$", re.MULTILINE)


SEVERAL = {"mean": np.mean, "low": min, "high": max, "sd": lambda values: np.std(values, ddof=1) if values[1:] else 0,
           "above_0": lambda values: sum(value > 0 for value in values), "count": len}


def kept(case):
    """What runs of a case (NN) gave, and its tables have: {name: number or word}."""
    folder, = INPUTS.glob(f"{case}_*")
    found = loaded(folder / f"{verify.NUMBERS}.yaml")
    claims = found.get("claims", {})
    known = {**{name: one["got"] for name, one in claims.items()},
             **{f"{name}.control": one["control"] for name, one in claims.items()}, **found.get("seen", {})}
    for path in folder.glob("*.csv"):
        known.update(table(path))
    for path in folder.glob("*.py"):
        if "\ndef seen():" in path.read_text(encoding="utf-8"):
            known.update(seen(path))
    return {**known, **reference(loaded(folder / "reference.yaml"))}


def loaded(path):
    return yaml.safe_load(path.read_text(encoding="utf-8")) if path.is_file() else {}


def table(path):
    """Of a CSV file with a head, as its words; of a polygon nothing."""
    with open(path, encoding="utf-8", newline="") as file:
        head, *rows = csv.reader(file)
    return {".".join((path.stem, *row[:2], name)): value for row in rows for name, value in zip(head[2:], row[2:])}


def written(path, by=()):
    """Of a table that a command wrote: {row.column: number or word}, of rows of one name what is written of several."""
    if path.suffix == ".yaml":
        return flat(loaded(path))
    with open(path, encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    by = by or list(rows[0])[:1]
    groups = {}
    for row in rows:
        groups.setdefault(".".join(number_or_word(row[one], "g") for one in by), []).append(row)
    found = {}
    for name, several in groups.items():
        for column in set(several[0]) - set(by):
            values = [number_or_word(row[column]) for row in several]
            if not values[1:]:
                found[f"{name}.{column}"] = values[0]
            values = [one for one in values if not isinstance(one, str)]
            found.update({f"{name}.{column}.{what}": float(f"{of(values):.8g}")
                          for what, of in SEVERAL.items() if values})
    return found


def number_or_word(word, form=""):
    """Of a cell of a table; form: as a name has it."""
    try:
        return format(float(word), form) if form else float(f"{float(word):.8g}")
    except ValueError:
        return word.replace(" ", "_")


def flat(one, name=""):
    """Mappings and lists as dotted names; an entry of a list is named by its first values, or by its place."""
    if not isinstance(one, (dict, list)):
        return {name: one}
    pairs = dict(enumerate(one)) if isinstance(one, list) else one
    if isinstance(one, list) and all(isinstance(entry, dict) for entry in one):
        for many in range(1, 1 + min(map(len, one), default=0)):
            heads = [".".join(number_or_word(str(word), "g") for word in [*entry.values()][:many]) for entry in one]
            if len(set(heads)) == len(heads):
                pairs = dict(zip(heads, one))
                break
    return {key: value for first, entry in pairs.items()
            for key, value in flat(entry, f"{name}.{first}".strip(".")).items()}


def take_table(wanted, texts=None):
    """NN.NAME=FILE[:COLUMN,...]: put what the pages have of a table into numbers.yaml; it must have all of that."""
    name, _, file = wanted.partition("=")
    file, _, by = file.partition(":")
    case, _, name = name.partition(".")
    found = {f"{name}.{key}": value for key, value in written(Path(file), by.split(",") if by else ()).items()}
    texts = texts or [path.read_text(encoding="utf-8") for path in PAGES]
    names = {match["name"] for text in texts for mark in MARKS for match in mark.finditer(text)
             if match["case"] == case and match["name"].startswith(name + ".")}
    if unknown := sorted(names - set(found)):
        sys.exit(f"made_numbers.py: {file} must have {', '.join(unknown)}; it has {', '.join(sorted(found))}")
    folder, = INPUTS.glob(f"{case}_*")
    put(folder / f"{verify.NUMBERS}.yaml", {"seen": {key: found[key] for key in sorted(names)}})


def seen(path):
    """What seen() of a script gives."""
    spec = importlib.util.spec_from_file_location(path.stem, path)
    script = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(script)
    return script.seen()


def reference(about):
    """Of a file of reference values."""
    known = {}
    for one in about.get("quantities", {}).values():
        level, = one["levels"].values()
        for name, series in one["series"].items():
            known.update({f"reference.{name}.{float(x):g}": value for x, value in series.items()})
            known[f"reference.{name}.over"] = max(series.values()) / level
        known.update({f"reference.{name}": value for name, value in one["levels"].items()})
    return {name.replace(" ", "_").replace(",", ""): value for name, value in known.items()}


def worded(got, form):
    """A number as the text has it: 3e-6, and a chance that would be rounded to 0 as less than the last digit."""
    if isinstance(got, str):
        return got
    form, _, unit = (form or ".5g").partition("/")
    text = re.sub(r"e([-+])0(?=\d)", r"e\1", format(got / float(unit) if unit else got, form))
    if text.endswith("%") and got > 0 and float(text[:-1]) == 0:
        return "less than " + re.sub(r"0(?=%)", "1", text)
    return text


def filled(text, numbers=None):
    """The text with the numbers that its marks name; raises KeyError of an unknown one. numbers: kept() of cases."""
    known = {} if numbers is None else numbers

    def of(case):
        if case not in known:
            known[case] = kept(case)
        return known[case]

    def put(match):
        return match["start"] + worded(of(match["case"])[match["name"]], match["form"]) + match["end"]

    def series(match):
        values = of(match["case"])
        return match["start"] + ", ".join(f"{key}: {values[match['name'] + '.' + key]:.0f}" for key in
                                          re.findall(r"([\d.]+):", match["shown"])) + match["end"]

    for mark in MARKS:
        text = mark.sub(put, text)
    return SERIES.sub(series, text)


def take(folder):
    """Put what `slope verify` wrote into inputs/: what it did not make anew stays."""
    for path in sorted((Path(folder) / verify.NUMBERS).glob("*.yaml")):
        place, new = INPUTS / path.stem / f"{verify.NUMBERS}.yaml", yaml.safe_load(path.read_text(encoding="utf-8"))
        put(place, new)


def put(place, new):
    """Add numbers to a file of them; a claim or number that is no more is left out by hand."""
    old = yaml.safe_load(place.read_text(encoding="utf-8")) if place.is_file() else {}
    merged = {part: {**old.get(part, {}), **new.get(part, {})} for part in ("claims", "seen")}
    place.write_text("# Written by tests/made_numbers.py of what runs gave; do not edit\n" + yaml.safe_dump(
        {part: one for part, one in merged.items() if one}, sort_keys=False), encoding="utf-8")


def main():
    for word in sys.argv[1:]:
        (take_table if "=" in word else take)(word)
    lack = []
    for path in PAGES:
        text = path.read_text(encoding="utf-8")
        try:
            new = filled(text)
        except KeyError as error:
            lack.append(f"{path.relative_to(TOP)} has a mark of a number that nothing made: {error.args[0]}")
            continue
        if new != text:
            path.write_text(new, encoding="utf-8")
            print(f"filled {path.relative_to(TOP)}")
    VERIFICATION.write_text(verify.page(verify.kept_outcomes()), encoding="ascii")
    sys.exit("\n".join(lack))


if __name__ == "__main__":
    main()
