"""A scene in space as its TOML file has it, read without the package: numbers, rotations, functions of time."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from decimal import Decimal
from pathlib import Path
from typing import Any

import numpy as np
from decimal_vectors import (
    ONE,
    ZERO,
    Array,
    about,
    array,
    cross,
    identity,
    length,
    number,
    of_quaternion,
)
from written_functions import WrittenFunctions

Table = Mapping[str, Any]

AXES = {"x": 0, "y": 1, "z": 2}


def tables(source: str | Path) -> Table:
    """The tables of a file or of a text, whose decimal numbers keep all their digits."""
    text = source.read_text() if isinstance(source, Path) else source
    return tomllib.loads(text, parse_float=Decimal)


class Numbers:
    """The numbers of a scene: parameters have their defaults, or the values of `p`. folder: that of its files."""

    def __init__(self, scene: Table, p: Mapping[str, float] | None = None, folder: Path = Path()) -> None:
        self.names = {name: number(table.get("default", 1)) for name, table in scene.get("parameters", {}).items()}
        self.names |= {name: number(value) for name, value in (p or {}).items()}
        self.functions = WrittenFunctions(self.names, scene, folder)

    def __call__(self, value: Any) -> Decimal:
        """A number, a fraction as a text, or a parameter."""
        if isinstance(value, Mapping):
            return self.names.get(value["symbol"], number(value.get("default", 1)))
        if not isinstance(value, str):
            return number(value)
        if value in self.names:
            return self.names[value]
        over, _, under = value.partition("/")
        return number(over) / number(under or 1)

    def vector(self, values: Any) -> Array:
        """A vector of such numbers."""
        return np.array([self(x) for x in values], dtype=object)

    def at(self, function: Any, t: Decimal) -> Decimal:
        """The value of a function of time: a number, a text such as "2*sin(t)", or that of an input."""
        of_time = isinstance(function, str) or (isinstance(function, Mapping) and "input" in function)
        return self.functions(function, t) if of_time else self(function)


def rotation(value: Any) -> Array:
    """The matrix of a rotation in any of its forms: a quaternion, an axis and an angle, two axes, three angles."""
    if value is None:
        return identity(3)
    if not isinstance(value, Mapping):
        return of_quaternion(array(value))
    if "axis" in value:
        axis = array(value["axis"])
        return about(axis * (number(value["angle"]) / length(axis)))
    if "angles" in value:
        result = identity(3)
        for angle, axis in zip(value["angles"], value["sequence"], strict=True):
            unit = array([ZERO, ZERO, ZERO])
            unit[AXES[axis]] = number(angle)
            result = result @ about(unit)
        return result
    return _of_axes(value)


def _of_axes(value: Table) -> Array:
    """The rotation whose columns are the axes, of which two are given; the third one makes them right-handed."""
    known = {AXES[name]: array(value[name]) / length(array(value[name])) for name in value}
    for k in range(3):
        if k not in known:
            known[k] = cross(known[(k + 1) % 3], known[(k + 2) % 3])
    result = np.array([known[k] for k in range(3)], dtype=object).T
    assert abs(sum(result[:, 0] * cross(result[:, 1], result[:, 2])) - ONE) < Decimal("1e-10"), "left-handed axes"
    return result
