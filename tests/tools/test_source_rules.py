"""What holds for every source of the package: see doc/src/developing.rst."""
import re
from pathlib import Path

import pytest

SRC = Path(__file__).resolve().parents[2] / "src"
SOURCES = sorted(SRC.glob("**/*.h")) + sorted(SRC.glob("**/*.cpp"))
LONGEST_FUNCTION = 80


def includes(path):
    names = re.findall(r'^#include "([^"]+)"', path.read_text(), re.MULTILINE)
    return {name for name in names if name in {source.name for source in SOURCES}}


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


def test_no_circle_of_includes():
    assert len(SOURCES) > 80
    assert circle({path.name: includes(path) for path in SOURCES}) is None


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: path.name)
def test_sizes(path):
    text = path.read_text()
    assert [start for start, length in functions(text) if length > LONGEST_FUNCTION] == []
