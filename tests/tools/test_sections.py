"""Sections of a page: each kind of block is drawn, nothing in them is markup, and a section is a line of the page."""
import ast
import re

import pytest

from run_helpers import TOOLS

from slope_tools.report import document, sections
from slope_tools.report.sections import (Cell, Columns, Figures, Heading, Listing, Pairs, Picture, Section, Table, Text,
                                         Verbatim, marked, strong)

REPORT = TOOLS / "slope_tools" / "report"
BAD = "<b>5 m3 & more"                          # what a file may say
DRAWN = "&lt;b&gt;5 m³ &amp; more"              # what stands on the page
KEPT = "&lt;b&gt;5 m3 &amp; more"               # verbatim
PICTURE = Picture("data:,", BAD, BAD)
FIGURE = f'><img decoding="sync" src="data:," alt="{DRAWN}"><figcaption>{DRAWN}</figcaption></figure>'
BLOCKS = [
    (Text(BAD, "soft"), f'<p class="soft">{DRAWN}</p>'),
    (Text(strong(BAD)), f"<p><strong>{DRAWN}</strong></p>"),
    (Heading(BAD), f"<h3>{DRAWN}</h3>"),
    (Listing([BAD, "b"]), f'<ul class="plain"><li>{DRAWN}</li><li>b</li></ul>'),
    (Verbatim(BAD, "keep"), f'<pre class="keep">{KEPT}</pre>'),
    (Verbatim(BAD, folded=BAD), f"<details><summary>{DRAWN}</summary><pre>{KEPT}</pre></details>"),
    (Figures([None, PICTURE]), f"<figure{FIGURE}"),
    (Figures([PICTURE], "tall"), f'<figure class="tall"{FIGURE}'),
    (Figures([PICTURE], "columns"), f'<div class="columns"><figure{FIGURE}</div>'),
    (Table(BAD, ["a", Cell(BAD, "m3")], [[BAD, 7], [Cell(BAD, "m2", "doubt"), Cell(BAD, "m2", "doubt", 2)]],
           marks=("", "bad")),
     f'<div class="wide"><table class="dense"><caption>{DRAWN}</caption>'
     f'<thead><tr><th class="left">a</th><th>{DRAWN} <small>m³</small></th></tr></thead><tbody>'
     f'<tr><td class="left">{DRAWN}</td><td>7</td></tr>'
     f'<tr class="bad"><td class="left">{DRAWN} <span class="unit">m²</span></td>'
     f'<td class="doubt" colspan="2">{DRAWN} <span class="unit">m²</span></td></tr></tbody></table></div>'),
    (Table("c", [], [["1"]], (), style="keep"),
     '<table class="keep"><caption>c</caption><tbody><tr><td>1</td></tr></tbody></table>'),
    (Pairs([(BAD, sections.verbatim(BAD), BAD), ("a", "b; " + marked(BAD, "status"))], BAD, "limits"),
     f'<table class="limits"><caption>{DRAWN}</caption><tr><th scope="row">{DRAWN}</th><td>{KEPT}</td><td>{DRAWN}</td>'
     f'</tr><tr><th scope="row">a</th><td>b; <span class="status">{DRAWN}</span></td></tr></table>'),
    (Columns([[Text("a"), Heading("b")], [Text(BAD)]]),
     f'<div class="columns"><div><p>a</p><h3>b</h3></div><div><p>{DRAWN}</p></div></div>')]


def drawn(section):
    """Its HTML, without the white space between tags."""
    html = str(document.templates().get_template("sections.html.j2").module.section(section))
    return re.sub(r"\s*(<[^>]+>)\s*(?=<|$)", r"\1", html)


@pytest.mark.parametrize("block, html", BLOCKS, ids=lambda one: sections.kind(one) if isinstance(one, tuple) else "")
def test_a_block_is_drawn_and_its_texts_are_no_markup(block, html):
    assert drawn(Section("one", BAD, [None, block])) == f'<section id="one"><h2>{DRAWN}</h2>{html}</section>'


def test_each_kind_of_block_is_tested_here():
    tree = ast.parse((REPORT / "sections.py").read_text(encoding="utf-8"))
    kinds = {one.name for one in tree.body if isinstance(one, ast.ClassDef)} - {"Picture", "Cell", "Section"}
    assert {sections.kind(block) for block, _ in BLOCKS} == kinds


def test_an_unknown_block_is_a_fault():
    with pytest.raises(Exception, match="Picture"):
        drawn(Section("one", "", [PICTURE]))


def test_only_the_blocks_make_markup():
    """Else a name of a file could be markup."""
    for path in [*REPORT.glob("*.py"), *(TOOLS / "slope_tools" / "route").glob("*.py")]:
        if path.name != "sections.py":
            assert "Markup(" not in path.read_text(encoding="utf-8"), path
