"""slope report --pdf: heads and page numbers, no page that is emptier than a third, the final state; looked at."""
import re
import shutil
import subprocess
import time
from pathlib import Path

import numpy as np
import pytest
import yaml

from run_helpers import TOOLS, called
from tiny_collapse import LMP, write_case

from slope_tools import cli
from slope_tools.animation import view
from slope_tools.drawing import figures
from slope_tools.errors import SlopeError
from slope_tools.report import document, printing

pytestmark = [pytest.mark.drawn, pytest.mark.filterwarnings("ignore::rasterio.errors.NotGeoreferencedWarning")]
looked_at = pytest.mark.skipif(not (printing.browser() and shutil.which("pdftoppm")),
                               reason="no browser that prints, or poppler-utils is not installed")
DUMP = "dump        view soil custom 75 view.*.dump id diameter x y z vx vy vz\ndump_modify view pad 9\n"
TOP, BOTTOM, TALL = 17, 16, 297     # mm, the margins and the height of a page
MOST_EMPTY = 1 / 3                  # of the height between the margins


def words(*arguments):
    return subprocess.run(arguments, check=True, stdout=subprocess.PIPE).stdout


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A study of two runs with dumps and a road, in out; its folder."""
    folder = tmp_path_factory.mktemp("made")
    deck = write_case(folder / "case")
    deck.write_text(deck.read_text().replace("run         ${steps}", f"{DUMP}run         ${{steps}}"))
    assert cli.main(["study", str(deck), "--set", "rolling=0,0.3", "--set", "steps=900", "-o", str(folder / "out"),
                     "--road", str(folder / "case" / "road.csv"), "--local", "--lmp", LMP]) == 0
    return folder / "out"


@pytest.fixture(scope="module")
def pdf(made):
    """The report of it as a PDF."""
    patch = pytest.MonkeyPatch()
    patch.setattr(figures, "DPI", 60)
    assert cli.main(["report", str(made), "--no-film", "--pdf", "--name", "Cut 7"]) == 0
    patch.undo()
    return made / "report.pdf"


@looked_at
def test_every_page_has_head_and_number(pdf):
    about = words("pdfinfo", pdf).decode()
    count = int(re.search(r"Pages: +(\d+)", about)[1])
    assert count >= 5 and "A4" in about
    for k in range(1, count + 1):
        text = words("pdftotext", "-f", str(k), "-l", str(k), "-layout", pdf, "-").decode()
        assert f"page {k} of {count}" in text and "Slope collapse: Cut 7" in text
    first = words("pdftotext", "-l", "1", pdf, "-").decode()
    assert "Appendix" not in first and "Less than 0.1 m is not drawn" in first      # the map's caption is there too


@looked_at
def test_no_page_is_emptier_than_a_third(pdf, tmp_path):
    """All but the last, which ends where the report does."""
    words("pdftoppm", "-r", "30", "-gray", pdf, tmp_path / "page")
    empty = []
    for path in sorted(tmp_path.glob("page*.pgm")):
        kind, size, most, content = path.read_bytes().split(b"\n", 3)
        assert kind == b"P5" and most == b"255"
        z = np.frombuffer(content, np.uint8).reshape([int(word) for word in size.split()][::-1])
        low, high = (round(len(z) * mm / TALL) for mm in (TOP, TALL - BOTTOM))
        inked = np.flatnonzero((z[low:high] < 230).any(axis=1))
        empty.append(1 - (inked[-1] + 1) / (high - low))
    assert len(empty) > 4 and max(empty[:-1]) <= MOST_EMPTY, empty


@looked_at
def test_no_title_and_no_row_is_alone(tmp_path):
    """Wherever a table begins on a page, its title, caption, head and two rows are together."""
    template = (TOOLS / "slope_tools" / "report" / "report.html.j2").read_text(encoding="utf-8")
    style = re.sub(r"\{\{.*?\}\}", "", re.search(r"<style>.*?</style>", template, re.DOTALL)[0])
    rows = "".join(f"<tr><td>row{i}</td></tr>" for i in range(5))
    table = ("<h2>TITLE</h2><div class='wide'><table><caption>CAPTION<br>of two lines</caption>"
             f"<thead><tr><th>HEAD<br>m</th></tr></thead><tbody>{rows}</tbody></table></div>")
    page = tmp_path / "page.html"
    page.write_text(f"<html>{style}" + "".join(
        f"<section style='break-before: page'><div style='height: {mm}mm'></div>{table}</section>"
        for mm in range(190, 246)), encoding="utf-8")
    printing.print_page(page, tmp_path / "page.pdf")
    found = [text.split() for text in words("pdftotext", "-layout", tmp_path / "page.pdf", "-").decode().split("\f")]
    found = [[word for word in text if word in ("TITLE", "CAPTION", "HEAD") or word[:3] == "row"] for text in found]
    assert sum("TITLE" in text for text in found) == 56 and any(text[-1:] == ["row2"] for text in found)
    for text in found:
        assert "TITLE" not in text or text[1:5] == ["CAPTION", "HEAD", "row0", "row1"], text
        assert sum(word.startswith("row") for word in text) != 1, text


@looked_at
@pytest.mark.skipif(view.library() is None, reason="libjs-three is not installed")
def test_the_still_picture_is_the_final_state(pdf, made):
    best = yaml.safe_load((made / "study.yaml").read_text())["conservative"]["run"]
    text = words("pdftotext", pdf, "-").decode()
    steps = [int(re.search(r"(\d+)\.dump", path.name)[1]) for path in (made / best).glob("view.*.dump")]
    assert f"t = {0.002 * max(steps):.1f} s" in text and "t = 0.0 s" not in text


def test_without_a_browser_one_line_and_nothing_is_made(made, capsys, monkeypatch, tmp_path):
    monkeypatch.setenv("PATH", str(tmp_path))
    status, out, err = called(capsys, ["report", str(made), "--pdf", "-o", str(tmp_path / "page.html")])
    assert (status, out) == (2, "") and err.count("\n") == 1 and not list(tmp_path.iterdir())
    assert "--pdf: needs a browser that prints, chromium or google-chrome" in err


@pytest.mark.parametrize("script, last", [("echo first >&2; echo 'no display' >&2; exit 3", "no display"),
                                          ("exit 0", "status 0")])
def test_a_browser_that_fails_leaves_no_pdf(monkeypatch, tmp_path, script, last):
    program = tmp_path / "bin" / "chromium"
    program.parent.mkdir()
    program.write_text(f"#!/bin/sh\n{script}\n")
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{program.parent}:/bin")
    page = tmp_path / "page.html"
    page.write_text("<html></html>")
    with pytest.raises(Exception, match=f"must print {page}, got {last}"):
        printing.print_page(page, tmp_path / "page.pdf")
    assert not (tmp_path / "page.pdf").exists()


def test_a_browser_that_hangs_is_ended_with_all_that_it_started(monkeypatch, tmp_path):
    program = tmp_path / "bin" / "chromium"
    program.parent.mkdir()
    program.write_text(f"#!/bin/sh\nsleep 600 &\necho $! > {tmp_path}/child\nwait\n")
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{program.parent}:/bin:/usr/bin")
    monkeypatch.setattr(printing, "PATIENCE", 1)
    page = tmp_path / "page.html"
    page.write_text("<html></html>")
    with pytest.raises(SlopeError) as error:
        printing.print_page(page, tmp_path / "page.pdf")
    assert str(error.value) == (f"--pdf: {program} must print {page} within 1 s: try again when less runs on this "
                                "machine, or print the page from any browser, got nothing by then")
    child, end = int((tmp_path / "child").read_text()), time.monotonic() + 10
    while is_running(child) and time.monotonic() < end:     # it was told to end; it does so when it is its turn
        time.sleep(0.02)
    assert not (tmp_path / "page.pdf").exists() and not is_running(child)


def is_running(process):
    """Whether there is a process of that number that is not a dead one whose parent has not asked for it."""
    try:
        return Path(f"/proc/{process}/stat").read_text().split(")")[1].split()[0] != "Z"
    except FileNotFoundError:
        return False


def test_what_a_browser_leaves_running_is_not_waited_for(monkeypatch, tmp_path):
    program = tmp_path / "bin" / "chromium"
    program.parent.mkdir()
    program.write_text("#!/bin/sh\nsleep 600 &\nfor word; do case $word in --print-to-pdf=*) echo %PDF > "
                       "${word#*=};; esac; done\n")
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{program.parent}:/bin:/usr/bin")
    monkeypatch.setattr(printing, "PATIENCE", 60)
    (tmp_path / "page.html").write_text("<html></html>")
    printing.print_page(tmp_path / "page.html", tmp_path / "page.pdf")
    assert (tmp_path / "page.pdf").read_text() == "%PDF\n"


def test_what_is_no_text_keeps_its_letters():
    """A unit is typeset; a picture, whose letters may look like one, is not."""
    import markupsafe
    assert document.typeset("5 m3") == "5 m³" and document.typeset(markupsafe.Markup("/m3+")) == "/m3+"
    template = (TOOLS / "slope_tools" / "report" / "sections.html.j2").read_text(encoding="utf-8")
    assert "picture.uri|safe" in template and "one.text|verbatim" in template
