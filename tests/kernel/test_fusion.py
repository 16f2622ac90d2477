"""Independent loops in one with ordered loops: every value and every bit stays, and what moves is what should."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from own_kernels import own_kernel

from derive.ir.analysis import codes_in_order
from derive.ir.batches import batch
from derive.ir.expansion import expand
from derive.ir.expressions import Element, Expr, Number, Operation, Operator, ScalarRef
from derive.ir.fusion import fused
from derive.ir.indices import ElementIndex, constant, variable
from derive.ir.interpreter import interpret
from derive.ir.loop_nests import Assign, For, Node, Sines, every
from derive.ir.statements import ForEach, Let, Require, Requirement, ReturnCode, Statement, StoreElement, Work
from kernel.test_instance_lanes import looped

COUNT, ROOM = 7, 30
"""The iterations of the loops, and the elements of the arrays that they touch anywhere."""


def added(a: Expr, b: Expr) -> Expr:
    return Operation(Operator.ADD, (a, b))


def halved(a: Expr) -> Expr:
    return Operation(Operator.MUL, (Number(Fraction(1, 2)), a))


def place(rng: np.random.Generator, name: str, strides: Sequence[int] = (1, -1)) -> ElementIndex:
    """A random index that stays within the arrays."""
    stride = int(rng.choice(strides))
    first = int(rng.integers(2, 6)) if stride > 0 else ROOM - 1 - int(rng.integers(2, 6))
    return variable(name, stride, first if rng.random() < 0.6 else 14 if stride > 0 else 14 + COUNT)


def random_statements(seed: int) -> tuple[Statement, ...]:
    """Instances before a recurrence and after it, with indices that meet in any way, and names that clash."""
    rng = np.random.default_rng(seed)
    n, s = "n", "s"
    to, of, more = place(rng, n, (1, -1, 2)), place(rng, s), place(rng, s, (1, -1, 2))
    give = Element("x", variable(n, 1, 1))
    before = (
        Let("t", added(give, Element("x", variable(n)))),
        Require(Requirement.POSITIVE, added(ScalarRef("t"), Number(Fraction(9))), ReturnCode.PIVOT, ""),
        StoreElement(Element("a", to), halved(ScalarRef("t"))),
        StoreElement(Element("b", variable(n, 1, 3)), ScalarRef("t")),
    )
    step = (
        Let("t", Element("a", of)),
        Let("last", Element("r", constant(0))),
        StoreElement(Element("r", constant(0)), halved(added(ScalarRef("t"), ScalarRef("last")))),
        StoreElement(Element("a", of if rng.random() < 0.7 else more), added(ScalarRef("last"), ScalarRef("t"))),
        StoreElement(Element("d", of), added(ScalarRef("last"), Element("b", more))),
    )
    after = (
        Let("t", added(Element("d", place(rng, n)), Element("b", variable(n, 1, 3)))),
        StoreElement(Element("y", variable(n)), added(ScalarRef("t"), Element("a", place(rng, n)))),
    )

    def loop(name: str, body: tuple[Any, ...], backward: bool = False, independent: bool = False) -> ForEach:
        return ForEach(name, constant(0), constant(COUNT), body, backward, independent)

    names = ("a", "b", "d", "r")
    filled = ForEach(
        "i",
        constant(0),
        constant(ROOM),
        tuple(StoreElement(Element(name, variable("i")), Element("x", variable("i"))) for name in names),
    )
    works = [Work(name, ROOM) for name in names]
    loops = loop(n, before, independent=True), loop(s, step, rng.random() < 0.5), loop(n, after, independent=True)
    return (*works, filled, *loops)


def plain(statements: tuple[Statement, ...]) -> tuple[Node, ...]:
    return tuple(node for statement in statements for node in expand(statement))


def loops_of_several(nodes: tuple[Node, ...]) -> list[For]:
    return [node for node in nodes if isinstance(node, For) and (node.count or 0) > 1 and node.variable != "i"]


def test_random_loops_keep_the_bits() -> None:
    """Whatever the indices are, in the same direction or not, the values are those of the loops one by one."""
    given = {"x": np.random.default_rng(0).uniform(-1, 1, ROOM).tolist()}
    moved = 0
    for seed in range(300):
        statements = random_statements(seed)
        kernel, nodes = own_kernel(ROOM, COUNT, statements), plain(statements)
        together = fused(nodes)
        assert interpret(kernel, given, nodes=together) == interpret(kernel, given, nodes=nodes), seed
        moved += together != nodes
    assert 100 < moved < 300


MOVING = 30
"""A seed whose loops are all in one with the recurrence."""


def finite(place: ElementIndex) -> Require:
    return Require(Requirement.FINITE, Element("x", place), ReturnCode.NOT_FINITE, "")


def test_the_first_of_several_codes_stays_the_first() -> None:
    """A check of results is behind all pivots: what has it does not move into the loop that computes these."""
    (*others, last) = random_statements(MOVING)
    assert isinstance(last, ForEach)
    assert len(loops_of_several(fused(plain((*others, last))))) == 1
    checked = plain((*others, replace(last, body=(*last.body, finite(variable("n"))))))
    together = fused(checked)
    assert [[*codes_in_order([loop])] for loop in loops_of_several(together)] == [
        [ReturnCode.PIVOT],
        [ReturnCode.NOT_FINITE],
    ]
    mixed = (*plain((finite(constant(0)),)), *checked)
    assert not codes_in_order(mixed)
    assert fused(mixed) == mixed


def test_instances_stay_behind_the_numbers_that_they_read() -> None:
    """A loop does not move up before the line that names what it reads."""
    (*others, last) = random_statements(MOVING)
    assert isinstance(last, ForEach)
    store = StoreElement(Element("y", variable("n")), ScalarRef("late"))
    named = Let("late", Element("x", constant(2)))
    statements = (*others, named, replace(last, body=(store,)))
    together = fused(plain(statements))
    assert together[-2:] == plain(statements)[-2:]
    given = {"x": [float(k) for k in range(ROOM)]}
    assert interpret(own_kernel(ROOM, COUNT, statements), given, nodes=together)["y"] == [2.0] * COUNT


def touched(node: Node) -> set[str]:
    return {
        item.target.array for item in every([node]) if isinstance(item, Assign) and isinstance(item.target, Element)
    }


def test_bodies_of_a_chain_are_computed_by_the_elimination() -> None:
    """Of a pinned chain, no loop over bodies alone is left, and what the next joint alone reads is not stored."""
    loops = loops_of_several(batch(looped("pinned").kernel("accel")).nodes)
    assert len(loops) == 4
    forward, backward = loops[:2], loops[2:]
    assert all({"update", "coupling"} < touched(loop) for loop in forward)
    assert all({"last_reaction", "vdot"} == touched(loop) for loop in backward)
    assert ["second_diagonal_in_turn" in touched(loop) for loop in forward] == [True, False]
    assert ["first_diagonal_in_turn" in touched(loop) for loop in forward] == [False, True]


@pytest.mark.parametrize("graph", ["chain_10", "tree"])
def test_sines_read_angles_where_they_are(graph: str) -> None:
    """Compilers copy in shorter vectors than they read, so that a copy of an angle would stall the sine."""
    angles = [node.angle for node in every(batch(looped(graph).kernel("accel")).nodes) if isinstance(node, Sines)]
    assert angles
    assert {angle.array for angle in angles} == {"q"}
