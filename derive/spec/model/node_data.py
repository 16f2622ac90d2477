"""The numbers of a discretised body, as a finite-element program gives them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from derive.short_text import record_text

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray
    from scipy.sparse import csr_array

    from derive.spec.model.mesh import NodeMesh


@dataclass(frozen=True, eq=False)
class NodeData:
    """A discretised body in SI units, as a finite-element program gives it.

    K0t, K0r, K0omega and K0F are the geometric stiffness matrices of the modes under unit loads, see
    `derive.reduction.second_order`.

    Attributes:
        positions: (nodes, 3), m.
        mass: the symmetric matrix m (nodes, nodes) of M = m (x) I3, kg, diagonal if lumped.
        stiffness: (3 nodes, 3 nodes), N/m, with the three displacements of a node together; None if there is none.
        modes: (N, nodes, 3); None if they are computed.
        modal_stiffness: (N, N), of U = 1/2 alpha K alpha; None if there is none.
        sha256: that of the files the numbers came from, which does not change where `dataclasses.replace` puts other
            numbers in.
        K0t: (3, N, N), for unit accelerations; None if there is none.
        K0r: (3, N, N), for unit angular accelerations.
        K0omega: (6, N, N), for unit products of angular velocities.
        K0F: (K, 3, N, N), for unit forces at nodes.
        K0F_nodes: (K,), the nodes of K0F.
        mesh: elements, materials and sets of nodes; None if the files have none.

    Examples:
        >>> import derive
        >>> import numpy as np
        >>> import scipy.sparse
        >>> corners = np.array([[1.0, 1, 0], [-1, 1, 0], [-1, -1, 0], [1, -1, 0]])
        >>> mass = scipy.sparse.csr_array(np.eye(4))
        >>> data = derive.NodeData(corners, mass, None, np.array([corners]) / 8**0.5, np.array([[100.0]]), sha256="")
        >>> derive.modal(derive.nodal_body("square", data)).mass
        4.0
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
    mesh: NodeMesh | None = None
    __repr__ = record_text

    @property
    def has_geometric_stiffness(self) -> bool:
        """Whether there are geometric stiffness matrices."""
        return any(k is not None for k in (self.K0t, self.K0r, self.K0omega, self.K0F))

    @property
    def has_stresses(self) -> bool:
        """Whether there are elements with materials, from which stresses of modes are computed."""
        return self.mesh is not None and self.mesh.is_elastic

    @property
    def gives_geometric_stiffness(self) -> bool:
        """Whether geometric stiffness matrices of any modes are computed, from elements, materials and stiffness."""
        return self.has_stresses and self.stiffness is not None
