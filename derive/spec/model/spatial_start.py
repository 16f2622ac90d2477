"""The initial values of bodies in space as frozen data: positions and rotations, and the curves of beams."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from derive.short_text import record_text
from derive.spec.model.beam_parts import Polynomial
from derive.spec.model.documentation import documented
from derive.spec.model.keys import KeyType, key
from derive.spec.model.simulation import GUESS

Triple = tuple[float, float, float]
UnitQuaternion = tuple[float, float, float, float]
Deflections = tuple[Polynomial, Polynomial]
"""Two polynomials in xi, along e2 and e3 of a beam."""
NO_ROTATION: UnitQuaternion = (1.0, 0.0, 0.0, 0.0)

ROTATION_FORMS = (
    "a unit quaternion, scalar first; { axis = [..], angle = a }; two axes of the frame { x = [..], y = [..] }; or "
    '{ angles = [a, b, c], sequence = "xyz" } about the axes of the turning frame'
)
"""The notations of a rotation, for descriptions."""


@documented
@dataclass(frozen=True)
class SpatialInitialValues:
    """Initial values of a body in space. The initial state keeps what is given; values not given adapt to it.

    Examples:
        >>> import derive
        >>> spun = derive.SpatialInitialValues(angular_velocity=(0, 0, 5))
        >>> top = derive.SpatialRigidBody("top", mass=1, inertia=(1, 1, 2, 0, 0, 0), start=spun)
        >>> derive.simulate(derive.spatial_scene("spinner", bodies=[top]), duration=1, output=1).v[-1]
        array([0., 0., 0., 0., 0., 5.])
    """

    position: Annotated[
        Triple | None,
        key(
            KeyType.TRIPLE,
            "Position of the origin of the body frame in the inertial frame, or of the centre of the straight axis of "
            "a beam, m.",
        ),
    ] = None
    rotation: Annotated[
        UnitQuaternion | None,
        key(KeyType.ROTATION, f"Rotation of the body frame, or of the straight beam: {ROTATION_FORMS}."),
    ] = None
    velocity: Annotated[Triple | None, key(KeyType.TRIPLE, "Velocity of that point in the inertial frame, m/s.")] = None
    angular_velocity: Annotated[Triple | None, key(KeyType.TRIPLE, "Angular velocity in that frame, rad/s.")] = None
    deflection: Annotated[
        Deflections | None,
        key(
            KeyType.DEFLECTIONS,
            "Initial deflections from the straight axis along e2 and e3, m: polynomials in xi from -1 to 1 along the "
            "whole beam, each a combination of 1, xi and the ansatz of its direction; by default the beam is straight "
            "if possible.",
            example='["0.01*(1 - xi^2)", 0]',
        ),
    ] = None
    deflection_rate: Annotated[
        Deflections | None,
        key(KeyType.DEFLECTIONS, "Time derivatives of the deflections, m/s: polynomials in xi.", example='[0, "xi^2"]'),
    ] = None
    twist: Annotated[
        Polynomial | None,
        key(
            KeyType.DEFLECTION,
            "Initial rotation of the sections about the axis, rad: a polynomial in xi, a combination of 1 and the "
            "ansatz of torsion; by default the beam is not twisted if possible.",
            example='"0.1*xi"',
        ),
    ] = None
    twist_rate: Annotated[
        Polynomial | None,
        key(KeyType.DEFLECTION, "Time derivative of the twist, rad/s: a polynomial in xi.", example='"xi"'),
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
    __repr__ = record_text


CURVES, CURVE_RATES = ("deflection", "twist"), ("deflection_rate", "twist_rate")
OF_BENT_BEAMS = (*CURVES, *CURVE_RATES)
"""The initial values that beams in space alone have: polynomials along the beam, and their rates."""
SPATIAL_START = key(
    SpatialInitialValues, "Initial values; those that are not given adapt to the others and to the joints."
)


NOT_GIVEN_IN_SPACE = SpatialInitialValues()
