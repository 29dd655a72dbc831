#!/usr/bin/python3
"""Processor seconds of the tests, which conftest.py writes by test into the file SLOPE_TIMES.

    times.py CSV            prints the ten slowest tests of that file
    times.py CSV --keep     and its sums by file into times.csv, by which the longest files begin first
"""
import collections
import csv
import sys
from pathlib import Path

TIMES = Path(__file__).resolve().parent / "times.csv"
SLOWEST = 10


def read_seconds():
    """{test file: seconds} as kept; none where there is no such file."""
    try:
        with open(TIMES, encoding="ascii", newline="") as file:
            return {row["file"]: float(row["seconds"]) for row in csv.DictReader(file)}
    except FileNotFoundError:
        return {}


def main(source, keep=None):
    with open(source, encoding="utf-8", newline="") as file:
        tests = sorted(((float(seconds), name, test) for name, test, _, seconds in csv.reader(file)), reverse=True)
    print(f"the {SLOWEST} slowest tests, processor seconds:")
    for seconds, name, test in tests[:SLOWEST]:
        print(f"{seconds:8.1f}  {name} {test}")
    if keep:
        sums = collections.Counter()
        for seconds, name, _ in tests:
            sums[name] += seconds
        with open(TIMES, "w", encoding="ascii", newline="") as file:
            out = csv.writer(file, lineterminator="\n")
            out.writerow(("file", "seconds"))
            out.writerows((name, f"{seconds:.1f}") for name, seconds in sums.most_common())


if __name__ == "__main__":
    main(*sys.argv[1:])
