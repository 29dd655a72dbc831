"""What a report shows of a mapped deposit: how the runs agree with it, whatever the method of the study."""
from typing import Any, Dict, List, Optional

from ..studies.mapped import BEYOND, OVERLAP, mass


def drawn(data) -> Any:
    """What the maps draw of it: its polygon, or the mask of its cells; None without one."""
    if data.mapped is None:
        return None
    return data.mapped.share >= 0.5 if data.mapped.polygon is None else data.mapped.polygon


def runs(data) -> List[Dict[str, Any]]:
    """The rows of the runs that are compared."""
    return [row for row in data.finished if row.get(OVERLAP) is not None] if data.mapped is not None else []


def sentence(data, numbers) -> str:
    """For the first page; "" without a mapped deposit."""
    found = runs(data)
    if not found:
        return ""
    about = data.study["observed"]
    best = next(row for row in found if row["run"] == about["best"])
    share = numbers("overlap with the mapped deposit", "1", best[OVERLAP], data.label_of(best))
    which = f"The best of {len(found)} runs" if len(found) > 1 else "The run"
    text = f"{which} shares {share} of the area that it or the mapped deposit covers (1: the same area)"
    if best[BEYOND] is not None:
        by = numbers("farther than the mapped deposit", "m", abs(best[BEYOND]), data.label_of(best))
        text += f", and ends {by} m {'beyond' if best[BEYOND] > 0 else 'short of'} its tip"
    lacks = mass(about["volume_m3"], about["released_m3"])
    return f"{text}." + (f" {lacks[0].upper()}{lacks[1:]}." if lacks else "")


def content(data, numbers) -> Optional[Dict[str, Any]]:
    """For the template: lines, and a table of the mapped deposit, the shown run, the best one and all."""
    found = runs(data)
    if not found:
        return None
    about = data.study["observed"]
    volume, length = about["volume_m3"], about["length_m"]
    by_name = {row["run"]: row for row in found}
    heads = [("overlap (Jaccard)", ""), ("length", "m"), ("difference", "m")]
    columns = [(OVERLAP, "1"), ("length_m", "m"), (BEYOND, "m")]
    if volume is not None:
        heads += [("volume of the deposit", "m3"), ("difference", "m3")]
    mine = ["1", numbers("length of the mapped deposit", "m", length), "-"]
    if volume is not None:
        mine += [numbers("volume of the mapped deposit", "m3", volume), "-"]
    rows = [("mapped", mine)]

    def cells(several, label):
        texts = []
        for key, unit in columns:
            values = [row[key] for row in several if row[key] is not None]
            texts.append(span(numbers, key.replace("_", " "), unit, values, label) if values else "-")
        if volume is not None:
            kept = [row["on_grid_m3"] for row in several]
            texts.append(span(numbers, "volume of the deposit", "m3", kept, label))
            texts.append(span(numbers, "volume less that of the mapped deposit", "m3",
                              [value - volume for value in kept], label))
        return texts

    shown = [("on the maps", data.result.name), ("best overlap", about["best"])]
    for what, name in shown if shown[0][1] != shown[1][1] else [("on the maps, best overlap", shown[0][1])]:
        if name in by_name:
            label = data.label_of(by_name[name])
            rows.append((f"run {data.number(name)}, {what}", cells([by_name[name]], label)))
    if len(found) > 1:
        rows.append((f"all {len(found)} runs", cells(found, "")))
    lacks = mass(volume, about["released_m3"])
    return {"lines": [f"{lacks[0].upper()}{lacks[1:]}."] if lacks else [], "heads": heads, "rows": rows,
            "caption": "Overlap: the area that both cover over that which either covers, thicker than "
                       f"{about['threshold_m']:g} m. Lengths are those of the table of runs; of an outline that to its "
                       "farthest point. Negative differences: the run ends short, or holds less."}


def span(numbers, what, unit, values, label) -> str:
    low, high = (numbers(what, unit, value, label) for value in (min(values), max(values)))
    return low if low == high else f"{low} to {high}"
