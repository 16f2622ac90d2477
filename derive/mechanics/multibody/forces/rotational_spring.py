"""A spring with a damper about e3 between the sections at two markers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from derive.algebra import sp
from derive.mechanics.multibody.forces.force_type import GeneralisedForce, Values, define, torque_terms
from derive.mechanics.multibody.forces.spring_type import SpringType, characteristic, is_linear, spring_keys
from derive.mechanics.symbols import element as element_symbol
from derive.mechanics.terms import EquationOfMotion, Intermediate
from derive.spec.model.forces import Spring

if TYPE_CHECKING:
    from derive.mechanics.multibody.point_motion import PointMotion


class RotationalSpring(SpringType):
    """A torque characteristic(relative rotation - rest) + damping * (relative angular velocity)."""

    keys = spring_keys("N m", "rad")
    intermediates = ("twist", "moment")

    def generalised_force(
        self, element: Spring, points: tuple[PointMotion, ...], values: Values, rows: tuple[EquationOfMotion, ...]
    ) -> GeneralisedForce:
        """The virtual work of the torque at both ends, and the energy of the spring."""
        from derive.mechanics.multibody.point_motion import RelativeMotion

        stiffness, damping, rest = values["stiffness"], values["damping"], values["rest"]
        name, (first, second), definitions = f"spring {element.name}", points, list[Intermediate]()
        angle, rate, _ = RelativeMotion(first, second).rotation
        if is_linear(values):
            torque = sp.expand(stiffness * (angle - rest) + damping * rate)
            potential = sp.expand(stiffness * (angle - rest) ** 2) / 2
        else:
            twist = define(element_symbol(element.name, "twist"), angle - rest, f"extension of {name}", definitions)
            over, energy = characteristic(values, twist)
            moment = sp.expand(damping * rate) + over * twist
            torque = define(element_symbol(element.name, "moment"), moment, f"torque of {name}", definitions)
            potential = sp.expand(energy * twist**2)
        terms = torque_terms(name, second, -torque, rows) + torque_terms(name, first, torque, rows)
        return GeneralisedForce(terms, tuple(definitions), potential, -damping * rate**2)
