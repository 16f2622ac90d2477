"""Loops with one iteration in C: blocks without a variable, unless the variable is in more than indices."""

from dataclasses import replace

from derive.backends.c.nests import CNests
from derive.ir.expressions import Element, Number
from derive.ir.indices import constant, variable
from derive.ir.loop_nests import Assign, For, If


def lines(loop: For) -> list[str]:
    """The C of a loop."""
    return [line.text.strip() for line in CNests({"x"}).lines([loop])]


STORE = Assign(Element("x", variable("i", 3, 1)), Number(1))
LOOP = For("i", constant(2), constant(3), (STORE,))


def test_one_iteration_is_a_block() -> None:
    """Its indices are numbers."""
    assert lines(LOOP) == ["{", "x[7] = 1.0;", "}"]


def test_other_loops_keep_their_variable() -> None:
    """Two iterations, a condition, and a bound need it."""
    several = (
        replace(LOOP, stop=constant(4)),
        replace(LOOP, body=(If("i", 3, (STORE,), ()),)),
        replace(LOOP, body=(For("j", constant(0), variable("i"), (STORE,)),)),
    )
    assert all("i = 2;" in lines(loop)[0] for loop in several)
