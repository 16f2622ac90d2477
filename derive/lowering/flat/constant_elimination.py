"""Accelerations of a planar body whose mass matrix is constant but for one row, once it is resolved in the body frame.

With vdot = T x, T = diag(Q, I), the equations M vdot + h = 0 become T^T M T x = -T^T h. Objectivity makes T^T M T
independent of the rotation. In first order the amplitudes enter it only through the row of phi. The other rows have a
constant block A, whose exact inverse is known at generation time:

    x_A = z - g x_phi,    z = -A^-1 h_A,    g = A^-1 d,    (J - d . g) x_phi = -h_phi - d . z

with the column d of phi. All of these are polynomials in the state, from which everything that cancels is gone: the
centrifugal forces on the shapes, for example, are A times the amplitudes. What remains is a single division.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TypeAlias

from sympy.polys.matrices import DomainMatrix

from derive.algebra import sp
from derive.lowering.flat.polynomials import Coefficient, NotPolynomialError, Polynomial, StatePolynomials, rational
from derive.lowering.ldlt import VANISHING
from derive.mechanics.equations import Equations

Matrix: TypeAlias = list[list[Polynomial]]


@dataclass(frozen=True)
class ConstantBlock:
    """Rows of the mass matrix that couple to each other by constants: A = unit times a rational matrix.

    rows: their indices. unit: the first diagonal entry, which has the sign of all pivots. inverse: of A.
    """

    rows: tuple[int, ...]
    unit: Coefficient
    inverse: list[list[Coefficient]]


@dataclass(frozen=True)
class ReducedSystem:
    """The equation pivot x = right of the row that is not constant, and the others, x_i = free_i - coupling_i x.

    polynomials: the ring. row: the index of that row. column: its entries d_i in the mass matrix in the body frame.
    blocks: the constant blocks, which hold all other rows.
    """

    polynomials: StatePolynomials
    row: int
    pivot: Polynomial
    right: Polynomial
    column: dict[int, Polynomial]
    free: dict[int, Polynomial]
    coupling: dict[int, Polynomial]
    blocks: tuple[ConstantBlock, ...]

    @property
    def is_definite(self) -> bool:
        """Whether the pivot exceeds the rounding errors of its elimination in every state.

        A positive constant and a positive definite quadratic form in the amplitudes need no check of this at run time.
        """
        zero = self.polynomials.ring.zero
        taken = sum((entry * self.coupling[i] for i, entry in self.column.items()), start=zero)
        domain = self.polynomials.ring.domain
        margin = domain.from_sympy(sp.Rational(VANISHING.numerator, VANISHING.denominator))
        return _is_positive(self.polynomials, self.pivot - taken * margin)

    @property
    def is_positive(self) -> bool:
        """Whether the pivot is positive in every state however its sum is rounded, so that no check is needed.

        The products of a quadratic form of n amplitudes add up to at most n times those of its diagonal, and each is
        rounded some n times: VANISHING of the diagonal is more than these errors for each n below 200.
        """
        ring = self.polynomials.ring
        squares = (x**2 for x in map(ring, self.polynomials.amplitudes))
        diagonal = [square * self.pivot.coeff(square) for square in squares]
        margin = Fraction(len(diagonal)) * VANISHING
        errors = sum(diagonal, start=ring.zero) * ring.domain.from_sympy(
            sp.Rational(margin.numerator, margin.denominator)
        )
        return self.is_definite and _is_positive(self.polynomials, self.pivot - errors)


def reduced_system(equations: Equations) -> ReducedSystem | None:
    """The system of a planar body, None where M has another structure or is nearly singular."""
    if equations.body is None or equations.body.dimension != 2:
        return None
    try:
        polynomials = StatePolynomials(equations)
        mass = _mass_in_body_frame(equations, polynomials)
        varying = [i for i, line in enumerate(mass) if not line[i].is_ground]
        if len(varying) != 1:
            return None
        force = _force_in_body_frame(equations, polynomials, mass)
    except NotPolynomialError:
        return None
    row = varying[0]
    others = [i for i in range(len(mass)) if i != row]
    blocks = [_block(polynomials, mass, rows) for rows in _components(mass, others)]
    known = tuple(block for block in blocks if block is not None)
    if len(known) < len(blocks):
        return None
    column = {i: mass[i][row] for i in others}
    free = _solved(polynomials, known, {i: -force[i] for i in others})
    coupling = _solved(polynomials, known, column)
    zero = polynomials.ring.zero
    pivot = mass[row][row] - sum((column[i] * coupling[i] for i in others), start=zero)
    right = -force[row] - sum((column[i] * free[i] for i in others), start=zero)
    if max(map(polynomials.degree, (pivot, right, *free.values(), *coupling.values()))) > 2:
        return None
    return ReducedSystem(polynomials, row, pivot, right, column, free, coupling, known)


def _mass_in_body_frame(equations: Equations, polynomials: StatePolynomials) -> Matrix:
    """The mass matrix T^T M T in the body frame. Raises NotPolynomialError if it depends on the rotation."""
    size = equations.mass.rows
    turn = _turn(equations, polynomials)
    inertial = [[polynomials(equations.mass[i, j]) for j in range(size)] for i in range(size)]
    mass = _product(_transposed(turn), _product(inertial, turn, polynomials), polynomials)
    if polynomials.rotates(entry for line in mass for entry in line):
        raise NotPolynomialError("the mass matrix in the body frame depends on the rotation")
    return mass


def _force_in_body_frame(equations: Equations, polynomials: StatePolynomials, mass: Matrix) -> list[Polynomial]:
    """T^T h with gravity in components of the body frame. Raises NotPolynomialError if it depends on the rotation."""
    turned = _product(
        _transposed(_turn(equations, polynomials)), [[polynomials(h)] for h in equations.force], polynomials
    )
    force = [line[0] for line in turned]
    for k, seen in polynomials.weight.items():
        force[k] = polynomials.reduced(force[k] + mass[k][k] * (seen.value - seen.generator))
    if polynomials.rotates(force):
        raise NotPolynomialError("the forces in the body frame depend on the rotation")
    return force


def _turn(equations: Equations, polynomials: StatePolynomials) -> Matrix:
    """The transformation T = diag(Q, I) from the body frame to the inertial frame."""
    assert equations.body is not None
    ring, size, rotation = polynomials.ring, equations.mass.rows, equations.body.motion.rotation
    turn = [[ring.one if i == j else ring.zero for j in range(size)] for i in range(size)]
    for i in range(rotation.rows):
        for j in range(rotation.rows):
            turn[i][j] = polynomials(rotation[i, j])
    return turn


def _transposed(matrix: Matrix) -> Matrix:
    return [list(column) for column in zip(*matrix, strict=True)]


def _product(a: Matrix, b: Matrix, polynomials: StatePolynomials) -> Matrix:
    """The product of two matrices, without sin^2."""
    zero, columns = polynomials.ring.zero, _transposed(b)
    return [
        [
            polynomials.reduced(sum((x * y for x, y in zip(row, column, strict=True) if x and y), start=zero))
            for column in columns
        ]
        for row in a
    ]


def _components(mass: Matrix, rows: Sequence[int]) -> list[tuple[int, ...]]:
    """The sets of rows that couple to each other."""
    result: list[tuple[int, ...]] = []
    waiting = list(rows)
    while waiting:
        component = [waiting.pop(0)]
        for i in component:
            coupled = [j for j in waiting if mass[i][j]]
            waiting = [j for j in waiting if j not in coupled]
            component += coupled
        result.append(tuple(sorted(component)))
    return result


def _block(polynomials: StatePolynomials, mass: Matrix, rows: tuple[int, ...]) -> ConstantBlock | None:
    """A block with its inverse; None if it varies, is nearly singular, or is no rational matrix times a unit."""
    values = _multiple(polynomials, [[mass[i][j] for j in rows] for i in rows])
    if values is None or not _is_definite(values):
        return None
    domain, unit = polynomials.ring.domain, mass[rows[0]][rows[0]].coeff(1)
    exact = [[sp.QQ(x.numerator, x.denominator) for x in line] for line in values]
    inverse = DomainMatrix(exact, (len(rows), len(rows)), sp.QQ).inv().to_list()
    return ConstantBlock(rows, unit, [[domain.convert_from(x, sp.QQ) / unit for x in line] for line in inverse])


def _is_positive(polynomials: StatePolynomials, polynomial: Polynomial) -> bool:
    """Whether a polynomial is known to be positive: a positive constant plus a positive definite quadratic form.

    The latter is a rational matrix times a positive unit.
    """
    ring = polynomials.ring
    constant = polynomial.coeff(1)
    form = polynomial - constant
    used = sorted({k for powers in form for k, power in enumerate(powers) if power})
    at = {k: n for n, k in enumerate(used)}
    entries = [[ring.zero] * len(used) for _ in used]
    for powers, coefficient in form.terms():
        factors = [k for k, power in enumerate(powers) for _ in range(power)]
        if len(factors) != 2:
            return False
        i, j = (at[k] for k in factors)
        entries[i][j] = entries[j][i] = ring.ground_new(coefficient if i == j else coefficient / 2)
    if not polynomials.is_positive(constant):
        return False
    matrix = _multiple(polynomials, entries)
    return not used or (matrix is not None and polynomials.is_positive(entries[0][0].coeff(1)) and _is_definite(matrix))


def _multiple(polynomials: StatePolynomials, entries: Matrix) -> list[list[Fraction]] | None:
    """A matrix divided by its first entry; None if the quotients are not rational numbers."""
    if not entries or not entries[0][0] or not all(entry.is_ground for line in entries for entry in line):
        return None
    unit = entries[0][0].coeff(1)
    quotients = [[rational(polynomials.ring.domain, entry.coeff(1) / unit) for entry in line] for line in entries]
    values = [[x for x in line if x is not None] for line in quotients]
    return values if all(len(line) == len(entries) for line in values) else None


def _is_definite(matrix: list[list[Fraction]]) -> bool:
    """Whether the pivots of a symmetric matrix are positive, and larger than rounding errors of its diagonal."""
    work = [row[:] for row in matrix]
    for k, row in enumerate(work):
        if row[k] <= VANISHING * matrix[k][k]:
            return False
        for below in work[k + 1 :]:
            factor = below[k] / row[k]
            for j in range(k, len(row)):
                below[j] -= factor * row[j]
    return True


def _solved(
    polynomials: StatePolynomials, blocks: Sequence[ConstantBlock], right: dict[int, Polynomial]
) -> dict[int, Polynomial]:
    """A^-1 times a vector of polynomials."""
    zero = polynomials.ring.zero
    return {
        i: sum((right[j] * x for j, x in zip(block.rows, line, strict=True) if x), start=zero)
        for block in blocks
        for i, line in zip(block.rows, block.inverse, strict=True)
    }
