"""The subcommands of tools/slope and what they share.

From Python: study(), sensitivity() and calibrate() are the commands of these names (commands/calls.py), Study reads
what a study left; each is imported when it is used.
"""
import functools
import importlib
from typing import Any

__all__ = ["SlopeError", "Study", "calibrate", "sensitivity", "study"]


def __getattr__(name: str) -> Any:
    def of(module: str) -> Any:
        return importlib.import_module(f".{module}", __name__)
    if name == "__version__":
        return of("provenance").version()
    if name == "SlopeError":
        return of("errors").SlopeError
    if name == "Study":
        return of("tables.study_file").Study
    if name in __all__:
        return functools.partial(of("commands.calls").call, name)
    raise AttributeError(f"slope_tools has no {name}")
