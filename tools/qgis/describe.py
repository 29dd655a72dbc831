#!/usr/bin/python3
"""Print the options of the commands that have an algorithm, as `slope COMMAND --describe` says them: commands.json.

A test holds the file against this; after a change: tools/qgis/describe.py > tools/qgis/slope/commands.json
"""
import argparse
import importlib
import json
import re
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))

from slope_tools import options  # noqa: E402  (after the path is set)

KEPT = ("option", "kind", "default", "needed", "choices")       # what the plugin takes


def describe(command):
    """{name: what the plugin takes of the option} of a command."""
    parser = argparse.ArgumentParser()
    options.declare(parser, importlib.import_module(f"slope_tools.commands.{command}").Request)
    return {name: {key: one[key] for key in KEPT} for name, one in options.described(parser).items()}


def main():
    commands = sorted(name for path in (HERE / "slope").glob("*.py")
                      for name in re.findall(r'^    command = "(\w+)"', path.read_text(encoding="utf-8"), re.MULTILINE))
    text = json.dumps({name: describe(name) for name in commands}, indent=1, default=str)
    print(re.sub(r'\{\s+("option"[^{}]*?)\s+\}', lambda found: "{" + re.sub(r"\s*\n\s*", " ", found[1]) + "}", text))


main()
