"""A search of slip surfaces from start to files: the deck, the program, and what it left."""
import os
import subprocess
from pathlib import Path
from typing import Any, Callable, List, NamedTuple, Sequence

from .. import disk, processes
from ..case import last_words, logs, slip_deck
from ..case.slip_deck import PREFIX
from ..errors import SlopeError
from ..survey import polygons, rasters
from . import jobs, launcher

SCREEN = "screen.txt"
POLL = 1.0              # s
TO_GO = "s to go"       # ends find_slip's lines on its progress


class Found(NamedTuple):
    """What find_slip said in its log."""
    notes: List[str]
    warnings: List[str]


def run_slip_search(asked: slip_deck.Asked, polygon, raster: rasters.Raster, folder: Path, lmp: Path, ranks: int,
                    tell: Callable[[str], Any]) -> Found:
    """Run the search in a folder, and leave its files there; SlopeError with LAMMPS' message.

    polygon: where the bodies must lie, in local metres, or None; raster: the terrain; tell: gets how far it is.
    """
    launcher.check_launcher(None, ranks)
    if polygon is not None:
        polygons.write_polygon(folder / slip_deck.WITHIN, polygon, raster)
    disk.write_file(folder / slip_deck.NAME, slip_deck.make_slip_deck(asked, lambda path: str(path.resolve())))
    by = launcher.list_launcher_words(None, ranks, jobs.slots())
    words = [*by, str(lmp), "-in", slip_deck.NAME, "-log", logs.LOG]
    with open(folder / SCREEN, "wb") as screen, jobs.signals_interrupt():
        try:
            process = processes.start(words, folder, screen, alone=not by)
        except OSError as error:
            raise SlopeError(lmp, f"cannot be run: {error.strerror}") from None
        try:
            status = followed(process, folder / logs.LOG, tell)
        finally:
            processes.stop([process])
    log = logs.Log(folder / logs.LOG).update()
    if status != 0 or not (folder / f"{PREFIX}.slips.csv").is_file():
        why = last_words.reason(log, last_words.Screen(folder / SCREEN, 0))
        raise SlopeError("find_slip", f"must end without an error: {why or f'ended with status {status}'}")
    (folder / SCREEN).unlink()
    text = (folder / logs.LOG).read_text(encoding="utf-8", errors="replace")
    return Found([line for line in text.splitlines() if line.startswith("Find_slip: lattice of")],
                 [one.removeprefix("Find_slip: ") for one in log.warnings])


def followed(process, log: Path, tell: Callable[[str], Any]) -> int:
    """The status with which the program ends; what it says of its progress goes to tell."""
    length = 0
    while True:
        try:
            return process.wait(POLL)
        except subprocess.TimeoutExpired:
            pass
        text = log.read_text(encoding="utf-8", errors="replace") if log.is_file() else ""
        lines = [line for line in text.split("\n")[:-1] if line.endswith(TO_GO)]
        for line in lines[length:]:
            tell(line)
        length = len(lines)


def settle(asked: slip_deck.Asked, raster: rasters.Raster, folder: Path, kept: int, final: Path) -> None:
    """Give the rasters the place of the terrain in their sidecars, and the deck paths from its folder `final` on."""
    disk.write_file(folder / slip_deck.NAME,
                    slip_deck.make_slip_deck(asked, lambda path: os.path.relpath(path.resolve(), final.resolve())))
    names = [f"{PREFIX}.factor.asc", *(f"{PREFIX}.{k + 1}.base.asc" for k in range(kept))]
    for name in names:
        values = rasters.read_raster(folder / name, heights=False)
        rasters.write_asc_local(folder / name, raster._replace(z=values.z), {}, exact=True)


def remove_others(folder: Path, kept: int, given: Sequence[str]) -> None:
    """Files of an earlier search in the same folder: of bodies beyond those that were kept, of rasters not given."""
    for path in [*folder.glob(f"{PREFIX}.*.base.*"), *folder.glob(f"{PREFIX}.*.columns.csv")]:
        rank = path.name.split(".")[1]
        if rank.isdigit() and int(rank) > kept:
            path.unlink()
    for path in [folder / slip_deck.TABLE, folder / slip_deck.BEDROCK, *folder.glob(slip_deck.LAYER.format("[0-9]*"))]:
        if path.name not in given:
            path.unlink(missing_ok=True)
            path.with_suffix(".yaml").unlink(missing_ok=True)
