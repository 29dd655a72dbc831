#!/usr/bin/python3
"""The tests that a change can touch, nearest and cheapest first, as far as two minutes on two processors go.

    changed.py COMMIT UNITS     prints the files for pytest; writes into the file UNITS a regular expression of ctest's

Nearest: a test that imports the changed module, then one that imports a module which imports it, and so on. Of C++, the
unit tests that include the header, and the decks that use a style of its room.
"""
import ast
import collections
import re
import subprocess
import sys
from pathlib import Path

from times import read_seconds

TESTS = Path(__file__).resolve().parent
TOP = TESTS.parent
BUDGET = 200.0          # processor seconds
STYLE = re.compile(r"^(?:Pair|Fix|Region|Command)Style\(([^,]+),", re.M)
SUITE = re.compile(r"^TEST(?:_[FP])?\((\w+),", re.M)
PAGES = ["tools/test_pages.py", "tools/test_lint.py"]


def changed_files(commit):
    def listed(*words):
        return subprocess.run(["git", *words], cwd=TOP, check=True, text=True, capture_output=True).stdout.splitlines()
    return sorted({*listed("diff", "--name-only", commit), *listed("ls-files", "--others", "--exclude-standard")})


def imports_of(path, package=()):
    """Names of modules that a file imports; package: its own, for relative imports."""
    names = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            base = ".".join((*package[:len(package) - node.level + 1], *filter(None, [node.module]))
                            ) if node.level else node.module
            names |= {base, *(f"{base}.{alias.name}" for alias in node.names)}
    return names


def module_imports():
    """{module or test: what it imports} of the tools and of tests/tools."""
    tools = TOP / "tools"
    found = {}
    for path in (tools / "slope_tools").rglob("*.py"):
        parts = path.relative_to(tools).with_suffix("").parts
        package = parts[:-1]
        name = ".".join(package if parts[-1] == "__init__" else parts)
        found[name] = imports_of(path, package)
    for path in (*TESTS.glob("tools/*.py"), *TESTS.glob("decks/*.py")):
        found[path.stem] = imports_of(path)
        command = re.search(r'^COMMAND = "(\w+)', path.read_text(encoding="utf-8"), re.M)
        if command:
            found[path.stem].add(f"slope_tools.commands.{command[1]}")
    return found


def distances(changed):
    """{test file: how many imports lie between it and the nearest of the changed modules}."""
    users = collections.defaultdict(set)
    for name, imported in module_imports().items():
        for one in imported:
            users[one].add(name)
    steps = {name: 0 for name in changed}
    queue = collections.deque(changed)
    while queue:
        name = queue.popleft()
        for user in users[name] - steps.keys():
            steps[user] = steps[name] + 1
            if not user.startswith("test_"):        # a test that imports another one's helpers is no nearer by it
                queue.append(user)
    return {path.relative_to(TESTS).as_posix(): steps[path.stem]
            for path in TESTS.glob("*/test_*.py") if path.stem in steps}


def touched_by(path):
    """{test file: distance} and names of unit tests, of one changed file."""
    parts = path.split("/")
    if parts[0] == "src" and len(parts) == 3:
        room = TOP / "src" / parts[1]
        sources = [test.read_text() for test in TESTS.glob("unit/test_*.cpp")]
        units = [name for text in sources if f'"{Path(path).stem}.h"' in text for name in SUITE.findall(text)]
        styles = [name for header in room.glob("*.h") for name in STYLE.findall(header.read_text())]
        header = (TOP / path).with_suffix(".h")
        own = STYLE.findall(header.read_text()) if header.exists() else []
        decks = {}
        for test in TESTS.glob("decks/test_*.py"):
            text = test.read_text()
            if any(style in text for style in styles):
                decks[test.relative_to(TESTS).as_posix()] = 1 if any(style in text for style in own) else 2
        return {**decks, "tools/test_source_rules.py": 0}, [*units, "lammps"]
    if parts[0] == "tools" and path.endswith(".py"):
        name = path.removeprefix("tools/").removesuffix(".py").replace("/", ".").removesuffix(".__init__")
        return {**distances({name}), "tools/test_rooms.py": 0, "tools/test_lint.py": 0}, []
    if parts[:2] == ["tests", "unit"]:
        return {}, SUITE.findall((TOP / path).read_text())
    if parts[0] == "tests" and len(parts) == 3 and path.endswith(".py"):
        own = {"/".join(parts[1:]): 0} if parts[2].startswith("test_") else {}
        return {**distances({Path(path).stem}), **own}, []
    # whatever names it: a page, a case, a script
    name = {"doc": Path(path).stem, "inputs": parts[min(1, len(parts) - 1)]}.get(parts[0], parts[-1])
    named = {test.relative_to(TESTS).as_posix(): 1 for test in TESTS.glob("*/test_*.py") if name in test.read_text()}
    return {**named, **(dict.fromkeys(PAGES, 0) if parts[0] == "doc" else {})}, []


def main(commit, units_file):
    near, units = {}, set()
    for path in changed_files(commit):
        files, names = touched_by(path)
        units |= set(names)
        for name, distance in files.items():
            near[name] = min(distance, near.get(name, distance))
    seconds, spent, left = read_seconds(), 0.0, []
    for name in sorted(near, key=lambda name: (near[name], seconds.get(name, 1.0))):
        if not (TESTS / name).is_file():
            continue
        spent += seconds.get(name, 1.0)
        if spent > BUDGET:
            left.append(name)
        else:
            print(TESTS / name)
    Path(units_file).write_text("|".join(rf"^unit\.{name}" for name in sorted(units)) or "^$")
    if left:
        print(f"changed: beyond {BUDGET:.0f} s of processor time, left out: {' '.join(left)}", file=sys.stderr)


if __name__ == "__main__":
    main(*sys.argv[1:])
