"""What the springs with dampers of this package have in common."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

from derive.mechanics.multibody.forces.force_type import ForceType
from derive.mechanics.multibody.keys import Key, KeyType
from derive.spec.model.scene import MarkerRef, Spring


def spring_keys(stiffness: str, damping: str, rest: str) -> tuple[Key, ...]:
    """The keys of a spring with a damper; the arguments are their units."""
    positive, signed, zero = KeyType.NOT_NEGATIVE_QUANTITY, KeyType.QUANTITY, Fraction(0)
    of_rest = "Length, m, or angle, rad, at which the spring exerts no force."
    return (
        Key("stiffness", positive, stiffness, "Stiffness, N/m or N m/rad.", required=True),
        Key("damping", positive, damping, "Damping constant, N s/m or N m s/rad.", default=zero),
        Key("rest", signed, rest, of_rest, default=zero),
    )


class SpringType(ForceType[Spring]):
    """The type of a spring with a damper between two markers."""

    section = "springs"

    def element(self, name: str, kind: str, markers: tuple[MarkerRef, ...], values: Mapping[str, Any]) -> Spring:
        """The spring."""
        first, second = markers
        return Spring(name, kind, first, second, **values)
