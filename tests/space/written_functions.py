"""Functions of time of a scene, evaluated from their texts in 60 digits; their integrals; tables as cubic splines."""

from __future__ import annotations

import ast
import csv
import operator
from collections.abc import Callable, Mapping, Sequence
from decimal import Decimal
from itertools import combinations, pairwise
from pathlib import Path
from typing import Any

import mpmath
from decimal_vectors import DIGITS, ONE, ZERO, Array, array, elementary, number, solved, zeros

Table = Mapping[str, Any]
OPERATORS: Mapping[type, Callable[[Decimal, Decimal], Decimal]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: lambda a, b: a ** int(b) if b == int(b) else elementary(mpmath.power, a, b),
}
ELEMENTARY = ("sin", "cos", "exp", "log", "tanh", "atan2")
PI = elementary(lambda: mpmath.pi)


class SplineTable:
    """A cubic spline through points, whose third derivative is continuous at the second and the last but one."""

    def __init__(self, rows: Sequence[tuple[Decimal, Decimal]]) -> None:
        self.x, self.y = zip(*rows, strict=True)
        n = len(rows)
        assert n >= 4, "shorter tables are lines and parabolas"
        h = [b - a for a, b in pairwise(self.x)]
        slopes = [(b - a) / step for (a, b), step in zip(pairwise(self.y), h, strict=True)]
        matrix, right = zeros(n, n), zeros(n)  # for the second derivatives at the points
        for i in range(1, n - 1):
            matrix[i, i - 1 : i + 2] = [h[i - 1], 2 * (h[i - 1] + h[i]), h[i]]
            right[i] = 6 * (slopes[i] - slopes[i - 1])
        for row, i in ((0, 0), (n - 1, n - 3)):
            matrix[row, i : i + 3] = [-ONE / h[i], ONE / h[i] + ONE / h[i + 1], -ONE / h[i + 1]]
        self.second: Array = solved(matrix, right)

    def __call__(self, x: Decimal) -> Decimal:
        x = min(max(x, self.x[0]), self.x[-1])
        i = next(i for i in range(len(self.x) - 1) if x <= self.x[i + 1])
        h, after, before = self.x[i + 1] - self.x[i], self.x[i + 1] - x, x - self.x[i]
        bend = (self.second[i] * after**3 + self.second[i + 1] * before**3) / (6 * h)
        ends = [self.y[j] / h - self.second[j] * h / 6 for j in (i, i + 1)]
        return Decimal(bend + ends[0] * after + ends[1] * before)


def smooth_step(x: Decimal, first: Decimal, last: Decimal) -> Decimal:
    """The polynomial of degree five from 0 to 1 whose first and second derivatives vanish at both ends."""
    s = min(max((x - first) / (last - first), ZERO), ONE)
    return 6 * s**5 - 15 * s**4 + 10 * s**3


class WrittenFunctions:
    """The functions of time of a scene: parameters by their symbols, inputs, and the tables in files of a folder."""

    def __init__(self, names: Mapping[str, Decimal], scene: Table, folder: Path) -> None:
        self.names = names
        self.inputs = {name: table.get("value", 0) for name, table in scene.get("inputs", {}).items()}
        self.splines = {
            name: SplineTable(_rows(folder / table["file"], table["x"], table["y"]))
            for name, table in scene.get("tables", {}).items()
        }
        self._integrals: dict[tuple[str, Decimal], Decimal] = {}

    def __call__(self, function: str | Mapping[str, str], t: Decimal) -> Decimal:
        """The value of a text such as "2*sin(t)", or of an input."""
        while isinstance(function, Mapping):
            function = self.inputs[function["input"]]
        return self._value(_parsed(str(function)), t)

    def integral(self, function: str, t: Decimal) -> Decimal:
        """The integral from 0 to t, by Gauss' rule between the times at which derivatives jump."""
        if (function, t) not in self._integrals:
            tree = _parsed(function)
            inside = [at for at in self._jumps(tree) if min(ZERO, t) < at < max(ZERO, t)]
            with mpmath.workdps(DIGITS + 5):

                def value(x: mpmath.mpf) -> mpmath.mpf:
                    at = Decimal(mpmath.nstr(x, DIGITS + 3, strip_zeros=False))
                    return mpmath.mpf(str(self._value(tree, at)))

                ends = [mpmath.mpf(str(x)) for x in sorted([ZERO, *inside, t], reverse=t < ZERO)]
                result = mpmath.quad(value, ends, method="gauss-legendre")
                self._integrals[function, t] = Decimal(mpmath.nstr(result, DIGITS, strip_zeros=False))
        return self._integrals[function, t]

    def _value(self, node: ast.expr, t: Decimal) -> Decimal:
        match node:
            case ast.Constant():
                return number(str(node.value))
            case ast.Name(id="t"):
                return t
            case ast.Name(id="pi"):
                return PI
            case ast.Name(id=name):
                return self.names[name]
            case ast.UnaryOp(op=ast.USub()):
                return -self._value(node.operand, t)
            case ast.UnaryOp(op=ast.UAdd()):
                return self._value(node.operand, t)
            case ast.BinOp():
                return OPERATORS[type(node.op)](self._value(node.left, t), self._value(node.right, t))
            case ast.Call(func=ast.Name(id="piecewise"), args=[*pieces, last]):
                for condition, value in zip(pieces[::2], pieces[1::2], strict=True):
                    if self._value(condition.left, t) < self._value(condition.comparators[0], t):
                        return self._value(value, t)
                return self._value(last, t)
            case ast.Call(func=ast.Name(id=name)):
                return self._called(name, [self._value(argument, t) for argument in node.args])
        raise NotImplementedError(ast.dump(node))

    def _called(self, name: str, x: list[Decimal]) -> Decimal:
        match name:
            case "sqrt":
                return x[0].sqrt()
            case "abs":
                return abs(x[0])
            case "min":
                return min(x)
            case "max":
                return max(x)
            case "step":
                return smooth_step(*x)
            case _ if name in self.splines:
                return self.splines[name](x[0])
            case _ if name in ELEMENTARY:
                return elementary(getattr(mpmath, name), *x)
        raise NotImplementedError(name)

    def _jumps(self, tree: ast.expr) -> list[Decimal]:
        """The times at which a function, or a derivative of it, jumps; arguments are linear in t."""
        result: list[Decimal] = []
        for node in ast.walk(tree):
            edges: list[tuple[ast.expr, Decimal | ast.expr]] = []
            match node:
                case ast.Compare(left=left, comparators=[right]):
                    edges = [(left, right)]
                case ast.Call(func=ast.Name(id="step"), args=[x, first, last]):
                    edges = [(x, first), (x, last)]
                case ast.Call(func=ast.Name(id="abs"), args=[x]):
                    edges = [(x, ZERO)]
                case ast.Call(func=ast.Name(id="min" | "max"), args=operands):
                    edges = [*combinations(operands, 2)]
                case ast.Call(func=ast.Name(id=name), args=[x]) if name in self.splines:
                    edges = [(x, knot) for knot in self.splines[name].x]
            for a, b in edges:
                at0, at1, at2 = (
                    self._value(a, t) - (self._value(b, t) if isinstance(b, ast.expr) else b)
                    for t in (ZERO, ONE, ONE + ONE)
                )
                assert abs(at2 - 2 * at1 + at0) < Decimal("1e-50"), "the arguments are not linear"
                result += [at0 / (at0 - at1)] if at0 != at1 else []
        return result


def _parsed(text: str) -> ast.expr:
    return ast.parse(text.strip().replace("^", "**"), mode="eval").body


def _rows(file: Path, x: str, y: str) -> list[tuple[Decimal, Decimal]]:
    with file.open() as lines:
        return [(number(row[x]), number(row[y])) for row in csv.DictReader(lines)]


def sampled(functions: WrittenFunctions, name: str, t: Decimal, step: Decimal) -> Array:
    """An input at a time, and its first two derivatives by differences."""
    before, now, after = (functions({"input": name}, t + s) for s in (-step, ZERO, step))
    return array([now, (after - before) / (2 * step), (after - 2 * now + before) / step**2])
