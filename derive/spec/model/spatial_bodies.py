"""Bodies of a scene in space as frozen data: rigid and finite-element ones, their markers and loads."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Annotated, ClassVar, Literal

from derive.short_text import record_text
from derive.spec.model.beam_parts import DEFAULT_LENGTH, INERTIA_UNIT
from derive.spec.model.body import NodalBody
from derive.spec.model.documentation import documented
from derive.spec.model.forces import ForceFrame
from derive.spec.model.keys import KeyType, key
from derive.spec.model.planar_bodies import BODY_MASS, NOT_NEEDED
from derive.spec.model.quantity import Quantity
from derive.spec.model.spatial_start import (
    NO_ROTATION,
    NOT_GIVEN_IN_SPACE,
    ROTATION_FORMS,
    SPATIAL_START,
    SpatialInitialValues,
    UnitQuaternion,
)
from derive.spec.model.time_function import TimeFunction
from derive.spec.model.visuals import Visual, visuals_key


@documented
@dataclass(frozen=True)
class FrameMarker:
    """A named marker of a rigid body or of the ground: a point, and the rotation of its frame, in those of the body.

    Attributes:
        name: the name of the marker.

    Examples:
        >>> import derive
        >>> axle = derive.FrameMarker("axle", (0, 0, "1/2"), rotation=(0, 1, 0, 0))
        >>> top = derive.SpatialRigidBody("top", mass=1, inertia=(1, 1, 2, 0, 0, 0), markers=[axle])
        >>> derive.spatial_scene("spinner", bodies=[top]).bodies[0].markers[0].position[2]
        Fraction(1, 2)
    """

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
    __repr__ = record_text


FRAMES = key(
    KeyType.FRAMES,
    "Named markers: coordinates [x, y, z], m, or { at = [x, y, z], rotation = ... } of a frame that is rotated.",
    default=(),
)


@documented
@dataclass(frozen=True)
class SpatialRigidBody:
    """A rigid body in space.

    Attributes:
        name: the name of the body.

    Examples:
        >>> import derive
        >>> top = derive.SpatialRigidBody("top", mass=1, inertia=(1, 1, 2, 0, 0, 0))
        >>> derive.spatial_scene("spinner", bodies=[top]).bodies[0].inertia[2]
        Fraction(2, 1)
    """

    name: str
    mass: Annotated[Quantity | None, BODY_MASS] = None
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
    visuals: Annotated[
        tuple[Visual, ...],
        visuals_key(
            "What pictures and the player show in place of the box of equal inertia: boxes, cylinders, spheres and "
            "meshes; equations do not contain them."
        ),
    ] = ()
    kind: ClassVar[str] = "rigid"
    __repr__ = record_text


NodeMotion = Literal["mean", "rigid"]


@documented
@dataclass(frozen=True)
class NodeFrame:
    """A named marker of a finite-element body: a node, or a set of nodes.

    Attributes:
        name: the name of the marker.
        node_set: the set of the file that `nodes` come from; "" if they are given by numbers.

    Examples:
        >>> import derive
        >>> derive.NodeFrame("corner", nodes=(0,)).has_rotation, derive.NodeFrame("face", nodes=(0, 1, 2)).has_rotation
        (False, True)
    """

    name: str
    nodes: Annotated[
        tuple[int, ...],
        key(
            KeyType.COUNTS,
            "Nodes whose weighted mean displacement and rotation are those of the marker.",
            default=(),
        ),
        key(KeyType.COUNT, "A node, counted from 0; its marker has no rotation of its own.", name="node"),
        key(KeyType.TEXT, "A set of nodes of the file, in place of `nodes`.", name="set", example='"left"'),
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
    node_set: str = ""
    __repr__ = record_text

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
    __repr__ = record_text


@documented
@dataclass(frozen=True)
class FlexibleBody:
    """A finite-element body in a scene in space.

    Attributes:
        name: the name of the body.
        body: its data, without gravity, markers and initial values.

    Examples:
        >>> import derive
        >>> import numpy as np
        >>> corners = [[1, 1, 0], [-1, 1, 0], [-1, -1, 0], [1, -1, 0]]
        >>> breathing = [np.array(corners) / 8**0.5]
        >>> nodes = {"positions": corners, "mass": np.eye(4), "modes": breathing, "modal_stiffness": [[100]]}
        >>> square = derive.FlexibleBody("square", derive.nodal_body("square", nodes, units="SI"))
        >>> derive.spatial_scene("floating", bodies=[square]).bodies[0].body.data.positions.shape
        (4, 3)
    """

    name: str
    body: NodalBody
    markers: Annotated[
        tuple[NodeFrame, ...],
        key(
            KeyType.NODE_FRAMES,
            "Named markers: the number of a node, or, for the weighted mean motion of a set of nodes, { nodes = [..] } "
            'or { set = "left" } with the name of a set of the file.',
            default=(),
        ),
    ] = ()
    start: Annotated[SpatialInitialValues, SPATIAL_START] = NOT_GIVEN_IN_SPACE
    loads: Annotated[
        tuple[NodalLoad, ...], key(NodalLoad, "Loads on nodes by name.", example="[bodies.rod.loads.pressure]")
    ] = ()
    keep_coordinates: ClassVar[bool] = True
    kind: ClassVar[str] = "flexible"
    __repr__ = record_text
