"""A spring with a damper about e3 between the sections at two markers."""

from __future__ import annotations

import sympy as sp

from derive.mechanics.multibody.forces.force_type import GeneralisedForce, Values, torque_terms
from derive.mechanics.multibody.forces.spring_type import SpringType, spring_keys
from derive.mechanics.multibody.point_motion import PointMotion, RelativeMotion
from derive.mechanics.terms import EquationOfMotion
from derive.spec.model.scene import Spring


class RotationalSpring(SpringType):
    """A torque stiffness * (relative rotation - rest) + damping * (relative angular velocity)."""

    keys = spring_keys("N m/rad", "N m s/rad", "rad")

    def generalised_force(
        self, element: Spring, points: tuple[PointMotion, ...], values: Values, rows: tuple[EquationOfMotion, ...]
    ) -> GeneralisedForce:
        """The virtual work of the torque at both ends, and the energy of the spring."""
        stiffness, damping, rest = (values[key.name] for key in self.keys)
        name, (first, second) = f"spring {element.name}", points
        angle, rate, _ = RelativeMotion(first, second).rotation
        torque = sp.expand(stiffness * (angle - rest) + damping * rate)
        terms = torque_terms(name, second, -torque, rows) + torque_terms(name, first, torque, rows)
        return GeneralisedForce(terms, (), sp.expand(stiffness * (angle - rest) ** 2) / 2, -damping * rate**2)
