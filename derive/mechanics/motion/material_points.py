"""Material points: position, velocity and Jacobian, and the work of a force there, from fields taken at the point."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import sympy as sp

from derive.mechanics import zeros
from derive.mechanics.motion.body_motion import Motion
from derive.mechanics.motion.kinematics import ONE, PHI, RDOT, Field, R
from derive.mechanics.sums import ModeSum
from derive.mechanics.symbols import Family, I, amplitude, quantity, vector
from derive.mechanics.tables import point_tables
from derive.mechanics.terms import Intermediate, MarkerEquations, ModelConstant


@dataclass(frozen=True)
class MaterialPoint:
    """A named material point: its reference position X and the values of the N shapes there, in the body frame."""

    name: str
    doc: str
    position: sp.ImmutableMatrix
    shapes: tuple[sp.ImmutableMatrix, ...]
    coefficients: tuple[ModelConstant, ...] = ()


def vector_at(motion: Motion, field: Field, values: Mapping[str, sp.Matrix]) -> sp.Matrix:
    """A field at a material point, in the inertial frame; `values` are r, rdot and Phi_i there."""
    still = sp.zeros(motion.rotation.rows, 1)
    moving = (tensor * values[name] for name, tensor in field.items() if name != ONE)
    return (field.get(ONE, still) + motion.rotation * sum(moving, still)).expand()


def work_at(motion: Motion, field: Field, values: Mapping[str, sp.Matrix]) -> sp.Expr:
    """The work of a force at a material point on a displacement; see `force_vector` and `force_definitions`."""
    still = sp.zeros(motion.rotation.rows, 1)
    seen = sp.Matrix([d.symbol for d in force_definitions(motion)])
    moving = (tensor * values[name] for name, tensor in field.items() if name != ONE)
    return sp.expand(force_vector(motion).dot(field.get(ONE, still)) + seen.dot(sum(moving, still)))


def force_vector(motion: Motion) -> sp.Matrix:
    """A force F_1, F_2, ... in the inertial frame."""
    return vector(Family.FORCE, motion.rotation.rows)


def force_definitions(motion: Motion) -> tuple[Intermediate, ...]:
    """The force in the body frame."""
    return tuple(
        Intermediate(
            quantity(Family.BODY_FORCE, k), expr, "F", "(10)", f"force along the axis {k} of the floating frame"
        )
        for k, expr in enumerate(motion.rotation.T * force_vector(motion), 1)
    )


def marker(motion: Motion, point: MaterialPoint, reasons: zeros.Reasons) -> MarkerEquations:
    """Position, velocity and Jacobian of a material point, from the same fields taken at that point."""

    def at_point(amplitudes: tuple[sp.Symbol, ...], offset: sp.Matrix) -> sp.Matrix:
        return sum((shape * a for shape, a in zip(point.shapes, amplitudes, strict=True)), offset)

    derivatives, axes = {R: 0, RDOT: 1}, range(motion.rotation.rows)
    still = sp.zeros(len(axes), 1)
    values = {R: at_point(motion.alpha, sp.Matrix(point.position)), RDOT: at_point(motion.alphadot, still)}
    local = tuple(
        Intermediate(symbol, value[k], "r", "(1), (14)", f"{symbol.identity.section} . e{k + 1} at the marker")
        for f, value in values.items()
        for k in axes
        for symbol in [quantity(Family.RADIUS, k + 1, derivative=derivatives[f])]
    )
    kept, known = zeros.drop_definitions(local, reasons)
    vectors = {f: vector(Family.RADIUS, len(axes), derivative=d) for f, d in derivatives.items()}

    def inertial(field: Field) -> sp.Matrix:
        return vector_at(motion, field, vectors).applyfunc(lambda e: zeros.drop(e, known))

    def work(field: Field) -> sp.Expr:
        return zeros.drop(work_at(motion, field, vectors), known)

    columns, load = [], []
    for field in (*motion.translations, *motion.frame.rotations()):
        columns.append(inertial(field))
        load.append(work(field))
    for shape in point.shapes:
        vectors[PHI] = sp.Matrix(shape)
        columns.append(inertial(motion.frame.deformation()))
        load.append(work(motion.frame.deformation()))
    return MarkerEquations(
        name=point.name,
        doc=point.doc,
        definitions=kept,
        force=sp.ImmutableMatrix(force_vector(motion)),
        force_definitions=force_definitions(motion),
        load=tuple(load),
        position=sp.ImmutableMatrix(inertial(motion.position)),
        velocity=sp.ImmutableMatrix(inertial(motion.velocity)),
        jacobian=sp.ImmutableMatrix.hstack(*columns),
    )


def indexed_marker(motion: Motion, number: int, point: MaterialPoint, deforms: bool) -> MarkerEquations:
    """The same for a generic shape, whose column and whose row of the load come last.

    X and the shapes at the point are tables, see `point_tables`; `motion` is that of the rigid body.
    """
    dimension = motion.rotation.rows
    x, phi = (table.generic_entries for table in point_tables(number, point.name, dimension))
    r, rdot = (vector(Family.RADIUS, dimension, derivative=d) for d in (0, 1))
    mode_sums = []
    for k, (position, shape) in enumerate(zip(x, phi, strict=True) if deforms else ()):
        mode_sums.append(ModeSum(r[k], position, amplitude(I) * shape, "X + u at the marker"))
        mode_sums.append(ModeSum(rdot[k], sp.S.Zero, amplitude(I, 1) * shape, "its rate"))
    if not deforms:
        r, rdot = sp.Matrix(x), sp.zeros(dimension, 1)
    at = {R: r, RDOT: rdot, PHI: sp.Matrix(phi)}
    displacements = (*motion.translations, *motion.frame.rotations(), motion.frame.deformation())
    return MarkerEquations(
        name=point.name,
        doc=point.doc,
        definitions=(),
        mode_sums=tuple(mode_sums),
        force=sp.ImmutableMatrix(force_vector(motion)),
        force_definitions=force_definitions(motion),
        load=tuple(work_at(motion, d, at) for d in displacements),
        position=sp.ImmutableMatrix(vector_at(motion, motion.position, at)),
        velocity=sp.ImmutableMatrix(vector_at(motion, motion.velocity, at)),
        jacobian=sp.ImmutableMatrix.hstack(*(vector_at(motion, d, at) for d in displacements)),
    )
