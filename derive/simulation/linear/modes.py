"""`modes`: natural frequencies, damping ratios and mode shapes of a model about a state."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from derive.backends.model_files import model_files
from derive.derivation import derive, lower
from derive.errors import Problem, SpecError
from derive.roles import Role
from derive.runtime.compiled_model import Native
from derive.runtime.loading import load
from derive.runtime.native_call import Vector
from derive.runtime.native_scene import NativeScene
from derive.simulation.compiled_scene import max_norm
from derive.simulation.initial.initial_state import initial_state
from derive.simulation.linear.eigenmodes import Mode, eigenmodes
from derive.simulation.linear.linearisation import Linearisation, linearise
from derive.simulation.simulate import simulate
from derive.spec.model.scene import Scene, Specification

State = tuple[Native, Vector, float, Vector, Vector]
"""A compiled model, its constants k (nk,), and a state: t (s), q (nq,), v (nv,)."""


@dataclass(frozen=True, eq=False)
class Modes:
    """The modes of a model about a state.

    linear: the state and the state-space matrices. modes: see `eigenmodes`. native, k: the compiled model and its
    constants (nk,).
    """

    spec: Specification
    native: Native
    k: Vector
    linear: Linearisation
    modes: tuple[Mode, ...]

    @property
    def frequencies(self) -> Vector:
        """The natural frequency of each mode (n,), Hz; 0 of one that does not oscillate."""
        return np.array([mode.frequency for mode in self.modes])

    @property
    def damping_ratios(self) -> Vector:
        """The damping ratio of each mode (n,)."""
        return np.array([mode.damping_ratio for mode in self.modes])

    @property
    def zero_eigenvalues(self) -> int:
        """The number of eigenvalues that are zero: two for each rigid-body motion without force."""
        return 2 * self.linear.count - sum(1 + (mode.eigenvalue.imag != 0) for mode in self.modes if mode.eigenvalue)

    def first(self, count: int) -> tuple[Mode, ...]:
        """The modes of zero eigenvalues, and the first `count` of the others."""
        return self.modes[: count + sum(not mode.eigenvalue for mode in self.modes)]

    @property
    def speed(self) -> float:
        """The largest generalised velocity of the state (SI units), 0 at rest."""
        return max_norm(self.linear.v)

    @property
    def acceleration(self) -> float:
        """The largest generalised acceleration of the state (SI units), 0 in equilibrium."""
        return max_norm(self.linear.vdot)


def modes(spec: Specification, *, at: float | None = None) -> Modes:
    """The modes of small motions about a state of a scene, or of a body about its undeformed state at rest.

    at: the time (s) of the motion from the initial state, whose state is taken. The coefficients are those of that
    instant.

    Raises SpecError, CompilerError, ModelError, SimulationError.
    """
    native, k, t, q, v = _of_scene(spec, 0.0 if at is None else at) if isinstance(spec, Scene) else _of_body(spec, at)
    linear = linearise(native, k, t, q, v)
    return Modes(spec, native, k, linear, eigenmodes(linear))


def _of_body(spec: Specification, at: float | None) -> State:
    """A body, undeformed and at rest in the inertial frame."""
    if at is not None:
        raise SpecError((Problem("", "a body alone has its modes about its undeformed state; leave out --at"),))
    native = load(model_files(lower(derive(spec)), spec))
    q = np.zeros(native.nq)
    if Role.QUATERNION in native.roles:
        q[native.roles.index(Role.QUATERNION)] = 1.0
    return native, native.setup(), 0.0, q, np.zeros(native.nv)


def _of_scene(scene: Scene, at: float) -> State:
    """A scene in its state at a time (s)."""
    if at > 0.0:
        motion = simulate(scene, duration=at, output=at).motion
        return motion.native, motion.k, float(motion.t[-1]), motion.q[-1], motion.v[-1]
    native = load(model_files(lower(derive(scene)), scene))
    assert isinstance(native, NativeScene)
    k = native.setup()
    start = initial_state(scene, native, k)
    return native, k, start.t, start.q, start.v
