"""Batches of loops over bodies: each step of an elimination has one text, and long loops have a function each."""

from __future__ import annotations

import pytest

from derive.backends.c.batch_block import StateBlock
from derive.backends.c.block_parts import LONG, block_parts
from derive.ir.loop_nests import For, every
from kernel.test_instance_lanes import looped


@pytest.fixture(scope="module")
def accelerations() -> StateBlock:
    """Eight states of the accelerations of ten beams that hang from the ground."""
    return StateBlock(looped("chain_10").kernel("accel"), "chain_10", 8)


def test_the_steps_of_an_end_have_one_text(accelerations: StateBlock) -> None:
    """Ten joints: four steps from the second end, five from the first one, and the joint in the middle."""
    long = [node for part in accelerations.parts if part.apart for node in part.nodes if isinstance(node, For)]
    assert [node.count for node in long if sum(1 for _ in every([node])) > LONG] == [4, 5]
    assert len(accelerations.body()) + sum(map(len, accelerations.functions())) < 850


def test_long_loops_have_functions(accelerations: StateBlock) -> None:
    """No statement is lost or moves, and functions name what they read and write of the arrays that they share."""
    parts = accelerations.parts
    assert tuple(node for part in parts for node in part.nodes) == accelerations.batch.nodes
    assert [part.apart for part in parts] == [False, True, True, True]
    body, (members, *functions) = "\n".join(accelerations.body()), accelerations.functions()
    assert all(f" {array}[" in "\n".join(members) for array in (*accelerations.batch.arrays, "codes"))
    for part, lines in zip((part for part in parts if part.apart), functions, strict=True):
        name = lines[0].split()[-1].rstrip("(")
        assert body.count(f"{name}(") == 1
        assert len(lines) > LONG
        named = {line.split("work->")[-1].rstrip(";") for line in lines if "= work->" in line}
        assert named == {array for array in accelerations.batch.arrays if array in part.names} | {"codes"}


@pytest.mark.parametrize(("count", "more"), [(5, 9), (6, 10)])
def test_two_steps_have_the_loops_of_many(count: int, more: int) -> None:
    """The body that the second of two steps needs is computed there; a step alone needs no sines of the next one."""
    few, many = (StateBlock(looped(f"chain_{n}").kernel("accel"), "chain", 8).parts for n in (count, more))
    lines = [[len([*every(part.nodes)]) for part in parts] for parts in (few, many)]
    assert all(0 <= b - a <= 2 for a, b in zip(*lines, strict=True))


def test_short_batches_are_one_function() -> None:
    block = StateBlock(looped("chain_10").kernel("energy"), "chain_10", 8)
    assert not block.functions()
    assert not any(part.apart for part in block_parts(block.batch.nodes, several=False))
