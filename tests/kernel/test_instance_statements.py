"""Statements over instances: what they mean in the interpreter and in C, what they read, and what they cost."""

from __future__ import annotations

from fractions import Fraction

import pytest

from derive.backends.python.module import python_function
from derive.ir.analysis import operations, reads
from derive.ir.expansion import expand
from derive.ir.expressions import Element, Expr, Number, Operation, Operator
from derive.ir.indices import ElementIndex, IndexTerm, constant, variable
from derive.ir.interpreter import RequirementError, interpret
from derive.ir.kernel import Argument, ConstantArray, Kernel, Output, Section, View
from derive.ir.loop_nests import Assign, For, Integer, Local
from derive.ir.statements import (
    Clear,
    Entry,
    ForEach,
    Let,
    Require,
    Requirement,
    ReturnCode,
    Statement,
    StoreElement,
    Work,
    inside,
)

TWO = Number(Fraction(2))
STARTS = ConstantArray("starts", (0, 2, 2, 5), integers=True)
"""The first of the elements of each of three instances, and the end: the second one has none."""
OWN = ConstantArray("own", (4, 0, 3, 1, 2), integers=True)
WEIGHTS = ConstantArray("weights", (Fraction(1, 2), Fraction(3), Fraction(5)), integers=False)
X = [1.0, 10.0, 100.0, 1000.0, 10000.0]


def kernel(*body: Statement, size: int = 3) -> Kernel:
    inputs = (Argument("x_", (), "", arrays=(View("x", 0, len(X)),)),)
    section = Section("", "", "", (Clear("y", size), *body))
    constants = STARTS, OWN, WEIGHTS
    return Kernel("test", "", inputs, (Output("y", (), "", None, size),), (section,), constants)


def value(made: Kernel) -> list[float]:
    """The output; elements to which nothing is written are zero."""
    return interpret(made, {"x_": X})["y"]


def element(array: str, name: str, offset: int = 0) -> Element:
    return Element(array, variable(name, 1, offset))


def stored(target: Element, expr: Expr, operator: Operator | None = None) -> StoreElement:
    return StoreElement(target, expr, operator)


GATHERED = ForEach(
    "i",
    constant(0),
    constant(3),
    (
        Entry("first", "starts", variable("i")),
        Entry("last", "starts", variable("i", 1, 1)),
        ForEach(
            "n",
            variable("first"),
            variable("last"),
            (
                Entry("at", "own", variable("n")),
                stored(
                    element("y", "i"),
                    Operation(Operator.MUL, (element("weights", "i"), element("x", "at"))),
                    Operator.ADD,
                ),
            ),
        ),
    ),
)
"""Each instance sums its own elements, which constant arrays list, times its weight."""


def test_bounds_and_indices_from_constant_arrays() -> None:
    assert value(kernel(GATHERED)) == [0.5 * (X[4] + X[0]), 0.0, 5 * (X[3] + X[1] + X[2])]


def test_operations_count_the_iterations_that_constant_arrays_give() -> None:
    """A product and a sum for each of the five elements."""
    constants = {a.name: list(map(int, a.values)) for a in (STARTS, OWN)}
    assert operations(GATHERED, constants) == kernel(GATHERED).operations == 2 * 5
    assert set(reads(GATHERED)) == {"starts", "own", "weights", "x", "y"}


@pytest.mark.parametrize("backward", [False, True])
def test_loops_run_in_order_or_from_the_end(backward: bool) -> None:
    """y_i = 2 y_(i -+ 1) + x_i: a recurrence sees what the iteration before has written."""
    neighbour = 1 if backward else -1
    before = Operation(Operator.MUL, (TWO, element("work", "i", 1 + neighbour)))
    body = (
        stored(element("work", "i", 1), Operation(Operator.ADD, (before, element("x", "i")))),
        stored(element("y", "i"), element("work", "i", 1)),
    )
    loop = ForEach("i", constant(1), constant(4), body, backward)
    expected, last = [0.0] * 5, 0.0
    for i in (3, 2, 1) if backward else (1, 2, 3):
        expected[i] = last = 2 * last + X[i]
    assert value(kernel(Work("work", 6, cleared=True), loop, size=5)) == expected
    assert operations(loop) == 3 * 2
    (nest,) = expand(loop)
    assert isinstance(nest, For)
    assert (nest.start.offset, nest.stop.offset, nest.step) == ((3, 0, -1) if backward else (1, 4, 1))


@pytest.mark.parametrize("backward", [False, True])
def test_a_loop_without_iterations(backward: bool) -> None:
    loop = ForEach("i", constant(2), constant(2), (stored(element("y", "i"), TWO),), backward)
    assert value(kernel(loop)) == [0.0] * 3
    assert operations(ForEach("i", constant(2), constant(2), GATHERED.body, backward)) == 0


def test_a_work_array_begins_with_zeros_only_if_cleared() -> None:
    added = stored(Element("work", constant(1)), TWO, Operator.ADD)
    result = stored(Element("y", constant(0)), Element("work", constant(1)))
    assert value(kernel(Work("work", 2, cleared=True), added, result)) == [2.0, 0.0, 0.0]
    with pytest.raises(TypeError):  # what nothing has written is no number
        value(kernel(Work("work", 2), added, result))


def test_stores_change_elements_by_their_operator() -> None:
    y = Element("y", constant(1))
    assert value(kernel(stored(y, X_0), stored(y, TWO, Operator.SUB), stored(y, X_0, Operator.ADD))) == [0.0, 0.0, 0.0]
    assert operations(stored(y, TWO)) == 0 and operations(stored(y, TWO, Operator.SUB)) == 1


X_0 = Element("x", constant(0))


def test_an_index_counts_from_several_variables() -> None:
    """Blocks that are turned have their strides from constant arrays."""
    index = ElementIndex(1, (IndexTerm(2, "at"), IndexTerm(-1, "i")))
    body = (Entry("at", "own", variable("i")), stored(element("y", "i"), Element("x", index)))
    assert value(kernel(ForEach("i", constant(3), constant(5), body), size=5)) == [0.0, 0.0, 0.0, X[0], X[1]]


def test_a_requirement_in_a_loop() -> None:
    positive = Require(
        Requirement.POSITIVE, Operation(Operator.SUB, (Number(Fraction(500)), element("x", "i"))), ReturnCode.PIVOT, ""
    )
    loop = ForEach("i", constant(0), constant(3), (positive, stored(element("y", "i"), TWO)))
    assert value(kernel(loop)) == [2.0] * 3
    with pytest.raises(RequirementError):
        value(kernel(ForEach("i", constant(0), constant(4), loop.body), size=4))


def test_plain_statements_of_each() -> None:
    work, entry, store = (
        Work("w", 4, cleared=True),
        Entry("at", "own", variable("i")),
        stored(Element("w", constant(2)), TWO),
    )
    assert expand(work) == (Local("w", 4, cleared=True),)
    assert expand(entry) == (Integer("at", "own", variable("i")),)
    assert expand(store) == (Assign(Element("w", constant(2)), TWO, None),)
    assert [type(item) for item in inside(GATHERED)] == [Entry, Entry, ForEach, Entry, StoreElement]


def test_the_kernel_of_a_loop_in_python() -> None:
    """Bounds of loops that run backward, in the text of Python."""
    loop = ForEach("i", constant(0), constant(3), (Let("a", element("x", "i")),), backward=True)
    text = [line.text for line in python_function(kernel(loop), True, False)]
    assert "    for i in range(2, -1, -1):" in text
