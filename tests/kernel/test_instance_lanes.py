"""Loops over instances: blocks of four bodies, both ends of a path at once, and batches leave every bit as it is."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pytest

import derive
from derive.backends.c.loop_text import vector_starts
from derive.backends.c.nests import CNests
from derive.ir.batches import batch
from derive.ir.expansion import expand
from derive.ir.expressions import Element, Number, Operation, Operator, ScalarRef
from derive.ir.indices import constant, variable
from derive.ir.interpreter import interpret, interpret_batch
from derive.ir.kernel import Argument, ConstantArray, Kernel, Output, Section, View
from derive.ir.lanes import in_lanes, section_in_lanes
from derive.ir.loop_nests import Assign, For, LoopKind, Node, every
from derive.ir.model import Model
from derive.ir.statements import Entry, ForEach, Let, Require, Requirement, ReturnCode, StoreElement, Work
from derive.lowering.flat.lower import lower
from derive.lowering.instances.lower import lower_instances
from derive.mechanics.multibody.mechanism import Mechanism

ROD = """
[bodies.b{n}]
ansatz = ["1", "xi", "xi^2", "xi^3"]
frame = "mean"
mass = "1/20"
length = "1/10"
bending_stiffness = "1/5"
markers = {{ left = -1, middle = 0, right = 1 }}
start = {{ position = [{x}, 0] }}
"""
HEAD = 'name = "graph"\n[scene]\ngravity = [0, "-981/100"]\n[ground.markers]\nhook = [0, 0]\nfar = [1, 0]\n'
Link = tuple[str, str, str]


def chain(count: int, first: str = "revolute", others: str = "weld") -> tuple[Link, ...]:
    """Rods one after the other, from the ground on."""
    links = ((others, f"b{n}.right", f"b{n + 1}.left") for n in range(count - 1))
    return ((first, "ground.hook", "b0.left"), *links)


GRAPHS: dict[str, tuple[int, tuple[Link, ...]]] = {
    **{f"chain_{n}": (n, chain(n)) for n in (1, 2, 3, 4, 5, 6, 9, 10)},
    "pinned": (7, chain(7, others="revolute")),
    "two_hooks": (5, (*chain(5), ("revolute", "b4.right", "ground.far"))),
    "star": (6, (("revolute", "ground.hook", "b0.left"), *(("weld", "b0.right", f"b{n}.left") for n in range(1, 6)))),
    "tree": (
        9,
        (
            *(("revolute", f"b{(n - 1) // 2}.{'left' if n % 2 else 'right'}", f"b{n}.middle") for n in range(1, 9)),
            ("weld", "ground.hook", "b0.middle"),
        ),
    ),
    "parallel": (3, (*chain(2), ("revolute", "b0.right", "b2.left"), ("revolute", "b1.right", "b2.right"))),
    "ring": (5, (*chain(5, others="revolute")[1:], ("revolute", "b4.right", "b0.left"))),
    "free": (2, chain(2)[1:]),
}


LATER = ("chain_4", "chain_5", "chain_6", "chain_10", "star", "two_hooks")
"""Graphs of which others have what is different in them: an end, a middle, a branch, a whole block and its rest."""
EVERY_GRAPH = [pytest.param(name, marks=pytest.mark.long if name in LATER else ()) for name in GRAPHS]


@cache
def mechanism(graph: str) -> Mechanism:
    count, links = GRAPHS[graph]
    text = HEAD + "".join(ROD.format(n=n, x=n / 10 + 0.05) for n in range(count))
    for k, (kind, first, second) in enumerate(links):
        text += f'[joints.j{k}]\nkind = "{kind}"\nbetween = ["{first}", "{second}"]\n'
    with TemporaryDirectory() as folder:
        path = Path(folder) / "graph.toml"
        path.write_text(text)
        made = derive.derive(derive.read(path))
    assert isinstance(made, Mechanism)
    return made


@cache
def looped(graph: str) -> Model:
    return lower_instances(mechanism(graph), explicit=True)


@cache
def straight(graph: str) -> Model:
    return lower(mechanism(graph).expanded(), explicit=True)


def arguments(kernel: Kernel) -> dict[str, Any]:
    """A state near the undeformed one: flexible rods keep the pivots positive."""
    rng = np.random.default_rng(3)
    return {a.name: 0.3 if a.scalar else rng.uniform(-0.3, 0.3, a.size).tolist() for a in kernel.arguments}


def nodes_in_lanes(kernel: Kernel) -> Iterator[Node]:
    return (node for section in kernel.sections for _, part in section_in_lanes(section.body) for node in part)


@pytest.mark.parametrize("graph", EVERY_GRAPH)
@pytest.mark.parametrize("name", ["accel", "solve", "project_velocity"])
def test_loops_are_the_straight_line(graph: str, name: str) -> None:
    """The elimination from both ends and that along tables solve the equations that straight-line code solves."""
    kernel, flat = looped(graph).kernel(name), straight(graph).kernel(name)
    given = arguments(kernel)
    found = interpret(kernel, given)
    for output, expected in interpret(flat, {a.name: given[a.name] for a in flat.arguments}).items():
        assert np.abs(np.subtract(found[output], expected)).max() < 2e-13 * max(1e-3, np.abs(expected).max())


@pytest.mark.parametrize("graph", EVERY_GRAPH)
def test_blocks_of_bodies_and_both_ends_keep_the_bits(graph: str) -> None:
    kernel = looped(graph).kernel("accel")
    given = arguments(kernel)
    assert interpret(kernel, given, nodes=nodes_in_lanes(kernel)) == interpret(kernel, given)


@pytest.mark.parametrize("graph", ["chain_6", "chain_9", "tree"])
def test_batches_keep_the_bits(graph: str) -> None:
    kernel = looped(graph).kernel("accel")
    given = arguments(kernel)
    many = {name: [[x] * 3 for x in value] if isinstance(value, list) else value for name, value in given.items()}
    found, codes = interpret_batch(kernel, many, 3)
    assert codes == [0, 0, 0]
    assert found["vdot"] == [[x] * 3 for x in interpret(kernel, given)["vdot"]]


def test_which_loops_run_in_lanes() -> None:
    """Loops over several bodies run in lanes, and so does that over the ends of a path.

    Where there is one block of bodies, their angles have a loop of their own, before their sines.
    """
    kinds = [node.kind for node in every(nodes_in_lanes(looped("chain_9").kernel("accel"))) if isinstance(node, For)]
    assert kinds.count(LoopKind.ENDS) == 2
    assert kinds.count(LoopKind.LANES) == 2 and LoopKind.FEW not in kinds
    kinds = [node.kind for node in every(nodes_in_lanes(looped("chain_3").kernel("accel"))) if isinstance(node, For)]
    assert kinds.count(LoopKind.FEW) == 3 and LoopKind.LANES not in kinds
    assert all(
        node.kind is LoopKind.ORDERED
        for node in every(nodes_in_lanes(looped("star").kernel("project_velocity")))
        if isinstance(node, For)
    )


# ---- blocks of a loop of its own ----


def own_kernel(count: int, *body: Any) -> Kernel:
    """A loop over instances whose elements a constant array places."""
    loop = ForEach("n", constant(0), constant(count), body, independent=True)
    x = Argument("x", (), "given", arrays=(View("x", 0, 3 * count),))
    y = Output("y", tuple(f"y{k}" for k in range(2 * count)), "result")
    places = ConstantArray("places", tuple((5 * k) % count for k in range(count)), True)
    return Kernel("own", "", (x,), (y,), (Section("", "", "", (loop,)),), (places,))


def placed_items(place: str = "place") -> Sequence[Any]:
    at = variable(place)
    angle = Operation(Operator.MUL, (Number(Fraction(2)), Element("x", variable("n", 3, 1))))
    return (
        Entry(place, "places", variable("n")),
        Let("far", Element("x", at)),
        Let("sine", Operation(Operator.SIN, (angle,))),
        Let("sum", Operation(Operator.ADD, (ScalarRef("sine"), ScalarRef("far")))),
        Require(
            Requirement.POSITIVE, Operation(Operator.ADD, (ScalarRef("sum"), Number(Fraction(9)))), ReturnCode.PIVOT, ""
        ),
        StoreElement(Element("y", at.scaled(2)), ScalarRef("sum")),
        StoreElement(Element("y", variable("n", 2, 1)), Operation(Operator.COS, (angle,))),
    )


@pytest.mark.parametrize("count", [1, 2, 3, 4, 6, 7, 8, 9, 11])
def test_elements_that_integers_place(count: int) -> None:
    """Such elements are copied before and after a block; the last block overlaps the one before if some are left.

    Two or three instances are one block, and a single one is none.
    """
    kernel = own_kernel(count, *placed_items())
    given = {"x": np.random.default_rng(0).uniform(-1, 1, 3 * count).tolist()}
    nodes = tuple(nodes_in_lanes(kernel))
    assert interpret(kernel, given, nodes=nodes) == interpret(kernel, given)
    kinds = {n.kind for n in every(nodes) if isinstance(n, For)} - {LoopKind.ORDERED}
    assert kinds == (set() if count == 1 else {LoopKind.FEW} if count < 4 else {LoopKind.LANES})


def test_loops_that_read_what_they_write_stay_in_order() -> None:
    """In an overlapping block the second run of an iteration would find what the first one has written."""
    changes = StoreElement(Element("y", variable("n", 2)), Element("y", variable("n", 2)))
    nodes = nodes_in_lanes(own_kernel(6, *placed_items(), changes))
    assert all(node.kind is LoopKind.ORDERED for node in every(nodes) if isinstance(node, For))


def test_requirements_of_all_lanes_are_tested_behind_the_loop() -> None:
    lines = [line.text.strip() for line in CNests({"y"}).lines(nodes_in_lanes(own_kernel(6, *placed_items())))]
    assert sum(line.startswith("TISSERAND_CHECK(holds_1, ") for line in lines) == 1
    assert lines[-1] == "if (!TISSERAND_EVERY(holds_1)) return 1; /* a pivot vanished */"
    assert "tisserand_holds holds_1 = TISSERAND_HOLDS;" in lines


def test_where_vectors_are_stored_arrays_are_aligned() -> None:
    """A vector that begins at element 2 needs two more before it; elements at a distance of two are no vectors."""
    works = Work("even", 12, spacing=12), Work("odd", 24, spacing=12)
    loop = ForEach(
        "n",
        constant(0),
        constant(8),
        (
            StoreElement(Element("even", variable("n", 1, 2)), Element("x", variable("n"))),
            StoreElement(Element("odd", variable("n", 2, 1)), Element("x", variable("n"))),
        ),
        independent=True,
    )
    nodes = [node for statement in (*works, loop) for node in in_lanes(expand(statement))]
    starts = vector_starts(nodes)
    assert starts == {"even": 2}
    assert "    TISSERAND_ALIGNED(even, 16, 2);" in [line.text for line in CNests(starts=starts).lines(nodes)]


def test_batches_keep_the_components_of_an_instance_together() -> None:
    """Element p of component c lies at 4 c + p in an array with a spacing of 4.

    In a batch, where only the components 1 and 2 occur, it is at 2 p + c - 1.
    """
    stores = (StoreElement(Element("w", variable("n", -1, 4 * c + 3)), Number(Fraction(1))) for c in (1, 2))
    kernel = own_kernel(4, *stores)
    kernel = replace(kernel, sections=(Section("", "", "", (Work("w", 12, spacing=4), *kernel.statements)),))
    stored = [n.target for n in every(batch(kernel).nodes) if isinstance(n, Assign)]
    assert [t.index for t in stored if isinstance(t, Element)] == [variable("n", -2, 6), variable("n", -2, 7)]
    assert batch(kernel).arrays.get("w") == 8


def test_rates_of_bodies_in_the_plane_are_one_copy() -> None:
    kernel = looped("chain_5").kernel("rates")
    (loop,) = kernel.statements
    assert isinstance(loop, ForEach) and len(loop.body) == 1
    given = arguments(kernel)
    assert interpret(kernel, given)["qdot"] == [*given["v"]]
