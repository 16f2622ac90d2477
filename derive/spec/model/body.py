"""The contents of a specification as frozen data: the types that `read` returns and `derive` takes."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from fractions import Fraction
from typing import TYPE_CHECKING, Annotated, Literal

from derive.spec.model.keys import KeyType, declared_keys, key
from derive.spec.model.plots import Plot
from derive.spec.model.quantity import Parameter, Quantity
from derive.spec.model.simulation import AT_REST, NOT_GIVEN, InitialValues, Simulation, SpatialStart

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray
    from scipy.sparse import csr_array

Polynomial = tuple[Fraction, ...]
"""A polynomial as its coefficients of 1, xi, xi^2, ... without trailing zeros."""

FrameKind = Literal["mean", "point", "chord", "tangent", "given"]
Ends = Literal["pinned", "free"]
"""The conditions on shapes at both ends of a beam, besides those of the frame: v'' = 0, or v'' = v''' = 0."""


class DisplacementOrder(Enum):
    """The order in which displacements due to deformation depend on the amplitudes.

    FIRST_ORDER: linearly, as in the paper. At second order a beam shortens as it bends: TRUNCATED keeps the kinetic and
    potential energy through second order in the amplitudes, FULL keeps all that the displacement field yields.
    """

    FIRST_ORDER = "first order"
    TRUNCATED = "second order, truncated"
    FULL = "second order, full"


DEFAULT_ANSATZ = ("1", "xi", "xi^2", "xi^3")
DEFAULT_POLYNOMIALS = tuple((Fraction(0),) * power + (Fraction(1),) for power in range(len(DEFAULT_ANSATZ)))
DEFAULT_FRAME: FrameKind = "mean"
DEFAULT_MASS = Parameter("m", "kg", 1.0)
DEFAULT_LENGTH = Parameter("l", "m", 1.0)
DEFAULT_BENDING_STIFFNESS = Parameter("EI", "N m^2", 1.0)
"""The free beam of the paper, (21)-(27): defaults for the keys that a specification leaves out."""
INERTIA_UNIT = "kg m^2"
ACCELERATION_UNIT = "m/s^2"
GRAVITY = "Acceleration of free fall in the inertial frame, m/s^2; each component a parameter or a number."
"""The description of the gravity of a body alone and of a scene."""


@dataclass(frozen=True)
class Frame:
    """The conditions that remove rigid motion from the displacements due to deformation: (16) or (17), (19).

    `mean`: no mean displacement and no mean rotation; `point`: no displacement and no slope at `at`;
    `chord`: no displacement at either end; `tangent`: no displacement and no slope at the end `at`;
    `given`: the ansatz is used as it stands, and refused if it holds a rigid motion. In every frame X = xi l/2 e1, so
    that c is where the centre of the undeformed beam lies in the floating frame, not the point `at`.
    """

    kind: Annotated[FrameKind, key(KeyType.CHOICE, "", choice_of="the frame", example='"point"')]
    at: Annotated[
        Fraction | None,
        key(
            KeyType.POSITION,
            "The position xi of a point frame (default 0), or the end, -1 or 1, of a tangent frame.",
        ),
    ] = None


FamilyKind = Literal["pinned", "free-free", "clamped-free"]


@dataclass(frozen=True)
class ShapeFamily:
    """Shape functions with names: the natural modes of a uniform beam, in mass and in stiffness orthogonal."""

    kind: Annotated[
        FamilyKind,
        key(
            KeyType.CHOICE,
            "Which beam they are modes of: pinned at both ends (half sine waves, for the frame chord), free-free (for "
            "the frame mean), clamped-free (clamped at the left end, for the frame tangent there).",
            choice_of="the family",
            example='"pinned"',
        ),
    ]
    count: Annotated[int, key(KeyType.SHAPE_COUNT, "How many, from that of the lowest frequency on.", example="3")]


FAMILY_FRAMES: dict[FamilyKind, Frame] = {
    "pinned": Frame("chord"),
    "free-free": Frame("mean"),
    "clamped-free": Frame("tangent", Fraction(-1)),
}
"""The frame whose conditions the shapes of a family fulfil."""


@dataclass(frozen=True)
class AssumedDeflection:
    """The assumed deflection of a beam, which determines its shape functions.

    It is an ansatz of polynomials with the conditions of the frame and of the ends, or a family of shapes, which have
    to fulfil the conditions of the frame.
    """

    ansatz: tuple[Polynomial, ...] | ShapeFamily
    frame: Frame
    orthogonal: bool = False
    ends: Ends | None = None


@dataclass(frozen=True)
class AxialDeformation:
    """How a beam stretches. Without this table its axis keeps its length, to the order of its displacements."""

    ansatz: Annotated[
        tuple[Polynomial, ...],
        key(
            KeyType.SHAPES,
            "Polynomials in xi whose sum is the displacement along the axis, before the condition of the frame takes a "
            "constant from each: no mean displacement, none at the point of the frame, or opposite ones at the ends of "
            'a chord. ["xi"] is a uniform strain.',
            example='["xi"]',
        ),
    ]
    stiffness: Annotated[
        Quantity,
        key(
            KeyType.POSITIVE_QUANTITY,
            "Axial stiffness EA, N: a run-time parameter or a number.",
            "N",
            example="1e6",
        ),
    ]
    preload: Annotated[
        Quantity,
        key(
            KeyType.QUANTITY,
            "Axial force of the straight beam of the given length, N, positive in tension; for beams of order 2.",
            "N",
        ),
    ] = Fraction(0)


@dataclass(frozen=True)
class Marker:
    """A named material point of a beam, at the dimensionless distance `at` in [-1, 1] of (21)."""

    name: str
    at: Fraction


@dataclass(frozen=True)
class AttachedMass:
    """A small rigid body that is fixed to the section of a beam, with its centre of mass on the axis."""

    name: str
    at: Annotated[Fraction, key(KeyType.POSITION, "Position xi, from -1 (left end) to 1 (right end).", example="1")]
    mass: Annotated[Quantity, key(KeyType.POSITIVE_QUANTITY, "Mass, kg.", DEFAULT_MASS.unit, example="0.5")]
    inertia: Annotated[
        Quantity,
        key(KeyType.NOT_NEGATIVE_QUANTITY, "Moment of inertia about its centre of mass, kg m^2.", INERTIA_UNIT),
    ] = Fraction(0)


@dataclass(frozen=True)
class BeamDamping:
    """Damping of the deformation of a beam: a fraction of critical damping, or proportional to mass and stiffness.

    It is that of the whole beam without attached masses, the same in every frame and in any number of pieces; rigid
    motion is not damped.
    """

    ratio: Annotated[
        Quantity,
        key(
            KeyType.NOT_NEGATIVE_QUANTITY,
            "Fraction of critical damping of each free mode, such as 0.01.",
            "1",
            optional=True,
        ),
    ] = Fraction(0)
    mass: Annotated[
        Quantity,
        key(
            KeyType.NOT_NEGATIVE_QUANTITY,
            "Factor of the mass matrix of the deformation, 1/s: forces against the velocity relative to the mean frame "
            "of the whole beam.",
            "1/s",
            optional=True,
        ),
    ] = Fraction(0)
    stiffness: Annotated[
        Quantity,
        key(KeyType.NOT_NEGATIVE_QUANTITY, "Factor of the stiffness matrix, s.", "s", optional=True),
    ] = Fraction(0)


@dataclass(frozen=True)
class PlanarBeam:
    """A uniform slender beam that moves freely in a plane."""

    name: str
    ansatz: Annotated[
        tuple[Polynomial, ...] | ShapeFamily,
        key(
            ShapeFamily,
            "Polynomials in xi whose sum is the deflection, before the conditions of the frame; or a family of shape "
            "functions.",
            default=DEFAULT_POLYNOMIALS,
            shown=DEFAULT_ANSATZ,
        ),
    ]
    frame: Annotated[
        Frame,
        key(
            Frame,
            "The floating frame, whose conditions remove rigid-body motion from the ansatz: mean (no mean "
            "displacement, no mean rotation), point (no displacement and no slope at a point), chord (no displacement "
            "at the ends), tangent (no displacement and no slope at an end), given (the ansatz is used unchanged). "
            "A family of shape functions has by default the frame that it is for.",
            shown=DEFAULT_FRAME,
            optional=True,
        ),
    ]
    mass: Annotated[
        Quantity,
        key(
            KeyType.POSITIVE_QUANTITY,
            "Mass, kg: a run-time parameter, or a number that is folded into the code.",
            DEFAULT_MASS.unit,
            default=DEFAULT_MASS,
        ),
    ]
    length: Annotated[
        Quantity,
        key(
            KeyType.POSITIVE_QUANTITY,
            "Length, m: a run-time parameter or a number.",
            DEFAULT_LENGTH.unit,
            default=DEFAULT_LENGTH,
        ),
    ]
    bending_stiffness: Annotated[
        Quantity,
        key(
            KeyType.POSITIVE_QUANTITY,
            "Bending stiffness EI, N m^2: a run-time parameter or a number. Rotary inertia of the cross-sections and "
            "shear deformation are left out at either order.",
            DEFAULT_BENDING_STIFFNESS.unit,
            default=DEFAULT_BENDING_STIFFNESS,
        ),
    ]
    markers: Annotated[
        tuple[Marker, ...],
        key(
            KeyType.BEAM_POINTS,
            "Named points of the beam and their positions xi, from -1 (left end) to 1 (right end).",
        ),
    ] = ()
    orthogonal: Annotated[
        bool,
        key(
            KeyType.TRUTH,
            "Whether the shape functions are made orthogonal; by default only in the mean frame.",
            optional=True,
        ),
    ] = False
    gravity: Annotated[tuple[Quantity, Quantity] | None, key(KeyType.PLANAR_ACCELERATION, GRAVITY)] = None
    start: Annotated[InitialValues, key(InitialValues, "Initial values of a simulation of the beam alone.")] = NOT_GIVEN
    simulation: Simulation | None = None
    plots: tuple[Plot, ...] = ()
    damping: Annotated[
        BeamDamping | None,
        key(
            BeamDamping,
            "Damping of the deformation: { ratio = 0.01 } of critical in each free mode of the beam, or "
            "{ mass = 0.1, stiffness = 1e-5 }, factors of its mass and stiffness matrices, in 1/s and s.",
            example="{ ratio = 0.01 }",
        ),
    ] = None
    order: Annotated[
        DisplacementOrder,
        key(
            KeyType.ORDER,
            "The order of the displacements in the amplitudes: 1 as in the paper, where a fast-spinning beam softens "
            "and no beam buckles; 2 with the shortening of a beam that bends.",
            default=1,
        ),
        key(
            KeyType.CHOICE,
            "What a beam of order 2 keeps: truncated (kinetic and potential energy through second order in the "
            "amplitudes), full (all that the displacements yield; the mass matrix is always positive definite). By "
            "default truncated in the frames mean, chord and given, and full in the frames point and tangent.",
            name="terms",
            choices=("truncated", "full"),
            choice_of="terms",
            optional=True,
        ),
    ] = DisplacementOrder.FIRST_ORDER
    ends: Annotated[
        Ends | None,
        key(
            KeyType.CHOICE,
            "What the shape functions fulfil at both ends of the beam besides the conditions of the frame: pinned (no "
            "curvature) or free (no curvature, no derivative of it). By default nothing.",
        ),
    ] = None
    masses: Annotated[
        tuple[AttachedMass, ...],
        key(
            AttachedMass,
            "Attached masses by name: rigid bodies that are fixed to sections of the beam. The conditions of the frame "
            "and the damping are those of the beam without them.",
            example="[bodies.rod.masses.tip]",
        ),
    ] = ()
    axial: Annotated[
        AxialDeformation | None,
        key(
            AxialDeformation,
            'How the beam stretches: { ansatz = ["xi"], stiffness = 1e6 }, the shapes of the displacement along its '
            "axis and EA in N. By default its axis does not stretch.",
            example='{ ansatz = ["xi"], stiffness = 1e6 }',
        ),
    ] = None

    @property
    def deflection(self) -> AssumedDeflection:
        """The assumed deflection, from which the shape functions follow."""
        return AssumedDeflection(self.ansatz, self.frame, self.orthogonal, self.ends)

    @property
    def body_name(self) -> str:
        """The name of the only body when the beam is simulated alone as a scene; it differs from that of the scene."""
        return "beam" if self.name.lower() != "beam" else "rod"


BEAM_QUANTITIES = {key.name: key.default for key in declared_keys(PlanarBeam) if isinstance(key.default, Parameter)}
"""The defaults of the physical constants of a beam, by their keys."""


Gravity = tuple[Quantity, Quantity, Quantity]
"""The acceleration of free fall in the inertial frame, m/s^2; each component a parameter or a number."""

Lowering = Literal["auto", "flat", "table"]
BodyFrameKind = Literal["mean", "point", "given"]
SymbolicFrame = Literal["mean", "given"]

LOWERING = key(
    KeyType.CHOICE,
    "Code of sums over the modes: flat (unrolled), table (loops), or auto (the faster, as predicted).",
    default="auto",
    choice_of="the lowering",
)


@dataclass(frozen=True, eq=False)
class NodeData:
    """A discretised body in SI units, as a finite-element program gives it.

    positions (nodes, 3); mass (nodes, nodes), the symmetric matrix m of M = m (x) I3, diagonal if lumped;
    stiffness (3 nodes, 3 nodes) with the three displacements of a node together; modes (N, nodes, 3);
    modal_stiffness (N, N), of U = 1/2 alpha K alpha. `sha256` is that of the files the numbers came from,
    which does not change where `dataclasses.replace` puts other numbers in.

    K0t (3, N, N), K0r (3, N, N), K0omega (6, N, N) and K0F (K, 3, N, N) are the geometric stiffness matrices of the
    modes under unit loads, K0F under forces at the nodes `K0F_nodes` (K,), see `derive.reduction.second_order`.
    """

    positions: NDArray[np.float64]
    mass: csr_array
    stiffness: csr_array | None
    modes: NDArray[np.float64] | None
    modal_stiffness: NDArray[np.float64] | None
    sha256: str
    K0t: NDArray[np.float64] | None = None
    K0r: NDArray[np.float64] | None = None
    K0omega: NDArray[np.float64] | None = None
    K0F: NDArray[np.float64] | None = None
    K0F_nodes: NDArray[np.int64] | None = None

    @property
    def has_geometric_stiffness(self) -> bool:
        """Whether there are geometric stiffness matrices."""
        return any(k is not None for k in (self.K0t, self.K0r, self.K0omega, self.K0F))


@dataclass(frozen=True)
class BodyFrame:
    """The conditions that remove rigid motion from the modes of a body in space.

    `mean`: conditions (17) and (19); `point`: no displacement of node `node`, and no mean rotation of it and its
    nearest neighbours `around`; `given`: modes as they stand, refused if they hold a rigid motion.
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


@dataclass(frozen=True)
class Damping:
    """Viscous damping: a fraction of critical damping, or proportional to mass and stiffness."""

    ratio: Annotated[
        Fraction,
        key(KeyType.NOT_NEGATIVE, "Fraction of critical damping of each mode, such as 0.01.", optional=True),
    ] = Fraction(0)
    mass: Annotated[Fraction, key(KeyType.NOT_NEGATIVE, "Factor of the mass matrix, 1/s.", optional=True)] = Fraction(0)
    stiffness: Annotated[Fraction, key(KeyType.NOT_NEGATIVE, "Factor of the stiffness matrix, s.", optional=True)] = (
        Fraction(0)
    )


@dataclass(frozen=True)
class NodeMarker:
    """A named node, numbered from 0."""

    name: str
    node: int


@dataclass(frozen=True)
class NodalBody:
    """A flexible body in space given by nodes, as a finite-element program exports it."""

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
        int | None,
        key(
            KeyType.MODE_COUNT,
            "Number of modes that are computed, or kept of the given ones; by default all given ones.",
            optional=True,
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
            "(K0t, K0r, K0omega, K0F), 1 leaves them out; by default 2 if there are any.",
            optional=True,
        ),
    ] = DisplacementOrder.FIRST_ORDER

    @property
    def second_order(self) -> bool:
        """Whether displacements are quadratic in the amplitudes."""
        return self.order is not DisplacementOrder.FIRST_ORDER


@dataclass(frozen=True)
class SymbolicBody:
    """A flexible body in space whose mass, shape integrals and stiffness are run-time parameters."""

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
