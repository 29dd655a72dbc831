"""What the benchmark found: tables, pictures, targets."""
import csv
import math
import sys
from statistics import median
from typing import Any, Dict

import io
import numpy as np
import yaml
from rich.console import Console
from rich.table import Table

from slope_tools import disk, provenance
from . import peers
from .bench_scenes import PREPARED

TARGETS = {"build": (">=", 0.95), "granular": (">=", 4.0), "hooke": (">=", 2.5), "liggghts": (">=", 4.0),
           "yade": (">=", 25.0), "terrain_time": ("<=", 1.05), "terrain_bytes": ("<=", 60.0), "ranks_2": (">=", 1.85),
           "rest_2": (">=", 1.85), "throughput": (">=", 1.9), "weak_time": ("<=", 1.3), "weak_time_2": ("<=", 1.3)}
BUSY = 0.5              # load of the machine, from which on the numbers are doubtful
SAME_ENERGY, SAME_WAY = 0.05, 0.02      # peers with the same coefficients: kinetic energy, displacement of centroid
LOOSE = {"hooke": 10.0}                 # times that for a peer without a smooth slip surface


def same_scene(plan):
    """{code: kinetic energy and displacement of the centroid against ours, and whether it is the same scene}."""
    found: Dict[str, Any] = {}
    if not plan.states:
        return found
    mass = plan.scene.mass

    def energy(balls):
        return 0.5 * mass * float((balls[:, 3:6] ** 2).sum())

    def displacement(balls):
        return balls[:, :3].mean(axis=0) - plan.scene.moving[:, :3].mean(axis=0)

    ours = plan.states["slope"]
    for name, balls in plan.states.items():
        other = energy(balls) / energy(ours)
        off = float(np.linalg.norm(displacement(balls) - displacement(ours)) / np.linalg.norm(displacement(ours)))
        loose = LOOSE.get(name, 1.0)
        found[name] = {"kinetic_energy": energy(balls), "kinetic_energy_to_ours": other,
                       "centroid_displacement": [round(value, 6) for value in displacement(balls).tolist()],
                       "centroid_off": off,
                       "same": len(balls) == len(ours) and abs(other - 1) <= loose * SAME_ENERGY
                       and off <= loose * SAME_WAY}
    return found


def report(plan):
    """Write the results, and print them."""
    ours = [one for one in plan.runs if one.code == "slope" and one.ranks == 1 and one.part == plan.runs[0].part
            and one.fixed == len(plan.scene.ground)]
    parts = {name: median(one.result.breakdown[name] for one in ours) for name in ours[0].result.breakdown}
    codes = {}
    for code in peers.ALL:
        own = [one for one in plan.runs if one.code == code.name and one.part == "peers"]
        if own:
            codes[code.name] = {"title": code.title, "version": plan.versions[code.name],
                                "loop_seconds": median(one.result.seconds for one in own),
                                "ns_per_ball_step": 1e9 * median(one.per_ball for one in own),
                                "differs": list(code.differs)}
    scene = plan.scene
    about = {"bench": {"finished": provenance.now(), "machine": provenance.machine(),
                       "package": provenance.package_version(),
                       "lmp_sha256": disk.sha256(plan.lmp),
                       "programs_sha256": {name: disk.sha256(path) for name, path in plan.programs.items()},
                       "versions": plan.versions, "quick": plan.quick,
                       "steps": plan.steps, "repeat": plan.repeat},
             "scene": {"moving": len(scene.moving), "fixed": len(scene.ground), "diameter": scene.diameter,
                       "dt": scene.dt, "skin": scene.skin, "prepared_s": PREPARED * math.sqrt(plan.size),
                       "median_speed": float(np.median(np.linalg.norm(scene.moving[:, 3:6], axis=1)))},
             "measures": plan.values, "codes": codes, "same_scene": same_scene(plan), "breakdown_seconds": parts,
             "start_to_rest": plan.cases, "notes": plan.notes}
    for name, state in about["same_scene"].items():
        if not state["same"]:
            plan.notes.append(f"{codes[name]['title']} ran another collapse: kinetic energy "
                              f"{state['kinetic_energy_to_ours']:.3f} of ours, displacement of the centroid off by "
                              f"{100 * state['centroid_off']:.1f} %")
    disk.write_file(plan.output / "bench.csv", table(plan.runs))
    disk.write_file(plan.output / "bench.yaml", "# slope bench: s, m, J, bytes; ratios are medians of neighbouring "
                    "runs\n" + yaml.safe_dump(about, sort_keys=False))
    draw(plan.output / "bench.png", about)
    show(about, plan.output)


def table(several):
    """bench.csv: one row per run."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    parts = sorted({name for one in several for name in one.result.breakdown})
    writer.writerow(["part", "code", "ranks", "moving", "fixed", "steps", "loop_s", "ns_per_ball_step", "peak_bytes",
                     *(f"{name.lower()}_s" for name in parts)])
    for one in several:
        writer.writerow([one.part, one.code, one.ranks, one.moving, one.fixed, one.steps, f"{one.result.seconds:.6g}",
                         f"{1e9 * one.per_ball:.6g}", one.result.peak,
                         *(one.result.breakdown.get(name, "") for name in parts)])
    return out.getvalue()


def show(about, folder):
    """Print tables, what differs, and where the numbers are."""
    console = Console() if sys.stdout.isatty() else Console(width=160)
    bench, scene, measures = about["bench"], about["scene"], about["measures"]
    machine = bench["machine"]
    print(f"{machine['processor']}, {machine['cores']} cores; {scene['moving']:,} moving and {scene['fixed']:,} fixed "
          f"balls, {bench['steps']} steps, median of {bench['repeat']}")
    if about["codes"]:
        shown = Table(title="one core, the same balls, the same step")
        for head, side in (("code", "left"), ("version", "left"), ("loop s", "right"), ("ns/ball/step", "right"),
                           ("time / ours", "right"), ("range", "right"), ("target", "right"), ("met", "right"),
                           ("energy / ours", "right"), ("centroid off %", "right")):
            shown.add_column(head, justify="left" if side == "left" else "right")
        for name, code in about["codes"].items():
            ratio, same = measures.get(name), about["same_scene"].get(name)
            shown.add_row(code["title"], code["version"].split(",")[0].removeprefix("Version "),
                          f"{code['loop_seconds']:.2f}", f"{code['ns_per_ball_step']:.1f}", *against(ratio),
                          f"{same['kinetic_energy_to_ours']:.3f}" if ratio else "",
                          f"{100 * same['centroid_off']:.2f}" if ratio else "")
        console.print(shown)
    rest = {name: value for name, value in measures.items() if name not in about["codes"]}
    if rest:
        shown = Table(title="terrain, ranks, more balls")
        for head, side in (("what", "left"), ("value", "right"), ("range", "right"), ("target", "right"),
                           ("met", "right")):
            shown.add_column(head, justify="left" if side == "left" else "right")
        for value in rest.values():
            shown.add_row(value["what"], *against(value))
        console.print(shown)
    total = sum(about["breakdown_seconds"].values())
    print("ours: " + ", ".join(f"{name.lower()} {seconds:.3f} s ({100 * seconds / total:.0f} %)"
                               for name, seconds in about["breakdown_seconds"].items()))
    for code in about["codes"].values():
        for text in code["differs"]:
            print(f"{code['title']}: {text}")
    for text in about["notes"]:
        print(text)
    print(f"{folder / 'bench.yaml'}, {folder / 'bench.csv'}, {folder / 'bench.png'}")


def against(value):
    """Cells of a measure: value, range, target, met."""
    if not value:
        return "", "", "", ""
    median_, low, high = (f"{value[key]:.3g}" if value[key] < 100 else f"{value[key]:.0f}"
                          for key in ("value", "low", "high"))
    return (median_, f"{low} to {high}", value.get("target", ""),
            {True: "yes", False: "NO", None: ""}[value.get("met")])


def draw(path, about):
    """The codes against ours with their targets, the other measures, and where our time goes."""
    from slope_tools.drawing import figures, pictures
    measures, codes, parts = about["measures"], about["codes"], about["breakdown_seconds"]
    with pictures.settings(figures.STYLE):
        figure, axes = pictures.subplots(1, 2, figsize=(figures.FULL, 2.3), width_ratios=(1.5, 1))
        names = [name for name in measures if name in codes][::-1]
        if names:
            ratios = [measures[name]["value"] for name in names]
            colours = [figures.COLOURS[2 if measures[name]["met"] else 1] for name in names]
            axes[0].barh(names, ratios, color=colours, height=0.6)
            axes[0].set_yticks(range(len(names)), [codes[name]["title"] for name in names])
            bounds = [TARGETS[name][1] for name in names]
            axes[0].scatter(bounds, names, marker="|", s=260, color="black", lw=1.6, zorder=3)
            for i, name in enumerate(names):
                axes[0].annotate(f"{ratios[i]:.1f}  ({codes[name]['ns_per_ball_step']:.0f} ns)",
                                 (max(ratios[i], bounds[i]), i), xytext=(5, 0), textcoords="offset points",
                                 va="center", fontsize=6.5)
            axes[0].set(xscale="log", xlim=(1, 5 * max(ratios + bounds)), xlabel="its time / ours "
                        f"({codes['slope']['ns_per_ball_step']:.0f} ns per moving ball and step)")
            axes[0].set_xticks([1, 2, 5, 10, 20, 50], ["1", "2", "5", "10", "20", "50"])
            axes[0].minorticks_off()
            axes[0].set_title("| target", loc="right", fontweight="normal")
            axes[0].set_ylim(len(names) - 4.6, len(names) - 0.4)       # room for four
            axes[0].set_title("One core, the same balls", loc="left")
        else:
            axes[0].set_visible(False)
        total = sum(parts.values())
        shown = [name for name in parts if parts[name] > 0.005 * total][::-1]
        axes[1].barh(shown, [100 * parts[name] / total for name in shown], color=figures.COLOURS[0], height=0.6)
        axes[1].set(xlabel="% of our time", xlim=(0, 100))
        for i, name in enumerate(shown):
            axes[1].annotate(f"{100 * parts[name] / total:.0f}", (100 * parts[name] / total, i), xytext=(3, 0),
                             textcoords="offset points", va="center", fontsize=6.5)
        axes[1].set_title("Where our time goes", loc="left")
        pictures.save(figure, path, dpi=figures.DPI)
