"""A scene in space as frozen data: its joints, gears and sections."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Annotated, Literal

from derive.display import html
from derive.short_text import record_text
from derive.spec.model.beam_parts import DEFAULT_LENGTH
from derive.spec.model.body import GRAVITY
from derive.spec.model.documentation import documented
from derive.spec.model.forces import BETWEEN
from derive.spec.model.joints import Drive, JointInitialValues
from derive.spec.model.keys import KeyType, declared_keys, key
from derive.spec.model.markers import MarkerRef
from derive.spec.model.plots import Plot
from derive.spec.model.ports import SceneOutput
from derive.spec.model.quantity import Quantity
from derive.spec.model.scene import NAMED, Redundant, Scene, SceneInput, SceneLowering, SceneStart
from derive.spec.model.simulation import Simulation
from derive.spec.model.spatial_beam import SpatialBody
from derive.spec.model.spatial_bodies import FRAMES, FrameMarker
from derive.spec.model.spatial_forces import (
    SpatialAction,
    SpatialForce,
    SpatialJointForce,
    SpatialJointLoad,
    SpatialJointTorque,
    SpatialSpring,
    SpatialTorque,
)
from derive.spec.model.spec_text import scene_text
from derive.spec.model.visuals import Visual, visuals_key


@documented
@dataclass(frozen=True)
class SpatialJointInitialValues(JointInitialValues):
    """Initial values of the relative motion of a joint in space: of body 2 relative to body 1.

    Examples:
        >>> import derive
        >>> derive.SpatialJointInitialValues(angle=0.5, angle_rate=2).angle
        0.5
    """

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
    __repr__ = record_text


NO_JOINT_START = SpatialJointInitialValues()


@documented
@dataclass(frozen=True)
class SpatialJoint:
    """A joint between two marker frames.

    Attributes:
        name: the name of the joint.
        kind: a name in `SPATIAL_JOINTS`.
        second: the second marker.

    Examples:
        >>> import derive
        >>> first, second = derive.MarkerRef("ground", "o"), derive.MarkerRef("wheel", "o")
        >>> hinge = derive.SpatialJoint("hinge", "revolute", first, second)
        >>> wheel = {"mass": 1, "inertia": [1, 1, 2, 0, 0, 0], "markers": {"o": (0, 0, 0)}}
        >>> scene = derive.spatial_scene("hub", ground={"o": (0, 0, 0)}, bodies={"wheel": wheel}, joints=[hinge])
        >>> derive.modes(scene).linear.states
        ('wheel_phi', 'wheel_phidot')
    """

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
    limits: Annotated[
        tuple[float, float] | None,
        key(
            KeyType.FLOAT_PAIR,
            "Least and largest motion of a revolute, screw or prismatic joint, rad or m. Nothing enforces them; a "
            "simulation notes where a joint passes them.",
            example="[-1.5, 2]",
        ),
    ] = None
    closes_loop: Annotated[
        bool,
        key(
            KeyType.TRUTH,
            "Whether the joint is a constraint in any case: in a loop of joints it is the one that closes the loop.",
        ),
    ] = False
    start: Annotated[
        SpatialJointInitialValues, key(SpatialJointInitialValues, "Initial values of the relative motion.")
    ] = NO_JOINT_START
    __repr__ = record_text


@documented
@dataclass(frozen=True)
class Gear:
    """A constant ratio of the motions of two joints: motion of the second = ratio * motion of the first + offset.

    Attributes:
        name: the name of the gear.

    Examples:
        >>> import derive
        >>> derive.Gear("mesh", ("sun", "planet"), ratio="-20/37").joints
        ('sun', 'planet')
    """

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
    __repr__ = record_text


Coordinates = Literal["auto", "relative", "absolute"]

_OF_SCENE = {key.field: key for key in declared_keys(Scene)}


@documented
@dataclass(frozen=True)
class SpatialScene:
    """Bodies in space with joints, drives, forces and gravity.

    Attributes:
        name: the name of the model.
        bodies: rigid and finite-element bodies.
        simulation: duration, output and tolerance of a simulation.

    Examples:
        >>> import derive
        >>> scene = derive.spatial_scene(
        ...     "hub",
        ...     ground={"o": (0, 0, 0)},
        ...     bodies={"wheel": {"mass": 1, "inertia": [1, 1, 2, 0, 0, 0], "markers": {"o": (0, 0, 0)}}},
        ...     joints={"hinge": {"kind": "revolute", "between": ["ground.o", "wheel.o"]}},
        ...     torques={"motor": {"joint": "hinge", "value": 3}},
        ... )
        >>> [body.name for body in scene.bodies]
        ['wheel']
    """

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
    ground_visuals: Annotated[
        tuple[Visual, ...],
        visuals_key("What pictures and the player show of the ground: boxes, cylinders, spheres and meshes."),
    ] = ()
    start: Annotated[SceneStart | None, _OF_SCENE["start"]] = None
    redundant: Annotated[Redundant, _OF_SCENE["redundant"]] = "auto"
    inputs: Annotated[tuple[SceneInput, ...], _OF_SCENE["inputs"]] = ()
    outputs: Annotated[tuple[SceneOutput, ...], _OF_SCENE["outputs"]] = ()
    lowering: Annotated[SceneLowering, _OF_SCENE["lowering"]] = "auto"
    coordinates: Annotated[
        Coordinates,
        key(
            KeyType.CHOICE,
            "Coordinates of rigid bodies that joints connect to bodies that move: relative (those of the joints; only "
            "joints that close loops are constraints), absolute (position and quaternion; all joints are constraints), "
            "or auto (relative, but absolute for loops over instances and for trees of very many bodies).",
            default="auto",
            choice_of="the choice of coordinates",
        ),
    ] = "auto"
    _repr_html_ = html

    def joint_between(self, first: MarkerRef, second: MarkerRef) -> SpatialJoint | None:
        """The joint between the markers `first` and `second`, in either order; None if there is none.

        Examples:
            >>> scene.joint_between(derive.MarkerRef("wheel", "o"), derive.MarkerRef("ground", "o")).name
            'hinge'
        """
        return next((j for j in self.joints if (first, second) in ((j.first, j.second), (j.second, j.first))), None)

    def markers_of(self, action: SpatialAction) -> tuple[MarkerRef, ...]:
        """The markers at which an `action`, such as a force, acts: its own, or those of its joint.

        Examples:
            >>> [marker.body for marker in scene.markers_of(scene.torques[0])]
            ['ground', 'wheel']
        """
        if isinstance(action, SpatialJointLoad):
            (joint,) = (joint for joint in self.joints if joint.name == action.joint)
            return (joint.first, joint.second)
        return action.markers

    def __repr__(self) -> str:
        return scene_text(self, NAMED)
