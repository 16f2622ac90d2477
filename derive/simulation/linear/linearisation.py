"""The linearisation of a compiled model about a state, in independent coordinates: xdot = A x + B u, y = C x + D u.

The equations M vdot + h = G^T lambda with g(t, q) = 0 and qdot = Z v are linearised about (t, q, v) with its vdot and
lambda. Their derivatives are blocks of the iteration matrices that the model generates; d(G^T lambda)/dq, the stiffness
of the multipliers, is part of them. Small displacements are dq = Z zeta with G zeta = 0. The columns of T span the null
space of G, zeta = T z, and z are elements of zeta: with G = [G_d, G_u] in the dependent and the independent columns,
T = [-G_d^-1 G_u; 1]. So the constraints are met exactly, and no eigenvalue belongs to them.

In a state of motion T changes with time. The coordinates z remain the same elements of zeta, so that
zetadot = T zdot + Tdot z, where Tdot z follows from d(gdot)/dq, and dvdot from the linearised G vdot = gamma.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lu_factor, lu_solve, qr

from derive.ir.patterns import Pattern
from derive.roles import Role
from derive.runtime.compiled_model import Native
from derive.runtime.native_call import Matrix, Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.constraints.scaling import mass_factor

WELL_CONDITIONED = 0.05
"""Translations are dependent coordinates as long as a pivot of their columns is above this, relative to the first."""


@dataclass(frozen=True, eq=False)
class Linearisation:
    """xdot = A x + B u, y = C x + D u about a state of a model, in SI units.

    t, q (nq,), v (nv,), vdot (nv,), lam (nlambda,): the state, with its accelerations and multipliers. states: the
    names of x = [z; zdot] (2 n,). inputs: the names of u, forces at markers in the inertial frame. outputs: the names
    of y, displacements of markers in the inertial frame. displacements (nq, n): dq = displacements z.
    """

    t: float
    q: Vector
    v: Vector
    vdot: Vector
    lam: Vector
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    A: Matrix
    B: Matrix
    C: Matrix
    D: Matrix
    displacements: Matrix

    @property
    def count(self) -> int:
        """The number n of independent coordinates."""
        return len(self.states) // 2


@dataclass(frozen=True, eq=False)
class _Derivatives:
    """Derivatives at a state; f = M vdot + h - G^T lambda, and a = G vdot - gamma.

    Z (nq, nv) = dqdot/dv; W (nv, nv): zetadot = dv + W zeta; M (nv, nv); K (nv, nv) = df/dq Z; H (nv, nv) = df/dv;
    G (nlambda, nv); rates (nlambda, nv) = d(gdot)/dq Z; a_q, a_v (nlambda, nv) = da/dq Z, da/dv.
    """

    Z: Matrix
    W: Matrix
    M: Matrix
    K: Matrix
    H: Matrix
    G: Matrix
    rates: Matrix
    a_q: Matrix
    a_v: Matrix


def linearise(native: Native, k: Vector, t: float, q: Vector, v: Vector) -> Linearisation:
    """The linearisation of a model about the consistent state q (nq,), v (nv,) at t (s), with coefficients of that t.

    k: the constants (nk,) of `native.setup`. The inputs are the components of a force at every marker, the outputs are
    their displacements. Raises ModelError where accelerations and multipliers of the state are not unique.
    """
    if isinstance(native, NativeScene):
        vdot, lam = native.solve(t, q, v, k)
        d = _of_scene(native, k, t, q, v, vdot, lam)
    else:
        vdot, lam = native.accel(t, q, v, k), np.zeros(0)
        d = _of_body(native, k, t, q, v, vdot)
    translations = np.array([role is Role.TRANSLATION for role in velocity_roles(native)], dtype=bool)
    dependent, free = independent_coordinates(d.M, d.G, translations)
    S = np.zeros((native.nv, native.nlambda))
    if dependent.size:
        S[dependent] = np.linalg.inv(d.G[:, dependent])
    T = np.eye(native.nv)[:, free] - S @ d.G[:, free]
    n = len(free)
    # zetadot = dv + W zeta = T zdot + Tdot z and d(gdot) = 0, so that dv = T zdot + shift z
    shift = -S @ d.rates @ T
    a_z, a_zdot = d.a_q @ T + d.a_v @ shift, d.a_v @ T
    K = T.T @ (d.K @ T + d.H @ shift - d.M @ S @ a_z)
    H = T.T @ (d.H @ T - d.M @ S @ a_zdot)
    mass = lu_factor(T.T @ d.M @ T)
    velocity = (d.W @ T)[free]  # 0 but for a body that rotates in space: zdot = dv_free + velocity z
    A = np.block([[velocity, np.eye(n)], [-lu_solve(mass, K), -lu_solve(mass, H)]])
    names, J = _marker_jacobians(native, k, q, v)
    B = np.vstack([np.zeros((n, len(names))), lu_solve(mass, T.T @ J.T)])
    C = np.hstack([J @ T, np.zeros((len(names), n))])
    positions, velocities = displacement_names(native), native.velocities
    return Linearisation(
        t=t,
        q=q,
        v=v,
        vdot=vdot,
        lam=lam,
        states=(*(positions[i] for i in free), *(velocities[i] for i in free)),
        inputs=tuple(f"{marker}_F{i}" for marker, i in names),
        outputs=tuple(f"{marker}_x{i}" for marker, i in names),
        A=A,
        B=B,
        C=C,
        D=np.zeros((len(names), len(names))),
        displacements=d.Z @ T,
    )


def independent_coordinates(
    M: Matrix, G: Matrix, translation: NDArray[np.bool_]
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """The indices of as many dependent coordinates as G (nlambda, nv) has rows, and those of the independent ones.

    The dependent ones come from QR factorisations with pivoting: first of the columns of translations, (nv,) a mask,
    then of the others in the metric of the mass matrix M (nv, nv). Angles and amplitudes are then independent where the
    constraints permit, because the equations of a mechanism in steady rotation depend on time if positions are among
    its coordinates.
    """
    columns, count = np.arange(len(M)), len(G)
    first, second = columns[translation], columns[~translation]
    Q, R, order = qr(G[:, first], pivoting=True) if first.size and count else (np.eye(count), np.zeros((0, 0)), first)
    pivots = np.abs(np.diag(R))
    rank = int(np.sum(pivots > WELL_CONDITIONED * pivots.max(initial=0.0)))
    dependent = first[order[:rank]]
    if rank < count:
        rest = Q[:, rank:].T @ G / np.linalg.norm(mass_factor(M), axis=0)
        others = np.concatenate([second, first[order[rank:]]]) if len(second) < count - rank else second
        pivoting = qr(rest[:, others], mode="r", pivoting=True)[1]
        dependent = np.concatenate([dependent, others[pivoting[: count - rank]]])
    return np.sort(dependent), np.setdiff1d(columns, dependent)


def velocity_roles(native: Native) -> tuple[Role, ...]:
    """The role of the coordinate that belongs to each velocity (nv,); an angular velocity in space is a ROTATION."""
    roles = [role for role in native.roles if role is not Role.QUATERNION]
    first = native.roles.index(Role.QUATERNION) if Role.QUATERNION in native.roles else 0
    return (*roles[:first], *[Role.ROTATION] * (native.nv - len(roles)), *roles[first:])


def displacement_names(native: Native) -> tuple[str, ...]:
    """The names of the elements of zeta (nv,): those of the coordinates; in space, of the small rotation as well."""
    if native.nq == native.nv:
        return native.coordinates
    names = iter(name for name, role in zip(native.coordinates, native.roles, strict=True) if role != Role.QUATERNION)
    rotations = iter(("rotation1", "rotation2", "rotation3"))
    return tuple(next(rotations if role is Role.ROTATION else names) for role in velocity_roles(native))


def _of_scene(
    native: NativeScene, k: Vector, t: float, q: Vector, v: Vector, vdot: Vector, lam: Vector
) -> _Derivatives:
    """The derivatives from the iteration matrices of index 1 and of the stabilised form; qdot = v."""
    n, size = native.nq, 2 * native.nq
    none = np.zeros(native.nlambda)
    y, ydot = np.concatenate([q, v, lam]), np.concatenate([v, vdot, none])
    form, stabilised = native.dae["index1"], native.dae["ggl"]
    J = form.pattern.dense(form.jacobian(t, y, ydot, 0.0, k))
    y, ydot = np.concatenate([y, none]), np.concatenate([ydot, none])
    rates = stabilised.pattern.dense(stabilised.jacobian(t, y, ydot, 0.0, k))
    return _Derivatives(
        Z=np.eye(n),
        W=np.zeros((n, n)),
        M=native.mass_pattern.dense(native.mass(q, k)),
        K=J[n:size, :n],
        H=J[n:size, n:size],
        G=native.constraint_pattern.dense(native.constraint_jacobian(t, q, k)),
        rates=rates[size : size + native.nlambda, :n],
        a_q=J[size:, :n],
        a_v=J[size:, n:size],
    )


def _of_body(native: Native, k: Vector, t: float, q: Vector, v: Vector, vdot: Vector) -> _Derivatives:
    """The derivatives from the iteration matrix of a body.

    With a quaternion Z depends on q, and dqdot = d(Z v)/dq Z zeta + Z dv = Z zetadot + Zdot zeta.
    """
    n, qdot = native.nq, native.rates(q, v, k)
    none = np.zeros((0, native.nv))

    def derivatives(velocity: Vector) -> Matrix:
        y, ydot = np.concatenate([q, velocity]), np.concatenate([qdot, vdot])
        return native.jacobian_pattern.dense(native.jacobian(t, y, ydot, 0.0, k))

    J = derivatives(v)
    Z = -J[:n, n:]
    Zdot = np.column_stack([-derivatives(unit)[:n, :n] @ qdot for unit in np.eye(native.nv)])
    return _Derivatives(
        Z=Z,
        W=np.linalg.pinv(Z) @ (-J[:n, :n] @ Z - Zdot),
        M=native.mass_pattern.dense(native.mass(q, k)),
        K=J[n:, :n] @ Z,
        H=J[n:, n:],
        G=none,
        rates=none,
        a_q=none,
        a_v=none,
    )


def _marker_jacobians(native: Native, k: Vector, q: Vector, v: Vector) -> tuple[list[tuple[str, int]], Matrix]:
    """The name of the marker and the component, from 1, of each row of d(velocity)/dv (rows, nv) of all markers."""
    names: list[tuple[str, int]] = []
    rows = [np.zeros((0, native.nv))]
    for marker in native.markers:
        pattern: Pattern = native.marker_pattern(marker)
        rows.append(pattern.dense(native.marker(marker, q, v, k)[2]))
        names += [(marker, i + 1) for i in range(pattern.rows)]
    return names, np.vstack(rows)
