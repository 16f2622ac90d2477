"""The known motions of a mechanism: the ground, bodies whose motion is prescribed, and drives."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import casadi as ca

from derive.algebra import fraction, sp
from derive.ir.expressions import Expr, Number, ScalarRef
from derive.ir.statements import Let, Statement, Store
from derive.lowering.flat.casadi_symbols import Symbols
from derive.lowering.flat.context import Context, Input, array_input
from derive.lowering.flat.schedule import OutputValue, Step
from derive.lowering.flat.sensitivities import by_parameters_and_inputs, derivatives
from derive.lowering.instances.classes.dimension import AnyJoint, dimension_of
from derive.lowering.instances.classes.gears import gears_of
from derive.lowering.instances.classes.varying_joints import prescribed_alone, varies
from derive.mechanics.equations import Equations
from derive.mechanics.fixed_symbols import t
from derive.mechanics.multibody.gathering import functions_of_time
from derive.mechanics.multibody.instances import InstanceEquations, instance_equations
from derive.mechanics.multibody.ports import input_symbols
from derive.mechanics.multibody.space.mechanism import AnyMechanism
from derive.mechanics.symbols import local
from derive.mechanics.terms import Constraint, Intermediate, ModelConstant
from derive.spec.model.instances import identifier
from derive.spec.model.markers import GROUND, MarkerRef
from derive.spec.model.scene_functions import splines

PARTS = ("position", "rate", "bias")


@dataclass(frozen=True)
class KnownDerivatives:
    """Derivatives of what is known with respect to parameters and inputs, besides zeros.

    columns: for each symbol the numbers of the parameters and inputs that it depends on, and the symbols of its
    derivatives; values: these by their names, in terms of `symbols`.
    """

    columns: Mapping[sp.Symbol, Mapping[int, sp.Symbol]]
    values: Mapping[str, ca.SX]
    symbols: Symbols | None = None


class KnownMotion:
    """The motions that are functions of the time and of inputs, with the code that computes them.

    bodies: the equations of the bodies without coordinates; constraints: what is known of the constraints of each
    joint, where bodies with coordinates are at rest in 0; moving: all symbols that depend on the time; derivatives:
    those with respect to parameters and inputs, once there are any.
    """

    def __init__(self, mechanism: AnyMechanism) -> None:
        self.mechanism, self.still = mechanism, dimension_of(mechanism).still
        by_name = {instance.name: instance for instance in mechanism.instances if not instance.moves}
        self.bodies: Mapping[str, InstanceEquations] = {
            name: instance_equations(by_name[name], mechanism.kinds[by_name[name].kind], False)
            for name in mechanism.order
            if name in by_name
        }
        definitions = [*mechanism.definitions, *(d for body in self.bodies.values() for d in body.definitions)]
        self.constraints: list[tuple[Constraint, ...]] = []
        for joint in mechanism.joints:
            defined, conditions = self._known_part(joint)
            self.constraints.append(conditions)
            definitions += [*defined, *_named(conditions)]
        for gear in gears_of(mechanism):
            self.constraints.append((gear.known_part(self.point),))
            definitions += _named(self.constraints[-1])
        self._potentials: list[Intermediate] = []
        for force in mechanism.forces:
            if all(map(self.is_known, force.markers)):
                defined, potential = self._stored(force)
                self._potentials.append(potential)
                definitions += [] if potential.expr.is_Rational else [*defined, potential]
        for name in self.bodies:
            definitions += [d for d in self._pose_definitions(name) if not d.expr.is_Rational]
        self.definitions = tuple(definitions)
        self.derivatives = KnownDerivatives({}, {})

    def differentiate(self, by_parameters: bool) -> None:
        """Compute the derivatives of what is known by the inputs, and by the parameters, for kernels that follow."""
        self.derivatives = _derivatives(self.context, [d.symbol for d in self.definitions], by_parameters)

    def _known_part(self, joint: AnyJoint) -> tuple[tuple[Intermediate, ...], tuple[Constraint, ...]]:
        """The definitions and the known parts of the constraints of a joint."""
        markers = joint.joint.first, joint.joint.second
        if varies(joint) and not all(map(self.is_known, markers)):
            return (), prescribed_alone(joint)
        first, second = map(self.point, markers)
        return joint.constraints(first, second, joint.drive, ())

    def _stored(self, force: Any) -> tuple[tuple[Intermediate, ...], Intermediate]:
        """The definitions of a force between markers whose motion is known, and the energy that it stores."""
        name = force.element.name
        made = self.mechanism.loads(force, self.point, ())
        symbol, doc = local(identifier("potential", name)), f"energy that {name} stores"
        return made.definitions, Intermediate(symbol, made.potential, name, "(22)", doc)

    @property
    def potentials(self) -> list[Expr]:
        """The energies of forces between markers whose motion is known, besides zeros and those of moving ones."""
        return [_value(d) for d in self._potentials if d.expr != 0 and d.symbol not in self.moving]

    def is_known(self, marker: MarkerRef) -> bool:
        """Whether the motion of a marker is known."""
        return marker.body == GROUND or marker.body in self.bodies

    def point(self, marker: MarkerRef) -> Any:
        """The motion of a marker if it is known, else that of a point at rest in 0."""
        if marker.body == GROUND:
            return self.mechanism.ground[marker.marker]
        return self.bodies[marker.body].motions[marker.marker] if marker.body in self.bodies else self.still

    def pose(self, body: str) -> tuple[Expr, ...]:
        """The position and the rotation of the frame of a body without coordinates, as numbers or known symbols."""
        return tuple(_value(d) for d in self._pose_definitions(body))

    def _pose_definitions(self, body: str) -> list[Intermediate]:
        """The definitions of the pose of a body without coordinates."""
        parts = self.mechanism.pose(body, self.bodies[body]).parts
        return [
            Intermediate(local(identifier("pose", body, what)), e, body, "(1)", f"{what} of {body}")
            for what, e in parts
        ]

    @cached_property
    def symbols(self) -> frozenset[sp.Symbol]:
        """The symbols that the definitions define."""
        return frozenset(d.symbol for d in self.definitions)

    @cached_property
    def moving(self) -> frozenset[sp.Symbol]:
        """The symbols that depend on the time or on inputs."""
        return self.moving_with(self.definitions) & self.symbols

    def moving_with(self, definitions: Iterable[Intermediate]) -> frozenset[sp.Symbol]:
        """All symbols that depend on the time or on inputs, also through some definitions."""
        varying = {t, *(given.symbol for given in input_symbols(self.mechanism.scene))}
        return moving_symbols((*self.definitions, *definitions), varying)

    @cached_property
    def context(self) -> Context:
        """The context of the code that computes what is known."""
        of_bodies = (c for body in self.bodies.values() for c in body.coefficients)
        coefficients = {c.symbol: c for c in (*self.mechanism.constants, *of_bodies)}
        return Context(
            Equations(
                name=self.mechanism.scene.name,
                doc="",
                frame_doc="",
                coordinates=(),
                rows=(),
                rates=(),
                parameters=self.mechanism.parameters,
                coefficients=canonical(tuple(coefficients.values()), self.mechanism),
                definitions=self.definitions,
                terms=(),
                vanished=(),
                kinetic_energy=sp.S.Zero,
                strain_energy=sp.S.Zero,
                weight_energy=None,
                linear_momentum=(),
                angular_momentum=(),
                markers=(),
                inputs=input_symbols(self.mechanism.scene),
                splines=splines(functions_of_time(self.mechanism.scene)),
            )
        )

    @property
    def names(self) -> frozenset[str]:
        """The names of the definitions and of their derivatives."""
        return frozenset((*map(str, self.symbols), *self.derivatives.values))

    def derivatives_of(self, symbols: Iterable[sp.Symbol]) -> Input:
        """The derivatives of some symbols of what is known, as the elements of an argument."""
        columns = (self.derivatives.columns.get(symbol, {}) for symbol in symbols)
        return array_input("known", (derivative for of in columns for derivative in of.values()), "")

    def by_inputs(self, symbol: sp.Symbol) -> list[tuple[int, sp.Symbol]]:
        """The numbers of the inputs that a symbol depends on, and the symbols of its derivatives."""
        parameters = len(self.mechanism.parameters)
        columns = self.derivatives.columns.get(symbol, {})
        return [(j - parameters, derivative) for j, derivative in columns.items() if j >= parameters]

    def statements(self, names: Iterable[str]) -> tuple[Statement, ...]:
        """The statements that compute some of the definitions and of their derivatives, by their names."""
        wanted = sorted(set(names))
        if not wanted:
            return ()
        symbols = self.derivatives.symbols or self.context.symbols(self.context.t)
        values = {str(symbol): symbols.values[symbol] for symbol in self.symbols if symbol in symbols.values}
        values |= self.derivatives.values
        items = tuple(OutputValue("known", k, values[name]) for k, name in enumerate(wanted))
        result: list[Statement] = []
        for section in self.context.sections(symbols, Step("known", "", "", items)):
            for statement in section.body:
                if not isinstance(statement, Store):
                    result.append(statement)
                elif statement.expr != ScalarRef(wanted[statement.index]):
                    result.append(Let(wanted[statement.index], statement.expr))
        return tuple(result)


def _derivatives(context: Context, of: Iterable[sp.Symbol], by_parameters: bool) -> KnownDerivatives:
    """The derivatives of some definitions, with the derivatives of their constants as constants of setup."""
    for constant in derivatives(context.equations) if by_parameters else ():
        context.add_constant(constant)
    symbols = context.symbols(context.t)
    known = [symbol for symbol in of if symbol in symbols.values]
    names = [*(p.symbol for p in context.equations.parameters), *context.u.symbols]
    columns: dict[sp.Symbol, dict[int, sp.Symbol]] = {}
    values: dict[str, ca.SX] = {}
    if known and names:
        matrix = by_parameters_and_inputs(context, symbols, symbols.values_of(known))
        for i, j in sorted(zip(*matrix.sparsity().get_triplet(), strict=True)):
            symbol = local(f"{known[i]}_by_{names[j]}")
            columns.setdefault(known[i], {})[j] = symbol
            values[str(symbol)] = matrix[i, j]
    return KnownDerivatives(columns, values, symbols)


def moving_symbols(definitions: Iterable[Intermediate], moving: Iterable[sp.Symbol]) -> frozenset[sp.Symbol]:
    """Some symbols that vary, with those that definitions make of them."""
    result = set(moving)
    for d in definitions:
        if d.expr.free_symbols & result:
            result.add(d.symbol)
    return frozenset(result)


def known_symbol(part: str, constraint: Constraint) -> sp.Symbol:
    """The symbol of a known part of a constraint that varies."""
    return local(f"known_{part}_{constraint.name}")


def _value(d: Intermediate) -> Expr:
    number = d.expr
    return Number(fraction(number)) if number.is_Rational else ScalarRef(str(d.symbol))


def _named(conditions: Iterable[Constraint]) -> list[Intermediate]:
    """The definitions of the known parts of constraints that are no numbers."""
    result = []
    for condition in conditions:
        for part in PARTS:
            value = getattr(condition, part)
            if not value.is_Rational:
                symbol = known_symbol(part, condition)
                result.append(Intermediate(symbol, value, condition.of, "(1)", f"known {part} of {condition.name}"))
    return result


def canonical(constants: tuple[ModelConstant, ...], mechanism: AnyMechanism) -> tuple[ModelConstant, ...]:
    """The constants with one symbol for each parameter, whatever its assumptions."""
    symbols = {p.symbol.name: p.symbol for p in mechanism.parameters}

    def value(c: ModelConstant) -> sp.Expr:
        return c.value.xreplace({s: symbols[s.name] for s in c.value.free_symbols if s.name in symbols})

    return tuple(replace(c, value=value(c)) for c in constants)
