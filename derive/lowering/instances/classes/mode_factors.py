"""Factors in G of the modes of a body as sums of its constants, with coefficients that all modes share.

A marker moves with mode j by Phi_j, and turns by Theta_j: constants, three for each mode. Whatever the joint and the
motion are, all that varies are their coefficients, which all modes share. A row of G for many modes is thus known from
few numbers, and G c8^-1 G^T from the constants Phi c8^-1 Phi^T.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from derive.algebra import sp
from derive.mechanics.axes import SPACE
from derive.mechanics.symbols import Identity, identity

FEWEST_MODES = 6
"""The number of modes from which on their coefficients take less than their factors."""
AXES = SPACE
"""The most constants of a mode with coefficients in one row."""


def constants_of_modes(coefficients: Iterable[sp.Symbol]) -> dict[sp.Symbol, Identity]:
    """The constants that modes have one each of, with what they are, whatever the mode and the body."""
    result = {}
    for symbol in coefficients:
        of = identity(symbol)
        if len(of.shapes) == 1 and of.point:
            result[symbol] = Identity(of.family, (), of.components, of.derivative, "", of.point)
    return result


def mode_coefficients(
    factors: Mapping[int, sp.Expr], constants: Mapping[sp.Symbol, Identity]
) -> dict[Identity, sp.Expr] | None:
    """The coefficients of the constants in the factors of modes, by the numbers of these; None if they differ.

    They also have to be the same for all modes, and fewer than these.
    """
    result: dict[Identity, sp.Expr] = {}
    for factor in factors.values():
        own = sorted(factor.free_symbols & constants.keys(), key=str)
        if not own or factor.xreplace(dict.fromkeys(own, sp.S.Zero)) != 0:
            return None
        for symbol in own:
            coefficient = factor.diff(symbol)
            if coefficient.free_symbols & constants.keys():
                return None
            if result.setdefault(constants[symbol], coefficient) != coefficient:
                return None
    return result if len(factors) >= FEWEST_MODES and len(result) <= AXES else None
