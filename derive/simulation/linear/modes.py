"""`modes`: natural frequencies, damping ratios and mode shapes of a model about a state."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from derive.display import html
from derive.enumerations import enumeration
from derive.errors import Problem, SpecError
from derive.generated_models import generated
from derive.roles import Role
from derive.runtime.compiler import FLAGS, WITHOUT_BATCHES
from derive.runtime.loading import load, load_scene
from derive.runtime.native_call import Vector
from derive.runtime.native_scene import NativeScene
from derive.short_text import counted, listed, summary
from derive.simulation.compiled_scene import max_norm
from derive.simulation.constraints.redundancy import check_constraints
from derive.simulation.equilibrium import Equilibrium
from derive.simulation.errors import MovingDrives, NoEquilibrium, SimulationError
from derive.simulation.integration.solution import Progress
from derive.simulation.linear.eigenmodes import Mode, eigenmodes
from derive.simulation.linear.linearisation import Linearisation, linearise
from derive.simulation.linear.run_time_inputs import constants, scene_with_values
from derive.simulation.linear.steady_motion import SteadyMotion
from derive.simulation.observables.motion import SceneMotion, si_value
from derive.simulation.prepared_run import PreparedRun
from derive.simulation.redundant_joints import with_redundant_joints
from derive.simulation.scene_start import state_of
from derive.simulation.simulate import with_simulation
from derive.simulation.validity.axial_loads import missing_stiffness_notes
from derive.spec.model.beam_pieces import in_pieces
from derive.spec.model.scene import EQUILIBRIUM, STEADY, Scene
from derive.spec.model.scene_functions import input_functions, time_functions
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.specification import AnyScene, Specification
from derive.spec.model.time_function import depends_on_time

ADVICE = "The option --at 0, in Python at=0, takes the initial state instead."
OF_ROTORS = 'Where everything rotates at a constant speed, start = "steady" in [scene] takes that steady motion.'


ROWS = 1000.0
"""The largest number of rows of the motion up to a state; integrators limit the steps between two rows."""


@dataclass(frozen=True, eq=False)
class _State:
    """A compiled model, its constants k (nk,), the state t (s), q (nq,), v (nv,), and what it is, if it is steady."""

    native: NativeScene
    k: Vector
    t: float
    q: Vector
    v: Vector
    equilibrium: Equilibrium | None = None
    steady: SteadyMotion | None = None


@dataclass(frozen=True, eq=False)
class Modes:
    """The modes of a model about a state.

    Attributes:
        spec: the scene or the body.
        native: the compiled model.
        k: its constants (nk,).
        linear: the state and the state-space matrices.
        modes: the modes by their natural frequencies, those of zero eigenvalues first.
        equilibrium: the equilibrium of a scene if the state is one; None otherwise and for a body.
        steady: the steady motion of a scene if the state is one, about which the modes are those in axes that rotate
            with it; None otherwise.
        notes: on bodies of first order that spin fast, or that forces pull or press, in the state.

    Examples:
        >>> import derive
        >>> modes = derive.modes(derive.planar_beam("beam", bending_stiffness=100))
        >>> modes.frequencies.round(2)  # rigid-body motions, then those of both shapes, Hz
        array([  0.  ,   0.  ,   0.  ,  42.71, 145.87])
        >>> modes.zero_eigenvalues
        6
    """

    spec: Specification
    native: NativeScene
    k: Vector
    linear: Linearisation
    modes: tuple[Mode, ...]
    equilibrium: Equilibrium | None
    steady: SteadyMotion | None = None
    notes: tuple[str, ...] = ()

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

    @property
    def functions_of_time(self) -> tuple[str, ...]:
        """The keys of the functions of a scene that change with time; modes have their values at the state's time."""
        if not isinstance(self.spec, (Scene, SpatialScene)):
            return ()
        functions = (*time_functions(self.spec), *input_functions(self.spec))
        changing = (path for path, function in functions if function.kind != "input" and depends_on_time(function))
        return tuple(dict.fromkeys(".".join(path) for path in changing))

    def first(self, count: int) -> tuple[Mode, ...]:
        """The modes of zero eigenvalues, and the first modes of the others.

        Arguments:
            count: the number of those others.

        Examples:
            >>> len(modes.first(1))
            4
        """
        return self.modes[: count + sum(not mode.eigenvalue for mode in self.modes)]

    @property
    def speed(self) -> float:
        """The largest generalised velocity of the state (SI units), 0 at rest."""
        return max_norm(self.linear.v)

    @property
    def acceleration(self) -> float:
        """The largest generalised acceleration of the state (SI units), 0 in equilibrium."""
        return max_norm(self.linear.vdot)

    def __repr__(self) -> str:
        moving = "steady motion" if self.steady else f"state at t = {self.linear.t:g} s"
        state = "equilibrium" if self.equilibrium else moving
        return summary(
            f"Modes of {self.spec.name}: {counted(len(self.modes), 'mode')} about the {state}",
            {"frequencies": f"{listed(f'{value:.4g}' for value in self.frequencies)} Hz"},
        )

    _repr_html_ = html


def modes(spec: Specification, *, at: float | None = None, progress: Progress | None = None) -> Modes:
    """The modes of small motions of a scene about its static equilibrium, or of a body about its undeformed state.

    About the steady motion of a scene that starts in one they are those in axes that rotate with it.

    Arguments:
        spec: a scene or a body.
        at: the time (s) of the motion of a scene from its initial state, whose state is taken in place of the
            equilibrium; the coefficients are those of that instant.
        progress: called with the time (s) that this motion has reached.

    Raises:
        SpecError: if the specification is not valid.
        SimulationError: if there is no equilibrium or no initial state.
        CompilerError: if there is no compiler.
        ModelError: if the model refuses a parameter or a state.

    Examples:
        >>> import derive
        >>> pendulum = derive.scene(
        ...     "pendulum",
        ...     gravity=(0, -9.81),
        ...     ground={"pivot": (0, 0)},
        ...     bodies={"rod": {"mass": 1, "inertia": "1/12", "markers": {"top": (0, 0.5)}}},
        ...     joints={"hinge": {"kind": "revolute", "between": ["ground.pivot", "rod.top"]}},
        ... )
        >>> derive.modes(pendulum).frequencies.round(4)  # sqrt(3 g / (2 l)) / (2 pi)
        array([0.6105])
    """
    if isinstance(spec, (Scene, SpatialScene)):
        try:
            state = with_redundant_joints(spec, lambda scene: _of_scene(scene, at, progress))
        except MovingDrives as error:
            raise SimulationError(
                f"a scene whose drives move at t = 0 has no static equilibrium: {enumeration(error.drives)}. "
                f"{OF_ROTORS} {ADVICE}"
            ) from None
    else:
        state = _of_body(spec, at)
    axes = None if state.steady is None else state.steady.axes
    linear = linearise(state.native, state.k, state.t, state.q, state.v, axes)
    whole, notes = in_pieces(spec), {}
    if isinstance(whole, SpatialScene):
        of_state = np.array([state.t]), state.q[None], state.v[None]
        notes = missing_stiffness_notes(whole, state.native, state.k, *of_state)
    found, about = eigenmodes(linear), (state.equilibrium, state.steady)
    return Modes(whole, state.native, state.k, linear, found, *about, tuple(notes.values()))


def _of_body(spec: Specification, at: float | None) -> _State:
    """A body, undeformed and at rest in the inertial frame."""
    if at is not None:
        raise SpecError((Problem("", "a body alone has its modes about its undeformed state; leave out --at"),))
    native = load(generated(spec)[1], (*FLAGS, WITHOUT_BATCHES))
    q = np.zeros(native.nq)
    if Role.QUATERNION in native.roles:
        q[native.roles.index(Role.QUATERNION)] = 1.0
    return _State(native, native.setup(), 0.0, q, np.zeros(native.nv))


def _motion(scene: AnyScene, at: float, progress: Progress | None) -> SceneMotion:
    """The motion of a scene up to a time (s). Raises SpecError, which names the option if the time is the reason."""
    rows = ROWS if scene.simulation is None else min(ROWS, max(1.0, at / scene.simulation.output))
    try:
        run = PreparedRun(with_simulation(scene, at, at / rows), complete=False).trajectory(progress=progress)
    except SpecError as error:
        if reasons := [p for p in error.problems if p.path in ("simulation.duration", "simulation.output")]:
            text = f"--at {at:g} (in Python at={at:g}) is no time, in s, up to which a motion can be computed"
            raise SpecError((Problem("", f"{text}: {reasons[0].message}"),)) from None
        raise
    return run.motion


def _check_constant_speeds(scene: AnyScene) -> None:
    """Raise MovingDrives if drives have a speed that is a number other than 0, which no code is needed to know."""
    constant = ((drive.name, drive.constant_speed) for drive in scene.drives)
    if moving := [name for name, speed in constant if speed is not None and si_value(speed) != 0.0]:
        raise MovingDrives(moving)


def _of_scene(scene: AnyScene, at: float | None, progress: Progress | None) -> _State:
    """A scene in its state at a time (s), or in its steady state, with the values of its run-time inputs there."""
    if at is not None and at > 0.0:
        motion = _motion(scene_with_values(scene), at, progress)
        t, q, v = float(motion.t[-1]), motion.q[-1], motion.v[-1]
        native = load_scene(generated(scene)[1], (*FLAGS, WITHOUT_BATCHES))  # simulations leave out what is needed here
        k = constants(scene, native, t)
        check_constraints(native, k, t, q)
        return _State(native, k, t, q, v)
    if at is None and scene.start != STEADY:
        _check_constant_speeds(scene)
    native = load_scene(generated(scene)[1], (*FLAGS, WITHOUT_BATCHES))
    k = constants(scene, native, 0.0)
    if at is not None:
        start = state_of(scene, native, k)
        return _State(native, k, start.t, start.q, start.v)
    if scene.start == STEADY:
        start = state_of(scene, native, k)
        return _State(native, k, start.t, start.q, start.v, steady=start.steady)
    try:
        changed: Any = scene
        balance = state_of(replace(changed, start=EQUILIBRIUM), native, k).equilibrium
    except NoEquilibrium as error:
        raise SimulationError(f"{error} {ADVICE}") from None
    assert balance is not None
    return _State(native, k, balance.t, balance.q, np.zeros(native.nv), balance)
