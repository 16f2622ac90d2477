"""The truncated second-order motion of a planar body: T and V through second order in the amplitudes. Beyond the paper.

At second order the displacement is u = sum alpha_i Phi_i + 1/2 sum alpha_i alpha_j Psi_ij, so that

    r = X + u,   dr/dalpha_i = Phi_i + sum alpha_j Psi_ij,
    rdot = sum alphadot_i dr/dalpha_i,   rddot = sum alphaddot_i dr/dalpha_i + sum alphadot_i alphadot_j Psi_ij.

The virtual work of (15) is the same in terms of these fields; only their moments change. A moment keeps its terms
through second order in the amplitudes, their rates and their variations together, which is what T through second order
yields: the equations are those of a Lagrangian, M is symmetric, and energy and momenta are conserved. What is dropped
are the moments of Psi_ij with Phi_k and with Psi_kl; the model that keeps them is in `full_second_order`.
"""

from __future__ import annotations

from collections.abc import Iterable

from derive.mechanics.sums import ALPHA, ALPHADDOT, ALPHADOT, HALF_ALPHA, IndexedSum
from derive.mechanics.symbols import Family, I, J, quantity
from derive.roles import Source

AXES = (1, 2)
SOURCE = Source.SECOND_ORDER


def second_order_moment_sums(first_order: Iterable[IndexedSum]) -> tuple[IndexedSum, ...]:
    """Those of first order with what the Psi_ij add to them, and d4_i = int rho dr/dalpha_i."""
    result: list[IndexedSum] = []
    for k in AXES:
        c2_i, c9_ij = quantity(Family.C2, k, shapes=(I,)), quantity(Family.C9, k, shapes=(I, J))
        c9_i, d4_i = (quantity(family, k, shapes=(I,)) for family in (Family.C9_SUM, Family.D4))
        result.append(IndexedSum(c9_i, None, ((ALPHA, c9_ij),), "int rho sum_j alpha_j Psi_{i}j", SOURCE))
        result.append(IndexedSum(d4_i, c2_i, ((ALPHA, c9_ij),), "int rho dr/dalpha_{i}", SOURCE))
    return (*result, *(_moment(s) for s in first_order))


def _moment(of: IndexedSum) -> IndexedSum:
    """A moment of first order with its terms of second order, if it has any."""
    known = of.symbol.identity
    match known.family, known.derivative:
        case Family.D1, 0:
            c9_j = quantity(Family.C9_SUM, *known.components, shapes=(J,))
            return IndexedSum(of.symbol, of.offset, (*of.sums, (HALF_ALPHA, c9_j)), of.doc, SOURCE)
        case Family.D1, 1:
            d4_j = quantity(Family.D4, *known.components, shapes=(J,))
            return IndexedSum(of.symbol, None, ((ALPHADOT, d4_j),), of.doc, SOURCE)
        case Family.D2, 0:
            c5_ij = quantity(Family.C5, shapes=(I, J))
            return IndexedSum(of.symbol, of.offset, ((ALPHA, c5_ij),), "int rho r . dr/dalpha_{i}", SOURCE)
        case Family.D3, 0:
            c10_ij = quantity(Family.C10, shapes=(I, J))
            return IndexedSum(of.symbol, of.offset, (*of.sums, (ALPHA, c10_ij)), "int rho r x dr/dalpha_{i}", SOURCE)
    return of


def second_order_row_sums(first_order: Iterable[IndexedSum]) -> tuple[IndexedSum, ...]:
    """The remaining sums of (15) with what the Psi_ij add to them."""
    result: list[IndexedSum] = []
    for k in AXES:
        c9_ij, c9dot_i = quantity(Family.C9, k, shapes=(I, J)), quantity(Family.C9_SUM, k, derivative=1, shapes=(I,))
        result.append(IndexedSum(c9dot_i, None, ((ALPHADOT, c9_ij),), "int rho sum_j alphadot_j Psi_{i}j", SOURCE))
    c10_ij, c10dot_i = quantity(Family.C10, shapes=(I, J)), quantity(Family.C10_SUM, derivative=1, shapes=(I,))
    result.append(IndexedSum(c10dot_i, None, ((ALPHADOT, c10_ij),), "int rho X x sum_j alphadot_j Psi_{i}j", SOURCE))
    return (*result, *(_row_sum(s) for s in first_order))


def _row_sum(of: IndexedSum) -> IndexedSum:
    known = of.symbol.identity
    match known.family, known.derivative:
        case Family.D1, 2:
            d4_j = quantity(Family.D4, *known.components, shapes=(J,))
            c9dot_j = quantity(Family.C9_SUM, *known.components, derivative=1, shapes=(J,))
            return IndexedSum(of.symbol, None, ((ALPHADDOT, d4_j), (ALPHADOT, c9dot_j)), of.doc, SOURCE)
        case Family.D3, 2:
            c10dot_j = quantity(Family.C10_SUM, derivative=1, shapes=(J,))
            return IndexedSum(of.symbol, None, (*of.sums, (ALPHADOT, c10dot_j)), of.doc, SOURCE)
    return of
