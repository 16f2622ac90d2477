"""The tables of initial values: of bodies, of joints and drives, and of a scene as a whole."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, PlainValidator, WithJsonSchema

from derive.spec.model.body import Polynomial
from derive.spec.model.scene import EQUILIBRIUM, JointInitialValues, SceneStart
from derive.spec.model.simulation import InitialValues
from derive.spec.parsing import choices
from derive.spec.tables.beam_shapes import Shape
from derive.spec.tables.markers import Float, FloatPair
from derive.spec.tables.shared import TomlTable, Truth

Guess = Annotated[
    Truth,
    Field(
        description="Whether these values are a first guess from which the mechanism is assembled; otherwise the "
        "initial state keeps them. A guessed deflection that the shapes do not have is replaced by the nearest one."
    ),
]


class StartTable(TomlTable):
    """Initial values of a body. The initial state keeps what is given; values that are not given adapt to it."""

    position: Annotated[
        FloatPair | None,
        Field(
            description="Position of the origin of a rigid body, or of the centre of the straight axis of a beam, m."
        ),
    ] = None
    angle: Annotated[Float | None, Field(description="Rotation angle, rad.")] = None
    velocity: Annotated[FloatPair | None, Field(description="Velocity of that point, m/s.")] = None
    spin: Annotated[Float | None, Field(description="Angular velocity, rad/s.")] = None
    guess: Guess = False

    def start(self) -> InitialValues:
        """The initial values that the table describes."""
        return InitialValues(self.position, self.angle, self.velocity, self.spin, guess=self.guess)


class BeamStartTable(StartTable):
    """Initial values of a beam. The initial state keeps what is given; values that are not given adapt to it."""

    deflection: Annotated[
        Shape | None,
        Field(
            description="Initial deflection from the straight axis, m: a polynomial in xi from -1 to 1 along the whole "
            "beam, a combination of 1, xi and the ansatz; by default the beam is straight if possible."
        ),
    ] = None
    deflection_rate: Annotated[
        Shape | None, Field(description="Time derivative of the deflection, m/s: a polynomial in xi.")
    ] = None

    def start(self) -> InitialValues:
        """The initial values that the table describes."""
        bent: dict[str, Polynomial | None] = {"deflection": self.deflection, "deflection_rate": self.deflection_rate}
        return InitialValues(self.position, self.angle, self.velocity, self.spin, **bent, guess=self.guess)


class JointStartTable(TomlTable):
    """Initial values of the relative motion of a joint, or of the joint of a drive: of body 2 relative to body 1."""

    angle: Annotated[Float | None, Field(description="Relative rotation of a revolute joint, rad.")] = None
    displacement: Annotated[
        Float | None, Field(description="Displacement of a translational joint along its axis, m.")
    ] = None
    speed: Annotated[Float | None, Field(description="Rate of that rotation or displacement, rad/s or m/s.")] = None
    guess: Guess = False

    def start(self) -> JointInitialValues:
        """The initial values that the table describes."""
        return JointInitialValues(self.angle, self.displacement, self.speed, self.guess)


BODY_START = Field(description="Initial values; those that are not given adapt to the others and to the joints.")
StartInput = Annotated[StartTable, BODY_START]
BeamStartInput = Annotated[BeamStartTable, BODY_START]
JointStartInput = Annotated[JointStartTable, Field(description="Initial values of the relative motion.")]


def _scene_start(value: object) -> SceneStart:
    return choices.choice(value, (EQUILIBRIUM,), "the start of a scene")


SceneStartInput = Annotated[
    SceneStart | None,
    PlainValidator(_scene_start),
    WithJsonSchema({"enum": [EQUILIBRIUM]}),
    Field(
        description='"equilibrium": the motion begins in the static equilibrium, computed with the loads and drives at '
        "t = 0; initial positions of bodies and joints are then its first guess."
    ),
]
