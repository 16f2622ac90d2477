"""Sines of all bodies come before the loops over these, of angles that lie at equal distances; every bit stays."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import pytest

from derive.backends.c.source import CBackend
from derive.ir.expressions import Element, Operation, Operator, ScalarRef, walk
from derive.ir.indices import constant, variable
from derive.ir.interpreter import interpret
from derive.ir.loop_nests import Assign, For, Integer, Local, Node, Sines, every, expressions_of
from derive.ir.sines_of_bodies import MANY, STORES, with_sines_of_bodies
from derive.ir.statements import Let
from derive.lowering.instances.loop_code.class_code import INSTANCE
from kernel.test_instance_lanes import arguments, looped, nodes_in_lanes

SINE, COSINE = Operator.SIN, Operator.COS


def body(number: int, start: int, stop: int, angle: Element, *others: Node) -> For:
    """A loop of a class of bodies, which stores sines times cosines."""
    phi, s, c = (f"{name}_{number}" for name in ("phi", "s", "c"))
    product = Operation(Operator.MUL, (ScalarRef(s), ScalarRef(c)))
    calls = (Let(name, Operation(kind, (ScalarRef(phi),))) for name, kind in ((s, SINE), (c, COSINE)))
    store = Assign(Element("y", variable("n", 1, start)), product)
    return For("n", constant(start), constant(stop), (Let(phi, angle), *others, *calls, store))


def sines_of(nodes: Iterable[Node]) -> list[Sines]:
    return [node for node in every(nodes) if isinstance(node, Sines)]


def has_calls(nodes: Iterable[Node]) -> bool:
    parts = (part for node in every(nodes) for expr in expressions_of(node) for part in walk(expr))
    return any(isinstance(part, Operation) and part.kind in (SINE, COSINE) for part in parts)


def at(first: int, stride: int = 5) -> Element:
    return Element("x", variable("n", stride, first))


def test_bodies_that_follow_each_other_have_one_call() -> None:
    """Angles 2, 7 to 22 and 27, which three loops count from their own variables, are six at a distance of five."""
    loops = [body(0, 0, 1, Element("x", constant(2))), body(1, 1, 5, at(2)), body(2, 0, 1, at(27))]
    first, *others = with_sines_of_bodies([(loop,) for loop in loops])
    names = "sin_x_2_5_6", "cos_x_2_5_6"
    assert first[:3] == (*(Local(name, 6) for name in names), Sines(Element("x", constant(2)), *names, 6, 5))
    nodes = [first[3], *(node for part in others for node in part)]
    assert not sines_of(nodes) and not has_calls(nodes)
    assert {n.expr for n in every(nodes) if isinstance(n, Let)} == {
        Element(name, index) for name in names for index in (constant(0), variable("n"), variable("n", 1, 5))
    }


@pytest.mark.parametrize(
    "loops",
    [
        [body(0, 0, 1, at(2))],  # a single body
        [body(0, 0, 4, Element("x", variable("place")), Integer("place", "places", variable("n")))],
        [body(0, 0, 4, at(2)), For("n", constant(0), constant(4), (Assign(Element("x", variable("n")), at(1)),))],
    ],
)
def test_other_angles_stay(loops: list[For]) -> None:
    """Angles that integers place, and those that the section itself computes."""
    assert with_sines_of_bodies([tuple(loops)]) == [tuple(loops)]


def test_each_distance_has_its_call() -> None:
    loops = (body(0, 0, 3, at(2)), body(1, 0, 3, at(20, 7)), body(2, 0, 2, at(7)))
    (nodes,) = with_sines_of_bodies([loops])
    assert [(item.angle, item.count, item.stride) for item in sines_of(nodes)] == [
        (Element("x", constant(2)), 3, 5),
        (Element("x", constant(20)), 3, 7),
    ]
    assert not has_calls(nodes)


@pytest.mark.parametrize("name", ["accel", "project_velocity", "constraints", "constraint_bias"])
def test_kernels_of_a_chain_keep_the_bits(name: str) -> None:
    kernel = looped("chain_5").kernel(name)
    given: dict[str, Any] = arguments(kernel)
    nodes = [*nodes_in_lanes(kernel)]
    assert len([item for item in sines_of(nodes) if item.stride]) == 1
    assert not has_calls(nodes)
    assert interpret(kernel, given, nodes=nodes) == interpret(kernel, given)


@pytest.mark.parametrize("count", [MANY - 1, MANY])
def test_loops_that_store_much_of_many_bodies_keep_their_sines(count: int) -> None:
    stores = [Assign(Element("z", variable("n", STORES, k)), ScalarRef("phi_0")) for k in range(STORES)]
    (nodes,) = with_sines_of_bodies([(body(0, 0, count, at(2), *stores),)])
    assert has_calls(nodes) == (count == MANY)


@pytest.mark.parametrize("count", [MANY - 1, MANY])
def test_loops_in_lanes_over_many_bodies_keep_their_sines(count: int) -> None:
    loop = replace(body(0, 0, count, at(2)), overlaps=True)
    (nodes,) = with_sines_of_bodies([(loop,)])
    assert has_calls(nodes) == (count == MANY)


def test_bodies_of_one_vector_keep_their_sines() -> None:
    """One call for them would spare no text, and they would wait for it."""
    (item,) = sines_of(nodes_in_lanes(looped("chain_3").kernel("accel")))
    assert not item.stride


def test_functions_of_one_instance_have_one_call_for_both() -> None:
    """The number of the body is an argument, on which the place of its angle depends."""
    kernel = looped("chain_5").kernel("marker_b0_left")
    nodes = [*nodes_in_lanes(kernel)]
    (item,) = sines_of(nodes)
    assert (item.angle, item.count) == (Element("q", variable(INSTANCE, 5, 2)), 1)
    assert not has_calls(nodes)
    for number in (0, 3):
        given = {**arguments(kernel), "number": number}
        assert interpret(kernel, given, nodes=nodes) == interpret(kernel, given)


def test_integers_that_place_the_angle_come_before_its_sine() -> None:
    place = Integer("place", "places", variable("n"))
    loop = replace(
        body(0, 0, 1, Element("x", variable("place")), place), start=variable("number"), stop=variable("number", 1, 1)
    )
    ((result,),) = with_sines_of_bodies([(replace(loop, body=(place, *(n for n in loop.body if n != place))),)])
    assert isinstance(result, For)
    kinds = [type(node) for node in result.body]
    assert kinds[:4] == [Integer, Local, Local, Sines] and not has_calls([result])


def test_batches_call_one_function_of_sines() -> None:
    """Compilers take long for sines, which several parts of a batch need for the states of a block."""
    _, source = CBackend().files(looped("chain_5"), "test")
    before, batches = source.text.split("void graph_block8_sines(")
    assert before.endswith("TISSERAND_APART ") and batches.count("    tisserand_sines(") == 1
    assert batches.count("graph_block8_sines(") > 1
