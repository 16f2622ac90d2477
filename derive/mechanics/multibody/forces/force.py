"""A force at a marker, with components in the inertial frame that are functions of time."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import sympy as sp

from derive.mechanics.multibody.forces.force_type import ForceType, GeneralisedForce, Values, define, force_terms
from derive.mechanics.multibody.keys import Key, KeyType
from derive.mechanics.multibody.point_motion import PointMotion
from derive.mechanics.symbols import element as element_symbol
from derive.mechanics.terms import EquationOfMotion, Intermediate
from derive.spec.model.scene import Force, MarkerRef


class ForceAtMarker(ForceType[Force]):
    """A force; it has no reaction."""

    section = "forces"
    doc = "with given components"
    keys = (
        Key(
            "components",
            KeyType.FUNCTION_PAIR,
            "N",
            "Components in the inertial frame, N: numbers, or functions of t.",
            required=True,
        ),
    )
    intermediates = ("1", "2")

    def generalised_force(
        self, element: Force, points: tuple[PointMotion, ...], values: Values, rows: tuple[EquationOfMotion, ...]
    ) -> GeneralisedForce:
        """The virtual work of both components."""
        definitions: list[Intermediate] = []
        name, components = f"force {element.name}", []
        for k, component in enumerate(values["components"], 1):
            symbol = element_symbol(element.name, "", k)
            components.append(define(symbol, component, f"{name} along e{k}", definitions))
        return GeneralisedForce(force_terms(name, points[0], sp.Matrix(components), rows), tuple(definitions))

    def element(self, name: str, kind: str, markers: tuple[MarkerRef, ...], values: Mapping[str, Any]) -> Force:
        """The force."""
        (at,) = markers
        return Force(name, at, values["components"])
