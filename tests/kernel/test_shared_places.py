"""Local arrays of instances: near elements are read in their place, and what is short-lived shares a place."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from own_kernels import own_kernel

from derive.ir.batches import batch
from derive.ir.expressions import Element, Expr, Number, Operation, Operator, ScalarRef
from derive.ir.indices import ElementIndex, constant, variable
from derive.ir.interpreter import interpret
from derive.ir.loop_nests import Assign, For, Local, Node
from derive.ir.nearby_reads import with_nearby_reads
from derive.ir.shared_places import with_shared_places
from derive.ir.statements import Let
from kernel.test_instance_lanes import looped

SPACING, ROOM, STEPS = 9, 3, 4
"""The elements of a component, those of the output and of near arrays, and the iterations of loops."""
KERNEL = own_kernel(SPACING, ROOM)
GIVEN = {"x": np.random.default_rng(0).uniform(-1, 1, SPACING).tolist()}
Change = Callable[[tuple[Node, ...]], tuple[Node, ...]]
ARRAYS = (Local("a", 2 * SPACING, spacing=SPACING), Local("b", SPACING, spacing=SPACING), Local("r", ROOM))


def far(rng: np.random.Generator, first: int, stride: int) -> Element:
    """An element of an instance, the one of the iteration or the next one."""
    array, component = [("a", 0), ("a", 1), ("b", 0)][int(rng.integers(3))]
    start = (first if stride > 0 else SPACING - 1 - first) + stride * int(rng.integers(2))
    return Element(array, variable("i", stride, component * SPACING + start))


def random_loop(rng: np.random.Generator, number: int, stride: int) -> For:
    """A recurrence that hands values on in arrays, near ones and those of the instances."""
    lines: list[Node] = []
    names: list[str] = []
    for line in range(10):
        near = Element(str(rng.choice(["r", "y"])), constant(int(rng.integers(ROOM))))
        place = near if rng.random() < 0.3 else far(rng, 2, stride)
        if rng.random() < 0.5:
            read: Expr = Element("x", variable("i")) if rng.random() < 0.3 else place
            more = ScalarRef(str(rng.choice(names))) if names and rng.random() < 0.5 else None
            names.append(f"t{number}_{line}")
            lines.append(Let(names[-1], Operation(Operator.SUB, (read, more)) if more else read))
        elif names and rng.random() < 0.8:
            value = ScalarRef(str(rng.choice(names)))
            lines += [Assign(element, value) for element in {place, near}]
        else:
            lines.append(Assign(place, Number(rng.integers(5).item()), Operator.ADD if rng.random() < 0.2 else None))
    return For("i", constant(0), constant(STEPS), tuple(lines))


def random_nodes(seed: int) -> tuple[Node, ...]:
    rng = np.random.default_rng(seed)
    start = [Assign(Element("y", constant(k)), Element("x", constant(k))) for k in range(ROOM)]
    start += [Assign(Element("r", constant(k)), Element("x", constant(k + ROOM))) for k in range(ROOM)]
    start += [Assign(Element(name, constant(k)), Element("x", constant(k))) for name in "ab" for k in (2, 3, 6, 5)]
    return (*ARRAYS, *start, *(random_loop(rng, number, int(rng.choice([1, -1]))) for number in range(3)))


@pytest.mark.parametrize(("change", "least"), [(with_nearby_reads, 40), (with_shared_places, 3)])
def test_random_recurrences_keep_the_bits(change: Change, least: int) -> None:
    changed = 0
    for seed in range(700):
        nodes = random_nodes(seed)
        try:
            values = interpret(KERNEL, GIVEN, nodes=nodes)
        except TypeError:  # it reads what nothing has written
            continue
        other = change(nodes)
        assert interpret(KERNEL, GIVEN, nodes=other) == values, seed
        changed += any(isinstance(node, Local) and node.array.endswith("_in_turn") for node in other) or (
            change is with_nearby_reads and reads(other) != reads(nodes)
        )
    assert changed > least


def reads(nodes: tuple[Node, ...]) -> list[Expr]:
    lines = (line for node in nodes if isinstance(node, For) for line in node.body if isinstance(line, Let))
    return sorted((line.expr for line in lines), key=repr)


def handed_on(place: ElementIndex) -> tuple[Node, ...]:
    """Each iteration reads what the one before has written to a component; at last the element at a place is read."""
    body = (
        Let("t", Element("a", variable("i"))),
        Assign(
            Element("a", variable("i", 1, 1)), Operation(Operator.ADD, (ScalarRef("t"), Element("x", variable("i"))))
        ),
    )
    first = Assign(Element("a", constant(0)), Element("x", constant(0)))
    return (
        *ARRAYS,
        first,
        For("i", constant(0), constant(STEPS), body),
        Assign(Element("y", constant(0)), Element("a", place)),
    )


def test_elements_share_a_place_unless_an_earlier_one_is_read_again() -> None:
    shared = with_shared_places(handed_on(constant(STEPS)))
    assert Local("a_in_turn", 1) in shared
    assert interpret(KERNEL, GIVEN, nodes=shared) == interpret(KERNEL, GIVEN, nodes=handed_on(constant(STEPS)))
    nodes = handed_on(constant(STEPS - 1))
    assert with_shared_places(nodes) == nodes


def test_joints_of_a_chain_keep_no_more_than_back_substitution_needs() -> None:
    """Four numbers of Y, two of the right-hand side and a pivot, in arrays that are padded to eight joints."""
    arrays = batch(looped("pinned").kernel("accel")).arrays
    assert [arrays[name] for name in ("coupling", "first_right", "first_diagonal")] == [4 * 8, 2 * 8, 8]
    assert not {"second_diagonal", "second_right", "reaction"} & arrays.keys()
    assert max(size for name, size in arrays.items() if name.endswith("_in_turn")) == 4
