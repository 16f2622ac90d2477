"""Loops that continue each other are one loop: the same bits, and only where elements follow each other."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from own_kernels import own_kernel

import derive
from derive.ir.batches import batch
from derive.ir.continuation import continued_loops, continued_statements
from derive.ir.expansion import expand
from derive.ir.expressions import Element, Number, Operation, Operator, ScalarRef, walk
from derive.ir.indices import ElementIndex, constant, variable
from derive.ir.interpreter import interpret
from derive.ir.kernel import Kernel
from derive.ir.loop_nests import Assign, For, Local, Node, every, expressions_of
from derive.ir.statements import ForEach, Let, Statement, StoreElement
from derive.ir.written_out_rows import with_rows_written_out
from derive.lowering.instances.loop_code.class_code import INSTANCE
from derive.lowering.instances.lower import lower_instances
from derive.mechanics.multibody.space.mechanism import SpatialMechanism
from derive.spec.toml.read import parse
from kernel.test_instance_lanes import looped
from some_functions import only

SIZE = 24


def body(name: str, read: ElementIndex, write: ElementIndex, factor: int = 2, adds: bool = True) -> tuple[Any, ...]:
    product = Operation(Operator.MUL, (Number(Fraction(factor)), ScalarRef(name)))
    return Let(name, Element("x", read)), StoreElement(Element("y", write), product, Operator.ADD if adds else None)


def loop(count: int, of: tuple[Any, ...], independent: bool = False, start: int = 0) -> ForEach:
    return ForEach("n", constant(start), constant(start + count), of, independent=independent)


def values(statements: tuple[Statement, ...]) -> Any:
    given = {"x": np.random.default_rng(0).uniform(-1, 1, SIZE).tolist()}
    cleared = ForEach(
        "i", constant(0), constant(SIZE), (StoreElement(Element("y", variable("i")), Number(Fraction(0))),)
    )
    return interpret(own_kernel(SIZE, SIZE, (cleared, *statements)), given)["y"]


FIRST = loop(1, body("a", constant(2), constant(9)))
SECOND = loop(4, body("b", variable("n", 3, 5), variable("n", -1, 8)))
THIRD = loop(1, body("c", constant(17), constant(4)))


def test_a_loop_and_its_continuations_are_one() -> None:
    """The elements 2, 5, 8, ..., 17 of x, and 9, 8, ..., 4 of y: they begin with a loop of a single iteration."""
    statements = FIRST, SECOND, THIRD
    (joined,) = continued_statements(statements)
    assert isinstance(joined, ForEach)
    assert (joined.start, joined.stop) == (constant(0), constant(6))
    assert joined.body == body("a", variable("n", 3, 2), variable("n", -1, 9))
    assert values((joined,)) == values(statements)


@pytest.mark.parametrize("backward", [False, True])
def test_plain_loops_and_their_continuations_are_one(backward: bool) -> None:
    """The same loops as plain statements, up, or from the last one down to the first."""
    statements = [replace(each, backward=backward) for each in (FIRST, SECOND, THIRD)]
    nodes = [node for each in (reversed(statements) if backward else statements) for node in expand(each)]
    (joined,) = continued_statements((FIRST, SECOND, THIRD))
    assert isinstance(joined, ForEach)
    (one,) = continued_loops(nodes)
    names = "c" if backward else "a"
    whole = body(names, variable("n", 3, 2), variable("n", -1, 9))
    assert (one,) == expand(replace(joined, body=whole, backward=backward))
    assert len([*continued_loops(nodes[::-1])]) > 1


def test_two_single_iterations_are_a_loop() -> None:
    statements = FIRST, loop(1, body("b", constant(20), constant(1)), start=7)
    (joined,) = continued_statements(statements)
    assert values((joined,)) == values(statements)


@pytest.mark.parametrize(
    "other",
    [
        loop(4, body("b", variable("n", 3, 6), variable("n", -1, 8))),  # an element of x is left out
        loop(4, body("b", variable("n", 3, 5), variable("n", 1, 8))),  # y in the other direction
        loop(4, body("b", variable("n", 3, 5), variable("n", -1, 8), factor=3)),
        loop(4, (*body("b", variable("n", 3, 5), variable("n", -1, 8)), *body("c", constant(0), constant(0)))),
        loop(4, body("b", variable("n", 3, 5), variable("n", -1, 8)), independent=True),
    ],
)
def test_other_loops_stay(other: ForEach) -> None:
    assert tuple(continued_statements((loop(2, body("a", variable("n", 3, -1), variable("n", -1, 10))), other))) == (
        loop(2, body("a", variable("n", 3, -1), variable("n", -1, 10))),
        other,
    )


def test_independent_iterations_write_elements_of_their_own() -> None:
    """Two loops that write to one element each stay two; the same loops are one if they write to others."""

    def both(first: int, second: int) -> tuple[Statement, ...]:
        bodies = (body("a", constant(k), constant(to), adds=False) for k, to in ((0, first), (3, second)))
        return tuple(continued_statements(loop(1, of, independent=True) for of in bodies))

    assert len(both(5, 5)) == 2
    assert len(both(5, 6)) == 1


def test_bodies_of_a_chain_have_one_text_where_joints_do_not_matter() -> None:
    model = looped("chain_10")
    for name in ("mass", "force", "mass_force", "momentum", "poses"):
        loops = [s for s in model.kernel(name).statements if isinstance(s, ForEach)]
        assert [(each.start.offset, each.stop.offset) for each in loops] == [(0, 10)], name
    (copied,) = (s for s in model.kernel("rates").statements if isinstance(s, ForEach))  # of coordinates, not of bodies
    assert (copied.start.offset, copied.stop.offset) == (0, len(model.coordinates)) == (0, 50)


def test_the_last_body_of_a_batch_computes_nothing_for_a_joint_that_it_does_not_have() -> None:
    """In vectors it is one of those between the ends; these are computed in the steps of the elimination."""
    nodes = batch(looped("chain_10").kernel("accel")).nodes
    own = [node for node in nodes if isinstance(node, For) and node.variable == INSTANCE and node.count == 1]
    assert len(own) == 2  # before the elimination, and behind it
    lines = (line for line in every(own[:1]) if isinstance(line, Assign) and isinstance(line.target, Element))
    written = {line.target.array.removesuffix("_in_turn") for line in lines}
    assert {"second_diagonal", "second_right"} <= written
    assert written.isdisjoint({"first_diagonal", "first_right", "coupling"})


WELDED = """name = "welded"
[scene]
gravity = [0, 0, -9.81]
lowering = "instances"
[ground.markers]
o = [0, 0, 0]
"""


def welded(count: int) -> Kernel:
    """The accelerations of a chain of rigid bodies in space, welded to each other, in loops, as batches get them."""
    text = WELDED
    for k in range(count):
        markers = "{ left = [0, 0, 0], right = [0.3, 0.1, 0] }"
        inertia = f"[0.5, 0.6, 0.{k + 3}, 0, 0, 0]"
        text += f"[bodies.b{k}]\nkeep_coordinates = true\nmass = {k + 1}\ncentre = [0.1, 0, 0]\n"
        text += f"inertia = {inertia}\nmarkers = {markers}\n"
        before = f"b{k - 1}.right" if k else "ground.o"
        text += f'[joints.j{k}]\nkind = "fixed"\nbetween = ["{before}", "b{k}.left"]\n'
    made = derive.derive(parse(text))
    assert isinstance(made, SpatialMechanism)
    with only("accel", "mass_force", "solve"):
        return with_rows_written_out(lower_instances(made, explicit=True)).kernel("accel")


def places(nodes: Iterable[Node], variables: dict[str, int]) -> Iterator[tuple[str, int]]:
    """The arrays and the places of all elements that plain statements read and write, in each iteration."""
    for node in nodes:
        if isinstance(node, For):
            for value in node.values(variables):
                yield from places(node.body, {**variables, node.variable: value})
            continue
        parts = [part for expr in expressions_of(node) for part in walk(expr)]
        parts += [node.target] if isinstance(node, Assign) else []
        for part in parts:
            if isinstance(part, Element) and part.index:
                yield part.array, part.index.at(variables)


@pytest.mark.parametrize("count", [4, 5, 6])
def test_elements_of_both_ends_lie_in_their_arrays(count: int) -> None:
    """Of four and five bodies each end has one step: those of both ends are one loop, whose blocks are transposed."""
    nodes = batch(welded(count)).nodes
    sizes = {node.array: node.size for node in every(nodes) if isinstance(node, Local)}
    known = [(array, place) for array, place in places(nodes, {"count": 1}) if array in sizes]
    assert {"coupling", "kept_joints"} <= {array for array, _ in known}
    assert [(array, place) for array, place in known if not 0 <= place < sizes[array]] == []


def test_the_joint_that_is_left_is_one_more_step_of_a_batch() -> None:
    """Nine joints are four from both ends and one; ten have one more on the side of the first end.

    There is a loop from each end, one step in the middle, and a loop to each end: every step but this computes a body.
    """
    steps = {}
    for count in (9, 10):
        nodes = batch(looped(f"chain_{count}").kernel("accel")).nodes
        steps[count] = [node.count for node in nodes if isinstance(node, For) and node.variable == "step"]
    assert steps == {9: [4, 4, 1, 4, 4], 10: [4, 5, 1, 5, 4]}
