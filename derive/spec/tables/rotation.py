"""The notations of a rotation in space: a unit quaternion, an axis and an angle, axes of the frame, or three angles."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Annotated, Any

from pydantic import AfterValidator, Field, PlainValidator, WithJsonSchema

from derive.spec.parsing import choices, values
from derive.spec.tables.shared import Example, TomlTable, components, number_schema, one_of

UNIT_LENGTH = 1e-3
"""The largest departure of the length of a quaternion from 1 that counts as rounding; the quaternion is normalised."""
ORTHOGONAL = 1e-6
"""The largest cosine of the angle between axes of a frame that counts as rounding."""

SEQUENCES = ("xyz", "xzy", "yzx", "yxz", "zxy", "zyx", "xyx", "xzx", "yzy", "yxy", "zxz", "zyz")
"""The axes of three successive rotations: six sequences of Cardan angles, and six of Euler angles."""

Quadruple = tuple[float, ...]
Vector = tuple[float, ...]


def _unit_quaternion(value: tuple[float, ...]) -> tuple[float, ...]:
    length = math.hypot(*value)
    if not abs(length - 1.0) <= UNIT_LENGTH:
        raise values.WrongValueError(
            f"a unit quaternion is needed, and the length of this one is {length:.6g}; divide it by that, or write "
            "{ axis = [0, 0, 1], angle = 0.5 }"
            if length
            else "this quaternion has the length 0, which is no rotation; [1, 0, 0, 0] is none, or write "
            "{ axis = [0, 0, 1], angle = 0.5 }"
        )
    return value


def _direction(value: tuple[float, ...]) -> tuple[float, ...]:
    if not any(value):
        raise values.WrongValueError("[0, 0, 0] is no direction; write one such as [0, 0, 1]")
    return value


Float = Annotated[float, PlainValidator(values.any_float), WithJsonSchema(number_schema())]
Triple = Annotated[tuple[Float, Float, Float], components(("0", "0", "1"), "numbers")]
Direction = Annotated[Triple, AfterValidator(_direction)]
Quaternion = Annotated[
    tuple[Float, Float, Float, Float], components(("1", "0", "0", "0"), "numbers"), AfterValidator(_unit_quaternion)
]
Sequence3 = Annotated[
    str,
    PlainValidator(lambda value: choices.choice(value, SEQUENCES, "the sequence of angles")),
    WithJsonSchema({"enum": [*SEQUENCES]}),
]


class RotationTable(TomlTable):
    """A rotation by an angle about an axis."""

    axis: Annotated[
        Direction, Field(description="Direction of the axis, of any length but zero."), Example("axis = [0, 0, 1]")
    ]
    angle: Annotated[Float, Field(description="Rotation angle, rad."), Example("angle = 0.5")]

    def quaternion(self) -> Quadruple:
        """The unit quaternion, scalar first."""
        return _about(self.axis, self.angle)


class AxesTable(TomlTable):
    """A rotation given by the directions of axes of the rotated frame in the other one."""

    x: Annotated[Direction | None, Field(description="Direction of the x axis of the frame.")] = None
    y: Annotated[Direction | None, Field(description="Direction of the y axis of the frame.")] = None
    z: Annotated[Direction | None, Field(description="Direction of the z axis of the frame.")] = None

    def quaternion(self) -> Quadruple:
        """The unit quaternion of the right-handed frame. Raises WrongValueError where the axes make none."""
        given = {name: _unit(axis) for name in "xyz" if (axis := getattr(self, name)) is not None}
        if len(given) < 2:
            raise values.WrongValueError("two axes of the frame are needed, such as { x = [1, 0, 0], y = [0, 1, 0] }")
        for first, second in (("x", "y"), ("y", "z"), ("x", "z")):
            if first in given and second in given:
                cosine = sum(a * b for a, b in zip(given[first], given[second], strict=True))
                if not abs(cosine) <= ORTHOGONAL:
                    angle = math.degrees(math.acos(max(-1.0, min(1.0, cosine))))
                    raise values.WrongValueError(
                        f"the axes {first} and {second} are at {angle:.6g} degrees; axes of a frame are orthogonal"
                    )
        x, y, z = (given.get(name) for name in "xyz")
        if x and y and z and _dot(_cross(x, y), z) < 0:
            text = "these axes are left-handed: x cross y has the direction opposite to z; reverse one"
            raise values.WrongValueError(text)
        if x and y:
            z = _unit(_cross(x, y))
        elif y and z:
            x = _unit(_cross(y, z))
        assert z
        if x is None:
            assert y
            x = _unit(_cross(y, z))
        y = _cross(z, x)
        return quaternion_of_axes(x, y, z)


class AnglesTable(TomlTable):
    """Three successive rotations about axes of the turning frame: Cardan or Euler angles."""

    angles: Annotated[Triple, Field(description="The three angles, rad."), Example("angles = [0.1, 0.2, 0]")]
    sequence: Annotated[
        Sequence3,
        Field(description="The axes of the turning frame: of xyz, Q = Q_x(a) Q_y(b) Q_z(c)."),
        Example('sequence = "xyz"'),
    ]

    def quaternion(self) -> Quadruple:
        """The unit quaternion, scalar first."""
        axes = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
        result: Quadruple = (1.0, 0.0, 0.0, 0.0)
        for name, angle in zip(self.sequence, self.angles, strict=True):
            result = _product(result, _about(axes[name], angle))
        return result


def _about(axis: Sequence[float], angle: float) -> Quadruple:
    length, half = math.hypot(*axis), angle / 2
    return (math.cos(half), *(math.sin(half) * x / length for x in axis))


def _product(p: Quadruple, q: Quadruple) -> Quadruple:
    u, v = p[1:], q[1:]
    w = _cross(u, v)
    return (p[0] * q[0] - _dot(u, v), *(p[0] * v[k] + q[0] * u[k] + w[k] for k in range(3)))


def _cross(a: Sequence[float], b: Sequence[float]) -> Vector:
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def _dot(a: Sequence[float], b: Sequence[float]) -> float:
    return sum(x * y for x, y in zip(a, b, strict=True))


def _unit(v: Sequence[float]) -> Vector:
    length = math.hypot(*v)
    return tuple(x / length for x in v)


def quaternion_of_axes(x: Vector, y: Vector, z: Vector) -> Quadruple:
    """The unit quaternion of a frame with these axes, by the largest of its components."""
    Q = [[x[k], y[k], z[k]] for k in range(3)]
    trace = Q[0][0] + Q[1][1] + Q[2][2]
    squares = (1 + trace, *(1 + 2 * Q[k][k] - trace for k in range(3)))
    largest = max(range(4), key=lambda n: squares[n])
    value = math.sqrt(squares[largest]) / 2
    odd = (Q[2][1] - Q[1][2], Q[0][2] - Q[2][0], Q[1][0] - Q[0][1])
    if largest == 0:
        result = [value, *(part / (4 * value) for part in odd)]
    else:
        i = largest - 1
        result = [odd[i] / (4 * value), 0.0, 0.0, 0.0]
        for j in range(3):
            result[j + 1] = value if i == j else (Q[i][j] + Q[j][i]) / (4 * value)
    sign = -1.0 if result[0] < 0 else 1.0
    return tuple(sign * part + 0.0 for part in result)


def _notation(value: Any) -> str:
    if not isinstance(value, Mapping):
        return "quaternion"
    if "angles" in value or "sequence" in value:
        return "angles"
    return "axes" if any(name in value for name in "xyz") else "turn"


Rotation = one_of(
    _notation,
    quaternion=Quaternion,
    turn=Annotated[RotationTable, AfterValidator(RotationTable.quaternion)],
    axes=Annotated[AxesTable, AfterValidator(AxesTable.quaternion)],
    angles=Annotated[AnglesTable, AfterValidator(AnglesTable.quaternion)],
)
