"""The audit of the paper against the tests: nothing is called equal that no test compares.

A test says by its marks which equations it compares and which statements it proves. Rows and marks are held against
each other in both directions, and a test with the mark of an equation has to reach the transcription of that equation.
"""

from __future__ import annotations

import ast
import json
import subprocess
import sys
from collections.abc import Iterable, Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path

from derive.report.paper_audit import ASSUMPTIONS, SECTIONS, STATEMENTS
from derive.report.paper_audit.model import AuditRow, Verdict
from derive.spec.tables.specification import json_schema

ROOT = Path(__file__).parent.parent.parent
FOLDER = ROOT / "tests" / "paper"
ROWS = tuple(row for section in SECTIONS for row in section.rows)
APPENDIX = ("c1", "c2", "C3", "C4", "C5", "c6", "c7", "c8", "J", "d1", "D2", "d3")

COLLECT = """
import json, sys
import pytest

class Marks:
    def pytest_collection_modifyitems(self, items):
        for item in items:
            name = item.nodeid.split("[")[0].removeprefix("tests/paper/")
            for mark in item.iter_markers():
                if mark.name in ("equation", "statement"):
                    found.setdefault(name, {}).setdefault(mark.name, []).extend(mark.args)
            found.setdefault(name, {})

found = {}
failed = pytest.main(["--collect-only", "-qq", "--no-header", "tests/paper"], plugins=[Marks()])
print("\\n" + json.dumps([int(failed), found]))
"""

COMPARED: tuple[Verdict, ...] = ("equal", "equal after the correction")
"""Verdicts that a test has to have compared."""

Marks = Mapping[str, Mapping[str, list[str]]]
"""For each test its marks: equation and statement, each with what it names."""


@cache
def collected() -> Marks:
    """All tests of the paper, as pytest collects them."""
    done = subprocess.run([sys.executable, "-c", COLLECT], cwd=ROOT, capture_output=True, text=True, check=False)
    failed, found = json.loads(done.stdout.strip().splitlines()[-1])
    assert failed == 0, done.stdout + done.stderr
    return found


def faults(rows: Iterable[AuditRow], marks: Marks) -> set[str]:
    """What rows claim that tests do not bear out, and what tests compare that no row names."""
    found = set()
    rows = tuple(rows)
    for row in rows:
        found |= {f"{row.number}: no test {test}" for test in row.tests if test not in marks}
        proofs = {test for test in row.tests if row.number in marks.get(test, {}).get("equation", [])}
        found |= {f"{row.number}: {test} does not compare it" for test in set(row.tests) - proofs}
        found |= {f"{row.number}: {row.verdict}, without a test"} if row.verdict in COMPARED and not proofs else set()
    named = {(test, row.number) for row in rows for test in row.tests}
    compared = {(test, number) for test, of in marks.items() for number in of.get("equation", [])}
    return found | {f"{number}: {test} compares it and is not named" for test, number in compared - named}


def test_verdicts_are_borne_out_by_tests() -> None:
    assert faults(ROWS, collected()) == set()


def test_a_verdict_without_a_test_is_noticed() -> None:
    """The audit broken by hand, in each way."""
    marks = collected()
    row = next(row for row in ROWS if row.number == "9")
    others = tuple(other for other in ROWS if other is not row)
    (test,) = row.tests

    def broken(changed: AuditRow) -> set[str]:
        return faults((*others, changed), marks)

    unnamed = f"9: {test} compares it and is not named"
    assert broken(replace(row, tests=())) == {"9: equal, without a test", unnamed}
    elsewhere = next(other.tests[0] for other in others if other.number == "34")
    assert broken(replace(row, tests=(elsewhere,))) == {
        "9: equal, without a test",
        f"9: {elsewhere} does not compare it",
        unnamed,
    }
    assert f"9: no test {test}s" in broken(replace(row, tests=(f"{test}s",)))
    marked = {name: {"equation": []} if name == test else of for name, of in marks.items()}
    assert faults(ROWS, marked) == {"9: equal, without a test", f"9: {test} does not compare it"}


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


# A test with the mark of an equation reaches its transcription.


def definitions(path: Path) -> dict[str, set[str]]:
    """For each name of a module the names that stand in its definition."""
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


def test_marked_tests_reach_the_transcription_of_their_equation() -> None:
    for test, marks in collected().items():
        numbers = {name.rsplit("_", 1)[-1] for name in reached(test)}
        assert set(marks.get("equation", [])) <= numbers, test


def test_a_transcription_that_is_not_reached_is_noticed() -> None:
    module = "test_printed_against_brute_force.py"
    numbers = {name.rsplit("_", 1)[-1] for name in reached(f"{module}::test_31_and_32_are_what_28_and_29_leave")}
    assert {"28", "29", "31", "32"} <= numbers and not numbers & {"33", "35", "39", "41"}
    assert reached(f"{module}::test_brute_force_refuses_what_is_no_polynomial") == {"xi"}


# Statements and assumptions.


def test_statements_and_their_tests_name_each_other() -> None:
    named = {(test, statement.place) for statement in STATEMENTS for test in statement.tests}
    marked = {(test, key) for test, marks in collected().items() for key in marks.get("statement", [])}
    assert named == marked
    for statement in STATEMENTS:
        assert bool(statement.tests) == (statement.verdict != "not compared"), statement.place


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
