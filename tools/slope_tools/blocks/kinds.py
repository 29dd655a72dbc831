"""The one place that picks what a command does by the kind of a site: a mass, or blocks (`kind` of site.yaml)."""
import dataclasses
from pathlib import Path
from typing import Any, Dict

from .. import disk
from ..errors import SlopeError
from ..sites import site, site_choices, site_roads
from ..sites.site_sections import Choices, Key, OfBlocks, OfMass
from ..studies import site_study

WRONG = "must not be given with a site of single blocks"
# of a command: what it calls a site's folder, and the options that have a meaning for blocks
TAKEN = {"study": ("deck", "np", "jobs", "lmp", "dry_run", "anew", "launcher", "engine", "slurm"),
         "export": ("prefix", "output", "overwrite"), "report": ("folder", "output", "overwrite"),
         "vtk": ("prefix", "output", "single")}


def run_by_kind(command: str, module: Any, request: Any, tell: Any) -> None:
    """Do a command of TAKEN: what its module does, or on a site of blocks what is done with these."""
    folder, *taken = TAKEN[command]
    named = getattr(request, folder)
    if named is None or site_choices.kind_in(Path(named)) is not OfBlocks:
        return getattr(module, f"run_{command}")(request)
    for field in dataclasses.fields(request):
        default = field.default_factory() if callable(field.default_factory) else field.default
        if field.metadata and field.name not in (folder, *taken) and getattr(request, field.name) != default:
            name = next(iter(field.metadata["names"]), "") or f"--{field.name.replace('_', '-')}"
            raise SlopeError(name, WRONG)
    site_folder = site_choices.load_kind(Path(named), OfBlocks)
    site_study.check_site(site_folder)
    if command == "study":
        from . import study
        return study.run_block_study(site_folder, module.setup_of(request))
    if command == "vtk":
        from . import runs, study
        shown = runs.find_farthest_run(study.read_block_runs(site_folder).runs)
        tell(f"{shown.name}, the run with the farthest block: {shown.folder}")
        return module.convert(str(shown.folder / runs.PREFIX), request.output, site_folder.folder, request.single)
    return (export if command == "export" else report)(site_folder, request.output, request.overwrite, tell)


def export(site_folder: site_choices.Folder[OfBlocks], output, overwrite: bool, tell) -> None:
    """The files for a GIS."""
    from . import files, study
    folder = output or site_folder.folder / "export"
    disk.check_folder(folder, [*files.NAMES, "export.yaml"], [site_folder.folder], overwrite)
    known = study.read_block_runs(site_folder)
    with disk.complete(folder, "export.yaml") as new:
        files.write_gis(new, known)
        disk.write_yaml(new / "export.yaml", {"of": site_folder.folder, "files": files.NAMES}, "slope export: m/s, J")
    tell(f"written to {folder}: {' '.join(files.NAMES)} export.yaml")


def report(site_folder: site_choices.Folder[OfBlocks], output, overwrite: bool, tell) -> None:
    """The page once more."""
    from ..report import document
    from . import page, study
    path = output or site_folder.folder / page.NAME
    disk.check_file(path, ".html")
    document.check_standing(path, site_folder.folder, overwrite, path.resolve().parent == site_folder.folder.resolve())
    tell(page.write_block_page(study.read_block_runs(site_folder), path))


# --- slope site ---

def begun(number: Any) -> Choices:
    """The choices of a new site; number: of blocks, None of a mass."""
    return OfMass.of({}) if number is None else OfBlocks.of({})


def check_kind(choices: Choices, given: Dict[str, Key]) -> None:
    """Raise SlopeError unless options, of these sections and keys, have a meaning for the kind of a site."""
    if choices.KIND and "roads" in given:
        raise SlopeError("--road", site_roads.ONE)
    for name, place in given.items():
        if not choices.has(*place):
            raise SlopeError(f"--{name.replace('_', '-')}", WRONG if choices.KIND else "must be given with --blocks")


def build(choices: Choices) -> site.Build:
    """What makes the files of a site."""
    if not isinstance(choices, OfBlocks):
        return site.build
    from .site import build as of_blocks
    return of_blocks
