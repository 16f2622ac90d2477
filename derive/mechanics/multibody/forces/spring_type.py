"""The base of the springs with dampers of this package: their keys and their polynomial characteristic."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

import sympy as sp

from derive.mechanics.multibody.forces.force_type import ForceType, Values
from derive.spec.model.forces import Spring
from derive.spec.model.keys import Key, KeyType
from derive.spec.model.markers import MarkerRef

POWERS = {"quadratic": 2, "cubic": 3, "quartic": 4, "quintic": 5}
"""The keys of the coefficients of the characteristic beyond the stiffness, with the powers of the extension."""


def spring_keys(force: str, length: str) -> tuple[Key, ...]:
    """The keys of a spring with a damper; the arguments are the units of its force and of its length."""
    positive, signed, zero = KeyType.NOT_NEGATIVE_QUANTITY, KeyType.QUANTITY, Fraction(0)
    of_rest = "Length, m, or angle, rad, at which the spring exerts no force."
    higher = (
        Key(
            name,
            signed,
            f"{force}/{length}^{power}",
            f"Coefficient of power {power} of the extension in the characteristic, N/m^{power} or N m/rad^{power}.",
            default=zero,
        )
        for name, power in POWERS.items()
    )
    return (
        Key("stiffness", positive, f"{force}/{length}", "Stiffness, N/m or N m/rad.", required=True),
        Key("damping", positive, f"{force} s/{length}", "Damping constant, N s/m or N m s/rad.", default=zero),
        Key("rest", signed, length, of_rest, default=zero),
        *higher,
    )


def is_linear(values: Values) -> bool:
    """Whether the characteristic is the stiffness alone."""
    return all(values[name] == 0 for name in POWERS)


def characteristic(values: Values, extension: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
    """The force of a spring over its extension, and its energy over the square of the extension, in Horner's form."""
    force = energy = sp.S.Zero
    for name, power in reversed([("stiffness", 1), *POWERS.items()]):
        force = values[name] + extension * force
        energy = values[name] / (power + 1) + extension * energy
    return force, energy


class SpringType(ForceType[Spring]):
    """The type of a spring with a damper between two markers."""

    section = "springs"

    def element(self, name: str, kind: str, markers: tuple[MarkerRef, ...], values: Mapping[str, Any]) -> Spring:
        """Return the spring as an element of a scene."""
        first, second = markers
        return Spring(name, kind, first, second, **values)
