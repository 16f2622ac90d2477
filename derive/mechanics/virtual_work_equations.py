"""The equations of motion (15) of a deformable body, term by term, with their sums over the shapes kept.

Inertia is the virtual work of the acceleration (5) on each virtual displacement (6). There is one term for each part
of the acceleration in each row; the rows of the shapes are one row for a generic shape i. The same terms serve
planar and spatial motion, and both forms of the equations: with indexed sums, and with expanded sums.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

from derive.algebra import sp
from derive.mechanics.generic_forces import SHAPE_ROW
from derive.mechanics.motion.kinematics import HERE, ONE, RDDOT, RDOT, Field, R
from derive.mechanics.motion.planar import planar_motion
from derive.mechanics.motion.spatial import spatial_motion
from derive.mechanics.symbols import Family, quantity, vector
from derive.mechanics.terms import Intermediate, Term

if TYPE_CHECKING:
    from derive.mechanics.motion.body_motion import Motion


@dataclass(frozen=True)
class VirtualWork:
    """The equations of motion (15) before anything vanishes, from which all forms of the equations follow.

    motion: that of the rigid body, whose sums over the modes the terms contain by name. rigid, generic: the virtual
    work of the inertia on the rigid displacements and on a variation of alpha_i; rigid_weight, generic_weight: that of
    gravity, for whose components in the body frame `gravity` has the definitions. The energies and momenta follow.
    """

    motion: Motion
    gravity: tuple[Intermediate, ...]
    rigid: tuple[Term, ...]
    generic: tuple[Term, ...]
    rigid_weight: tuple[Term, ...]
    generic_weight: tuple[Term, ...]
    kinetic_energy: sp.Expr
    weight_energy: sp.Expr
    linear_momentum: tuple[sp.Expr, ...]
    angular_momentum: tuple[sp.Expr, ...]
    mass_moments: tuple[sp.Expr, ...]


@cache
def virtual_work(dimension: int, truncated: bool) -> VirtualWork:
    """The virtual work of a body in the plane (2) or in space (3), truncated at second order or not."""
    motion = (planar_motion if dimension == 2 else spatial_motion)(0, truncated)
    return VirtualWork(
        motion=motion,
        gravity=gravity_definitions(motion),
        rigid=rigid_inertia(motion),
        generic=generic_inertia(motion),
        rigid_weight=rigid_weight(motion),
        generic_weight=generic_weight(motion),
        kinetic_energy=kinetic_energy(motion),
        weight_energy=weight_energy(motion),
        linear_momentum=linear_momentum(motion),
        angular_momentum=angular_momentum(motion),
        mass_moments=mass_moments(motion),
    )


def _parts(motion: Motion) -> tuple[tuple[str, Field], ...]:
    """The acceleration (5), split into its named parts."""
    acceleration = motion.acceleration
    turning, still = acceleration[R], dict.fromkeys(motion.frame.omegadot, sp.S.Zero)
    centrifugal = turning.xreplace(still)
    named = centrifugal.expand().xreplace(motion.products)
    return (
        ("translation", {ONE: acceleration[ONE]}),
        ("Euler", {R: turning - centrifugal}),
        ("centrifugal", {R: named}),
        ("Coriolis", {RDOT: acceleration[RDOT]}),
        ("relative", {RDDOT: acceleration[RDDOT]}),
    )


def rigid_inertia(motion: Motion) -> tuple[Term, ...]:
    """The virtual work of the inertia on the rigid displacements (6): a term for each part of (5); sums are named."""
    return tuple(
        Term(row, name, "(15)", motion.product(part, displacement))
        for row, displacement in rigid_displacements(motion)
        for name, part in _parts(motion)
    )


def generic_inertia(motion: Motion) -> tuple[Term, ...]:
    """The virtual work of the inertia on a variation of alpha_i, for a generic i; sums are named."""
    deformation = motion.frame.deformation()
    return tuple(Term(SHAPE_ROW, name, "(15)", motion.product(part, deformation)) for name, part in _parts(motion))


def rigid_displacements(motion: Motion) -> Iterator[tuple[str, Field]]:
    """The rows of the rigid motion, each with its virtual displacement."""
    names = [row.name for row in motion.rigid_rows]
    return zip(names, (*motion.translations, *motion.frame.rotations()), strict=True)


def gravity_vector(motion: Motion) -> sp.Matrix:
    """The acceleration of free fall, g_1, g_2, ..., in the inertial frame."""
    return vector(Family.GRAVITY, motion.rotation.rows)


def gravity_definitions(motion: Motion) -> tuple[Intermediate, ...]:
    """The definitions of Q^T g, gravity resolved in the body frame."""
    seen = motion.rotation.T * gravity_vector(motion)
    return tuple(
        Intermediate(
            quantity(Family.BODY_GRAVITY, k), expr, "gb", "(1)", f"gravity along the axis {k} of the floating frame"
        )
        for k, expr in enumerate(seen, 1)
    )


def _work_of(motion: Motion, displacement: Field) -> sp.Expr:
    """The work int rho g . f of gravity on a field: inertial g on a translation, g in the body frame on the rest."""
    seen = vector(Family.BODY_GRAVITY, motion.rotation.rows)
    translation = {ONE: displacement[ONE]} if ONE in displacement else {}
    rest = {name: tensor for name, tensor in displacement.items() if name != ONE}
    return motion.product({ONE: gravity_vector(motion)}, translation) + motion.product({HERE: seen}, rest)


def rigid_weight(motion: Motion) -> tuple[Term, ...]:
    """The virtual work of gravity on the rigid displacements, on the left-hand side."""
    return tuple(
        Term(row, "gravity", "(10)", -_work_of(motion, displacement))
        for row, displacement in rigid_displacements(motion)
    )


def generic_weight(motion: Motion) -> tuple[Term, ...]:
    """The virtual work of gravity on a variation of alpha_i, on the left-hand side."""
    return (Term(SHAPE_ROW, "gravity", "(10)", -_work_of(motion, motion.frame.deformation())),)


def weight_energy(motion: Motion) -> sp.Expr:
    """The potential energy of gravity in J, with its zero level at the inertial origin."""
    return -_work_of(motion, motion.position)


def kinetic_energy(motion: Motion) -> sp.Expr:
    """The kinetic energy 1/2 int rho xdot . xdot; sums are named."""
    return motion.product(motion.velocity, motion.velocity) / 2


def linear_momentum(motion: Motion) -> tuple[sp.Expr, ...]:
    """The linear momentum int rho xdot along each axis: the virtual work of the velocity on unit translations."""
    return tuple(motion.product(motion.velocity, d) for d in motion.translations)


def angular_momentum(motion: Motion) -> tuple[sp.Expr, ...]:
    """The angular momentum int rho x x xdot about the inertial origin: the virtual work of the velocity on e_k x x."""
    position = motion.position
    rotated = ({ONE: fixed * position[ONE], R: moving} for fixed, moving in motion.rotation_generators)
    return tuple(motion.product(field, motion.velocity) for field in rotated)


def mass_moments(motion: Motion) -> tuple[sp.Expr, ...]:
    """The mass, and the first moments int rho x along each axis: products of unit translations with the position."""
    first = motion.translations[0]
    return motion.product(first, first), *(motion.product(motion.position, d) for d in motion.translations)
