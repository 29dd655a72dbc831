"""What a reviewer needs to make a report's numbers again: commands, versions, checksums; as text."""
import os
import platform
from importlib import metadata
from pathlib import Path
from shlex import join, quote
from typing import Any, Dict, Iterable, List, Mapping, Tuple

from .. import disk, provenance
from ..case import run_folders
from ..sites import site_roads
from ..survey.roads import NOTHING, OPTIONS, Asked
from .data import Data
from .heading import site_file, site_of

LIBRARIES = ("numpy", "scipy", "rasterio", "shapely", "matplotlib", "scikit-learn")
# of a study, beside the summaries of its runs
RESULTS = ("study.yaml", "study.csv", "combinations.csv", "hazard.csv", "influence.csv", "structures.csv", "lines.csv")


Run = Tuple[str, Path, Mapping[str, Any], Mapping[str, Any]]      # label, folder, of its command, of its end


def list_reproduce_commands(folder: Path) -> List[str]:
    """All of a folder of a study or of a run."""
    data = Data(folder)
    runs = list(runs_of(data))
    return ["# versions", *versions(data, runs), "",
            "# commands; those of runs in copies of their folders, as they overwrite what is there",
            *commands(data, runs), "",
            f"# checksums (SHA-256), of files in {quote(str(folder))}: sha256sum -c checks them",
            *checksums(data, runs), *sources(folder)]


def runs_of(data) -> Iterable[Run]:
    """Label, folder, and what was written of its command and of its end, of each finished run."""
    if not data.study:
        yield data.result.name, data.result.folder, data.result.about, data.result.marker
        return
    for row in data.finished:
        folder = run_folders.summary_of(data.folder, row.summary).parent
        yield (f"run {data.number(row.run)}, {data.label_of(row)}", folder, run_folders.begun(folder),
               run_folders.ended(folder))


def versions(data, runs: List[Run]) -> List[str]:
    summary = data.result.summary
    packages = sorted({str(about["package"]) for _, _, about, _ in runs if about.get("package")})
    programs = sorted({str(about["lmp_sha256"]) for _, _, about, _ in runs if about.get("lmp_sha256")})
    lines = [f"SLOPE, as compiled into the program: {summary['slope_version']}",
             f"LAMMPS: {summary['lammps_version']}",
             f"package of the runs (git describe): {', '.join(packages) or '-'}",
             f"package of these tools: {provenance.package_version() or provenance.version()}",
             *(f"SHA-256 of the program: {digest}" for digest in programs),
             f"Python: {platform.python_version()}"]
    return lines + [f"{name}: {version(name)}" for name in LIBRARIES]


def version(name: str) -> str:
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return "not installed"


def commands(data, runs: List[Run]) -> List[str]:
    """Of the study, as far as its file says, and of each run, in its folder."""
    words = []
    site = site_file(data.folder)
    if site:
        place = quote(os.path.relpath(site.parent))
        words += [f"tools/slope site {place}", f"tools/slope study {place}"]
    elif data.study and not data.study.ensemble:
        words.append(of_study(data))
    for label, folder, about, _ in runs:
        command = about.get("command") or "by hand: its command is in its log"
        words.append(f"cd {quote(str(folder))} && {command}    # {label}")
    return words


def of_study(data: Data) -> str:
    """The command of a study of a deck; its deck lies in the folder of each run."""
    about = data.of_study.study
    words = ["tools/slope", "study", about.deck]
    for option, values in (("--set", about.set), ("--repeat", about.repeat)):
        for name, several in values.items():
            words += [option, f"{name}={','.join(map(str, several))}"]
    road = about.road
    if road:
        words += ["--road", str(road["local"]), "--local", "--cut-angle", f"{road['cut_angle']:g}", "--mesh",
                  f"{road['mesh']:g}"]
        asked = Asked.of(road)._asdict()
        words += [word for field, option in OPTIONS.items() if asked[field] not in (None, NOTHING._asdict()[field])
                  for word in (option, f"{asked[field]:g}")]
    return join([*words, "-o", str(data.folder)])


def checksums(data, runs: List[Run]) -> List[str]:
    """Of inputs as the runs had them, one line for each content, and of results as they are now."""
    inputs: Dict[Tuple[str, str], Path] = {}
    for _, folder, _, marker in runs:
        for name, digest in (marker.get("inputs") or {}).items():
            inputs.setdefault((Path(name).name, digest), folder / name)
    files = [data.folder / name for name in RESULTS if (data.folder / name).is_file()]
    files += [run_folders.summary_of(data.folder, row.summary) for row in data.finished] or [data.result.path]
    return [f"{digest}  {relative(path, data.folder)}" for (_, digest), path in inputs.items()] + [
        f"{disk.sha256(path)}  {relative(path, data.folder)}" for path in files]


def sources(folder: Path) -> List[str]:
    """Of the files that a site was made from."""
    about = (site_of(folder).get("found") or {}).get("sources_sha256") or {}
    place = site_file(folder)
    if not (about and place):
        return []
    return ["", f"# checksums of the site's sources, of files in {quote(os.path.relpath(place.parent))}",
            *(f"{digest}  {name}" for name, digest in about.items())]


def relative(path: Path, folder: Path) -> Path:
    """The path from a folder, also of what is in a folder beside it; that of a file elsewhere as it is."""
    beside = {folder, folder.parent, site_roads.home(folder)}
    return Path(os.path.relpath(path, folder)) if beside & set(path.parents) else path
