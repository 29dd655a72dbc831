"""The choices of a site as types: what site.yaml may hold by its schema, and nothing else."""
import ast
import dataclasses
from typing import ClassVar, get_origin, get_type_hints

import pytest
import yaml

from run_helpers import TOOLS

from slope_tools.errors import SlopeError
from slope_tools.sites import site_choices, site_sections
from slope_tools.sites.site_found import Body, Found, Origin, SlipBody, Zone
from slope_tools.sites.site_sections import KINDS, Choices, OfBlocks, OfMass, sections

EACH = [(kind, name, about) for kind in KINDS for name, about in sections(kind)]


@pytest.mark.parametrize("kind", KINDS)
def test_a_site_has_the_sections_of_its_schema(kind):
    hints = {name: hint for name, hint in get_type_hints(KINDS[kind]).items() if get_origin(hint) is not ClassVar}
    assert hints.keys() - {"older"} == {name for name, _ in sections(kind)}
    assert KINDS[kind].KIND == kind


@pytest.mark.parametrize("kind, name, about", EACH)
def test_what_is_not_given_is_the_schemas(kind, name, about):
    made = KINDS[kind].of({})
    wanted = {key: entry.get("default", []) for key, entry in about["properties"].items()}
    assert made.entries()[name] == wanted and KINDS[kind].of(made.entries()) == made


def test_choices_are_frozen_and_others_are_made_of_them():
    made = OfMass.of({"study": {"rolling": [0, 0.1]}, "road": {"from": 3}, "known": {"confined": True}})
    for owner, name in ((made, "road"), (made.road, "from_"), (made.study, "rolling")):
        with pytest.raises(dataclasses.FrozenInstanceError):
            setattr(owner, name, None)
    assert made.study.rolling == (0, 0.1) and made.road.asked.start == 3 and made.known.confined == "yes"
    other = made.changed({("road", "from"): 4, ("road", "mesh"): 5, ("study", "spacing"): [0.5]})
    assert (other.road.from_, other.road.mesh, other.study.spacing) == (4, 5, (0.5,)) and made.road.from_ == 3
    assert other.study.rolling is made.study.rolling and isinstance(other, OfMass)
    assert OfBlocks.of({}).entries()["kind"] == "blocks" and not OfBlocks.of({}).has("motion", "file")
    assert made.study.levels is None and OfMass.of({"study": {"levels": 2}}).study.levels == 2


def test_no_signature_takes_choices_for_a_mapping():
    """A type checker would see none of their keys; of a body's shape, in releases, they are another thing."""
    wrong = []
    for path in sorted((TOOLS / "slope_tools").rglob("*.py")):
        if path.parent.name == "releases":
            continue
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.FunctionDef):
                for one in (*node.args.args, *node.args.kwonlyargs):
                    said = ast.unparse(one.annotation) if one.annotation else ""
                    if one.arg == "choices" and (not said or any(word in said for word in ("Dict", "Mapping", "Any"))):
                        wrong.append(f"{path.name}: {node.name}: {said or 'none'}")
    assert wrong == []
    assert issubclass(OfMass, Choices) and site_sections.schema()["properties"].keys() > {"road", "model"}


def test_what_was_found_lacks_what_older_sites_do_not_have():
    assert Found.of({"found": None}) == Found.of({}) == Found()
    made = Found.of({"found": {
        "files": ["a"], "body": {"volume": 5.0}, "trial": {"balls": 3}, "zones": None, "roads": None,
        "origin": {"east": 1}, "bodies": {2: {"volume_m3": 7.0}}}})
    assert made.files == ("a",) and made.body == Body(5.0) and made.trial is None and made.origin == Origin(1, 0.0)
    assert made.bodies == {"2": SlipBody(7.0)} and made.zones == made.roads == ()
    zone = {"name": "n", "variables": "v", "friction": 35, "area_m2": 9.0, "share": 0.2}
    assert Found.of({"found": {"zones": [zone]}}).zones == (Zone("n", "v", {"friction": 35}, 0.2),)


@pytest.mark.parametrize("found, where", [
    ({"files": 3}, "files"), ({"roads": "x"}, "roads"), ({"zones": [{}]}, "zones: first value"),
    ({"body": [1]}, "body"), ({"bodies": {"1": {}}}, "bodies: 1"), ({"sources_sha256": "x"}, "sources_sha256"),
    ({"trial": 4}, "trial"), ({"origin": {"east": "x"}}, "origin: east"), ({"derived": []}, "derived"),
    ({"blocks": {"down": 1}}, "blocks: down")])
def test_what_was_found_is_checked_when_it_is_read(tmp_path, found, where):
    """It is not to be changed; who did gets a line, whatever reads it."""
    about = {"slope_site": 1, "terrain": {"files": ["dem.tif"]}, "release": {}, "found": found}
    (tmp_path / "site.yaml").write_text(yaml.safe_dump(about))
    for read in (site_choices.load_site, site_choices.found):
        with pytest.raises(SlopeError, match=f"site.yaml: must be a site.yaml of `slope site`: found: {where}: must"):
            read(tmp_path)
