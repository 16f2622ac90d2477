"""Outputs of markers in space: their motion as an observer in a frame measures it, angles, and deformation.

With d the vector from the origin of the frame, A its axes, w its angular velocity and u = v - v0 - w x d, the
components in the frame are

    s = A^T d,    sdot = A^T u,    sddot = A^T (a - a0 - wdot x d - w x (w x d) - 2 w x u)

and those of the relative angular velocity A^T (w2 - w) and A^T (w2dot - wdot - w x (w2 - w)).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING, Any, TypeAlias

from derive.algebra import sp
from derive.mechanics.axes import AXES
from derive.mechanics.motion.vectors import cross, dot, length_of
from derive.mechanics.multibody.outputs.deflection import CHORD, DIVIDED_BY, deflection_doc
from derive.mechanics.multibody.space.output_parts import SpatialComponent, SpatialOutputType, SpatialParts
from derive.spec.model.keys import Key, KeyType
from derive.spec.model.markers import MarkerRef

if TYPE_CHECKING:
    from derive.mechanics.multibody.space.frame_motion import FrameMotion

LABELS = tuple(map(str, AXES))
MARKER = Key("marker", KeyType.MARKER, "", 'The marker, such as "rod.right".', required=True)
BETWEEN_MARKERS = Key("between", KeyType.MARKER_PAIR, "", "Two markers.", required=True)
FRAME = Key(
    "frame",
    KeyType.MARKER,
    "",
    "Marker whose frame is the frame of reference, an observer who moves and turns with it; forces and torques are "
    "given along its axes. By default it is the inertial frame.",
)
AXIS = Key("axis", KeyType.CHOICE, "", "Axis of the frame: x, y or z.", default="x", choices=("x", "y", "z"))
OF_CHORD = replace(
    CHORD,
    description='Markers at the beginning and the end of a chord, such as ["rod.left", "rod.right"]: the deflection is '
    "the vector to the marker from the nearest point of the line through them, along the axes of the floating frame of "
    "its body. By default it is the displacement by deformation.",
    required=False,
)
Observed: TypeAlias = "Callable[[FrameMotion, FrameMotion], sp.Matrix]"
"""A vector of a marker as the frame of reference observes it, along the axes of that frame."""


@cache
def inertial() -> FrameMotion:
    """The inertial frame."""
    from derive.mechanics.multibody.space.frame_motion import fixed_frame

    return fixed_frame(sp.zeros(3, 1), sp.eye(3))


def _length(vector: Sequence[sp.Expr]) -> sp.Expr:
    """The length of a vector; less than the square of any keeps it, and its derivative, away from 0/0."""
    return sp.sqrt(dot(vector, vector) + sp.Rational(1, 10**100))


def observer(values: Mapping[str, Any], parts: SpatialParts) -> tuple[FrameMotion, str]:
    """The frame of reference of an output, and its name."""
    marker: MarkerRef | None = values.get(FRAME.name)
    return (inertial(), "the inertial frame") if marker is None else (parts.at(marker), str(marker))


def along(frame: FrameMotion, vector: sp.Matrix) -> sp.Matrix:
    """The components of an inertial vector along the axes of a frame."""
    return vector if frame is inertial() else frame.axes.T * vector


def _velocity(frame: FrameMotion, at: FrameMotion) -> sp.Matrix:
    """The velocity of a marker against a frame that moves and turns, in inertial components."""
    arm = at.position - frame.position
    return at.velocity - frame.velocity - cross(frame.angular_velocity, arm)


def _acceleration(frame: FrameMotion, at: FrameMotion) -> sp.Matrix:
    """The acceleration of a marker as a frame observes it, in inertial components."""
    w, arm = frame.angular_velocity, at.position - frame.position
    transport = cross(frame.angular_acceleration, arm) + cross(w, cross(w, arm))
    return at.acceleration - frame.acceleration - transport - 2 * cross(w, _velocity(frame, at))


def _angular_acceleration(frame: FrameMotion, at: FrameMotion) -> sp.Matrix:
    """The rate of the relative angular velocity as a frame observes it, in inertial components."""
    w = frame.angular_velocity
    return at.angular_acceleration - frame.angular_acceleration - cross(w, at.angular_velocity - w)


def _vector(text: str, unit: str, observed: Observed, turns: bool = False) -> SpatialOutputType:
    """The type of an output of a vector of a marker; turns: whether it is one of its rotation against the frame."""

    def components(values: Mapping[str, Any], parts: SpatialParts) -> tuple[SpatialComponent, ...]:
        frame, name = observer(values, parts)
        vector = along(frame, observed(frame, parts.at(values["marker"])))
        relative = f" against {name}" if turns and FRAME.name in values else ""
        doc = f"{text} of {values['marker']}{relative} along e{{}} of {name}"
        return tuple(SpatialComponent(str(k), unit, doc.format(k), vector[k - 1]) for k in AXES)

    return SpatialOutputType(f"{text} of a marker", (MARKER, FRAME), LABELS, components)


# ---- rotations and angles


def rotation_vector(R: sp.Matrix) -> sp.Matrix:
    """The rotation vector of a rotation matrix, whose length is the angle from 0 to pi.

    Each row of 4 e e^T is a multiple of the quaternion e and a polynomial in R without squares; that of the largest
    component does not vanish, so that no rotation is singular. At half a turn the vector changes its sign.
    """
    from derive.mechanics.time_functions import Atan2, select

    trace = R[0, 0] + R[1, 1] + R[2, 2]
    axial = [R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]]
    rows = [[1 + trace, *axial]]
    for i in range(3):
        of_axes = [1 + 2 * R[i, i] - trace if i == j else R[i, j] + R[j, i] for j in range(3)]
        rows.append([axial[i], *of_axes])
    largest, e = rows[0][0], rows[0]
    for i, row in enumerate(rows[1:], 1):
        e = [select(largest, row[i], own, other) for other, own in zip(e, row, strict=True)]
        largest = select(largest, row[i], row[i], largest)
    scalar, *vector = e
    length = _length(vector)
    half = Atan2(length, select(scalar, sp.S.Zero, -scalar, scalar))
    factor = 2 * half / length
    return sp.Matrix([select(scalar, sp.S.Zero, -factor * x, factor * x) for x in vector])


def _rotation(values: Mapping[str, Any], parts: SpatialParts) -> tuple[SpatialComponent, ...]:
    """The rotation vector of a marker against the frame, whose components along the axes of both are the same."""
    frame, name = observer(values, parts)
    vector = rotation_vector(sp.Matrix(along(frame, parts.at(values["marker"]).axes)))
    doc = f"rotation vector of {values['marker']} against {name} along e{{}} of both, of a length up to pi"
    return tuple(SpatialComponent(str(k), "rad", doc.format(k), vector[k - 1]) for k in AXES)


def _angle(values: Mapping[str, Any], parts: SpatialParts) -> tuple[SpatialComponent, ...]:
    """The angle between a line and an axis of the frame."""
    from derive.mechanics.time_functions import Atan2

    frame, name = observer(values, parts)
    first, second = (parts.at(marker) for marker in values["between"])
    line = along(frame, second.position - first.position)
    axis = values[AXIS.name]
    k = AXIS.choices.index(axis)
    across = [x for i, x in enumerate(line) if i != k]
    angle = Atan2(_length(across), line[k])
    markers = " to ".join(map(str, values["between"]))
    doc = f"angle between the line from {markers} and {axis} of {name}, from 0 to pi"
    return (SpatialComponent("", "rad", doc, angle),)


def _distance(values: Mapping[str, Any], parts: SpatialParts) -> tuple[SpatialComponent, ...]:
    first, second = (parts.at(marker) for marker in values["between"])
    d = second.position - first.position
    text = f"distance between {values['between'][0]} and {values['between'][1]}"
    return (SpatialComponent("", "m", text, length_of(d)),)


def _deflection(values: Mapping[str, Any], parts: SpatialParts) -> tuple[SpatialComponent, ...]:
    """The deflection of a marker along the axes of the floating frame of its body.

    It is the displacement u by the deformation of the body or, with a chord along e, the part d - e (e . d) of the
    vector d from the beginning of the chord to the marker.
    """
    marker, chord, divisor = values["marker"], values.get(OF_CHORD.name), values.get(DIVIDED_BY.name)
    at, length = parts.at(marker), None if divisor is None else float(divisor)
    if chord is None:
        vector = sp.Matrix(at.displacement)
        text = f"displacement of {marker} by deformation" + ("" if length is None else f", divided by {length:g} m")
    else:
        start, end = (sp.Matrix(parts.at(of).position) for of in chord)
        line, arm = end - start, sp.Matrix(at.position) - start
        vector = sp.Matrix(at.frame).T * (arm - line * (dot(line, arm) / dot(line, line)))
        text = deflection_doc(marker, chord, length)
    unit = "m" if divisor is None else ""
    scaled = vector / (1 if divisor is None else sp.Rational(divisor))
    doc = f"{text}, along e{{}} of the floating frame"
    return tuple(SpatialComponent(str(k), unit, doc.format(k), scaled[k - 1]) for k in AXES)


def _stress(values: Mapping[str, Any], parts: SpatialParts) -> tuple[SpatialComponent, ...]:
    """The components of the stress at a marker along the axes of the body, and that of von Mises."""
    marker = values["marker"]
    xx, yy, zz, xy, yz, xz = stress = parts.at(marker).stress
    normal = (xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2
    shear = xy**2 + yz**2 + xz**2
    mises = sp.sqrt(normal / 2 + 3 * shear + sp.Rational(1, 10**100))  # as in `_length`
    components = zip(STRESSES, (*stress, mises), strict=True)
    doc = f"of {marker} in the axes of its body"
    return tuple(
        SpatialComponent(label, "Pa", f"stress {label} {doc}" if label != MISES else f"von Mises stress of {marker}", x)
        for label, x in components
    )


MISES = "mises"
STRESSES = ("xx", "yy", "zz", "xy", "yz", "xz", MISES)
ANGLE, DEFLECTION, STRESS = "angle", "deflection", "stress"
MARKER_OUTPUTS: Mapping[str, SpatialOutputType] = {
    "position": _vector("position", "m", lambda frame, at: at.position - frame.position),
    "velocity": _vector("velocity", "m/s", _velocity),
    "acceleration": _vector("acceleration", "m/s^2", _acceleration),
    "rotation": SpatialOutputType(
        "rotation vector of a marker against the frame: its axis times its angle from 0 to pi, without whole turns",
        (MARKER, FRAME),
        LABELS,
        _rotation,
    ),
    "angular_velocity": _vector(
        "angular velocity", "rad/s", lambda frame, at: at.angular_velocity - frame.angular_velocity, True
    ),
    "angular_acceleration": _vector("angular acceleration", "rad/s^2", _angular_acceleration, True),
    "distance": SpatialOutputType("distance of two markers", (BETWEEN_MARKERS,), ("",), _distance),
    ANGLE: SpatialOutputType(
        "angle between the line from one marker to another and an axis of the frame, from 0 to pi",
        (BETWEEN_MARKERS, AXIS, FRAME),
        ("",),
        _angle,
    ),
    DEFLECTION: SpatialOutputType(
        "displacement of a marker by deformation, against the undeformed body in its floating frame; or its distance "
        "from a chord, as a vector",
        (MARKER, OF_CHORD, replace(DIVIDED_BY, type=KeyType.POSITIVE)),
        LABELS,
        _deflection,
    ),
    STRESS: SpatialOutputType(
        "stress at a marker of a body with elements and materials, in the axes of the body, and that of von Mises: at "
        "its node, or of the mean over a set of nodes",
        (MARKER,),
        STRESSES,
        _stress,
        of_numbers=True,
    ),
}
"""The kinds of outputs of markers."""
