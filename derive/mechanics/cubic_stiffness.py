"""The part of the strain energy that is of third order in the amplitudes: sum K3_ijk alpha_i alpha_j alpha_k.

A beam in space has it where its two bending stiffnesses differ: bending in both planes twists it.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from math import prod
from typing import TYPE_CHECKING

from derive.algebra import sp
from derive.mechanics.symbols import Family
from derive.mechanics.terms import ModelConstant, Term
from derive.roles import Source

if TYPE_CHECKING:
    from derive.mechanics.motion.body_motion import Motion


def cubic_energy(constants: Iterable[ModelConstant], motion: Motion) -> sp.Expr:
    """The strain energy of third order, J; zero for a body without it."""
    own = (c.symbol for c in constants if c.symbol.identity.family is Family.CUBIC_STIFFNESS)
    return sp.Add(*(entry * prod(motion.alpha[i - 1] for i in entry.identity.shapes) for entry in own))


def cubic_terms(constants: Iterable[ModelConstant], motion: Motion) -> Iterator[Term]:
    """The forces on the amplitudes of the strain energy of third order."""
    energy = cubic_energy(constants, motion)
    for alpha in motion.alpha if energy != 0 else ():
        force = sp.diff(energy, alpha)
        if force != 0:
            yield Term(alpha.name, "elastic, third order", Source.SECOND_ORDER, sp.expand(force))
