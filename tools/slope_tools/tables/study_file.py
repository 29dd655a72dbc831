"""study.yaml, read by those who work on with it."""
from .. import disk
from ..errors import SlopeError
from .study_table import COLUMNS, MAYBE, ROAD_COLUMNS

EXCEEDANCE = ("threshold_m", "area_in_any_run_m2", "area_in_every_run_m2")
# of the conservative volume
PARTS = ("volume_m3", "mean_m3", "chance_m3", "size_m3", "scatter_m3", "degrees_of_freedom")
ALWAYS = PARTS[:2]                  # the others may be unknown


def read_study(path):
    """study.yaml as a dict, with all that its readers take from it; SlopeError if something is missing."""
    what = "what `slope study` wrote"
    study = disk.load_yaml(path, what)
    try:
        rows, about, best = study["runs"], study["study"], study["conservative"]
        if not all(isinstance(several, list) for several in about["set"].values()):
            raise ValueError("set")
        if not any(row["status"] == "finished" for row in rows):
            raise SlopeError(path, "must have a finished run", f"{len(rows)} that failed")
        for row in rows:
            if not (isinstance(row["run"], str) and row["set"].keys() == about["set"].keys()):
                raise ValueError("runs")
            if row["status"] == "finished":
                check_row(f"{path}: run {row['run']}", row, best)
        names = [row["run"] for row in rows if row["status"] == "finished"]
        if not all(one is None or one["run"] in names for one in (best, study["largest"]["front_m"])):
            raise ValueError("conservative, largest")
        if best:
            check_headline(path, best)
            if not about.get("road"):
                raise ValueError("conservative")
        if about.get("road") and not all(disk.is_number(about["road"][key]) for key in ("cut_angle", "mesh")):
            raise ValueError("road")
        for entry in study.get("exceedance") or ():
            if not all(disk.is_number(entry[key]) for key in EXCEEDANCE):
                raise ValueError("exceedance")
        if study.get("envelope"):
            study["envelope"]["max_thickness"]["file"]
        str(about["deck"]), int(about["runs"]), int(about["finished"])
    except (KeyError, TypeError, AttributeError, ValueError, OverflowError) as error:
        raise SlopeError(path, f"must be {what} ({error!r})") from error
    return study


def check_headline(path, best):
    """SlopeError if the conservative volume lacks a part, or has no number there."""
    for key in (*PARTS, "remove_m3", "kind", "repeats", "rounded"):
        if key not in best:
            raise SlopeError(path, f"conservative must have {key}: it is of another version; `slope study` with the "
                             "same arguments rewrites it and keeps the runs")
    withheld = best.get("withheld") or []           # none in older ones
    if not all(isinstance(one["text"], str) and isinstance(one["remedy"], str) for one in withheld):
        raise ValueError("conservative: withheld")
    for key in (*PARTS, "remove_m3"):
        unknown = key == "volume_m3" and withheld or key in PARTS and key not in ALWAYS
        if not (disk.is_number(best[key]) or best[key] is None and unknown):
            raise ValueError(f"conservative: {key}")


def check_row(where, row, road):
    """SlopeError if the row of a finished run lacks a column, or has no number there."""
    for key in (*COLUMNS, "moving_share", *(ROAD_COLUMNS if road else ())):
        if key not in row:
            raise SlopeError(where, f"must have {key}: it is of another version; `slope study` with the same "
                             "arguments rewrites it and keeps the runs")
        if key in ("moving", "at_rest", "stop_reason", "end") or (key in MAYBE and row[key] is None):
            continue
        if not disk.is_number(row[key]):
            raise SlopeError(where, f"{key} must be a finite number", repr(row[key])[:60])
    for key in ("moving", "at_rest"):
        if not isinstance(row[key], bool):
            raise SlopeError(where, f"{key} must be true or false", repr(row[key])[:60])
    if not isinstance(row["summary"], str):
        raise SlopeError(where, "summary must be the name of a file", repr(row["summary"])[:60])
