"""A force at a marker, with components in the inertial frame that are functions of time."""

from __future__ import annotations

from collections.abc import Iterator

import sympy as sp

from derive.mechanics.multibody.forces.force_type import Constants, ForceType, GeneralisedForce, define, force_terms
from derive.mechanics.multibody.point_motion import PointMotion
from derive.mechanics.multibody.time_functions import function
from derive.mechanics.symbols import element as element_symbol
from derive.mechanics.terms import EquationOfMotion, Intermediate
from derive.spec.model.scene import Force, MarkerRef, TimeFunction


class ForceAtMarker(ForceType[Force]):
    """A force; it has no reaction."""

    section = "forces"
    intermediates = ("1", "2")

    def markers(self, element: Force) -> tuple[MarkerRef, ...]:
        """The marker it acts at."""
        return (element.at,)

    def functions(self, element: Force) -> Iterator[tuple[str, TimeFunction]]:
        """Its components."""
        yield from (("components", component) for component in element.components)

    def generalised_force(
        self, element: Force, points: tuple[PointMotion, ...], constants: Constants, rows: tuple[EquationOfMotion, ...]
    ) -> GeneralisedForce:
        """The virtual work of both components."""
        definitions: list[Intermediate] = []
        name, values = f"force {element.name}", []
        for k, component in enumerate(element.components, 1):
            symbol = element_symbol(element.name, "", k)
            values.append(define(symbol, function(component), f"{name} along e{k}", definitions))
        return GeneralisedForce(force_terms(name, points[0], sp.Matrix(values), rows), tuple(definitions))
