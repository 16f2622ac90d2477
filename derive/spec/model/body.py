"""Bodies in space as frozen data: made of nodes, or with parameters for all their integrals."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from fractions import Fraction
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

from derive.display import html
from derive.short_text import record_text
from derive.spec.model.documentation import documented
from derive.spec.model.keys import KeyType, key
from derive.spec.model.mode_selection import ModeSelection
from derive.spec.model.node_data import NodeData
from derive.spec.model.node_markers import InterfaceMarker, NodeMarker
from derive.spec.model.plots import Plot
from derive.spec.model.quantity import Quantity
from derive.spec.model.simulation import AT_REST, Simulation, SpatialStart
from derive.spec.model.spec_text import nodal_text, symbolic_text

if TYPE_CHECKING:
    pass


class DisplacementOrder(Enum):
    """The order in which displacements due to deformation depend on the amplitudes.

    FIRST_ORDER: linearly, as in the paper. At second order a beam shortens as it bends: TRUNCATED keeps the kinetic and
    potential energy through second order in the amplitudes, FULL keeps all that the displacement field yields.
    """

    FIRST_ORDER = "first order"
    TRUNCATED = "second order, truncated"
    FULL = "second order, full"


ACCELERATION_UNIT = "m/s^2"
GRAVITY = "Acceleration of free fall in the inertial frame, m/s^2; each component a parameter or a number."
"""The description of the gravity of a body alone and of a scene."""

Gravity = tuple[Quantity, Quantity, Quantity]
"""The acceleration of free fall in the inertial frame, m/s^2; each component a parameter or a number."""

Lowering = Literal["auto", "flat", "loops"]
BodyFrameKind = Literal["mean", "point", "given"]
SymbolicFrame = Literal["mean", "given"]
ComponentModes = Literal["free", "craig_bampton", "attachment"]

LOWERING = key(
    KeyType.CHOICE,
    "Code of sums over the modes: flat (unrolled), loops, or auto (the faster, as predicted).",
    default="auto",
    choice_of="the lowering",
)


@documented
@dataclass(frozen=True)
class BodyFrame:
    """The conditions that remove rigid motion from the modes of a body in space.

    Attributes:
        kind: "mean": conditions (17) and (19); "point": no displacement of node `node`, and no mean rotation of it and
            its neighbours `around`; "given": modes as they stand, refused if they hold a rigid motion.

    Examples:
        >>> import derive
        >>> derive.BodyFrame("point", node=3).around
        ()
    """

    kind: Annotated[BodyFrameKind, key(KeyType.CHOICE, "", choice_of="the frame", example='"point"')]
    node: Annotated[int | None, key(KeyType.COUNT, "The node of a point frame, counted from 0.")] = None
    around: Annotated[
        tuple[int, ...],
        key(
            KeyType.COUNTS,
            "Nodes whose mean rotation a point frame follows; by default the nearest neighbours of `node`.",
        ),
    ] = ()
    __repr__ = record_text


@documented
@dataclass(frozen=True)
class Damping:
    """Viscous damping of a body in space: a fraction of critical damping, or proportional to mass and stiffness.

    Examples:
        >>> import derive
        >>> import numpy as np
        >>> corners = [[1, 1, 0], [-1, 1, 0], [-1, -1, 0], [1, -1, 0]]
        >>> breathing = [np.array(corners) / 8**0.5]
        >>> nodes = {"positions": corners, "mass": np.eye(4), "modes": breathing, "modal_stiffness": [[100]]}
        >>> body = derive.modal(derive.nodal_body("square", nodes, units="SI", damping=derive.Damping(ratio=0.01)))
        >>> body.damping  # 2 ratio sqrt(K c8)
        array([[0.2]])
    """

    ratio: Annotated[
        Fraction,
        key(KeyType.NOT_NEGATIVE, "Fraction of critical damping of each mode, such as 0.01.", optional=True),
    ] = Fraction(0)
    mass: Annotated[Fraction, key(KeyType.NOT_NEGATIVE, "Factor of the mass matrix, 1/s.", optional=True)] = Fraction(0)
    stiffness: Annotated[Fraction, key(KeyType.NOT_NEGATIVE, "Factor of the stiffness matrix, s.", optional=True)] = (
        Fraction(0)
    )
    __repr__ = record_text


@documented
@dataclass(frozen=True)
class NodalBody:
    """A flexible body in space given by nodes, as a finite-element program exports it.

    Attributes:
        name: the name of the model.
        data: positions, mass, stiffness and modes of the nodes in SI units.
        simulation: duration, output and tolerance of a simulation of the body alone.
        plots: plots of a simulation of the body alone.
        rigid_sets: sets of nodes that move as rigid bodies in all computed modes.
        interface_markers: the markers that `interface` names.
        loaded_nodes: the nodes of markers and loads in a scene, whose displacements of second order are computed.

    Examples:
        >>> import derive
        >>> import numpy as np
        >>> corners = [[1, 1, 0], [-1, 1, 0], [-1, -1, 0], [1, -1, 0]]
        >>> breathing = [np.array(corners) / 8**0.5]
        >>> nodes = {"positions": corners, "mass": np.eye(4), "modes": breathing, "modal_stiffness": [[100]]}
        >>> square = derive.nodal_body("square", nodes, units="SI", markers={"corner": 0})
        >>> square.frame.kind, square.markers[0].node
        ('mean', 0)
    """

    name: str
    data: Annotated[
        NodeData,
        key(
            KeyType.NODES,
            "A .npz file with the arrays, or one MatrixMarket file for each; relative to the specification.",
            name="nodes",
            example='"block.npz"',
        ),
        key(
            KeyType.UNITS,
            'Units of the numbers in the files: "SI", or a table of units.',
            name="units",
            required=True,
            example='"SI", or those of the files, such as { length = "mm", mass = "t", time = "s" }',
        ),
    ]
    modes: Annotated[
        int | ModeSelection | None,
        key(
            ModeSelection,
            "Number of modes that are computed, or kept of the given ones; by default all given ones. Or the error "
            "within which as few as possible are computed.",
            optional=True,
            example="12, or { error = 0.01, up_to = 500 }",
        ),
    ]
    frame: Annotated[
        BodyFrame,
        key(
            BodyFrame,
            "The floating frame, whose conditions remove rigid-body motion from the modes: mean (no mean displacement, "
            "no mean rotation), point (fixed to a node), given (the modes are used unchanged).",
            default=BodyFrame("mean"),
            shown="mean",
        ),
    ]
    orthonormal: Annotated[
        bool,
        key(
            KeyType.TRUTH,
            "Whether the modes are made orthonormal with respect to the mass; by default in the mean frame and for "
            "computed modes.",
            optional=True,
        ),
    ]
    damping: Annotated[
        Damping, key(Damping, "Viscous damping; none by default.", optional=True, example="{ ratio = 0.01 }")
    ]
    gravity: Annotated[Gravity | None, key(KeyType.ACCELERATION, GRAVITY, optional=True)]
    markers: Annotated[
        tuple[NodeMarker, ...],
        key(KeyType.NODE_POINTS, "Named nodes and their numbers, counted from 0.", default=()),
    ]
    lowering: Annotated[Lowering, LOWERING]
    start: Annotated[SpatialStart, key(SpatialStart, "Initial state of a simulation of the body alone.")] = AT_REST
    simulation: Simulation | None = None
    plots: tuple[Plot, ...] = ()
    order: Annotated[
        DisplacementOrder,
        key(
            KeyType.ORDER,
            "The order of the displacements in the amplitudes: 2 uses the geometric stiffness matrices of the files "
            "(K0t, K0r, K0omega, K0F), or computes them where the files have elements with materials and a stiffness; "
            "1 leaves them out. By default 2 if the files have matrices of the modes that are used.",
            optional=True,
        ),
    ] = DisplacementOrder.FIRST_ORDER
    component_modes: Annotated[
        ComponentModes | None,
        key(
            KeyType.CHOICE,
            "Modes that are computed from mass and stiffness: free (the natural modes of the free body), craig_bampton "
            "(static modes of the interface, and the vibration modes of the body that is held there) or attachment "
            "(static modes of loads at the interface, balanced by inertia forces, and free modes). By default "
            "craig_bampton with an interface; without one the modes of the files, or free ones if these have none.",
            choice_of="the kind of component modes",
            optional=True,
        ),
    ] = None
    interface: Annotated[
        tuple[str, ...],
        key(
            KeyType.MARKER_NAMES,
            "Markers, or sets of nodes of the file, at which joints hold the body. Each adds static modes to `modes`, "
            "of its displacement and, if it is a set of nodes, of its rotation; craig_bampton needs six fewer, which "
            "are rigid motion.",
            default=(),
            example='["left", "right"]',
        ),
    ] = ()
    stress: Annotated[
        bool,
        key(
            KeyType.TRUTH,
            "Whether simulations record the largest stress of von Mises in the body, Pa, as the column `stress` of a "
            "body alone, and NAME_stress of a body of a scene; the files then have elements with materials.",
        ),
    ] = False
    rigid_sets: tuple[tuple[int, ...], ...] = ()
    interface_markers: tuple[InterfaceMarker, ...] = ()
    loaded_nodes: tuple[int, ...] = ()
    section: ClassVar[str] = "body"
    __repr__ = nodal_text
    _repr_html_ = html

    @property
    def uses_given_modes(self) -> bool:
        """Whether the modes are those of the files, which come before computed ones unless these are asked for."""
        return self.data.modes is not None and self.component_modes is None

    @property
    def second_order(self) -> bool:
        """Whether displacements are quadratic in the amplitudes."""
        return self.order is not DisplacementOrder.FIRST_ORDER

    @property
    def computes_geometric_stiffness(self) -> bool:
        """Whether the geometric stiffness of the modes comes from the elements, as the files have none of them."""
        return self.second_order and not (self.uses_given_modes and self.data.has_geometric_stiffness)


@documented
@dataclass(frozen=True)
class SymbolicBody:
    """A flexible body in space whose mass, shape integrals and stiffness are run-time parameters.

    Attributes:
        name: the name of the model.

    Examples:
        >>> import derive
        >>> derive.symbolic_body("any_body", modes=4).frame
        'mean'
    """

    # In the frame mean c1, c2 and c6 vanish, c8 is the unit matrix, and the stiffness is diagonal.
    name: str
    modes: Annotated[int, key(KeyType.MODE_COUNT, "Number of modes.", example="8")]
    frame: Annotated[
        SymbolicFrame,
        key(
            KeyType.CHOICE,
            "Assumption about the modes: mean (orthonormal in the mean frame), or given (none).",
            default="mean",
            choice_of="the frame of a symbolic body",
        ),
    ]
    damping: Annotated[bool, key(KeyType.TRUTH, "Whether viscous damping is among the parameters.", default=False)]
    gravity: Annotated[Gravity | None, key(KeyType.ACCELERATION, GRAVITY, optional=True)]
    lowering: Annotated[Lowering, LOWERING]
    section: ClassVar[str] = "body"
    simulation: ClassVar[None] = None  # it has no numbers to simulate with
    plots: ClassVar[tuple[Plot, ...]] = ()
    __repr__ = symbolic_text
    _repr_html_ = html
