"""Sphinx: the pages of this folder as HTML. `cmake --build build --target doc` makes build/html.

Formulas become drawings by matplotlib, which need neither a network nor fonts where they are read.
"""
import html
import re
import sys
from pathlib import Path

from docutils import nodes
from matplotlib.font_manager import FontProperties
from matplotlib.textpath import TextPath
from pygments.lexer import RegexLexer, bygroups
from pygments.token import Comment, Keyword, Name, Number, String, Text
from sphinx.util import logging

logger = logging.getLogger(__name__)

sys.path.insert(0, str(Path(__file__).parent))
extensions = ["slope_options"]
project = "SLOPE"
version = release = re.search(r'SLOPE_VERSION "(.*)"',
                              (Path(__file__).parents[2] / "src" / "slope_version.h").read_text(encoding="ascii"))[1]
copyright = "GNU General Public License version 2"
exclude_patterns = ["_build"]
highlight_language = "none"
nitpicky = True
smartquotes = False     # -- of options stays as it is typed

html_theme = "sphinx_rtd_theme"
html_theme_options = {"navigation_depth": 2, "style_external_links": True}
html_static_path = ["_static"]
html_css_files = ["slope.css"]
html_title = f"SLOPE {version}"
html_short_title = "SLOPE"
html_math_renderer = "drawing"
html_show_sphinx = html_copy_source = html_show_sourcelink = False

# what the pages name of LAMMPS' manual, as its own pages do; anything else that is not here is an error
LAMMPS_MANUAL = "https://docs.lammps.org/{}.html"
LAMMPS_PAGES = set("""
balance boundary compute_pair_local create_atoms create_box delete_atoms displace_atoms dump fix fix_balance fix_deposit
fix_freeze fix_gravity fix_halt fix_modify fix_move fix_nve fix_nve_sphere fix_pour fix_rigid fix_wall_gran_region
minimize neigh_modify neighbor pair_coeff pair_gran pair_granular read_restart region reset_timestep restart run suffix
thermo_modify timestep unfix units write_restart
""".split())


class LammpsLexer(RegexLexer):
    """Input decks."""

    name = "LAMMPS"
    tokens = {
        "root": [
            (r"^(\s*)([a-z_]+)", bygroups(Text, Keyword)),
            (r"#.*$", Comment),
            (r"\$\{\w+\}|\$\([^)]*\)|\b[vfc]_\w+", Name.Variable),
            (r'"[^"]*"|\'[^\']*\'', String),
            (r"(?<![\w/])[-+]?\d+\.?\d*([eE][-+]?\d+)?(?![\w/])", Number),
            (r"\s+", Text),
            (r"[\w/]+|.", Text),
        ],
    }


def lammps_page(app, env, node, contnode):
    """A page that is not here, but in LAMMPS' manual."""
    target = node.get("reftarget")
    if node.get("reftype") != "doc" or target not in LAMMPS_PAGES:
        return None
    text = contnode.astext()
    return nodes.reference("", text if node["refexplicit"] else target, internal=False,
                           refuri=LAMMPS_MANUAL.format(target))


SIZE = 100      # units of a drawing in an em
FONT = FontProperties(math_fontfamily="stix")
STEPS = {1: "M", 2: "L", 3: "Q", 4: "C", 79: "Z"}       # matplotlib.path.Path's codes in SVG


def drawing(node, display=False):
    """The formula of a node as SVG, its baseline on that of the text; a warning if it is none."""
    tex = " ".join(node.astext().split())
    words = re.sub(r"\\boldsymbol\s*(\\[a-z]+)", r"\\mathbf{\1}", tex)     # as matplotlib knows them
    words = re.sub(r"\\([lg]e)\b", r"\\\1q", words)
    words = words.replace(r"\frac", r"\dfrac" if display else r"\frac").replace(r"\tfrac", r"\frac")
    try:
        path = TextPath((0, 0), f"${words}$", size=SIZE, prop=FONT)
    except ValueError as error:
        logger.warning("formula %s: %s", tex, " ".join(str(error).split()), location=node)
        return ""
    steps = "".join(STEPS[code] + ("" if code == 79 else " ".join(f"{v:.0f}" for v in points))
                    for points, code in path.iter_segments())
    # control points included: the extremes of the fonts' curves are points of theirs
    drawn = path.vertices[path.codes != 79]
    (_, bottom), (right, top) = drawn.min(axis=0), drawn.max(axis=0)
    low, high, wide = min(bottom, 0) - 2, top + 2, right + 4
    return (f'<svg role="img" aria-label="{html.escape(tex)}" viewBox="-2 {-high:.0f} {wide:.0f} {high - low:.0f}" '
            f'style="width:{wide / SIZE:.3f}em;height:{(high - low) / SIZE:.3f}em;vertical-align:{low / SIZE:.3f}em">'
            f'<path transform="scale(1 -1)" d="{steps}"/></svg>')


def inline_formula(writer, node):
    writer.body.append(f'<span class="math">{drawing(node)}</span>')
    raise nodes.SkipNode


def formula(writer, node):
    writer.body.append(f'<div class="math">{drawing(node, display=True)}</div>\n')
    raise nodes.SkipNode


def made_number(_name, _raw, text, _line, _inliner, options=None, content=None):  # pylint: disable=unused-argument
    """:made:`0.249<01.name>`: a number that tests/made_numbers.py puts in."""
    return [nodes.Text(text.rsplit("<", 1)[0])], []


def setup(app):
    app.add_role("made", made_number)
    app.add_lexer("LAMMPS", LammpsLexer)
    app.add_html_math_renderer("drawing", (inline_formula, None), (formula, None))
    app.connect("missing-reference", lammps_page)
