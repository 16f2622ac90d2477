"""A scene in space as its TOML file has it, read without the package: numbers, rotations, functions of time."""

from __future__ import annotations

import ast
import operator
import tomllib
from collections.abc import Mapping
from decimal import Decimal
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
from decimal_vectors import (
    ONE,
    ZERO,
    Array,
    about,
    array,
    cross,
    elementary,
    identity,
    length,
    number,
    of_quaternion,
)

Table = Mapping[str, Any]

AXES = {"x": 0, "y": 1, "z": 2}
OPERATORS = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: lambda a, b: a ** int(b) if b == int(b) else elementary(mpmath.power, a, b),
}
FUNCTIONS = {
    name: getattr(mpmath, name) for name in ("sin", "cos", "tan", "exp", "log", "sqrt", "tanh", "atan", "cosh")
}


def tables(source: str | Path) -> Table:
    """The tables of a file or of a text, whose decimal numbers keep all their digits."""
    text = source.read_text() if isinstance(source, Path) else source
    return tomllib.loads(text, parse_float=Decimal)


class Numbers:
    """The numbers of a scene: parameters have their defaults, or the values of `p`."""

    def __init__(self, scene: Table, p: Mapping[str, float] | None = None) -> None:
        self.names = {name: number(table.get("default", 1)) for name, table in scene.get("parameters", {}).items()}
        self.names |= {name: number(value) for name, value in (p or {}).items()}
        self.inputs = {name: table.get("value", 0) for name, table in scene.get("inputs", {}).items()}

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
        if isinstance(function, Mapping) and "input" in function:
            function = self.inputs[function["input"]]
        if not isinstance(function, str):
            return self(function)
        return self._value(ast.parse(function.replace("^", "**"), mode="eval").body, t)

    def _value(self, node: ast.expr, t: Decimal) -> Decimal:
        match node:
            case ast.Constant():
                return number(str(node.value))
            case ast.Name(id="t"):
                return t
            case ast.Name(id="pi"):
                return elementary(lambda: mpmath.pi)
            case ast.Name(id=name):
                return self.names[name] if name in self.names else self.at(self.inputs[name], t)
            case ast.UnaryOp(op=ast.USub()):
                return -self._value(node.operand, t)
            case ast.UnaryOp(op=ast.UAdd()):
                return self._value(node.operand, t)
            case ast.BinOp():
                return OPERATORS[type(node.op)](self._value(node.left, t), self._value(node.right, t))
            case ast.Call(func=ast.Name(id=name)):
                return elementary(FUNCTIONS[name], *(self._value(argument, t) for argument in node.args))
        raise NotImplementedError(ast.dump(node))


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
