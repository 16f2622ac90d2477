"""Shapes of a rigid body in space for pictures and the player; equations do not contain them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Annotated

from derive.short_text import record_text
from derive.spec.model.documentation import documented
from derive.spec.model.keys import Key, KeyType, key
from derive.spec.model.spatial_start import NO_ROTATION, ROTATION_FORMS, UnitQuaternion

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

NO_SCALE = (1.0, 1.0, 1.0)


@dataclass(frozen=True)
class Mesh:
    """The triangles (m, 3) of a file, by numbers of their points (n, 3); meshes of the same bytes are equal.

    count: the number of triangles in the file, of which there may be fewer here.
    """

    file: str
    sha256: str
    count: int
    points: NDArray[np.float64] = field(compare=False)
    triangles: NDArray[np.int64] = field(compare=False)

    def __repr__(self) -> str:
        return f"Mesh({self.file!r}, {self.count} triangles)"


@documented
@dataclass(frozen=True)
class Visual:
    """A box, a cylinder, a sphere or a mesh that pictures and the player show of a rigid body or of the ground.

    Examples:
        >>> import derive
        >>> rod = derive.Visual(cylinder=(0.02, 1), at=(0, 0, 0.5))
        >>> body = derive.SpatialRigidBody("rod", mass=1, inertia=(1, 1, 2, 0, 0, 0), visuals=[rod])
        >>> derive.spatial_scene("swing", bodies=[body]).bodies[0].visuals[0].cylinder
        (0.02, 1.0)
    """

    mesh: Annotated[
        str | Mesh | None,
        key(
            KeyType.MESH,
            "File with a mesh, STL, OBJ or Collada (.dae), relative to the specification; in m where it names no unit.",
            example='"hand.stl"',
        ),
    ] = None
    box: Annotated[
        tuple[float, float, float] | None,
        key(KeyType.TRIPLE, "Edges of a box along its axes, m; its middle is at `at`.", example="[0.1, 0.2, 0.3]"),
    ] = None
    cylinder: Annotated[
        tuple[float, float] | None,
        key(
            KeyType.FLOAT_PAIR,
            "Radius and length of a cylinder about its z axis, m; its middle is at `at`.",
            example="[0.05, 0.3]",
        ),
    ] = None
    sphere: Annotated[
        float | None, key(KeyType.POSITIVE_FLOAT, "Radius of a sphere, m; its middle is at `at`.", example="0.1")
    ] = None
    at: Annotated[
        tuple[float, float, float], key(KeyType.TRIPLE, "Position of its frame in the frame of the body, m.")
    ] = (0.0, 0.0, 0.0)
    rotation: Annotated[
        UnitQuaternion,
        key(KeyType.ROTATION, f"Rotation of its frame: {ROTATION_FORMS}.", shown=(1, 0, 0, 0)),
    ] = NO_ROTATION
    scale: Annotated[
        tuple[float, float, float],
        key(KeyType.TRIPLE, "Factors of a mesh along its axes: [0.001, 0.001, 0.001] of one in mm.", shown=(1, 1, 1)),
    ] = NO_SCALE
    __repr__ = record_text


def visuals_key(description: str) -> Key:
    """The key of the visuals of a body or of the ground."""
    return key(KeyType.VISUALS, description, "", "visuals", default=(), shown=[], example="[{ box = [0.1, 0.2, 0.3] }]")
