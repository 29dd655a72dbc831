"""The run that a name on the command line stands for; of a study or a site the one whose maps are on the first page."""
import re
from pathlib import Path
from typing import NamedTuple, Optional, Sequence, Tuple, Union

from ..case.run_folders import OF_RUN, RASTERS, prefix_of, summaries, summary_of
from ..errors import SlopeError
from ..sites import site_choices
from ..statistics.entries import KnownQuantile, Quantile, Source
from . import ensemble_types, sizes, study_types
from .rows import Finished, find_farthest_run, finished_of
from .study_file import STUDY, load_study, study_in, without_study


class Named(NamedTuple):
    """A run; run, study: its name in the study that was named, None if another thing was."""
    prefix: str
    folder: Optional[Path]      # that was named, None if a prefix or a file was
    run: Optional[str] = None
    study: Optional[Path] = None


def governing(study: study_types.Study) -> str:
    """The run that represents the headline of a study with a finished run (load_study); else the one that went
    farthest.

    Of an ensemble whose quantile is the headline the one at this quantile; else the one at the 90 % quantile of what
    counts, or the largest where known events go beyond all runs.
    """
    rows, ensemble, best = finished_of(study.runs), study.ensemble, study.conservative
    if ensemble and (number := of_headline(study, rows)):
        return number
    if ensemble and ensemble.of:
        # a quantile is the value of a run
        of = ensemble.of
        known = ensemble_types.weighted(ensemble)
        quantiles: Sequence[Union[Quantile, KnownQuantile]] = ensemble.quantities[of].quantiles
        if known and known.quantities:
            quantiles = known.quantities[of].quantiles if of in known.quantities else []
        at = next((one.value for one in quantiles if one.share == 0.9), None)
        having = [row for row in rows if row.value(of) is not None]      # others lost it
        if at is None:      # events beyond the runs decide
            return max(having, key=lambda row: row.value(of)).run
        return sizes.nearest(having, of, at).run
    return best.run if best else find_farthest_run(rows).run


def of_headline(study: study_types.Study, rows: Sequence[Finished]) -> Optional[str]:
    """The run of an ensemble at whose volume the headline is; the longest where the headline is 0, as no run says more.

    None where the headline is of another study, of none, or withheld.
    """
    number, known = study.headline, ensemble_types.weighted(study.ensemble)
    if not number or number.source is not Source.ENSEMBLE or number.volume_m3 is None:
        return None
    if number.volume_m3 == 0:
        long = [row for row in rows if row.length_m is not None]
        return max(long, key=lambda row: row.length_m or 0.0).run if long else None
    at = next((one.value for one in known.to_remove or () if one.share == number.share), None) \
        if known else None
    return None if at is None else sizes.nearest(rows, "remove_m3", at).run


def governing_run(study: Path) -> Tuple[str, Path]:
    """Name and folder of the governing run of the study in a folder."""
    about = load_study(study / STUDY)
    name = governing(about)
    return name, next(summary_of(study, row.summary).parent for row in finished_of(about.runs) if row.run == name)


def read_named_run(name: str) -> Named:
    """The run of a prefix, of one of its rasters or its summary, of its folder, or the governing run of a study's or a
    site's folder; SlopeError if there is none, or several.
    """
    path = Path(name)
    if Path(f"{name}.thickness.asc").is_file() or not path.exists():
        return Named(name, None)
    if path.is_file():
        match = re.fullmatch(rf"(.+?)(?:\.\d+)?\.(?:{'|'.join(RASTERS)})\.asc|(.+)\.summary\.yaml", path.name)
        if not match:
            raise SlopeError(path, f"must be {OF_RUN}")
        return Named(str(path.with_name(match[1] or match[2])), None)
    study = study_in(path)
    if study:
        run, folder = governing_run(study)
        inside = summaries(folder)
        if len(inside) != 1:
            raise SlopeError(folder, "must hold the governing run of the study, with its summary")
        return Named(str(prefix_of(inside[0])), path, run, study)
    here = summaries(path)
    if len(here) > 1:
        raise SlopeError(path, "must hold one run, or name one of them by its prefix",
                         ", ".join(str(prefix_of(one)) for one in here[:3]) + ", ..." * (len(here) > 3))
    if not here and (path / site_choices.NAME).is_file():
        raise without_study(path)
    if not here:
        raise SlopeError(path, f"must be {OF_RUN}: it holds neither a PREFIX.summary.yaml nor a study.yaml")
    return Named(str(prefix_of(here[0])), path)
