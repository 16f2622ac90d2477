"""SymPy functions of the derivation that are not expanded automatically and that know their derivatives.

SymPy would expand exp(a + b) to exp(a) exp(b) and differentiate |x| to distributions. At kinks and jumps a derivative
is that of one side.
"""

from __future__ import annotations

from collections.abc import Sequence

from sympy.core.function import ArgumentIndexError
from sympy.core.symbol import Str

from derive.algebra import sp
from derive.spec.model.time_function import Spline


class TimeOperation(sp.Function):  # type: ignore[misc]  # SymPy has no types
    """A function that the lowering translates to operations of a kernel."""


class Exp(TimeOperation):
    """The exponential function."""

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        """The derivative, which is the function itself."""
        return self


class Log(TimeOperation):
    """The natural logarithm."""

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        """The derivative 1/x."""
        return 1 / self.args[0]


class Tanh(TimeOperation):
    """The hyperbolic tangent."""

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        """The derivative 1 - tanh^2."""
        return 1 - self**2


class Sign(TimeOperation):
    """The sign of a number: -1, 0 or 1."""

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        """The derivative: zero, wherever it exists."""
        return sp.S.Zero


class Absolute(TimeOperation):
    """The absolute value of a number."""

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        """The derivative, which is the sign."""
        return Sign(self.args[0])


class Atan2(TimeOperation):
    """The angle of the point (x, y) from its coordinates y, x."""

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        """The derivatives x/(x^2 + y^2) and -y/(x^2 + y^2)."""
        y, x = self.args
        return (x if argindex == 1 else -y) / (x**2 + y**2)


class Wrapped(TimeOperation):
    """The number next to zero among x + 2 pi n s for all whole n: of the arguments x, s an angle x/s without turns."""

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        """The derivative by x, which is 1; s is a constant, by which nothing is differentiated here."""
        if argindex != 1:
            raise ArgumentIndexError(self, argindex)
        return sp.S.One


class Select(TimeOperation):
    """The choice between two values: of the arguments a, b, x, y it is x where a < b, else y."""

    def _eval_derivative(self, s: sp.Symbol) -> sp.Expr:
        a, b, x, y = self.args
        return select(a, b, x.diff(s), y.diff(s))


class Minimum(TimeOperation):
    """The smaller of two values."""

    def _eval_derivative(self, s: sp.Symbol) -> sp.Expr:
        a, b = self.args
        return select(a, b, a.diff(s), b.diff(s))


class Maximum(TimeOperation):
    """The larger of two values."""

    def _eval_derivative(self, s: sp.Symbol) -> sp.Expr:
        a, b = self.args
        return select(a, b, b.diff(s), a.diff(s))


class SmoothStep(TimeOperation):
    """The smooth step with the arguments x, x0, x1, n: derivative n of a quintic polynomial from 0 at x0 to 1 at x1."""

    def _eval_derivative(self, s: sp.Symbol) -> sp.Expr:
        x, x0, x1, order = self.args
        return SmoothStep(x, x0, x1, order + 1) * x.diff(s)


class Lookup(TimeOperation):
    """A table lookup with the arguments name, n, x: derivative n of a table at x."""

    is_commutative = True  # in spite of its name, which SymPy does not take for a number

    def _eval_derivative(self, s: sp.Symbol) -> sp.Expr:
        name, order, x = self.args
        return Lookup(name, order + 1, x) * x.diff(s)


def tried(expr: sp.Expr) -> sp.Expr:
    """An expression without symbols as SymPy evaluates it; a table and a smooth step have their arguments as values.

    What holds for any values of these functions can so be tried, and what depends on their values cannot.
    """
    for operation, function in _TRIED.items():
        expr = expr.replace(operation, function)
    return expr


_TRIED = {
    Exp: sp.exp,
    Log: sp.log,
    Tanh: sp.tanh,
    Sign: sp.sign,
    Absolute: sp.Abs,
    Minimum: sp.Min,
    Maximum: sp.Max,
    Select: lambda a, b, x, y: sp.Piecewise((x, a < b), (y, True)),
    SmoothStep: lambda x, x0, x1, order: x,
    Lookup: lambda name, order, x: x,
    Atan2: sp.atan2,
    Wrapped: lambda x, s: x - 2 * sp.pi * s * sp.floor(x / (2 * sp.pi * s) + sp.S.Half),
}


def select(a: sp.Expr, b: sp.Expr, x: sp.Expr, y: sp.Expr) -> sp.Expr:
    """Return x where a < b, else y; simplified where x and y are equal, or where a and b are numbers."""
    if a.is_Rational and b.is_Rational:
        return x if a < b else y
    return x if x == y else Select(a, b, x, y)


def lookup(spline: Spline, x: sp.Expr) -> sp.Expr:
    """Return the value of a table at x."""
    return Lookup(Str(spline.name), sp.S.Zero, x)


def piecewise(conditions: Sequence[tuple[sp.Expr, sp.Expr]], values: Sequence[sp.Expr]) -> sp.Expr:
    """Return the value of the first condition (a, b) with a < b; where none holds, the last value."""
    if not conditions:
        return values[0]
    return select(*conditions[0], values[0], piecewise(conditions[1:], values[1:]))


BUILD = {
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul": lambda a, b: a * b,
    "div": lambda a, b: a / b,
    "pow": lambda a, b: a**b,
    "neg": lambda a: -a,
    "sin": sp.sin,
    "cos": sp.cos,
    "sqrt": sp.sqrt,
    "exp": Exp,
    "log": Log,
    "tanh": Tanh,
    "abs": Absolute,
    "min": Minimum,
    "max": Maximum,
    "atan2": Atan2,
    "step": lambda x, x0, x1: SmoothStep(x, x0, x1, sp.S.Zero),
}
"""The expression of each kind of function of time, from those of its operands."""
