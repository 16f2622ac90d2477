"""A torque about e3 at a marker that is a function of time, with its reaction at another marker."""

from __future__ import annotations

from collections.abc import Iterator

from derive.mechanics.multibody.forces.force_type import Constants, ForceType, GeneralisedForce, define, torque_terms
from derive.mechanics.multibody.point_motion import PointMotion
from derive.mechanics.multibody.time_functions import function
from derive.mechanics.symbols import element as element_symbol
from derive.mechanics.terms import EquationOfMotion, Intermediate
from derive.spec.model.scene import MarkerRef, TimeFunction, Torque


class TorqueAtMarker(ForceType[Torque]):
    """A torque; its reaction acts at a second marker, if there is one."""

    section = "torques"
    intermediates = ("torque",)

    def markers(self, element: Torque) -> tuple[MarkerRef, ...]:
        """The marker it acts at, and that of its reaction."""
        return (element.at,) if element.against is None else (element.at, element.against)

    def functions(self, element: Torque) -> Iterator[tuple[str, TimeFunction]]:
        """Its value."""
        yield "value", element.value

    def generalised_force(
        self, element: Torque, points: tuple[PointMotion, ...], constants: Constants, rows: tuple[EquationOfMotion, ...]
    ) -> GeneralisedForce:
        """The virtual work of the torque and of its reaction."""
        definitions: list[Intermediate] = []
        name = f"torque {element.name}"
        value = define(element_symbol(element.name, "torque"), function(element.value), name, definitions)
        terms = torque_terms(name, points[0], value, rows)
        for against in points[1:]:
            terms += torque_terms(name, against, -value, rows)
        return GeneralisedForce(terms, tuple(definitions))
