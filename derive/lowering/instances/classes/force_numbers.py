"""The numbers in forces of one form: where such forces differ in them, they are constants of the instances."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

from derive.algebra import sp
from derive.mechanics.multibody.forces.force_type import GeneralisedForce
from derive.mechanics.multibody.instances import instance_equations
from derive.mechanics.multibody.kinds import ForceInstance
from derive.mechanics.multibody.mechanism import Mechanism
from derive.mechanics.multibody.point_motion import PointMotion
from derive.mechanics.multibody.space.mechanism import AnyMechanism, SpatialActionInstance
from derive.mechanics.symbols import local
from derive.mechanics.terms import EquationOfMotion, ModelConstant
from derive.spec.model.forces import CustomForce
from derive.spec.model.instances import identifier
from derive.spec.model.markers import GROUND, MarkerRef

Place = tuple[str, int]
"""The place of a number in a force: a key and the component of its value, or a marker's number and a component."""


@dataclass(frozen=True)
class ForceForm:
    """A force with its numbers apart.

    key: all that its code depends on, besides these; numbers: the values of keys that are not zero, and the
    coordinates of markers at rest, by their places.
    """

    force: ForceInstance
    key: Hashable
    numbers: Mapping[Place, sp.Rational]

    def differing(self, others: Iterable[ForceForm]) -> tuple[Place, ...]:
        """The places of the numbers in which some forces of the same form differ."""
        others = tuple(others)
        return tuple(place for place, value in self.numbers.items() if any(o.numbers[place] != value for o in others))

    def constants(self, places: Sequence[Place]) -> tuple[ModelConstant, ...]:
        """The numbers at some places as constants, which are named after the force."""
        name = self.force.element.name
        return tuple(
            ModelConstant(local(identifier("number", name, what), k + 1), self.numbers[what, k], "(10)", name, "")
            for what, k in places
        )

    def with_symbols(
        self, differing: Sequence[Place], at: Callable[[MarkerRef], PointMotion]
    ) -> tuple[ForceInstance, dict[MarkerRef, PointMotion]]:
        """The force with symbols for the numbers at some places, and markers at rest that have such coordinates.

        at: the motion of a marker.
        """
        symbols = {place: c.symbol for place, c in zip(differing, self.constants(differing), strict=True)}
        values = {name: _replaced(value, name, symbols) for name, value in self.force.values.items()}
        markers, new = [], dict[MarkerRef, PointMotion]()
        for n, marker in enumerate(self.force.markers):
            own = marker
            if any(what == _of_marker(n) for what, _ in differing):
                own = MarkerRef(marker.body, identifier(marker.marker, "of", self.force.element.name))
                point = at(marker)
                new[own] = replace(point, position=_replaced(point.position, _of_marker(n), symbols))
            markers.append(own)
        return replace(self.force, values=values, markers=tuple(markers)), new

    def generalised(
        self, differing: Sequence[Place], at: Callable[[MarkerRef], PointMotion], rows: tuple[EquationOfMotion, ...]
    ) -> GeneralisedForce:
        """The virtual work of the force `with_symbols`."""
        force, new = self.with_symbols(differing, at)
        points = tuple(new[marker] if marker in new else at(marker) for marker in force.markers)
        return force.type.generalised_force(force.element, points, force.values, rows)


def force_form(mechanism: Mechanism, force: ForceInstance) -> ForceForm:
    """A force with its numbers apart; the names of bodies with coordinates do not matter.

    A force of another package may compare its numbers, so that they belong to its form.
    """
    numbers: dict[Place, sp.Rational] = {}
    values = dict(force.values)
    if not isinstance(force.element, CustomForce):
        for name, value in values.items():
            numbers |= {(name, k): x for k, x in enumerate(_components(value)) if _is_number(x) and x != 0}
            values[name] = tuple(0 if x == 0 else "number" if _is_number(x) else x for x in _components(value))
    markers: list[Hashable] = []
    for n, marker in enumerate(force.markers):
        known = _known_point(mechanism, marker)
        if known is None:
            markers.append(marker.marker)
        elif known.is_still and all(map(_is_number, known.position)):
            numbers |= {(_of_marker(n), k): x for k, x in enumerate(known.position)}
            markers.append(("at rest", known.rotation))
        else:
            markers.append(marker)
    plain = tuple((k, v.as_immutable() if isinstance(v, sp.MatrixBase) else v) for k, v in values.items())
    own = ((f.name, getattr(force.element, f.name)) for f in fields(force.element) if f.name not in force.values)
    known_names = ("name", "values")  # those of a force of another package are in force.values
    others = tuple((name, value) for name, value in own if name not in known_names and not _is_marker(value))
    return ForceForm(force, (type(force.type), tuple(markers), plain, others), numbers)


def differing_places(forces: Sequence[Sequence[ForceForm]]) -> tuple[tuple[Place, ...], ...]:
    """The places of the numbers in which elements differ, for each force of the first of them."""
    return tuple(first.differing(others) for first, *others in zip(*forces, strict=True))


def differing_constants(
    forces: Sequence[ForceForm], differing: Sequence[tuple[Place, ...]]
) -> tuple[ModelConstant, ...]:
    """The numbers of some forces at some places of each as constants."""
    each = zip(forces, differing, strict=False)
    return tuple(constant for force, places in each for constant in force.constants(places))


def moving_bodies(mechanism: AnyMechanism, force: ForceInstance | SpatialActionInstance) -> tuple[str, ...]:
    """The bodies with coordinates that a force acts on."""
    return tuple({m.body: None for m in force.markers if m.body != GROUND and mechanism.instance(m.body).moves})


def _known_point(mechanism: Mechanism, marker: MarkerRef) -> PointMotion | None:
    """The motion of a marker if it is known, else None."""
    if marker.body == GROUND:
        return mechanism.ground[marker.marker]
    instance = mechanism.instance(marker.body)
    if instance.moves:
        return None
    equations = instance_equations(instance, mechanism.kinds[instance.kind], False)
    return equations.points[marker.marker].replaced({c.symbol: c.value for c in equations.coefficients})


def _of_marker(number: int) -> str:
    return f"marker_{number + 1}"


def _components(value: Any) -> Sequence[Any]:
    return list(value) if isinstance(value, sp.MatrixBase) else [value]


def _replaced(value: Any, what: str, symbols: Mapping[Place, sp.Symbol]) -> Any:
    parts = [symbols.get((what, k), x) for k, x in enumerate(_components(value))]
    return value.__class__(*value.shape, parts) if isinstance(value, sp.MatrixBase) else parts[0]


def _is_number(value: object) -> bool:
    return isinstance(value, sp.Rational)


def _is_marker(value: object) -> bool:
    return isinstance(value, MarkerRef) or (isinstance(value, tuple) and any(map(_is_marker, value)))
