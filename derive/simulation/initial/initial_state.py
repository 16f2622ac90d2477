"""The initial state of a scene: initial values made consistent with joints, its equilibrium, or its steady motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from derive.display import html
from derive.runtime.native_call import Vector
from derive.runtime.native_scene import NativeScene
from derive.short_text import summary, vector_text
from derive.simulation.compiled_scene import max_norm
from derive.simulation.constraints.redundancy import check_accelerations, check_constraints
from derive.simulation.drive_jumps import check_start
from derive.simulation.equilibrium import Equilibrium, equilibrium
from derive.simulation.errors import ExcessiveDeformation, MovingDrives
from derive.simulation.initial.assembler import Assembler
from derive.simulation.initial.assembly import EXACT, Assembly, assemble
from derive.simulation.initial.conflicts import drive_rates, position_conflict, velocity_conflict
from derive.simulation.initial.contradictions import Conflict, InitialValue, Misfit
from derive.simulation.initial.deflection_remainders import deflection_remainders
from derive.simulation.initial.initial_guess import initial_guess
from derive.simulation.initial.initial_velocities import velocities
from derive.simulation.initial.kinematics import Kinematics
from derive.simulation.initial.targets import Strength, Target, targets
from derive.simulation.linear.steady_motion import SteadyMotion, steady_motion
from derive.simulation.observables.beams import beam_bodies, half_length, relative_deflection
from derive.simulation.observables.motion import SceneMotion, si_value, transformed
from derive.spec.model.planar_bodies import BeamBody, RigidBody
from derive.spec.model.scene import EQUILIBRIUM, STEADY, Scene
from derive.spec.model.specification import AnyScene

LISTED = 6
"""The largest number of values that notes on an equilibrium list, in which all given values are first guesses."""
MAX_DEFLECTION = 0.3
"""The largest deflection of an initial state, relative to the length of a piece of a beam; one with a larger deflection
is not a state of this mechanism."""
ROUNDING = 1e-15
"""Values below this part of the size of the scene, of 1 rad, or of the largest velocity are rounding errors of zero."""


@dataclass(frozen=True, eq=False)
class InitialState:
    """A consistent state in SI units, which meets joints and drives.

    Attributes:
        t: the time, s.
        q: coordinates (nq,).
        v: generalised velocities (nv,).
        position_error: the largest violation of a constraint, m or rad.
        velocity_error: that of the rate of a constraint, m/s or rad/s.
        deformed: whether deformations had to change from those of the guess.
        deforming: whether their rates had to.
        values: the initial values of the specification, and those of the state.
        equilibrium: the static equilibrium that the state is, if it is one.
        remainders: a line on each deflection that shapes do not have, and approximate.
        steady: the steady motion that the state is, if it is one.

    Examples:
        >>> import derive
        >>> ball = derive.scene("flight", bodies={"ball": {"mass": 1, "inertia": 1, "start": {"velocity": (3, 4)}}})
        >>> initial = derive.simulate(ball, duration=1, output=1).initial
        >>> initial.v
        array([3., 4., 0.])
        >>> initial.corrections
        ()
    """

    t: float
    q: Vector
    v: Vector
    position_error: float
    velocity_error: float
    deformed: bool
    deforming: bool
    values: tuple[InitialValue, ...] = ()
    equilibrium: Equilibrium | None = None
    remainders: tuple[str, ...] = ()
    steady: SteadyMotion | None = None

    @property
    def corrections(self) -> tuple[InitialValue, ...]:
        """The given values that the state does not have."""
        return tuple(value for value in self.values if value.corrected)

    @property
    def notes(self) -> tuple[str, ...]:
        """A line on each given value that is changed or approximated, and on the equilibrium, for a user to read."""
        reason = "corrected: it contradicts the joints or other values"
        if of := self.equilibrium or self.steady:
            reason = "its value in equilibrium" if self.equilibrium else "its value in the steady motion"
        balance = (str(of),) if of else ()
        listed, others = self.corrections, 0
        if of and len(listed) > LISTED:
            listed, others = listed[:LISTED], len(listed) - LISTED
        more = (f"likewise {others} other given values, all of which are first guesses",) if others else ()
        return (*balance, *self.remainders, *(f"{value} ({reason})" for value in listed), *more)

    def __repr__(self) -> str:
        kind = "equilibrium" if self.equilibrium else "steady motion" if self.steady else "consistent state"
        errors = f"|g| <= {self.position_error:.1e}, |gdot| <= {self.velocity_error:.1e}"
        return summary(
            f"InitialState at t = {self.t:g} s: {kind}, {errors}",
            {"q": vector_text(self.q), "v": vector_text(self.v), "notes": "; ".join(self.notes)},
        )

    _repr_html_ = html


def initial_state(scene: Scene, native: NativeScene, k: Vector | None = None) -> InitialState:
    """The initial state of a scene at t = 0: it meets joints and drives and keeps the initial values that are given.

    Positions that are not given come as near as possible to first guesses, or else to zero; velocities that are not
    given are those of the least kinetic energy. Given values that contradict each other by no more than rounding are
    corrected: see `InitialState.corrections`. With `start = "equilibrium"` the positions are those of the static
    equilibrium that Newton's method reaches from there, with `start = "steady"` the state is a steady motion. The state
    does not depend on which coordinates the scene keeps.

    Arguments:
        scene: the scene.
        native: the compiled scene.
        k: the constants (nk,) of `native.setup`; by default those of the default parameters.

    Raises:
        SpecError: with given values that contradict each other, and with drives whose speed jumps at t = 0.
        SimulationError: with the constraints that cannot be met.
        TypeError: for a body alone, whose initial state is its `start`.
        ExcessiveDeformation: where they can be met only by beams that bend beyond what linear displacements describe.

    Examples:
        >>> import derive
        >>> pendulum = derive.scene(
        ...     "pendulum",
        ...     ground={"pivot": (0, 0)},
        ...     bodies={"rod": {"mass": 1, "inertia": 1, "markers": {"top": (0, 0.5)}, "start": {"velocity": (2, 0)}}},
        ...     joints={"hinge": {"kind": "revolute", "between": ["ground.pivot", "rod.top"]}},
        ... )
        >>> native = derive.load_scene(derive.model_files(derive.lower(derive.derive(pendulum)), pendulum))
        >>> derive.initial_state(pendulum, native).v.round(9)  # 2 m/s at 0.5 m from the hinge
        array([4.])
    """
    if not isinstance(scene, AnyScene):
        raise TypeError(f"a scene is needed, not {type(scene).__name__}; derive.simulate starts a body alone")
    check_start(scene)
    constants = native.setup() if k is None else k
    guess, _, _ = initial_guess(scene, native, constants)
    assembler = Assembler(native, constants, 0.0, scene_size(scene))
    every = targets(scene, native)
    positions = [target for target in every if not target.rate]
    assembly = assemble(
        assembler,
        guess,
        positions,
        lambda q: _check_deflections(scene, native, constants, q),
        lambda q, given: position_conflict(scene, assembler, guess, q, given),
        rough=scene.start is not None,
    )
    balance = None
    if scene.start == EQUILIBRIUM:
        check_rest(scene, native, constants)
        balance = equilibrium(native, constants, assembly.q)
        assembly = _moved(assembler, assembly, balance.q, positions)
    q = assembly.q
    momentum = _momentum(scene, assembler.kinematics(q, moving=True)) if scene.drives else np.zeros(native.nv)
    rates = [target for target in every if target.rate]

    def conflict(v: Vector, given: Sequence[Target]) -> Conflict:
        return velocity_conflict(scene, assembler, q, v, given)

    result = velocities(assembler, q, rates, momentum, conflict)
    steady = None
    if scene.start == STEADY:
        steady = steady_motion(native, constants, q, result.v)
        assembly = _moved(assembler, assembly, steady.q, positions)
        q, result = steady.q, replace(result, v=steady.v)
    check_constraints(native, constants, 0.0, q)
    check_accelerations(native, constants, 0.0, q, result.v)
    values = _values(assembler, q, result.v, every, (*assembly.misfits, *result.misfits))
    errors, changed = (assembly.error, result.error), (assembly.deformed, result.deforming)
    return InitialState(0.0, q, result.v, *errors, *changed, values, balance, deflection_remainders(scene), steady)


def _values(
    assembler: Assembler, q: Vector, v: Vector, every: Sequence[Target], misfits: Sequence[Misfit]
) -> tuple[InitialValue, ...]:
    """The values that the specification gives or guesses, and those of the state; rounding errors of zero are zero."""
    stated = [target for target in every if target.strength is not Strength.DEFAULT]
    still = assembler.values(q)  # gradients take a pose of all bodies for each coordinate, and rates alone need them
    moving = assembler.kinematics(q, moving=True) if any(target.rate for target in stated) else still
    changed = {id(misfit.target) for misfit in misfits}
    result = []
    for target in stated:
        linear, guess = target.function(moving if target.rate else still), target.strength is Strength.GUESS
        value = float(linear.gradient @ v) + linear.drift if target.rate else linear.value
        scale = assembler.unit(target) * (max_norm(v) if target.rate else 1.0)
        shown = 0.0 if abs(value) < ROUNDING * scale else value
        result.append(InitialValue(target.name, target.unit, target.value, shown, guess, id(target) in changed))
    return tuple(result)


def scene_size(scene: Scene) -> float:
    """The diagonal (m) of the rectangle around all markers, with bodies where they start; 1 of a point."""
    points = [np.array([[si_value(p.x), si_value(p.y)]]) for p in scene.ground]
    for body in scene.bodies:
        pose = np.array([[*(body.start.position or (0.0, 0.0)), body.start.angle or 0.0]])
        if isinstance(body, BeamBody):
            half = body.pieces * half_length(body)
            own = [(-half, 0.0), (half, 0.0)]
        else:
            own = [(0.0, 0.0), *((si_value(m.x), si_value(m.y)) for m in body.markers)]
        points += [transformed(pose, np.array(point)) for point in own]
    return float(np.hypot(*np.ptp(np.concatenate(points), axis=0))) or 1.0


def _check_deflections(scene: Scene, native: NativeScene, k: Vector, q: Vector) -> None:
    """Raise ExcessiveDeformation if joints bend a beam too far."""
    motion = SceneMotion(scene, native, k, np.zeros(1), q[None], np.zeros((1, native.nv)))
    deflections = {beam.name: relative_deflection(motion, beam) for beam in beam_bodies(scene)}
    if excessive := {name: value for name, value in deflections.items() if value > MAX_DEFLECTION}:
        raise ExcessiveDeformation(excessive)


def check_rest(scene: AnyScene, native: NativeScene, k: Vector) -> None:
    """Raise MovingDrives if drives have a speed or an acceleration at t = 0, so that there is no static equilibrium."""
    moving = []
    for drive in scene.drives:
        if any(rate != 0.0 for rate in drive_rates(native, k, drive)):
            moving.append(drive.name)
    if moving:
        raise MovingDrives(moving)


def _moved(assembler: Assembler, assembly: Assembly, q: Vector, positions: list[Target]) -> Assembly:
    """The assembly in equilibrium or in steady motion, q (nq,); given positions that it changes are listed."""
    given = [target for target in positions if target.strength is Strength.GIVEN]
    misfits = tuple(m for m in assembler.misfits(given, q) if abs(m.relative) > EXACT)
    error = max_norm(assembler.native.constraints(assembler.t, q, assembler.k))
    return replace(assembly, q=q, misfits=misfits, error=error)


def _momentum(scene: Scene, kinematics: Kinematics) -> Vector:
    """The generalised momentum (nv,) of rigid bodies that drives carry along, at v = 0."""
    result = np.zeros(kinematics.native.nv)
    for body in scene.bodies:
        if not isinstance(body, RigidBody) or body.mass is None or body.inertia is None:
            continue
        c1, c2, phi = (kinematics.component(body.name, i) for i in range(3))
        x, y = (si_value(x) for x in body.centre)
        cos, sin = np.cos(phi.value), np.sin(phi.value)
        turns = -(sin * x + cos * y), cos * x - sin * y
        for c, turn in zip((c1, c2), turns, strict=True):
            result += si_value(body.mass) * (c.gradient + turn * phi.gradient) * (c.drift + turn * phi.drift)
        result += si_value(body.inertia) * phi.gradient * phi.drift
    return result
