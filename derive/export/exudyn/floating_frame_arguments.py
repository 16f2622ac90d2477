"""The shape integrals of a body in space as the arguments of ObjectFFRFreducedOrder of Exudyn."""

from __future__ import annotations

import numpy as np

from derive.mechanics.bodies.modal_body import Array, ModalBody


def floating_frame_arguments(body: ModalBody) -> dict[str, Array]:
    """The arguments of ObjectFFRFreducedOrder that a body of first order with N modes determines, by their names.

    With a~ b = a x b, Exudyn has the integrals of X~^T Phi_i = -X x Phi_i, of X~^T Phi_i~ = (X . Phi_i) I - Phi_i X,
    and of the same with Phi_j in place of X, as blocks of matrices. The nodes of its mode basis are the points.
    """
    n = body.modes
    return {
        "mass": np.array(body.mass),
        "centerOfMass": body.c1 / body.mass,
        "inertia": body.C3,
        "massMatrixReduced": body.c8,
        "stiffnessMatrixReduced": body.stiffness,
        "dampingMatrixReduced": body.damping,
        "mPhitTPsi": body.c2.T,
        "mPhitTPsiTilde": np.hstack([_skew(c2) for c2 in body.c2]),
        "mXRefTildePsi": -body.c6.T,
        "mXRefTildePsiTilde": np.hstack(list(body.C4)),
        "mPsiTildePsi": -body.c7.transpose(0, 2, 1).reshape(3 * n, n),
        "mPsiTildePsiTilde": body.C5.transpose(1, 2, 0, 3).reshape(3 * n, 3 * n),
        "referencePositions": np.array([point.position for point in body.points]).reshape(-1),
        "modeBasis": np.array([point.shapes.T for point in body.points]).reshape(-1, n),
    }


def _skew(a: Array) -> Array:
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])
