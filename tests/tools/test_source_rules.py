"""What holds for every source of the package: see doc/src/architecture.rst and doc/src/developing.rst."""
import re
import subprocess
from pathlib import Path

import pytest

SRC = Path(__file__).resolve().parents[2] / "src"
SOURCES = sorted(SRC.glob("**/*.h")) + sorted(SRC.glob("**/*.cpp"))
NAMES = {path.name: path for path in SOURCES}
LONGEST_FUNCTION = 80
# A room includes its own files and those of the rooms in this list; slope_version.h is above all of them.
BELOW = ("common", "lammps")
ROOMS = {"common": (), "lammps": ("common",), "contacts": BELOW, "regions": BELOW,
         "ground": (*BELOW, "regions", "contacts"), "meshes": (*BELOW, "contacts"),
         "deposit": (*BELOW, "regions", "contacts"), "motion": (*BELOW, "contacts"), "slips": (*BELOW, "regions"),
         "plugin": ()}
# first line of a file that needs no LAMMPS: it includes such files of its own room and of common alone
FREE = "// No LAMMPS\n"


def room_of(path):
    """The folder of a source below src; "" for src itself."""
    return path.parent.relative_to(SRC).as_posix().strip(".")


def is_free(path):
    """Whether a file says that it needs no LAMMPS."""
    return path.read_text().startswith(FREE)


def includes(path):
    """Names of our files that a file includes, and of others'."""
    names = set(re.findall(r'^#include "([^"]+)"', path.read_text(), re.MULTILINE))
    return names & NAMES.keys(), names - NAMES.keys()


def not_allowed(room, names):
    """What a file of this room must not include, of the files {name: room}."""
    return sorted(name for name, other in names.items() if other not in (room, "", *ROOMS[room]))


def pairs(sources):
    """{name of a .h/.cpp pair: names of the other pairs that it includes}"""
    of = {}
    for path in sources:
        of.setdefault(path.stem, set()).update(Path(name).stem for name in includes(path)[0])
    return {name: others - {name} for name, others in of.items()}


def circle(of):
    """A circle in {name: names}, as a list that begins and ends with the same name; None without one."""
    done = set()

    def visit(name, way):
        if name in way:
            return way[way.index(name):] + [name]
        if name in done:
            return None
        for other in sorted(of.get(name, ())):
            found = visit(other, way + [name])
            if found:
                return found
        done.add(name)
        return None

    for name in sorted(of):
        found = visit(name, [])
        if found:
            return found
    return None


def functions(text):
    """(first line, lines) of each function body: a block whose opening brace ends a line of its own or a header."""
    lines = re.sub(r'"(\\.|[^"\\])*"', '""', text).splitlines()
    open_at, found = [], []
    for number, line in enumerate(lines, 1):
        code = line.split("//")[0]
        for character in code:
            if character == "{":
                open_at.append((number, code))
            elif character == "}" and open_at:
                start, header = open_at.pop()
                found.append((start, number - start + 1, header, len(open_at)))
    # the outermost blocks that are no namespace, class, struct or initializer
    return [(start, length) for start, length, header, depth in found if header.strip() == "{"]


def test_the_circle_is_found():
    assert circle({"a": {"b"}, "b": {"c"}, "c": {"b"}}) == ["b", "c", "b"]
    assert circle({"a": {"b", "c"}, "b": {"c"}}) is None


def test_a_long_function_is_found():
    text = "int f()\n{\n" + "  step();\n" * 90 + "}\n\nint g()\n{\n  return 1;\n}\n"
    assert functions(text) == [(2, 92), (96, 3)]


def test_an_arrow_upwards_is_found():
    assert not_allowed("regions", {"region_columns.h": "regions", "text_file.h": "common", "triangle.h": "meshes",
                                   "pair_gran_restitution.h": "contacts"}) == ["pair_gran_restitution.h", "triangle.h"]


def test_every_file_is_in_a_room():
    assert len(SOURCES) > 80 and len(NAMES) == len(SOURCES)
    assert {room_of(path) for path in SOURCES} == {"", *ROOMS}
    assert [path.name for path in SOURCES if path.parent == SRC] == ["slope_version.h"]
    assert [room for room in ROOMS if not (SRC / room / "README.md").exists()] == []


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: path.name)
def test_no_arrow_upwards(path):
    room = room_of(path)
    ours, others = includes(path)
    if not room:
        assert not ours
        return
    assert not_allowed(room, {name: room_of(NAMES[name]) for name in ours}) == []
    if room == "common" or is_free(path):
        assert is_free(path) and not others
        assert [name for name in ours if not is_free(NAMES[name]) or room_of(NAMES[name]) not in (room, "common")] == []


def syntax_errors(room, texts):
    """What the compiler says of C++11 that finds the headers of a room and of common alone."""
    code = "".join(texts)
    where = [f"-I{SRC / room}", f"-I{SRC / 'common'}"]
    ended = subprocess.run(["c++", "-std=c++11", "-fsyntax-only", "-Wno-psabi", *where, "-x", "c++", "-"], input=code,
                           capture_output=True, text=True)
    return ended.stderr if ended.returncode else ""


@pytest.mark.parametrize("room", [room for room in ROOMS if room not in ("lammps", "regions", "plugin")])
def test_headers_without_lammps_compile_without_it(room):
    """Each alone: by its .cpp, of which it is the first line and which tests/CMakeLists.txt compiles so, or here."""
    headers = [path for path in sorted((SRC / room).glob("*.h")) if is_free(path)]
    assert headers
    sources = {path: path.with_suffix(".cpp") for path in headers if path.with_suffix(".cpp").exists()}
    assert [path.name for path, source in sources.items() if not re.search(
        rf'\A[^#]*#include "{path.name}"', source.read_text())] == []
    headers = [path for path in headers if path not in sources or not is_free(sources[path])]
    assert {path.name: text for path in headers if (text := syntax_errors(room, [f'#include "{path.name}"\n']))} == {}


def test_a_header_with_lammps_does_not_compile_without_it():
    assert "pointers.h" in syntax_errors("contacts", ['#include "contact_table.h"\n'])


def test_no_circle_of_pairs():
    """Of .h/.cpp pairs, which is more than the compiler asks."""
    assert circle(pairs(SOURCES)) is None


def second_bases(texts):
    """Classes beside the first, LAMMPS' one, that a class derives from and whose destructor is virtual."""
    beside = {name for text in texts
              for bases in re.findall(r"^class \w+ : public \w+, ([^{]+) \{", text, re.MULTILINE)
              for name in re.findall(r"\w+", bases) if name != "public"}
    return sorted(name for name in beside for text in texts if re.search(rf"virtual ~{name}\(", text))


def test_a_virtual_destructor_beside_the_one_of_lammps_is_found():
    user = "class FixA : public Fix, public Asked {"
    assert second_bases([user, "virtual ~Asked() = default;"]) == ["Asked"]
    assert second_bases([user, "protected:\n ~Asked() = default;"]) == []


def test_destructors_beside_the_one_of_lammps():
    """That of LAMMPS' classes may throw in some versions, so one that may not does not compile with it."""
    assert second_bases([path.read_text() for path in SOURCES if path.suffix == ".h"]) == []


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: path.name)
def test_sizes(path):
    text = path.read_text()
    assert [start for start, length in functions(text) if length > LONGEST_FUNCTION] == []


# LAMMPS' lists of fixes, computes and groups, which change between its versions, and members that are not public
INSIDES = re.compile(r"modify->(?!(?:add|replace)_fix\()\w+|\b(?:find|delete)_(?:fix|compute)(?:_by_style)?\(|"
                     r"\bbitmask\b|SLOPE_REVEAL|LAMMPS_VERSION\s*[<>]=?")
KNOWS_INSIDES = {"lammps_compat.h", "lammps_compat.cpp", "reveal.h", "test_reveal.cpp"}


def insides(text):
    """What code has of LAMMPS' insides, without its comments."""
    return INSIDES.findall(re.sub(r"//[^\n]*|/\*.*?\*/", "", text, flags=re.DOTALL))


@pytest.mark.parametrize("code", [
    "for (int k = 0; k < modify->nfix; k++)", "lmp->modify->fix[k]", "modify->fmask[k]", "modify->find_fix(id)",
    "modify->ncompute", "m.delete_fix(id)", "group->bitmask[igroup]", "modify->nfix_restart_peratom",
    "SLOPE_REVEAL(Modify, int, nfix)", "#if SLOPE_LAMMPS_VERSION >= 20220504"])
def test_insides_of_lammps_are_found(code):
    assert insides(code)


def test_one_file_knows_the_insides_of_lammps():
    assert not insides("modify->add_fix(words); modify->replace_fix(id, words); x;  // modify->fix[0]\n")
    tests = (SRC.parent / "tests").glob("unit/**/*.cpp")
    assert {path.name: found for path in [*SOURCES, *tests] if path.name not in KNOWS_INSIDES
            and (found := insides(path.read_text()))} == {}
