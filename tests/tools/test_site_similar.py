"""Sites whose lengths are scaled give the same collapse, in times and speeds by the root of the lengths (Froude)."""
import subprocess

import numpy as np
import pytest
import yaml

from test_site import CELL, COLUMNS, LMP, RELEASE, ROWS, height, make, write_layer
from run_helpers import write_tif

from slope_tools.case import decks

REPEATS = ("1", "2", "3", "4")     # packings
# each is a length over that of the site: travel of the centroid, what 90 and 99 % of the volume stay within
LENGTHS = ("centroid", "within_90", "within_99")


def measured(folder, factor, *words):
    """The deck's variables, and LENGTHS of each repeat, of a site with all lengths times a factor."""
    folder.mkdir()
    z = np.broadcast_to(100 + height((np.arange(COLUMNS) + 0.5) * CELL), (ROWS, COLUMNS))
    write_tif(folder / "dem.tif", factor * z, factor * CELL, crs="EPSG:6677")
    write_layer(folder / "release.geojson", [(factor * x, factor * y) for x, y in RELEASE])
    done = make(folder, "--shape", "ellipsoid", "--depth", 8 * factor, "--balls", 400)
    assert done.returncode == 0, done.stderr
    found = []
    for seed in REPEATS:
        subprocess.run([LMP, "-in", "in.site", "-screen", "none", "-var", "rolling", "0.05", "-var", "packing", seed,
                        *words], cwd=folder / "mine", check=True, stdin=subprocess.DEVNULL)
        about = yaml.safe_load((folder / "mine" / "site.summary.yaml").read_text())
        assert about["stop"]["reason"] == "halted"
        within = {round(100 * one["share"]): one["distance"] for one in about["travel"]["quantiles"]}
        found.append([about["travel"]["centroid"], within[90], within[99]])
    return decks.index_variables(folder / "mine" / "in.site"), about, np.array(found) / factor


def t_of(one, other):
    """Difference of the means over its standard error."""
    error = np.sqrt((one.var(axis=0, ddof=1) + other.var(axis=0, ddof=1)) / len(one))
    return (one.mean(axis=0) - other.mean(axis=0)) / error


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    return measured(tmp_path_factory.mktemp("site") / "one", 1)


@pytest.mark.long
@pytest.mark.parametrize("factor", [10, 0.1])
def test_scaled_lengths_give_the_scaled_collapse(site, tmp_path, factor):
    variables, about, lengths = site
    scaled, other, found = measured(tmp_path / "other", factor)
    assert float(scaled["thick"]) == pytest.approx(factor * float(variables["thick"]), rel=0.01)
    assert float(scaled["d"]) == pytest.approx(factor * float(variables["d"]), rel=0.01)
    assert float(scaled["speed"]) == pytest.approx(factor ** 0.5 * float(variables["speed"]), rel=0.15)
    assert other["dt"] == pytest.approx(factor ** 0.5 * about["dt"], rel=0.05)
    # 4 runs each: t of 6 degrees of freedom is below 3.7 in 99 % of cases
    assert (abs(t_of(found, lengths)) < 3.7).all()
