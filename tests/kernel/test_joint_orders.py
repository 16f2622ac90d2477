"""The elimination of joints in graphs: orders in which few joints wait for each other, and the work of each."""

from __future__ import annotations

from derive.ir.analysis import operations
from derive.ir.patterns import Pattern, pattern
from derive.lowering.elimination_orders import elimination_order, graph_of, rounds_of_least_degree, work
from derive.lowering.instances.elimination.block_system import blocks
from kernel.test_instance_lanes import looped

RING = 64


def ring(count: int) -> Pattern:
    entries = {(max(k, (k + 1) % count), min(k, (k + 1) % count)) for k in range(count)}
    return pattern(count, count, entries, symmetric=True)


def longest_wait(shape: Pattern, order: tuple[int, ...]) -> int:
    """The largest number of rows that have to be eliminated one after the other."""
    graph, depth = graph_of(shape), dict.fromkeys(order, 1)
    for node in order:
        neighbours = graph.pop(node)
        for other in neighbours:
            depth[other] = max(depth[other], depth[node] + 1)
            graph[other] |= neighbours
            graph[other] -= {node, other}
    return max(depth.values())


def test_rounds_along_a_ring_wait_for_the_logarithm_of_its_length() -> None:
    shape = ring(RING)
    order = rounds_of_least_degree(shape)
    assert sorted(order) == list(range(RING))
    assert work(shape, order) == work(shape, elimination_order(shape))
    assert longest_wait(shape, order) <= 8
    assert longest_wait(shape, elimination_order(shape)) > RING // 2


def test_joints_of_a_ring_are_eliminated_in_rounds() -> None:
    """The first half of the joints has its neighbours in the second half."""
    handles = [((k, False), ((k + 1) % RING, True)) for k in range(RING)]
    system = blocks([3] * RING, handles)
    assert all(other >= RING // 2 for of in system.neighbours[: RING // 2] for other, _ in of)


def test_the_work_of_a_ring() -> None:
    """A smaller number is progress. Four additions of each body check that its accelerations are finite."""
    assert {graph: operations_of(graph) for graph in ("ring", "tree")} == {"ring": 1150, "tree": 3540}


def operations_of(graph: str) -> int:
    kernel = looped(graph).kernel("accel")
    integers = {array.name: array.values for array in kernel.constants if array.integers}
    return sum(operations(statement, integers) for statement in kernel.statements)
