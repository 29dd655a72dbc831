"""slope volume: what must be removed from a road, per mesh cell and in total, above a cut that rises from its edges.

Order of the work: read the run, the road and its axis; cut (cut.py); sum per mesh cell; write tables and maps.
"""
from dataclasses import dataclass
from pathlib import Path
from typing import Optional

from .. import disk, findings
from ..deposits import left_words, volume
from ..deposits.volume import CUT_ANGLE, MUCH_BELOW, SAMPLES
from ..digits import cents
from ..options import Overwrite, flag, option, positional, parse_whole_number
from ..studies import outdated
from ..tables import named_run
from . import road_arguments

DESCRIPTION = ("Volume to remove from a road, per mesh cell and in total, above a cut surface that rises from the "
               "road's edges.")
EPILOG = """\
units: metres, m3, degrees. PREFIX is what fix deposit/grid was given as output, or a folder.

example: meshes of 10 m, the road from a GIS, and the volume also as loosened ground (bulk factor 2.3):
  tools/slope volume embankment --road route4.geojson --cut-angle 30 --mesh 10 --bulk 2.3 -o removal

the road as a line, a lane of 3.5 m, and the hours of a loader that clears 60 m3 of loosened ground in an hour:
  tools/slope volume embankment --road axis.geojson --road-width 8 --road-from 12.3 --mesh 10 --lane 3.5 \\
      --clearing 60 --loosening 1.3 -o removal

Writes volume.yaml, volume.csv, volume.geojson, volume_mesh.tif, volume.tif, axis.csv, stretches.csv, stretches.gpkg and
volume.png.
"""


@dataclass(frozen=True, kw_only=True)
class Request(road_arguments.Clearing, Overwrite):
    prefix: str = positional(
        "output of fix deposit/grid: PREFIX.thickness.asc and so on; or one of these files; or the folder of a run, "
        "or of a study or site, which stands for its governing run", metavar="PREFIX")
    road: Path = option(road_arguments.ROAD, metavar="POLYGON|LINE")
    cut_angle: float = option(
        f"rise of the cut surface with distance from the road's edges, degrees (default "
        f"{CUT_ANGLE:g})", metavar="DEG", default=CUT_ANGLE)
    mesh: float = option(
        "side of the mesh cells, m; their corners are at multiples of it in local x and y", metavar="SIZE")
    output: Optional[Path] = option("folder for the results (default PREFIX.volume; of a folder, FOLDER/volume)", "-o",
                                    metavar="DIR")
    terrain: Optional[Path] = option(
        "the run's terrain, whose sidecar holds the CRS (default: terrain.asc beside PREFIX)", metavar="TERRAIN.asc")
    local: bool = flag("the road and the axis are in local metres, not in a CRS")
    bulk: Optional[float] = option(
        "also give the volumes for this bulk factor (volume of ground / volume of the balls)", metavar="FACTOR")
    axis: Optional[Path] = option(
        "the road's axis: GeoJSON, shapefile, CSV or WKT (default: the road's middle)", metavar="LINE")
    samples: int = option(
        f"parts of a cell along a side for round corners and rough ground, even, 2 to 32 (default "
        f"{SAMPLES}); planes are exact with any", metavar="K", type=parse_whole_number, default=SAMPLES)
    no_picture: bool = flag("without volume.png, which takes longest")


def run_volume(args: Request) -> None:
    """Do the command; raises SlopeError on bad input. Prints the totals."""
    wanted = volume.Wanted(args.road, args.mesh, args.cut_angle, args.local, args.axis, args.bulk,
                           road_arguments.asked(args), args.samples)
    volume.check_wanted_volume(wanted)
    named = named_run.read_named_run(args.prefix)
    outdated.check_study_current(Path(args.prefix), named.study)
    folder = args.output or (named.folder / "volume" if named.folder else Path(f"{named.prefix}.volume"))
    disk.check_folder(folder, volume.FILES, [named.prefix, args.road], args.overwrite)
    found = volume.compute_removal(named.prefix, wanted, args.terrain, findings.printer("volume"))
    volume.write_removal(found, folder, picture=not args.no_picture)
    if named.study:
        print(f"{named.run}, the governing run of {named.study}: {named.prefix}")
    print(describe_removal(found.about, folder))


def describe_removal(summary, folder):
    """What the user needs to know."""
    volume, axis = summary["volume"], summary["axis"]
    below = volume["remove_where_cut_below_ground"]
    lines = [f"to remove: {volume['remove']:.1f} m3 of {volume['deposit']:.1f} m3: {volume['remove_on_road']:.1f} m3 "
             f"on the road, {volume['remove_beside_road']:.1f} m3 beside it above a cut of "
             f"{summary['cut_angle']:g} degrees"]
    if below > 0:
        share = below / volume["remove"]
        lines.append(f"{below:.1f} m3 of that ({cents(share, 3)}) where the cut surface lies below the ground before "
                     f"the collapse, which is steeper than {summary['cut_angle']:g} degrees there"
                     + (": is the cut angle right?" if share > MUCH_BELOW else ""))
    lines.append(f"bulk factor {summary['bulk_factor']:.6g}, the run's")
    if "other_bulk_factor" in summary:
        lines[-1] += (f"; at {summary['other_bulk_factor']:.6g}: "
                      f"{summary['volume_at_other_bulk_factor']['remove']:.1f} m3 " "to remove")
    lines.append(f"axis: thicker than {axis['blocked_above']:g} m over {axis['blocked_length']:.1f} of "
                 f"{axis['length']:.1f} m, up to {axis['largest_thickness']:.2f} m")
    lines += of_stretches(summary["stretches"], summary["clearing"])
    lines += of_mass(summary["divided"], summary["left"])
    lines.append(f"mesh of {summary['mesh']['size']:g} m: {summary['mesh']['cells_to_clear']} cells to clear")
    lines.append(f"written to {folder}: {' '.join(summary['files'])}")
    return "\n".join(lines)


def of_stretches(stretches, total):
    """Lines on the blocked stretches, one for each, and on all of them."""
    def with_hours(stretch, volume, hours):
        return f"{stretch[volume]:.1f} m3" + (f" ({stretch[hours]:.1f} hours)" if hours in stretch else "")

    for number_, one in enumerate(stretches, 1):
        lane = f"; a lane: {with_hours(one, 'remove_lane', 'hours_lane')}, {one['lane_offset']:+.2f} m from the axis" \
            if "remove_lane" in one else ""
        yield (f"stretch {number_}: {one['from']:.1f} to {one['to']:.1f} m, up to "
               f"{one['largest_thickness_on_axis']:.2f} m on the axis, {one['passable_width']:.2f} m passable; "
               f"to remove: {with_hours(one, 'remove', 'hours')}{lane}")
    if "hours" in total or "lane" in total:
        lane = f"; a lane of {total['lane']:g} m: {with_hours(total, 'remove_lane', 'hours_lane')}" \
            if "lane" in total else ""
        yield f"all stretches: {with_hours(total, 'remove', 'hours')}{lane}"


def of_mass(divided, left):
    """Lines on the mass before the road and beyond it, and on what left the terrain."""
    if divided is None:
        return
    end = f", {divided['past_end']:.1f} m3 of them past its end" if divided["past_end"] > 0 else ""
    yield (f"of the released volume {divided['before']:.1f} m3 before the road, {divided['on']:.1f} on it, "
           f"{divided['past']:.1f} beyond it{end}")
    if divided["unknown"] > 0:
        yield (f"{divided['unknown']:.1f} m3 left the terrain, and it is not known where: a run of an older version, "
               "without dumps")
    elif said := left_words.sentence(left):
        yield f"left the terrain: {said}"
