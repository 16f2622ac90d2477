"""The static response of a body of which some displacements are held."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.linalg import splu

from derive.reduction.mesh_stiffening import Response


def clamped_response(stiffness: csr_array, fixed: np.ndarray) -> Response:
    """The response of a body with some displacements held; loads on these have no effect."""
    moving = np.setdiff1d(np.arange(stiffness.shape[0]), fixed)
    factors = splu(stiffness[moving][:, moving].tocsc())

    def respond(loads: np.ndarray, *_: np.ndarray) -> np.ndarray:
        result = np.zeros_like(loads)
        result[:, moving] = factors.solve(loads[:, moving].T).T
        return result

    return respond
