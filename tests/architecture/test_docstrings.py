"""Docstrings stand alone: none begins with "What", or refers to its neighbour as "Those of" or "Likewise" do."""

import ast
from collections.abc import Iterator

import pytest

from conftest import ROOT

REFERRING = ("What ", "Those ", "Likewise", "That of ", "The same of ")
"""Beginnings of docstrings that need a neighbour to be understood."""


def docstrings(source: str) -> Iterator[tuple[int, str]]:
    """The line and the text of each docstring of modules, classes, functions and attributes."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
            for statement in node.body:
                match statement:
                    case ast.Expr(ast.Constant(str(text))):
                        yield statement.lineno, text.lstrip()


@pytest.mark.parametrize("folder", ["derive", "tests", "bench", "examples"])
def test_docstrings_stand_alone(folder: str) -> None:
    texts = {path: list(docstrings(path.read_text(encoding="utf-8"))) for path in (ROOT / folder).rglob("*.py")}
    assert sum(map(len, texts.values())) > 10
    named = [
        f"{path.relative_to(ROOT).as_posix()}:{line}: {text}"
        for path, in_file in texts.items()
        for line, text in in_file
        if text.startswith(REFERRING)
    ]
    assert named == []


def test_docstrings_of_all_kinds_are_seen() -> None:
    source = (
        '"""A"""\nx = 1\n"""B"""\nclass C:\n    """C"""\n    y: int\n    """D"""\n    def f(self):\n        """E"""\n'
    )
    assert {text for _, text in docstrings(source)} == set("ABCDE")
