"""Lines in another order: each stays behind what it needs, and fewer values wait for their readers."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import numpy as np
from own_kernels import own_kernel

from derive.ir.analysis import names_read
from derive.ir.batches import batch
from derive.ir.expressions import Element, Expr, Number, Operation, Operator, ScalarRef
from derive.ir.indices import ElementIndex, constant, variable
from derive.ir.interpreter import interpret
from derive.ir.loop_nests import Assign, For, LoopKind, Node, every
from derive.ir.ordering import LONG, with_few_waiting
from derive.ir.statements import Let, Require, Requirement, ReturnCode
from kernel.test_instance_lanes import looped

ROOM = 6
"""The elements of the arrays."""
KERNEL = own_kernel(ROOM, ROOM)


def random_lines(seed: int) -> list[Node]:
    """Named values and assignments to elements that others read before and after, also through indices of a loop."""
    rng = np.random.default_rng(seed)
    lines: list[Node] = []
    names: list[str] = []

    def place() -> ElementIndex:
        return variable("i", int(rng.integers(-1, 2)), 2) if rng.random() < 0.3 else constant(int(rng.integers(ROOM)))

    def leaf() -> Expr:
        if names and rng.random() < 0.7:
            return ScalarRef(str(rng.choice(names)))
        return Element(str(rng.choice(["x", "y"])), place())

    for number in range(30):
        expr = Operation(rng.choice(np.array([Operator.ADD, Operator.SUB])), (leaf(), leaf()))
        if rng.random() < 0.6:
            names.append(f"t{number}")
            lines.append(Let(names[-1], expr))
        else:
            lines.append(Assign(Element("y", place()), expr, Operator.ADD if rng.random() < 0.3 else None))
    return lines


def in_loop(lines: Sequence[Node]) -> tuple[Node, ...]:
    start = For("i", constant(0), constant(ROOM), (Assign(Element("y", variable("i")), Number(Fraction(1, 3))),))
    return start, For("i", constant(0), constant(2), tuple(lines))


def test_random_lines_keep_their_values() -> None:
    given = {"x": np.random.default_rng(0).uniform(-1, 1, ROOM).tolist()}
    changed = 0
    for seed in range(200):
        lines = random_lines(seed)
        other = with_few_waiting(lines)
        assert sorted(map(repr, other)) == sorted(map(repr, lines))
        values = [interpret(KERNEL, given, nodes=in_loop(of)) for of in (lines, other)]
        assert values[0] == values[1], seed
        changed += list(other) != lines
    assert changed > 150


def most_waiting(lines: Sequence[Node]) -> int:
    """The largest number of named values that are known and still to be read."""
    last = {name: number for number, line in enumerate(lines) for name in names_read([line])}
    ends = [
        (number, last[line.name]) for number, line in enumerate(lines) if isinstance(line, Let) and line.name in last
    ]
    return max(sum(first <= number < end for first, end in ends) for number in range(len(lines)))


def test_sums_are_computed_one_after_the_other() -> None:
    """Of sums whose terms are all named first, each is completed before the terms of the next."""
    terms = [Let(f"t{k}", Element("x", constant(k % ROOM))) for k in range(40)]
    pairs = [Operation(Operator.ADD, (ScalarRef(f"t{k}"), ScalarRef(f"t{39 - k}"))) for k in range(20)]
    lines = [*terms, *(Assign(Element("y", constant(k % ROOM)), pair, Operator.ADD) for k, pair in enumerate(pairs))]
    assert most_waiting(lines) == 40
    assert most_waiting(with_few_waiting(lines)) == 2


def test_the_first_of_several_codes_stays_first() -> None:
    """Requirements of different codes keep their order, though the later one could be first."""
    values = [Let("a", Element("x", constant(0))), Let("b", Element("x", constant(1)))]
    codes = (ReturnCode.PIVOT, ReturnCode.NOT_FINITE)
    late = Let("c", Operation(Operator.ADD, (ScalarRef("a"), Element("y", constant(0)))))
    checks = [Require(Requirement.POSITIVE, ScalarRef(name), code, "") for name, code in zip("cb", codes, strict=True)]
    stored = Assign(Element("y", constant(0)), Element("x", constant(2)))
    ordered = with_few_waiting([stored, *values, late, *checks])
    assert [line.code for line in ordered if isinstance(line, Require)] == list(codes)
    checks = [Require(Requirement.POSITIVE, ScalarRef(name), codes[0], "") for name in "cb"]
    assert with_few_waiting([stored, *values, late, *checks]).index(checks[1]) < 4


def test_long_straight_lines_are_left_as_they_are() -> None:
    lines = [Let(f"t{k}", Element("x", constant(0))) for k in range(LONG + 1)]
    assert with_few_waiting(lines) == tuple(lines)


def test_bodies_of_a_chain_leave_few_values_waiting() -> None:
    """A body of a chain that is computed in the elimination; 37 were waiting in the order in which it is derived."""
    loops = (node for node in every(batch(looped("chain_10").kernel("accel")).nodes) if isinstance(node, For))
    longest = max((loop.body for loop in loops if loop.kind is LoopKind.STATES), key=len)
    assert most_waiting(longest) <= 29
