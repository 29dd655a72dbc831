#!/usr/bin/python3
"""Numbers of pages that are made, not typed: takes what commands wrote into inputs/, and fills the pages.

    tests/made_numbers.py [DIR]         DIR: of `slope verify -o DIR`; without it the pages are filled alone

inputs/NN_case/numbers.yaml holds what runs gave; `slope verify` writes one for each case into DIR/numbers, for which
this script puts what is new into the file, and inputs/20_embankment/paper_table.py those of that case. In the text a
number has its name: NN.name or NN.name:format, NN being that of the case, the format Python's (default .5g); of a claim
NN.claim and NN.claim.control.

    Markdown    <!--01.restitution_0.25-->0.24873<!--/-->           the comments are not shown
    pages       :made:`0.24873<01.restitution_0.25>`                a role of doc/src/conf.py
    YAML        series: {0.0: 1, 0.05: 2}   # 20.paper.remove       a name and its keys

doc/src/verification.rst is made as a whole. tests/tools/test_made_numbers.py fails where text and file differ.
"""
import re
import sys
from pathlib import Path

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


def kept(case):
    """What runs of a case (NN) gave: {name: number or word}."""
    path, = INPUTS.glob(f"{case}_*/{verify.NUMBERS}.yaml")
    found = yaml.safe_load(path.read_text(encoding="utf-8"))
    claims = found.get("claims", {})
    return {**{name: one["got"] for name, one in claims.items()},
            **{f"{name}.control": one["control"] for name, one in claims.items()}, **found.get("seen", {})}


def worded(got, form):
    """A number as the text has it."""
    return got if isinstance(got, str) else format(got, form or ".5g")


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
    if len(sys.argv) > 1:
        take(sys.argv[1])
    for path in PAGES:
        text = path.read_text(encoding="utf-8")
        if (new := filled(text)) != text:
            path.write_text(new, encoding="utf-8")
            print(f"filled {path.relative_to(TOP)}")
    VERIFICATION.write_text(verify.page(verify.kept_outcomes()), encoding="ascii")


if __name__ == "__main__":
    main()
