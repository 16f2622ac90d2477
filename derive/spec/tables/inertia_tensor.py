"""The check of tensors of inertia: there is a distribution of mass that has them."""

from __future__ import annotations

from derive.spec.model.quantity import Parameter, Quantity
from derive.spec.parsing.values import WrongValueError


def check_tensor(inertia: tuple[Quantity, ...]) -> None:
    """Refuse a tensor of inertia that no distribution of mass has, if its entries are numbers."""
    if any(isinstance(entry, Parameter) for entry in inertia):
        return
    xx, yy, zz, xy, xz, yz = (float(entry) for entry in inertia if not isinstance(entry, Parameter))
    a, b, c = principal_moments(xx, yy, zz, xy, xz, yz)
    text = f"no body has this tensor of inertia: its principal moments are {a:.6g}, {b:.6g}, {c:.6g} kg m^2"
    size = max(abs(a), abs(b), abs(c))
    if a < -ROUNDING * size or size == 0.0:
        raise WrongValueError(f"{text}, and they are positive")
    if c > (a + b) * (1 + ROUNDING):
        raise WrongValueError(f"{text}, and the largest is at most the sum of the other two")


ROUNDING = 1e-9
"""The part of the principal moments by which they may violate an inequality, since entries are rounded."""


def principal_moments(xx: float, yy: float, zz: float, xy: float, xz: float, yz: float) -> tuple[float, float, float]:
    """The eigenvalues of a symmetric tensor, from the least to the largest, by Jacobi rotations."""
    import numpy as np  # not for specifications that have no tensors

    moments = np.linalg.eigvalsh(np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]))
    return float(moments[0]), float(moments[1]), float(moments[2])
