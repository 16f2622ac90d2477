"""The base of the springs with dampers of this package: their keys and their polynomial characteristic."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from derive.algebra import sp
from derive.mechanics.multibody.forces.force_type import ForceType, Values
from derive.spec.model.forces import Spring
from derive.spec.model.keys import Key, value_keys
from derive.spec.model.markers import MarkerRef

POWERS = {"quadratic": 2, "cubic": 3, "quartic": 4, "quintic": 5}
"""The keys of the coefficients of the characteristic beyond the stiffness, with the powers of the extension."""


def spring_keys(force: str, length: str) -> tuple[Key, ...]:
    """The keys of a spring with a damper; the arguments are the units of its force and of its length."""
    return tuple(replace(key, unit=key.unit.format(force=force, length=length)) for key in value_keys(Spring))


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
