"""The data that the functions of a mechanism share: classes of bodies, joints and names."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import cached_property
from itertools import accumulate

from derive.algebra import fraction, sp
from derive.ir.expressions import Expr, Number, Operation, Operator, ScalarRef
from derive.ir.statements import ForEach, Statement, Work
from derive.lowering.flat.casadi_symbols import Symbols
from derive.lowering.flat.context import Input, array_input, stores
from derive.lowering.flat.schedule import Step, StepItem
from derive.lowering.flat.sensitivities import derivatives
from derive.lowering.flat.setup_constants import Constants
from derive.lowering.instances.classes.body_classes import BodyClass, body_classes, handles_of, marker_classes
from derive.lowering.instances.classes.class_equations import class_equations
from derive.lowering.instances.classes.first_body_joints import has_rows_along_first
from derive.lowering.instances.classes.gears import constraining
from derive.lowering.instances.classes.groups import Bodies, Group, force_groups
from derive.lowering.instances.classes.known_motion import KnownMotion, known_symbol
from derive.lowering.instances.classes.output_groups import output_groups
from derive.lowering.instances.classes.spatial_actions import action_groups
from derive.lowering.instances.classes.spatial_outputs import (
    output_components,
    spatial_output_groups,
    spatial_sums,
)
from derive.lowering.instances.elimination.block_system import Blocks, blocks
from derive.lowering.instances.elimination.joined_classes import joined_classes
from derive.lowering.instances.loop_code.class_code import ClassCode, Loaded, LoopCode, LoopTarget
from derive.lowering.instances.loop_code.group_code import GroupCode, group_code, spread
from derive.lowering.instances.loop_code.joint_codes import JointCodes
from derive.lowering.instances.places import Place, Places
from derive.mechanics.equations import Equations
from derive.mechanics.multibody.outputs.output_type import SumOutput
from derive.mechanics.multibody.space.mechanism import AnyMechanism, SpatialMechanism
from derive.mechanics.symbols import local
from derive.mechanics.terms import Constraint, OutputEquation
from derive.spec.model.instances import identifier, joined


class InstanceContext:
    """The data of all functions: the classes of bodies, the joints, the names of all elements, and constant arrays."""

    def __init__(self, mechanism: AnyMechanism, sensitivities: bool = False, proximal: bool = False) -> None:
        """proximal: whether redundant constraints have multipliers of least norm, see `derive.lowering.proximal`."""
        self.mechanism, self.proximal = mechanism, proximal
        self.places, self.constants = Places(), Constants(frozenset())
        self.known = KnownMotion(mechanism)
        self.constants.coefficients |= self.known.context.constants.coefficients
        self.known.context.constants = self.constants
        self.classes = [self._class(of) for of in body_classes(mechanism)]
        rows = [of.multipliers for of in constraining(mechanism)]
        self.first_rows = [0, *accumulate(rows)]
        handles, gears = handles_of(m for c in self.classes for m in c.of.members)
        self.blocks: Blocks | None = blocks(rows, handles, gears) if rows else None
        self.classes_in_lanes = self._joined()
        self.marker_classes = {
            name: self._class(of, f"markers_{name}") for name, of in marker_classes(mechanism).items()
        }
        bodies = Bodies(mechanism, [of.of for of in self.classes], self.known)
        in_space = isinstance(mechanism, SpatialMechanism)
        self.bodies = bodies
        forces = action_groups(bodies) if in_space else force_groups(bodies)
        self.forces = [self._group(group, equations) for group, equations in forces]
        outputs = spatial_output_groups(bodies) if in_space else output_groups(bodies)
        self.outputs = [self._group(group, equations) for group, equations in outputs]
        codes = JointCodes(bodies, self.places, self.constants)
        self.joints = codes.of(self.classes)
        in_lanes = codes.of(self.classes_in_lanes) if self.along_first else self.joints
        self.joints_in_lanes = codes.with_ground(in_lanes, self.blocks) if self.blocks else in_lanes
        self.loaded = {m.number for group in self.forces for e in group.elements for m in e.bodies}
        self.coordinates = len(mechanism.coordinates)
        self.rows = tuple(row.name for row in mechanism.rows)
        self.multipliers = tuple(c.name for c in self.conditions)
        if sensitivities:
            self.known.differentiate(by_parameters=True)
            for code in self.codes:
                for constant in derivatives(code.context.equations):
                    code.context.add_constant(constant)
        elif mechanism.scene.outputs and mechanism.scene.inputs:
            self.known.differentiate(by_parameters=False)

    def _joined(self) -> list[ClassCode]:
        """The codes of the classes after some have joined others, for which the system then has a spare place."""
        of_classes = [(code.of, code.context.equations) for code in self.classes]
        along_first = not self.proximal and has_rows_along_first(self.mechanism, of_classes, self.known)
        own = [replace(of, along_first=True) if along_first else of for of, _ in of_classes]
        classes = joined_classes(self.mechanism, own, self.blocks)
        if self.blocks and any(of.is_joined for of in classes):
            self.blocks = replace(self.blocks, has_spare=True)
        return [next((code for code in self.classes if code.of is of), None) or self._class(of) for of in classes]

    @property
    def along_first(self) -> bool:
        """Whether joints have rows along the axes of their first bodies in lanes."""
        return any(code.of.along_first for code in self.classes_in_lanes)

    def _class(self, of: BodyClass, name: str = "") -> ClassCode:
        equations = class_equations(self.mechanism, of, self.known)
        return ClassCode(of, equations, self.places, self.constants, name)

    def _group(self, group: Group, equations: Equations) -> GroupCode:
        return GroupCode(group_code(group, equations, self.known, self.places, self.constants), group)

    def is_loaded(self, of: ClassCode) -> bool:
        """Whether a force that acts between bodies acts on a body of a class."""
        return any(m.number in self.loaded for m in of.of.members)

    @property
    def codes(self) -> tuple[LoopCode, ...]:
        """All codes of loops over instances."""
        in_lanes = (group for group in self.joints_in_lanes if group not in self.joints)
        groups = (group.code for group in (*self.forces, *self.outputs, *self.joints, *in_lanes))
        joined = (of for of in self.classes_in_lanes if of not in self.classes)
        return (*self.classes, *joined, *self.marker_classes.values(), *groups)

    @cached_property
    def output_components(self) -> tuple[OutputEquation, ...]:
        """The components of all outputs in the order of the specification, without their values."""
        if isinstance(self.mechanism, SpatialMechanism):
            return output_components(self.bodies)
        units: dict[int, str] = {}
        for group in self.outputs:
            for element in group.elements:
                own = enumerate(group.code.context.equations.outputs)
                units |= {} if element.adds else {element.first + k: output.unit for k, output in own}
        result: list[OutputEquation] = []
        for output in self.mechanism.outputs:
            docs = output.type.descriptions(output.values, self.mechanism)
            for k, (label, doc) in enumerate(zip(output.type.labels, docs, strict=True)):
                unit = output.type.units[k] if isinstance(output.type, SumOutput) else units[len(result)]
                shown = joined(output.name, label)
                result.append(OutputEquation(identifier(shown), shown, unit, doc, sp.S.Zero))
        return tuple(result)

    @property
    def sums(self) -> list[tuple[int, int]]:
        """The outputs that are sums: the number of the first component of each, and how many components it has."""
        if isinstance(self.mechanism, SpatialMechanism):
            return spatial_sums(self.bodies)
        outputs = self.mechanism.outputs
        firsts = accumulate((len(output.type.labels) for output in outputs), initial=0)
        every = zip(firsts, (output.type for output in outputs), strict=False)
        return [(first, len(of.labels)) for first, of in every if isinstance(of, SumOutput)]

    @property
    def conditions(self) -> tuple[Constraint, ...]:
        """The known parts of all constraints, one joint after the other."""
        return tuple(c for of in self.known.constraints for c in of)

    def constraint(self, joint: int, row: int) -> Constraint:
        """A constraint: what is known of it, and what a varying joint adds in symbols of the first one of its group."""
        known = self.known.constraints[joint][row]
        for group in self.joints:
            if joint in group.joints:
                of = group.code.context.equations.constraints[row]
                return replace(known, position=known.position + of.position, jacobian=of.jacobian)
        return known

    def rows_of(self, of: ClassCode) -> list[Place]:
        """The place of the first constraint of the joint of each handle of a class."""
        return [
            of.place(f"row_{h}", [self.first_rows[m.handles[h].joint] for m in of.of.members])
            for h in range(len(of.rows))
        ]


def idle_rows(context: InstanceContext) -> list[tuple[int, int]]:
    """The constraints that no coordinate takes part in, as pairs of a joint and its row."""
    met = {
        (m.handles[h].joint, k)
        for of in context.classes
        for h, rows in enumerate(of.rows)
        for k, row in enumerate(rows)
        if of.context.equations.constraints[row].jacobian
        for m in of.of.members
    }
    met |= {
        (joint, k)
        for group in context.joints
        for k, condition in enumerate(group.code.context.equations.constraints)
        if condition.jacobian
        for joint in group.joints
    }
    every = ((joint, k) for joint, of in enumerate(context.known.constraints) for k in range(len(of)))
    return [row for row in every if row not in met]


def merged(of: ClassCode, array: str, rows: Iterable[Place], operator: Operator | None) -> LoopTarget:
    """The target of the constraints of a body: those of its joints, each from a place."""
    places = list(rows)
    index = [place.at(k) for place, own in zip(places, of.rows, strict=True) for k in range(len(own))]
    return LoopTarget(array, index.__getitem__, operator, tuple(entry for place in places for entry in place.entries))


def scatter(of: LoopCode, what: str, array: str, positions: list[list[int]], operator: Operator | None) -> LoopTarget:
    """The target of outputs at given positions for each member, from one first position if all are spaced alike."""
    spaced = [[p - own[0] for p in own] for own in positions if own]
    if all(own == spaced[0] for own in spaced):
        place = of.place(what, [own[0] for own in positions if own] or [0])
        offsets = spaced[0] if spaced else []
        return LoopTarget(array, lambda k: place.at(offsets[k]), operator, place.entries)
    columns = [of.place(f"{what}_{e}", [own[e] for own in positions]) for e in range(len(positions[0]))]
    return LoopTarget(array, lambda k: columns[k].at(0), operator, tuple(e for c in columns for e in c.entries))


def state(of: ClassCode, *names: str) -> list[Loaded]:
    """The places of the coordinates and velocities of a body of a class."""
    given = {"q": (of.coordinate, of.context.q), "v": (of.row, of.context.v)}
    return [(name, *given[name]) for name in names if name in given]


def given_inputs(of: LoopCode, *names: str) -> tuple[Input, ...]:
    """The arguments of these names of a body of a class, and what is known, which functions of the time have."""
    context = of.context
    inputs = {"t": context.t, "q": context.q, "v": context.v}
    return (*(inputs[name] for name in names), of.given if "t" in names else of.given_still)


def loops_of(
    context: InstanceContext,
    of_class: Callable[[ClassCode, Symbols], tuple[list[StepItem], dict[str, LoopTarget]]],
    *names: str,
) -> list[ForEach]:
    """A loop over each class with the items that it computes from the state, and from the time if `names` have t."""
    loops = []
    for of in context.classes:
        symbols = of.context.symbols(*given_inputs(of, *names))
        items, targets = of_class(of, symbols)
        if items:
            loops.append(of.loop(symbols, [Step(of.name, "", "", tuple(items))], state(of, *names), targets))
    return loops


def force_loops(context: InstanceContext, array: str) -> list[ForEach]:
    """The loops that add what forces between bodies contribute to the rows of these."""
    result = []
    for group in context.forces:
        of, ctx = group.code, group.code.context
        symbols = ctx.symbols(*given_inputs(of, "t", "q", "v"))
        inputs = group.state("q", "v")
        items = stores(array, [symbols(ctx.equations.sum_of(row.name)) for row in ctx.equations.rows])
        target = spread(of, array, group.rows, Operator.ADD)
        result.append(of.loop(symbols, [Step(of.name, "(10)", "", items)], inputs, {array: target}))
    return result


APPLIED = "applied"
"""The local array of the forces between bodies, one for each row."""


def applied_sums(context: InstanceContext) -> list[Statement]:
    """The sums of the forces between bodies, which the bodies then read."""
    loops = force_loops(context, APPLIED)
    return [Work(APPLIED, len(context.rows), cleared=True), *loops] if loops else []


def applied_forces(context: InstanceContext, of: ClassCode) -> tuple[Loaded, ...]:
    """The places of the sums of forces between bodies for a body of a class; none if no such force acts on it."""
    if not context.is_loaded(of):
        return ()
    symbols = (local(f"{APPLIED}_{name}") for name in of.context.rows)
    return ((APPLIED, of.row, array_input(APPLIED, symbols, "")),)


def known_value(part: str, constraint: Constraint, sign: int = 1) -> Expr | None:
    """The known part of a constraint, with a sign; None if it is zero."""
    value = getattr(constraint, part)
    if value == 0:
        return None
    if value.is_Rational:
        return Number(sign * fraction(value))
    name = ScalarRef(str(known_symbol(part, constraint)))
    return name if sign > 0 else Operation(Operator.NEG, (name,))
