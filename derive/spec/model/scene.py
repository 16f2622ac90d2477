"""The contents of a scene as frozen data: planar bodies, joints, drives, forces, and what to simulate."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Annotated, ClassVar, Literal

from derive.display import html
from derive.short_text import record_text
from derive.spec.model.beam import PlanarBeam
from derive.spec.model.beam_parts import DEFAULT_LENGTH, DEFAULT_MASS, INERTIA_UNIT, Marker, Polynomial
from derive.spec.model.body import GRAVITY
from derive.spec.model.documentation import documented
from derive.spec.model.forces import BETWEEN, Bushing, CustomForce, Force, ForceFrame, Spring, Torque
from derive.spec.model.keys import KeyType, key
from derive.spec.model.markers import MarkerRef, PointMarker
from derive.spec.model.plots import Plot
from derive.spec.model.ports import SceneOutput
from derive.spec.model.quantity import UNIT, Quantity
from derive.spec.model.simulation import GUESS, NOT_GIVEN, InitialValues, Simulation
from derive.spec.model.spec_text import scene_text
from derive.spec.model.time_function import TimeFunction

NAMED = {
    "bodies": "body",
    "joints": "joint",
    "drives": "drive",
    "gears": "gear",
    "forces": "force",
    "torques": "torque",
    "springs": "spring",
    "plots": "plot",
    "inputs": "input",
    "outputs": "output",
}
"""The sections of a scene whose elements have names, with the noun for one element; gears are in space alone."""


@dataclass(frozen=True)
class SceneInput:
    """A run-time input of the generated code, which forces, torques and drives refer to by its name."""

    name: str
    unit: Annotated[str, UNIT] = ""
    function: Annotated[
        TimeFunction | None,
        key(KeyType.FUNCTION, "What the input is in simulations: a number, or a function of t.", name="value"),
    ] = None
    __repr__ = record_text


SceneStart = Literal["equilibrium", "steady"]
SceneLowering = Literal["auto", "flat", "instances"]
EQUILIBRIUM: SceneStart = "equilibrium"
"""The value of `start` for which the initial state of a scene is its static equilibrium."""
STEADY: SceneStart = "steady"
"""The value of `start` for which it is a steady motion with the initial velocities."""

Redundant = Literal["auto", "resolve", "error"]
"""The treatment of redundant joints."""


@documented
@dataclass(frozen=True)
class JointInitialValues:
    """Initial values of the relative motion of a joint, or of the joint of a drive: of body 2 relative to body 1.

    Examples:
        >>> import derive
        >>> bent = derive.JointInitialValues(angle=0.5, speed=2)
        >>> bent.coordinate
        0.5
    """

    angle: Annotated[float | None, key(KeyType.FLOAT, "Relative rotation of a revolute joint, rad.")] = None
    displacement: Annotated[
        float | None, key(KeyType.FLOAT, "Displacement of a translational joint along its axis, m.")
    ] = None
    speed: Annotated[float | None, key(KeyType.FLOAT, "Rate of that rotation or displacement, rad/s or m/s.")] = None
    guess: Annotated[bool, GUESS] = False
    __repr__ = record_text

    @property
    def coordinate(self) -> float | None:
        """The given angle or displacement."""
        return self.displacement if self.angle is None else self.angle


NOT_NEEDED = "not needed if the motion is prescribed: energies, powers and reactions then count what is not given as 0."
BODY_MASS = key(KeyType.POSITIVE_QUANTITY, f"Mass, kg; {NOT_NEEDED}", DEFAULT_MASS.unit)
POINTS = key(
    KeyType.POINTS,
    "Named points and their coordinates [x, y], m, in the frame of the body or the inertial frame.",
    default=(),
)
START = key(InitialValues, "Initial values; those that are not given adapt to the others and to the joints.")
JOINT_START = key(JointInitialValues, "Initial values of the relative motion.")


@documented
@dataclass(frozen=True)
class RigidBody:
    """A rigid body in the plane; it has none of the keys length, bending_stiffness, ansatz and frame.

    Attributes:
        name: the name of the body.

    Examples:
        >>> import derive
        >>> rod = derive.RigidBody("rod", mass=2, inertia="1/6", markers=[derive.PointMarker("top", 0, 0.5)])
        >>> derive.scene("free", bodies=[rod]).bodies[0].inertia
        Fraction(1, 6)
    """

    name: str
    mass: Annotated[Quantity | None, BODY_MASS] = None
    inertia: Annotated[
        Quantity | None,
        key(
            KeyType.POSITIVE_QUANTITY,
            f"Moment of inertia about the centre of mass, kg m^2; {NOT_NEEDED}",
            INERTIA_UNIT,
        ),
    ] = None
    centre: Annotated[
        tuple[Quantity, Quantity],
        key(KeyType.COORDINATES, "Position of the centre of mass in the frame of the body, m.", DEFAULT_LENGTH.unit),
    ] = (Fraction(0), Fraction(0))
    markers: Annotated[tuple[PointMarker, ...], POINTS] = ()
    start: Annotated[InitialValues, START] = NOT_GIVEN
    keep_coordinates: Annotated[
        bool,
        key(
            KeyType.TRUTH,
            "Whether the body keeps all three coordinates even if a joint or a drive could eliminate some; the "
            "multipliers are then the constraint reactions.",
        ),
    ] = False
    kind: ClassVar[str] = "rigid"
    __repr__ = record_text


@documented
@dataclass(frozen=True)
class DistributedLoad:
    """A force per length on a beam: polynomials in xi times a function of t.

    Attributes:
        name: the name of the load.

    Examples:
        >>> import derive
        >>> wind = {"force": [0, "-10*(1 - xi^2)"], "time": "sin(t)"}
        >>> scene = derive.scene("bar", bodies={"rod": {"length": 1, "frame": "mean", "loads": {"wind": wind}}})
        >>> scene.bodies[0].loads[0].force
        ((), (Fraction(-10, 1), Fraction(0, 1), Fraction(10, 1)))
    """

    name: str
    force: Annotated[
        tuple[Polynomial, Polynomial],
        key(
            KeyType.LOAD_PAIR,
            "Components, N/m: numbers, or polynomials in xi, which goes from -1 to 1 along the beam.",
            example='[0, "-10*(1 - xi^2)"]',
        ),
    ]
    time: Annotated[
        TimeFunction,
        key(
            KeyType.FUNCTION,
            "Factor of the load: a number, or a function of t.",
            default=TimeFunction("number", value=Fraction(1)),
            shown=1,
        ),
    ]
    frame: Annotated[
        ForceFrame,
        key(KeyType.CHOICE, "The frame of the components: inertial, or body, the floating frame of the beam."),
    ] = "inertial"
    __repr__ = record_text


@documented
@dataclass(frozen=True)
class BeamBody:
    """A beam in a scene: it has one of the keys length, bending_stiffness, ansatz and frame.

    Attributes:
        name: the name of the body.
        beam: the beam, as `planar_beam` makes it.

    Examples:
        >>> import derive
        >>> rod = derive.BeamBody("rod", derive.planar_beam("rod", frame="mean", length=2), pieces=2)
        >>> scene = derive.scene("bar", bodies=[rod])
        >>> derive.derive(scene).names
        ('rod_1', 'rod_2')
    """

    # The whole rod, before it is cut into pieces that are welded together; its gravity is None.
    name: str
    beam: PlanarBeam
    pieces: Annotated[
        int, key(KeyType.PIECE_COUNT, "Number of beams of equal length into which the rod is divided.")
    ] = 1
    start: Annotated[InitialValues, START] = NOT_GIVEN
    loads: Annotated[
        tuple[DistributedLoad, ...],
        key(DistributedLoad, "Distributed loads by name.", example="[bodies.rod.loads.wind]"),
    ] = ()
    kind: ClassVar[str] = "beam"
    __repr__ = record_text

    @property
    def markers(self) -> tuple[Marker, ...]:
        """The markers of the whole rod."""
        return self.beam.markers


@documented
@dataclass(frozen=True)
class CustomBody:
    """A body of a type that is registered from outside the package.

    Attributes:
        name: the name of the body.
        kind: its name in `BODIES`.
        values: those of the keys of the type.

    Examples:
        >>> import derive
        >>> derive.CustomBody("drop", "drop", {"radius": 0.1}).values
        {'radius': 0.1}
    """

    name: str
    kind: str
    values: Mapping[str, object] = field(default_factory=dict, hash=False)
    markers: Annotated[tuple[PointMarker, ...], POINTS] = ()
    start: Annotated[InitialValues, START] = NOT_GIVEN
    __repr__ = record_text


SceneBody = RigidBody | BeamBody | CustomBody


@documented
@dataclass(frozen=True)
class Joint:
    """A joint between two markers.

    Attributes:
        name: the name of the joint.
        kind: a name in `JOINTS`.
        second: the second marker.

    Examples:
        >>> import derive
        >>> hinge = derive.Joint("hinge", "revolute", derive.MarkerRef("ground", "o"), derive.MarkerRef("rod", "left"))
        >>> rod = {"length": 1, "frame": "mean", "markers": {"left": -1}}
        >>> derive.scene("swing", ground={"o": (0, 0)}, bodies={"rod": rod}, joints=[hinge]).joints[0].kind
        'revolute'
    """

    # Its kind and the keys angle and axis are those of the registry of joints. Its multipliers are the force and the
    # torque that it exerts on the second body.
    name: str
    kind: str
    first: Annotated[MarkerRef, BETWEEN]
    second: MarkerRef
    angle: Annotated[
        float,
        key(
            KeyType.FLOAT,
            "Constant rotation of body 2 relative to body 1, rad; not for revolute joints.",
            "rad",
            optional=True,
        ),
    ] = 0.0
    axis: Annotated[
        tuple[Fraction, Fraction],
        key(
            KeyType.DIRECTION,
            "Direction of the line of a translational joint in the frame of body 1.",
            optional=True,
        ),
    ] = (Fraction(1), Fraction(0))
    start: Annotated[JointInitialValues, JOINT_START] = JointInitialValues()
    __repr__ = record_text


@documented
@dataclass(frozen=True)
class CustomJoint(Joint):
    """A joint of a kind that is registered from outside the package; its kind is its name in `JOINTS`.

    Attributes:
        name: the name of the joint.
        kind: the kind of joint.
        second: the second marker.
        values: those of the keys of the kind.

    Examples:
        >>> import derive
        >>> first, second = derive.MarkerRef("ground", "o"), derive.MarkerRef("rod", "left")
        >>> derive.CustomJoint("slot", "slot", first, second, values={"length": 0.2}).values
        {'length': 0.2}
    """

    values: Mapping[str, object] = field(default_factory=dict, hash=False)
    __repr__ = record_text


@documented
@dataclass(frozen=True)
class Drive:
    """A joint whose motion is prescribed, by the motion itself or by its speed.

    Attributes:
        name: the name of the drive.

    Examples:
        >>> import derive
        >>> motor = derive.Drive("motor", "hinge", motion=None, speed=5)
        >>> wheel = {"mass": 1, "inertia": 1, "markers": {"o": (0, 0)}}
        >>> hinge = {"kind": "revolute", "between": ["ground.o", "wheel.o"]}
        >>> parts = {"bodies": {"wheel": wheel}, "joints": {"hinge": hinge}, "drives": [motor]}
        >>> derive.scene("turning", ground={"o": (0, 0)}, **parts).drives[0].constant_speed
        Fraction(5, 1)
    """

    name: str
    joint: Annotated[str, key(KeyType.JOINT, "The name of a revolute or translational joint.", example='"bearing"')]
    motion: Annotated[
        TimeFunction | None,
        key(
            KeyType.FUNCTION,
            'Angle, rad, or displacement, m, as a function of t, such as "0.1*sin(2*pi*t)".',
            optional=True,
        ),
    ]
    speed: Annotated[
        Quantity | TimeFunction | None,
        key(
            KeyType.SPEED,
            "Speed in place of a motion, rad/s or m/s: a number, a parameter, or a function of t, such as "
            '"150*step(t, 0, 0.3)", whose integral from t = 0 the motion is.',
        ),
    ] = None
    offset: Annotated[
        Fraction,
        key(KeyType.NUMBER, "Angle, rad, or displacement, m, at t = 0; only with a speed.", optional=True),
    ] = Fraction(0)
    start: Annotated[JointInitialValues, JOINT_START] = JointInitialValues()
    __repr__ = record_text

    @property
    def constant_speed(self) -> Quantity | None:
        """The speed if it is a number or a parameter; None for a function of t."""
        return None if isinstance(self.speed, TimeFunction) else self.speed


@documented
@dataclass(frozen=True)
class Scene:
    """Planar bodies with joints, drives, forces and gravity.

    Attributes:
        name: the name of the model.
        bodies: rigid bodies, beams and bodies of registered types.
        simulation: duration, output and tolerance of a simulation.

    Examples:
        >>> import derive
        >>> ball = derive.scene("ball", gravity=(0, -9.81), bodies={"ball": {"mass": 1, "inertia": 1}})
        >>> ball.gravity
        (Fraction(0, 1), Fraction(-981, 100))
    """

    name: str
    ground: Annotated[tuple[PointMarker, ...], POINTS]
    gravity: Annotated[tuple[Quantity, Quantity] | None, key(KeyType.PLANAR_ACCELERATION, GRAVITY, optional=True)]
    bodies: tuple[SceneBody, ...]
    joints: Annotated[tuple[Joint, ...], key(Joint, "Joints by name.", example="[joints.pin]", default=())]
    drives: Annotated[
        tuple[Drive, ...], key(Drive, "Prescribed motions of joints by name.", example="[drives.motor]")
    ] = ()
    forces: Annotated[tuple[Force | CustomForce, ...], key(Force, "Forces by name.", example="[forces.load]")] = ()
    torques: Annotated[tuple[Torque | CustomForce, ...], key(Torque, "Torques by name.", example="[torques.load]")] = ()
    springs: Annotated[
        tuple[Spring | Bushing | CustomForce, ...],
        key(Spring, "Springs and dampers by name.", example="[springs.mount]"),
    ] = ()
    simulation: Simulation | None = None
    plots: Annotated[tuple[Plot, ...], key(Plot, "Plots of a simulation by name.", example="[plots.deflection]")] = ()
    start: Annotated[
        SceneStart | None,
        key(
            KeyType.CHOICE,
            '"equilibrium": the motion begins in the static equilibrium, computed with the loads and drives at t = 0; '
            "initial positions of bodies and joints are then its first guess. "
            '"steady": it begins in a steady motion, at rest in axes that rotate at a constant speed or translate; '
            "initial velocities and drives determine which.",
            choice_of="the start of a scene",
        ),
    ] = None
    redundant: Annotated[
        Redundant,
        key(
            KeyType.CHOICE,
            "The treatment of redundant joints, whose motion is determined and whose reactions are not. auto: those of "
            "least norm are computed where joints are redundant; resolve: always, which takes longer, also through "
            "singular positions; error: redundant joints are refused.",
            choice_of="redundant joints",
        ),
    ] = "auto"
    inputs: Annotated[
        tuple[SceneInput, ...], key(SceneInput, "Run-time inputs by name.", example="[inputs.motor]")
    ] = ()
    outputs: Annotated[tuple[SceneOutput, ...], key(SceneOutput, "Outputs by name.", example="[outputs.tip]")] = ()
    lowering: Annotated[
        SceneLowering,
        key(
            KeyType.CHOICE,
            "Code of bodies and joints: flat (unrolled), instances (loops over all of a kind), or auto (the faster, as "
            "predicted).",
            default="auto",
            choice_of="the lowering of a scene",
        ),
    ] = "auto"
    _repr_html_ = html

    def __repr__(self) -> str:
        return scene_text(self, NAMED)
