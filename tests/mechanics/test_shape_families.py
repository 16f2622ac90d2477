"""Families of shape functions: their natural frequencies, their integrals by quadrature, and their zeros."""

from __future__ import annotations

from fractions import Fraction
from itertools import product

import numpy as np
import pytest
import sympy as sp

import derive
from derive.mechanics.bodies.beam_functions import polynomial
from derive.mechanics.symbols import Family

ROOTS = {
    "pinned": [np.pi**2, 4 * np.pi**2, 9 * np.pi**2],
    "free-free": [22.3732854, 61.6728229, 120.9033917],
    "clamped-free": [3.5160153, 22.0344916, 61.6972144],
}
"""Natural frequencies in sqrt(EI/(m l^3)), Blevins, Formulas for Natural Frequency and Mode Shape."""


def entries(kind: str, count: int, order: int = 1) -> dict[tuple[Family, tuple[int, ...], tuple[int, ...]], float]:
    """The integrals of a beam of unit mass, length and stiffness."""
    ansatz = {"kind": kind, "count": count}
    beam = derive.planar_beam("beam", ansatz=ansatz, mass=1, length=1, bending_stiffness=1, order=order)
    result = {}
    for c in derive.derive(beam).expanded().coefficients:
        known = c.symbol.identity
        result[known.family, known.shapes, known.components] = float(c.value)
    return result


@pytest.mark.parametrize("kind", ROOTS)
def test_frequencies_are_those_of_the_beam(kind: str) -> None:
    of = entries(kind, 3)
    for n, expected in enumerate(ROOTS[kind], 1):
        stiffness, mass = of[Family.STIFFNESS, (n, n), ()], of[Family.C8, (n, n), ()]
        assert np.sqrt(stiffness / mass) == pytest.approx(expected, rel=1e-8)
    for i, j in ((1, 2), (1, 3), (2, 3)):
        assert of[Family.STIFFNESS, (i, j), ()] == of[Family.C8, (i, j), ()] == 0


def test_integrals_of_pinned_sines_at_second_order_by_quadrature() -> None:
    """c2, c6, c9 and C5 of the sines, whose shortening is measured from the middle of the chord."""
    of = entries("pinned", 3, order=2)
    xi, weights = np.polynomial.legendre.leggauss(80)
    waves = np.array([np.sin(n * np.pi * (xi + 1) / 2) for n in (1, 2, 3)])

    def slope(n: int, at: np.ndarray) -> np.ndarray:
        return n * np.pi / 2 * np.cos(n * np.pi * (at + 1) / 2)

    def shortening(i: int, j: int) -> np.ndarray:
        """-2 int slope_i slope_j dxi from -1 to xi, less half of it over the whole beam."""
        along = [(x + 1) / 2 * np.dot(weights, slope(i, s := (x + 1) / 2 * (xi + 1) - 1) * slope(j, s)) for x in xi]
        whole = np.dot(weights, slope(i, xi) * slope(j, xi))
        return -2 * np.array(along) + whole

    for i in (1, 2, 3):
        wave = waves[i - 1]
        assert of[Family.C2, (i,), (2,)] == pytest.approx(np.dot(weights, wave) / 2, abs=1e-13)
        assert of[Family.C6, (i,), ()] == pytest.approx(np.dot(weights, xi * wave) / 4, abs=1e-13)
        for j in range(i, 4):
            psi = shortening(i, j)
            expected = np.dot(weights, wave * waves[j - 1]) / 2 + np.dot(weights, xi * psi) / 4
            assert of[Family.C9, (i, j), (1,)] == pytest.approx(np.dot(weights, psi) / 2, abs=1e-12)
            assert of[Family.C5, (i, j), ()] == pytest.approx(expected, abs=1e-12)


def test_polynomials_are_written_as_sympy_writes_them() -> None:
    values = (Fraction(0), Fraction(1), Fraction(-1), Fraction(-3, 2), Fraction(7, 3), Fraction(1, 2), Fraction(5))
    for coefficients in product(values, repeat=4):
        highest_first = [sp.Rational(c.numerator, c.denominator) for c in reversed(coefficients)]
        known = str(sp.Poly(highest_first, sp.Symbol("xi")).as_expr()).replace("**", "^")
        assert polynomial(coefficients).text == known
