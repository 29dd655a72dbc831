#!/usr/bin/python3
"""Mutation fuzzer of the readers in tools/slope_tools: whatever the file, it is read, or told in one line.

    tests/fuzz/fuzz_readers.py [TARGET ...] [--seconds 600] [--seed 1] [--keep found]

A finding is any exception but SlopeError (MemoryError, too), a message that is not one printable line, a case of more
than SLOW seconds, words of a library on standard error, or the death of the process. What a case is made of stays in
--keep, in a folder of its own, which tests/tools/test_fuzz.py replays when it is moved to tests/fuzz/found/TARGET.

A case that fails at a new place, or the first that is read, joins the files that are mutated: the mutations find their
way past one rule after the other.
"""
import argparse
import contextlib
import copy
import gzip
import io
import json
import logging
import multiprocessing
import os
import random
import resource
import shutil
import subprocess
import sys
import tempfile
import time
import traceback
import warnings
import zipfile
from pathlib import Path

import yaml

HERE = Path(__file__).resolve().parent
TOOLS = Path(os.environ.get("SLOPE_TOOLS", HERE.parents[1] / "tools"))
sys.path[:0] = [str(TOOLS), str(HERE.parent / "tools")]

from slope_tools.case import run_folders  # noqa: E402
from slope_tools.deposits import dumps  # noqa: E402
from slope_tools.errors import SlopeError  # noqa: E402
from slope_tools.survey import crs, fggml, polygons, rasters  # noqa: E402

SLOW = 10.0                    # s
MEMORY = 8_000_000_000         # bytes of address space

NUMBERS = [b"0", b"-1", b"1", b"1.5", b"1e400", b"-1e400", b"1e-320", b"nan", b"inf", b"-inf", b"2147483648",
           b"99999999999999999999", b"9" * 5000, b"1_0", b"0x10", b"1e15", b"-9999", b"20000", b"100000", b""]
WORDS = [b"\0", b"\xff\xfe", b"\xef\xbb\xbf", b"\x1b[31m", "\u0663".encode(), b"#", b",", b"\n\n", b"\r", b"\t",
         b"<", b"&a;",
         b"*a", b"!!python/object:os.system", b"{}", b"[", b"]", b"null", b"EMPTY", b"<!DOCTYPE x []>", b"../../x"]
VALUES = [None, True, "", "x", "nan", 0, -1, 10 ** 400, 1e400, float("nan"), [], {}, [[]], {"a": 1}, "2001-99-99",
          1e-320]


# --- mutations ---

def mutate(data, pool, rng):
    """A few random changes of bytes; pool: other files to take pieces from."""
    data = bytearray(data)
    for _ in range(rng.choice((1, 1, 1, 2, 3, 6))):
        kind = rng.randrange(9)
        at = rng.randrange(len(data) + 1)
        to = min(len(data), at + rng.choice((1, 2, 4, 16, 64, 500)))
        if kind == 0 and data:
            data[at % len(data)] ^= 1 << rng.randrange(8)
        elif kind == 1:
            del data[at:to]
        elif kind == 2:
            data[at:at] = data[at:to] * rng.choice((1, 2, 50))
        elif kind == 3:
            data[at:at] = rng.choice(WORDS)
        elif kind == 4:
            del data[at:]
        elif kind == 5:
            other = rng.choice(pool)
            begin = rng.randrange(len(other) + 1)
            data[at:to] = other[begin:begin + rng.choice((4, 30, 300))]
        elif kind == 6:
            lines = bytes(data).split(b"\n")
            i, j = rng.randrange(len(lines)), rng.randrange(len(lines))
            lines[i], lines[j] = lines[j], lines[i] if rng.random() < 0.5 else lines[j]
            data = bytearray(b"\n".join(lines))
        else:           # a whole word, most often a number
            begin, end = at, at
            while begin > 0 and data[begin - 1] not in b" \t\n,<>:\"":
                begin -= 1
            while end < len(data) and data[end] not in b" \t\n,<>:\"":
                end += 1
            data[begin:end] = rng.choice(NUMBERS)
    return bytes(data)


def mutate_tree(tree, rng):
    """Another value, or none, somewhere in what YAML or JSON makes."""
    tree = copy.deepcopy(tree)
    node = tree
    while True:
        keys = list(node) if isinstance(node, dict) else range(len(node))
        if not keys:
            return tree
        key = rng.choice(keys)
        if isinstance(node[key], (dict, list)) and node[key] and rng.random() < 0.85:
            node = node[key]
        elif rng.random() < 0.3:
            del node[key]
            return tree
        else:
            node[key] = rng.choice(VALUES)
            return tree


def mutate_yaml(data, pool, rng):
    try:
        tree = yaml.safe_load(data) if rng.random() < 0.7 else None
    except (ValueError, RecursionError, yaml.YAMLError):
        tree = None
    if not isinstance(tree, (dict, list)) or not tree:
        return mutate(data, pool, rng)
    return yaml.safe_dump(mutate_tree(tree, rng), sort_keys=False).encode()


def mutate_json(data, pool, rng):
    try:
        tree = json.loads(data) if rng.random() < 0.7 else None
    except ValueError:
        tree = None
    return json.dumps(mutate_tree(tree, rng)).encode() if isinstance(tree, dict) and tree else mutate(data, pool, rng)


def mutate_zip(data, pool, rng):
    """Bytes of the zip, or of one of its members, or what its directory says of one."""
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            members = {info.filename: archive.read(info) for info in archive.infolist()}
    except Exception:       # of a broken one only the bytes are there
        members = {}
    if not members or rng.random() < 0.4:
        return mutate(data, pool, rng)
    name = rng.choice(list(members))
    change = mutate_zip if name.endswith(".zip") else mutate
    members[name] = change(members[name], list(members.values()), rng)
    if rng.random() < 0.2:
        other = rng.choice(("../../x.xml", "/etc/x.xml", "\x1b[2J.xml", "a\nb.xml", "x" * 3000 + ".xml"))
        members[other] = members[name]
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", rng.choice((zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED, zipfile.ZIP_LZMA))) as archive:
        for key, content in members.items():
            archive.writestr(key, content)
        if rng.random() < 0.2:
            info = rng.choice(archive.filelist)
            if rng.random() < 0.3:
                info.flag_bits = rng.choice((0, 1, 8, 2047, 65535))
            else:
                setattr(info, rng.choice(("file_size", "compress_size", "CRC", "header_offset")),
                        rng.choice((0, 1, 65535, 300_000_000, 2 ** 32 - 1)))
    return out.getvalue()


def mutate_gz(data, pool, rng):
    if rng.random() < 0.4:
        return mutate(data, pool, rng)
    try:
        return gzip.compress(mutate(gzip.decompress(data), pool, rng), 1)
    except Exception:       # of a broken one only the bytes are there
        return mutate(data, pool, rng)


# --- targets: files that are read, how they change, and who reads them ---

GRID = (b"ncols 4\nnrows 3\nxllcorner 10\nyllcorner 20\ncellsize 2.5\nNODATA_value -9999\n"
        b"1 2 3 4\n5 6.25 -9999 8\n9 1e1 11 12\n")
RINGS = b"# a road\nx,y\n0,0\n10,0\n10,10\n0,10\n\n2,2\n2,4\n4,4\n"
WKT = b"POLYGON ((0 0, 10 0, 10 10, 0 10, 0 0), (2 2, 2 4, 4 4, 2 2))\nMULTIPOLYGON (((20 20, 30 20, 30 30, 20 20)))\n"
DUMP = (b"ITEM: TIMESTEP\n10\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS ff ff ff\n0 1\n0 1\n0 1\n"
        b"ITEM: ATOMS id type x y z vx vy vz\n1 1 0.5 0.5 0.5 0 0 0\n2 1 0.1 1e-3 -0.5 1 1 1\n") * 2
SUMMARY = {"slope_version": "0.1.0", "lammps_version": "29 Sep 2021", "time": 12.5, "bulk_factor": 1.9, "moving": False,
           "ranks": 1, "dt": 1e-4, "stop": {"step": 10, "time": 1.0, "reason": "end"},
           "volume": {"released": 2.0, "on_grid": 2.0, "off_grid": 0.0, "lost": 0.0, "residual": 0.0},
           "balls": {"released": 2, "lost": 0}, "motion": {"moving_share": 0.0, "threshold": 0.1},
           "grid": {"cell": 1.0, "extent": {"xlo": 0.0, "xhi": 4.0, "ylo": 0.0, "yhi": 3.0}},
           "travel": {"front": 1.0, "front_at_release": 0.5, "centroid": 0.3, "reach_angle": 30.0},
           "largest": {"thickness": 1.0, "max_thickness": 1.0, "max_speed": 2.0, "max_energy": 1.0}}
TERRAIN = rasters.Place(None, (0.0, 0.0), (100, 100), (0.0, 0.0, 100.0, 100.0))


def tile():
    from test_fggml import heights, xml
    return xml(heights()).encode()


def zipped(**members):
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in members.items():
            archive.writestr(name.replace("_", "."), content)
    return out.getvalue()


def geojson():
    ring = [[139.8, 36.5], [139.9, 36.5], [139.9, 36.6], [139.8, 36.5]]
    return json.dumps({"type": "FeatureCollection", "features": [
        {"type": "Feature", "properties": {"a": 1}, "geometry": {"type": "Polygon", "coordinates": [ring]}},
        {"type": "Feature", "properties": {}, "geometry": {"type": "MultiPolygon", "coordinates": [[ring]]}}]}).encode()


def shapefile():
    """The files of a shapefile with two polygons."""
    import fiona
    with tempfile.TemporaryDirectory() as folder:
        with fiona.open(f"{folder}/p.shp", "w", "ESRI Shapefile", {"geometry": "Polygon", "properties": {"a": "int"}},
                        crs="EPSG:6677") as out:
            for k in range(2):
                ring = [(k, 0), (k + 1, 0), (k + 1, 1), (k, 0)]
                out.write({"geometry": {"type": "Polygon", "coordinates": [ring]}, "properties": {"a": k}})
        return {path.name: path.read_bytes() for path in Path(folder).iterdir()}


def geotiff():
    import numpy as np
    from affine import Affine
    with tempfile.TemporaryDirectory() as folder:
        rasters.write_geotiff(f"{folder}/a.tif", {"height": np.arange(12.0).reshape(3, 4)},
                              rasters.Raster(None, Affine(2, 0, 10, 0, -2, 20), crs.as_crs("", "EPSG:6677")))
        return Path(folder, "a.tif").read_bytes()


def sidecar():
    import numpy as np
    from affine import Affine
    with tempfile.TemporaryDirectory() as folder:
        rasters.write_asc_local(f"{folder}/a.asc", rasters.Raster(
            np.ones((3, 4)), Affine(2, 0, 0, 0, -2, 6), crs.as_crs("", "EPSG:6677"), (1e4, 2e4)), {})
        return {path.name: path.read_bytes() for path in Path(folder).iterdir()}


def study():
    """The files of a study of two combinations with a repeat, some seconds of work."""
    from tiny_collapse import LMP, write_case
    with tempfile.TemporaryDirectory() as folder:
        deck = write_case(Path(folder, "case"))
        deck.write_text(deck.read_text().replace("sc 1.0", "sc 1.0 origin ${xoffset} 0 0").replace(
            "variable  kn", "variable  xoffset index 0\nvariable  kn"))
        subprocess.run([sys.executable, TOOLS / "slope", "study", deck, "--set", "rolling=0,0.3", "--repeat",
                        "xoffset=0.4", "-o", f"{folder}/out", "--road", deck.with_name("road.csv"), "--mesh", "4"],
                       env={**os.environ, "LMP": LMP}, capture_output=True, check=True)
        return {str(path.relative_to(f"{folder}/out")): path.read_bytes()
                for path in Path(folder, "out").rglob("*") if path.is_file()}


def read_page(folder):
    """The report on a study, all but the drawing."""
    from slope_tools.plots import figure_charts, figure_maps
    from slope_tools.report import document
    from slope_tools.report.heading import Asked
    for name in ("value_map", "terrain_map", "mesh_map", "small_maps"):
        setattr(figure_maps, name, lambda *_, **__: "")
    for name in ("bars", "chart", "convergence"):
        setattr(figure_charts, name, lambda *_, **__: "")
    figure_charts.draw_section = lambda *_, **__: ("", 1, None)
    page, _ = document.make_page(Asked(folder))
    page.section.table()
    page.numbers.table()


def one(name, *contents):
    """Seeds of a target whose cases are a single file."""
    return lambda: [{name: content() if callable(content) else content} for content in contents]


def of(name, read):
    """A reader of that file of the case."""
    return lambda folder: read(folder / name)


def polygon(path):
    polygons.read_local(path, TERRAIN, local=True)


REFERENCE = {"title": "Measured", "remark": "elsewhere", "quantities": {
    "remove_m3": {"variable": "rolling", "series": {"theirs": {0.0: 4711, 0.3: 12.5}}, "levels": {"measured": 1234}},
    "front_m": {"levels": {"mapped": 33.5}}}}
CONVERGE = {"study": {"variable": "d", "deck": "in.tiny", "finished": 4, "base": {"rolling": "0"}, "road": None},
            "quantities": {"remove_m3": {
                "name": "to remove", "unit": "m3", "slope": {"value": -1200.0, "standard_error": 90.0},
                "small_balls": {"value": 17400.0, "standard_error": 200.0, "low": 16900.0, "high": 17900.0},
                "supported": True, "covariance": -3.0, "quantile": 2.4, "errors_known": True,
                "sizes": [{"value": 4.0, "runs": 2, "mean": 12600.0, "scatter": 300.0, "fitted": 12600.0,
                           "error_percent": -27.6, "standard_error_percent": 2.0},
                          {"value": 2.5, "runs": 1, "mean": 14400.0, "scatter": None, "fitted": 14400.0,
                           "error_percent": -17.2, "standard_error_percent": None}]}}}


def sizes(path):
    """converge.yaml, as the report takes it."""
    from slope_tools.plots import figure_charts
    from slope_tools.report import convergence_part as report_convergence, numbers as report_numbers
    found = report_convergence.Sizes(path)
    figure_charts.convergence = lambda *_: ""
    found.section(report_numbers.Numbers())


def reference_of(path):
    from slope_tools.report import reference
    reference.read_reference(path, {"remove_m3": "to remove", "front_m": "farthest ball"})


# name: seeds, how a file is changed, which files are (None: all), reader
TARGETS = {
    "asc": (one("a.asc", GRID), mutate, None, of("a.asc", rasters.read_asc_local)),
    "sidecar": (lambda: [sidecar()], mutate_yaml, ("a.yaml",), of("a.asc", rasters.read_asc_local)),
    "geotiff": (one("a.tif", geotiff), mutate, None, of("a.tif", rasters.read_raster)),
    "csv": (one("a.csv", RINGS), mutate, None, of("a.csv", polygon)),
    "wkt": (one("a.wkt", WKT), mutate, None, of("a.wkt", polygon)),
    "geojson": (one("a.geojson", geojson), mutate_json, None, of("a.geojson", polygon)),
    "shapefile": (lambda: [shapefile()], mutate, None, of("p.shp", polygon)),
    "xml": (one("a.xml", tile), mutate, None, of("a.xml", fggml.read_fggml_tiles)),
    "zip": (one("a.zip", lambda: zipped(a_xml=tile(), b_xml=tile()), lambda: zipped(a_zip=zipped(b_xml=tile()))),
            mutate_zip, None, of("a.zip", fggml.read_fggml_tiles)),
    "dump": (one("a.dump", DUMP), mutate, None, of("a.dump", lambda path: dumps.last(path, ("type", "vx")))),
    "dump_gz": (one("a.gz", lambda: gzip.compress(DUMP)), mutate_gz, None, of("a.gz", dumps.last)),
    "summary": (one("a.summary.yaml", yaml.safe_dump(SUMMARY).encode()), mutate_yaml, None,
                of("a.summary.yaml", lambda path: [run_folders.load_summary(path, schema)
                                                   for schema in (run_folders.OF_DEPOSIT, run_folders.SUMMARY)])),
    "reference": (one("r.yaml", yaml.safe_dump(REFERENCE).encode()), mutate_yaml, None, of("r.yaml", reference_of)),
    "converge": (one("c.yaml", yaml.safe_dump(CONVERGE).encode()), mutate_yaml, None, of("c.yaml", sizes)),
    "study": (lambda: [study()], mutate_yaml, ("study.yaml", "tiny.summary.yaml", "variables.yaml", "finished.yaml",
                                               "log.lammps", "in.tiny", "road.csv"), read_page),
}


# --- the work ---

def check(read, folder):
    """Read a case; what is wrong as text, or None; and where it ended."""
    began = time.monotonic()
    with tempfile.TemporaryFile() as told:
        with standard_error_to(told):
            wrong, where = _check(read, folder)
        if wrong is None and told.tell() > 0:
            told.seek(0)
            wrong = f"on standard error: {told.read(300)}"
    if wrong is None and time.monotonic() - began > SLOW:
        wrong = f"took {time.monotonic() - began:.1f} s"
    return wrong, where


@contextlib.contextmanager
def standard_error_to(file):
    """Standard error goes there, that of the libraries, too."""
    before = os.dup(2)
    os.dup2(file.fileno(), 2)
    try:
        yield
    finally:
        sys.stderr.flush()
        os.dup2(before, 2)
        os.close(before)


def _check(read, folder):
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            read(folder)
        where = "read"
    except SlopeError as error:
        where = tuple((frame.filename, frame.lineno) for frame in traceback.extract_tb(error.__traceback__)
                      if "slope_tools" in frame.filename)
        if not str(error).isprintable() or len(str(error)) > 4000:
            return f"not one printable line: {str(error)[:300]!r}", where
    except Exception:
        return traceback.format_exc(), "bad"
    return None, where


def write_case(case, folder):
    shutil.rmtree(folder, ignore_errors=True)
    for name, content in case.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(content)


def fuzz(target, seconds, seed, keep, most=None):
    """Fuzz one target in this process; the number of cases and the findings, {place: text}."""
    make, change, changed, read = TARGETS[target]
    rng = random.Random(f"{target} {seed}")
    pool, places, findings = make(), set(), {}
    work = Path(tempfile.mkdtemp(prefix=f"fuzz_{target}."))
    logging.disable(logging.CRITICAL)
    for case in pool:
        write_case(case, work / "case")
        wrong, _ = check(read, work / "case")
        assert wrong is None, f"seed of {target}: {wrong}"
    count, end = 0, time.monotonic() + seconds
    while time.monotonic() < end and (most is None or count < most):
        case = dict(rng.choice(pool[:2] + pool[-20:] if rng.random() < 0.5 else pool))
        names = [name for name in case if changed is None or name.rsplit("/", 1)[-1] in changed]
        name = rng.choice(names)
        case[name] = change(case[name], [other[name] for other in pool], rng)
        write_case(case, work / "case")      # on disk before it is read: it is still there if the process dies
        wrong, where = check(read, work / "case")
        count += 1
        if wrong:
            place = tuple(line for line in wrong.splitlines() if line.startswith("  File"))[-2:] or wrong[:60]
            if place not in findings:
                findings[place] = wrong
                shutil.copytree(work / "case", keep / target / f"{seed}.{count}")
                print(f"{target}: case {count}: {wrong}", flush=True)
        elif where not in places and sum(map(len, case.values())) < 1_000_000:
            places.add(where)
            pool.append(case)
    shutil.rmtree(work)
    print(f"{target}: {count} cases, {len(places)} ends, {len(findings)} findings", flush=True)
    return count, findings


def child(target, args):
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    sys.exit(1 if fuzz(target, args.seconds, args.seed, args.keep)[1] else 0)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("targets", metavar="TARGET", nargs="*", help=f"of {', '.join(TARGETS)} (default: all)")
    parser.add_argument("--seconds", type=float, default=600, help="for each target (default 600)")
    parser.add_argument("--seed", type=int, default=1, help="of the random numbers (default 1)")
    parser.add_argument("--keep", type=Path, default=Path("found"), help="folder for the findings (default found)")
    args = parser.parse_args()
    bad = [target for target in args.targets if target not in TARGETS]
    if bad:
        parser.error(f"TARGET must be of {', '.join(TARGETS)}, got {bad[0]}")
    status = 0
    for target in args.targets or TARGETS:
        process = multiprocessing.Process(target=child, args=(target, args))
        process.start()
        process.join()
        if process.exitcode not in (0, 1):
            print(f"{target}: the process ended with {process.exitcode}; its case is in "
                  f"{tempfile.gettempdir()}/fuzz_{target}.*/case")
        status = max(status, 1 if process.exitcode else 0)
    return status


if __name__ == "__main__":
    sys.exit(main())
