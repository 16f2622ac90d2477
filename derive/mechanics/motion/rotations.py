"""Rotations in space: products of quaternions, and the finite rotation that a small rotation vector stands for."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

from derive.algebra import sp
from derive.mechanics.motion.spatial import rotation_of
from derive.mechanics.motion.vectors import skew
from derive.mechanics.symbols import local

THETA = tuple(local("theta", k) for k in (1, 2, 3))
RATE = tuple(local("theta_rate", k) for k in (1, 2, 3))
SCALE = local("theta_scale")
"""The rotation vector of a section, its rate, and 1/(1 + theta . theta / 4), as variables of the functions below."""


def product(p: Sequence[sp.Expr], q: Sequence[sp.Expr]) -> tuple[sp.Expr, ...]:
    """The product of two quaternions, scalar first."""
    u, v = sp.Matrix(p[1:]), sp.Matrix(q[1:])
    return (p[0] * q[0] - u.dot(v), *(p[0] * v + q[0] * u + u.cross(v)))


def conjugate(p: Sequence[sp.Expr]) -> tuple[sp.Expr, ...]:
    """The quaternion of the inverse rotation."""
    return (p[0], *(-x for x in p[1:]))


def matrix_of(quaternion: Sequence[float]) -> sp.ImmutableMatrix:
    """The rotation matrix of a quaternion of doubles; entries that are 0 or 1 up to rounding are so exactly."""
    exact = tuple(sp.Rational(float(x)) for x in quaternion)
    square = sum(x**2 for x in exact)
    return sp.ImmutableMatrix((rotation_of(exact) / square).applyfunc(_clean))


def _clean(entry: sp.Expr) -> sp.Expr:
    nearest = sp.Integer(round(float(entry)))
    return nearest if abs(float(entry - nearest)) < ROUNDING else sp.Rational(float(entry))


ROUNDING = 4e-16
"""Entries of rotation matrices that are nearer to an integer than this are that integer: cos(pi/2) is 6e-17."""


@cache
def section_rotation() -> tuple[sp.ImmutableMatrix, sp.ImmutableMatrix, sp.ImmutableMatrix]:
    """The rotation of a section by a small vector THETA: matrix, tangent operator T, and bias of the acceleration.

    The rotation is that of the quaternion 1 + THETA/2, normalised. Its angular velocity is T RATE, the virtual rotation
    T delta THETA, and the angular acceleration T (second derivative of THETA) + bias; all in the frame of the body.
    They follow from 2 pdot p* / (p p*), the vector part of which is the angular velocity of any quaternion p.
    """
    half = tuple(x / 2 for x in THETA)
    p = (sp.S.One, *half)
    matrix = (SCALE * rotation_of(p)).expand()
    columns = [sp.Matrix(product([x.diff(theta) for x in p], conjugate(p))[1:]) * 2 for theta in THETA]
    unscaled = sp.Matrix.hstack(*columns)
    norm = sum(x**2 for x in p)
    rate = (unscaled * sp.Matrix(RATE)).expand()
    of_scale = -(SCALE**2) * sum(norm.diff(theta) * r for theta, r in zip(THETA, RATE, strict=True))
    change = sum((rate.diff(theta) * r for theta, r in zip(THETA, RATE, strict=True)), sp.zeros(3, 1))
    bias = (of_scale * rate + SCALE * change).applyfunc(sp.factor_terms)
    return sp.ImmutableMatrix(matrix), sp.ImmutableMatrix(SCALE * unscaled), sp.ImmutableMatrix(bias)


@cache
def inverse_tangent() -> sp.ImmutableMatrix:
    """The inverse of the tangent operator of `section_rotation`, 1 - THETA~/2 + THETA THETA^T/4."""
    theta = sp.Matrix(THETA)
    return sp.ImmutableMatrix(sp.eye(3) - skew(theta) / 2 + theta * theta.T / 4)
