"""The setup kernel: all work on parameters alone, done once."""

from __future__ import annotations

from collections.abc import Callable, Iterable

import casadi as ca

from derive.ir.expressions import Expr, Num, Op, Ref, walk
from derive.ir.interpreter import BINARY
from derive.ir.kernel import Argument, Kernel, Output
from derive.ir.model import Variable
from derive.lowering.flat.casadi_symbols import Symbols
from derive.lowering.flat.context import Context
from derive.lowering.flat.functions import NOT_FINITE
from derive.lowering.flat.graph import Constants, Graph
from derive.lowering.flat.schedule import Named, Required, Step, Stored, schedule

UNARY: dict[str, Callable[[ca.SX], ca.SX]] = {"neg": lambda a: -a, "sin": ca.sin, "cos": ca.cos, "sqrt": ca.sqrt}


def setup_kernel(context: Context, kernels: Iterable[Kernel]) -> tuple[Kernel, tuple[Variable, ...]]:
    """p -> k, with the constants that the kernels use, in the order of the derivation."""
    parameters = context.equations.parameters
    symbols = Symbols(early=frozenset(p.symbol for p in parameters), late=frozenset())
    for p in parameters:
        symbols.input(p.symbol, Ref(f"p_{p.symbol}"))
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
    named = tuple(Named(name, value) for name, value in values.items())
    checks = [
        *(
            Required("positive", symbols.values[p.symbol], NOT_FINITE, f"{p.symbol} must be positive")
            for p in parameters
            if p.positive
        ),
        *(Required("finite", symbols.values[p.symbol], NOT_FINITE, f"{p.symbol} must be finite") for p in parameters),
        *(Required("finite", values[c.name], NOT_FINITE, f"{c.name} is not finite") for c in constants),
        *(Required(r.kind, _casadi(r.expr, values, symbols), r.code, r.text) for r in context.constants.requirements),
    ]
    stored = tuple(Stored("k", index, values[c.name]) for index, c in enumerate(constants))
    steps = (
        Step("integrals", "appendix", "shape integrals, stiffness, and what is made of them", named),
        Step("constants", "", "what the kernels read", stored),
        Step("checks", "", "refuse parameters that make no body", tuple(checks)),
    )
    kernel = Kernel(
        "setup",
        "Constants k from the parameters p: once for a set of parameters.",
        (Argument("p", tuple(f"p_{p.symbol}" for p in parameters), "parameters"),),
        (Output("k", tuple(c.name for c in constants), "constants"),),
        schedule(Graph(Constants(frozenset())), symbols, (), steps),
    )
    return kernel, tuple(constants)


def _needed(used: frozenset[str], hoisted: dict[str, Expr], checked: Iterable[Expr]) -> frozenset[str]:
    """The names of all constants behind the used ones and the checked expressions."""

    def names(expr: Expr) -> set[str]:
        return {e.name for e in walk(expr) if isinstance(e, Ref)}

    needed = set(used).union(*map(names, checked))
    for name, expr in reversed(hoisted.items()):  # an expression refers to earlier ones only
        if name in needed:
            needed |= names(expr)
    return frozenset(needed)


def _casadi(expr: Expr, values: dict[str, ca.SX], symbols: Symbols) -> ca.SX:
    """An expression of coefficients, in CasADi."""
    if isinstance(expr, Num):
        return symbols.number(expr.value)
    if isinstance(expr, Ref):
        return values[expr.name]
    assert isinstance(expr, Op), "setup has no loops here"
    args = [_casadi(a, values, symbols) for a in expr.args]
    return UNARY[expr.kind](args[0]) if expr.kind in UNARY else BINARY[expr.kind](*args)


def _text(expr: Expr) -> str:
    """An expression as the generated comments show it."""
    if isinstance(expr, Num):
        return str(expr.value)
    if isinstance(expr, Ref):
        return expr.name
    assert isinstance(expr, Op), "setup has no loops here"
    args = [f"({_text(a)})" if isinstance(a, Op) else _text(a) for a in expr.args]
    sign = {"add": " + ", "sub": " - ", "mul": " * ", "div": " / "}
    if expr.kind in ("sin", "cos", "sqrt"):
        return f"{expr.kind}({_text(expr.args[0])})"
    return f"-{args[0]}" if expr.kind == "neg" else sign[expr.kind].join(args)
