"""The rooms of the Python package: see doc/src/architecture.rst."""
import ast
import collections
import contextlib
import functools
import importlib
import os
import re
import subprocess
import sys

import pytest

from run_helpers import TOOLS, TOP

from slope_tools import cli

PACKAGE = TOOLS / "slope_tools"
MODULES = sorted(PACKAGE.rglob("*.py"))
LONGEST = 400       # lines
# from below
ROOMS = ("", "drawing", "survey", "case", "quakes", "releases", "slips", "sites", "deposits", "mobility", "statistics",
         "runs", "tables", "ensembles", "seismic", "studies", "fitting", "plots", "animation", "report", "scenarios",
         "blocks", "route", "validation", "commands")
MOST = 25           # modules of a room; its __init__.py is one
ALIKE = 3           # public functions of one name
FILES = r"\*[\w/]+\.py\*(?: or \*[\w/]+\.py\*)?"       # that a README names; of two either
# names that say nothing of a value: not of a parameter, nor of what is used on more than LIVES lines
SAY_NOTHING = {"one", "found", "about", "said", "item", "it", "thing"}
LIVES = 5
nodes = functools.lru_cache(None)(lambda text: list(ast.walk(ast.parse(text))))     # nearly every test asks for all


def imported(text, path):
    """Modules of the package that a module imports, as tuples of words; a name in one of them counts as one, too."""
    here = path.relative_to(PACKAGE).parts[:-1]
    found = set()
    for node in nodes(text):
        if isinstance(node, ast.ImportFrom) and node.level:
            base = here[:len(here) - node.level + 1] + tuple(node.module.split(".") if node.module else ())
        elif isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] == "slope_tools":
            base = tuple(node.module.split(".")[1:])
        else:
            continue
        found |= {(*base, name.name) for name in node.names}
    return found


def room(words):
    return words[0] if words[0] in ROOMS else ""


def upwards(text, path):
    """Imports from a room above the module's own; cli.py, which takes commands by name, needs none."""
    mine = ROOMS.index(room(path.relative_to(PACKAGE).parts))
    return sorted(".".join(words) for words in imported(text, path) if ROOMS.index(room(words)) > mine)


def other_commands(text, path):
    """Commands that a command imports."""
    return sorted(".".join(words) for words in imported(text, path)
                  if words[0] == "commands" and words[1] in cli.COMMANDS and words[1] != path.stem)


def test_what_is_wrong_is_found():
    survey, volume = PACKAGE / "survey" / "rasters.py", PACKAGE / "commands" / "volume.py"
    assert upwards("from ..deposits import cut\nfrom .crs import box\n", survey) == ["deposits.cut"]
    assert upwards("def f():\n    from ..commands.volume import run\n", survey) == ["commands.volume.run"]
    assert upwards("from slope_tools.report import page\n", survey) == ["report.page"]
    assert other_commands("from . import run_arguments, study\n", volume) == ["commands.study"]
    assert other_commands("from .score import THRESHOLD\n", volume) == ["commands.score.THRESHOLD"]


@pytest.mark.parametrize("path", MODULES, ids=lambda path: str(path.relative_to(PACKAGE)))
def test_a_module(path):
    text = path.read_text(encoding="utf-8")
    assert text.count("\n") <= LONGEST
    assert upwards(text, path) == []
    assert path.parent.name != "commands" or other_commands(text, path) == []


@pytest.mark.parametrize("room_", ROOMS[1:])
def test_a_room_tells_of_files_and_functions_that_are_there(room_):
    """*name.py* of the room, or *room/name.py*; `name()` of any."""
    path = PACKAGE / room_ / "README.md"
    text = path.read_text(encoding="utf-8") if path.exists() else ""
    named = [name for name in re.findall(r"\*([\w/]+\.py)\*", text) if not (TOP / name).is_file()]
    assert [name for name in named if not any((place / name).is_file() for place in (path.parent, PACKAGE))] == []
    there = {node.name for module in MODULES for node in nodes(module.read_text(encoding="utf-8"))
             if isinstance(node, ast.FunctionDef)} if "()`" in text else set()
    assert set(re.findall(r"`(?:\w+\.)*(\w+)\(\)`", text)) <= there


def columns_of(text):
    """The columns of a table of a README, each with the first where it has a cell; "the same" is as to the left."""
    lines = [line for line in text.splitlines() if line.startswith("| ")]
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]
    for k, (first, *cells) in enumerate(rows):
        for place, cell in enumerate(cells):
            if cell.startswith("the same"):
                cells[place] = f"{cells[place - 1]} {cell}"
        rows[k] = [f"{first} {cell}" if cell else "" for cell in cells]
    return [" ".join(column) for column in zip(*rows)]


def test_a_number_of_page_1_is_made_in_ten_files():
    """By studies/README.md: of two files with "or" between them one counts; functions are in the files beside them. Two
    more are of the row on the size of the balls, a factor on the way."""
    table = "| | a | b |\n|---|---|---|\n| *x.py* | *y.py* or *z.py* | the same, *u.py* |\n| *v.py* | | *w.py* |\n"
    assert [len(re.findall(FILES, column)) for column in columns_of(table)] == [2, 5]
    text = (PACKAGE / "studies" / "README.md").read_text(encoding="utf-8")
    columns = columns_of("\n".join(line for line in text.splitlines() if not line.startswith("| at the finest balls")))
    assert len(columns) == 4 and [column for column in columns if len(set(re.findall(FILES, column))) > 10] == []
    for name, functions in re.findall(r"\*([\w/]+)\.py\*((?:,? (?:and )?`\w+\(\)`)+)", text):
        path = PACKAGE / f"{name}.py" if "/" in name else PACKAGE / "studies" / f"{name}.py"
        assert set(re.findall(r"\w+(?=\()", functions)) <= {
            node.name for node in ast.parse(path.read_text(encoding="utf-8")).body if isinstance(node, ast.FunctionDef)}


def test_every_command_is_a_module_and_every_module_in_a_room():
    commands = {path.stem for path in (PACKAGE / "commands").glob("*.py")}
    assert set(cli.COMMANDS) <= commands
    assert all((cli.TESTS / "other_codes" / f"{name}.py").is_file() for name in cli.IN_TESTS)
    assert {path.name for path in PACKAGE.iterdir() if (path / "__init__.py").is_file()} == {*ROOMS[1:]}
    for name in ROOMS[1:]:
        assert len(list((PACKAGE / name).glob("*.py"))) <= MOST, name


@pytest.mark.parametrize("name", cli.IN_TESTS)
def test_a_command_of_developers_needs_a_checkout(name, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(cli, "TESTS", tmp_path / "tests")
    with pytest.raises(SystemExit) as ended:
        cli.main([name, "--quick"])
    err = capsys.readouterr().err
    assert ended.value.code == 2 and err.count("\n") == 1 and err.startswith(f"slope {name}: ") and "checkout" in err


def test_rooms_take_no_arguments_of_the_command_line():
    """Functions below commands/ have parameters of their own, not argparse's namespace."""
    for path in (one for one in MODULES if one.parent.name != "commands" and one.name not in ("cli.py", "options.py")):
        for node in nodes(path.read_text(encoding="utf-8")):
            if isinstance(node, (ast.FunctionDef, ast.Lambda)):
                assert "args" not in [one.arg for one in (*node.args.args, *node.args.kwonlyargs)], f"{path}: {node}"
            assert not (isinstance(node, ast.Attribute) and node.attr in ("parse_args", "ArgumentParser")), path


def homonyms(texts):
    """{name: how many} of public functions, methods apart, where more than ALIKE modules have one."""
    names = collections.Counter(node.name for text in texts for node in ast.parse(text).body
                                if isinstance(node, ast.FunctionDef) and not node.name.startswith("_"))
    return {name: number for name, number in names.items() if number > ALIKE}


def test_public_functions_have_names_of_their_own():
    assert homonyms(["def read(): pass"] * 4 + ["def _f(): pass\nclass A:\n    def go(self): pass"] * 4) == {"read": 4}
    assert homonyms(path.read_text(encoding="utf-8") for path in MODULES) == {}


def say_nothing(text):
    """(line, name) of parameters, and of values that are used on more than LIVES lines, whose names say nothing."""
    for function in nodes(text):
        if not isinstance(function, (ast.FunctionDef, ast.Lambda)):
            continue
        given = function.args
        every = [*given.posonlyargs, *given.args, *given.kwonlyargs, *filter(None, (given.vararg, given.kwarg))]
        yield from ((arg.lineno, arg.arg) for arg in every if arg.arg in SAY_NOTHING)
        own = {node.id: node.lineno for node in sorted(own_names(function), key=lambda node: -node.lineno)
               if node.id in SAY_NOTHING.difference(arg.arg for arg in every)}
        used = names_in(function) if own else ()
        last = {node.id: node.lineno for node in sorted(used, key=lambda node: node.lineno)}
        yield from ((line, name) for name, line in own.items() if last[name] - line > LIVES)


def names_in(node):
    return (part for part in ast.walk(node) if isinstance(part, ast.Name))


def own_names(function):
    """Names that a function itself assigns, not a function or a comprehension in it."""
    waiting = list(ast.iter_child_nodes(function))
    while waiting:
        node = waiting.pop()
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            yield node
        if not isinstance(node, (ast.FunctionDef, ast.Lambda, ast.ClassDef, ast.comprehension)):
            waiting += ast.iter_child_nodes(node)


def test_names_say_what_they_hold():
    assert list(say_nothing("def f(one, *, x):\n    pass\n")) == [(1, "one")]
    assert list(say_nothing("f = lambda found: found\n")) == [(1, "found")]
    long = "def f():\n    about = 1\n" + "    g()\n" * LIVES + "    return {}\n"
    assert list(say_nothing(long.format("about"))) == [(2, "about")]
    assert list(say_nothing(long.format("[about for about in x]").replace("about = 1", "y = 1"))) == []
    assert list(say_nothing("def f():\n    one = 1\n    return one\n")) == []
    assert {path.relative_to(PACKAGE).as_posix(): wrong for path in MODULES
            if (wrong := list(say_nothing(path.read_text(encoding="utf-8"))))} == {}


# the line of an error, a warning, progress, the names of a report's pictures
PRINT = {"cli.py", "findings.py", "runs/job_display.py", "validation/verify.py", "report/document.py"}


def prints(text):
    """Lines on which a module calls print()."""
    return [node.lineno for node in nodes(text)
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "print"]


def test_rooms_print_nothing():
    assert prints("def f(line):\n    print(line)\n") == [2] and prints("def f(print_):\n    print_.show(1)\n") == []
    found = {path.relative_to(PACKAGE).as_posix() for path in MODULES
             if path.parent.name != "commands" and prints(path.read_text(encoding="utf-8"))}
    assert found == PRINT


@pytest.mark.parametrize("name", ["study", "volume", "polygon"])
def test_a_command_loads_only_what_it_needs(name):
    """Other commands, and rooms that it does not need, stay unloaded."""
    code = (f"import sys; sys.path.insert(0, {str(TOOLS)!r})\nfrom slope_tools import cli\n"
            f"try:\n    cli.main([{name!r}, '--help'])\nexcept SystemExit:\n    pass\n"
            "print('loaded', *(one for one in sys.modules if one.startswith('slope_tools.')))")
    done = subprocess.run([sys.executable, "-c", code], text=True, capture_output=True, check=True, env=os.environ)
    loaded = done.stdout.split("loaded ")[1].split()
    others = {f"slope_tools.commands.{other}" for other in cli.COMMANDS} - {f"slope_tools.commands.{name}"}
    assert f"slope_tools.commands.{name}" in loaded
    assert not others & set(loaded)
    assert not [one for one in loaded if one.startswith(tuple(
        f"slope_tools.{name}." for name in ("plots", "animation", "report", "validation")))]


def imports_of_modules(texts):
    """{module: the modules that it imports anywhere, inside functions too}; texts: {path: source}."""
    names = {path.relative_to(PACKAGE).with_suffix("").parts: path for path in texts}
    return {".".join(mine): {".".join(part) for words in imported(texts[path], path)
                             for part in (words, words[:-1]) if part in names and part != mine}
            for mine, path in names.items()}


def circle(graph):
    """A circle of modules, each importing the next one; an empty list without any."""
    done = set()

    def follow(module, way):
        if module in way:
            return way[way.index(module):] + [module]
        if module in done:
            return []
        done.add(module)
        return next(filter(None, (follow(other, [*way, module]) for other in sorted(graph.get(module, ())))), [])

    return next(filter(None, (follow(module, []) for module in sorted(graph))), [])


def test_no_circle_of_imports():
    """An import inside a function may save time, not hide that two modules need each other."""
    one, other = PACKAGE / "studies" / "results.py", PACKAGE / "studies" / "study.py"
    assert circle(imports_of_modules({one: "def f():\n    from . import study\n", other: "from .results import f\n"})) \
        == ["studies.results", "studies.study", "studies.results"]
    assert circle(imports_of_modules({one: "", other: "from .results import f\n"})) == []
    assert circle(imports_of_modules({path: path.read_text(encoding="utf-8") for path in MODULES})) == []


def taken_of_the_package(path):
    """(module, name) of what a script takes of modules of slope_tools, by their names or as attributes."""
    tree, modules = ast.parse(path.read_text(encoding="utf-8")), {}
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] == "slope_tools":
            for one in node.names:
                yield node.module, one.name
                modules[one.asname or one.name] = f"{node.module}.{one.name}"
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id in modules:
            yield modules[node.value.id], node.attr


SCRIPTS = [path for path in (*(TOP / "inputs").glob("*/*.py"), *(TOP / "tests").glob("*.py"),
                             *(TOP / "tests" / "other_codes").glob("*.py"))
           if "slope_tools" in path.read_text(encoding="utf-8")]


@pytest.mark.parametrize("path", SCRIPTS, ids=lambda path: "/".join(path.parts[-2:]))
def test_what_scripts_take_of_the_package_is_there(path):
    """No type checker sees them, and those of inputs run by hand only."""
    for where, name in taken_of_the_package(path):
        try:
            module = importlib.import_module(where)
        except ModuleNotFoundError:     # a class or a function of a module
            continue
        with contextlib.suppress(ModuleNotFoundError):
            importlib.import_module(f"{where}.{name}")
        assert hasattr(module, name), f"{where}.{name}"


def test_affine_transforms_are_applied_by_at():
    """affine 3 finds fault with *, but only a release after Debian 13 has it; see survey/grids.py."""
    with_star = re.compile(r"transform \*(?!\*)|\* Affine\.|\* [\w.]*transform\b(?!\.)")
    assert with_star.search("~raster.transform * (column, row)") and not with_star.search("2 * raster.transform.a")
    assert [f"{path.relative_to(PACKAGE)}: {line.strip()}" for path in MODULES
            for line in path.read_text(encoding="utf-8").splitlines() if with_star.search(line)] == []
