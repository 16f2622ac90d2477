"""A spring with a damper about e3 between the sections at two markers."""

from __future__ import annotations

from typing import ClassVar

import sympy as sp

from derive.mechanics.multibody.forces.force_type import Constants, GeneralisedForce, SpringType, torque_terms
from derive.mechanics.multibody.point_motion import PointMotion, RelativeMotion
from derive.mechanics.terms import EquationOfMotion
from derive.spec.model.scene import Spring


class RotationalSpring(SpringType):
    """A torque stiffness * (relative rotation - rest) + damping * (relative angular velocity)."""

    units: ClassVar[dict[str, str]] = {"stiffness": "N m/rad", "damping": "N m s/rad", "rest": "rad"}
    intermediates = ()

    def generalised_force(
        self, element: Spring, points: tuple[PointMotion, ...], constants: Constants, rows: tuple[EquationOfMotion, ...]
    ) -> GeneralisedForce:
        """The virtual work of the torque at both ends, and the energy of the spring."""
        stiffness, damping, rest = (constants[key] for key in self.units)
        name, (first, second) = f"spring {element.name}", points
        angle, rate, _ = RelativeMotion(first, second).rotation
        torque = sp.expand(stiffness * (angle - rest) + damping * rate)
        terms = torque_terms(name, second, -torque, rows) + torque_terms(name, first, torque, rows)
        return GeneralisedForce(terms, (), sp.expand(stiffness * (angle - rest) ** 2) / 2)
