"""The equations of a mechanism, in the plane or in space, gathered from its instances, joints and forces."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import chain
from typing import TYPE_CHECKING

from derive.algebra import sp
from derive.display import html
from derive.errors import Problem, SpecError
from derive.mechanics.equations import Equations
from derive.mechanics.expansion import mass_matrix
from derive.mechanics.fixed_symbols import t
from derive.mechanics.multibody.instances import InstanceEquations, instance_equations
from derive.mechanics.multibody.ports import input_symbols
from derive.mechanics.prescribed_motion import drive_motion
from derive.mechanics.terms import (
    Constraint,
    Coordinate,
    Eliminated,
    EquationOfMotion,
    InputSymbol,
    Intermediate,
    MarkerEquations,
    ModelConstant,
    OutputEquation,
    ParameterSymbol,
    Pose,
    Reason,
    SpatialPose,
    Term,
)
from derive.mechanics.time_functions import tried
from derive.short_text import counted, listed, summary
from derive.spec.model.scene import Redundant
from derive.spec.model.scene_functions import splines, time_functions
from derive.spec.model.specification import AnyScene
from derive.spec.model.time_function import TimeFunction

if TYPE_CHECKING:
    from derive.mechanics.multibody.kinds import BodyInstance, BodyKind
    from derive.mechanics.multibody.space.tree.recursions import TreeBody

Instances = Mapping[str, InstanceEquations]


@dataclass(frozen=True)
class InstancesOfKinds(ABC):
    """The kinds and instances of the bodies of a scene, in the plane or in space.

    kinds: the equations of its bodies, each once; instances: its bodies in the order of the specification; order: their
    names in the order in which their definitions follow each other, since a body may follow another's motion;
    constants: parameters of drives, ground and forces; definitions: prescribed motions with names of their own;
    eliminated: what the equations need not contain.
    """

    scene: AnyScene
    kinds: tuple[BodyKind, ...]
    instances: tuple[BodyInstance, ...]
    order: tuple[str, ...]
    parameters: tuple[ParameterSymbol, ...]
    constants: tuple[ModelConstant, ...]
    definitions: tuple[Intermediate, ...]
    eliminated: tuple[Eliminated, ...]

    @property
    def coordinates(self) -> tuple[Coordinate, ...]:
        """The coordinates of all instances."""
        return tuple(c for instance in self.instances for c in instance.coordinates.coordinates)

    @property
    def rows(self) -> tuple[EquationOfMotion, ...]:
        """The equations of motion of all instances, one for each velocity."""
        return tuple(row for instance in self.instances for row in instance.coordinates.rows)

    def instance(self, name: str) -> BodyInstance:
        """An instance by its name."""
        return self.instances_by_name[name]

    @cached_property
    def instances_by_name(self) -> dict[str, BodyInstance]:
        """The instances by their names."""
        return {instance.name: instance for instance in self.instances}

    def expanded(self) -> Equations:
        """The equations of motion without reference to kinds: each instance has rows of its own.

        Raises SpecError where a constraint has no coordinate that could meet it, or where two names meet.
        """
        return self._expanded

    @cached_property
    def _expanded(self) -> Equations:
        return self._equations()

    @abstractmethod
    def pose(self, name: str, instance: InstanceEquations) -> Pose | SpatialPose:
        """The pose of the frame of an instance."""

    @abstractmethod
    def doc(self, conditions: tuple[Constraint, ...]) -> str:
        """A line that summarises what the mechanism consists of."""

    @abstractmethod
    def frame_doc(self, by_table: bool = False) -> str:
        """The description of the frames of the bodies for users of the generated code.

        by_table: one for all instances of a table.
        """

    @abstractmethod
    def _equations(self) -> Equations:
        """Derive the equations of `expanded`."""

    def equations_of_instances(self) -> Instances:
        """The equations of each instance; those of a group list the terms that vanish once."""
        result, groups = {}, set()
        for instance in self.instances:
            group = instance.component.group
            result[instance.name] = instance_equations(instance, self.kinds[instance.kind], group in groups)
            groups.add(group)
        return result

    def summary(self, what: str, lists: Mapping[str, Iterable[str]]) -> str:
        """Lines on the kinds of the instances, on lists of names, and on what is eliminated."""
        lines = [f"{what} {self.scene.name}"]
        for number, kind in enumerate(self.kinds):
            names = [instance.name for instance in self.instances if instance.kind == number]
            lines.append(f"  kind {number + 1} of body, {len(kind.motion.alpha)} shapes: {', '.join(names)}")
        lines += [f"  {title}: {', '.join(names) or 'none'}" for title, names in lists.items()]
        lines += [f"  {e.what}: {e.reason}" for e in self.eliminated]
        return "\n".join([*lines, "  the equations, one row for each velocity: print(mechanism.expanded())"])

    def __repr__(self) -> str:
        kinds = f"{counted(len(self.instances), 'body', 'bodies')} of {counted(len(self.kinds), 'kind')}"
        return summary(
            f"{type(self).__name__} {self.scene.name}: {kinds}, {counted(len(self.coordinates), 'coordinate')}",
            {
                "bodies": listed(instance.name for instance in self.instances),
                "joints": listed(joint.name for joint in self.scene.joints),
                "eliminated": listed(e.what for e in self.eliminated),
            },
        )

    _repr_html_ = html


@dataclass(frozen=True)
class Gathered:
    """The contributions to the equations of a mechanism besides those of its instances.

    doc, frame_doc: the description for users of the code; terms, potentials: those of the forces; definitions: those of
    joints and forces; coefficients: those of dampings; of_outputs: the coefficients of outputs; trees: their bodies;
    mass_zeros: zeros of M between bodies, with the reasons.
    """

    doc: str
    frame_doc: str
    conditions: tuple[Constraint, ...]
    terms: tuple[Term, ...]
    potentials: tuple[sp.Expr, ...]
    definitions: tuple[Intermediate, ...]
    outputs: tuple[OutputEquation, ...]
    poses: tuple[Pose, ...] | tuple[SpatialPose, ...]
    coefficients: tuple[ModelConstant, ...] = ()
    of_outputs: tuple[ModelConstant, ...] = ()
    trees: tuple[TreeBody, ...] = ()
    mass_zeros: tuple[tuple[str, str, Reason], ...] = ()


def equations_of_mechanism(mechanism: InstancesOfKinds, instances: Instances, of: Gathered) -> Equations:
    """The equations of motion of a mechanism. Raises SpecError where two names meet."""
    scene, rows, bodies = mechanism.scene, mechanism.rows, list(instances.values())
    in_order = [instances[name].definitions for name in mechanism.order]
    definitions = (*mechanism.definitions, *chain.from_iterable(in_order), *of.definitions)
    inputs = input_symbols(scene)
    moving = moving_symbols(definitions, inputs)
    own = (*(b.coefficients for b in bodies), of.coefficients)
    coefficients = (*constants_of_scene(mechanism.parameters, mechanism.constants, own), *of.of_outputs)
    refuse_equal_names(rows, of.conditions, coefficients, definitions)

    def summed(expressions: Iterable[sp.Expr]) -> sp.Expr:
        """The sum of the expressions without explicit time dependence; a prescribed motion supplies energy."""
        return sp.Add(*(e for e in expressions if not e.free_symbols & moving))

    def total(vectors: Sequence[tuple[sp.Expr, ...]]) -> tuple[sp.Expr, ...]:
        """The sum of the vectors of the bodies that coordinates move."""
        own = [vector if b.moved_by else (sp.S.Zero,) * len(vector) for b, vector in zip(bodies, vectors, strict=True)]
        return tuple(map(summed, zip(*own, strict=True)))

    def of_unmoved(vectors: Sequence[tuple[sp.Expr, ...]]) -> tuple[sp.Expr, ...]:
        """The same without the bodies that a drive moves, so that all of these sums are of the same bodies."""
        own = [v if not _of_time(b, moving) else (sp.S.Zero,) * len(v) for b, v in zip(bodies, vectors, strict=True)]
        return total(own)

    terms = (*chain.from_iterable(b.terms for b in bodies), *of.terms)
    kinetic, strain, weight = total([b.energies for b in bodies])
    number = {row.name: i for i, row in enumerate(rows)}
    return Equations(
        name=scene.name,
        doc=of.doc,
        frame_doc=of.frame_doc,
        coordinates=mechanism.coordinates,
        rows=rows,
        rates=tuple(rate for b in bodies for rate in b.rates),
        parameters=mechanism.parameters,
        splines=splines(functions_of_time(scene)),
        coefficients=coefficients,
        definitions=definitions,
        terms=terms,
        vanished=tuple(v for b in bodies for v in b.vanished),
        mass=mass_matrix(rows, terms),
        mass_zeros=tuple(_zeros(chain(*(b.mass_zeros for b in bodies), of.mass_zeros), number)),
        kinetic_energy=kinetic,
        strain_energy=strain + summed(of.potentials),
        weight_energy=weight if scene.gravity else None,
        linear_momentum=of_unmoved([b.linear for b in bodies]),
        angular_momentum=of_unmoved([b.angular for b in bodies]),
        mass_moments=of_unmoved([b.mass_moments for b in bodies]),
        markers=tuple(m for m in markers_of_scene(bodies, rows) if not depends(m.definitions, m.position, moving)),
        constraints=of.conditions,
        inputs=inputs,
        outputs=of.outputs,
        poses=of.poses,
        trees=of.trees,
        eliminated=(*mechanism.eliminated, *carried(instances, moving)),
    )


def _zeros(named: Iterable[tuple[str, str, Reason]], number: Mapping[str, int]) -> Iterator[tuple[int, int, Reason]]:
    """Zeros of the mass matrix by the numbers of their rows, in the lower triangle."""
    for first, second, why in named:
        i, j = sorted((number[first], number[second]), reverse=True)
        yield i, j, why


INSTANTS = (sp.S.Zero, sp.Rational(5, 11), sp.Rational(-13, 9), sp.Rational(17, 3))
"""Times (s) and values of inputs at which a constraint without coordinates is tried; one met there always is."""
MET = sp.Rational(1, 10**10)
"""A constraint that no coordinate takes part in is met if it is off by at most this (m or rad): numbers are rounded."""


def refuse_idle(
    conditions: tuple[Constraint, ...], redundant: Redundant, known: Sequence[tuple[sp.Symbol, sp.Expr]] = ()
) -> None:
    """Raise SpecError for the constraints that no coordinate takes part in; redundant ones may be accepted.

    known: symbols in their positions with their values, each in terms of those before it; coordinates may have any.
    """
    prescribed = (
        "no coordinate can meet it, since the motion of both bodies is prescribed; leave out a drive or a joint"
    )
    implied = "this constraint is redundant: other joints and drives meet it in every state; leave out one of them"
    problems = []
    for c in (c for c in conditions if not c.jacobian):
        size, constant = _largest(c.position, known)
        key = f"{c.section}.{c.of}"
        if size > MET:
            off = f"it is off by {float(size):.3g}, and " if constant else ""
            problems.append(Problem(key, f"{c.doc}: {off}{prescribed}"))
        elif redundant == "error":
            problems.append(Problem(key, f"{c.doc}: {implied}"))
    if problems:
        raise SpecError(tuple(problems))


def _largest(position: sp.Expr, known: Sequence[tuple[sp.Symbol, sp.Expr]]) -> tuple[sp.Expr, bool]:
    """The largest size of the position of a constraint at some times and values of inputs; whether it is constant."""
    for symbol, value in reversed(known):
        position = position.xreplace({symbol: value})
    symbols = sorted(position.free_symbols, key=str)
    sizes = []
    for start in INSTANTS:
        values = {symbol: start + sp.Rational(k, 7) for k, symbol in enumerate(symbols)}
        value = sp.N(tried(position.xreplace(values)))
        sizes.append(abs(value) if value.is_Float or value.is_Rational else sp.oo)
    return max(sizes), not symbols


def functions_of_time(scene: AnyScene) -> Iterator[TimeFunction]:
    """The functions of time that the equations contain: those that are written, and the integrals of speeds."""
    yield from (function for _, function in time_functions(scene))
    yield from map(drive_motion, scene.drives)


def carried(instances: Instances, moving: frozenset[sp.Symbol]) -> list[Eliminated]:
    """The bodies whose pose depends on a prescribed motion, which functions without the argument t cannot describe."""
    reason = "a drive moves it, and these functions do not depend on time"
    names = [name for name, instance in instances.items() if instance.moved_by and _of_time(instance, moving)]
    return [Eliminated(f"{name} in energy, momentum and markers", reason) for name in names]


def constants_of_scene(
    parameters: tuple[ParameterSymbol, ...],
    constants: tuple[ModelConstant, ...],
    of_bodies: Iterable[tuple[ModelConstant, ...]],
) -> tuple[ModelConstant, ...]:
    """The constants of a mechanism, each once, where each parameter is one symbol whatever its assumptions."""
    canonical = {p.symbol.name: p.symbol for p in parameters}
    result: dict[sp.Symbol, ModelConstant] = {}
    for c in chain(constants, *of_bodies):
        known = {s: canonical[s.name] for s in c.value.free_symbols if s.name in canonical}
        result.setdefault(c.symbol, replace(c, value=c.value.xreplace(known)))
    return tuple(result.values())


def refuse_equal_names(
    rows: tuple[EquationOfMotion, ...],
    conditions: tuple[Constraint, ...],
    coefficients: tuple[ModelConstant, ...],
    definitions: tuple[Intermediate, ...],
) -> None:
    """Raise SpecError if two composed names coincide, so that one of the two parts must be renamed."""
    names = [str(s) for row in rows for s in (row.name, row.v, row.a)]
    names += [c.name for c in conditions] + [str(c.symbol) for c in coefficients] + [str(d.symbol) for d in definitions]
    twice = sorted(name for name, count in Counter(names).items() if count > 1)
    if twice:
        text = f"two things of this scene would be called {', '.join(twice)} in the code; give one another name"
        raise SpecError((Problem("bodies", text),))


def moving_symbols(definitions: tuple[Intermediate, ...], inputs: tuple[InputSymbol, ...]) -> frozenset[sp.Symbol]:
    """The time, the inputs, and all symbols that depend on them."""
    moving = {t, *(given.symbol for given in inputs)}
    for d in definitions:
        if d.expr.free_symbols & moving:
            moving.add(d.symbol)
    return frozenset(moving)


def depends(definitions: tuple[Intermediate, ...], position: sp.ImmutableMatrix, moving: frozenset[sp.Symbol]) -> bool:
    """Whether a marker depends on the time, which functions of markers do not get as an argument."""
    every = (position.free_symbols, *(d.expr.free_symbols for d in definitions))
    return any(symbols & moving for symbols in every)


def markers_of_scene(
    bodies: Iterable[InstanceEquations], rows: Sequence[EquationOfMotion]
) -> Iterator[MarkerEquations]:
    """The markers of all bodies, with a column and an entry of the load for each row of the scene."""
    number = {row.name: i for i, row in enumerate(rows)}
    for body in bodies:
        columns = [number[row.name] for row in body.moved_by]
        for m in body.markers:
            size = m.jacobian.rows
            jacobian, load = sp.zeros(size, len(rows)), [sp.S.Zero] * len(rows)
            for own, column in enumerate(columns):
                jacobian[:, column] = m.jacobian[:, own]
                load[column] = m.load[own]
            yield replace(m, jacobian=sp.ImmutableMatrix(jacobian), load=tuple(load))


def _of_time(body: InstanceEquations, moving: frozenset[sp.Symbol]) -> bool:
    """Whether energy or momentum of a body depend on time explicitly, because a drive prescribes its support."""
    return any(e.free_symbols & moving for e in (*body.energies, *body.linear, *body.angular))
