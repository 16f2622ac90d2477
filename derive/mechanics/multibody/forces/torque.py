"""A torque about e3 at a marker that is a function of time, with its reaction at another marker."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from derive.mechanics.multibody.forces.force_type import ForceType, GeneralisedForce, Values, define, torque_terms
from derive.mechanics.symbols import element as element_symbol
from derive.spec.model.forces import Torque
from derive.spec.model.keys import value_keys
from derive.spec.model.markers import MarkerRef

if TYPE_CHECKING:
    from derive.mechanics.multibody.point_motion import PointMotion
    from derive.mechanics.terms import EquationOfMotion, Intermediate


class TorqueAtMarker(ForceType[Torque]):
    """A torque about e3 at a marker; its reaction acts at a second marker, if there is one."""

    section = "torques"
    doc = "with a given value"
    keys = value_keys(Torque)
    intermediates = ("torque",)

    def generalised_force(
        self, element: Torque, points: tuple[PointMotion, ...], values: Values, rows: tuple[EquationOfMotion, ...]
    ) -> GeneralisedForce:
        """The virtual work of the torque and of its reaction."""
        definitions: list[Intermediate] = []
        name = f"torque {element.name}"
        torque = define(element_symbol(element.name, "torque"), values["value"], name, definitions)
        terms = torque_terms(name, points[0], torque, rows)
        for against in points[1:]:
            terms += torque_terms(name, against, -torque, rows)
        return GeneralisedForce(terms, tuple(definitions))

    def element(self, name: str, kind: str, markers: tuple[MarkerRef, ...], values: Mapping[str, Any]) -> Torque:
        """Return the torque as an element of a scene."""
        at, *against = markers
        return Torque(name, at, values["value"], *against)
