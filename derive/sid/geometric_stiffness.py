"""The geometric stiffness of a SID: the matrices that a text contains, and their integrals of second order.

See `derive.reduction.second_order` for what the matrices mean and for their signs. Ct has K0t as its first order, that
of Cr is K0r - c7, and K0omega is added to that of Oe, from which it need not be separated: J and the centrifugal forces
need the sum, which is C5 of a body of second order. The first order of phi of a node is -K0F.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from derive.mechanics.bodies.modal_body import ModalPoint
from derive.reduction.integrals import OMEGA_PRODUCTS, omega_tensors
from derive.sid.mapping import AGREEMENT, INERTIA_COLUMN, Array, Matrices, closest_symmetric


def given_stiffening(matrices: Matrices, points: tuple[ModalPoint, ...]) -> tuple[str, ...]:
    """The names of the matrices among K0t, K0r, K0omega and K0F that a text contains."""
    size = float(np.abs(matrices["Me"].m0).max(initial=0.0))
    ct, cr = matrices["Ct"].m1, matrices["Cr"].m1
    c5 = first_order_of_oe(matrices, OMEGA_PRODUCTS)
    even = np.zeros(1) if cr is None else (cr + np.swapaxes(cr, 0, 1)) / 2
    trace = np.zeros(1) if c5 is None else np.trace(c5, axis1=-2, axis2=-1) - 2 * matrices["Me"].m0
    contained = {
        "K0t": ct is not None and bool(np.any(ct)),
        "K0r": bool(np.abs(even).max(initial=0.0) > AGREEMENT * size),
        "K0omega": bool(np.abs(trace).max(initial=0.0) > AGREEMENT * size),
        "K0F": any(point.second is not None and np.any(point.second) for point in points),
    }
    return tuple(name for name, there in contained.items() if there)


def header_stiffening(first: str) -> bool | None:
    """Whether the first line of a text states that there is geometric stiffness; None if it does not state it."""
    match = re.search(r"\bGeo_Stiff *= *(yes|no)\b", first, re.ASCII | re.IGNORECASE)
    return match[1].lower() == "yes" if match else None


def without_forces(points: tuple[ModalPoint, ...]) -> Iterator[str]:
    """A line of text about the nodes of a body of second order that have no K0F."""
    missing = [point.name for point in points if point.second is None]
    if missing:
        names = ", ".join(missing[:4]) + (f" and {len(missing) - 4} more" if len(missing) > 4 else "")
        yield f"1: there is no K0F (first order of phi) of {names}: these points move to first order in the amplitudes"


def of_one_order(points: tuple[ModalPoint, ...], second_order: bool) -> tuple[ModalPoint, ...]:
    """The points of a body, all of second order (zeros for those without K0F) or all of first order."""

    def second(point: ModalPoint) -> Array:
        n = len(point.shapes)
        return np.zeros((n, n, 3)) if point.second is None else point.second

    return tuple(replace(point, second=second(point) if second_order else None) for point in points)


def rotational_stiffness(first: Array | None, c7: Array) -> Array:
    """The integral c10 (N, N, 3), which is K0r, from the first order of Cr."""
    return np.zeros(c7.shape) if first is None else closest_symmetric(first, -c7)


def omega_products(oe: Array, s4: Array, size: float) -> tuple[tuple[int, int], ...]:
    """The order of the products in Omega: some programs write w1 w3 before w2 w3, which a comparison with Gr shows."""
    for products in (OMEGA_PRODUCTS, INERTIA_COLUMN):
        if np.abs(omega_tensors(oe, products) - s4).max(initial=0.0) <= AGREEMENT * size:
            return products
    return OMEGA_PRODUCTS


def first_order_of_oe(matrices: Matrices, products: tuple[tuple[int, int], ...]) -> Array | None:
    """The symmetric parts (N, N, 3, 3) of C5 from the first order of Oe, or else of Gr; None if neither has one."""
    n = len(matrices["Me"].m0)
    if matrices["Oe"].m1 is not None:
        return omega_tensors(matrices["Oe"].m1, products)
    if matrices["Gr"].m1 is not None:
        c5 = matrices["Gr"].m1.reshape(3, n, n, 3).transpose(2, 1, 0, 3) / 2
        return np.asarray((c5 + np.swapaxes(c5, -1, -2)) / 2)
    return np.zeros((0, 0, 3, 3)) if n == 0 else None
