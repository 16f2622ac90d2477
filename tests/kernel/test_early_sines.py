"""Sines one instance ahead: they are stored where they are kept, and every value stays."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from conftest import QUICK
from derive.backends.c import batch as c_batch
from derive.backends.c.source import CBackend
from derive.ir.batches import batch
from derive.ir.early_sines import with_early_sines
from derive.ir.expressions import Element, Number, Operation, Operator, ScalarRef
from derive.ir.indices import constant, variable
from derive.ir.library_calls import STATE, over_states
from derive.ir.loop_nests import Assign, For, If, Local, Node, Sines, every
from derive.ir.statements import Let
from derive.runtime.loading import load_scene
from kernel.test_instance_lanes import looped

COUNT = 4
"""The iterations of the loops."""
ANGLES = frozenset({"x"})


def kept(name: str, component: int, operator: Operator | None = None) -> Assign:
    return Assign(Element("kept", variable("i", 2, component), STATE), ScalarRef(name), operator)


def in_states(*lines: Node) -> For:
    """A loop over a single state, which the interpreter runs."""
    return replace(over_states(lines), stop=constant(1))


def of(array: str, stride: int = 1, first: int = 0) -> Element:
    return Element(array, variable("i", stride, first), STATE)


def instances(count: int = COUNT, stored: Sequence[str] = ("s", "c"), others: Sequence[Node] = ()) -> tuple[Node, ...]:
    """A loop that stores sines and cosines of angles, and one that reads what is stored."""
    sines = Sines(Element("x", variable("i")), "s", "c")
    stores = [kept(name, k) for k, name in enumerate(stored)]
    body = in_states(*stores, *others, Assign(of("y"), Operation(Operator.MUL, (ScalarRef("s"), ScalarRef("s")))))
    read = in_states(Assign(of("y"), of("kept", 2), Operator.ADD))
    loops = [For("i", constant(0), constant(count), (part,)) for part in (body, read)]
    return Local("kept", 2 * COUNT), replace(loops[0], body=(sines, body)), loops[1]


def sines_of(nodes: Iterable[Node]) -> list[Sines]:
    return [node for node in every(nodes) if isinstance(node, Sines)]


def test_sines_of_the_next_instance_come_before_the_lines_of_this_one() -> None:
    (_, first, loop, _) = with_early_sines(instances(), ANGLES)
    rows = constant(0), constant(1)
    assert first == Sines(Element("x", constant(0)), "kept", "kept", rows=rows)
    assert isinstance(loop, For)
    ahead, states = loop.body
    rows = variable("i", 2, 2), variable("i", 2, 3)
    following = Sines(Element("x", variable("i", 1, 1)), "kept", "kept", rows=rows)
    assert ahead == If("i", COUNT - 1, (following,), ())
    assert isinstance(states, For)
    assert states.body[:2] == (Let("c", of("kept", 2, 1)), Let("s", of("kept", 2)))
    assert not {"s", "c"} & {
        line.expr.name for line in states.body if isinstance(line, Assign) and isinstance(line.expr, ScalarRef)
    }


def test_a_single_instance_needs_none_ahead() -> None:
    (_, first, loop, _) = with_early_sines(instances(1), ANGLES)
    assert isinstance(first, Sines)
    assert not sines_of([loop])


@pytest.mark.parametrize(
    "nodes",
    [
        instances(stored=["s"]),
        instances(others=[Assign(of("kept", 2), Number(Fraction(1)))]),
        instances(others=[kept("s", 0, Operator.ADD)]),
    ],
)
def test_sines_that_are_not_kept_in_places_of_their_own_stay(nodes: tuple[Node, ...]) -> None:
    assert with_early_sines(nodes, ANGLES) == nodes


def test_sines_of_what_a_kernel_computes_stay() -> None:
    assert with_early_sines(instances(), frozenset()) == instances()


@pytest.mark.parametrize("width", [8, 4])
def test_batches_of_a_chain_have_the_bits_of_single_states(width: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Bodies are computed in the elimination, in another order of their lines, and after their sines."""
    monkeypatch.setattr(c_batch, "REPEATED", {width: None})
    scene = load_scene(CBackend().files(looped("chain_10"), "a test"), QUICK)
    rng = np.random.default_rng(1)
    q, v, k = rng.uniform(-0.3, 0.3, (11, scene.nq)), rng.uniform(-1, 1, (11, scene.nv)), scene.setup()
    q[4, 2] = 3e5  # an angle whose sine the C library computes
    single = [scene.accel(0.5, *state, k) for state in zip(q, v, strict=True)]
    assert scene.accel_batch(0.5, q, v, k).tobytes() == np.array(single).tobytes()


def test_bodies_of_a_chain_have_early_sines() -> None:
    """The sines of first bodies come first; the loops of an end and of both sides compute those of the next body."""
    nodes = batch(looped("chain_10").kernel("accel")).nodes
    first = [node for node in nodes if isinstance(node, Sines)]
    ahead = [node for node in every(nodes) if isinstance(node, If)]
    assert len(ahead) == 2
    assert len(sines_of(nodes)) == len(first) + 2
    assert all(node.rows for node in sines_of(nodes))
