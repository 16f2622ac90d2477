"""The contents of a specification as frozen data: the types that `read` returns and `derive` takes."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from fractions import Fraction
from typing import TYPE_CHECKING, Literal

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
DEFAULT_FRAME: FrameKind = "mean"
DEFAULT_MASS = Parameter("m", "kg", 1.0)
DEFAULT_LENGTH = Parameter("l", "m", 1.0)
DEFAULT_BENDING_STIFFNESS = Parameter("EI", "N m^2", 1.0)
BEAM_QUANTITIES = {"mass": DEFAULT_MASS, "length": DEFAULT_LENGTH, "bending_stiffness": DEFAULT_BENDING_STIFFNESS}
"""The defaults of the physical constants of a beam, by their keys."""
"""The free beam of the paper, (21)-(27): defaults for the keys that a specification leaves out."""


@dataclass(frozen=True)
class Frame:
    """The conditions that remove rigid motion from the displacements due to deformation: (16) or (17), (19).

    `mean`: no mean displacement and no mean rotation; `point`: no displacement and no slope at `at`;
    `chord`: no displacement at either end; `tangent`: no displacement and no slope at the end `at`;
    `given`: the ansatz is used as it stands, and refused if it holds a rigid motion. In every frame X = xi l/2 e1, so
    that c is where the centre of the undeformed beam lies in the floating frame, not the point `at`.
    """

    kind: FrameKind
    at: Fraction | None = None


FamilyKind = Literal["pinned", "free-free", "clamped-free"]


@dataclass(frozen=True)
class ShapeFamily:
    """The first `count` natural modes of a uniform beam: pinned at both ends, free, or clamped at its left end."""

    kind: FamilyKind
    count: int


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
    """The stretching of a beam: ansatz of the axial displacement, EA (N), and axial force at rest (N).

    `preload` is the axial force, positive in tension, that the beam of the given length carries when it is straight.
    """

    ansatz: tuple[Polynomial, ...]
    stiffness: Quantity
    preload: Quantity = Fraction(0)


@dataclass(frozen=True)
class Marker:
    """A named material point of a beam, at the dimensionless distance `at` in [-1, 1] of (21)."""

    name: str
    at: Fraction


@dataclass(frozen=True)
class AttachedMass:
    """A small rigid body that is fixed to the section of a beam at `at` in [-1, 1].

    `mass` (kg) has its centre on the axis of the beam, `inertia` (kg m^2) is about that centre.
    """

    name: str
    at: Fraction
    mass: Quantity
    inertia: Quantity = Fraction(0)


@dataclass(frozen=True)
class BeamDamping:
    """Damping of the deformation of a beam, without the masses that are attached to it.

    Either `ratio` of critical in each of its free modes, or `mass` times the mass matrix of the deformation plus
    `stiffness` times K (proportional, 1/s and s). The modes and the mass matrix are those of the mean frame of the
    whole beam, so that the same deformation is damped alike in every frame and in any number of pieces.
    """

    ratio: Quantity = Fraction(0)
    mass: Quantity = Fraction(0)
    stiffness: Quantity = Fraction(0)


@dataclass(frozen=True)
class PlanarBeam:
    """A uniform slender free beam that moves in a plane: the example of the paper, (21)-(27).

    `gravity` is the acceleration of free fall in the inertial frame, m/s^2. `start`, `simulation` and `plots` are for
    the simulation of the beam alone. The conditions of `frame` are on the beam without its `masses`. Without `axial`
    the beam does not stretch.
    """

    name: str
    ansatz: tuple[Polynomial, ...] | ShapeFamily
    frame: Frame
    mass: Quantity
    length: Quantity
    bending_stiffness: Quantity
    markers: tuple[Marker, ...] = ()
    orthogonal: bool = False
    gravity: tuple[Quantity, Quantity] | None = None
    start: InitialValues = NOT_GIVEN
    simulation: Simulation | None = None
    plots: tuple[Plot, ...] = ()
    damping: BeamDamping | None = None
    order: DisplacementOrder = DisplacementOrder.FIRST_ORDER
    ends: Ends | None = None
    masses: tuple[AttachedMass, ...] = ()
    axial: AxialDeformation | None = None

    @property
    def deflection(self) -> AssumedDeflection:
        """The assumed deflection, from which the shape functions follow."""
        return AssumedDeflection(self.ansatz, self.frame, self.orthogonal, self.ends)

    @property
    def body_name(self) -> str:
        """The name of the only body when the beam is simulated alone as a scene; it differs from that of the scene."""
        return "beam" if self.name.lower() != "beam" else "rod"


Gravity = tuple[Quantity, Quantity, Quantity]
"""The acceleration of free fall in the inertial frame, m/s^2; each component a parameter or a number."""

Lowering = Literal["auto", "flat", "table"]
BodyFrameKind = Literal["mean", "point", "given"]
SymbolicFrame = Literal["mean", "given"]


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

    kind: BodyFrameKind
    node: int | None = None
    around: tuple[int, ...] = ()


@dataclass(frozen=True)
class Damping:
    """Viscous damping: `ratio` of critical in each mode, or `mass` c8 + `stiffness` K (proportional, 1/s and s)."""

    ratio: Fraction = Fraction(0)
    mass: Fraction = Fraction(0)
    stiffness: Fraction = Fraction(0)


@dataclass(frozen=True)
class NodeMarker:
    """A named node, numbered from 0."""

    name: str
    node: int


@dataclass(frozen=True)
class NodalBody:
    """A deformable body in space made of nodes; `modes` is how many are computed or kept, None for those given.

    `start`, `simulation` and `plots` are for the simulation of the body alone.
    """

    name: str
    data: NodeData
    modes: int | None
    frame: BodyFrame
    orthonormal: bool
    damping: Damping
    gravity: Gravity | None
    markers: tuple[NodeMarker, ...]
    lowering: Lowering
    start: SpatialStart = AT_REST
    simulation: Simulation | None = None
    plots: tuple[Plot, ...] = ()
    order: DisplacementOrder = DisplacementOrder.FIRST_ORDER

    @property
    def second_order(self) -> bool:
        """Whether displacements are quadratic in the amplitudes."""
        return self.order is not DisplacementOrder.FIRST_ORDER


@dataclass(frozen=True)
class SymbolicBody:
    """A deformable body in space whose mass, shape integrals and stiffness are run-time parameters.

    `frame` is `mean` (c1, c2, c6 vanish, c8 is the unit matrix, the stiffness is diagonal) or `given` (all there is).
    """

    name: str
    modes: int
    frame: SymbolicFrame
    damping: bool
    gravity: Gravity | None
    lowering: Lowering
