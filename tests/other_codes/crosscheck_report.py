"""What the comparison of codes found: tables, a picture."""
import csv
import math
import sys

import io
import yaml
from rich.console import Console
from rich.table import Table

from slope_tools import disk, provenance
from .crosscheck_cases import Check, road_corners


def report(work):
    """Write the results, and print them."""
    rows = [{**check._asdict(), "passed": check.passed} for check in work.checks]
    about = {"crosscheck": {"finished": provenance.now(), "machine": provenance.machine(),
                            "package": provenance.package_version(),
                            "lmp_sha256": disk.sha256(work.lmp), "versions": work.versions,
                            "processor_seconds": {name: round(value, 1) for name, value in work.seconds.items()},
                            "quick": work.quick,
                            "compared": sum(row["passed"] is not None for row in rows),
                            "failed": sum(row["passed"] is False for row in rows)},
             "collapse": work.about_collapse, "table": work.about_table,
             "laws": work.about_laws, "checks": rows,
             "differs": {code.name: list(code.differs) for code in work.codes if code.differs}, "notes": work.notes}
    out = io.StringIO()
    writer = csv.DictWriter(out, [*Check._fields, "passed"], lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    disk.write_file(work.output / "crosscheck.csv", out.getvalue())
    disk.write_file(work.output / "crosscheck.yaml", "# slope crosscheck: the same scenes in other codes; m, rad, m3\n"
                    + yaml.safe_dump(about, sort_keys=False))
    written = ["crosscheck.yaml", "crosscheck.csv"]
    if work.about_table:
        written.append("table.csv")
    if work.about_laws:
        written.append("laws.csv")
    if work.profiles:
        draw(work.output / "crosscheck.png", work)
        written.append("crosscheck.png")
    shown = Table(title="the same scenes in other codes")
    for head, side in (("case", "left"), ("quantity", "left"), ("code", "left"), ("value", "right"),
                       ("expected", "right"), ("of", "left"), ("+-", "right"), ("agrees", "right")):
        shown.add_column(head, justify="left" if side == "left" else "right")
    last = None
    for check in work.checks:
        new, last = (check.case, check.quantity) != last, (check.case, check.quantity)
        if new:
            shown.add_section()
        informs = check.tolerance is None
        shown.add_row(check.case if new else "", check.quantity if new else "", work.title[check.code],
                      cell(check.value), "" if informs and not check.against else cell(check.expected), check.against,
                      "" if informs or isinstance(check.value, str) else cell(check.tolerance),
                      {True: "yes", False: "NO", None: ""}[check.passed])
    (Console() if sys.stdout.isatty() else Console(width=160)).print(shown)
    for check in work.checks:
        if check.case == "table":
            print(f"{check.quantity}, {work.title[check.code]}: {check.reason}: {check.value}")
    for row in work.about_laws["rows"] if work.about_laws else ():
        if row["difference"] is not None and math.isfinite(row["difference"]):
            print(f"{row['what']}: {row['quantity']}, mu_r {row['rolling']:g}: {100 * row['difference']:+.1f} % "
                  f"({100 * row['low']:+.1f} to {100 * row['high']:+.1f})")
    print("processor time, s: " + ", ".join(f"{work.title[name]} {value:.0f}" for name, value in work.seconds.items()))
    for code in work.codes:
        for text in code.differs:
            print(f"{code.title}: {text}")
    for text in work.notes:
        print(text)
    print(", ".join(str(work.output / name) for name in written))


def cell(value):
    return value if isinstance(value, str) else f"{value:.4g}"


def draw(path, work):
    """The deposit of every code along x, with the road."""
    from slope_tools.drawing import figures, pictures
    with pictures.settings(figures.STYLE):
        figure, axes = pictures.subplots(figsize=(figures.FULL, 2.7))
        road = road_corners()[:, 0]
        axes.axvspan(road.min(), road.max(), color=figures.ROAD, alpha=0.12, lw=0, label="road")
        for i, (name, (edges, values)) in enumerate(work.profiles.items()):
            axes.stairs(values, edges, color=figures.COLOURS[i], lw=2.0 if name == "slope" else 1.1,
                        label=work.title[name])
        full = [i for _, values in work.profiles.values() for i, value in enumerate(values) if value > 0]
        edges = work.profiles["slope"][0]
        axes.set(xlim=(edges[max(0, min(full) - 1)], edges[min(len(edges) - 1, max(full) + 2)]), ylim=(0, None),
                 xlabel="x (m); the mass came from the right", ylabel="deposit (m3 per m)")
        axes.set_title(f"Deposit after {work.about_collapse['seconds']:g} s, {work.about_collapse['balls']:,} balls of "
                       f"{work.about_collapse['d']:g} m", loc="left")
        axes.legend(loc="upper left")
        pictures.save(figure, path, dpi=figures.DPI)
