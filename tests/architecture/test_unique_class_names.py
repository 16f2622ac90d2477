"""One word has one meaning: no two public classes of the package share a name."""

import ast
from collections import defaultdict
from pathlib import Path

PACKAGE = Path(__file__).parents[2] / "derive"
"""The source of the package."""


def test_no_two_public_classes_share_a_name() -> None:
    definitions = defaultdict(list)
    for path in sorted(PACKAGE.rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                definitions[node.name].append(f"{path.relative_to(PACKAGE.parent).as_posix()}:{node.lineno}")
    assert len(definitions) > 100
    assert {name: lines for name, lines in definitions.items() if len(lines) > 1} == {}
