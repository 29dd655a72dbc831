"""find_slip: the surface with the least factor of safety below a terrain, in the deck."""

import csv
import math
import re

import numpy
import pytest
from deck_helpers import run_deck, write_asc

GRAVITY = 9.80665

DECK = """
units           si
region          ground terrain ground.asc
find_slip       ground strength {strength} {more} output crit
{after}
"""

# after Donald and Giam 1989: c 3 kPa, phi 19.6 degrees, 20 kN/m3
LOW = "3000 19.6 {:.12g}".format(20000 / GRAVITY)
LOW_SPHERE = "surface sphere 10.25 25.25 54.0 28.9617"
# after Arai and Tagyo 1985: c 41.65 kPa, phi 15 degrees, 18.82 kN/m3
HIGH = "41650 15 {:.12g}".format(18820 / GRAVITY)
HIGH_SPHERE = "surface sphere 25.75 33.25 49.0 36.6347"


def embankment(path, nx, ny, low, first, step, steps):
    """Write a raster of 0.5 m cells that rises along x by step per cell from column first on."""
    profile = low + step * numpy.clip(numpy.arange(nx) - first, 0, steps)
    row = " ".join(f"{z:.9g}" for z in profile)
    (path / "ground.asc").write_text(
        f"ncols {nx}\nnrows {ny}\nxllcorner 0\nyllcorner 0\ncellsize 0.5\nNODATA_value -9999\n" + (row + "\n") * ny)


def of_10_m(path):
    embankment(path, 102, 101, 25, 20, 0.25, 40)


def of_10_m_coarse(path):
    """The same in cells of 1 m, for searches whose least factor is not compared."""
    write_asc(path / "ground.asc", numpy.tile(25 + 0.5 * numpy.clip(numpy.arange(51) - 9.75, 0, 20), (50, 1)))


def of_20_m(path):
    embankment(path, 133, 133, 15, 36, 1 / 3, 60)


def deck(strength=LOW, more=LOW_SPHERE, after=""):
    return DECK.format(strength=strength, more=more, after=after)


def rows(path):
    with open(path / "crit.slips.csv", newline="") as lines:
        return [{name: float(value) for name, value in row.items()} for row in csv.DictReader(lines)]


def yield_of_the_low_sphere(cell=0.1):
    """By a sum of its own over square columns: resisting moment at F = 1 less the weight's, over the inertia's."""
    x, y = numpy.meshgrid(numpy.arange(cell / 2, 51, cell), numpy.arange(cell / 2, 50.5, cell))
    ground = 25 + 0.25 * numpy.clip(x / 0.5 - 20.5, 0, 40)
    u, v = x - 10.25, y - 25.25
    depth = numpy.sqrt(numpy.maximum(28.9617 ** 2 - u ** 2 - v ** 2, 0))
    there = (depth > 0) & (54 - depth < ground)
    u, depth, ground = u[there], depth[there], ground[there]
    weight = 20000 * (ground - 54 + depth) * cell ** 2
    sine, up, tangent = u / numpy.hypot(u, depth), depth / 28.9617, math.tan(math.radians(19.6))
    base = cell ** 2 / up
    normal = (weight - 3000 * base * sine) / numpy.maximum(up + sine * tangent, 0.2)
    resisting = numpy.hypot(u, depth) * (3000 * base + normal * tangent)
    return numpy.sum(resisting - weight * u) / numpy.sum(weight * (54 - (ground + 54 - depth) / 2))


def raster(path):
    values = numpy.loadtxt(path, skiprows=6)
    return numpy.where(values == -9999, numpy.nan, values)[::-1]


def by_the_columns(path, row, cohesion, phi, k=(0.0, 0.0)):
    """Bishop's factor and yield coefficient, by sums of its own over crit.N.columns.csv, and the volume's weight."""
    with open(path / f"crit.{row['rank']:.0f}.columns.csv", newline="") as lines:
        read = csv.DictReader(lines)
        names = read.fieldnames
        values = numpy.array([[float(value) for value in one.values()] for one in read]).T
    c = dict(zip(names, values))
    assert names == ["dx_m", "dy_m", "depth_m", "area_m2", "slope_x", "slope_y", "weight_n", "weight_depth_m",
                     "pressure_pa"]
    way = numpy.array([math.cos(math.radians(row["direction"])), math.sin(math.radians(row["direction"]))])
    u, e = -(c["dx_m"] * way[0] + c["dy_m"] * way[1]), c["depth_m"]
    rise = -(c["slope_x"] * way[0] + c["slope_y"] * way[1])
    up = 1 / numpy.sqrt(1 + c["slope_x"] ** 2 + c["slope_y"] ** 2)
    sine, base, tangent = rise / numpy.hypot(1, rise), c["area_m2"] / up, math.tan(math.radians(phi))
    lever, of_normal = u * sine + e / numpy.hypot(1, rise), up * (e * rise - u)
    weight, lift = c["weight_n"], c["pressure_pa"] * base

    def moments(factor, k):
        m = numpy.maximum(up + sine * tangent / factor, 0.2)
        normal = ((1 - k[1]) * weight - (cohesion * base - lift * tangent) * sine / factor) / m
        return (numpy.sum(lever * (cohesion * base + (normal - lift) * tangent)),
                numpy.sum((1 - k[1]) * weight * u + k[0] * weight * c["weight_depth_m"] + normal * of_normal))

    factor = 1.0
    for _ in range(100):
        resisting, driving = moments(factor, k)
        factor = resisting / driving
    resisting, driving = moments(1.0, (0.0, k[1]))
    assert numpy.sum(c["area_m2"]) == pytest.approx(row["area"], rel=1e-7)
    return factor, (resisting - driving) / numpy.sum(weight * c["weight_depth_m"])


@pytest.mark.parametrize("more, k", [
    (LOW_SPHERE, (0.0, 0.0)), (f"{LOW_SPHERE} seismic 0.1 -0.1 direction 170", (0.1, -0.1)),
    (f"{LOW_SPHERE} water ru 0.2", (0.0, 0.0)), (f"{LOW_SPHERE} water table water.asc bedrock rock.asc", (0.0, 0.0)),
    (f"{LOW_SPHERE} layer rock.asc 3000 19.6 2500", (0.0, 0.0)),
    ("surface ellipsoid 10.25 25.25 54.0 28.9617 0.9 1.2 3 direction 175", (0.0, 0.0))])
def test_columns_have_the_factor_and_the_yield_coefficient_of_the_table(tmp_path, more, k):
    """The digits that are printed, but for rounding; the same file on two ranks."""
    of_10_m(tmp_path)
    ground = raster(tmp_path / "ground.asc")
    write_asc(tmp_path / "water.asc", numpy.minimum(ground, 28.0), cell=0.5)
    write_asc(tmp_path / "rock.asc", ground - 2.5 + 0.02 * numpy.arange(102), cell=0.5)
    run_deck(deck(more=more), tmp_path)
    [row] = rows(tmp_path)
    factor, coefficient = by_the_columns(tmp_path, row, 3000, 19.6, k)
    assert factor == pytest.approx(row["factor"], rel=1e-7)
    assert coefficient == pytest.approx(row["yield"], abs=1e-7)
    written = (tmp_path / "crit.1.columns.csv").read_bytes()
    run_deck(deck(more=more), tmp_path, np=2)
    assert (tmp_path / "crit.1.columns.csv").read_bytes() == written


def test_a_name_of_columns_that_cannot_be_written_ends_the_command_before_it_begins(tmp_path):
    of_10_m(tmp_path)
    (tmp_path / "crit.2.columns.csv").mkdir()
    run_deck(deck(more="volume 500 5000 keep 2"), tmp_path, expect_error="crit.2.columns.csv")
    assert sorted(path.name for path in tmp_path.glob("crit*")) == ["crit.2.columns.csv"]


def test_the_sphere_of_the_low_embankment(tmp_path):
    of_10_m(tmp_path)
    after = 'print "IN THE DECK $(v_crit_factor:%.5f) $(v_crit_yield:%.5f) ${crit_x} ${crit_y} ${crit_z} ${crit_r}"'
    log = run_deck(deck(after=after), tmp_path)
    [row] = rows(tmp_path)
    assert list(row) == ["rank", "x", "y", "z", "radius", "direction", "factor", "yield", "volume", "area", "depth",
                         "along", "across", "straight"]
    assert row["rank"] == 1
    assert row["factor"] == pytest.approx(1.0405, rel=1e-3)
    assert row["yield"] == pytest.approx(yield_of_the_low_sphere(), rel=5e-3)
    assert row["volume"] == pytest.approx(788.48, rel=5e-4)
    assert row["direction"] == pytest.approx(180, abs=0.1)
    assert f"IN THE DECK {row['factor']:.5f} {row['yield']:.5f} 10.25 25.25 54 28.9617" in log

    # the base is the sphere where it is below the ground, and the map has the factor there

    base, factor = raster(tmp_path / "crit.1.base.asc"), raster(tmp_path / "crit.factor.asc")
    ground = raster(tmp_path / "ground.asc")
    x, y = numpy.meshgrid(0.25 + 0.5 * numpy.arange(102), 0.25 + 0.5 * numpy.arange(101))
    depth = numpy.sqrt(numpy.maximum(28.9617 ** 2 - (x - 10.25) ** 2 - (y - 25.25) ** 2, 0))
    there = (depth > 0) & (54 - depth < ground)
    assert (numpy.isfinite(base) == there).all() and (numpy.isfinite(factor) == there).all()
    assert base[there] == pytest.approx((54 - depth)[there], abs=1e-6)
    assert factor[there] == pytest.approx(row["factor"], rel=1e-6)
    assert numpy.sum((ground - base)[there]) * 0.25 == pytest.approx(row["volume"], rel=0.01)


def test_the_sphere_of_the_high_embankment(tmp_path):
    of_20_m(tmp_path)
    run_deck(deck(HIGH, HIGH_SPHERE), tmp_path)
    [row] = rows(tmp_path)
    assert row["factor"] == pytest.approx(1.5982, rel=1e-3)
    assert row["volume"] == pytest.approx(14419.9, rel=5e-4)


def test_an_earthquake_of_the_yield_coefficient_makes_the_factor_one(tmp_path):
    of_10_m(tmp_path)
    run_deck(deck(), tmp_path)
    first = rows(tmp_path)[0]
    run_deck(deck(more=f"{LOW_SPHERE} seismic {first['yield']:.10g}"), tmp_path)
    assert rows(tmp_path)[0]["factor"] == pytest.approx(1, abs=1e-6)
    run_deck(deck(more=f"{LOW_SPHERE} seismic 0 0.2"), tmp_path)       # upwards: cohesion counts for more
    assert rows(tmp_path)[0]["factor"] > first["factor"]


def test_a_given_direction_off_the_steepest_has_a_larger_factor(tmp_path):
    of_10_m(tmp_path)
    run_deck(deck(), tmp_path)
    steepest = rows(tmp_path)[0]["factor"]
    run_deck(deck(more=f"{LOW_SPHERE} direction 170"), tmp_path)
    [row] = rows(tmp_path)
    assert row["direction"] == pytest.approx(170)
    assert row["factor"] == pytest.approx(1.017 * steepest, rel=2e-3)


def test_layers_and_water(tmp_path):
    of_10_m(tmp_path)
    ground = (tmp_path / "ground.asc").read_text()
    (tmp_path / "top.asc").write_text(ground)
    factors = {}
    for name, more in {"dry": "", "ru": "water ru 0.2", "table": "water table top.asc",
                       "layer": f"layer top.asc 6000 19.6 {20000 / GRAVITY:.12g}",
                       "ordinary": "method ordinary"}.items():
        run_deck(deck(more=f"{LOW_SPHERE} {more}"), tmp_path)
        factors[name] = rows(tmp_path)[0]["factor"]
    run_deck(deck(f"6000 19.6 {20000 / GRAVITY:.12g}"), tmp_path)
    assert factors["layer"] == pytest.approx(rows(tmp_path)[0]["factor"], rel=1e-9)
    assert factors["table"] < factors["ru"] < factors["dry"]
    assert factors["ordinary"] < factors["dry"]
    assert math.isfinite(factors["table"])


@pytest.mark.parametrize("more, message", [
    ("surface ellipsoid 10.25 25.25 54.0 28.9617 1 1.5 0", "Find_slip direction DEG must be given with surface ellips"),
    ("surface ellipsoid 10 25 54 29 1 0 0 direction 180", "Find_slip surface ellipsoid B must be > 0, got 0"),
    ("surface ellipsoid 10 25 54 29 1 1 -1 direction 180", "Find_slip surface ellipsoid L must be >= 0, got -1"),
    ("surface ellipsoid 10.25 2 54 29 1 1.5 0 direction 180", "got ellipsoid 10.25 2 54 29: the body reaches the edge"),
    (f"{LOW_SPHERE} method janbu", "Find_slip method must be bishop, ordinary or spencer, got janbu"),
    ("surface raster ground.asc", "Find_slip surface must be sphere or ellipsoid, got raster"),
    (f"{LOW_SPHERE} shape cube", "Find_slip shape must be sphere or ellipsoid, got cube"),
    (f"{LOW_SPHERE} water ru 1.5", "Find_slip water ru R must be 0 to below 1, got 1.5"),
    (f"{LOW_SPHERE} seismic -0.1", "Find_slip seismic must be >= 0 (horizontal, of the weight), got -0.1"),
    (f"{LOW_SPHERE} seismic 0.1 ''", "Find_slip seismic KV must be a finite number, got "),
    (f"{LOW_SPHERE} seismic 0.1-", "Find_slip seismic must be a finite number, got 0.1-"),
    (f"{LOW_SPHERE} layer none.asc 1 2 3", "none.asc"),
    (f"{LOW_SPHERE} bedrock ground.asc", "Find_slip bedrock must be below the ground somewhere, got none of it"),
    (f"{LOW_SPHERE} within ground", "Find_slip within: region ground must be of style polygon, got terrain"),
    ("surface sphere 10 25 54 20", "no ground is above it"),
    ("surface sphere 10 2 54 29", "the body reaches the edge of the terrain"),
    (f"{LOW_SPHERE} strange 3", "Find_slip: unknown keyword strange"),
])
def test_wrong_words_end_the_run_with_one_line(tmp_path, more, message):
    of_10_m(tmp_path)
    run_deck(deck(more=more), tmp_path, expect_error=message)
    assert not list(tmp_path.glob("crit.*"))


def test_spencer_balances_a_body_or_says_that_nothing_does(tmp_path):
    of_10_m(tmp_path)
    more = f"{LOW_SPHERE} method spencer"
    run_deck(deck(more=more), tmp_path)
    [row] = rows(tmp_path)
    assert row["factor"] == pytest.approx(1.0405, rel=0.01)       # of Bishop
    run_deck(deck(more=f"{more} seismic {row['yield']:.10g}"), tmp_path)
    assert rows(tmp_path)[0]["factor"] == pytest.approx(1, abs=1e-6)
    of_20_m(tmp_path)
    run_deck(deck(f"40000 0 {19000 / GRAVITY:.12g}", f"{HIGH_SPHERE} method spencer"), tmp_path,
             expect_error="Find_slip method spencer must find forces between columns")


def steep(path, rise, first):
    """A face of 10 m in cells of 1 m, which rises by so much per cell from column first on."""
    write_asc(path / "ground.asc", numpy.tile(numpy.clip(rise * (numpy.arange(20) - first), 0, 10), (18, 1)))


def test_a_search_by_spencer_says_what_it_leaves_out(tmp_path):
    """On a steep face most surfaces have no factor by Spencer; the least of the others was given alone."""
    steep(tmp_path, 2.5, 8)
    log = run_deck(deck("30000 5 2039", "volume 100 150 method spencer"), tmp_path)
    [bishop] = re.findall("no factor for surfaces that bishop gives ([0-9.]+)", log)
    assert 1.3 < float(bishop) < 1.5 < rows(tmp_path)[0]["factor"]
    steep(tmp_path, 4, 10)
    run_deck(deck("30000 0 2039", "volume 100 150 method spencer"), tmp_path,
             expect_error="Find_slip method spencer must balance a surface within the limits, got none")


def test_a_rim_that_is_vertical_leaves_the_factor_finite(tmp_path):
    """Where the centre is as high as the ground: columns of rounding had no dip, and the search gave inf."""
    steep(tmp_path, 4, 10)
    log = run_deck(deck("30000 0 2039", "volume 100 150"), tmp_path)
    [row] = rows(tmp_path)
    assert row["z"] == pytest.approx(10, abs=1e-3) and row["factor"] == pytest.approx(1.3295, rel=1e-3)
    assert row["yield"] == pytest.approx(0.618, rel=1e-2)
    assert re.search("normal forces pull below 0.1[0-9]* of the weight", log)   # what was said of a given surface alone


@pytest.mark.parametrize("ranks", (1, 2))
def test_the_variables_are_those_of_the_last_find_slip(tmp_path, ranks):
    of_10_m(tmp_path)
    other = "find_slip ground strength {} 30 2039 surface sphere {} 25.25 54.0 {} output {}"
    shown = 'print "DECK $(v_crit_factor:%.8g) $(v_crit_yield:%.8g) ${crit_x} ${crit_r} ${side_x} ${side_r}"'
    after = "\n".join([other.format(5000, 11, 28.5, "side"), "variable last equal 7",
                       other.format(50000, 11.25, 28, "crit"), shown])
    log = run_deck(deck(after=after), tmp_path, np=ranks)
    [row] = rows(tmp_path)
    assert row["factor"] > 5.5                                       # of the first: 1.04
    assert f"DECK {row['factor']:.8g} {row['yield']:.8g} 11.25 28 11 28.5" in log


def test_a_variable_of_the_deck_is_not_replaced(tmp_path):
    of_10_m(tmp_path)
    run_deck("variable crit_yield equal 1\n" + deck(), tmp_path,
             expect_error="Find_slip output must not begin the names of variables that are not of a find_slip, got "
             "crit, and there is a variable crit_yield")
    assert not list(tmp_path.glob("crit.*"))


def test_a_yield_coefficient_that_does_not_exist_is_nan_in_the_deck(tmp_path):
    of_10_m(tmp_path)
    high = "surface sphere 19.182 25.25 44.242 20.0908 method spencer seismic 0 0.397"
    log = run_deck(deck("41829.7 8.265 2039", high, 'print "DECK ${crit_yield} ${crit_x} $(v_crit_factor)"'), tmp_path)
    [row] = rows(tmp_path)
    assert math.isnan(row["yield"]) and f"DECK nan 19.182 {row['factor']:.6g}" in log


def test_a_narrow_polygon_has_a_body_though_coarse_columns_lead_out_of_it(tmp_path):
    write_asc(tmp_path / "ground.asc", numpy.tile(120 + numpy.clip(0.639 * (numpy.arange(1, 141, 2) - 50), 0, 31.945),
                                                  (70, 1)), cell=2)
    (tmp_path / "within.csv").write_text("60,60\n98,60\n98,80\n60,80\n")
    run_deck(deck("10000 30 1900", "volume 700 6000 within inside").replace(
        "find_slip", "region inside polygon within.csv\nfind_slip", 1), tmp_path)
    [row] = rows(tmp_path)
    assert row["volume"] >= 700 and 1.8 < row["factor"] < 1.9


def test_the_search_finds_the_least_on_any_number_of_ranks(tmp_path):
    """Not above the 1.0400 of a search by Scoops3D on a lattice, within the limits; the map and the rows agree."""
    of_10_m(tmp_path)
    more = "volume 500 5000 keep 2"
    run_deck(deck(more=more), tmp_path)
    found = rows(tmp_path)
    assert found[0]["factor"] < 1.0400
    assert found[0]["direction"] == pytest.approx(180, abs=1)
    assert all(500 <= row["volume"] <= 5000 for row in found)
    assert [row["factor"] for row in found] == sorted(row["factor"] for row in found)
    bases = [numpy.isfinite(raster(tmp_path / f"crit.{k + 1}.base.asc")) for k in range(len(found))]
    for k, row in enumerate(found):
        assert (raster(tmp_path / "crit.factor.asc")[bases[k]] <= row["factor"] * (1 + 1e-6)).all()
    assert len(found) == 1      # a second one would share more than a tenth

    # the sphere that it says has the factor that it says

    names = ("slips.csv", "factor.asc", "1.base.asc", "1.columns.csv")
    written = [(tmp_path / f"crit.{name}").read_bytes() for name in names]
    factor, coefficient = by_the_columns(tmp_path, found[0], 3000, 19.6)
    assert (factor, coefficient) == pytest.approx((found[0]["factor"], found[0]["yield"]), rel=1e-7, abs=1e-8)
    run_deck(deck(more="surface sphere {x:.10g} {y:.10g} {z:.10g} {radius:.10g}".format(**found[0])), tmp_path)
    assert rows(tmp_path)[0]["factor"] == pytest.approx(found[0]["factor"], rel=1e-5)
    run_deck(deck(more=more), tmp_path, np=2)
    assert [(tmp_path / f"crit.{name}").read_bytes() for name in names] == written


def six_slopes(path):
    """Six hills of 100 x 100 m, each with one steep face to the west, which has room for one body, and a lower top."""
    x, y = numpy.meshgrid(4.0 * numpy.arange(24) + 2, 4.0 * numpy.arange(24) - 46)
    hill = (numpy.clip((x - 16) / 26, 0, 1) * numpy.clip((92 - x) / 40, 0, 1)
            * numpy.clip((44 - abs(y)) / 26, 0, 1))
    west_to_east = [numpy.hstack([top * hill for top in tops]) for tops in ((24, 22, 20.5), (19, 17.5, 16))]
    write_asc(path / "ground.asc", numpy.vstack(west_to_east), cell=4.0)


def test_bodies_that_are_kept_are_of_several_slopes(tmp_path):
    """Six of six: of bodies that may share half of their plan the search found four, and could end with six of one."""
    six_slopes(tmp_path)
    more = "volume 1200 3000 direction 180 keep {}"
    run_deck(deck("5000 25 2000", more.format(1)), tmp_path)
    [least] = rows(tmp_path)
    run_deck(deck("5000 25 2000", more.format(6)), tmp_path)
    found = rows(tmp_path)
    bases = [numpy.isfinite(raster(tmp_path / f"crit.{k + 1}.base.asc")) for k in range(len(found))]
    middles = [numpy.argwhere(base).mean(axis=0) // 24 for base in bases]
    assert [tuple(middle) for middle in middles] == [(0, 0), (0, 1), (0, 2), (1, 0), (1, 1), (1, 2)]
    assert not any((a & b).any() for k, a in enumerate(bases) for b in bases[:k])
    assert found[0]["factor"] == pytest.approx(least["factor"], rel=1e-6)
    assert [row["factor"] for row in found] == sorted(row["factor"] for row in found)
    assert [by_the_columns(tmp_path, row, 5000, 25)[0] for row in found] == pytest.approx(
        [row["factor"] for row in found], rel=1e-7)     # bodies of few cells, where the least number of lines counts


def test_bodies_that_are_kept_share_at_most_a_tenth(tmp_path):
    """On one slope, along which there is room for several."""
    write_asc(tmp_path / "ground.asc", numpy.tile(25 + numpy.clip(numpy.arange(30) - 8.0, 0, 10), (55, 1)), cell=2.0)
    run_deck(deck(more="volume 300 800 keep 3"), tmp_path)
    bases = [numpy.isfinite(raster(tmp_path / f"crit.{k + 1}.base.asc")) for k in range(len(rows(tmp_path)))]
    assert len(bases) >= 2
    for k, base in enumerate(bases):
        for other in bases[:k]:
            assert (base & other).sum() <= 0.1 * min(base.sum(), other.sum())


def test_no_body_goes_below_the_bedrock(tmp_path):
    """The same rows on two ranks; a search finds no less than the 1.04 without; the base is where the files say."""
    of_10_m_coarse(tmp_path)
    ground = raster(tmp_path / "ground.asc")
    head = (tmp_path / "ground.asc").read_text().splitlines()[:6]
    rock = ground - 2.5
    numpy.savetxt(tmp_path / "rock.asc", rock[::-1], fmt="%.9g", header="\n".join(head), comments="")
    limits = "volume 500 3000"
    run_deck(deck(more=limits + " bedrock rock.asc"), tmp_path)
    cut = rows(tmp_path)[0]
    table = (tmp_path / "crit.slips.csv").read_bytes()
    assert cut["depth"] <= 2.5 * (1 + 1e-9) and 500 <= cut["volume"] <= 3000 and cut["factor"] > 1.04
    base = raster(tmp_path / "crit.1.base.asc")
    there = numpy.isfinite(base)
    assert (base[there] >= rock[there] - 1e-6).all() and (base[there] < rock[there] + 1e-6).any()
    sphere = "surface sphere {x:.10g} {y:.10g} {z:.10g} {radius:.10g}".format(**cut)
    run_deck(deck(more=sphere + " bedrock rock.asc"), tmp_path)
    assert rows(tmp_path)[0]["factor"] == pytest.approx(cut["factor"], rel=1e-5)
    run_deck(deck(more=limits + " bedrock rock.asc"), tmp_path, np=2)
    assert (tmp_path / "crit.slips.csv").read_bytes() == table
    run_deck(deck(more=sphere + " bedrock none.asc"), tmp_path, expect_error="none.asc")


def test_wide_surfaces_on_an_extruded_profile(tmp_path):
    """A capped cylinder and a long ellipsoid on the circle with the least factor in two dimensions, 1.405."""
    embankment(tmp_path, 133, 401, 15, 36, 1 / 3, 60)
    run_deck(deck(HIGH, "surface ellipsoid 25.94 100.25 46.34 32.26 1 1 100 direction 180"), tmp_path)
    assert rows(tmp_path)[0]["factor"] == pytest.approx(1.455, rel=3e-3)
    embankment(tmp_path, 133, 2161, 15, 36, 1 / 3, 60)
    run_deck(deck(HIGH, "surface ellipsoid 25.94 540.25 46.34 32.26 1 15 0 direction 180"), tmp_path)
    [row] = rows(tmp_path)
    assert row["factor"] == pytest.approx(1.526, rel=3e-3)
    assert (row["along"], row["across"], row["straight"]) == (1, 15, 0)


@pytest.mark.long
def test_ellipsoids_are_not_above_spheres_on_any_number_of_ranks(tmp_path):
    of_10_m(tmp_path)
    run_deck(deck(more="volume 500 5000"), tmp_path)
    [sphere] = rows(tmp_path)
    run_deck(deck(more="volume 500 5000 shape ellipsoid"), tmp_path)
    [wide] = rows(tmp_path)
    assert sphere["across"] == 1 and 1.5 < wide["across"] <= 4 and wide["along"] == 1
    assert wide["factor"] < 0.99 * sphere["factor"] and 500 <= wide["volume"] <= 5000
    table = (tmp_path / "crit.slips.csv").read_bytes()
    words = "{x:.10g} {y:.10g} {z:.10g} {radius:.10g} 1 {across:.10g} 0 direction {direction:.10g}".format(**wide)
    run_deck(deck(more=f"surface ellipsoid {words}"), tmp_path)
    assert rows(tmp_path)[0]["factor"] == pytest.approx(wide["factor"], rel=1e-5)
    run_deck(deck(more="volume 500 5000 shape ellipsoid"), tmp_path, np=2)
    assert (tmp_path / "crit.slips.csv").read_bytes() == table


def test_a_body_at_a_limit_is_not_lost(tmp_path):
    """Cells find a body as deep as is allowed, exact columns a little deeper: it is made to fit."""
    of_10_m_coarse(tmp_path)
    run_deck(deck(more="volume 200 5000 depth 0 2"), tmp_path)
    [row] = rows(tmp_path)
    assert 1.9 < row["depth"] <= 2 and 1.04 < row["factor"] < 1.13


@pytest.mark.parametrize("strength, more, message", [
    (LOW, "volume 1e7 1e8", "Find_slip limits must leave a sphere inside the terrain"),
    (LOW, "volume 5 2", "Find_slip volume must be LO HI with 0 <= LO < HI, got 5 2"),
    (LOW, "keep 0", "Find_slip keep must be 1 to 1000, got 0"),
    ("0 30 2000", "keep 1", "Find_slip volume LO must be > 0 where C is 0"),
])
def test_a_search_that_cannot_be(tmp_path, strength, more, message):
    of_10_m(tmp_path)
    run_deck(deck(strength, more), tmp_path, expect_error=message)
    assert not list(tmp_path.glob("crit.*"))
