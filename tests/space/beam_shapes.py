"""The shape functions of a beam in space as its table in a scene has them, with 60 digits: their values and slopes.

Conditions of frames and of ends are solved by elimination on the coefficients of the ansatz; the modes of uniform beams
are written as they are in books.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from functools import cache
from typing import Any

import mpmath
import numpy as np
import sympy as sp
from decimal_vectors import DIGITS, ONE, number

Polynomial = tuple[Fraction, ...]
Function = Callable[[Decimal, int], Decimal]
"""A function of xi and of the order of its derivative by xi."""
CUBIC = ("1", "xi", "xi^2", "xi^3")
FAMILY_FRAMES = {
    "pinned": {"kind": "chord"},
    "free-free": {"kind": "mean"},
    "clamped-free": {"kind": "tangent", "at": -1},
}
NODES_OF_MODES = 20
"""The number of nodes with which products of modes are integrated to some 20 digits."""
NEWTON = 3
"""The steps from 16 digits to all."""


@dataclass(frozen=True)
class BeamShapes:
    """Functions by what they are amplitudes of: v and w across the axis, theta (times length/2), u along the axis."""

    frame: Mapping[str, Any]
    along: Mapping[str, tuple[Function, ...]]
    nodes: int
    """The number of nodes of quadrature."""

    @property
    def numbered(self) -> list[tuple[str, Function]]:
        """The shapes in the order of their amplitudes."""
        return [(direction, shape) for direction, shapes in self.along.items() for shape in shapes]


def beam_shapes(table: Mapping[str, Any]) -> BeamShapes:
    """The shapes of the table of a beam."""
    first = table.get("ansatz", CUBIC)
    frame = table.get("frame", FAMILY_FRAMES[first["kind"]] if isinstance(first, Mapping) else "mean")
    frame = frame if isinstance(frame, Mapping) else {"kind": frame}
    orthogonal = bool(table.get("orthogonal", frame["kind"] == "mean"))
    of_bending = [first, table.get("lateral", {}).get("ansatz", first)]
    along = [_deflections(ansatz, frame, table.get("ends"), orthogonal) for ansatz in of_bending]
    along += [
        _displacements(table[name]["ansatz"], frame, orthogonal) if name in table else []
        for name in ("torsion", "axial")
    ]
    exact = [len(p) for shapes in along for p in shapes if isinstance(p, tuple)]
    modes = any(isinstance(ansatz, Mapping) for ansatz in of_bending)
    functions = [tuple(_function(p) if isinstance(p, tuple) else p for p in shapes) for shapes in along]
    nodes = NODES_OF_MODES if modes else max(exact) + 1
    return BeamShapes(frame, dict(zip(("v", "w", "theta", "u"), functions, strict=True)), nodes)


# ---- polynomials


def polynomial(text: Any) -> Polynomial:
    """The coefficients of a polynomial in xi, from that of 1 on."""
    of = sp.Poly(sp.sympify(str(text).replace("^", "**"), rational=True), sp.Symbol("xi"))
    return tuple(Fraction(int(c.p), int(c.q)) for c in reversed(of.all_coeffs()))


def derivative(p: Polynomial, order: int = 1) -> Polynomial:
    """A derivative by xi."""
    for _ in range(order):
        p = tuple(n * c for n, c in enumerate(p))[1:] or (Fraction(0),)
    return p


def at(p: Polynomial, xi: Fraction) -> Fraction:
    """The value at xi."""
    return sum((c * xi**n for n, c in enumerate(p)), Fraction(0))


def mean(p: Polynomial, q: Polynomial = (Fraction(1),)) -> Fraction:
    """The integral of a product from -1 to 1."""
    terms = ((a * b, n + m) for n, a in enumerate(p) for m, b in enumerate(q))
    return sum((2 * c / (n + 1) for c, n in terms if n % 2 == 0), Fraction(0))


def combined(polynomials: Sequence[Polynomial], weights: Sequence[Fraction]) -> Polynomial:
    """The sum of polynomials with weights."""
    size = max(map(len, polynomials))
    padded = [(*p, *[Fraction(0)] * (size - len(p))) for p in polynomials]
    return tuple(
        sum((w * c for w, c in zip(weights, column, strict=True)), Fraction(0)) for column in zip(*padded, strict=True)
    )


def _deflections(ansatz: Any, frame: Mapping[str, Any], ends: str | None, orthogonal: bool) -> list[Any]:
    """The functions of an ansatz on which the conditions hold, or the modes of a family."""
    if isinstance(ansatz, Mapping):
        return [MODES[ansatz["kind"]](n) for n in range(1, ansatz["count"] + 1)]
    polynomials, place = [polynomial(text) for text in ansatz], Fraction(str(frame.get("at", 0)))
    conditions: dict[str, list[Callable[[Polynomial], Fraction]]] = {
        "mean": [mean, lambda p: mean(p, polynomial("xi"))],
        "point": [lambda p: at(p, place), lambda p: at(derivative(p), place)],
        "chord": [lambda p: at(p, Fraction(-1)), lambda p: at(p, Fraction(1))],
        "given": [],
    }
    imposed = conditions["point" if frame["kind"] == "tangent" else frame["kind"]]
    orders = {None: (), "pinned": (2,), "free": (2, 3)}[ends]
    imposed += [lambda p, o=o, end=end: at(derivative(p, o), Fraction(end)) for o in orders for end in (-1, 1)]
    return _scaled(_eliminated(polynomials, [[of(p) for p in polynomials] for of in imposed]), orthogonal)


def _displacements(ansatz: Any, frame: Mapping[str, Any], orthogonal: bool) -> list[Polynomial]:
    """The polynomials of displacements along the axis, or of rotations about it, without what the frame takes away."""
    polynomials = [polynomial(text) for text in ansatz]
    moving = [p for p in polynomials if any(p[1:])]
    return _scaled([combined([p, polynomial(1)], [Fraction(1), -_constant(p, frame)]) for p in moving], orthogonal)


def _constant(p: Polynomial, frame: Mapping[str, Any]) -> Fraction:
    if frame["kind"] == "mean":
        return mean(p) / 2
    if frame["kind"] == "chord":
        return (at(p, Fraction(-1)) + at(p, Fraction(1))) / 2
    return at(p, Fraction(str(frame.get("at", 0))))


def _eliminated(polynomials: list[Polynomial], rows: list[list[Fraction]]) -> list[Polynomial]:
    """Combinations that fulfil linear equations: one for each polynomial that is not needed to fulfil them."""
    rows, pivots = [list(row) for row in rows], []
    for column in range(len(polynomials)):
        k = len(pivots)
        found = next((i for i in range(k, len(rows)) if rows[i][column]), None)
        if found is None:
            continue
        rows[k], rows[found] = rows[found], rows[k]
        rows[k] = [x / rows[k][column] for x in rows[k]]
        for i in range(len(rows)):
            if i != k:
                factor = rows[i][column]
                rows[i] = [x - factor * y for x, y in zip(rows[i], rows[k], strict=True)]
        pivots.append(column)
    result = []
    for free in (c for c in range(len(polynomials)) if c not in pivots):
        weights = [Fraction(int(c == free)) for c in range(len(polynomials))]
        for row, pivot in zip(rows, pivots, strict=False):
            weights[pivot] = -row[free]
        result.append(combined(polynomials, weights))
    return result


def _scaled(shapes: list[Polynomial], orthogonal: bool) -> list[Polynomial]:
    """The shapes made orthogonal in turn, if that is asked for, with a value or a first slope of 1 at the right end."""
    done: list[Polynomial] = []
    for shape in shapes:
        weights = [-mean(shape, other) / mean(other, other) for other in done] if orthogonal else []
        done.append(combined([shape, *done[: len(weights)]], [Fraction(1), *weights]))
    values = [next(x for x in (at(derivative(p, o), Fraction(1)) for o in range(len(p))) if x) for p in done]
    return [tuple(c / x for c in p) for p, x in zip(done, values, strict=True)]


def _function(p: Polynomial) -> Function:
    @cache
    def of(xi: Decimal, order: int) -> Decimal:
        total = Decimal(0)
        for c in reversed(derivative(p, order)):
            total = total * xi + number(c)
        return total

    return of


# ---- modes of uniform beams


def _mode(value: Callable[[Any, int], Any]) -> Function:
    """A function from its values by mpmath."""

    @cache
    def of(xi: Decimal, order: int) -> Decimal:
        with mpmath.workdps(DIGITS + 5):
            return Decimal(mpmath.nstr(value(mpmath.mpf(str(xi)), order), DIGITS + 3))

    return of


def _cosine(z: Any, order: int) -> Any:
    return (mpmath.cos(z), -mpmath.sin(z), -mpmath.cos(z), mpmath.sin(z))[order % 4]


def _sine(z: Any, order: int) -> Any:
    return _cosine(z, order + 3)


def _hyperbolic(z: Any, order: int, even: bool) -> Any:
    return mpmath.cosh(z) if even == (order % 2 == 0) else mpmath.sinh(z)


def _pinned(n: int) -> Function:
    return _mode(lambda xi, order: (n * mpmath.pi / 2) ** order * _sine(n * mpmath.pi / 2 * (1 + xi), order))


def _free(n: int) -> Function:
    even = n % 2 == 1
    trigonometric = _cosine if even else _sine

    def value(xi: Any, order: int) -> Any:
        sign = 1 if even else -1
        k = mpmath.findroot(
            lambda z: mpmath.sin(z) + sign * mpmath.cos(z) * mpmath.tanh(z), (2 * n + 1) * mpmath.pi / 4
        )
        first = trigonometric(k * xi, order) / trigonometric(k, 0)
        return k**order * (first + _hyperbolic(k * xi, order, even) / _hyperbolic(k, 0, even)) / 2

    return _mode(value)


def _clamped(n: int) -> Function:
    def value(xi: Any, order: int) -> Any:
        guess = 1.875 if n == 1 else (2 * n - 1) * mpmath.pi / 2
        whole = mpmath.findroot(lambda z: mpmath.cos(z) + 1 / mpmath.cosh(z), guess)
        s = (mpmath.cosh(whole) + mpmath.cos(whole)) / (mpmath.sinh(whole) + mpmath.sin(whole))

        def shape(z: Any, of: int) -> Any:
            difference = _hyperbolic(z, of, True) - _cosine(z, of)
            return difference - s * (_hyperbolic(z, of, False) - _sine(z, of))

        return (whole / 2) ** order * shape(whole / 2 * (1 + xi), order) / shape(whole, 0)

    return _mode(value)


MODES = {"pinned": _pinned, "free-free": _free, "clamped-free": _clamped}


# ---- quadrature


@cache
def gauss_points(n: int) -> tuple[tuple[Decimal, Decimal], ...]:
    """The nodes and weights of Gauss-Legendre quadrature on (-1, 1)."""
    with mpmath.workdps(DIGITS + 10):
        roots = [mpmath.mpf(float(x)) for x in np.polynomial.legendre.leggauss(n)[0]]

        def slope(x: Any) -> Any:
            return n * (mpmath.legendre(n - 1, x) - x * mpmath.legendre(n, x)) / (1 - x**2)

        for _ in range(NEWTON):
            roots = [x - mpmath.legendre(n, x) / slope(x) for x in roots]
        slopes = [slope(x) for x in roots]
        pairs = [(r, 2 / ((1 - r**2) * slope**2)) for r, slope in zip(roots, slopes, strict=True)]
        return tuple(tuple(Decimal(mpmath.nstr(x, DIGITS + 5)) for x in pair) for pair in pairs)  # type: ignore[misc]


def integral(function: Callable[[Decimal], Decimal], to: Decimal, nodes: int) -> Decimal:
    """The integral from -1 to a point."""
    half = (to + ONE) / 2
    return sum((half * w * function(half * (x + ONE) - ONE) for x, w in gauss_points(nodes)), Decimal(0))
