"""The truncated second-order motion of a body: T and V through second order in the amplitudes. Beyond the paper.

At second order the displacement is u = sum alpha_i Phi_i + 1/2 sum alpha_i alpha_j Psi_ij, so that

    r = X + u,   dr/dalpha_i = Phi_i + sum alpha_j Psi_ij,
    rdot = sum alphadot_i dr/dalpha_i,   rddot = sum alphaddot_i dr/dalpha_i + sum alphadot_i alphadot_j Psi_ij.

The virtual work of (15) is the same in terms of these fields; only their moments change. A moment keeps its terms
through second order in the amplitudes, their rates and their variations together, which is what T through second order
yields: the equations are those of a Lagrangian, M is symmetric, and energy and momenta are conserved. What is dropped
are the moments of Psi_ij with Phi_k and with Psi_kl; the model that keeps them is in `full_second_order`.

In the plane the axial moment c10_ij = int rho X x Psi_ij is a scalar, in space a vector. In space the moments of rddot
are two sums each, those of accelerations (d4ddot, d3ddot) and those of rates (c9dotdot, c10dotdot), because loops
compute what accelerations multiply apart from the rest.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from derive.mechanics.axes import AXES
from derive.mechanics.sums import ALPHA, ALPHADDOT, ALPHADOT, HALF_ALPHA, IndexedSum
from derive.mechanics.symbols import Family, I, J, quantity
from derive.roles import Source

SOURCE = Source.SECOND_ORDER
Axes = tuple[int, ...]
PLANE = (1, 2)
"""The axes of vectors in the plane; those in space have all AXES."""


def second_order_moment_sums(first_order: Iterable[IndexedSum], axes: Axes = PLANE) -> tuple[IndexedSum, ...]:
    """The moments of first order with the contributions of the Psi_ij, and d4_i = int rho dr/dalpha_i."""
    result: list[IndexedSum] = []
    for k in axes:
        c2_i, c9_ij = quantity(Family.C2, k, shapes=(I,)), quantity(Family.C9, k, shapes=(I, J))
        d4_i = quantity(Family.D4, k, shapes=(I,))
        result.append(IndexedSum(d4_i, c2_i, ((ALPHA, c9_ij),), "int rho dr/dalpha_{i}", SOURCE))
        if axes == PLANE:
            c9_i = quantity(Family.C9_SUM, k, shapes=(I,))
            result.append(IndexedSum(c9_i, None, ((ALPHA, c9_ij),), "int rho sum_j alpha_j Psi_{i}j", SOURCE))
    for k in axes if axes == AXES else ():
        c10a_i, c10_ij = quantity(Family.C10_AMPLITUDES, k, shapes=(I,)), quantity(Family.C10, k, shapes=(I, J))
        result.append(IndexedSum(c10a_i, None, ((ALPHA, c10_ij),), "int rho X x sum_j alpha_j Psi_{i}j", SOURCE))
    return (*result, *(_moment(s, axes) for s in first_order))


def _moment(of: IndexedSum, axes: Axes) -> IndexedSum:
    """A moment of first order with its terms of second order, if it has any."""
    known = of.symbol.identity
    match known.family, known.derivative:
        case Family.D1, 0 if axes == PLANE:  # straight-line code, where a sum that vanishes costs nothing
            c9_j = quantity(Family.C9_SUM, *known.components, shapes=(J,))
            return IndexedSum(of.symbol, of.offset, (*of.sums, (HALF_ALPHA, c9_j)), of.doc, SOURCE)
        case Family.D1, 0:
            c2_j, d4_j = (quantity(family, *known.components, shapes=(J,)) for family in (Family.C2, Family.D4))
            return IndexedSum(of.symbol, of.offset, ((HALF_ALPHA, c2_j), (HALF_ALPHA, d4_j)), of.doc, SOURCE)
        case Family.D1, 1:
            d4_j = quantity(Family.D4, *known.components, shapes=(J,))
            return IndexedSum(of.symbol, None, ((ALPHADOT, d4_j),), of.doc, SOURCE)
        case Family.D2, 0:
            c5_ij = quantity(Family.C5, shapes=(I, J))
            return IndexedSum(of.symbol, of.offset, ((ALPHA, c5_ij),), "int rho r . dr/dalpha_{i}", SOURCE)
        case Family.S, 0:
            return replace(of, doc="symmetric part of int rho ((r . t) I - r t), t = dr/dalpha_{i}", source=SOURCE)
        case Family.D3, 0:
            c10_ij = quantity(Family.C10, *known.components, shapes=(I, J))
            return IndexedSum(of.symbol, of.offset, (*of.sums, (ALPHA, c10_ij)), "int rho r x dr/dalpha_{i}", SOURCE)
        case Family.D3, 1 if axes == AXES:
            c10a_j = quantity(Family.C10_AMPLITUDES, *known.components, shapes=(J,))
            return IndexedSum(of.symbol, None, (*of.sums, (ALPHADOT, c10a_j)), of.doc, SOURCE)
    return of


def second_order_row_sums(first_order: Iterable[IndexedSum], axes: Axes = PLANE) -> tuple[IndexedSum, ...]:
    """The remaining sums of (15) with the contributions of the Psi_ij."""
    result: list[IndexedSum] = []
    for k in axes:
        c9_ij, c9dot_i = quantity(Family.C9, k, shapes=(I, J)), quantity(Family.C9_SUM, k, derivative=1, shapes=(I,))
        result.append(IndexedSum(c9dot_i, None, ((ALPHADOT, c9_ij),), "int rho sum_j alphadot_j Psi_{i}j", SOURCE))
    for components in ((),) if axes == PLANE else tuple((k,) for k in axes):
        c10_ij = quantity(Family.C10, *components, shapes=(I, J))
        c10dot_i = quantity(Family.C10_SUM, *components, derivative=1, shapes=(I,))
        doc = "int rho X x sum_j alphadot_j Psi_{i}j"
        result.append(IndexedSum(c10dot_i, None, ((ALPHADOT, c10_ij),), doc, SOURCE))
    for s in first_order:
        result += _row_sums(s, apart=axes == AXES)
    return tuple(result)


def _row_sums(of: IndexedSum, apart: bool) -> tuple[IndexedSum, ...]:
    """A sum with accelerations and the contribution of rates, in the same sum or, with `apart`, in a second one."""
    known = of.symbol.identity
    match known.family, known.derivative:
        case Family.D1, 2:
            d4_j = quantity(Family.D4, *known.components, shapes=(J,))
            symbol = quantity(Family.D4, *known.components, derivative=2) if apart else of.symbol
            accelerated, rates, total = (ALPHADDOT, d4_j), Family.C9_SUM, Family.C9_RATES
        case Family.D3, 2:
            ((factor, entry),) = of.sums
            symbol = of.symbol
            accelerated, rates, total = (factor, entry), Family.C10_SUM, Family.C10_RATES
        case _:
            return (of,)
    quadratic = (ALPHADOT, quantity(rates, *known.components, derivative=1, shapes=(J,)))
    if not apart:
        return (IndexedSum(of.symbol, None, (accelerated, quadratic), of.doc, SOURCE),)
    return (
        IndexedSum(symbol, None, (accelerated,), f"{of.doc} of accelerations", SOURCE),
        IndexedSum(quantity(total, *known.components), None, (quadratic,), f"{of.doc} of rates", SOURCE),
    )
