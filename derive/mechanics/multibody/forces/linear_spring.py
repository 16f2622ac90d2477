"""A spring with a damper along the line between two markers."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from derive.algebra import sp
from derive.mechanics.multibody.forces.force_type import GeneralisedForce, Values, force_terms, intermediate
from derive.mechanics.multibody.forces.spring_type import SpringType, characteristic, is_linear, spring_keys
from derive.mechanics.symbols import element as element_symbol
from derive.mechanics.terms import EquationOfMotion, Intermediate
from derive.spec.model.forces import Spring

if TYPE_CHECKING:
    from derive.mechanics.multibody.point_motion import PointMotion


class LinearSpring(SpringType):
    """A tension characteristic(length - rest) + damping * (rate of the length)."""

    doc = "along the line between the markers"
    keys = spring_keys("N", "m")
    lengths = ("rest",)
    along_line = True
    intermediates = ("apart_1", "apart_2", "length", "extension", "rate", "pull")

    def generalised_force(
        self, element: Spring, points: tuple[PointMotion, ...], values: Values, rows: tuple[EquationOfMotion, ...]
    ) -> GeneralisedForce:
        """The virtual work of the tension at both ends, and the energy of the spring."""
        from derive.mechanics.motion.vectors import length_of
        from derive.mechanics.multibody.point_motion import RelativeMotion

        stiffness, damping, rest = values["stiffness"], values["damping"], values["rest"]
        name, (first, second), definitions = f"spring {element.name}", points, list[Intermediate]()
        displacement, rate_of_displacement, _ = RelativeMotion(first, second).displacement
        dissipation = sp.S.Zero

        def define(expr: sp.Expr, doc: str, what: str, *components: int) -> sp.Expr:
            symbol = element_symbol(element.name, what, *components)
            return intermediate(symbol, expr, element.name, f"{doc} of {name}", definitions)

        vector = sp.Matrix(
            [define(sp.expand(displacement[k]), f"vector along e{k + 1}", "apart", k + 1) for k in range(2)]
        )
        if rest == 0 and damping == 0 and is_linear(values):  # without a square root
            pull, potential = stiffness * vector, stiffness * vector.dot(vector) / 2
        else:
            length = define(length_of(vector), "length", "length")
            extension = length - rest
            if is_linear(values):
                tension, potential = stiffness * extension, stiffness * extension**2 / 2
            else:
                extension = define(extension, "extension", "extension")
                over, energy = characteristic(values, extension)
                tension, potential = over * extension, energy * extension**2
            if damping != 0:
                along = sp.expand(vector.dot(rate_of_displacement)) / length
                rate = define(along, "time derivative of the length", "rate")
                tension += damping * rate
                dissipation = -damping * rate**2
            pull = define(tension / length, "tension over length", "pull") * vector
            if isinstance(length, sp.Symbol):
                coincide = f"the ends of {name} coincide"
                definitions[-1] = replace(definitions[-1], divisor=length, divisor_text=coincide)
        terms = force_terms(name, second, -pull, rows) + force_terms(name, first, pull, rows)
        return GeneralisedForce(terms, tuple(definitions), sp.expand(potential), dissipation)
