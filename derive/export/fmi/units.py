"""The units of a unit's variables in powers of the base units of SI, from which importers convert."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from derive.spec.parsing.units import UnknownUnit, unit_size

ANGULAR = {"rad": 1, "rad/s": 1, "rad/s^2": 1}
"""The power of the angle, which `unit_size` takes as a number, in the units of angles and their rates."""


@dataclass(frozen=True)
class UnitDefinition:
    """A unit: its name, its size in base units and their powers that are not zero; none where it is not known."""

    name: str
    factor: float
    powers: tuple[tuple[str, int], ...]
    known: bool = True


def unit_definitions(names: Iterable[str]) -> tuple[UnitDefinition, ...]:
    """The definitions of all units that occur, in the order of their names."""
    return tuple(_defined(name) for name in sorted({*names} - {""}))


def _defined(name: str) -> UnitDefinition:
    try:
        size = unit_size(name)
    except UnknownUnit:
        return UnitDefinition(name, 1.0, (), False)
    length, mass, time = size.dimension
    powers = {"kg": mass, "m": length, "s": time, "rad": ANGULAR.get(name, 0)}
    return UnitDefinition(name, size.scale, tuple((base, power) for base, power in powers.items() if power))
