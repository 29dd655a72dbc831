"""A body of 1.07 Mm3 on a real mountain, Hintertux: a mapped release area, the slip surface 5 m below the ground as a
second raster. The elevation model is not part of the package: without it the test is skipped."""

import re
import subprocess
from pathlib import Path

import numpy
import pytest

from deck_helpers import read_asc, run_deck, write_asc

TOP = Path(__file__).resolve().parents[2]
DATA = TOP.parent / "shared" / "data"

DECK = """
units       si
atom_style  sphere
boundary    s s fs
comm_modify vel yes
region      ground terrain terrain.asc depth 20 headroom 20
region      mapped polygon release.csv
region      above terrain slip.asc depth 20 side out
region      body intersect 3 ground mapped above
create_box  3 ground
lattice     sc ${d}
create_atoms 1 region body
group       soil type 1
set         group soil diameter ${d} density 3411.4
variable    half equal v_d/2
fix         slip soil wall/gran/balls 2 ${d} surface body lower spacing ${half} sink ${sink} write slip.xyz
fix         field soil wall/gran/balls 3 ${d} surface ground upper spacing ${d} outside body write field.xyz
delete_balls soil overlap 0.0
"""


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    if not (DATA / "hit.asc").exists():
        pytest.skip("needs hit.asc, the elevation model of Hintertux, which is not part of the package")
    folder = tmp_path_factory.mktemp("site")
    for command in (["terrain", DATA / "hit.asc", "--crs", "EPSG:31287", "-o", "terrain.asc"],
                    ["polygon", DATA / "hit-release.shp", "--terrain", "terrain.asc", "-o", "release.csv"]):
        subprocess.run([TOP / "tools" / "slope", *command], cwd=folder, check=True, capture_output=True)
    heights, header = read_asc(folder / "terrain.asc")
    place = header["xllcorner"], header["yllcorner"], header["cellsize"]
    write_asc(folder / "slip.asc", heights - 5.0, *place)
    return folder, heights, place


def left_out(site, **variables):
    """Share of the balls that delete_balls removed; the fixed balls of the slip surface and of the field."""
    log = run_deck(DECK, site[0], vars=variables)
    gone, left = map(int, re.search(r"Delete_balls: (\d+) balls .* (\d+) balls left", log).groups())
    return gone / (gone + left), *(numpy.loadtxt(site[0] / name) for name in ("slip.xyz", "field.xyz"))


def below_ground(site, balls):
    """Depth below the bilinear ground."""
    _, z, (xlo, ylo, cell) = site
    u, v = (balls[:, 0] - xlo) / cell - 0.5, (balls[:, 1] - ylo) / cell - 0.5
    i, j = (numpy.clip(w.astype(int), 0, size - 2) for w, size in zip((u, v), z.shape[::-1]))
    u, v = u - i, v - j
    return ((1 - u) * (1 - v) * z[j, i] + u * (1 - v) * z[j, i + 1] + (1 - u) * v * z[j + 1, i]
            + u * v * z[j + 1, i + 1]) - balls[:, 2]


@pytest.mark.parametrize("d", [8, *(pytest.param(d, marks=pytest.mark.long) for d in (6, 4))])
def test_next_to_nothing_of_the_body_is_left_out(site, d):
    share, slip, field = left_out(site, d=d, sink=d)
    assert share < 0.01
    deep = below_ground(site, slip)
    assert (deep > 5.0 + 0.9 * d).mean() > 0.9 and deep.max() < 5.0 + 3.0 * d    # the slope is up to 60 degrees
    walls = below_ground(site, field)
    walls = walls[walls > 0.5 * d]      # the ground ends at them: field balls from there to the bottom
    assert len(walls) > 100 and walls.max() < 5.0 + 3.0 * d
