"""The damping matrix B of a planar beam: proportional to mass and stiffness, or a fraction of critical in each mode.

The deformation is damped, whatever the frame that it is measured from, and in however many pieces. Modes and mass
matrix are therefore those of the deformation of the whole rod without the rigid motion in it, see `rod_deformation`.
The damping forces on the amplitudes of one piece are then linear in the rates of all: B alphadot, which vanishes in
every rigid motion, since amplitudes do not change in it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cache
from itertools import combinations_with_replacement
from typing import TYPE_CHECKING

import mpmath

from derive.algebra import sp
from derive.mechanics import quantity
from derive.mechanics.bodies.beam_stiffness import beam_stiffness, stiffness_units
from derive.mechanics.bodies.displacement_fields import displacement_fields
from derive.mechanics.bodies.rod_deformation import deformation_mass
from derive.mechanics.quantity import rounded
from derive.mechanics.symbols import Family, pair
from derive.mechanics.terms import ModelConstant, ParameterSymbol
from derive.spec.model.beam import PlanarBeam
from derive.spec.model.beam_parts import BeamDamping
from derive.spec.model.quantity import Parameter

if TYPE_CHECKING:
    from derive.mechanics.bodies.beam_integrals import BeamField

DIGITS = 60
"""The precision of the modes in digits; results are rounded to doubles, so that they are the same on any machine."""

NEGLIGIBLE = mpmath.mpf(10) ** -40
UNCOUPLED = "these shapes (the modes that they are part of are damped alone)"

DAMPING_DOCS = {
    "ratio": "damping ratio",
    "mass": "factor of the mass in the damping",
    "stiffness": "factor of the stiffness in the damping",
}
"""The descriptions of the constants of BeamDamping."""


def damping_constants(beam: PlanarBeam, pieces: int = 1) -> tuple[ModelConstant, ...]:
    """The entries B_ij, i <= j, in N s/m, of a beam or of a rod in pieces, with the reasons of those that vanish.

    The amplitudes of a rod are counted through its pieces from left to right. Without damping there are no entries.
    """
    if beam.damping is None:
        return ()
    fields, entries = displacement_fields(beam), dict[tuple[int, int], sp.Expr]()
    for axis in stiffness_units(beam, pieces):
        numbers, B = _amplitudes(fields, axis, pieces), _matrix(beam, axis, pieces)
        entries |= {(i, j): B[p, q] for p, i in enumerate(numbers) for q, j in enumerate(numbers)}
    of_stiffness = {c.symbol.identity.shapes: c.zero for c in beam_stiffness(beam)} if pieces == 1 else {}
    result = []
    for i, j in combinations_with_replacement(range(1, len(fields) * pieces + 1), 2):
        value, zero = entries.get((i, j), sp.S.Zero), None
        if value == 0:
            alone = (i, j) in entries and beam.damping.ratio != 0
            zero = UNCOUPLED if alone else of_stiffness.get((i, j)) or UNCOUPLED
        doc = f"damping of modes {i} and {j}"
        result.append(ModelConstant(pair(Family.DAMPING, i, j), value, "(13)", doc, "N s/m", zero))
    return tuple(result)


def retardation_times(beam: PlanarBeam, pieces: int = 1) -> sp.Matrix:
    """The matrix K^-1 B (s) of the bending of a beam with damping, or of all pieces of a rod.

    It gives the amplitudes whose elastic forces are the damping forces of given velocities. Of damping that is
    proportional to the stiffness it is the retardation time of the material times the unit matrix.
    """
    unit = stiffness_units(beam, pieces)[2]
    return (_stiffness(beam, 2, pieces).inv() * _matrix(beam, 2, pieces) / unit).expand()


def _amplitudes(fields: Sequence[BeamField], axis: int, pieces: int) -> list[int]:
    """The numbers of the amplitudes of a rod that displace it along the axis (1) or across it (2)."""
    return [len(fields) * k + i for k in range(pieces) for i, field in enumerate(fields, 1) if field.axis == axis]


def _stiffness(beam: PlanarBeam, axis: int, pieces: int) -> sp.Matrix:
    """The stiffness matrix of bending (2) or of stretching (1), in units of `stiffness_units`."""
    unit, shapes = stiffness_units(beam)[axis], _amplitudes(displacement_fields(beam), axis, 1)
    entries = {c.symbol.identity.shapes: c.value for c in beam_stiffness(beam)}

    def entry(i: int, j: int) -> sp.Rational:
        return sp.Rational(entries[shapes[min(i, j)], shapes[max(i, j)]] / unit)

    piece = sp.Matrix(len(shapes), len(shapes), entry)
    return sp.diag(*[piece] * pieces)


def _matrix(beam: PlanarBeam, axis: int, pieces: int) -> sp.Matrix:
    """The damping matrix B of bending (2) or of stretching (1)."""
    assert beam.damping is not None
    shapes = tuple(field.of for field in displacement_fields(beam) if field.axis == axis)
    M, K = deformation_mass(shapes, axis, pieces), _stiffness(beam, axis, pieces)
    return damping_matrix(beam.damping, M, K, quantity.value(beam.mass), stiffness_units(beam, pieces)[axis])


def damping_matrix(damping: BeamDamping, M: sp.Matrix, K: sp.Matrix, mass: sp.Expr, stiffness: sp.Expr) -> sp.Matrix:
    """The damping matrix B of a deformation with the matrices mass M and stiffness K. Proportional damping is exact.

    In 2 ratio M (M^-1 K)^(1/2) every mode of M and K has the ratio; the root is that of matrices of numbers.
    """
    ratio, of_mass, of_stiffness = (quantity.value(x, positive=False) for x in vars(damping).values())
    result = of_mass * mass * M + of_stiffness * stiffness * K
    if ratio != 0:
        number, symbols = sp.expand(mass * stiffness).as_coeff_Mul()
        unit = rounded(sp.sqrt(number)) * sp.sqrt(symbols)  # SymPy would keep an irrational factor such as sqrt(2)
        result += 2 * ratio * unit * _root(M.as_immutable(), K.as_immutable())
    return result.applyfunc(rounded)


def damping_parameters(beam: PlanarBeam) -> Iterator[ParameterSymbol]:
    """The run-time parameters of the damping of a beam."""
    for key, value in vars(beam.damping).items() if beam.damping else ():
        if isinstance(value, Parameter):
            yield quantity.parameter(value, f"{DAMPING_DOCS[key]} of the beam", positive=False)


@cache
def _root(mass: sp.ImmutableMatrix, stiffness: sp.ImmutableMatrix) -> sp.ImmutableMatrix:
    """The matrix M (M^-1 K)^(1/2), whose entries are rounded to doubles."""
    with mpmath.workdps(DIGITS):
        low = mpmath.cholesky(_high_precision(mass))
        inverse = low**-1
        squares, modes = mpmath.eigsy(inverse * _high_precision(stiffness) * inverse.T)
        root = low * modes * mpmath.diag([mpmath.sqrt(square) for square in squares]) * modes.T * low.T
        least = NEGLIGIBLE * max(abs(x) for x in root)
        return sp.ImmutableMatrix(
            *mass.shape, lambda i, j: sp.Rational(float(x)) if abs(x := root[min(i, j), max(i, j)]) > least else 0
        )


def _high_precision(matrix: sp.ImmutableMatrix) -> mpmath.matrix:
    """A matrix of fractions converted to the precision of the mpmath context."""
    return mpmath.matrix([[mpmath.mpf(int(x.p)) / int(x.q) for x in matrix.row(i)] for i in range(matrix.rows)])
