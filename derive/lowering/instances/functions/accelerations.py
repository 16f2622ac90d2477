"""Accelerations and multipliers: bodies first, then the joints, then the bodies again."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import casadi as ca

from derive.algebra import sp
from derive.ir.expressions import Element, ScalarRef
from derive.ir.indices import constant
from derive.ir.kernel import Argument, Kernel
from derive.ir.statements import ForEach, Requirement, ReturnCode, Statement, StoreElement, Work
from derive.lowering.flat.accelerations import balanced
from derive.lowering.flat.context import array_input, stores
from derive.lowering.flat.schedule import RequiredValue, Step, StepItem
from derive.lowering.instances.elimination.block_system import (
    FORCE,
    KNOWN,
    Blocks,
    declared,
    spaced,
    spare_reactions,
)
from derive.lowering.instances.elimination.graph_elimination import in_graph
from derive.lowering.instances.elimination.joined_classes import written_too_much
from derive.lowering.instances.elimination.path_elimination import along_path
from derive.lowering.instances.elimination.proximal_elimination import with_proximal_term
from derive.lowering.instances.functions.block_entries import block_items, joint_place, loop_targets
from derive.lowering.instances.functions.body_motions import BodyMotions
from derive.lowering.instances.functions.first_body_results import inertial_translation, reactions_of_joints
from derive.lowering.instances.functions.local_system import Right, local_system
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
    if of.of.along_first:
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
        places = loop_targets(context.blocks, of) if loops else None
        if loops and loops.groups and places:
            inner[of.name] = loops.loops(places)
            items += loops.items()
        else:
            more, targets = block_items(context, of, system)
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
            inputs.append((FORCE, joint_place(context.blocks, of, h), names_of))
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
    are_joined, along_first = any(of.of.is_joined for of in classes), any(of.of.along_first for of in classes)
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
        motions = BodyMotions(context).statements() if along_first else ()
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
        yield ForEach(INSTANCE, constant(0), constant(count), (*to.entries, *of.entries, *body))


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
