"""The linearisation of a compiled model about a state, in independent coordinates: xdot = A x + B u, y = C x + D u.

The equations M vdot + h = G^T lambda with g(t, q) = 0 and qdot = Z v are linearised about (t, q, v) with its vdot and
lambda. Their derivatives are blocks of the iteration matrices that the model generates; d(G^T lambda)/dq, the stiffness
of the multipliers, is part of them. Small displacements are dq = Z zeta. With G = [G_d, G_f] in the columns of
dependent and of free coordinates, T = [-G_d^-1 G_f; 1] spans the null space of G, and S = [G_d^-1; 0] has G S = 1.

The states are x = [z; w] with z = zeta_f and w = dv_f. The linearised g = 0 and gdot = 0 give zeta and dv in terms of x
and u, and G vdot = gamma gives dvdot = T dw/dt - S (...). The equations of motion, multiplied by T^T, give dw/dt;
multiplied by S^T, they give dlambda. The constraints are met exactly, and no eigenvalue belongs to them. In a state of
motion T depends on time, but the states remain the same elements of zeta and dv.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lu_factor, lu_solve, qr

from derive.display import html
from derive.roles import Role
from derive.runtime.native_call import Matrix, Vector
from derive.runtime.native_scene import NativeScene
from derive.short_text import listed, summary
from derive.simulation.configurations import rate_matrix, velocity_roles
from derive.simulation.constraints.scaling import SINGULAR, mass_factor, spectrum
from derive.simulation.linear.ports import inputs_of, outputs_of

WELL_CONDITIONED = 0.05
"""Translations are dependent coordinates as long as a pivot of their columns is above this, relative to the first."""


@dataclass(frozen=True, eq=False)
class Linearisation:
    """The state space xdot = A x + B u, y = C x + D u about a state of a model, in SI units.

    All of x, u and y are small changes from the state. Without outputs y are the positions of the markers, and without
    inputs as well u are forces at the markers, in the inertial frame; with outputs alone there is no u.

    Attributes:
        t: the time of the state, s.
        q: its coordinates (nq,).
        v: its generalised velocities (nv,).
        vdot: its accelerations (nv,).
        lam: its multipliers (nlambda,).
        states: the names of x = [z; w] (2 n,).
        inputs: the names of u, the run-time inputs of a scene.
        outputs: the names of y, the outputs of a scene.
        A: the state matrix (2 n, 2 n).
        B: the input matrix (2 n, inputs).
        C: the output matrix (outputs, 2 n).
        D: the feedthrough matrix (outputs, inputs).
        displacements: the matrix (nq, n) of dq = displacements z if u = 0.

    Examples:
        >>> import derive
        >>> pendulum = derive.scene(
        ...     "pendulum",
        ...     gravity=(0, -9.81),
        ...     ground={"pivot": (0, 0)},
        ...     bodies={"rod": {"mass": 1, "inertia": "1/12", "markers": {"top": (0, 0.5)}}},
        ...     joints={"hinge": {"kind": "revolute", "between": ["ground.pivot", "rod.top"]}},
        ... )
        >>> linear = derive.modes(pendulum).linear
        >>> linear.states
        ('rod_phi', 'rod_phidot')
        >>> linear.A.round(3) + 0.0
        array([[  0.   ,   1.   ],
               [-14.715,   0.   ]])
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

    def __repr__(self) -> str:
        return summary(
            f"Linearisation at t = {self.t:g} s: xdot = A x + B u, y = C x + D u",
            {
                "states x": listed(self.states),
                "inputs u": listed(self.inputs),
                "outputs y": listed(self.outputs),
            },
        )

    _repr_html_ = html


class _Linear(NamedTuple):
    """A quantity that depends linearly on the states and the inputs: the factors of x and of u."""

    x: Matrix
    u: Matrix


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


def linearise(
    native: NativeScene, k: Vector, t: float, q: Vector, v: Vector, axes: Matrix | None = None
) -> Linearisation:
    """The linearisation of a model about the consistent state q (nq,), v (nv,) at t (s), with the coefficients at t.

    k: the constants (nk,) of `native.setup`, with the inputs at t. axes (nv, nv): those of a `SteadyMotion`, which
    rotate with the scene; small displacements and velocities are then those in these axes, where the coefficients are
    constant.
    Changes of reactions that are not unique are those of least norm.
    Raises ModelError where accelerations and multipliers of the state are not unique, unless the model is `proximal`.
    """
    vdot, lam = native.solve(t, q, v, k)
    d = _of_scene(native, k, t, q, v, vdot, lam) if native.dae else _of_body(native, k, t, q, v, vdot)
    if axes is not None and axes.any():
        d = _in_rotating_axes(d, axes)
    u, y = inputs_of(native, k, t, q, v, vdot, lam), outputs_of(native, k, t, q, v, vdot, lam)
    spread = np.eye(native.nlambda)
    if native.nlambda and native.proximal:
        spread, kept = _independent_constraints(native, k, t, q, d)
        d = replace(d, G=d.G[kept], rates=d.rates[kept], a_q=d.a_q[kept], a_v=d.a_v[kept])
        u = replace(u, constraints=u.constraints[kept], rates=u.rates[kept], accelerations=u.accelerations[kept])
    translations = np.array([role is Role.TRANSLATION for role in velocity_roles(native)], dtype=bool)
    dependent, free = independent_coordinates(d.M, d.G, translations)
    S = np.zeros((native.nv, len(d.G)))
    if dependent.size:
        S[dependent] = np.linalg.inv(d.G[:, dependent])
    T = np.eye(native.nv)[:, free] - S @ d.G[:, free]
    n = len(free)
    none = np.zeros((native.nv, n))
    zeta = _Linear(np.hstack([T, none]), -S @ u.constraints)
    dv = _Linear(np.hstack([-S @ d.rates @ T, T]), -S @ (d.rates @ zeta.u + u.rates))
    bias = _Linear(d.a_q @ zeta.x + d.a_v @ dv.x, d.a_q @ zeta.u + d.a_v @ dv.u + u.accelerations)
    force = _Linear(d.K @ zeta.x + d.H @ dv.x, d.K @ zeta.u + d.H @ dv.u + u.forces)
    mass = lu_factor(T.T @ d.M @ T)
    wdot = _Linear(*(-lu_solve(mass, T.T @ (f - d.M @ S @ b)) for f, b in zip(force, bias, strict=True)))
    dvdot = _Linear(*(T @ a - S @ b for a, b in zip(wdot, bias, strict=True)))
    dlam = _Linear(*(spread @ S.T @ (d.M @ a + f) for a, f in zip(dvdot, force, strict=True)))
    kinematic = np.hstack([(d.W @ T)[free], np.eye(n)])  # zdot = w + W z, where W = 0 except for bodies in space
    C, D = (
        y.by_zeta @ a + y.by_v @ b + y.by_vdot @ c + y.by_lam @ e
        for a, b, c, e in zip(zeta, dv, dvdot, dlam, strict=True)
    )
    names = displacement_names(native)
    return Linearisation(
        t=t,
        q=q,
        v=v,
        vdot=vdot,
        lam=lam,
        states=(*(names[i] for i in free), *(native.velocities[i] for i in free)),
        inputs=u.names,
        outputs=y.names,
        A=np.vstack([kinematic, wdot.x]),
        B=np.vstack([np.zeros((n, len(u.names))), wdot.u]),
        C=C,
        D=D + y.by_u,
        displacements=d.Z @ T,
    )


def _independent_constraints(
    native: NativeScene, k: Vector, t: float, q: Vector, d: _Derivatives
) -> tuple[Matrix, NDArray[np.intp]]:
    """The indices (r,) of constraints that imply the others, and the factors (nlambda, r) of their multipliers in all.

    The multipliers of all constraints are those of least norm with the same forces.
    """
    of = spectrum(native, k, t, q)
    kept = np.sort(qr(of.scaled.T, mode="r", pivoting=True)[1][: of.rank])
    weights = np.sqrt(np.einsum("ij,ji->i", d.G, np.linalg.solve(d.M, d.G.T)))
    weights = np.maximum(weights, 1e-6 * of.norms)  # also where G is zero, or has rounding errors alone
    scaled = d.G / weights[:, None]
    return np.linalg.pinv(scaled.T, rcond=SINGULAR) @ d.G[kept].T / weights[:, None], kept


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


def displacement_names(native: NativeScene) -> tuple[str, ...]:
    """The names of the elements of zeta (nv,): those of the coordinates, but in space of a small rotation vector.

    In a scene in space they are those of the velocities whose small displacements they are.
    """
    if native.nq == native.nv:
        return native.coordinates
    if native.dae:
        return tuple(f"{name}_displacement" for name in native.velocities)
    names = iter(name for name, role in zip(native.coordinates, native.roles, strict=True) if role != Role.QUATERNION)
    rotations = iter(("rotation1", "rotation2", "rotation3"))
    return tuple(next(rotations if role is Role.ROTATION else names) for role in velocity_roles(native))


def _of_scene(
    native: NativeScene, k: Vector, t: float, q: Vector, v: Vector, vdot: Vector, lam: Vector
) -> _Derivatives:
    """The derivatives from the iteration matrices of index 1 and of the stabilised form; in the plane qdot = v."""
    n, size = native.nq, native.nq + native.nv
    none, qdot = np.zeros(native.nlambda), native.rates(q, v, k)
    y, ydot = np.concatenate([q, v, lam]), np.concatenate([qdot, vdot, none])
    form, stabilised = native.dae["index1"], native.dae["ggl"]

    def derivatives(y: Vector) -> Matrix:
        return form.pattern.dense(form.jacobian(t, y, ydot, 0.0, k))

    J = derivatives(y)
    Z, W = np.eye(n), np.zeros((n, n))
    if native.nq != native.nv:
        Z = rate_matrix(native, q, k)
        W = _of_moving_axes(Z, J[:n, :n], qdot, lambda unit: derivatives(np.concatenate([q, unit, lam]))[:n, :n])
    y, ydot_of_both = np.concatenate([y, none]), np.concatenate([ydot, none])
    rates = stabilised.pattern.dense(stabilised.jacobian(t, y, ydot_of_both, 0.0, k))
    return _Derivatives(
        Z=Z,
        W=W,
        M=native.mass_pattern.dense(native.mass(q, k)),
        K=J[n:size, :n] @ Z,
        H=J[n:size, n:size],
        G=native.constraint_pattern.dense(native.constraint_jacobian(t, q, k)),
        rates=rates[size : size + native.nlambda, :n] @ Z,
        a_q=J[size:, :n] @ Z,
        a_v=J[size:, n:size],
    )


def _of_moving_axes(Z: Matrix, by_q: Matrix, qdot: Vector, by_q_at: Callable[[Vector], Matrix]) -> Matrix:
    """The matrix W (nv, nv) of zetadot = dv + W zeta.

    It follows from d(Z v)/dq Z zeta + Z dv = Z zetadot + Zdot zeta. by_q: -d(Z v)/dq; by_q_at: the same at other
    velocities (nv,), in which it is linear.
    """
    Zdot = np.column_stack([-by_q_at(unit) @ qdot for unit in np.eye(Z.shape[1])])
    return np.asarray(np.linalg.pinv(Z) @ (-by_q @ Z - Zdot))


def _in_rotating_axes(d: _Derivatives, W: Matrix) -> _Derivatives:
    """The derivatives by displacements and velocities in axes that rotate, where W (nv, nv) is the matrix of w x.

    zetadot = dv - W zeta, and the change of the accelerations is dvdot + W dv.
    """
    return replace(d, W=d.W - W, H=d.H + d.M @ W, a_v=d.a_v + d.G @ W)


def _of_body(native: NativeScene, k: Vector, t: float, q: Vector, v: Vector, vdot: Vector) -> _Derivatives:
    """The derivatives from the iteration matrix of a body.

    With a quaternion Z depends on q, see `_of_moving_axes`.
    """
    n, qdot = native.nq, native.rates(q, v, k)
    none = np.zeros((0, native.nv))

    def derivatives(velocity: Vector) -> Matrix:
        y, ydot = np.concatenate([q, velocity]), np.concatenate([qdot, vdot])
        return native.jacobian_pattern.dense(native.jacobian(t, y, ydot, 0.0, k))

    J = derivatives(v)
    Z = -J[:n, n:]
    return _Derivatives(
        Z=Z,
        W=_of_moving_axes(Z, J[:n, :n], qdot, lambda unit: derivatives(unit)[:n, :n]),
        M=native.mass_pattern.dense(native.mass(q, k)),
        K=J[n:, :n] @ Z,
        H=J[n:, n:],
        G=none,
        rates=none,
        a_q=none,
        a_v=none,
    )
