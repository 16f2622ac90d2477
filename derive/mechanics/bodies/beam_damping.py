"""The damping matrix B of a planar beam: proportional to mass and stiffness, or a fraction of critical in each mode.

The deformation is damped, whatever the frame that it is measured from. Modes and mass matrix are therefore those of the
deformation without the rigid motion in it, which is that of the mean frame: c8_ij - c2_i c2_j/m - c6_i c6_j/C3.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import mpmath
import sympy as sp

from derive.mechanics import quantity
from derive.mechanics.quantity import rounded
from derive.mechanics.symbols import Family, identity, pair
from derive.mechanics.symbols import quantity as quantity_symbol
from derive.mechanics.terms import ModelConstant, ParameterSymbol
from derive.spec.model.body import BeamDamping, PlanarBeam
from derive.spec.model.quantity import Parameter

DIGITS = 60
"""Digits of the modes, whose results are rounded to doubles: the same on any machine."""

NEGLIGIBLE = mpmath.mpf(10) ** -40
UNCOUPLED = "these shapes (the modes that they are part of are damped alone)"

DAMPING_DOCS = {
    "ratio": "damping ratio",
    "mass": "factor of the mass in the damping",
    "stiffness": "factor of the stiffness in the damping",
}
"""What the constants of BeamDamping are."""

Numbers = Mapping[tuple[int, int], sp.Rational]
"""The entries (i, j), i <= j, of a symmetric matrix."""


def beam_damping(
    damping: BeamDamping,
    integrals: tuple[ModelConstant, ...],
    stiffness: tuple[ModelConstant, ...],
    mass: sp.Expr,
    unit: sp.Expr,
) -> tuple[ModelConstant, ...]:
    """The entries B_ij, i <= j, in N s/m, with the reasons of those that vanish; of bending or of stretching.

    integrals: those of the beam alone, without attached masses; stiffness: the entries K_ij of some shapes; mass: that
    of the beam, kg; unit: EI/l^3 or EA/l, N/m. Proportional damping is exact. In B = 2 ratio c8 (c8^-1 K)^(1/2) every
    mode of c8 and K has the ratio; the root is one of numbers, since c8/mass and K/unit are numbers.
    """
    ratio, of_mass, of_stiffness = (
        quantity.value(x, positive=False) for x in (damping.ratio, damping.mass, damping.stiffness)
    )
    stiffnesses = _numbers(stiffness, unit)
    deforming = _deforming_mass(integrals, mass)
    masses = {key: deforming[key] for key in stiffnesses}
    roots: Numbers = _roots(masses, stiffnesses) if ratio != 0 else {}
    number, symbols = sp.expand(mass * unit).as_coeff_Mul()
    root_unit = rounded(sp.sqrt(number)) * sp.sqrt(symbols)  # SymPy would keep an irrational factor such as sqrt(2)
    result = []
    for entry in stiffness:
        key = _shapes(entry)
        value = of_mass * masses[key] * mass + of_stiffness * entry.value
        value += 2 * ratio * root_unit * roots.get(key, sp.S.Zero)
        zero = None if value != 0 else UNCOUPLED if roots else entry.zero or UNCOUPLED
        doc = f"damping of modes {key[0]} and {key[1]}"
        result.append(ModelConstant(pair(Family.DAMPING, *key), rounded(value), "(13)", doc, "N s/m", zero))
    return tuple(result)


def damping_parameters(beam: PlanarBeam) -> Iterator[ParameterSymbol]:
    """The run-time parameters of the damping of a beam."""
    for key, value in vars(beam.damping).items() if beam.damping else ():
        if isinstance(value, Parameter):
            yield quantity.parameter(value, f"{DAMPING_DOCS[key]} of the beam", positive=False)


def retardation(stiffness: tuple[ModelConstant, ...], damping: tuple[ModelConstant, ...], unit: sp.Expr) -> sp.Matrix:
    """K^-1 B (s): the amplitudes whose elastic forces are the damping forces of given velocities.

    Of proportional damping it is the factor of the stiffness, the retardation time of the material, times the unit
    matrix, if that of the mass is zero.
    """
    K, B = _symmetric(_numbers(stiffness, unit)), _symmetric({_shapes(c): c.value / unit for c in damping})
    return (K.inv() * B).expand()


def _deforming_mass(integrals: tuple[ModelConstant, ...], mass: sp.Expr) -> Numbers:
    """The mass matrix of the deformation without its rigid motion, over the mass of a beam with its centre in O."""
    known = {c.symbol: c.value for c in integrals}
    inertia = known[quantity_symbol(Family.C3)]

    def displaced(i: int, k: int) -> sp.Expr:
        return known[quantity_symbol(Family.C2, k, shapes=(i,))]

    def rotated(i: int) -> sp.Expr:
        return known[quantity_symbol(Family.C6, shapes=(i,))]

    result = {}
    for c in integrals:
        if identity(c.symbol).family is Family.C8:
            i, j = _shapes(c)
            moved = sp.Add(*(displaced(i, k) * displaced(j, k) for k in (1, 2)))
            rigid = moved / mass + rotated(i) * rotated(j) / inertia
            result[i, j] = sp.Rational((c.value - rigid) / mass)
    return result


def _numbers(constants: tuple[ModelConstant, ...], unit: sp.Expr) -> Numbers:
    """Entries that are rational multiples of a unit."""
    return {_shapes(c): sp.Rational(c.value / unit) for c in constants}


def _shapes(constant: ModelConstant) -> tuple[int, int]:
    """The numbers of the shapes of an entry."""
    i, j = identity(constant.symbol).shapes
    assert isinstance(i, int) and isinstance(j, int)
    return i, j


def _roots(masses: Numbers, stiffnesses: Numbers) -> Numbers:
    """The entries of c8 (c8^-1 K)^(1/2), i <= j, that do not vanish."""
    with mpmath.workdps(DIGITS):
        c8, k = (_high_precision(_symmetric(of)) for of in (masses, stiffnesses))
        low = mpmath.cholesky(c8)
        inverse = low**-1
        squares, modes = mpmath.eigsy(inverse * k * inverse.T)
        root = low * modes * mpmath.diag([mpmath.sqrt(square) for square in squares]) * modes.T * low.T
        largest = max(abs(x) for x in root)
        first = min(i for i, _ in masses)
        entries = {(i, j): root[i - first, j - first] for i, j in masses}
        return {key: sp.Rational(float(x)) for key, x in entries.items() if abs(x) > NEGLIGIBLE * largest}


def _symmetric(entries: Mapping[tuple[int, int], sp.Expr]) -> sp.Matrix:
    """A symmetric matrix from its entries i <= j, of shapes that follow each other."""
    first, last = min(i for i, _ in entries), max(i for i, _ in entries)
    n = last - first + 1
    return sp.Matrix(n, n, lambda i, j: entries[first + min(i, j), first + max(i, j)])


def _high_precision(matrix: sp.Matrix) -> mpmath.matrix:
    """A matrix of fractions with the digits of the context."""
    return mpmath.matrix([[mpmath.mpf(int(x.p)) / int(x.q) for x in matrix.row(i)] for i in range(matrix.rows)])
