"""The page for users of LIGGGHTS, YADE and PFC: its examples run and give its numbers; large boxes and their bins."""
import math
import re
from pathlib import Path

import pytest
from deck_helpers import read_dump, run_deck

DOC = Path(__file__).resolve().parents[2] / "doc" / "src"
PAGE = (DOC / "coming_from.rst").read_text()


def blocks(kind, text=PAGE):
    found = re.findall(rf"\.\. code-block:: {kind}\n\n((?:   .*\n|\n)+)", text)
    return ["\n".join(line[3:] for line in block.strip("\n").splitlines()) + "\n" for block in found]


EXAMPLES = [block for block in blocks("LAMMPS") if "pair_coeff 1 1" in block]     # LIGGGHTS, YADE, PFC

IMPACT = """
units        si
atom_style   sphere
atom_modify  map array
boundary     f f f
comm_modify  mode single vel yes
region       box block -1 1 -1 1 -1 1
create_box   2 box
create_atoms 1 single 0 0 0.1851
create_atoms {target} single 0 0 0
set          type * diameter 0.185 density $(8.78/(PI*0.185^3/6))
group        struck id 2
group        striking id 1
velocity     striking set 0 0 -1
{example}
timestep     1e-6
neighbor     0.01 bin
neigh_modify every 1 delay 0 check yes
{more}
run          4000
print        "SPEEDS $(vz[1]) $(vz[2])"
"""


def speeds(example, tmp_path, fixed):
    more = "fix hold struck freeze\nfix move striking nve/sphere" if fixed else "fix move all nve/sphere"
    log = run_deck(IMPACT.format(example=example, target=1 + fixed, more=more), tmp_path)
    return [abs(float(word)) for word in re.search(r"^SPEEDS (\S+) (\S+)$", log, re.MULTILINE).groups()]


@pytest.mark.parametrize("code", [0, 1, 2], ids=["LIGGGHTS", "YADE", "PFC"])
def test_impacts_of_the_page(tmp_path, code):
    assert len(EXAMPLES) == 3
    tables = re.findall(r"struck ball +\S+ +(\S+)\n.*striking one +\S+ +(\S+)\nball on a fixed one +\S+ +(\S+)\n", PAGE)
    slower, fixed = re.search(r"the run gives (\S+) m/s for the slower .* and (\S+) m/s on the fixed", PAGE).groups()
    struck, striking, rebound = map(float, (tables + [(f"{1 - float(slower)}", slower, fixed)])[code])
    got = speeds(EXAMPLES[code], tmp_path, fixed=False)
    assert got == pytest.approx([striking, struck], abs=5e-4)
    assert speeds(EXAMPLES[code], tmp_path, fixed=True)[0] == pytest.approx(rebound, abs=5e-4)


def kn(young, poisson, mass, radius, speed):
    """Of the page, for two bodies of one material."""
    y = young / (2 * (1 - poisson ** 2))
    return 16 / 15 * math.sqrt(radius) * y * (15 * mass * speed ** 2 / (16 * math.sqrt(radius) * y)) ** 0.2


def test_stiffness_of_pairs_and_walls():
    """The factors that the page names."""
    m, r = 8.78, 0.0925
    pair, frozen, wall = (kn(5e6, 0.3, *which, 1.0) for which in ((m / 2, r / 2), (m, r / 2), (m, r)))
    factors = [float(x) for x in re.findall(r"(1\.\d{3})\s+\(:math:`2\^", PAGE)]
    assert factors == pytest.approx([frozen / pair, wall / pair], abs=5e-4)


def test_a_ball_goes_as_deep_as_with_hertz(tmp_path):
    """On the plane of the page, with its stiffness: 4/3 Y sqrt(R) d^1.5, whose energy is 8/15 Y sqrt(R) d^2.5."""
    m, r, speed, y = 8.78, 0.0925, 2.0, 5e6 / (2 * (1 - 0.3 ** 2))
    [plane] = [block for block in blocks("text") if block.startswith("solid")]
    (tmp_path / "plane.stl").write_text(plane)
    [floor] = [block for block in blocks("LAMMPS") if "wall/gran/mesh" in block]
    pair = (f"pair_style gran/restitution\npair_coeff 1 * stiffness {kn(5e6, 0.3, m, r, speed)!r} 0 restitution 1\n"
            f"{floor}velocity striking set 0 0 {-speed}\n")
    deck = IMPACT.format(example=pair, target=1, more="fix move all nve/sphere\n"
                         "dump d all custom 10 path.dump id z\ndump_modify d sort id format float %.15g")
    deck = deck.replace("block -1 1 -1 1 -1 1", "block 0 10 0 10 -1 10").replace("0 0 0.1851", "5 4 0.0926")
    deck = deck.replace("create_atoms 1 single 0 0 0\n", "create_atoms 1 single 2 2 5\n").replace("1e-6", "1e-5")
    run_deck(deck, tmp_path)
    lowest = min(frame[0, 1] for frame in read_dump(tmp_path / "path.dump").values())
    hertz = (15 * m * speed ** 2 / (16 * y * math.sqrt(r))) ** 0.4
    assert r - lowest == pytest.approx(hertz, rel=1e-4)


def test_words_of_a_mesh_in_another_order():
    """LIGGGHTS 3.8.0 puts the corner at -5 of `move 0.3 0 0 scale 2` at -9.4; here move comes last."""
    words = re.search(r"\*move\* (\S+) 0 0 \*scale\* (\S+) of LIGGGHTS is \*scale\* (\S+) \*move\*\s+(\S+) 0 0 here",
                      PAGE)
    move, scale, same, moved = map(float, words.groups())
    assert scale == same and (-5 + move) * scale == pytest.approx(-5 * same + moved)


# --- large boxes ---

LARGE = """
units        si
atom_style   sphere
boundary     f f f
comm_modify  vel yes
region       box block 0 3000 0 3000 0 800
create_box   1 box
create_atoms 1 single 1500 1500 10
set          type 1 diameter 0.5 density 2500
neighbor     0.1 bin
pair_style   gran/restitution
pair_coeff   * * stiffness 1e6 1e6 restitution 0.5
fix          move all nve/sphere
timestep     1e-3
{}
run          1
"""
REMEDY = next(block for block in blocks("LAMMPS", (DOC / "region_terrain.rst").read_text()) if "binsize" in block)


@pytest.mark.parametrize("remedy, error", [
    ("", "Too many atom sorting bins"), (REMEDY.splitlines()[0], "Too many neighbor bins"), (REMEDY, None),
    ("atom_modify sort 0 0\n" + REMEDY.splitlines()[1], None)])
def test_bins_of_a_large_terrain(tmp_path, remedy, error):
    run_deck(LARGE.format(remedy), tmp_path, expect_error=error)


@pytest.mark.parametrize("page", ["region_terrain", "fix_wall_gran_balls", "fix_wall_gran_mesh",
                                  "pair_gran_restitution"])
def test_the_remedy_stands_where_one_looks_for_it(page):
    text = (DOC / f"{page}.rst").read_text()
    assert "Too many atom\nsorting bins" in text or "Too many atom sorting bins" in text
    assert "*atom_modify sort" in text and "binsize" in text
