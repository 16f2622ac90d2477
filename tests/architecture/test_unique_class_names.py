"""One word has one meaning: no two public classes of the package share a name."""

import ast
from collections import defaultdict
from pathlib import Path

PACKAGE = Path(__file__).parents[2] / "derive"
"""The source of the package."""

DOCUMENT_MODEL = {
    "Equations": "derive/report/document/page.py",
    "Matrix": "derive/report/document/formula.py",
    "Number": "derive/report/document/formula.py",
    "Operator": "derive/report/document/formula.py",
    "Section": "derive/report/paper/model.py",
}
"""Names that the document model of the reports shares with another class, and the file in `derive/report`."""


def public_classes() -> dict[str, set[str]]:
    """The files that define each public class, by the name of the class."""
    files = defaultdict(set)
    for path in sorted(PACKAGE.rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                files[node.name].add(path.relative_to(PACKAGE.parent).as_posix())
    return files


def test_no_two_public_classes_share_a_name() -> None:
    shared = {name: files for name, files in public_classes().items() if len(files) > 1}
    assert shared.keys() - DOCUMENT_MODEL.keys() == set(), shared


def test_each_exemption_is_needed_and_names_a_file_of_the_report() -> None:
    files = public_classes()
    assert all(len(files[name]) > 1 and file in files[name] for name, file in DOCUMENT_MODEL.items())
