"""A force at a marker, whose components are functions of time in the inertial frame or in that of the section there."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from derive.algebra import sp
from derive.mechanics.multibody.forces.force_type import (
    ForceType,
    GeneralisedForce,
    Values,
    define,
    force_terms,
    section_rotation,
)
from derive.mechanics.symbols import element as element_symbol
from derive.spec.model.forces import Force
from derive.spec.model.keys import value_keys
from derive.spec.model.markers import MarkerRef

if TYPE_CHECKING:
    from derive.mechanics.multibody.point_motion import PointMotion
    from derive.mechanics.terms import EquationOfMotion, Intermediate


class ForceAtMarker(ForceType[Force]):
    """A force at a marker without reaction. In the frame of the body it is a follower force, which has no potential."""

    section = "forces"
    doc = "with given components"
    keys = value_keys(Force)
    intermediates = ("1", "2", "cos", "sin")

    def generalised_force(
        self, element: Force, points: tuple[PointMotion, ...], values: Values, rows: tuple[EquationOfMotion, ...]
    ) -> GeneralisedForce:
        """The virtual work of both components of the force."""
        definitions: list[Intermediate] = []
        (at,), name, components = points, f"force {element.name}", []
        for k, component in enumerate(values["components"], 1):
            symbol = element_symbol(element.name, "", k)
            axis = f"e{k}" if element.frame == "inertial" else f"axis {k} of the section"
            components.append(define(symbol, component, f"{name} along {axis}", definitions))
        force = sp.Matrix(components)
        if element.frame == "body":
            force = section_rotation(element.name, name, at, definitions) * force
        return GeneralisedForce(force_terms(name, at, force, rows), tuple(definitions))

    def element(self, name: str, kind: str, markers: tuple[MarkerRef, ...], values: Mapping[str, Any]) -> Force:
        """Return the force as an element of a scene."""
        (at,) = markers
        return Force(name, at, values["components"], values["frame"])
