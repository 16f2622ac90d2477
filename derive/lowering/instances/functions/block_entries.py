"""The entries of bodies in the system of the joints: blocks on and beside its diagonal, and right-hand sides."""

from __future__ import annotations

from collections.abc import Callable
from itertools import combinations

from derive.ir.expressions import Operator
from derive.ir.indices import ElementIndex, IndexTerm
from derive.ir.statements import Entry
from derive.lowering.flat.context import stores
from derive.lowering.flat.schedule import StepItem
from derive.lowering.instances.elimination.block_system import COUPLING, DIAGONAL, FLOOR, RIGHT, Blocks, packed
from derive.lowering.instances.functions.compliance_loops import RowTargets
from derive.lowering.instances.functions.local_system import LocalSystem
from derive.lowering.instances.loop_code.class_code import INSTANCE, ClassCode, LoopTarget
from derive.lowering.instances.loop_code.context import InstanceContext
from derive.lowering.instances.places import Place


def block_items(
    context: InstanceContext, of: ClassCode, local_of: LocalSystem
) -> tuple[list[StepItem], dict[str, LoopTarget]]:
    """The items that write G M^-1 G^T and the right-hand side of a body to the system of the joints."""
    system = context.blocks
    assert system is not None
    items: list[StepItem] = []
    targets: dict[str, LoopTarget] = {}
    for h, rows in enumerate(of.system_rows):
        place, (side, operator) = joint_place(system, of, h), _side(of, h)
        pairs = [(i, j) for i in range(len(rows)) for j in range(i, len(rows))]
        index = [packed(system.size, i, j) for i, j in pairs]
        targets[f"diagonal_{h}"] = LoopTarget(DIAGONAL[side], _chosen(place, index), operator, place.entries)
        items += stores(f"diagonal_{h}", [local_of.compliance(rows[i], rows[j]) for i, j in pairs])
        targets[f"right_{h}"] = of.target(RIGHT[side], place, operator)
        items += stores(f"right_{h}", [local_of.right[r] for r in rows])
        if context.proximal:
            targets[f"floor_{h}"] = of.target(FLOOR[side], place, operator)
            items += stores(f"floor_{h}", [local_of.floor(r) for r in rows])
    for a, b in combinations(range(len(of.system_rows)), 2):
        items_of, targets_of = _coupling(system, of, (a, b), local_of)
        items += items_of
        targets |= targets_of
    return items, targets


def _side(of: ClassCode, handle: int) -> tuple[int, Operator | None]:
    """The side of a joint that a body is, and how it writes its block there: the bodies of a gear add to one side."""
    at = of.of.first.handles[handle]
    return (0, Operator.ADD) if at.is_gear else (at.side, None)


def loop_targets(system: Blocks, of: ClassCode) -> RowTargets | None:
    """Where the entries of the rows of a class go in loops over these; None if they are not at equal distances."""
    entries: dict[tuple[int, int], tuple[str, ElementIndex, int, int]] = {}
    rights: dict[int, tuple[str, ElementIndex, int]] = {}
    size, spacing = system.size, system.spacing
    has_gears = any(handle.is_gear for handle in of.of.first.handles)
    if has_gears or system.adds or packed(size, 1, 1) != packed(size, 0, 0) + size + 1:
        return None
    for h in range(len(of.system_rows)):
        place, side = joint_place(system, of, h), 0 if of.of.first.handles[h].is_first else 1
        entries[h, h] = DIAGONAL[side], place.at(0), size * spacing, spacing
        rights[h] = RIGHT[side], place.at(0), spacing
        if place.entry:
            return None
    for a, b in combinations(range(len(of.system_rows)), 2):
        place, turned = _coupling_place(system, of, (a, b))
        if place.entry or len(set(turned)) > 1:
            return None
        distances = (1, size) if turned[0] else (size, 1)
        row, column = (n * system.coupling_spacing for n in distances)
        entries[a, b] = COUPLING, place.at(0), row, column
    return RowTargets(entries, rights)


def joint_place(system: Blocks, of: ClassCode, handle: int) -> Place:
    """The place of the joint at a handle of each body, in arrays of one component after the other."""
    return of.place(f"joint_{handle}", [system.place(m.handles[handle].joint) for m in of.of.members], system.spacing)


def _coupling(
    system: Blocks, of: ClassCode, handles: tuple[int, int], local_of: LocalSystem
) -> tuple[list[StepItem], dict[str, LoopTarget]]:
    """The items that write a block beside the diagonal: two joints of one body."""
    a, b = handles
    first, second = of.system_rows[a], of.system_rows[b]
    size, name = system.size, f"coupling_{a}_{b}"
    place, turned = _coupling_place(system, of, handles)
    values = [local_of.compliance(i, j) for i in first for j in second]
    cells = [(i, j) for i in range(len(first)) for j in range(len(second))]
    has_gear = any(of.of.first.handles[h].is_gear for h in handles)
    operator = Operator.ADD if system.adds or has_gear else None
    if len(set(turned)) == 1:
        index = [size * j + i if turned[0] else size * i + j for i, j in cells]
        target = LoopTarget(COUPLING, _chosen(place, index), operator, place.entries)
    else:
        row, column = f"{name}_row_{of.name}", f"{name}_column_{of.name}"
        spacing = system.coupling_spacing
        rows = of.places.integers(f"{row}s", [1 if t else size for t in turned])
        columns = of.places.integers(f"{column}s", [size if t else 1 for t in turned])
        here = ElementIndex(0, (IndexTerm(1, INSTANCE),))
        entries = (*place.entries, Entry(row, rows, here), Entry(column, columns, here))

        def at_cell(k: int) -> ElementIndex:
            i, j = cells[k]
            terms = [IndexTerm(n * spacing, variable) for n, variable in ((i, row), (j, column)) if n]
            return ElementIndex(place.first.offset, (*place.first.terms, *terms))

        target = LoopTarget(COUPLING, at_cell, operator, entries)
    return [*stores(name, values)], {name: target}


def _coupling_place(system: Blocks, of: ClassCode, handles: tuple[int, int]) -> tuple[Place, list[bool]]:
    """The place of the block of two joints of each body, and whether the second of these comes first."""
    a, b = handles
    at = [(system.place(m.handles[a].joint), system.place(m.handles[b].joint)) for m in of.of.members]
    is_turned = at[of.of.leading][0] > at[of.of.leading][1]
    turned = [is_turned if system.joints in pair else pair[0] > pair[1] for pair in at]
    return of.place(f"coupling_{a}_{b}", [system.block(*pair) for pair in at], system.coupling_spacing), turned


def _chosen(place: Place, numbers: list[int]) -> Callable[[int], ElementIndex]:
    return lambda k: place.at(numbers[k])
