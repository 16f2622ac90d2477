"""The conditions of a frame on the ansatz are the printed ones, and what they remove."""

from __future__ import annotations

import pages
import pytest
import sympy as sp
from formula_number import number

import beams
import derive
from derive.report.document.formula import Fenced, FormulaRow, Name, NumberToken, OperatorToken
from derive.report.document.page import EquationBlock, Paragraph
from derive.report.sections.frame import frame_blocks, on_ansatz, removed
from paper.printed import CONDITION_28, CONDITION_29, CONDITION_35, CONDITION_37

PRIME, ONE = OperatorToken("\N{PRIME}"), NumberToken("1")
A = sp.symbols("a0 a1 a2 a3")
PRINTED = {"mean": (CONDITION_35, CONDITION_37), "point": (CONDITION_28, CONDITION_29)}
NUMBERS = {"mean": ["17), (34", "35", "19), (36", "37"], "point": ["16), (28", "28", "29", "29"]}


@pytest.mark.parametrize("frame", PRINTED)
def test_conditions_are_the_printed_ones(frame: str) -> None:
    found = [sum(f * a for f, a in zip(one.factors, A, strict=True)) for one in on_ansatz(beams.beam(frame))]
    assert found == list(PRINTED[frame])
    lines = pages.equations(pages.section(frame, "frame"))[1:5]
    assert [line.number for line in lines] == NUMBERS[frame]
    for line, condition in zip(lines[1::2], PRINTED[frame], strict=True):
        values = {Name("a", below=(str(j),)): 0.3 * j + 1.1 for j in range(4)}
        expected = condition.subs({a: 0.3 * j + 1.1 for j, a in enumerate(A)})
        assert number(line.left, values) == pytest.approx(float(expected))


@pytest.mark.parametrize(("frame", "turned"), [("mean", (0, 1)), ("point", (2, 3)), ("chord", (0, 1))])
def test_what_is_removed_comes_first_in_the_ansatz(frame: str, turned: tuple[int, ...]) -> None:
    """With xi^2 and xi^3 in front these are removed, but where the conditions hold for them anyway."""
    assert removed(beams.beam(frame)) == (0, 1)
    assert removed(beams.beam(frame, ansatz=["xi^2", "xi^3", "1", "xi"])) == turned


def test_pinned_ends_are_named_and_remove_two_terms_more() -> None:
    spec = beams.beam("mean", 3, ends="pinned")
    assert removed(spec) == (0, 1, 2, 3)
    _, explained, _, _, lines, *_ = frame_blocks(spec)
    assert isinstance(explained, Paragraph) and "Its ends are pinned" in "".join(map(str, explained.text))
    assert isinstance(lines, EquationBlock)
    conditions = [(line.number, line.left) for line in lines.rows[::2]]
    assert [number for number, _ in conditions] == ["17), (34", "19), (36", "", ""]
    assert conditions[2][1] == FormulaRow((Name("v"), PRIME, PRIME, Fenced(FormulaRow((OperatorToken("-"), ONE)))))


def test_without_conditions_nothing_is_removed() -> None:
    spec = derive.planar_beam("given", frame="given", ansatz=["xi^2", "xi^3"])
    assert on_ansatz(spec) == () and removed(spec) == ()
