"""Static equilibrium of a compiled scene by Newton's method, with its residual and its stability."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import Protocol, assert_never

import numpy as np
from numpy.typing import ArrayLike
from scipy.linalg import null_space, solve_triangular

from derive.display import html
from derive.enumerations import enumeration
from derive.ir.patterns import Pattern
from derive.roles import Role
from derive.runtime.native_call import Matrix, Vector, checked_vector
from derive.short_text import summary, vector_text
from derive.simulation.compiled_scene import (
    ConstrainedSystem,
    constraint_matrix,
    coordinates_with,
    mass_matrix,
    max_norm,
)
from derive.simulation.configurations import displaced, rate_matrix, velocities_with, velocity_names
from derive.simulation.constraints.closest_state import closest_state
from derive.simulation.constraints.scaling import in_mass_metric, mass_factor, typical_row_norms
from derive.simulation.errors import NoEquilibrium

LOAD_STEPS = (1, 4, 16, 64)
"""Numbers of steps in which the loads that the first guess does not balance are applied, until one converges."""
ITERATIONS = 100
LARGEST_STEP = 0.3
"""rad: the largest rotation in one iteration; of lengths, the part of the size of the mechanism."""
SMALLEST_STEP = 1e-12
"""rad, and part of the size: an iteration that moves no more than this ends Newton's method."""
ROUNDING = 1e-12
"""Stiffnesses below this part of the largest one, and forces below this part of the loads, count as zero."""
HALVINGS = 12


class StaticSystem(ConstrainedSystem, Protocol):
    """A scene with the Jacobian of its residual F(t, y, ydot), y = [q; v; lambda], as `NativeScene` computes it."""

    jacobian_pattern: Pattern

    def jacobian(self, t: float, y: Vector, ydot: Vector, cj: float, k: Vector) -> Vector:
        """Values of dF/dy + cj dF/dydot."""


class Stability(Enum):
    """The stability of an equilibrium: whether it is regained after a small disturbance. The value is its name."""

    STABLE = "stable"
    NEUTRAL = "neutral"
    UNSTABLE = "unstable"


@dataclass(frozen=True, eq=False)
class Equilibrium:
    """A configuration at rest in which loads, elastic forces and constraint reactions balance.

    Attributes:
        t: the time, s, at which drives and loads have their values.
        q: coordinates (nq,) in SI units.
        lam: multipliers (nlambda,) in SI units.
        residual: the largest element of h - G^T lambda, N or N m.
        load: the largest element of h in it and in the first guess.
        eigenvalues: of the stiffness d(h - G^T lambda)/dq in the motions that the constraints allow, in the metric of
            the mass matrix, rad^2/s^2, ascending by their real parts; squares of the natural frequencies where they are
            real and positive.
        softest: the coordinates that take part in the motion of the first eigenvalue.
        iterations: those of Newton's method.
        load_steps: the steps in which the loads were applied.

    Examples:
        >>> import derive
        >>> pendulum = derive.scene(
        ...     "pendulum",
        ...     gravity=(0, -9.81),
        ...     ground={"pivot": (0, 0)},
        ...     bodies={"rod": {"mass": 1, "inertia": "1/12", "markers": {"top": (0, 0.5)}}},
        ...     joints={"hinge": {"kind": "revolute", "between": ["ground.pivot", "rod.top"]}},
        ... )
        >>> equilibrium = derive.modes(pendulum).equilibrium
        >>> equilibrium.stability.name
        'STABLE'
        >>> equilibrium.eigenvalues.round(3)  # 3 g / (2 l)
        array([14.715])
    """

    t: float
    q: Vector
    lam: Vector
    residual: float
    load: float
    eigenvalues: Vector
    softest: tuple[str, ...]
    iterations: int
    load_steps: int

    def __str__(self) -> str:
        """The equilibrium in a sentence, with its residual, its loads and its stability."""
        text = f"static equilibrium with a residual of {self.residual:.1e} N or N m beside loads of {self.load:.3g}"
        match self.stability:
            case Stability.STABLE:
                lowest = float(np.sqrt(np.min(np.real(self.eigenvalues)))) if len(self.eigenvalues) else None
                return f"{text}; stable" + (
                    f", lowest natural frequency {lowest / (2 * np.pi):.4g} Hz" if lowest else ""
                )
            case Stability.NEUTRAL:
                return f"{text}; neutral: a motion of {enumeration(self.softest)} meets no stiffness"
            case Stability.UNSTABLE:
                return f"{text}; unstable: a motion of {enumeration(self.softest)} grows"
            case _ as never:
                assert_never(never)

    @property
    def stability(self) -> Stability:
        """Unstable with a negative or complex eigenvalue, neutral with one that is zero up to rounding."""
        limit = ROUNDING * max_norm(np.abs(self.eigenvalues))
        real, imaginary = np.real(self.eigenvalues), np.imag(self.eigenvalues)
        if np.any(real < -limit) or np.any(np.abs(imaginary) > 1e-6 * np.abs(self.eigenvalues) + limit):
            return Stability.UNSTABLE
        return Stability.NEUTRAL if np.any(real <= limit) else Stability.STABLE

    def __repr__(self) -> str:
        return summary(
            f"Equilibrium at t = {self.t:g} s: {self.stability.value}",
            {
                "residual": f"{self.residual:.1e} N or N m beside loads of {self.load:.3g}",
                "q": vector_text(self.q),
                "multipliers": vector_text(self.lam) if self.lam.size else "",
            },
        )

    _repr_html_ = html


def equilibrium(native: StaticSystem, k: Vector, guess: ArrayLike, t: float = 0.0) -> Equilibrium:
    """The static equilibrium that Newton's method reaches from a first guess.

    Each iteration solves with the stiffness of the generated Jacobian in the motions that the constraints allow. Along
    motions of negative stiffness it steps down the potential, so that a mechanism that is not in an unstable
    equilibrium already comes to a stable one. If the iteration does not converge, the loads that the guess does not
    balance are applied in several steps. Velocities are zero; drives keep what they prescribe at t.

    Arguments:
        native: the compiled scene.
        k: the constants (nk,) of `native.setup`.
        guess: the coordinates (nq,) to begin with.
        t: the time (s), which stays constant.

    Raises:
        NoEquilibrium: a SimulationError with the coordinates that loads keep moving.
        ModelError: where the model returns an error.
        ValueError: if `guess` has another length.

    Examples:
        >>> import derive
        >>> pendulum = derive.scene(
        ...     "pendulum",
        ...     gravity=(0, -9.81),
        ...     ground={"pivot": (0, 0)},
        ...     bodies={"rod": {"mass": 1, "inertia": "1/12", "markers": {"top": (0, 0.5)}}},
        ...     joints={"hinge": {"kind": "revolute", "between": ["ground.pivot", "rod.top"]}},
        ... )
        >>> native = derive.load_scene(derive.model_files(derive.lower(derive.derive(pendulum)), pendulum))
        >>> result = derive.equilibrium(native, native.setup(), [1.0])
        >>> abs(result.q.round(6))
        array([0.])
    """
    guess = checked_vector(native.nq, guess, "guess")
    norms = typical_row_norms(native, k, t, guess, mass_factor(mass_matrix(native, guess, k)))
    first = closest_state(native, k, t, guess, np.ones(native.nv, dtype=bool), norms).q
    unbalanced = native.force(t, first, np.zeros(native.nv), k)
    for steps in LOAD_STEPS:
        newton = _Newton(native, k, t, norms, max_norm(unbalanced))
        q: Vector | None = first
        for step in range(1, steps + 1):
            q = newton.balanced(q, (1.0 - step / steps) * unbalanced) if q is not None else None
        if q is not None:
            return newton.result(q, steps)
    raise NoEquilibrium(t, newton.moving)


@dataclass(frozen=True, eq=False)
class _Linearisation:
    """The balance of forces in a configuration: motions (nv, f) of unit kinetic energy that the constraints allow,
    multipliers, the out-of-balance force (nv,), and the stiffness (f, f) of those motions."""

    motions: Matrix
    lam: Vector
    unbalanced: Vector
    stiffness: Matrix

    @property
    def forces(self) -> Vector:
        """The work (f,) of the out-of-balance forces on each motion."""
        return np.asarray(self.motions.T @ self.unbalanced)


class _Newton:
    """The iteration, with the number of its steps, the largest load, and the coordinates of the last step.

    norms: (nlambda,) lengths by which the constraints are scaled, in all configurations.
    """

    def __init__(self, native: StaticSystem, k: Vector, t: float, norms: Vector, load: float) -> None:
        self.native, self.k, self.t, self.norms = native, k, t, norms
        self.iterations, self.load, self.first_load = 0, load, load
        self.moving: tuple[str, ...] = ()

    def balanced(self, q: Vector, excluded: Vector) -> Vector | None:
        """The configuration near q (nq,) that balances all loads but `excluded` (nv,); None without convergence."""
        at = self.linearisation(q, excluded)
        for _ in range(ITERATIONS):
            self.iterations += 1
            motion = at.motions @ _newton_step(at, self.load)
            length = self._length(q, motion)
            self.moving = _participants(self.native, motion)
            if length > LARGEST_STEP:
                motion = motion * (LARGEST_STEP / length)
            work = float(motion @ at.unbalanced)
            for halving in range(HALVINGS):
                trial = self._on_constraints(displaced(self.native, q, 0.5**halving * motion))
                after = self.linearisation(trial, excluded)
                if float(motion @ after.unbalanced) <= 0.5 * abs(work):  # no far overshoot; false for NaN
                    break
            q, at = trial, after
            if length <= SMALLEST_STEP:
                return q
        return None

    def linearisation(self, q: Vector, excluded: Vector) -> _Linearisation:
        """The balance of forces at rest in the configuration q (nq,), without the loads `excluded` (nv,)."""
        native, k, t = self.native, self.k, self.t
        rest = np.zeros(native.nv)
        R, G = mass_factor(mass_matrix(native, q, k)), constraint_matrix(native, t, q, k)
        scaled = in_mass_metric(G, R) / self.norms[:, None]
        allowed = null_space(scaled) if len(scaled) else np.eye(native.nv)
        h = native.force(t, q, rest, k) - excluded
        self.load = max(self.load, max_norm(h))
        lam = np.linalg.lstsq(scaled.T, solve_triangular(R, h, trans="T"), rcond=None)[0] / self.norms
        y = np.concatenate([q, rest, lam])
        values = native.jacobian(t, y, np.zeros_like(y), 0.0, k)
        stiffness = native.jacobian_pattern.dense(values)[native.nq : native.nq + native.nv, : native.nq]
        motions = solve_triangular(R, allowed)
        if native.nq == native.nv:
            return _Linearisation(motions, lam, h - G.T @ lam, motions.T @ stiffness @ motions)
        # In terms of rotation vectors the stiffness is not symmetric beside an equilibrium; its symmetric part is that
        # of the potential.
        of_motions = motions.T @ stiffness @ rate_matrix(native, q, k) @ motions
        return _Linearisation(motions, lam, h - G.T @ lam, (of_motions + of_motions.T) / 2)

    def result(self, q: Vector, load_steps: int) -> Equilibrium:
        """The equilibrium q (nq,) with its residual and eigenvalues."""
        at = self.linearisation(q, np.zeros(self.native.nv))
        values, vectors = _eigen(at.stiffness)
        softest = _participants(self.native, at.motions @ np.real(vectors[:, 0])) if len(values) else ()
        residual = max_norm(at.unbalanced)
        h = self.native.force(self.t, q, np.zeros(self.native.nv), self.k)
        return Equilibrium(
            self.t, q, at.lam, residual, max(self.first_load, max_norm(h)), values, softest, self.iterations, load_steps
        )

    def _on_constraints(self, q: Vector) -> Vector:
        """The configuration next to q (nq,) that meets the constraints, with the deformations of q if possible.

        A finite step along the tangent of a rotation stretches bodies; if that deformed stiff beams, they would keep
        the step short.
        """
        for free in (~velocities_with(self.native, Role.AMPLITUDE), np.ones(self.native.nv, dtype=bool)):
            closest = closest_state(self.native, self.k, self.t, q, free, self.norms)
            if closest.converged:
                break
        return closest.q

    def _length(self, q: Vector, motion: Vector) -> float:
        """The largest rotation (rad) of a motion (nq,), or displacement as a part of the size of the mechanism."""
        angles = velocities_with(self.native, Role.ROTATION)
        lengths = ~coordinates_with(self.native, Role.ROTATION, Role.QUATERNION, Role.AMPLITUDE)
        size = max(max_norm(q[lengths]), 1e-3)
        return max(max_norm(motion[angles]), max_norm(motion[~angles]) / size)


def _newton_step(at: _Linearisation, load: float) -> Vector:
    """The step (f,) of Newton's method; down the potential along motions of negative stiffness, if there is one."""
    forces = at.forces
    negligible = ROUNDING * load * np.max(np.abs(at.motions), axis=0, initial=0.0)
    if not _is_symmetric(at.stiffness):
        return np.asarray(np.linalg.lstsq(at.stiffness, -forces, rcond=None)[0])
    values, vectors = np.linalg.eigh(at.stiffness)
    limit = ROUNDING * max_norm(values)
    parts = vectors.T @ forces
    without_load = np.abs(parts) <= np.abs(vectors.T) @ negligible
    soft = np.abs(values) <= limit
    divisors = np.where(soft, max(limit, 1e-300), np.abs(values))
    return np.asarray(vectors @ np.where(soft & without_load, 0.0, -parts / divisors))


def _eigen(stiffness: Matrix) -> tuple[Vector, Matrix]:
    """Eigenvalues by ascending real parts, and eigenvectors as columns."""
    if _is_symmetric(stiffness):
        values, vectors = np.linalg.eigh((stiffness + stiffness.T) / 2)
        return values, vectors
    values, vectors = np.linalg.eig(stiffness)
    order = np.argsort(values.real)
    return values[order], vectors[:, order]


def _is_symmetric(stiffness: Matrix) -> bool:
    """Whether the stiffness is symmetric, so that the loads have a potential."""
    return max_norm((stiffness - stiffness.T).ravel()) <= 1e-9 * max_norm(stiffness.ravel())


def _participants(native: StaticSystem, motion: Vector) -> tuple[str, ...]:
    """The coordinates with a share above 10 % in a motion (nv,)."""
    largest = max_norm(motion)
    return tuple(name for name, x in zip(velocity_names(native), motion, strict=True) if abs(x) > 0.1 * largest > 0.0)
