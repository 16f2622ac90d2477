"""The joints of a mechanism in space along which its rotations are eliminated relative to each other.

They are a forest whose nodes are the bodies that turn freely; its root is all that has no such rotation: the ground,
bodies whose motion is prescribed, and those that keep the coordinates of a joint alone.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from derive.ir.statements import Requirement, ReturnCode
from derive.lowering.elimination_orders import EliminationRule
from derive.lowering.flat.casadi_symbols import Symbols
from derive.lowering.flat.context import Context
from derive.lowering.flat.schedule import RequiredValue
from derive.lowering.ldlt import VANISHING
from derive.lowering.relative_rotations import InertialRotations, RelativeElimination, RelativeTurn, Triple
from derive.lowering.vectors import Vector
from derive.mechanics.symbols import identity
from derive.mechanics.terms import ConstrainedFrame, Constraint

MOST_OTHERS = 3
"""The largest number of rows that turn a body at the root of the forest, each of which is added to the rows behind."""


@dataclass(frozen=True)
class _Edge:
    """A joint that removes rotations: its constraints, and the free rotations of its frames, None at the root."""

    conditions: tuple[Constraint, ...]
    first: Triple | None
    second: Triple | None


@dataclass(frozen=True)
class JointTurns:
    """The change to inertial components, and the joints whose rotations are relative, leaves first."""

    inertial: InertialRotations
    turns: tuple[RelativeTurn, ...]


def joint_turns(context: Context, symbols: Symbols) -> JointTurns | None:
    """The joints whose rotations are eliminated beforehand; None if there are none.

    This takes the transpose of a rotation tensor for its inverse, which holds for unit quaternions alone. Derivatives
    with respect to the components of a quaternion leave these, so that models with derivatives do without.
    """
    if context.proximal or context.sensitivities or context.elimination is not EliminationRule.SAFE:
        return None
    oriented = list(_oriented(_forest(list(_edges(context)))))
    if not oriented:
        return None
    tensors = {}
    for c in context.equations.constraints:
        for frame in _frames(c):
            if rows := _rows(context, frame):
                assert frame.rotation is not None
                Q = frame.rotation.Q
                tensors[rows] = [[symbols(Q[i, j]) for j in range(3)] for i in range(3)]
    turns = tuple(_turn(context, symbols, edge, child) for edge, child in reversed(oriented))
    return JointTurns(InertialRotations(tensors, _factors(context, symbols)), turns)


def _frames(c: Constraint) -> tuple[ConstrainedFrame, ...]:
    return (c.frames.first, c.frames.second) if c.frames else ()


def _rows(context: Context, frame: ConstrainedFrame) -> Triple | None:
    """The rows of the free rotation of a frame."""
    if frame.rotation is None:
        return None
    a, b, c = (context.rows.index(name) for name in frame.rotation.rows)
    return a, b, c


def _edges(context: Context) -> Iterator[_Edge]:
    """The joints that remove up to three rotations relative to a body that turns freely."""
    groups: dict[tuple[str, str], list[Constraint]] = {}
    for c in context.equations.constraints:
        if c.frames and c.frames.axis is not None:
            groups.setdefault((c.section, c.of), []).append(c)
    for conditions in groups.values():
        first, second = _frames(conditions[0])
        ends = _rows(context, first), _rows(context, second)
        others = (len(frame.turning) for frame, end in zip((first, second), ends, strict=True) if not end)
        if len(conditions) <= 3 and ends[0] != ends[1] and all(count <= MOST_OTHERS for count in others):
            yield _Edge(tuple(conditions), *ends)


def _forest(edges: Sequence[_Edge]) -> list[_Edge]:
    """The edges that close no loop; those that remove most come first."""
    tree: dict[Triple | None, Triple | None] = {}

    def root(node: Triple | None) -> Triple | None:
        while node in tree:
            node = tree[node]
        return node

    result = []
    for edge in sorted(edges, key=lambda edge: -len(edge.conditions)):
        a, b = root(edge.first), root(edge.second)
        if a != b:
            child, parent = (b, a) if b is not None else (a, b)
            tree[child] = parent
            result.append(edge)
    return result


def _oriented(edges: Sequence[_Edge]) -> Iterator[tuple[_Edge, Triple]]:
    """The edges of a forest from its roots, each with the node that it leads to."""
    waiting = [*edges]
    nodes = [None, *(node for edge in edges for node in (edge.first, edge.second) if node)]
    seen: set[Triple | None] = set()
    for start in nodes:
        if start in seen:
            continue
        seen.add(start)
        reached = [start]
        for node in reached:
            for edge in [edge for edge in waiting if node in (edge.first, edge.second)]:
                waiting.remove(edge)
                child = edge.second if node == edge.first else edge.first
                assert child is not None, "the root is the first start"
                seen.add(child)
                reached.append(child)
                yield edge, child


def _turn(context: Context, symbols: Symbols, edge: _Edge, child: Triple) -> RelativeTurn:
    """A joint whose rotation is that of `child` relative to the other body."""
    first, second = _frames(edge.conditions[0])
    frame, parent = (first, edge.first) if child == edge.second else (second, edge.second)
    others = () if parent else frame.turning
    numbers = {c.name: len(context.rows) + k for k, c in enumerate(context.equations.constraints)}
    return RelativeTurn(
        child,
        parent,
        tuple((context.rows.index(name), [symbols(x) for x in factor]) for name, factor in others),
        tuple(numbers[c.name] for c in edge.conditions),
    )


def _factors(context: Context, symbols: Symbols) -> dict[tuple[int, Triple], Vector]:
    """The inertial entries of the rows of multipliers in the KKT matrix, by these rows and those of rotations."""
    result: dict[tuple[int, Triple], Vector] = {}
    for k, c in enumerate(context.equations.constraints, len(context.rows)):
        for number, frame in enumerate(_frames(c)):
            if rows := _rows(context, frame):
                axis = c.frames.axis if c.frames else None  # equal and opposite, so that code shares it
                entry = [-symbols(x) for x in (frame.moment if axis is None else axis)]
                entry = [-x for x in entry] if axis is not None and number == 0 else entry
                old = result.get((k, rows))
                result[k, rows] = [a + b for a, b in zip(old, entry, strict=True)] if old else entry
    return result


def turn_text(turn: RelativeTurn, names: Sequence[str]) -> str:
    """The rows that are eliminated with a joint, for people."""
    rotations, multipliers = turn.gone[: -len(turn.multipliers)], turn.multipliers
    return f"relative {', '.join(names[i] for i in rotations)} with {', '.join(names[i] for i in multipliers)}"


def axis_checks(symbols: Symbols, relative: RelativeElimination, names: Sequence[str]) -> tuple[RequiredValue, ...]:
    """The checks that the axes about which a joint removes rotations are independent; their length is 1 or less."""
    margin = symbols.number(VANISHING)
    result = []
    for step in relative.steps:
        text = f"the axes of {', '.join(names[i] for i in step.turn.multipliers)} became dependent"
        squared = step.divisor if step.leaves_one else step.divisor * step.divisor
        result.append(RequiredValue(Requirement.POSITIVE, squared - margin, ReturnCode.PIVOT, text))
    return tuple(result)


def rows_of_bodies(context: Context) -> dict[int, tuple[int, ...]]:
    """The other rows of the body to which each row belongs."""
    owners = [identity(row.v).owner for row in context.equations.rows]
    every = range(len(owners))
    return {i: tuple(j for j in every if j != i and owners[j] == owners[i]) for i in every}
