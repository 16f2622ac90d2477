"""Names are printed, never parsed: no code of the package reads facts from names, docstrings or reasons.

The check is by syntax: regular expressions anywhere, and methods that take text apart on the attributes and variables
which hold names. What other code may do with text (paths, generated lines, files) is left alone.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[2] / "derive"
PARTS = (
    "mechanics", "lowering", "ir", "backends", "report", "simulation", "runtime", "study", "visual", "pipeline.py",
)  # fmt: skip

METHODS = {"split", "rsplit", "partition", "rpartition", "startswith", "endswith", "removeprefix", "removesuffix"}
STRIPS = {"strip", "lstrip", "rstrip"}
ATTRIBUTES = {"name", "doc", "zero", "reason", "row", "section"}
VARIABLES = {"name", "symbol"}

EXEMPT = {
    "ir/model.py": "numbers the elements of arrays, those of rates before their dot",
    "report/writers/picture.py": "reads SVG pictures of users: addresses, sizes and style sheets",
    "report/writers/markdown.py": "escapes text for Markdown",
    "report/writers/latex_text.py": "escapes text for LaTeX",
    "report/writers/latex_math.py": "puts escaped text back into formulas in LaTeX",
    "report/notation/glyphs.py": "typesets letters by their Unicode names, and the numbers that users write",
    "report/notation/formula_reader.py": "reads formulas that are written in a line",
    "report/document/anchors.py": "turns any text into an address that browsers take",
    "visual/chart_style.py": "shortens the numbers of an SVG file that matplotlib wrote",
}
"""Files that may read text, and why."""


def receives_a_name(node: ast.expr) -> bool:
    """Whether an expression is a name of the derivation: `x.name`, `str(x)`, `name`."""
    match node:
        case ast.Attribute(attr=attr):
            return attr in ATTRIBUTES
        case ast.Name(id=identifier):
            return identifier in VARIABLES
        case ast.Call(func=ast.Name(id="str")):
            return True
        case ast.Subscript(value=value):
            return receives_a_name(value)
        case ast.BoolOp(values=values):
            return any(map(receives_a_name, values))
        case ast.IfExp(body=body, orelse=orelse):
            return receives_a_name(body) or receives_a_name(orelse)
    return False


def has_letters(arguments: list[ast.expr]) -> bool:
    """Whether a strip has an argument, with letters or no constant, that names the characters to remove."""
    return any(not isinstance(a, ast.Constant) or any(map(str.isalpha, str(a.value))) for a in arguments)


def parses(node: ast.AST) -> bool:
    """Whether a node takes a name apart, or uses a regular expression."""
    match node:
        case ast.ImportFrom(module="re"):
            return True
        case ast.Call(func=ast.Attribute(value=ast.Name(id="re"))):
            return True
        case ast.Call(func=ast.Attribute(value=value, attr=method), args=arguments):
            taken_apart = method in METHODS or method in STRIPS and has_letters(arguments)
            return taken_apart and receives_a_name(value)
        case ast.Subscript(value=ast.Attribute(attr="name"), ctx=ast.Load()):
            return True
        case ast.Compare(left=ast.Constant(value=str()), ops=[ast.In() | ast.NotIn()], comparators=[right]):
            return isinstance(right, ast.Attribute | ast.Call) and receives_a_name(right)
    return False


def findings(source: str) -> list[int]:
    """The lines that parse names."""
    return sorted({node.lineno for node in ast.walk(ast.parse(source)) if parses(node)})


def files() -> Iterator[tuple[str, Path]]:
    """The files that are checked, by their paths inside the package."""
    for part in PARTS:
        top = PACKAGE / part
        assert top.exists(), part
        for path in [top] if top.is_file() else sorted(top.rglob("*.py")):
            yield path.relative_to(PACKAGE).as_posix(), path


def test_no_file_parses_names() -> None:
    found = {name: findings(path.read_text()) for name, path in files() if name not in EXEMPT}
    assert {name: lines for name, lines in found.items() if lines} == {}


def test_every_exemption_is_needed() -> None:
    """A line of the list leaves when its file no longer needs it."""
    present = dict(files())
    assert [name for name in EXEMPT if name not in present or not findings(present[name].read_text())] == []


@pytest.mark.parametrize(
    "line",
    [
        "re.match('c[0-9]', text)",
        "from re import match",
        "symbol.name.split('_')",
        "row.name.startswith('alpha')",
        "name.endswith('phi')",
        "str(symbol).rpartition('_')",
        "coefficient.zero.removeprefix('condition ')",
        "definition.section.rsplit('_', 1)",
        "name.rstrip('dot')",
        "vanished.reason.partition(' = ')",
        "symbol.name[-1]",
        "'dot' in symbol.name",
        "'_' not in str(symbol)",
        "names[i].name.split('_')",
    ],
)
def test_lines_that_parse_are_noticed(line: str) -> None:
    assert findings(f"x = 1\n{line}\n") == [2]


@pytest.mark.parametrize(
    "line",
    ["file.path.endswith('.c')", "text.strip()", "name.strip()", "', '.join(names)", "f'{symbol.name}_1'", "names[0]"],
)
def test_other_lines_are_left_alone(line: str) -> None:
    assert findings(f"{line}\n") == []
