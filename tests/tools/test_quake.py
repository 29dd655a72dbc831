"""tools/slope quake: formats round-trip fixtures with their traps; what is written integrates back to what is said."""
import glob
import gzip
import math
import re
import shlex
import subprocess
import tarfile
import zipfile
from pathlib import Path

import numpy as np
import pytest
import yaml

from run_helpers import TOP, examples

from slope_tools.errors import SlopeError
from slope_tools.quakes import motion_file, quake_motion, quake_records

COMMAND = "quake"
DT = 0.01
T = DT * np.arange(2000)
GAL, G = 0.01, 9.80665


def wave(frequency, amplitude, phase=0.0):
    """A pulse of some seconds, m/s2."""
    return amplitude * np.sin(2 * np.pi * frequency * T + phase) * np.exp(-((T - 8) / 3) ** 2)


EW, NS, UD = wave(1.5, 3.0), wave(2.3, 2.0, 1.0), wave(4.0, 1.0, 2.0)


def refused(slope, arguments, *parts):
    """One line that has all parts, status 2, and no file but those that were there."""
    before = sorted(Path().iterdir())
    status, out, err = slope(arguments)
    assert status == 2 and out == "" and err.count("\n") == 1, err
    for part in parts:
        assert part in err, err
    assert sorted(Path().iterdir()) == before


def read_motion(path="motion.txt"):
    return np.loadtxt(path)


# --- fixtures ---


def knet(path, values, direction, factor=(3920, 6182761), rate=100, width=8, offset=1234, end="\n", most=None, **head):
    """NIED's ASCII; values in m/s2; offset: counts of the instrument's zero."""
    counts = np.round(values / GAL * factor[1] / factor[0]).astype(int) + offset
    real = (counts - counts.mean()) * factor[0] / factor[1]
    lines = {"Origin Time": "2011/03/11 14:46:00", "Lat.": "38.103", "Long.": "142.860", "Depth. (km)": "024",
             "Mag.": "9.0", "Station Code": "FKS005", "Station Lat.": "37.6", "Station Long.": "141.0",
             "Station Height(m)": "40", "Record Time": "2011/03/11 14:46:36", "Sampling Freq(Hz)": f"{rate}Hz",
             "Duration Time(s)": f"{len(values) / rate:g}", "Dir.": direction,
             "Scale Factor": f"{factor[0]}(gal)/{factor[1]}",
             "Max. Acc. (gal)": f"{np.abs(real).max() if most is None else most:.3f}",
             "Last Correction": "2011/03/11 14:46:21", "Memo.": ""}
    lines.update(head)
    text = [f"{key:<18}{value}" for key, value in lines.items()]
    text += ["".join(f"{count:9d}" for count in counts[k:k + width]) for k in range(0, len(counts), width)]
    Path(path).write_bytes((end.join(text) + end).encode("ascii"))


def three_knet(**settings):
    knet("a.EW", EW, "E-W", **settings)
    knet("a.NS", NS, "N-S", **settings)
    knet("a.UD", UD, "U-D", **settings)


def at2(path, values, direction, unit="G", width=5, size=None, form="{:15.7E}"):
    size = size or f"NPTS= {len(values):6d}, DT= {DT:.5f} SEC,"
    numbers = [form.format(value / (G if unit == "G" else GAL)) for value in values]
    lines = ["PEER NGA STRONG MOTION DATABASE RECORD", f"Tohoku, 3/11/2011, Station 5, {direction}",
             f"ACCELERATION TIME SERIES IN UNITS OF {unit}", size]
    lines += ["".join(numbers[k:k + width]) for k in range(0, len(numbers), width)]
    Path(path).write_text("\n".join(lines) + "\n")


# --- K-NET, KiK-net ---


@pytest.mark.parametrize("settings", [{}, {"factor": (2000, 8388608)}, {"width": 5}, {"end": "\r\n"},
                                      {"offset": -70000}, {"Memo.": "sensor changed"}, {"Lat.": ""}])
def test_knet(slope, settings):
    three_knet(**settings)
    status, out, err = slope("a.EW a.NS a.UD --baseline mean -o motion.txt")
    assert status == 0 and err == "" and out.endswith("\nfix shake soil ground/motion motion.txt\n")
    motion = read_motion()
    assert motion[:, 0] == pytest.approx(T, abs=1e-9)
    step = GAL * settings.get("factor", (3920, 6182761))[0] / settings.get("factor", (3920, 6182761))[1]
    for k, values in enumerate((EW, NS, UD), 1):
        assert motion[:, k] == pytest.approx(values - values.mean(), abs=0.51 * step + 1e-9)


def test_kiknet_surface_and_borehole(slope):
    knet("a.NS2", NS[:1000], "4", rate=200)
    knet("a.EW2", EW[:1000], "5", rate=200)
    knet("a.UD2", UD[:1000], "6", rate=200)
    knet("a.EW1", EW[:1000], "2", rate=200)
    assert slope("a.NS2 a.EW2 a.UD2 --baseline none -o motion.txt")[0] == 0
    motion = read_motion()
    assert motion[-1, 0] == pytest.approx(999 * 0.005)
    assert motion[:, 1] - motion[:, 1].mean() == pytest.approx(EW[:1000] - EW[:1000].mean(), abs=1e-5)
    refused(slope, "a.NS2 a.EW2 a.EW1 -o x.txt", "a.EW1: must be of the sensor of a.NS2, at the surface, got in the")
    knet("a.UD1", UD[:1000], "3", rate=200)
    refused(slope, "a.NS2 a.EW2 a.UD1 -o x.txt", "a.UD1: must be of the sensor of a.NS2")
    knet("b.EW2", NS[:1000], "5", rate=200)
    refused(slope, "a.NS2 a.EW2 b.EW2 -o x.txt", "b.EW2: at most two horizontal components")


@pytest.mark.parametrize("change, message", [
    (lambda text: text[:-200], "a.EW: must hold the 2000 values that its head promises, it is cut short, got 19"),
    (lambda text: text + "12 13\n", "it has too many, got 2002"),
    (lambda text: text.replace("3920(gal)", "3920"), "head must have a line Scale Factor such as 3920(gal)/6182761"),
    (lambda text: text.replace("3920(gal)", "392(gal)"), "the largest acceleration must be the head's Max. Acc."),
    (lambda text: text.replace("100Hz", "fast"), "must have a line Sampling Freq(Hz) such as 100Hz, got 'fast'"),
    (lambda text: text.replace("E-W", "E"), "the head must have a line Dir. with N-S, E-W, U-D or 1 to 6, got 'E'"),
    (lambda text: text[:2000] + "x" + text[2001:], "must hold numbers only"),
    (lambda text: "", "a.EW: must hold a record, it is empty"),
])
def test_a_knet_file_that_is_wrong(slope, change, message):
    knet("a.EW", EW, "E-W")
    text = Path("a.EW").read_text()
    assert change(text) != text
    Path("a.EW").write_text(change(text))
    refused(slope, "a.EW -o motion.txt", message)


def test_components_of_different_records(slope):
    knet("a.EW", EW, "E-W")
    knet("b.NS", NS, "N-S", **{"Record Time": "2011/03/11 14:46:40"})
    refused(slope, "a.EW b.NS -o motion.txt", "b.NS: must begin when a.EW does, 2011/03/11 14:46:36, got",
            "14:46:40")
    knet("b.NS", NS, "N-S", **{"Station Code": "FKS006"})
    refused(slope, "a.EW b.NS -o motion.txt", "b.NS: must be of the earthquake and station of a.EW, "
            "2011/03/11 14:46:00 at FKS005, got 2011/03/11 14:46:00 at FKS006")
    knet("b.NS", NS, "N-S", **{"Origin Time": "2011/03/11 14:51:00"})
    refused(slope, "a.EW b.NS -o motion.txt", "b.NS: must be of the earthquake and station of a.EW, 2011/03/11")
    for old, new in (("Tohoku", "Iwaki"), ("Station 5", "Station 15"), ("3/11/2011", "4/11/2011")):
        at2("a.AT2", EW, "090")
        at2("b.AT2", NS, "000")
        Path("b.AT2").write_text(Path("b.AT2").read_text().replace(old, new))
        refused(slope, "a.AT2 b.AT2 -o motion.txt", "b.AT2: must be of the earthquake and station of a.AT2, TOHOKU, ")
    knet("c.NS", NS, "N-S", rate=200)
    refused(slope, "a.EW c.NS -o motion.txt", "c.NS: must have the time step of a.EW, 0.01 s, got 0.005 s")


# --- PEER AT2 ---


@pytest.mark.parametrize("settings", [{}, {"width": 8}, {"width": 1}, {"size": f"  2000    {DT:.4f}    NPTS, DT"},
                                      {"size": "NPTS=2000, DT=.01 SEC"}, {"size": "NPTS= 2000  DT= .01 SEC"},
                                      {"unit": "CM/S/S"}, {"unit": "CM/SEC2"}, {"unit": "CM/SEC**2"},
                                      {"form": "{:+.7E}"}])    # nothing between two numbers
def test_at2(slope, settings):
    at2("a.AT2", EW, "090", **settings)
    at2("b.AT2", NS[:1990], "000", **{**settings, **({} if "size" not in settings else
                                                     {"size": settings["size"].replace("2000", "1990")})})
    at2("c.AT2", UD, "UP", **settings)
    assert slope("a.AT2 b.AT2 c.AT2 --baseline none -o motion.txt")[0] == 0
    motion = read_motion()
    assert len(motion) == 1990    # of the shortest one
    for k, values in enumerate((EW, NS, UD), 1):
        assert motion[:, k] == pytest.approx(values[:1990], abs=2e-6)


def test_at2_turned(slope):
    """Components towards 120 and 210 degrees; x towards 120: the first one is x, the second one runs to the right."""
    at2("a.AT2", EW, "120")
    at2("b.AT2", NS, "210")
    at2("c.AT2", UD, "DWN")
    assert slope("a.AT2 b.AT2 c.AT2 --azimuth 120 --baseline none -o motion.txt")[0] == 0
    assert read_motion()[:, 1:] == pytest.approx(np.column_stack([EW, -NS, -UD]), abs=2e-6)


@pytest.mark.parametrize("change, parts", [
    (lambda text: text[:-100], ["must hold the 2000 values that its head promises, it is cut short"]),
    (lambda text: text.replace("UNITS OF G", "UNITS OF FURLONGS"), ["a.AT2, line 3: must end in UNITS OF G"]),
    (lambda text: text.replace("NPTS=", "POINTS="), ["a.AT2, line 4: must be NPTS= n, DT= s SEC"]),
    (lambda text: text.replace("DT= 0.01", "DT= 0.00.01"), ["a.AT2, line 4: must be NPTS= n, DT= s SEC"]),
    (lambda text: text.replace(", 090", ", somewhere"), ["a.AT2, line 2: must end in the direction, an azimuth or UP"]),
    (lambda text: text.replace(", 090", ", BH100"), ["a.AT2, line 2: must end in the direction", "metadata", "BH100'"]),
    (lambda text: text.replace(", 090", ", 400"), ["a.AT2, line 2: must end in the direction"]),
    (lambda text: "\n".join(text.splitlines()[:4]), ["must have four lines of head and values (cut short), got 4"]),
])
def test_an_at2_file_that_is_wrong(slope, change, parts):
    at2("a.AT2", EW, "090")
    text = Path("a.AT2").read_text()
    assert change(text) != text
    Path("a.AT2").write_text(change(text))
    refused(slope, "a.AT2 -o motion.txt", "a.AT2", *parts)


def test_not_at_right_angles(slope):
    at2("a.AT2", EW, "090")
    at2("b.AT2", NS, "030")
    refused(slope, "a.AT2 b.AT2 -o motion.txt", "b.AT2: two horizontal components must be at right angles",
            "got 90 degrees and 30 degrees")


# --- networks, as tool_quake.rst lists them ---


DAT = "20260101_000000"
HNE = f"XX.STA..HNE.D.{DAT}.C.ACC.ASC"


def rows_of(*columns, form="{:.6f}", mark=" ", end="\n"):
    return "".join(mark.join(form.format(value / GAL) for value in row) + end for row in zip(*columns))


def dyna(path, values, stream, unit="cm/s^2", **change):
    head = {"EVENT_NAME": "X", "EVENT_ID": "E-1", "MAGNITUDE_W": "", "NETWORK": "XX", "STATION_CODE": "STA",
            "DATE_TIME_FIRST_SAMPLE_YYYYMMDD_HHMMSS": f"{DAT}.870", "SAMPLING_INTERVAL_S": "0.010000",
            "NDATA": len(values), "STREAM": stream, "UNITS": unit, "DATA_TYPE": "ACCELERATION", "USER5": "", **change}
    Path(path).write_text("".join(f"{key}: {value}\n" for key, value in head.items()) + rows_of(values))


def three_dyna():
    for stream, values in zip(("HNE", "HNN", "HNZ"), (EW, NS, UD)):
        dyna(f"XX.STA..{stream}.D.{DAT}.C.ACC.ASC", values, stream)
        dyna(f"XX.STA..{stream}.D.{DAT}.C.VEL.ASC", values, stream, "cm/s", DATA_TYPE="VELOCITY")


def afad(path="20260101_0001.txt"):
    Path(path).write_text(
        "STRONG GROUND MOTION RECORDS OF TURKIYE\nPLACE                   : X\n"
        "EARTHQUAKE DATE         : 2026/01/01 00:00:00 (GMT)\nSTATION ID              : 4304\n"
        f"NUMBER OF DATA          : {len(T)}\nSAMPLING INTERVAL (sec) : 0.01\n"
        "RAW PGA VALUES (gal)    : (N-S) 1.2 (E-W) 1.2 (U-D) 0.6\nCopyright EARTHQUAKE DEPARTMENT\n"
        "       N-S          E-W          U-D\n" + rows_of(NS, EW, UD, form="{:12.6f}"), encoding="latin-1")


def cwa(path="2-STA.dat", order=("U(+)", "N(+)", "E(+)")):
    columns = {"U": UD, "N": NS, "E": EW}
    values = [columns[one[0]] * (-1 if "-" in one else 1) for one in order]
    Path(path).write_text(
        "#Earthquake Information\n#Origin Time(GMT+08): 2026/01/01-00:00:00\n\n#StationCode: STA\n"
        "#StartTime(GMT+08): 2026/01/01-00:00:09.000\n#SampleRate(Hz): 100\n"
        "#AmplitudeUnit:  gal. DCoffset(corr)\n"
        f"#DataSequence: Time {'; '.join(order)}\n#Data: 4F10.3 \n" + rows_of(T * GAL, *values, form="{:9.3f}"))


def jma(path="acc123.csv", names="NS,EW,UD"):
    head = ["SITE CODE= 123\u76ca\u57ce,37.5,137.2,16,7.6,,,", " LAT.= 37.0,,,,,,,", " SAMPLING RATE= 100Hz,,,,,,,",
            " UNIT  = gal(cm/s/s),,,,,,,", "INITIAL TIME = 2026 01 01 00 00 00,,,,,,,", f"{names},,,,,"]
    text = "".join(line + "\r\n" for line in head) + rows_of(NS, EW, UD, form="{:.3f}", mark=",", end=",,,,,\r\n")
    Path(path).write_bytes(text.encode("shift_jis"))


def geonet(path, processed=False):
    """N28W, S62W, Up; processed: velocities and displacements follow."""
    blocks = []
    for bearing, azimuth in (("N28W", 332), ("S62W", 242), ("Up", None)):
        turned = np.radians(azimuth or 0.0)
        values = UD if azimuth is None else EW * np.sin(turned) + NS * np.cos(turned)
        series = [values * 1000, values * 300, values * 5] if processed else [values * 1000]
        lines = [f"{'C' if processed else 'Unc'}orrected accelerogram {DAT}_STA_20 GNS Science",
                 "Site STA       42 37 10S  173 03 13E", f"Accelerogram {DAT}_STA_20     Processed 2026 January 09",
                 "2026 January 01          00:00:09 UT", f"Number of points  {len(values)}    Duration 20.00 s",
                 "Instrument corrected data at 0.010 sec intervals" if processed else
                 "Raw readings in units of 1.00 mm/s/s  at intervals of 0.010 s", f"Component {bearing}",
                 "Acceleration:  peak  -9733.1 mm/s/s at  44.88 sec     rms    719.0 mm/s/s"]
        lines += ["    2026       1       1       0       0     560       0       0    2026       1"] * 10
        for one in series:
            lines += ["".join(f"{value:8.1f}" for value in one[k:k + 10]) for k in range(0, len(one), 10)]
        blocks += lines
    Path(path).write_text("\n".join(blocks) + "\n")


def csmip(path="CE89146.V2"):
    """Three channels with nothing between numbers, of which awk makes AT2."""
    lines = []
    for name, values in (("90 Deg", EW), ("360 Deg", NS), ("Up", UD)):
        lines += ["Corrected accelerogram   89146-L2500    Chan", f"Chan  1: {name}", "    1  100    1    3",
                  f"{len(T):6d} points of accel data equally spaced at  .010 sec, in cm/sec2. (8f10.5)"]
        for kind in ("veloc", "displ", ""):
            lines += ["".join(f"{value / GAL:10.5f}" for value in values[k:k + 8]) for k in range(0, len(T), 8)]
            lines += [f"{len(T):6d} points of {kind} data equally spaced"] if kind else ["/&"]
    Path(path).write_text("\n".join(lines) + "\n")


def archive(path, *names):
    """A zip or tar.gz of files, which are taken away."""
    if path.endswith(".zip"):
        with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as made:
            [made.write(name) for name in names]
    else:
        with tarfile.open(path, "w:gz") as made:
            [made.add(name) for name in names]
    [Path(name).unlink() for name in names]


def knet_archive():
    three_knet()
    archive("FKS0051103111446.tar.gz", "a.EW", "a.NS", "a.UD")


def kiknet(station="FKSH10"):
    for code, (end, values) in enumerate((("NS1", NS), ("EW1", EW), ("UD1", UD)), 1):
        knet(f"{station}.{end}", 0.3 * values, str(code), **{"Station Code": station})
        knet(f"{station}.{end[:2]}2", values, str(code + 3), **{"Station Code": station})
    return [f"{station}.{end}{sensor}" for sensor in "12" for end in ("NS", "EW", "UD")]


def peer():
    at2("RSN1_A090.AT2", EW, "090")
    at2("RSN1_A000.AT2", NS, "000")
    at2("RSN1_A-UP.AT2", UD, "UP")
    for name in ("VT2", "DT2"):
        at2(f"RSN1_A090.{name}", EW, "090")
        Path(f"RSN1_A090.{name}").write_text(Path(f"RSN1_A090.{name}").read_text().replace(
            "ACCELERATION", "VELOCITY" if name == "VT2" else "DISPLACEMENT").replace("OF G", "OF CM"))
    Path("_SearchResults.csv").write_text("Record Sequence Number,EQID\n1,2\n")
    archive("PEERNGARecords_Unscaled.zip", *glob.glob("RSN1*"), "_SearchResults.csv")


MAKERS = {"NIED K-NET": knet_archive, "NIED KiK-net": lambda: archive("FKSH101103111446.tar.gz", *kiknet()),
          "PEER": peer, "ESM, ITACA, AFAD": three_dyna, "AFAD, before": afad, "CWA": cwa, "JMA": jma,
          "GeoNet": lambda: geonet(f"{DAT}_STA_20.V2A", True), "CSMIP": csmip}


def listed():
    """Rows of the page's table: network, and what is typed."""
    text = (TOP / "doc" / "src" / "tool_quake.rst").read_text(encoding="utf-8")
    part = text.partition(".. list-table::")[2].partition("\nFewer values")[0]
    rows = re.findall(r"^   \* - (.*?)\n     - .*?\n     - (.*?)(?=\n   \* - |\Z)", part, re.M | re.S)
    return {" ".join(network.split()): re.findall("``(.*?)``", typed, re.S) for network, typed in rows[1:]}


@pytest.mark.parametrize("network", MAKERS)
def test_what_is_typed_for_a_network(slope, network):
    """The page's row, on a file of that form as it is downloaded."""
    assert list(listed()) == list(MAKERS)
    MAKERS[network]()
    for command in listed()[network]:
        if command.startswith("tools/slope quake "):
            words = [found for word in shlex.split(command)[2:] for found in glob.glob(word) or [word]]
            status, out, err = slope(shlex.join([*words, "--baseline", "none"]))
            assert status == 0 and err == "", err
        else:
            subprocess.run(" ".join(command.split("\n")), shell=True, check=True)
    motion = read_motion()
    assert motion[:, 0] == pytest.approx(T, abs=1e-9)
    less = motion[:, 1:].mean(axis=0) if "NIED" in network else 0.0       # its counts have an offset
    assert motion[:, 1:] - less == pytest.approx(np.column_stack([EW, NS, UD]), abs=2e-4)


def test_uncorrected_records_of_geonet(slope):
    geonet("a.V1A")
    assert slope("a.V1A --azimuth 242 --baseline none -o motion.txt")[0] == 0
    turned = np.radians(242)
    assert read_motion()[:, 1] == pytest.approx(EW * np.sin(turned) + NS * np.cos(turned), abs=1e-4)


def test_the_columns_are_those_that_the_head_names(slope):
    cwa(order=("E(+)", "N(-)", "U(+)"))
    assert slope("2-STA.dat --baseline none -o motion.txt")[0] == 0
    assert read_motion()[:, 1:] == pytest.approx(np.column_stack([EW, NS, UD]), abs=1e-5)


@pytest.mark.parametrize("make, name, old, new, said", [
    (three_dyna, HNE, "cm/s^2", "cm/s", "must be of an acceleration, got cm/s"),
    (three_dyna, HNE, "TYPE: ACC", "TYPE: PSEUDO ACC", "must be of an acceleration, got cm"),
    (three_dyna, HNE, "HNE", "HN1", "the head must name the directions"),
    (three_dyna, HNE, "NDATA: 2000", "NDATA: 2001", "must hold the 2001 values"),
    (three_dyna, HNE, "SAMPLING_I", "I", "must have a line with SAMPLING_INTERVAL_S: 0.005"),
    (three_dyna, HNE, "0.010000", "10", "the time step must be > 0 and <= 1 s"),
    (afad, "20260101_0001.txt", "    -0.000", "", "20260101_0001.txt, line 210: must hold 3 numbers"),
    (cwa, "2-STA.dat", "(Hz): 100", "(Hz): 200", "times must be evenly spaced, by the 0.005 s of the head"),
    (jma, "acc123.csv", "NS,EW,UD", "X,Y,Z", "the head must name the directions"),
    (jma, "acc123.csv", "gal(cm/s/s)", "count", "must be of an acceleration, got count"),
    (lambda: geonet("a.V1A"), "a.V1A", "Component S62W", "Component X", "a.V1A, line 219: the head must name"),
    (lambda: geonet("a.V2A", True), "a.V2A", "  2000 ", "  2005 ", "must hold the 6015 values"),
])
def test_a_record_of_a_network_that_is_wrong(slope, make, name, old, new, said):
    make()
    text = Path(name).read_bytes()
    assert old.encode() in text
    Path(name).write_bytes(text.replace(old.encode(), new.encode(), 1))
    refused(slope, f"{name} -o motion.txt", name, said)


@pytest.mark.parametrize("content, said", [
    (b"1.  NOMBRE DEL ARCHIVO DEL REGISTRO : ACAC1709.191\n", "got '1. NOMBRE"),
    (b"Corrected accelerogram   89146-L2500    Chan  1: 360 Deg\n", "got 'Corrected"),
    (b"000001D \x00\xff\x80" + bytes(600), "got a file that is no text")], ids=("UNAM", "CSMIP", "miniSEED"))
def test_a_record_that_is_not_read(slope, content, said):
    """It says what is read, and what can be done."""
    Path("a.v2").write_bytes(content)
    refused(slope, "a.v2 -o motion.txt", "a.v2: must be", "K-NET", "PEER AT2", "GeoNet", "CSV", "tool_quake", said)


def test_archives_of_several_records(slope):
    """One of them must be named; the line has names that can be typed."""
    archive("a.tar.gz", *kiknet(), *kiknet("FKSH11"))
    refused(slope, "a.tar.gz -o m.txt", "a.tar.gz/FKSH10.NS1", "got 12 components of 4 records", "FKSH11", "borehole")
    names = "a.tar.gz/FKSH10.NS1 a.tar.gz/FKSH10.EW1 a.tar.gz/FKSH10.UD1"
    assert slope(f"{names} --baseline none -o one.txt")[0] == 0
    assert slope("'a.tar.gz/FKSH10*2' --baseline none -o motion.txt")[0] == 0
    size = [np.abs(read_motion(one)[:, 1:] - read_motion(one)[:, 1:].mean(axis=0)).max() for one in
            ("one.txt", "motion.txt")]
    assert size[0] == pytest.approx(0.3 * size[1], rel=1e-3)
    refused(slope, "'a.tar.gz/*.AT2' -o m.txt", "a.tar.gz/*.AT2: must be files of the archive, got FKSH10.NS1")


def test_archives_in_archives(slope):
    three_knet()
    Path("a.EW.gz").write_bytes(gzip.compress(Path("a.EW").read_bytes()))
    assert slope("a.EW.gz -o one.txt")[0] == 0
    archive("a.tar.gz", "a.EW", "a.NS", "a.UD")
    archive("a.zip", "a.tar.gz")
    assert slope("a.zip -o motion.txt")[0] == 0 and len(read_motion()) == len(T)
    at2("b.AT2", EW, "090")     # known by its name only
    text = Path("b.AT2").read_text().replace("PEER", "")
    for name in ("b.AT2.gz", "c.AT2.GZ"):
        Path(name).write_bytes(gzip.compress(text.encode()))
    archive("b.zip", "c.AT2.GZ")
    for name in ("b.zip", "b.zip/c.AT2", "'b.zip/*.AT2.gz'", "b.AT2.gz"):
        assert slope(f"{name} -o two.txt --overwrite")[0] == 0


@pytest.mark.parametrize("name, content", [
    ("a.tar.gz", lambda data: data[:-400]), ("a.zip", lambda data: data[:400]), ("a.zip", lambda data: data[:-30]),
    ("a.zip", lambda data: data[:200] + b"x" + data[201:])])
def test_damaged_archives(slope, name, content):
    three_knet()
    archive(name, "a.EW", "a.NS", "a.UD")
    Path(name).write_bytes(content(Path(name).read_bytes()))
    refused(slope, f"{name} -o motion.txt", f"{name}: must be a whole archive")


def test_archives_without_a_record(slope):
    with zipfile.ZipFile("a.zip", "w") as made:
        made.writestr("read.me", "text\n")
        made.writestr("b.csv", "time,EW (gal)\n" + "\n".join(LINES) + "\n")
    refused(slope, "a.zip -o m.txt", "a.zip: an archive must hold the components of one record", "got 0 components")
    assert slope("./a.zip/b.csv -o motion.txt")[0] == 0
    with zipfile.ZipFile("b.zip", "w") as made:
        made.writestr("empty/", "")
    refused(slope, "b.zip -o m.txt", "b.zip: an archive must hold files, got none")


# --- CSV ---


@pytest.mark.parametrize("name, factor", [("time (ms)", 1e-3), ("t [msec]", 1e-3), ("time_ms", 1e-3), ("time (s)", 1.0),
                                          ("Time (sec)", 1.0)])
def test_the_unit_of_time_counts(tmp_path, monkeypatch, name, factor):
    monkeypatch.chdir(tmp_path)
    rows = [f"{round(t / factor, 6):g},{a:.9g}" for t, a in zip(T, EW / GAL)]
    Path("a.csv").write_text(f"{name},EW (gal)\n" + "\n".join(rows) + "\n")
    found, = quake_records.read_quake_record("a.csv")
    assert found.dt == pytest.approx(DT) and found.values == pytest.approx(EW, abs=1e-7)


@pytest.mark.parametrize("head, rows, words", [
    ("time (min),EW (gal)", "0,1\n0.01,2\n", "a.csv, line 1: time must be in s or ms, got 'min'"),
    ("time,EW (gal)", "0,1\n10,2\n20,1\n", "a.csv: times must be in s, with a step of at most 1 s: are they in ms?"),
    ("time,EW (gal)", "0,1_5\n0.01,2\n", "a.csv, line 2: must be 2 numbers, got '0,1_5'"),
    ("time;EW (gal)", "0,00;1,5\n0,01;2,5\n", "a.csv, line 2: must be 2 numbers"),
    ("time,NS (cm/s)", "0,1\n0.01,2\n", "a.csv, line 1: column ns needs a unit"),
    ("# time,NS (gal)", "0,1\n0.01,2\n", "a.csv, line 2: the first line must name the columns")])
def test_a_table_in_other_units(slope, head, rows, words):
    Path("a.csv").write_text(f"{head}\n{rows}")
    refused(slope, "a.csv -o motion.txt", words)


@pytest.mark.parametrize("size", ["NPTS=  5, DT=  5.0 MSEC", "NPTS=  5, DT=  5.0 SEC", "NPTS=  5, DT=  0.005 MIN",
                                  "5  0.005  NPTS, DT (MS)"])
def test_the_time_step_of_at2_is_in_seconds(slope, size):
    at2("c.AT2", EW[:5], "090", size=size)
    refused(slope, "c.AT2 -o motion.txt", "c.AT2, line 4: must be NPTS= n, DT= s SEC")


def test_a_velocity_is_no_acceleration(slope):
    at2("c.AT2", EW[:5], "090")
    Path("c.AT2").write_text(Path("c.AT2").read_text().replace("ACCELERATION", "VELOCITY"))
    refused(slope, "c.AT2 -o motion.txt", "c.AT2, line 3: must be of an acceleration")


@pytest.mark.parametrize("head, rule", [
    ("# t ay ax az", "line 1: columns must be t ax ay az in s and m/s2, got t ay ax az"),
    ("# time(s) ax(gal) ay(gal) az(gal)", "line 1: columns must be t ax ay az in s and m/s2"),
    ("# t, ax, ay, az [ms, m/s2]", "line 1: columns must be t ax ay az in s and m/s2"),
    ("0 300 0 0", "must have accelerations in m/s2, at most 50: are they in gal?, got 300"),
    ("0 1_0 0 0", "line 1: must be four numbers"), ("t ax ay az", "line 1: must be four numbers")])
def test_a_motion_in_another_order_or_unit(slope, head, rule):
    Path("m.txt").write_text(f"{head}\n1 1 0 0\n2 2 0 0\n")
    with pytest.raises(SlopeError, match=re.escape(rule)):
        motion_file.read_motion("m.txt")
    Path("m.txt").write_text("# of fix ground/motion: t ax ay az (s, m/s2)\n1 1 0 0\n2 2 0 0\n")
    assert motion_file.read_motion("m.txt").shape == (2, 4)
    Path("m.txt").write_text("0, 1, 0, 0\n1, 1, 0, 0\n1, 2, 0, 0\n2, 2, 0, 0\n")       # as the fix: commas, a jump
    assert motion_file.read_motion("m.txt").shape == (4, 4)
    Path("m.txt").write_text("0 1 0 0\n1 1 0 0\n0.5 2 0 0\n")
    with pytest.raises(SlopeError, match=re.escape("line 3: times must not decrease, 1 s is before it, got 0.5")):
        motion_file.read_motion("m.txt")


@pytest.mark.parametrize("turned, wrong", [("", False), ("--azimuth 90", False), ("--azimuth 135", True),
                                           ("--azimuth 0", True)])
def test_a_motion_along_other_axes_is_not_one_of_a_terrain(slope, turned, wrong):
    """Sites and bodies have x towards the east; a deck of its own may have others."""
    for name, values, direction in (("a.EW", EW, "E-W"), ("a.NS", NS, "N-S")):
        knet(Path(name), values, direction)
    assert slope(f"a.EW a.NS {turned} -o motion.txt")[0] == 0
    if not wrong:
        assert len(motion_file.read_motion("motion.txt")) == len(T)
        return
    with pytest.raises(SlopeError, match="must have the axes of a terrain, x towards the east .*, got x axis towards "
                       + turned.split()[1]):
        motion_file.read_motion("motion.txt")


@pytest.mark.parametrize("head, unit, option", [
    ("time,EW (gal),NS (gal),UD (gal)", GAL, ""), ("t;e [g];n [g];up [g]", G, ""),
    ("time\tew\tns\tud", 1.0, "--unit m/s2"), ("time,E-W (cm/s^2),N-S (cm/s^2),U-D (cm/s^2)", GAL, ""),
    ('"time","EW (m/s\u00b2)","NS [m/sec2]","UD [m/s**2]"', 1.0, ""),
    ("t,ew gals,ns mm/s/s,up cm/s/s", (GAL, 1e-3, GAL), ""), ("t,E (g),N (g),Z (g)", G, ""),
    ("Time (s) , East ( m/s2 ) , North (m/s2), Vertical (m/s2)", 1.0, "--unit gal")])
def test_csv(slope, head, unit, option):
    mark = next(mark for mark in ",;\t" if mark in head)
    rows = [f"{a:.6f}{mark}{b:.9g}{mark}{c:.9g}{mark}{d:.9g}" for a, b, c, d in
            zip(T + 5, *(np.array((EW, NS, UD)).T / unit).T)]
    Path("a.csv").write_text("# a record\n" + head + "\n" + "\n".join(rows) + "\n")
    assert slope(f"a.csv {option} --baseline none -o motion.txt")[0] == 0
    assert read_motion() == pytest.approx(np.column_stack([T, EW, NS, UD]), abs=1e-7)


@pytest.mark.parametrize("rate, digits", [(256, 3), (256, 5), (120, 4), (100, 2), (62.5, 3)])
def test_times_of_a_csv_are_rounded(slope, rate, digits):
    rows = "".join(f"{k / rate + 3:.{digits}f},{a:.9g}\n" for k, a in enumerate(EW))
    Path("a.csv").write_text("t,EW (m/s2)\n" + rows)
    assert slope("a.csv --baseline none -o motion.txt")[0] == 0
    assert read_motion()[:, 0] == pytest.approx(np.arange(len(EW)) / rate, abs=1.1 * 10.0 ** -digits)
    lines = Path("a.csv").read_text().splitlines()
    Path("a.csv").write_text("\n".join(lines[:900] + lines[901:]))
    refused(slope, "a.csv -o gap.txt", "a.csv, line 901: times must be evenly spaced", "a step of")


def test_times_of_a_csv_whose_step_changes(slope):
    t = np.cumsum(np.where(np.arange(400) < 200, 0.004, 0.003))    # each within the rounding of its neighbours
    Path("a.csv").write_text("t,EW (m/s2)\n" + "".join(f"{a:.3f},{b:.9g}\n" for a, b in zip(t, EW)))
    refused(slope, "a.csv -o motion.txt", "a.csv, line 2", "times must be evenly spaced")


def test_csv_files_of_one_record_begin_together(slope):
    for name, begin in (("ew", 0), ("ns", 0), ("ud", 5)):
        rows = "".join(f"{a:.2f},{b:.9g}\n" for a, b in zip(T + begin, EW))
        Path(f"{name}.csv").write_text(f"t,{name} (m/s2)\n" + rows)
    assert slope("ew.csv ns.csv -o motion.txt")[0] == 0
    refused(slope, "ew.csv ns.csv ud.csv -o x.txt", "ud.csv: must begin when ew.csv does, 0 s, got 5 s")


def test_a_file_of_comments(slope):
    Path("a.csv").write_text("# a record\n\n# to come\n")
    refused(slope, "a.csv -o motion.txt", "a.csv: must hold a record")


LINES = ["0,1", "0.01,2", "0.02,1", "0.03,0", "0.04,1"]


@pytest.mark.parametrize("head, lines, message", [
    ("time,EW (gal)", LINES[:3] + LINES[4:], "line 5: times must be evenly spaced, 0.01 s here: the record has a gap"),
    ("time,EW (gal)", LINES[:3] + ["0.015,1"], "a.csv, line 5: times must rise, got 0.015 after 0.02"),
    ("time,EW (gal)", LINES[:3] + ["0.02,1"], "a.csv, line 5: times must rise, got 0.02 after 0.02"),
    ("time,EW (gal)", LINES[:3] + ["0.03"], "a.csv, line 5: must be 2 numbers, got '0.03'"),
    ("time,EW (gal)", LINES[:3] + ["0.03,nan"], "a.csv, line 5: must be 2 numbers, got '0.03,nan'"),
    ("time,EW (gal)", LINES[:3] + ["0.03,"], "a.csv, line 5: must be 2 numbers, got '0.03,'"),
    ("time,EW", LINES, "a.csv, line 1: column ew needs a unit, gal, g or m/s2, in brackets or by --unit, got none"),
    ("time,size (gal)", LINES, "a.csv, line 1: columns must be time and EW, NS or UD, got 'size'"),
    ("0,1", LINES, "a.csv, line 1: the first line must name the columns, such as time,EW (gal),NS (gal), got '0,1'"),
    ("time,EW (gal)", LINES[:1], "a.csv: must hold at least two lines of values, got 1"),
    ("time,EW (m/s2)", ["0,0", "0.01,300", "0.02,-300"], "at most 50 m/s2: the unit (--unit) or"),
    ("time,EW (gal)", ["0,3", "0.01,3", "0.02,3"], "a.csv: must hold a motion, the acceleration is constant"),
])
def test_a_csv_that_is_wrong(slope, head, lines, message):
    Path("a.csv").write_text(head + "\n" + "\n".join(lines) + "\n")
    refused(slope, "a.csv -o motion.txt", message)


# --- processing ---


def exact(motion):
    """Velocity and displacement of straight lines between points, by quadrature of each piece with 3 Gauss points."""
    t, a = motion[:, 0], motion[:, 1:]
    v, d = np.zeros_like(a), np.zeros_like(a)
    for k in range(len(t) - 1):
        h = t[k + 1] - t[k]
        v[k + 1] = v[k] + h * (a[k] + a[k + 1]) / 2
        s = h * (0.5 + np.sqrt(0.6) * np.array([-0.5, 0, 0.5]))
        inside = v[k] + np.outer(s, a[k]) + np.outer(s ** 2 / 2 / h, a[k + 1] - a[k])
        d[k + 1] = d[k] + h * np.array([5, 8, 5]) / 18 @ inside
    return v, d


@pytest.mark.drawn
def test_what_is_written_integrates_back(slope):
    three_knet()
    status, out, _ = slope("a.EW a.NS a.UD --peak 300 --band 0.2 20 --azimuth 135 -o motion.txt")
    motion, about = read_motion(), yaml.safe_load(Path("motion.yaml").read_text())
    v, d = exact(motion)
    assert status == 0 and np.hypot(motion[:, 1], motion[:, 2]).max() == pytest.approx(3.0, rel=1e-9)
    assert about["peak_gal"] == pytest.approx(300, rel=1e-9) and "300 gal" in out
    for k, axis in enumerate("xyz"):
        said = about["axes"][axis]
        assert said["velocity"] == pytest.approx(np.abs(v[:, k]).max(), rel=1e-6)
        assert said["displacement"] == pytest.approx(np.abs(d[:, k]).max(), rel=1e-5)
        assert abs(v[-1, k]) < 1e-7 * said["velocity"] and abs(d[-1, k]) < 1e-6 * said["displacement"]
        assert said["acceleration_gal"] == pytest.approx(np.abs(motion[:, 1 + k]).max() / GAL, rel=1e-9)
    assert not list(Path().glob("*.tmp")) and Path("motion.png").stat().st_size > 20_000


def test_scale_is_a_factor(slope):
    three_knet()
    assert slope("a.EW a.NS --baseline none -o one.txt")[0] == 0
    assert slope("a.EW a.NS --baseline none --scale -2 -o two.txt")[0] == 0
    assert read_motion("two.txt")[:, 1:] == pytest.approx(-2 * read_motion("one.txt")[:, 1:], rel=1e-10)


def test_azimuth_turns_and_keeps_the_size():
    parts = [quake_records.Component("a", 90.0, DT, EW), quake_records.Component("b", 0.0, DT, NS)]
    one, two = (quake_motion.combine(parts, azimuth) for azimuth in (90, 120))
    assert one.a[:, :2] == pytest.approx(np.column_stack([EW, NS]), abs=1e-12)
    assert np.hypot(*two.a[:, :2].T) == pytest.approx(np.hypot(EW, NS), rel=1e-12)
    assert quake_motion.combine(parts, 0).a[:, :2] == pytest.approx(np.column_stack([NS, -EW]), abs=1e-12)


def test_band_pass_keeps_what_is_within_and_no_delay():
    a = np.column_stack([wave(2.0, 1.0), wave(0.05, 1.0), wave(40.0, 1.0)])
    out = quake_motion.band_pass(quake_motion.Motion(DT, a), 0.5, 10).a
    assert out[:, 0] == pytest.approx(a[:, 0], abs=0.02)
    assert np.abs(out[:, 1:]).max() < 0.02


def test_window(slope):
    three_knet()
    assert slope("a.EW --window 5 12.5 --baseline none -o motion.txt")[0] == 0
    motion = read_motion()
    assert motion[0, 0] == 0 and motion[-1, 0] == pytest.approx(7.5) and len(motion) == 751
    assert motion[:, 1] - motion[0, 1] == pytest.approx(EW[500:1251] - EW[500], abs=2e-5)


@pytest.mark.parametrize("options, message", [
    ("--window 5 30", "--window: must be within the record, 0 to 19.99 s, and three points long, got 5 30"),
    ("--window 6 5", "--window: must be within"), ("--band 0.1 60", "--band: must be 0 < LOW < HIGH < 50 Hz"),
    ("--band 5 1", "--band: must be 0 < LOW < HIGH"), ("--peak 0", "--peak: must be > 0, got 0"),
    ("--scale 0", "--scale: must not be 0, got 0"),
    ("--peak 6000", "--peak: must give a largest acceleration of at most 5000 gal"),
    ("--scale 100", "--scale: must give a largest acceleration of at most 5000 gal"),
    ("--azimuth 400", "--azimuth: must be a compass bearing, 0 to 360 degrees, got 400"),
    ("--azimuth=-1", "--azimuth: must be a compass bearing, 0 to 360 degrees, got -1"),
    ("--unit g", "--unit: must be given for a CSV that names no unit")])
def test_options_that_are_wrong(slope, options, message):
    knet("a.EW", EW, "E-W")
    refused(slope, f"a.EW {options} -o motion.txt", message)


def test_a_vertical_component_alone_has_no_horizontal_peak(slope):
    knet("a.UD", UD, "U-D")
    refused(slope, "a.UD --peak 300 -o motion.txt", "--peak: needs a horizontal component", "got a.UD (up)")
    status, out, err = slope("a.UD --scale 2 --baseline mean -o motion.txt")
    about = yaml.safe_load(Path("motion.yaml").read_text())
    assert status == 0 and err == "" and "no horizontal component" in out and "largest horizontal" not in out
    assert about["peak_gal"] == 0 == about["arias_horizontal"]
    assert read_motion()[:, 3] == pytest.approx(2 * (UD - UD.mean()), abs=1e-4)
    refused(slope, "a.UD --scale 100 -o x.txt", "--scale: must give a largest acceleration of at most 5000 gal, got 9")


def test_the_unit_is_of_the_csv_among_the_records(slope):
    knet("a.EW", EW, "E-W", **{"Record Time": ""})
    Path("b.csv").write_text("time,UD\n" + "\n".join(f"{t:.2f},{a:.9g}" for t, a in zip(T, UD / GAL)) + "\n")
    assert slope("a.EW b.csv --unit gal --baseline none -o motion.txt")[0] == 0
    assert read_motion()[:, 3] == pytest.approx(UD, abs=1e-7)
    at2("c.AT2", EW, "090")
    refused(slope, "c.AT2 --unit g -o x.txt", "--unit: must be given for a CSV", "got g")


def test_output_that_is_wrong(slope):
    knet("a.EW", EW, "E-W")
    Path("a.txt").write_text(Path("a.EW").read_text())
    refused(slope, "a.EW -o motion.csv", "-o: must be a file that ends in .txt, got motion.csv")
    refused(slope, "a.EW -o no/motion.txt", "-o: must be in an existing folder, got no/motion.txt")
    refused(slope, "a.txt -o a.txt", "-o: must not be a record, got a.txt")
    refused(slope, "no.EW -o b.txt", "no.EW: cannot be read: No such file or directory")


# --- the numbers that describe a motion ---


def test_arias_and_duration_of_a_constant_acceleration():
    """Intensity pi/(2g) a2 t rises evenly: 5 to 95 % takes 90 % of the time."""
    about = quake_motion.measures(quake_motion.Motion(DT, np.tile([2.0, 0.0, 1.0], (1001, 1))))
    assert about["axes"]["x"]["arias"] == pytest.approx(np.pi / (2 * G) * 4 * 10, rel=1e-12)
    assert about["axes"]["z"]["duration_5_95"] == pytest.approx(9.0, rel=1e-9)
    assert about["arias_horizontal"] == about["axes"]["x"]["arias"] and about["axes"]["y"]["duration_5_95"] == 0


def test_arias_of_a_sine():
    t = 0.01 * np.arange(1001)
    a = np.column_stack([np.sin(2 * np.pi * t), 0 * t, 0 * t])
    assert quake_motion.measures(quake_motion.Motion(0.01, a))["axes"]["x"]["arias"] == pytest.approx(
        np.pi / (2 * G) * 5, rel=1e-3)


def test_spectrum_at_resonance():
    """An oscillator that a sine of its own period drives for long: sqrt(1 + 1/(4 z2)) times the sine, z the damping."""
    t = 0.01 * np.arange(6000)
    motion = quake_motion.Motion(0.01, np.column_stack([np.sin(2 * np.pi * t), 2 * np.sin(2 * np.pi * t), 0 * t]))
    found = quake_motion.spectrum(motion, 0.05, np.array([1.0]))[0]
    assert found == pytest.approx(np.array([1, 2, 0]) * math.sqrt(1 + 1 / (4 * 0.05 ** 2)), rel=2e-3)


def test_spectrum_of_a_step_in_closed_form():
    """A step: absolute acceleration 1 + exp(-z pi/sqrt(1-z2)) for any period; stiff ones follow the ground."""
    motion = quake_motion.Motion(0.002, np.vstack([np.zeros((1, 3)), np.ones((20000, 3))]))
    found = quake_motion.spectrum(motion, 0.02, np.array([0.5, 1.0, 5.0]))[:, 0]
    # the dashpot works on the absolute velocity, too: 2 z w s in the numerator
    z, w = 0.02, 2 * np.pi
    s = np.linspace(0, 1, 200001)
    wd = w * np.sqrt(1 - z * z)
    step = 1 - np.exp(-z * w * s) * (np.cos(wd * s) - z * w / wd * np.sin(wd * s))
    assert found == pytest.approx(np.full(3, step.max()), rel=3e-3)


def test_the_largest_response_is_found_between_the_points():
    """A stiff oscillator, 2.5 points of the record per period, against steps of its own in closed form."""
    rng, dt, period, z = np.random.default_rng(2), 0.02, 0.05, 0.05
    a = np.column_stack([rng.standard_normal((200, 3))])
    a[0] = a[-1] = 0
    h, w = dt / 200, 2 * np.pi / period
    wd = w * math.sqrt(1 - z * z)
    largest = np.zeros(3)
    for c in range(3):
        fine = np.append(np.interp(np.arange(199 * 200 + 1) * h, dt * np.arange(200), a[:, c]), np.zeros(600))
        # particular solution of u'' + 2 z w u' + w2 u = -(p + q s), and the free oscillation about it
        q = np.diff(fine) / h
        u = v = 0.0
        cos, sin, decay = math.cos(wd * h), math.sin(wd * h), math.exp(-z * w * h)
        for p, slope_ in zip(fine, q):
            b = -slope_ / w ** 2
            first = -p / w ** 2 + 2 * z * slope_ / w ** 3
            y, s = u - first, v - b
            k = (s + z * w * y) / wd
            u = first + b * h + decay * (y * cos + k * sin)
            v = b + decay * (s * cos - (z * w * k + wd * y) * sin)
            largest[c] = max(largest[c], abs(w * w * u + 2 * z * w * v))
    found = quake_motion.spectrum(quake_motion.Motion(dt, a), z, np.array([period]))[0]
    assert found == pytest.approx(largest, rel=4e-3)


def test_spectrum_file_has_what_is_drawn(slope):
    three_knet()
    slope("a.EW a.NS a.UD -o motion.txt")
    rows = np.loadtxt("motion.spectrum.csv", delimiter=",", skiprows=1)
    motion = quake_motion.Motion(DT, read_motion()[:, 1:])
    assert rows[:, 1:] == pytest.approx(quake_motion.spectrum(motion) / GAL, rel=1e-4)


# --- the page ---


@pytest.mark.parametrize("command", examples("quake"))
def test_every_example_of_the_page_and_the_help_runs(slope, command):
    three_knet()
    for suffix in ("EW", "NS", "UD"):
        Path(f"a.{suffix}").rename(f"FKS005.{suffix}")
    at2("RSN1_090.AT2", EW, "090")
    at2("RSN1_000.AT2", NS, "000")
    rows = "\n".join(f"{t:.2f},{a:.6f}" for t, a in zip(T, EW / GAL))
    Path("shake.csv").write_text("time,EW\n" + rows + "\n")
    status, out, err = slope(command)
    if "--help" in command:
        assert "tools/slope quake FKS005.EW" in out
    else:
        assert status == 0 and err == "" and "fix shake soil ground/motion" in out
