"""What stands where a result is to go: replaced if it is a result of the same input, else only with --overwrite."""
from pathlib import Path

import numpy as np
import pytest
from shapely.geometry import box

from run_helpers import run_command, write_asc, write_geojson, write_run

from slope_tools import disk
from slope_tools.errors import SlopeError


def standing(sources, overwrite=False):
    """Whether results of these sources may replace what is in the folder."""
    try:
        disk.check_folder(Path("out"), ["a.csv", "a.yaml"], sources, overwrite)
    except SlopeError as error:
        assert "out/a.csv" in str(error) or "out/a.yaml" in str(error), error
        return False
    return True


def test_only_the_result_of_the_same_sources_is_replaced(here):
    assert standing(["road.csv"])
    Path("out").mkdir()
    Path("out/mine.txt").write_text("of the user\n")
    assert standing(["road.csv"])
    Path("out/a.csv").write_text("of the user\n")
    assert not standing(["road.csv"]) and standing(["road.csv"], overwrite=True)
    disk.void_of(Path("out/a.yaml")).touch()        # a set that was killed between two of its files
    assert standing(["road.csv"])
    with disk.complete("out", "a.yaml") as new:
        (new / "a.csv").write_text("1\n")
        disk.write_yaml(new / "a.yaml", {"prefix": "run", "road": Path("it's/road.csv"), "records": ["b.dump"]}, "a")
    assert standing(["run", "it's/road.csv", "b.dump"])
    for other in ("road.csv", "s/road.csv", "it's/road", "b.dump.gz", "ru"):
        assert not standing([other]), other
    Path("out/a.yaml").write_text("a: [")
    assert not standing(["run"])


@pytest.mark.parametrize("command, words, other, made", [
    ("terrain", "a.asc -o out.asc", "b.asc -o out.asc", "out.asc"),
    ("volume", "run --road a.geojson --local --mesh 10 --no-picture -o out",
     "run --road b.geojson --local --mesh 10 --no-picture -o out", "out/volume.csv"),
    ("polygon", "a.csv --terrain a.asc --local -o out.csv", None, "out.csv"),
    ("score", "run --observed a.geojson --local -o out", "run --observed b.geojson --local -o out", "out/score.csv"),
    ("export", "run -o out", None, "out/run.surface.tif")])
def test_of_a_command(here, capsys, command, words, other, made):
    for name in "ab":
        write_asc(f"{name}.asc", np.full((8, 8), 3.0), 2.5)
        write_geojson(f"{name}.geojson", box(2, 2, 12, 12))
    Path("a.csv").write_text("2,2\n12,2\n12,12\n2,12\n")
    for prefix in ("run", "more"):
        write_run(np.full((8, 8), 1.0), 0.0, 2.5, prefix)
    assert run_command(command, words, capsys)[0] == 0
    assert run_command(command, words, capsys)[0] == 0      # again
    if other:
        kept = Path(made).read_bytes()
        status, out, err = run_command(command, other, capsys)
        assert (status, out) == (2, "") and "-o: out" in err and "--overwrite" in err
        assert Path(made).read_bytes() == kept
        assert run_command(command, f"{other} --overwrite", capsys)[0] == 0
    for path in Path().glob("out*"):
        if path.is_dir():
            (path / f"{command}.yaml").unlink()
        elif path.suffix == ".yaml":
            path.unlink()
    Path(made).write_text("of the user\n")
    status, out, err = run_command(command, words, capsys)
    assert (status, out) == (2, "") and err.count("\n") <= 2 and f"-o: {made} must be the result of" in err
    assert Path(made).read_text() == "of the user\n"
    assert run_command(command, f"{words} --overwrite", capsys)[0] == 0
