"""A deformable body as numbers: what the equations of motion need to know of it, whatever it was made from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ModalPoint:
    """A named material point: X (3,) in m and the values of the N shapes there, (N, 3), in the body frame."""

    name: str
    doc: str
    position: Array
    shapes: Array


@dataclass(frozen=True, eq=False)
class ModalBody:
    """Mass, shape integrals c1 .. c8 of the appendix, stiffness and damping of a body with N modes, SI units.

    c1 (3,) = int rho X; c2 (N, 3) = int rho Phi_i; C3 (3, 3) = int rho {(X . X) I - X X};
    C4 (N, 3, 3) = int rho {(Phi_i . X) I - Phi_i X}; C5 (N, N, 3, 3) = int rho {(Phi_i . Phi_j) I - Phi_i Phi_j};
    c6 (N, 3) = int rho X x Phi_i; c7 (N, N, 3) = int rho Phi_i x Phi_j; c8 (N, N) = int rho Phi_i . Phi_j;
    `stiffness` (N, N) of U = 1/2 alpha K alpha; `damping` (N, N), the factor of the rates alphadot.

    `zeros` gives the reason of each integral that vanishes by structure. Its keys are the names of the derivation:
    c1_k, c2_i_k, C3_ab, C4_i_ab, C5_i_j_ab (symmetric parts; i <= j, a <= b), c6_i_k, c7_i_j_k (i < j), c8_i_j
    (i <= j), K_i_j and B_i_j (stiffness and damping, i <= j), with i, j from 1 and k, a, b from 1 to 3. The numbers
    there are 0.0 exactly.
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

    @property
    def modes(self) -> int:
        """N."""
        return len(self.c2)
