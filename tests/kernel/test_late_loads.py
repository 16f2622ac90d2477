"""Loads move to their first reader, but not past what may change the element; blocks of lanes take no branch."""

from __future__ import annotations

from derive.backends.c.loop_text import last_block, loop_head
from derive.backends.c.nests import CNests
from derive.ir.expressions import Element, Ends, Expr, Operation, Operator, ScalarRef
from derive.ir.indices import constant, variable
from derive.ir.late_loads import with_late_loads
from derive.ir.loop_nests import START, Assign, For, Node
from derive.ir.statements import Let

A, B = ScalarRef("a"), ScalarRef("b")


def at(number: int, array: str = "x") -> Element:
    return Element(array, constant(number))


def total(*of: Expr) -> Expr:
    return Operation(Operator.ADD, of)


def test_a_load_is_before_its_first_reader() -> None:
    a, b = Let("a", at(0)), Let("b", at(1))
    one, two = Let("one", total(B, B)), Let("two", total(A, B))
    assert with_late_loads((a, b, one, two)) == (b, one, a, two)


def test_a_load_stays_before_what_may_write_the_element() -> None:
    a, read = Let("a", at(0)), Assign(at(2, "y"), A)
    other, same = Assign(at(1), ScalarRef("c")), Assign(at(0), ScalarRef("c"))
    assert with_late_loads((a, other, same, read)) == (other, a, same, read)
    inner = For("i", START, constant(2), (Assign(Element("x", variable("i")), B),))
    assert with_late_loads((a, inner, read)) == (a, inner, read)
    ends = Let("a", Ends("x", variable("step"), variable("step", -1, 5), "end"))
    assert with_late_loads((ends, same, read)) == (ends, same, read)


def test_loads_that_nothing_reads_go() -> None:
    body: tuple[Node, ...] = (Let("a", at(0)), Let("b", at(1)), Assign(at(2, "y"), B))
    assert with_late_loads(body) == body[1:]


def test_the_last_block_of_lanes_begins_without_a_branch() -> None:
    """A step that depends on the block is a branch that processors predict wrongly each time."""
    loop = For("instance", START, constant(10), (Assign(Element("y", variable("instance")), A),), step=4, overlaps=True)
    assert last_block(loop) == 6
    assert last_block(For("instance", START, constant(8), (), step=4, overlaps=True)) is None
    assert loop_head(loop, "int", short=False).endswith("instance_block < 10; instance_block += 4) {")
    lines = [line.text.strip() for line in CNests().lines((loop,))]
    assert lines[1] == "const int instance = instance_block < 6 ? instance_block : 6;"
    assert [*loop.values({})] == [0, 4, 6]
