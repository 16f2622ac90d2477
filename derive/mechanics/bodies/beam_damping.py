"""The damping matrix B of a planar beam: proportional to c8 and K, or a fraction of critical damping in each mode."""

from __future__ import annotations

from collections.abc import Mapping

import mpmath
import sympy as sp

from derive.mechanics.quantity import rounded
from derive.mechanics.symbols import Family, identity, pair
from derive.mechanics.terms import ModelConstant
from derive.spec.model.body import Damping

DIGITS = 60
"""Digits of the modes, whose results are rounded to doubles: the same on any machine."""

NEGLIGIBLE = mpmath.mpf(10) ** -40
UNCOUPLED = "these shapes (the modes that they are part of are damped alone)"


def beam_damping(
    damping: Damping,
    integrals: tuple[ModelConstant, ...],
    stiffness: tuple[ModelConstant, ...],
    mass: sp.Expr,
    bending: sp.Expr,
) -> tuple[ModelConstant, ...]:
    """The entries B_ij, i <= j, in N s/m, with the reasons of those that vanish.

    mass: that of the beam, kg; bending: EI/l^3, N/m. Proportional damping is exact. In B = 2 ratio c8 (c8^-1 K)^(1/2)
    every mode of c8 and K has the ratio; the root is one of numbers, since c8/mass and K/bending are numbers.
    """
    masses = {_shapes(c): c for c in integrals if identity(c.symbol).family is Family.C8}
    stiffnesses = {_shapes(c): c for c in stiffness}
    roots: Mapping[tuple[int, int], sp.Rational] = {}
    if damping.ratio:
        of_mass = {key: sp.Rational(c.value / mass) for key, c in masses.items()}
        roots = _roots(of_mass, {key: sp.Rational(c.value / bending) for key, c in stiffnesses.items()})
    number, symbols = sp.expand(mass * bending).as_coeff_Mul()
    unit = rounded(sp.sqrt(number)) * sp.sqrt(symbols)  # SymPy would keep an irrational factor such as sqrt(2)
    result = []
    for key, entry in stiffnesses.items():
        value = sp.Rational(damping.mass) * masses[key].value + sp.Rational(damping.stiffness) * entry.value
        value += 2 * sp.Rational(damping.ratio) * unit * roots.get(key, sp.S.Zero)
        zero = None if value != 0 else UNCOUPLED if roots else entry.zero or masses[key].zero
        doc = f"damping of modes {key[0]} and {key[1]}"
        result.append(ModelConstant(pair(Family.DAMPING, *key), rounded(value), "(13)", doc, "N s/m", zero))
    return tuple(result)


def _shapes(constant: ModelConstant) -> tuple[int, int]:
    """The numbers of the shapes of an entry."""
    i, j = identity(constant.symbol).shapes
    assert isinstance(i, int) and isinstance(j, int)
    return i, j


def _roots(
    masses: Mapping[tuple[int, int], sp.Rational], stiffnesses: Mapping[tuple[int, int], sp.Rational]
) -> dict[tuple[int, int], sp.Rational]:
    """The entries of c8 (c8^-1 K)^(1/2), i <= j, that do not vanish."""
    with mpmath.workdps(DIGITS):
        c8, k = (_matrix(of) for of in (masses, stiffnesses))
        low = mpmath.cholesky(c8)
        inverse = low**-1
        squares, modes = mpmath.eigsy(inverse * k * inverse.T)
        root = low * modes * mpmath.diag([mpmath.sqrt(square) for square in squares]) * modes.T * low.T
        largest = max(abs(x) for x in root)
        entries = {(i, j): root[i - 1, j - 1] for i, j in masses}
        return {key: sp.Rational(float(x)) for key, x in entries.items() if abs(x) > NEGLIGIBLE * largest}


def _matrix(entries: Mapping[tuple[int, int], sp.Rational]) -> mpmath.matrix:
    """A symmetric matrix of numbers from its entries i <= j."""
    n = max(i for i, _ in entries)
    result = mpmath.matrix(n, n)
    for (i, j), value in entries.items():
        result[i - 1, j - 1] = result[j - 1, i - 1] = mpmath.mpf(int(value.p)) / int(value.q)
    return result
