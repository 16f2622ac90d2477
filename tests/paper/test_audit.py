"""The audit of the paper against the tests: nothing is called equal that no test compares.

A row of the audit names the tests that compare its equation, a statement those that prove it. They have to exist, and
those of a row have to reach the transcription of its equation.
"""

from __future__ import annotations

import ast
import json
from collections.abc import Iterable
from dataclasses import replace
from functools import cache
from pathlib import Path

from derive.report.paper_audit import ASSUMPTIONS, SECTIONS, STATEMENTS
from derive.report.paper_audit.model import AuditRow, Verdict
from derive.spec.tables.json_schema import json_schema

ROOT = Path(__file__).parent.parent.parent
FOLDER = ROOT / "tests" / "paper"
ROWS = tuple(row for section in SECTIONS for row in section.rows)
APPENDIX = ("c1", "c2", "C3", "C4", "C5", "c6", "c7", "c8", "J", "d1", "D2", "d3")

COMPARED: tuple[Verdict, ...] = ("equal", "equal after the correction")
"""Verdicts that a test has to have compared."""


def faults(rows: Iterable[AuditRow]) -> set[str]:
    """Faults of what rows claim about tests."""
    found = set()
    for row in rows:
        missing = {test for test in row.tests if not exists(test)}
        beside = {test for test in {*row.tests} - missing if not compares(test, row)}
        found |= {f"{row.number}: no test {test}" for test in missing}
        found |= {f"{row.number}: {test} does not reach it" for test in beside}
        if row.verdict in COMPARED and not row.tests:
            found.add(f"{row.number}: {row.verdict}, without a test")
    return found


def exists(test: str) -> bool:
    file, name = test.split("::")
    return name.startswith("test_") and (FOLDER / file).exists() and name in definitions(FOLDER / file)


def compares(test: str, row: AuditRow) -> bool:
    return row.number in {name.rsplit("_", 1)[-1] for name in reached(test)}


def test_verdicts_are_borne_out_by_tests() -> None:
    assert faults(ROWS) == set()


def test_a_verdict_without_a_test_is_noticed() -> None:
    """The audit broken by hand, in each way."""
    row = next(row for row in ROWS if row.number == "9")
    elsewhere = next(other.tests[0] for other in ROWS if other.number == "34")
    (test,) = row.tests
    assert faults([replace(row, tests=())]) == {"9: equal, without a test"}
    assert faults([replace(row, tests=(elsewhere,))]) == {f"9: {elsewhere} does not reach it"}
    assert faults([replace(row, tests=(f"{test}s",))]) == {f"9: no test {test}s"}


def test_every_equation_and_every_line_of_the_appendix_has_one_row() -> None:
    assert [row.number for row in ROWS] == [*map(str, range(1, 42)), *APPENDIX]


def test_corrections_are_told_where_there_are_some() -> None:
    for row in ROWS:
        assert bool(row.correction) == bool(row.misread), row.number
        assert (row.derived is None) == bool(row.stated) and row.tests, row.number


def test_definitions_and_assumptions_say_where_they_are_made() -> None:
    for row in ROWS:
        assert bool(row.where) == (row.verdict not in COMPARED), row.number
        for where in row.where:
            file, name = where.split("::")
            tree = ast.parse((ROOT / file).read_text())
            assert name in {n for node in ast.walk(tree) for n in _names_made(node)}, where


def _names_made(node: ast.AST) -> list[str]:
    if isinstance(node, ast.FunctionDef | ast.ClassDef):
        return [node.name]
    targets = [node.target] if isinstance(node, ast.AnnAssign) else node.targets if isinstance(node, ast.Assign) else []
    return [target.id for target in targets if isinstance(target, ast.Name)]


# A test reaches the transcription of an equation.


@cache
def definitions(path: Path) -> dict[str, set[str]]:
    """The names in the definition of each name of a module."""
    found: dict[str, set[str]] = {}
    for node in ast.parse(path.read_text()).body:
        used = {n.id for n in ast.walk(node) if isinstance(n, ast.Name)}
        used |= {n.attr for n in ast.walk(node) if isinstance(n, ast.Attribute)}
        for name in _names_made(node):
            found.setdefault(name, set()).update(used)
    return found


@cache
def transcriptions() -> dict[str, set[str]]:
    return {name: used for path in FOLDER.glob("printed*.py") for name, used in definitions(path).items()}


def reached(test: str) -> set[str]:
    """The transcriptions that a test uses, by itself or through what it calls in its module."""
    path, name = test.split("::")
    known = transcriptions() | definitions(FOLDER / path)
    found, open_names = set[str](), [name]
    while open_names:
        for used in known.get(open_names.pop(), set()) - found:
            found.add(used)
            open_names.append(used)
    return found & set(transcriptions())


def test_a_transcription_that_is_not_reached_is_noticed() -> None:
    module = "test_printed_against_brute_force.py"
    test = f"{module}::test_31_and_32_are_what_28_and_29_leave"
    assert (
        {"28", "29", "31", "32"}
        <= {row.number for row in ROWS if compares(test, row)}
        <= {"21", "28", "29", "31", "32"}
    )
    assert reached(f"{module}::test_brute_force_refuses_what_is_no_polynomial") == {"xi"}


# Statements and assumptions.


def test_statements_name_tests_that_exist() -> None:
    for statement in STATEMENTS:
        assert bool(statement.tests) == (statement.verdict != "not compared"), statement.place
        assert all(map(exists, statement.tests)), statement.place


@cache
def schema() -> dict:
    return json.loads(json_schema())


def test_options_are_keys_of_a_specification() -> None:
    for assumption in ASSUMPTIONS:
        for option in assumption.options:
            assert any(_known(option.split("."), schema())), option
        assert bool(assumption.options) == bool(assumption.lifts), assumption.name
    assert not any(_known(["beam", "foreshortening"], schema()))


def _known(path: list[str], node: object) -> Iterable[bool]:
    """Whether a key leads somewhere in the schema: by any of its alternatives."""
    if not isinstance(node, dict):
        return
    if "$ref" in node:
        yield from _known(path, schema()["$defs"][node["$ref"].rsplit("/", 1)[-1]])
    for word in ("anyOf", "oneOf", "allOf"):
        for alternative in node.get(word, ()):
            yield from _known(path, alternative)
    if not path:
        yield True
        return
    first, *rest = path
    if first in node.get("properties", {}):
        yield from _known(rest, node["properties"][first])
    if first == "*":
        for named in node.get("patternProperties", {}).values():
            yield from _known(rest, named)


def test_the_assumptions_of_the_paper_are_listed() -> None:
    names = " ".join(assumption.name.lower() for assumption in ASSUMPTIONS)
    words = "body force, load on the surface, no stress, isotropic linear elastic, linear in the amplitudes"
    words += ", rigid body motion, centre of mass, inextensible, rotary inertia, uniform cross-section, bernoulli"
    assert [word for word in words.split(", ") if word not in names] == []
