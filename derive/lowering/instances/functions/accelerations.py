"""Accelerations and multipliers: bodies first, then the joints, then the bodies again."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import casadi as ca

from derive.algebra import sp
from derive.ir.expressions import Element, Operator, ScalarRef
from derive.ir.indices import ElementIndex, IndexTerm, constant
from derive.ir.kernel import Argument, Kernel
from derive.ir.statements import Entry, ForEach, Requirement, ReturnCode, Statement, StoreElement, Work
from derive.lowering.flat.accelerations import balanced
from derive.lowering.flat.context import array_input, stores
from derive.lowering.flat.schedule import RequiredValue, Step, StepItem
from derive.lowering.instances.elimination.block_system import (
    COUPLING,
    DIAGONAL,
    FLOOR,
    FORCE,
    KNOWN,
    RIGHT,
    Blocks,
    declared,
    packed,
    spaced,
    spare_reactions,
)
from derive.lowering.instances.elimination.graph_elimination import in_graph
from derive.lowering.instances.elimination.joined_classes import written_too_much
from derive.lowering.instances.elimination.path_elimination import along_path
from derive.lowering.instances.elimination.proximal_elimination import with_proximal_term
from derive.lowering.instances.functions.body_motions import BodyMotions
from derive.lowering.instances.functions.compliance_loops import RowTargets
from derive.lowering.instances.functions.first_body_results import inertial_translation, reactions_of_joints
from derive.lowering.instances.functions.local_system import LocalSystem, Right, local_system
from derive.lowering.instances.functions.marker_modes import LABEL
from derive.lowering.instances.functions.varying_factors import VaryingFactors
from derive.lowering.instances.loop_code.class_code import (
    INSTANCE,
    ClassCode,
    InnerLoops,
    LoopTarget,
    kept_values,
)
from derive.lowering.instances.loop_code.context import (
    InstanceContext,
    applied_forces,
    applied_sums,
    given_inputs,
    idle_rows,
    known_value,
    state,
)
from derive.lowering.instances.loop_code.kernels import Part, Result, kernel
from derive.lowering.instances.places import Place
from derive.lowering.model_functions import ModelFunction
from derive.mechanics.motion.products import product
from derive.mechanics.symbols import local
from derive.roles import Source


@dataclass(frozen=True)
class _Solution:
    """The two loops over the bodies of a class, before and after the elimination of the joints."""

    before: ForEach
    work: Work | None
    after: ForEach


def _system(
    context: InstanceContext,
    of: ClassCode,
    right: Callable[[InstanceContext, ClassCode], Right],
    names: tuple[str, ...],
    output: str,
    in_lanes: bool,
) -> _Solution:
    """The loops of a class: the compliance of its markers, and its unknowns from the reactions."""
    ctx = of.system
    side = right(context, of)
    read = [*side.inputs, *VaryingFactors(context, in_lanes).reads(of)]
    if in_lanes and context.along_first:
        read.append(BodyMotions(context).of_class(of))
    loads = [*state(of, *names), *read]
    given = (*given_inputs(of, *names), *(given for _, _, given in read), ctx.lam)
    symbols = ctx.symbols(*given)
    system = local_system(of, symbols, side, in_lanes)
    found = inertial_translation(of, symbols, system.unknowns)
    unknowns, kept, values = kept_values(symbols, found, symbols.values_of(ctx.forces), system.inverses)
    items: list[StepItem] = [*system.checks]
    targets: dict[str, LoopTarget] = {}
    inner: dict[str, InnerLoops] = {}
    if context.blocks and of.system_rows:
        loops = system.in_loops if not context.proximal else None
        places = _loop_targets(context.blocks, of) if loops else None
        if loops and loops.groups and places:
            inner[of.name] = loops.loops(places)
            items += loops.items()
        else:
            more, targets = _block_items(context, of, system)
            items += more
    work = Work(f"kept_{of.name}", len(kept) * spaced(of.count), spacing=spaced(of.count)) if kept else None
    place = of.place("kept", range(of.count), spaced(of.count))
    if work:
        items += stores("kept", values)
        targets["kept"] = of.target(work.array, place)
    steps = [Step(of.name, "", "", tuple(items))]
    if system.markers and inner:
        steps[0] = Step(of.name, "", "", (*system.markers.items(), *items))
        inner[of.name] = system.markers.loops().and_then(inner[of.name])
    elif system.markers:
        steps.insert(0, Step(LABEL, "", "", tuple(system.markers.items())))
        inner[LABEL] = system.markers.loops()
    before = of.loop(symbols, steps, loads, targets, in_lanes, inner)
    later = symbols.copy()
    inputs = list(loads)
    if work:
        labels = [local(f"kept_{k + 1}") for k in range(len(kept))]
        for symbol in labels:
            later.input(symbol, ScalarRef(symbol.name))
        inputs.append((work.array, place, array_input(work.array, labels, "")))
        unknowns = ca.vertsplit(ca.substitute([ca.vertcat(*unknowns)], kept, later.values_of(labels))[0])
    if context.blocks:
        for h, rows in enumerate(of.system_rows):
            names_of = array_input(FORCE, [ctx.forces[r] for r in rows], "")
            inputs.append((FORCE, _joint_place(context.blocks, of, h), names_of))
    after = of.loop(
        later,
        [Step(of.name, "", "", (*stores(output, unknowns), *_finite(unknowns)))],
        inputs,
        {output: of.target(output, of.row)},
        in_lanes,
    )
    return _Solution(before, work, after)


def _finite(unknowns: list[ca.SX]) -> tuple[StepItem, ...]:
    """The requirement that the unknowns of a body are finite, by their sum: it is not finite if one of them is not.

    A reaction that is not finite makes those of its bodies so, since zero times it is a NaN.
    """
    if not unknowns:
        return ()
    return (RequiredValue(Requirement.FINITE, balanced(unknowns), ReturnCode.NOT_FINITE, "a result is not finite"),)


def _block_items(
    context: InstanceContext, of: ClassCode, local_of: LocalSystem
) -> tuple[list[StepItem], dict[str, LoopTarget]]:
    """The items that write G M^-1 G^T and the right-hand side of a body to the system of the joints."""
    system = context.blocks
    assert system is not None
    items: list[StepItem] = []
    targets: dict[str, LoopTarget] = {}
    for h, rows in enumerate(of.system_rows):
        place, (side, operator) = _joint_place(system, of, h), _side(of, h)
        pairs = [(i, j) for i in range(len(rows)) for j in range(i, len(rows))]
        index = [packed(system.size, i, j) for i, j in pairs]
        targets[f"diagonal_{h}"] = LoopTarget(DIAGONAL[side], _chosen(place, index), operator, entries_of(place))
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


def _loop_targets(system: Blocks, of: ClassCode) -> RowTargets | None:
    """Where the entries of the rows of a class go in loops over these; None if they are not at equal distances."""
    entries: dict[tuple[int, int], tuple[str, ElementIndex, int, int]] = {}
    rights: dict[int, tuple[str, ElementIndex, int]] = {}
    size, spacing = system.size, system.spacing
    has_gears = any(handle.is_gear for handle in of.of.first.handles)
    if has_gears or system.adds or packed(size, 1, 1) != packed(size, 0, 0) + size + 1:
        return None
    for h in range(len(of.system_rows)):
        place, side = _joint_place(system, of, h), 0 if of.of.first.handles[h].is_first else 1
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


def _joint_place(system: Blocks, of: ClassCode, handle: int) -> Place:
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
        target = LoopTarget(COUPLING, _chosen(place, index), operator, entries_of(place))
    else:
        row, column = f"{name}_row_{of.name}", f"{name}_column_{of.name}"
        spacing = system.coupling_spacing
        rows = of.places.integers(f"{row}s", [1 if t else size for t in turned])
        columns = of.places.integers(f"{column}s", [size if t else 1 for t in turned])
        here = ElementIndex(0, (IndexTerm(1, INSTANCE),))
        entries = (*entries_of(place), Entry(row, rows, here), Entry(column, columns, here))

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


def entries_of(place: Place) -> tuple[Entry, ...]:
    """The statement that names a place, if it needs one."""
    return (place.entry,) if place.entry else ()


def solved(
    context: InstanceContext,
    function: ModelFunction,
    results: Mapping[str, Result],
    right: Callable[[InstanceContext, ClassCode], Right],
    names: tuple[str, ...],
    unknown: str,
    given: Sequence[Statement] = (),
    inputs: Mapping[str, Argument] | None = None,
    in_lanes: bool = True,
    alone: bool = False,
) -> Kernel:
    """A kernel that solves the system of bodies and joints.

    given: the statements that write what is known of the right-hand sides of the joints, to KNOWN; alone: they write
    all of them, to RIGHT[0] after the bodies, which have zeros. in_lanes: whether many bodies are computed in vectors,
    in which bodies with fewer rows join those with more.
    """
    classes = context.classes_in_lanes if in_lanes else context.classes
    are_joined = any(of.of.is_joined for of in classes)
    systems = [_system(context, of, right, names, unknown, in_lanes) for of in classes]
    works = [s.work for s in systems if s.work]
    applied = applied_sums(context) if right is _forces else ()
    factors = VaryingFactors(context, in_lanes)
    has_bias = bool(factors.groups) and right is _forces
    has_known = (bool(given) and not alone) or has_bias
    steps: list[Part] = [
        (
            "bodies",
            "(15)",
            "the compliance of the markers of each body, and its motion without reactions",
            [*works, *applied, *(s.before for s in systems)],
        )
    ]
    if context.blocks:
        motions = BodyMotions(context).statements() if in_lanes and context.along_first else ()
        loops = factors.loops(context.blocks, names, has_bias, in_lanes)
        varying: list[Statement] = [*factors.works(), *motions, *loops]
        written = {element for of in classes for element in written_too_much(of.of, of.system_rows, context.blocks)}
        arrays = declared(context.blocks, has_known, context.proximal, written)
        before = [s for s in arrays if isinstance(s, Work) or not are_joined]
        steps[:0] = [
            ("system", Source.FACTORISATION, "the blocks of the joints", before),
            ("known", "(5)", "what is known of the right-hand sides", [] if alone else list(given)),
            ("factors", "(6)", "what the rows of G of one body owe to another", varying),
        ]
        if are_joined:
            after = [*(s for s in arrays if s not in before), *spare_reactions(context.blocks)]
            steps.append(("rows", Source.FACTORISATION, "rows that joints do not have", after))
        if alone:
            steps.append(("right", "(5)", "the right-hand sides of the joints", list(given)))
        steps.append(
            (
                "joints",
                Source.FACTORISATION,
                "elimination of the joints, and back substitution",
                _eliminated(context, context.blocks, has_known),
            )
        )
    steps.append(
        ("unknowns", Source.FACTORISATION, "the unknowns of each body from the reactions", [s.after for s in systems])
    )
    if "lam" in results and context.blocks:
        along_first = in_lanes and context.along_first
        reactions = reactions_of_joints(context, context.blocks) if along_first else _reactions(context, context.blocks)
        steps.append(("lambda", "", "the reactions", list(reactions)))
    return kernel(context, function, results, *steps, inputs=inputs)


def _eliminated(context: InstanceContext, of: Blocks, has_known: bool) -> tuple[Statement, ...]:
    """The elimination of all joints and the back substitution, from the arrays of the system to the reactions."""
    if context.proximal:
        idle = [of.position[joint] + k * of.spacing for joint, k in idle_rows(context)]
        return with_proximal_term(of, context.places, has_known, idle)
    return along_path(of, has_known) if of.is_path else in_graph(of, context.places, has_known)


def by_joint(context: InstanceContext, system: Blocks) -> Iterator[tuple[int, int, Place, Place]]:
    """Yield each number of rows of joints, how many joints have it, their first rows and their places in the arrays."""
    for rows in sorted(set(system.rows)):
        joints = [j for j, own in enumerate(system.rows) if own == rows]
        firsts = context.places.place(f"multiplier_{rows}", INSTANCE, [context.first_rows[j] for j in joints])
        of = [system.position[j] for j in joints]
        yield rows, len(joints), firsts, context.places.place(f"reaction_{rows}", INSTANCE, of, system.spacing)


def _reactions(context: InstanceContext, system: Blocks) -> Iterator[Statement]:
    """The reactions in the order of the constraints."""
    for rows, count, to, of in by_joint(context, system):
        body = [StoreElement(Element("lam", to.at(k)), Element(FORCE, of.at(k))) for k in range(rows)]
        yield ForEach(INSTANCE, constant(0), constant(count), (*entries_of(to), *entries_of(of), *body))


def _known_bias(context: InstanceContext) -> list[Statement]:
    """The known parts of gamma, besides zeros."""
    system = context.blocks
    result: list[Statement] = []
    if system is None:
        return result
    for joint, of in enumerate(context.known.constraints):
        for k, c in enumerate(of):
            value = known_value("bias", c, -1)
            if value is not None:
                index = system.position[joint] + k * system.spacing
                result.append(StoreElement(Element(KNOWN, constant(index)), value))
    return result


def _forces(context: InstanceContext, of: ClassCode) -> Right:
    eq = of.system.equations
    applied = applied_forces(context, of)
    own = (*(applied[0][2].symbols if applied else [sp.S.Zero] * len(eq.rows)),)
    forces = [-h - more for h, more in zip(eq.force, own, strict=True)]
    if of.axes is not None:
        forces[: of.axes.rows] = product(of.axes.T, sp.Matrix(forces[: of.axes.rows]))
    return Right(forces, [-c.bias for c in eq.constraints], applied)


def accel(context: InstanceContext, function: ModelFunction) -> Kernel:
    """The kernel of vdot alone, for integrators of first-order equations."""
    results = {"vdot": Result(("body by body",), count=len(context.rows))}
    return solved(context, function, results, _forces, ("t", "q", "v"), "vdot", _known_bias(context))


def solve(context: InstanceContext, function: ModelFunction) -> Kernel:
    """The kernel of vdot and lambda."""
    results = {
        "vdot": Result(("body by body",), count=len(context.rows)),
        "lam": Result(("joint by joint",), count=len(context.multipliers)),
    }
    return solved(context, function, results, _forces, ("t", "q", "v"), "vdot", _known_bias(context))
