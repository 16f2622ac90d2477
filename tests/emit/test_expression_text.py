"""Expressions written as C and Python are the trees they came from: same operations, same order, exact numbers."""

from __future__ import annotations

import math
import random
from dataclasses import replace
from fractions import Fraction

import pytest

from derive.backends.expression_text import PYTHON, C, Dialect, index_text, text
from derive.backends.wrapping import PLUS, WIDTH, join, statement
from derive.ir.expressions import Expr, Number, Operation, Operator, ScalarRef
from derive.ir.indices import ElementIndex, IndexTerm, Of
from derive.ir.interpreter import interpret
from derive.ir.kernel import Argument, Kernel, Output, Section
from derive.ir.statements import Store

VALUES = {"a": 1.7, "b": -0.3, "c": 0.9}
NUMBERS = [Fraction(2), Fraction(-3), Fraction(1, 3), Fraction(-5, 7), Fraction(1, 4), Fraction(2**60 + 1, 3)]


def random_tree(rng: random.Random, depth: int) -> Expr:
    if depth == 0:
        return ScalarRef(rng.choice("abc")) if rng.random() < 0.7 else Number(rng.choice(NUMBERS))
    kind = Operator(rng.choice(["add", "sub", "mul", "div", "add", "sub", "mul", "neg", "sin"]))
    count = 2 if kind.binary else 1
    return Operation(kind, tuple(random_tree(rng, rng.randrange(depth)) for _ in range(count)))


def value_of(expr: Expr) -> float:
    """The value of an expression by the interpreter, in doubles."""
    arguments = (Argument("x", tuple(VALUES), ""),)
    kernel = Kernel("f", "", arguments, (Output("y", ("y",), ""),), (Section("", "", "", (Store("y", 0, expr),)),))
    return float(interpret(kernel, {"x": list(VALUES.values())})["y"][0])


@pytest.mark.parametrize("dialect", [C, replace(PYTHON, namespace="")])
def test_text_keeps_the_order_of_operations(dialect: Dialect) -> None:
    """Python and C read these operators alike; doubles tell (a + b) + c from a + (b + c)."""
    rng = random.Random(1)
    for _ in range(3000):
        tree = random_tree(rng, 5)
        try:
            expected = value_of(tree)
        except ZeroDivisionError:
            continue
        written = text(tree, dialect)
        names = {"sin": math.sin, "tisserand_sin": math.sin, **VALUES}
        assert eval(str(written), names) == expected, written
        lines = statement("    ", "y = (", written, ")")
        assert (
            eval("\n".join(lines).strip().removeprefix("y = "), {"sin": math.sin, "tisserand_sin": math.sin, **VALUES})
            == expected
        )


@pytest.mark.parametrize(
    ("tree", "expected"),
    [
        (
            Operation(Operator.ADD, (ScalarRef("a"), Operation(Operator.ADD, (ScalarRef("b"), ScalarRef("c"))))),
            "a + (b + c)",
        ),
        (
            Operation(Operator.ADD, (Operation(Operator.ADD, (ScalarRef("a"), ScalarRef("b"))), ScalarRef("c"))),
            "a + b + c",
        ),
        (
            Operation(Operator.SUB, (ScalarRef("a"), Operation(Operator.MUL, (ScalarRef("b"), ScalarRef("c"))))),
            "a - b * c",
        ),
        (
            Operation(Operator.MUL, (Operation(Operator.SUB, (ScalarRef("a"), ScalarRef("b"))), ScalarRef("c"))),
            "(a - b) * c",
        ),
        (
            Operation(Operator.DIV, (ScalarRef("a"), Operation(Operator.MUL, (ScalarRef("b"), ScalarRef("c"))))),
            "a / (b * c)",
        ),
        (Operation(Operator.NEG, (Operation(Operator.NEG, (ScalarRef("a"),)),)), "-(-a)"),
        (Operation(Operator.MUL, (Number(Fraction(1, 3)), ScalarRef("a"))), "(1.0 / 3.0) * a"),
        (Operation(Operator.DIV, (ScalarRef("m"), Number(Fraction(7)))), "m / 7.0"),
        (Operation(Operator.SIN, (Operation(Operator.ADD, (ScalarRef("a"), ScalarRef("b"))),)), "tisserand_sin(a + b)"),
    ],
)
def test_no_parentheses_more_than_needed(tree: Expr, expected: str) -> None:
    assert str(text(tree, C)) == expected


@pytest.mark.parametrize(
    ("value", "c", "python"),
    [
        (Fraction(7), "7.0", "7"),
        (Fraction(-7), "-7.0", "-7"),
        (Fraction(1, 4), "0.25", "0.25"),
        (Fraction(1, 3), "(1.0 / 3.0)", "(1 / 3)"),
        (Fraction(2**53 - 1), "9007199254740991.0", "9007199254740991"),
        (Fraction(2**53), "9007199254740992.0", "9007199254740992.0"),
        (Fraction(10**22), "1e+22", "1e+22"),
    ],
)
def test_numbers(value: Fraction, c: str, python: str) -> None:
    assert str(text(Number(value), C)) == c
    assert str(text(Number(value), PYTHON)) == python


def test_numbers_are_the_nearest_doubles() -> None:
    """A quotient of integers below 2^53 is rounded once, and so is what `float` makes of a fraction."""
    rng = random.Random(2)
    for _ in range(2000):
        value = Fraction(rng.randrange(-(10**20), 10**20), rng.randrange(1, 10 ** rng.randrange(1, 20)))
        for dialect in (C, PYTHON):
            assert eval(str(text(Number(value), dialect))) == float(value)


def test_long_statements_break_before_a_sign() -> None:
    terms = join("a_long_name_0 * b", *(part for k in range(1, 12) for part in (PLUS, f"a_long_name_{k} * b")))
    first, *others = statement("    ", "const double x = ", terms, ";")
    assert len(others) > 1
    assert all(len(line) <= WIDTH for line in (first, *others))
    assert all(line.startswith("        + ") for line in others)
    assert " ".join(line.strip() for line in (first, *others)) == f"const double x = {terms};"


@pytest.mark.parametrize("offset_first", [True, False])
def test_text_of_an_index_is_its_number(offset_first: bool) -> None:
    """Whatever the signs of its strides, and however many variables have the same one."""
    rng = random.Random(0)
    values = {"instance": 4, "l": 3, "n": 6}
    for _ in range(300):
        kinds = [Of.VALUE, Of.VALUE, Of.BLOCK, Of.LANE, Of.PAIRS]
        terms = (IndexTerm(rng.choice([-2, -1, 1, 3]), rng.choice([*values]), rng.choice(kinds)) for _ in range(3))
        index = ElementIndex(rng.choice([-5, 0, 7]), tuple(terms)[: rng.randrange(4)])
        written = index_text(index, offset_first)
        assert eval(written.replace("/", "//"), {}, values) == index.at(values), written
