"""Material points: position, velocity and Jacobian, and the work of a force there, from fields taken at the point."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING

from derive.algebra import sp
from derive.mechanics import zeros
from derive.mechanics.motion.kinematics import ONE, PHI, RDOT, Field, R
from derive.mechanics.motion.products import product
from derive.mechanics.sums import ALPHA, ModeSum, TableSum
from derive.mechanics.symbols import Family, I, amplitude, quantity, vector
from derive.mechanics.tables import point_tables
from derive.mechanics.terms import Intermediate, MarkerEquations, ModelConstant

if TYPE_CHECKING:
    from derive.mechanics.motion.body_motion import Motion
    from derive.mechanics.typed_symbol import Symbol

KEPT = 64
"""The number of points whose motion is kept: equal pieces of a rod have equal points, and so have models of a study."""


@dataclass(frozen=True)
class MaterialPoint:
    """A named material point: its reference position X and the values of the N shapes there, in the body frame.

    `second` (N, N) are the values of the Psi_ij there; empty at first order.
    """

    name: str
    doc: str
    position: sp.ImmutableMatrix
    shapes: tuple[sp.ImmutableMatrix, ...]
    coefficients: tuple[ModelConstant, ...] = ()
    second: tuple[tuple[sp.ImmutableMatrix, ...], ...] = ()


@dataclass(frozen=True)
class Tangents:
    """The vectors dr/dalpha_i at a point for each shape, and the symbols in them with their values and descriptions."""

    vectors: tuple[sp.Matrix, ...]
    definitions: tuple[tuple[Symbol, sp.Expr, str], ...]


def tangent_vectors(motion: Motion, point: MaterialPoint, name: Callable[[int, int], Symbol]) -> Tangents:
    """Return dr/dalpha_i = Phi_i + sum alpha_j Psi_ij at a point; variable components become symbols, by i and axis."""
    vectors, definitions = [], []
    for i, shape in enumerate(point.shapes, 1):
        tangent = sp.Matrix(shape)
        for k, part in enumerate(_second(point, i, motion.alpha) if point.second else (), 1):
            if part != 0:
                symbol = name(i, k)
                definitions.append((symbol, tangent[k - 1] + part, f"dr/dalpha_{i} . e{k} at marker {point.name}"))
                tangent[k - 1] = symbol
        vectors.append(tangent)
    return Tangents(tuple(vectors), tuple(definitions))


def radius_and_rate(motion: Motion, point: MaterialPoint, tangents: Sequence[sp.Matrix]) -> tuple[sp.Matrix, sp.Matrix]:
    """The vectors r = X + sum alpha_i (Phi_i + dr/dalpha_i)/2 and rdot = sum alphadot_i dr/dalpha_i at a point."""
    r, rdot = sp.Matrix(point.position), sp.zeros(motion.rotation.rows, 1)
    for a, rate, shape, tangent in zip(motion.alpha, motion.alphadot, point.shapes, tangents, strict=True):
        r += (sp.Matrix(shape) + tangent) / 2 * a
        rdot += tangent * rate
    return r, rdot


def acceleration_of_rates(motion: Motion, point: MaterialPoint) -> sp.Matrix:
    """The vector sum alphadot_i alphadot_j Psi_ij at a point: rddot without accelerations."""
    result = sp.zeros(motion.rotation.rows, 1)
    for i, rate in enumerate(motion.alphadot if point.second else (), 1):
        result += _second(point, i, motion.alphadot) * rate
    return result


def _second(point: MaterialPoint, i: int, factors: Sequence[sp.Symbol]) -> sp.Matrix:
    """The sum over j of factor_j Psi_ij at a point."""
    row = zip(point.second[i - 1], factors, strict=True)
    return sum((sp.Matrix(psi) * f for psi, f in row), sp.zeros(*point.position.shape))


def vector_at(motion: Motion, field: Field, values: Mapping[str, sp.Matrix]) -> sp.Matrix:
    """The value of a field at a material point, in the inertial frame; `values` are r, rdot and Phi_i there."""
    still = sp.zeros(motion.rotation.rows, 1)
    moving = (tensor * values[name] for name, tensor in field.items() if name != ONE)
    return (field.get(ONE, still) + product(motion.rotation, sum(moving, still))).expand()


def work_at(motion: Motion, field: Field, values: Mapping[str, sp.Matrix]) -> sp.Expr:
    """The work of a force at a material point on a displacement; see `force_vector` and `force_definitions`."""
    still = sp.zeros(motion.rotation.rows, 1)
    seen = sp.Matrix([d.symbol for d in force_definitions(motion)])
    moving = (tensor * values[name] for name, tensor in field.items() if name != ONE)
    return sp.expand(force_vector(motion).dot(field.get(ONE, still)) + seen.dot(sum(moving, still)))


def force_vector(motion: Motion) -> sp.Matrix:
    """The symbols of a force F_1, F_2, ... in the inertial frame."""
    return vector(Family.FORCE, motion.rotation.rows)


def force_definitions(motion: Motion) -> tuple[Intermediate, ...]:
    """The definitions of the force resolved in the body frame."""
    return tuple(
        Intermediate(
            quantity(Family.BODY_FORCE, k), expr, "F", "(10)", f"force along the axis {k} of the floating frame"
        )
        for k, expr in enumerate(motion.rotation.T * force_vector(motion), 1)
    )


@lru_cache(KEPT)
def marker(motion: Motion, point: MaterialPoint) -> MarkerEquations:
    """Position, velocity and Jacobian of a material point, from the same fields taken at that point."""

    axes = range(motion.rotation.rows)
    tangents = tangent_vectors(motion, point, lambda shape, k: quantity(Family.TANGENT, k, shapes=(shape,)))
    r, rdot = radius_and_rate(motion, point, tangents.vectors)
    local = (
        *(Intermediate(s, value, "r", "(6)", doc) for s, value, doc in tangents.definitions),
        *(
            Intermediate(symbol, value[k], "r", "(1), (14)", f"{symbol.identity.section} . e{k + 1} at the marker")
            for derivative, value in enumerate((r, rdot))
            for k in axes
            for symbol in [quantity(Family.RADIUS, k + 1, derivative=derivative)]
        ),
    )
    kept, known = zeros.drop_definitions(local, zeros.reasons_of(point.coefficients))
    at = {f: vector(Family.RADIUS, len(axes), derivative=d) for d, f in enumerate((R, RDOT))}
    equations = _equations(motion, point, at, tangents.vectors)

    def kept_parts(matrix: sp.ImmutableMatrix) -> sp.ImmutableMatrix:
        return matrix.applyfunc(lambda e: zeros.drop(e, known))

    return replace(
        equations,
        definitions=kept,
        position=kept_parts(equations.position),
        velocity=kept_parts(equations.velocity),
        jacobian=kept_parts(equations.jacobian),
        load=tuple(zeros.drop(e, known) for e in equations.load),
    )


def _equations(
    motion: Motion, point: MaterialPoint, at: Mapping[str, sp.Matrix], tangents: Iterable[sp.Matrix]
) -> MarkerEquations:
    """The equations of a marker from r and rdot there, and from dr/dalpha_i of each mode or of a generic one."""
    displacements = [(field, at) for field in (*motion.translations, *motion.frame.rotations())]
    displacements += [(motion.frame.deformation(), {**at, PHI: tangent}) for tangent in tangents]
    return MarkerEquations(
        name=point.name,
        doc=point.doc,
        definitions=(),
        force=sp.ImmutableMatrix(force_vector(motion)),
        force_definitions=force_definitions(motion),
        load=tuple(work_at(motion, field, values) for field, values in displacements),
        position=sp.ImmutableMatrix(vector_at(motion, motion.position, at)),
        velocity=sp.ImmutableMatrix(vector_at(motion, motion.velocity, at)),
        jacobian=sp.ImmutableMatrix.hstack(*(vector_at(motion, field, values) for field, values in displacements)),
    )


def indexed_marker(motion: Motion, number: int, point: MaterialPoint, deforms: bool) -> MarkerEquations:
    """The marker equations for a generic shape, whose column and whose row of the load come last.

    X and the shapes at the point are tables, see `point_tables`; `motion` is that of the rigid body.
    """
    dimension = motion.rotation.rows
    x, phi, *second = (t.generic_entries for t in point_tables(number, point.name, dimension, bool(point.second)))
    tangents = phi
    table_sums: tuple[TableSum, ...] = ()
    if second:
        tangents = tuple(vector(Family.TANGENT, dimension, shapes=(I,)))
        parts = zip(tangents, phi, second[0], strict=True)
        table_sums = tuple(TableSum(t, shape, ((ALPHA, psi),), "dr/dalpha_{i}") for t, shape, psi in parts)
    r, rdot = (vector(Family.RADIUS, dimension, derivative=d) for d in (0, 1))
    mode_sums = []
    for k, (position, shape, tangent) in enumerate(zip(x, phi, tangents, strict=True) if deforms else ()):
        mode_sums.append(ModeSum(r[k], position, amplitude(I) * (shape + tangent) / 2, "X + u at the marker"))
        mode_sums.append(ModeSum(rdot[k], sp.S.Zero, amplitude(I, 1) * tangent, "its rate"))
    if not deforms:
        r, rdot = sp.Matrix(x), sp.zeros(dimension, 1)
    equations = _equations(motion, point, {R: r, RDOT: rdot}, [sp.Matrix(tangents)])
    return replace(equations, mode_sums=tuple(mode_sums), table_sums=table_sums)
