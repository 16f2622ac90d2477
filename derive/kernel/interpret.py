"""Run a Kernel in Python on any numbers that know + - * /: floats, fractions, mpmath, SymPy or CasADi symbols."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from typing import Any

from derive.kernel.ir import Expr, Kernel, Num, Ref, Require, Store

BINARY: dict[str, Callable[[Any, Any], Any]] = {
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul": lambda a, b: a * b,
    "div": lambda a, b: a / b,
}


class RequirementError(ArithmeticError):
    """A requirement of a kernel does not hold; `code` is what the generated C returns."""

    def __init__(self, code: int, text: str) -> None:
        self.code = code
        super().__init__(text)


def interpret(
    kernel: Kernel,
    arguments: Mapping[str, Any],
    *,
    number: Callable[[Fraction], Any] = float,
    functions: Mapping[str, Callable[[Any], Any]] | None = None,
    check: bool = True,
) -> dict[str, list[Any]]:
    """The outputs of a kernel: lists of the lengths of `kernel.outputs`.

    `arguments` maps each argument to a sequence (to a number, if scalar); `number` turns exact constants into the
    numbers wanted, `functions` gives their `sin` and `cos`. Raises RequirementError (with `check`).
    """
    call = {"sin": math.sin, "cos": math.cos, **(functions or {})}
    values: dict[str, Any] = {}
    for argument in kernel.arguments:
        given: Any = arguments[argument.name]
        values.update({argument.name: given} if argument.scalar else _named(argument.elements, given))
    outputs: dict[str, list[Any]] = {o.name: [None] * len(o.elements) for o in kernel.outputs}

    def value(expr: Expr) -> Any:
        if isinstance(expr, Num):
            return number(expr.value)
        if isinstance(expr, Ref):
            return values[expr.name]
        operands = [value(arg) for arg in expr.args]
        if expr.kind == "neg":
            return -operands[0]
        return BINARY[expr.kind](*operands) if expr.kind in BINARY else call[expr.kind](*operands)

    for statement in kernel.statements:
        result = value(statement.expr)
        if isinstance(statement, Require):
            if check and not (result > 0 if statement.kind == "positive" else math.isfinite(result)):
                raise RequirementError(statement.code, statement.text)
        elif isinstance(statement, Store):
            outputs[statement.output][statement.index] = result
        else:
            values[statement.name] = result
    return outputs


def _named(names: Sequence[str], given: Sequence[Any]) -> dict[str, Any]:
    return dict(zip(names, given, strict=True))
