"""Functions of numbers from expressions of SymPy, which is not loaded once their kernels are kept in the cache."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, TypeAlias

from derive.ir.kernel import Argument, Kernel, Output
from derive.ir.straight_line import straight_line_function
from derive.kept_objects import kept_object

if TYPE_CHECKING:
    from derive.algebra import sp

Expressions: TypeAlias = "tuple[Sequence[sp.Symbol], Sequence[sp.Expr]]"
"""Symbols, and expressions of these."""

ARGUMENT, RESULT = "x", "y"


def kept_function(
    kind: str, source: str, expressions: Callable[[], Expressions], keep: bool = True
) -> Callable[[Sequence[float]], list[float]]:
    """A function from the values of symbols to those of expressions.

    kind, source: those of `kept_object`. expressions: called if there is no kernel for `source` yet. keep: whether the
    kernel is kept, which it is not where `source` does not say all.
    """

    def made() -> Kernel:
        return _kernel(kind, *expressions())

    function = straight_line_function(kept_object(kind, source, made) if keep else made(), lambda value, item: None, {})
    assert function is not None, "a kernel of expressions has no loops"
    straight = function
    return lambda values: straight({ARGUMENT: values})[RESULT]


def _kernel(name: str, symbols: Sequence[sp.Symbol], expressions: Sequence[sp.Expr]) -> Kernel:
    from derive.ir.expressions import ScalarRef
    from derive.lowering.flat.casadi_symbols import Symbols
    from derive.lowering.flat.graph import Graph
    from derive.lowering.flat.schedule import OutputValue, Step, schedule

    names = tuple(f"{ARGUMENT}{k}" for k in range(len(symbols)))
    known = Symbols(frozenset(), frozenset())
    for symbol, each in zip(symbols, names, strict=True):
        known.input(symbol, ScalarRef(each))
    items = tuple(OutputValue(RESULT, k, known(expr)) for k, expr in enumerate(expressions))
    sections = schedule(Graph(), known, (), (Step(name, "", "", items),))
    output = Output(RESULT, tuple(f"expression {k}" for k in range(len(expressions))), "the values of the expressions")
    return Kernel(name, "", (Argument(ARGUMENT, names, "the values of the symbols"),), (output,), sections)
