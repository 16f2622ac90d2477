"""The settings of a simulation, and the initial values of planar bodies and of bodies in space."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Annotated

from derive.short_text import record_text
from derive.spec.model.documentation import documented
from derive.spec.model.keys import KeyType, key

GUESS = key(
    KeyType.TRUTH,
    "Whether these values are a first guess from which the mechanism is assembled; otherwise the initial state keeps "
    "them. A guessed deflection that the shapes do not have is replaced by the nearest one.",
)


@documented
@dataclass(frozen=True)
class Simulation:
    """Duration, output and accuracy of a simulation.

    Examples:
        >>> import derive
        >>> short = derive.Simulation(duration=1, output=0.25)
        >>> ball = derive.scene("ball", bodies={"ball": {"mass": 1, "inertia": 1}}, simulation=short)
        >>> derive.simulate(ball).t
        array([0.  , 0.25, 0.5 , 0.75, 1.  ])
    """

    duration: Annotated[float, key(KeyType.POSITIVE_FLOAT, "Duration, s.", example="1.0")]
    output: Annotated[float, key(KeyType.POSITIVE_FLOAT, "Time between rows of the output, s.", example="1e-3")]
    tolerance: Annotated[
        float,
        key(KeyType.TOLERANCE, "Tolerance of the integrator for the error of a step, relative and absolute."),
    ] = 1e-9
    until: Annotated[
        str | None,
        key(
            KeyType.CONDITION,
            'Condition on columns that ends the simulation before its duration, such as "rod_phi > pi/2" or '
            '"slider_s = 0.2".',
        ),
    ] = None
    __repr__ = record_text


@documented
@dataclass(frozen=True)
class InitialValues:
    """Initial values of a body in the plane. The initial state keeps what is given; other values adapt to it.

    Examples:
        >>> import derive
        >>> ball = derive.RigidBody("ball", mass=1, inertia=1, start=derive.InitialValues(velocity=(3, 4)))
        >>> derive.simulate(derive.scene("flight", bodies=[ball]), duration=1, output=1).q[-1]
        array([3., 4., 0.])
    """

    position: Annotated[
        tuple[float, float] | None,
        key(
            KeyType.FLOAT_PAIR,
            "Position of the origin of a rigid body, or of the centre of the straight axis of a beam, m.",
        ),
    ] = None
    angle: Annotated[float | None, key(KeyType.FLOAT, "Rotation angle, rad.")] = None
    velocity: Annotated[tuple[float, float] | None, key(KeyType.FLOAT_PAIR, "Velocity of that point, m/s.")] = None
    spin: Annotated[float | None, key(KeyType.FLOAT, "Angular velocity, rad/s.")] = None
    deflection: Annotated[
        tuple[Fraction, ...] | None,
        key(
            KeyType.DEFLECTION,
            "Initial deflection from the straight axis, m: a polynomial in xi from -1 to 1 along the whole beam, a "
            "combination of 1, xi and the ansatz; by default the beam is straight if possible.",
        ),
    ] = None
    deflection_rate: Annotated[
        tuple[Fraction, ...] | None,
        key(KeyType.DEFLECTION, "Time derivative of the deflection, m/s: a polynomial in xi."),
    ] = None
    guess: Annotated[bool, GUESS] = False
    __repr__ = record_text


OF_BEAMS = ("deflection", "deflection_rate")
"""The initial values that beams alone have."""

NOT_GIVEN = InitialValues()
"""The default of initial values: none are given."""


@documented
@dataclass(frozen=True)
class SpatialStart:
    """The initial state of a body in space that is simulated alone.

    Examples:
        >>> import derive
        >>> derive.SpatialStart(angular_velocity=(0, 0, 5)).quaternion
        (1.0, 0.0, 0.0, 0.0)
    """

    position: Annotated[
        tuple[float, ...], key(KeyType.TRIPLE, "Position of the origin of the floating frame in the inertial frame, m.")
    ] = (0.0, 0.0, 0.0)
    quaternion: Annotated[
        tuple[float, ...],
        key(
            KeyType.ROTATION,
            "Rotation of the floating frame: a unit quaternion, scalar first, or an axis and an angle.",
            name="rotation",
            shown=(1, 0, 0, 0),
        ),
    ] = (1.0, 0.0, 0.0, 0.0)
    velocity: Annotated[
        tuple[float, ...], key(KeyType.TRIPLE, "Velocity of the origin in the inertial frame, m/s.")
    ] = (0.0, 0.0, 0.0)
    angular_velocity: Annotated[
        tuple[float, ...], key(KeyType.TRIPLE, "Angular velocity in the floating frame, rad/s.")
    ] = (0.0, 0.0, 0.0)
    amplitudes: Annotated[
        tuple[float, ...],
        key(KeyType.AMPLITUDES, "Amplitudes of the first modes, m; those of the others are zero."),
    ] = ()
    amplitude_rates: Annotated[
        tuple[float, ...],
        key(KeyType.AMPLITUDES, "Rates of the amplitudes of the first modes, m/s; the others are zero."),
    ] = ()
    __repr__ = record_text


AT_REST = SpatialStart()
"""The default initial state: at the origin, not rotated, at rest, not deformed."""
