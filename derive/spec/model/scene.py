"""The contents of a scene as frozen data: planar bodies, joints, drives, forces, and what to simulate."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import ClassVar, Literal

from derive.spec.model.body import Marker, NodalBody, PlanarBeam, Polynomial, SymbolicBody
from derive.spec.model.forces import Bushing, CustomForce, Force, ForceFrame, Spring, Torque
from derive.spec.model.markers import MarkerRef, PointMarker
from derive.spec.model.plots import Plot
from derive.spec.model.ports import SceneOutput
from derive.spec.model.quantity import Quantity
from derive.spec.model.simulation import NOT_GIVEN, InitialValues, Simulation
from derive.spec.model.time_function import TimeFunction

NAMED = {
    "bodies": "body",
    "joints": "joint",
    "drives": "drive",
    "forces": "force",
    "torques": "torque",
    "springs": "spring",
    "plots": "plot",
    "inputs": "input",
    "outputs": "output",
}
"""The sections of a scene whose elements have names, with the noun for one element."""


@dataclass(frozen=True)
class SceneInput:
    """A run-time input of the generated code, such as a torque or a prescribed motion.

    `function` is what it is in simulations; None where only the run-time values count.
    """

    name: str
    unit: str = ""
    function: TimeFunction | None = None


SceneStart = Literal["equilibrium"]
EQUILIBRIUM: SceneStart = "equilibrium"
"""The value of `start` for which the initial state of a scene is its static equilibrium."""


@dataclass(frozen=True)
class JointInitialValues:
    """Initial values of the relative motion of a joint, of body 2 relative to body 1; None where none is given.

    angle (rad) is that of joints that rotate, displacement (m) that of joints with an axis, speed the rate of either
    (rad/s or m/s). With `guess` the values are where the assembly begins.
    """

    angle: float | None = None
    displacement: float | None = None
    speed: float | None = None
    guess: bool = False

    @property
    def coordinate(self) -> float | None:
        """The given angle or displacement."""
        return self.displacement if self.angle is None else self.angle


@dataclass(frozen=True)
class RigidBody:
    """A rigid body in the plane. The coordinates of its markers count from the origin of its frame.

    `inertia` is about the centre of mass, which lies at `centre` in the frame of the body. A body whose motion is
    prescribed needs neither mass nor inertia (None). With `keep_coordinates` it has three coordinates however it is
    constrained, so that its joints and drives are constraints and their multipliers are the constraint reactions.
    """

    name: str
    mass: Quantity | None = None
    inertia: Quantity | None = None
    centre: tuple[Quantity, Quantity] = (Fraction(0), Fraction(0))
    markers: tuple[PointMarker, ...] = ()
    start: InitialValues = NOT_GIVEN
    keep_coordinates: bool = False
    kind: ClassVar[str] = "rigid"


@dataclass(frozen=True)
class DistributedLoad:
    """A force per length on a rod: polynomials in xi (N/m) times a function of t.

    `force` are its components along e1 and e2 of the inertial frame, or of the floating frame of the rod (`body`), as
    coefficients of 1, xi, xi^2, ...; xi goes from -1 to 1 along the whole rod.
    """

    name: str
    force: tuple[Polynomial, Polynomial]
    time: TimeFunction
    frame: ForceFrame = "inertial"


@dataclass(frozen=True)
class BeamBody:
    """A flexible rod in a scene: a free planar beam, cut into `pieces` beams of equal length that are welded together.

    `beam` is the whole rod: its name, mass, length and markers are those before it is cut; its gravity is None.
    `start` is that of the straight axis of the rod.
    """

    name: str
    beam: PlanarBeam
    pieces: int = 1
    start: InitialValues = NOT_GIVEN
    loads: tuple[DistributedLoad, ...] = ()
    kind: ClassVar[str] = "beam"

    @property
    def markers(self) -> tuple[Marker, ...]:
        """The markers of the whole rod."""
        return self.beam.markers


@dataclass(frozen=True)
class CustomBody:
    """A body of a type that is registered from outside the package; `values` are those of the keys of the type."""

    name: str
    kind: str
    values: Mapping[str, object] = field(default_factory=dict, hash=False)
    markers: tuple[PointMarker, ...] = ()
    start: InitialValues = NOT_GIVEN


SceneBody = RigidBody | BeamBody | CustomBody


@dataclass(frozen=True)
class Joint:
    """A joint between two markers. Its multipliers are the force and the torque it exerts on the second body.

    `kind` is a name of the registry of joints. `revolute`: the markers coincide; `weld`, `fixed`: so do they, and their
    rotations differ by `angle`, constant; `translational`: the second marker stays on a line through the first, along
    `axis` in the frame of the first body, and the rotations differ by `angle`.
    """

    name: str
    kind: str
    first: MarkerRef
    second: MarkerRef
    angle: float = 0.0
    axis: tuple[Fraction, Fraction] = (Fraction(1), Fraction(0))
    start: JointInitialValues = JointInitialValues()


@dataclass(frozen=True)
class CustomJoint(Joint):
    """A joint of a kind that is registered from outside the package; `values` are those of the keys of the kind."""

    values: Mapping[str, object] = field(default_factory=dict, hash=False)


@dataclass(frozen=True)
class Drive:
    """A prescribed motion of a joint: its relative rotation, or its displacement along the axis, is a `motion` of t, or
    the integral of a `speed` from 0 to t, plus `offset`."""

    name: str
    joint: str
    motion: TimeFunction | None
    speed: Quantity | TimeFunction | None = None
    offset: Fraction = Fraction(0)
    start: JointInitialValues = JointInitialValues()

    @property
    def constant_speed(self) -> Quantity | None:
        """The speed if it is a number or a parameter; None for a function of t."""
        return None if isinstance(self.speed, TimeFunction) else self.speed


@dataclass(frozen=True)
class Scene:
    """Planar bodies with joints, drives, forces and gravity: what `[scene]` and its companions specify.

    start: None for the state that initial values of bodies, joints and drives describe, or EQUILIBRIUM.
    """

    name: str
    ground: tuple[PointMarker, ...]
    gravity: tuple[Quantity, Quantity] | None
    bodies: tuple[SceneBody, ...]
    joints: tuple[Joint, ...]
    drives: tuple[Drive, ...] = ()
    forces: tuple[Force | CustomForce, ...] = ()
    torques: tuple[Torque | CustomForce, ...] = ()
    springs: tuple[Spring | Bushing | CustomForce, ...] = ()
    simulation: Simulation | None = None
    plots: tuple[Plot, ...] = ()
    start: SceneStart | None = None
    inputs: tuple[SceneInput, ...] = ()
    outputs: tuple[SceneOutput, ...] = ()


Specification = PlanarBeam | NodalBody | SymbolicBody | Scene
"""The types that `read` returns and `derive` takes: a body alone, or a scene of bodies."""


def check_specification(spec: object) -> None:
    """Raise TypeError if the argument is not a specification, for example the path of a file."""
    if not isinstance(spec, Specification):
        raise TypeError(f"a specification is needed, not {type(spec).__name__}; read a file with derive.read(...)")
