"""A deformable body as numbers: the data that its equations of motion need, whatever their source."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from derive.short_text import counted, listed, summary

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ModalPoint:
    """A named material point: X (3,) in m and the values of the N shapes there, (N, 3), in the body frame.

    `second` (N, N, 3), 1/m, are the values of the second-order fields Psi_ij there; None for a body of first order.
    """

    name: str
    doc: str
    position: Array
    shapes: Array
    second: Array | None = None


@dataclass(frozen=True)
class ModalFrame:
    """A marker frame: its point, and the rotation vectors (N, 3), rad/m, of the section there by unit amplitudes.

    `second_twists` (N, N, 3), rad/m^2, are those of second order, of 1/2 sum a_i a_j s_ij; None at first order.
    `stresses` (N, 6), Pa/m, are those of unit amplitudes there, where an output asks for them.
    """

    point: ModalPoint
    twists: Array
    second_twists: Array | None = None
    stresses: Array | None = None


@dataclass(frozen=True, eq=False)
class ModalBody:
    """Mass, shape integrals c1 .. c8 of the appendix, stiffness and damping of a body with N modes, SI units.

    A body with geometric stiffening has displacements of second order, u = sum a_i Phi_i + 1/2 sum a_i a_j Psi_ij
    (`derive.reduction.second_order`). It has the further integrals c9 and c10, both symmetric in i and j, and its C5
    contains int rho {(X . Psi_ij) I - sym X Psi_ij} as well: C5_ij is then, as without Psi_ij, the factor of
    alpha_i alpha_j in the tensor of inertia.

    The keys of `zeros` are the names of the derivation: c1_k, c2_i_k, C3_ab, C4_i_ab, C5_i_j_ab (symmetric parts;
    i <= j, a <= b), c6_i_k, c7_i_j_k (i < j), c8_i_j (i <= j), K_i_j and B_i_j (stiffness and damping, i <= j),
    c9_i_j_k and c10_i_j_k (i <= j), with i, j from 1 and k, a, b from 1 to 3. The numbers there are 0.0 exactly.

    Attributes:
        name: the name of the body.
        doc: the kind of body in words.
        origin: where the origin of the floating frame is, in words.
        mass: kg.
        c1: (3,) = int rho X.
        c2: (N, 3) = int rho Phi_i.
        C3: (3, 3) = int rho {(X . X) I - X X}.
        C4: (N, 3, 3) = int rho {(Phi_i . X) I - Phi_i X}.
        C5: (N, N, 3, 3) = int rho {(Phi_i . Phi_j) I - Phi_i Phi_j}.
        c6: (N, 3) = int rho X x Phi_i.
        c7: (N, N, 3) = int rho Phi_i x Phi_j.
        c8: (N, N) = int rho Phi_i . Phi_j.
        stiffness: (N, N) of U = 1/2 alpha K alpha.
        damping: (N, N), the factor of the rates alphadot.
        points: the markers with their displacements in the modes.
        zeros: the reason of each integral that vanishes by structure.
        c9: (N, N, 3) = int rho Psi_ij; None for a body of first order.
        c10: (N, N, 3) = int rho X x Psi_ij; None for a body of first order.

    Examples:
        >>> import derive
        >>> import numpy as np
        >>> corners = [[1, 1, 0], [-1, 1, 0], [-1, -1, 0], [1, -1, 0]]
        >>> breathing = [np.array(corners) / 8**0.5]
        >>> nodes = {"positions": corners, "mass": np.eye(4), "modes": breathing, "modal_stiffness": [[100]]}
        >>> square = derive.nodal_body("square", nodes, units="SI")
        >>> body = derive.modal(square)
        >>> body.modes, body.mass, body.C3.diagonal()
        (1, 4.0, array([4., 4., 8.]))
        >>> body.c8, body.stiffness
        (array([[1.]]), array([[100.]]))
    """

    name: str
    doc: str
    origin: str
    mass: float
    c1: Array
    c2: Array
    C3: Array
    C4: Array
    C5: Array
    c6: Array
    c7: Array
    c8: Array
    stiffness: Array
    damping: Array
    points: tuple[ModalPoint, ...] = ()
    zeros: Mapping[str, str] = field(default_factory=dict)
    c9: Array | None = None
    c10: Array | None = None

    @property
    def modes(self) -> int:
        """The number of modes N."""
        return len(self.c2)

    @property
    def second_order(self) -> bool:
        """Whether displacements are quadratic in the amplitudes."""
        return self.c9 is not None

    def __repr__(self) -> str:
        head = f"ModalBody {self.name}: {counted(self.modes, 'mode')}, mass {self.mass:g} kg"
        return summary(head, {"model": self.doc, "points": listed(point.name for point in self.points)})
