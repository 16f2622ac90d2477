"""A bushing: linear springs with dampers along both axes of the section at a marker, and about e3."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from derive.algebra import sp
from derive.mechanics.multibody.forces.force_type import (
    ForceType,
    GeneralisedForce,
    Values,
    force_terms,
    intermediate,
    section_rotation,
    torque_terms,
)
from derive.mechanics.symbols import element as element_symbol
from derive.mechanics.terms import EquationOfMotion, Intermediate
from derive.spec.model.forces import Bushing
from derive.spec.model.keys import value_keys
from derive.spec.model.markers import MarkerRef

if TYPE_CHECKING:
    from derive.mechanics.multibody.point_motion import PointMotion


class BushingForce(ForceType[Bushing]):
    """Forces stiffness * (displacement - rest) + damping * (rate) for each of the three relative motions."""

    section = "springs"
    doc = "along both axes of the frame of the first marker, and about e3"
    keys = value_keys(Bushing)
    intermediates = ("cos", "sin", "apart_1", "apart_2", "x", "y", "force_x", "force_y")

    def generalised_force(
        self, element: Bushing, points: tuple[PointMotion, ...], values: Values, rows: tuple[EquationOfMotion, ...]
    ) -> GeneralisedForce:
        """The virtual work of the forces on the displacements in the frame of the first marker.

        With d = Q1^T (x2 - x1) the virtual work -F . delta d is that of -Q1 F at the second marker, of Q1 F at the
        first, and of the torque (x2 - x1) x Q1 F there, since the axes rotate with the first section.
        """
        from derive.mechanics.multibody.point_motion import RelativeMotion

        name, (first, second), definitions = f"spring {element.name}", points, list[Intermediate]()
        relative = RelativeMotion(first, second)

        def define(expr: sp.Expr, doc: str, what: str, *components: int) -> sp.Expr:
            symbol = element_symbol(element.name, what, *components)
            return intermediate(symbol, expr, element.name, f"{doc} of {name}", definitions)

        rotation = section_rotation(element.name, name, first, definitions)
        displacement, rate, _ = relative.displacement
        apart = sp.Matrix(
            [define(sp.expand(displacement[k]), f"vector along e{k + 1}", "apart", k + 1) for k in (0, 1)]
        )
        along = sp.Matrix([define((rotation.T * apart)[k], "displacement", axis) for k, axis in enumerate("xy")])
        spin = first.angular_velocity * sp.Matrix([along[1], -along[0]])
        speed = rotation.T * sp.Matrix(rate) + spin
        forces, potential, dissipation = [], sp.S.Zero, sp.S.Zero
        for k, axis in enumerate("xy"):
            stiffness, damping, rest = (values[f"{what}_{axis}"] for what in ("stiffness", "damping", "rest"))
            extension = along[k] - rest
            forces.append(define(stiffness * extension + damping * speed[k], f"force along {axis}", f"force_{axis}"))
            potential += sp.expand(stiffness * extension**2) / 2
            dissipation -= damping * speed[k] ** 2
        force = rotation * sp.Matrix(forces)
        moment = along[0] * forces[1] - along[1] * forces[0]
        stiffness, damping, rest = (values[f"{what}_rotation"] for what in ("stiffness", "damping", "rest"))
        angle, angular_rate, _ = relative.rotation
        torque = sp.expand(stiffness * (angle - rest) + damping * angular_rate)
        terms = force_terms(name, second, -force, rows) + force_terms(name, first, force, rows)
        terms += torque_terms(name, second, -torque, rows) + torque_terms(name, first, torque + moment, rows)
        potential += sp.expand(stiffness * (angle - rest) ** 2) / 2
        dissipation -= damping * angular_rate**2
        return GeneralisedForce(terms, tuple(definitions), potential, dissipation)

    def element(self, name: str, kind: str, markers: tuple[MarkerRef, ...], values: Mapping[str, Any]) -> Bushing:
        """Return the bushing as an element of a scene."""
        first, second = markers
        return Bushing(name, first, second, **values)
