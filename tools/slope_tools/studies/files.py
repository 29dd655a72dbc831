"""The files of a study: study.yaml, tables and maps over all runs, which are prints of its Outcome."""
from dataclasses import replace
from pathlib import Path
from typing import Mapping, Optional

from .. import disk
from ..ensembles import ensemble
from ..seismic import chain_files
from ..survey.rasters import Place
from ..tables import (combinations, elastic, intensity, road_runs, structures, study_file, study_table,
                      study_types)
from .outcome import Outcome


def write_study_files(outcome: Outcome, study: study_types.Study, output: Path,
                      place: Optional[Place]) -> study_types.Study:
    """All of them; what study.yaml says: about, with the maps of an ensemble. place: CRS and offset of maps, None
    without."""
    asked, read = outcome.questions, outcome.read
    if outcome.ensemble:
        assert asked.order
        study = replace(study, ensemble=ensemble.write_ensemble(outcome.ensemble, asked.order.levels, output, place,
                                                                read.problem))
    if stretches := study.stretches:
        head, *lines = road_runs.rows(stretches)
        disk.write_file(output / road_runs.FILE, disk.csv_text(head, lines))
        write_or_remove(output / f"{road_runs.BODIES}.csv",
                        road_runs.table_of_bodies(stretches.bodies) if stretches.bodies else None)
    if outcome.chain:
        (output / chain_files.PER_YEAR).unlink(missing_ok=True)      # of a study before this one in the folder
        for name, text in outcome.chain.tables.items():
            disk.write_file(output / name, text)
    write_or_remove(output / intensity.FILE, intensity.tabulate_intensity(study.intensity) if study.intensity else None)
    write_or_remove(output / elastic.FILE, read.elastic and elastic.tabulate_elastic(read.elastic))
    for what, name in structures.FILES.items():
        write_or_remove(output / name, structures.tabulate_structures(read.finished, what))
    disk.write_file(output / "study.csv", study_table.tabulate_study(asked.settings, asked.repeated, read.rows,
                                                                     read.defaults))
    disk.write_file(output / "combinations.csv", combinations.tabulate_combinations(outcome.groups, outcome.names,
                                                                                    asked.settings))
    if asked.alone:
        write_abouts({output: study})
    return study


def write_or_remove(path: Path, text: Optional[str]) -> None:
    """A file, or none of a study before this one in the folder."""
    if text:
        disk.write_file(path, text)
    else:
        path.unlink(missing_ok=True)


def write_abouts(abouts: Mapping[Path, study_types.Study]) -> None:
    """study.yaml in one folder, or in those of both studies of a site, one right after the other."""
    with disk.write_beside(*(output / study_file.STUDY for output in abouts)) as new:
        for path, about in zip(new, abouts.values()):
            path.write_text(disk.yaml_text(study_file.TITLE, study_file.encode_study(about)), encoding="utf-8")
