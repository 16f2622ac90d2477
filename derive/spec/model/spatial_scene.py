"""The contents of a scene in space as frozen data: bodies with marker frames, joints, drives, forces."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Annotated, ClassVar, Literal

from derive.spec.model.beam_parts import DEFAULT_LENGTH, DEFAULT_MASS, INERTIA_UNIT
from derive.spec.model.body import GRAVITY, NodalBody
from derive.spec.model.forces import BETWEEN, ForceFrame
from derive.spec.model.keys import KeyType, declared_keys, key
from derive.spec.model.markers import MarkerRef
from derive.spec.model.plots import Plot
from derive.spec.model.ports import SceneOutput
from derive.spec.model.quantity import Quantity
from derive.spec.model.scene import (
    NOT_NEEDED,
    Drive,
    JointInitialValues,
    Redundant,
    Scene,
    SceneInput,
    SceneLowering,
    SceneStart,
)
from derive.spec.model.simulation import GUESS, Simulation
from derive.spec.model.time_function import TimeFunction

Triple = tuple[float, float, float]
UnitQuaternion = tuple[float, float, float, float]
NO_ROTATION: UnitQuaternion = (1.0, 0.0, 0.0, 0.0)

ROTATION_FORMS = (
    "a unit quaternion, scalar first; { axis = [..], angle = a }; two axes of the frame { x = [..], y = [..] }; or "
    '{ angles = [a, b, c], sequence = "xyz" } about the axes of the turning frame'
)
"""The notations of a rotation, for descriptions."""


@dataclass(frozen=True)
class FrameMarker:
    """A named marker of a rigid body or of the ground: a point, and the rotation of its frame, in those of the body."""

    name: str
    position: Annotated[
        tuple[Quantity, Quantity, Quantity],
        key(
            KeyType.COORDINATE_TRIPLE,
            "Coordinates of the point, m, in the frame of the body or the inertial frame.",
            DEFAULT_LENGTH.unit,
            name="at",
            example="[0.1, 0, 0]",
        ),
    ]
    rotation: Annotated[
        UnitQuaternion,
        key(
            KeyType.ROTATION,
            f"Rotation of the frame of the marker: {ROTATION_FORMS}.",
            shown=(1, 0, 0, 0),
        ),
    ] = NO_ROTATION


@dataclass(frozen=True)
class SpatialInitialValues:
    """Initial values of a body in space. The initial state keeps what is given; values not given adapt to it."""

    position: Annotated[
        Triple | None, key(KeyType.TRIPLE, "Position of the origin of the body frame in the inertial frame, m.")
    ] = None
    rotation: Annotated[
        UnitQuaternion | None, key(KeyType.ROTATION, f"Rotation of the body frame: {ROTATION_FORMS}.")
    ] = None
    velocity: Annotated[Triple | None, key(KeyType.TRIPLE, "Velocity of the origin in the inertial frame, m/s.")] = None
    angular_velocity: Annotated[
        Triple | None, key(KeyType.TRIPLE, "Angular velocity in the frame of the body, rad/s.")
    ] = None
    amplitudes: Annotated[
        tuple[float, ...] | None,
        key(KeyType.AMPLITUDES, "Amplitudes of the first modes of a flexible body, m; the others are zero."),
    ] = None
    amplitude_rates: Annotated[
        tuple[float, ...] | None,
        key(KeyType.AMPLITUDES, "Rates of the amplitudes of the first modes, m/s; the others are zero."),
    ] = None
    guess: Annotated[bool, GUESS] = False


SPATIAL_START = key(
    SpatialInitialValues, "Initial values; those that are not given adapt to the others and to the joints."
)


@dataclass(frozen=True)
class SpatialJointInitialValues(JointInitialValues):
    """Initial values of the relative motion of a joint in space: of body 2 relative to body 1."""

    angle: Annotated[
        float | None, key(KeyType.FLOAT, "Rotation about z of a joint whose bodies may turn about it, rad.")
    ] = None
    displacement: Annotated[
        float | None, key(KeyType.FLOAT, "Displacement along z of a joint whose bodies may move along it, m.")
    ] = None
    speed: Annotated[
        float | None,
        key(KeyType.FLOAT, "Rate of the only motion of a revolute, screw or prismatic joint, rad/s or m/s."),
    ] = None
    displacements: Annotated[
        tuple[float, float] | None,
        key(KeyType.FLOAT_PAIR, "Displacements of a planar joint along x and y of the first marker, m."),
    ] = None
    angle_rate: Annotated[float | None, key(KeyType.FLOAT, "Rate of the angle, rad/s.")] = None
    displacement_rate: Annotated[float | None, key(KeyType.FLOAT, "Rate of the displacement, m/s.")] = None
    displacement_rates: Annotated[
        tuple[float, float] | None, key(KeyType.FLOAT_PAIR, "Rates of the displacements of a planar joint, m/s.")
    ] = None


NO_JOINT_START = SpatialJointInitialValues()
NOT_GIVEN_IN_SPACE = SpatialInitialValues()
FRAMES = key(
    KeyType.FRAMES,
    "Named markers: coordinates [x, y, z], m, or { at = [x, y, z], rotation = ... } of a frame that is rotated.",
    default=(),
)


@dataclass(frozen=True)
class SpatialRigidBody:
    """A rigid body in space."""

    name: str
    mass: Annotated[Quantity | None, key(KeyType.POSITIVE_QUANTITY, f"Mass, kg; {NOT_NEEDED}", DEFAULT_MASS.unit)] = (
        None
    )
    inertia: Annotated[
        tuple[Quantity, ...] | None,
        key(
            KeyType.INERTIA_TENSOR,
            "Tensor of inertia about the centre of mass along the axes of the body, kg m^2: the entries "
            f"[Jxx, Jyy, Jzz, Jxy, Jxz, Jyz], Jxy = - int x y dm; {NOT_NEEDED}",
            INERTIA_UNIT,
            example="[0.01, 0.02, 0.02, 0, 0, 0]",
        ),
    ] = None
    centre: Annotated[
        tuple[Quantity, Quantity, Quantity],
        key(
            KeyType.COORDINATE_TRIPLE,
            "Position of the centre of mass in the frame of the body, m.",
            DEFAULT_LENGTH.unit,
        ),
    ] = (Fraction(0), Fraction(0), Fraction(0))
    markers: Annotated[tuple[FrameMarker, ...], FRAMES] = ()
    start: Annotated[SpatialInitialValues, SPATIAL_START] = NOT_GIVEN_IN_SPACE
    keep_coordinates: Annotated[
        bool,
        key(
            KeyType.TRUTH,
            "Whether the body keeps position and quaternion even if a joint or a drive could eliminate some; the "
            "multipliers are then the constraint reactions.",
        ),
    ] = False
    kind: ClassVar[str] = "rigid"


NodeMotion = Literal["mean", "rigid"]


@dataclass(frozen=True)
class NodeFrame:
    """A named marker of a finite-element body: a node, or a set of nodes."""

    name: str
    nodes: Annotated[
        tuple[int, ...],
        key(
            KeyType.COUNTS,
            "Nodes whose weighted mean displacement and rotation are those of the marker.",
            default=(),
        ),
        key(KeyType.COUNT, "A node, counted from 0; its marker has no rotation of its own.", name="node"),
    ]
    weights: Annotated[tuple[Fraction, ...], key(KeyType.WEIGHTS, "Weights of the nodes; equal by default.")] = ()
    motion: Annotated[
        NodeMotion,
        key(
            KeyType.CHOICE,
            "How the nodes move: mean, freely (their weighted mean is the marker, as RBE3), or rigid, as a rigid body "
            "(as RBE2): computed modes then have this constraint, modes that are given must meet it.",
            choice_of="the motion of nodes",
        ),
    ] = "mean"
    rotation: Annotated[
        UnitQuaternion,
        key(
            KeyType.ROTATION,
            f"Rotation of the marker against the undeformed body: {ROTATION_FORMS}.",
            shown=(1, 0, 0, 0),
        ),
    ] = NO_ROTATION

    @property
    def has_rotation(self) -> bool:
        """Whether the marker has a rotation by deformation."""
        return len(self.nodes) > 1


@dataclass(frozen=True)
class NodalLoad:
    """Forces at nodes of a finite-element body, times a function of t."""

    name: str
    nodes: Annotated[
        tuple[int, ...],
        key(KeyType.LOADED_NODES, "The nodes, counted from 0.", default=(), example="[3, 4]"),
        key(
            KeyType.TEXT,
            "File in place of nodes and forces, relative to the specification: a CSV file with the columns node, x, y, "
            "z, the number of a node and the components of the force there, N, or a .npz file with the arrays nodes "
            "(n,) and forces (n, 3).",
            name="file",
            example='"pressure.csv"',
        ),
    ]
    forces: Annotated[
        tuple[tuple[Fraction, Fraction, Fraction], ...],
        key(
            KeyType.NODAL_FORCES,
            "The force at each node, N: three components; a single force is that of all nodes.",
            default=(),
            example="[[0, 0, -5], [0, 0, -10]]",
        ),
    ]
    time: Annotated[
        TimeFunction,
        key(
            KeyType.FUNCTION,
            "Factor of the load: a number, a function of t, or an input.",
            default=TimeFunction("number", value=Fraction(1)),
            shown=1,
        ),
    ]
    frame: Annotated[
        ForceFrame,
        key(KeyType.CHOICE, "The frame of the components: inertial, or body, the floating frame of the body."),
    ] = "inertial"


@dataclass(frozen=True)
class FlexibleBody:
    """A finite-element body in a scene in space; `body` are its data, without gravity, markers and initial values."""

    name: str
    body: NodalBody
    markers: Annotated[
        tuple[NodeFrame, ...],
        key(
            KeyType.NODE_FRAMES,
            "Named markers: the number of a node, or { nodes = [..] } for the weighted mean motion of a set of nodes.",
            default=(),
        ),
    ] = ()
    start: Annotated[SpatialInitialValues, SPATIAL_START] = NOT_GIVEN_IN_SPACE
    loads: Annotated[
        tuple[NodalLoad, ...], key(NodalLoad, "Loads on nodes by name.", example="[bodies.rod.loads.pressure]")
    ] = ()
    keep_coordinates: ClassVar[bool] = True
    kind: ClassVar[str] = "flexible"


SpatialBody = SpatialRigidBody | FlexibleBody


@dataclass(frozen=True)
class SpatialJoint:
    """A joint between two marker frames."""

    # Its kind and further keys are those of the registry of joints in space. Its multipliers are the forces along, and
    # the torques about, the axes of the frame of the first marker that it exerts on the second body.
    name: str
    kind: str
    first: Annotated[MarkerRef, BETWEEN]
    second: MarkerRef
    removes: Annotated[
        tuple[str, ...],
        key(
            KeyType.RELATIVE_MOTIONS,
            "Relative motions that a general joint removes: x, y, z (displacements along the axes of the first "
            "marker) and rx, ry, rz (rotations about them).",
            optional=True,
            example='["x", "y", "rz"]',
        ),
    ] = ()
    distance: Annotated[
        Fraction | None,
        key(KeyType.POSITIVE, "Constant distance of the markers, m."),
    ] = None
    pitch: Annotated[
        Quantity | None,
        key(
            KeyType.NONZERO_QUANTITY,
            "Displacement along z for a whole turn of the second marker about z, m; negative for left-handed threads.",
            DEFAULT_LENGTH.unit,
            example="0.005",
        ),
    ] = None
    start: Annotated[
        SpatialJointInitialValues, key(SpatialJointInitialValues, "Initial values of the relative motion.")
    ] = NO_JOINT_START


@dataclass(frozen=True)
class Gear:
    """A constant ratio of the motions of two joints: motion of the second = ratio * motion of the first + offset."""

    # The motion of a joint is that of its second marker against its first: the rotation about z (revolute, screw,
    # cylindrical and planar joints), or the displacement along z (prismatic joints). The multiplier is the torque, or
    # the force, that the gear exerts in the second joint; in the first one it is -ratio times that.
    name: str
    joints: Annotated[
        tuple[str, str],
        key(KeyType.JOINT_PAIR, "The two joints whose motions it couples.", example='["sun", "planet"]'),
    ]
    ratio: Annotated[
        Quantity,
        key(
            KeyType.NONZERO_QUANTITY,
            "Motion of the second joint for a unit motion of the first: 1, or m/rad or rad/m. Of toothed wheels write "
            'a fraction, such as "-20/37".',
            example='"-20/37"',
        ),
    ]
    offset: Annotated[
        Quantity,
        key(KeyType.QUANTITY, "Motion of the second joint where that of the first is zero, rad or m."),
    ] = Fraction(0)


@dataclass(frozen=True)
class SpatialForce:
    """A force at a marker in space."""

    name: str
    at: Annotated[
        MarkerRef, key(KeyType.MARKER, 'Marker at which it acts, such as "rod.right".', example='"rod.right"')
    ]
    force: Annotated[
        tuple[TimeFunction, TimeFunction, TimeFunction],
        key(KeyType.FUNCTION_TRIPLE, "Components, N: numbers, or functions of t.", "N", example="[0, 0, -10]"),
    ]
    frame: Annotated[
        ForceFrame,
        key(
            KeyType.CHOICE,
            "The frame of the components: inertial, or body, the frame of the marker, with which the force turns.",
        ),
    ] = "inertial"
    kind: ClassVar[str] = "force"

    @property
    def markers(self) -> tuple[MarkerRef, ...]:
        """The marker at which the force acts."""
        return (self.at,)


@dataclass(frozen=True)
class SpatialTorque:
    """A torque at a marker in space, with a reaction at another one or without."""

    name: str
    on: Annotated[
        MarkerRef, key(KeyType.MARKER, 'Marker at which it acts, such as "crank.hub".', example='"crank.hub"')
    ]
    torque: Annotated[
        tuple[TimeFunction, TimeFunction, TimeFunction],
        key(KeyType.FUNCTION_TRIPLE, "Components, N m: numbers, or functions of t.", "N m", example="[0, 0, 1.5]"),
    ]
    against: Annotated[
        MarkerRef | None,
        key(KeyType.MARKER, "Marker at which the reaction acts; by default there is no reaction."),
    ] = None
    frame: Annotated[
        ForceFrame,
        key(
            KeyType.CHOICE,
            "The frame of the components: inertial, or body, the frame of the marker, with which the torque turns.",
        ),
    ] = "inertial"
    kind: ClassVar[str] = "torque"

    @property
    def markers(self) -> tuple[MarkerRef, ...]:
        """The marker at which the torque acts, and that of its reaction, if there is one."""
        return (self.on,) if self.against is None else (self.on, self.against)


@dataclass(frozen=True)
class SpatialSpring:
    """A spring or a bushing between two markers in space; `values` are those of the keys of its kind."""

    name: str
    kind: str
    first: Annotated[MarkerRef, BETWEEN]
    second: MarkerRef
    values: Mapping[str, object] = field(default_factory=dict, hash=False)

    @property
    def markers(self) -> tuple[MarkerRef, ...]:
        """The two markers between which it acts."""
        return (self.first, self.second)


@dataclass(frozen=True)
class SpatialJointForce:
    """A force in a joint: along z of its first marker on the second body, and its reaction on the first one."""

    name: str
    joint: Annotated[
        str, key(KeyType.JOINT, "Joint whose bodies may move along z of its first marker.", example='"guide"')
    ]
    value: Annotated[
        TimeFunction,
        key(KeyType.FUNCTION, "Force on the second body, N: a number, or a function of t.", "N", example="10"),
    ]
    kind: ClassVar[str] = "force"


@dataclass(frozen=True)
class SpatialJointTorque:
    """A torque in a joint: about z of its first marker on the second body, and its reaction on the first one."""

    name: str
    joint: Annotated[
        str, key(KeyType.JOINT, "Joint whose bodies may turn about z of its first marker.", example='"hinge"')
    ]
    value: Annotated[
        TimeFunction,
        key(KeyType.FUNCTION, "Torque on the second body, N m: a number, or a function of t.", "N m", example="1.5"),
    ]
    kind: ClassVar[str] = "torque"


SpatialJointLoad = SpatialJointForce | SpatialJointTorque
"""Loads along or about the axis of a joint."""
SpatialAction = SpatialForce | SpatialTorque | SpatialSpring | SpatialJointLoad
"""Actions at markers and in joints in space."""

_OF_SCENE = {key.field: key for key in declared_keys(Scene)}


@dataclass(frozen=True)
class SpatialScene:
    """Bodies in space with joints, drives, forces and gravity."""

    name: str
    ground: Annotated[tuple[FrameMarker, ...], FRAMES]
    gravity: Annotated[tuple[Quantity, Quantity, Quantity] | None, key(KeyType.ACCELERATION, GRAVITY, optional=True)]
    bodies: tuple[SpatialBody, ...]
    joints: Annotated[
        tuple[SpatialJoint, ...], key(SpatialJoint, "Joints by name.", example="[joints.pin]", default=())
    ]
    drives: Annotated[tuple[Drive, ...], _OF_SCENE["drives"]] = ()
    gears: Annotated[
        tuple[Gear, ...], key(Gear, "Ratios of the motions of two joints by name.", example="[gears.mesh]")
    ] = ()
    forces: Annotated[
        tuple[SpatialForce | SpatialJointForce, ...],
        key(SpatialForce, "Forces by name.", example="[forces.load]", default=()),
    ] = ()
    torques: Annotated[
        tuple[SpatialTorque | SpatialJointTorque, ...],
        key(SpatialTorque, "Torques by name.", example="[torques.load]", default=()),
    ] = ()
    springs: Annotated[
        tuple[SpatialSpring, ...],
        key(SpatialSpring, "Springs and bushings by name.", example="[springs.mount]", default=()),
    ] = ()
    simulation: Simulation | None = None
    plots: Annotated[tuple[Plot, ...], _OF_SCENE["plots"]] = ()
    start: Annotated[SceneStart | None, _OF_SCENE["start"]] = None
    redundant: Annotated[Redundant, _OF_SCENE["redundant"]] = "auto"
    inputs: Annotated[tuple[SceneInput, ...], _OF_SCENE["inputs"]] = ()
    outputs: Annotated[tuple[SceneOutput, ...], _OF_SCENE["outputs"]] = ()
    lowering: Annotated[SceneLowering, _OF_SCENE["lowering"]] = "auto"

    def joint_between(self, first: MarkerRef, second: MarkerRef) -> SpatialJoint | None:
        """The joint between two markers, in either order, if there is one."""
        return next((j for j in self.joints if (first, second) in ((j.first, j.second), (j.second, j.first))), None)

    def markers_of(self, action: SpatialAction) -> tuple[MarkerRef, ...]:
        """The markers at which an action acts: its own, or those of its joint."""
        if isinstance(action, SpatialJointLoad):
            (joint,) = (joint for joint in self.joints if joint.name == action.joint)
            return (joint.first, joint.second)
        return action.markers
