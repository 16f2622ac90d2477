"""The setup kernel, which computes everything that depends on the parameters alone, once for a set of parameters."""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterable

import casadi as ca

from derive.ir.expressions import Expr, Number, Operation, Operator, ScalarRef, walk
from derive.ir.kernel import Argument, Kernel, Output
from derive.ir.model import Variable
from derive.ir.statements import Requirement, ReturnCode
from derive.lowering.flat.casadi_symbols import Symbols
from derive.lowering.flat.context import Context
from derive.lowering.flat.graph import Graph
from derive.lowering.flat.schedule import NamedValue, OutputValue, RequiredValue, Step, schedule
from derive.roles import Source


def _when(condition: ca.SX, value: ca.SX) -> ca.SX:
    return ca.if_else(condition, value, 0)


FUNCTIONS: dict[Operator, Callable[..., ca.SX]] = {
    Operator.NEG: lambda a: -a,
    Operator.SIN: ca.sin,
    Operator.COS: ca.cos,
    Operator.SQRT: ca.sqrt,
    Operator.EXP: ca.exp,
    Operator.LOG: ca.log,
    Operator.TANH: ca.tanh,
    Operator.SIGN: ca.sign,
    Operator.NOT: ca.logic_not,
    Operator.ADD: operator.add,
    Operator.SUB: operator.sub,
    Operator.MUL: operator.mul,
    Operator.DIV: operator.truediv,
    Operator.ATAN2: ca.atan2,
    Operator.MIN: ca.fmin,
    Operator.MAX: ca.fmax,
    Operator.LESS: operator.lt,
    Operator.NOT_GREATER: operator.le,
    Operator.WHEN: _when,
}


def setup_kernel(context: Context, kernels: Iterable[Kernel]) -> tuple[Kernel, tuple[Variable, ...]]:
    """The kernel that computes the constants k from the parameters p, and the constants that `kernels` use.

    The constants are in the order of the derivation.
    """
    parameters = context.equations.parameters
    symbols = Symbols(early=frozenset(p.symbol for p in parameters), late=frozenset())
    for p in parameters:
        symbols.input(p.symbol, ScalarRef(f"p_{p.symbol}"))
    used = frozenset().union(*(kernel.used for kernel in kernels))
    hoisted = {name: expr for expr, name in context.constants.hoisted.items()}
    needed = _needed(used, hoisted, (r.expr for r in context.constants.requirements))
    values: dict[str, ca.SX] = {}
    constants: list[Variable] = []
    for c in context.coefficients:
        if str(c.symbol) in needed and not c.value.is_Rational:
            values[str(c.symbol)] = symbols(c.value)
            if str(c.symbol) in used:
                constants.append(Variable(str(c.symbol), c.doc, c.unit))
    for name, expr in hoisted.items():
        if name in needed:
            values[name] = _casadi(expr, values, symbols)
        if name in used:
            constants.append(Variable(name, _text(expr), ""))
    named = tuple(NamedValue(name, value) for name, value in values.items())
    checks = [
        *(
            RequiredValue(
                Requirement.POSITIVE, symbols.values[p.symbol], ReturnCode.NOT_FINITE, f"{p.symbol} must be positive"
            )
            for p in parameters
            if p.positive
        ),
        *(
            RequiredValue(
                Requirement.FINITE, symbols.values[p.symbol], ReturnCode.NOT_FINITE, f"{p.symbol} must be finite"
            )
            for p in parameters
        ),
        *(
            RequiredValue(Requirement.FINITE, values[c.name], ReturnCode.NOT_FINITE, f"{c.name} is not finite")
            for c in constants
        ),
        *(
            RequiredValue(r.kind, _casadi(r.expr, values, symbols), r.code, r.text)
            for r in context.constants.requirements
        ),
    ]
    stored = tuple(OutputValue("k", index, values[c.name]) for index, c in enumerate(constants))
    steps = (
        Step("integrals", Source.APPENDIX, "shape integrals, stiffness, and constants computed from them", named),
        Step("constants", "", "constants that the kernels read", stored),
        Step("checks", "", "checks of the parameters", tuple(checks)),
    )
    kernel = Kernel(
        "setup",
        "Constants k from the parameters p: once for a set of parameters.",
        (Argument("p", tuple(f"p_{p.symbol}" for p in parameters), "parameters"),),
        (Output("k", tuple(c.name for c in constants), "constants"),),
        schedule(Graph(), symbols, (), steps),
    )
    return kernel, tuple(constants)


def _needed(used: frozenset[str], hoisted: dict[str, Expr], checked: Iterable[Expr]) -> frozenset[str]:
    """The names of the constants that are used, or from which constants in use or checked expressions follow."""

    def names(expr: Expr) -> set[str]:
        return {e.name for e in walk(expr) if isinstance(e, ScalarRef)}

    needed = set(used).union(*map(names, checked))
    for name, expr in reversed(hoisted.items()):  # an expression refers to earlier ones only
        if name in needed:
            needed |= names(expr)
    return frozenset(needed)


def _casadi(expr: Expr, values: dict[str, ca.SX], symbols: Symbols) -> ca.SX:
    """An expression of coefficients as a CasADi scalar."""
    if isinstance(expr, Number):
        return symbols.number(expr.value)
    if isinstance(expr, ScalarRef):
        return values[expr.name]
    assert isinstance(expr, Operation), "setup has no loops here"
    args = [_casadi(a, values, symbols) for a in expr.args]
    return symbols.call(FUNCTIONS[expr.kind], *args)


def _text(expr: Expr) -> str:
    """The text of an expression in the comments of the generated code."""
    if isinstance(expr, Number):
        return str(expr.value)
    if isinstance(expr, ScalarRef):
        return expr.name
    assert isinstance(expr, Operation), "setup has no loops here"
    args = [f"({_text(a)})" if isinstance(a, Operation) else _text(a) for a in expr.args]
    sign = {Operator.ADD: " + ", Operator.SUB: " - ", Operator.MUL: " * ", Operator.DIV: " / "}
    if expr.kind is Operator.NEG:
        return f"-{args[0]}"
    if expr.kind not in sign:
        return f"{expr.kind.value}({', '.join(map(_text, expr.args))})"
    return sign[expr.kind].join(args)
