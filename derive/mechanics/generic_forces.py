"""The forces on a generic amplitude alpha_i besides inertia and gravity: terms, sums over the modes, and energies."""

from __future__ import annotations

from collections.abc import Container
from dataclasses import dataclass, field

from derive.algebra import sp, zero
from derive.mechanics.sums import ALPHA, ALPHADDOT, ALPHADOT, IndexedSum
from derive.mechanics.symbols import Family, I, J, quantity
from derive.mechanics.terms import Term
from derive.roles import Source

SHAPE_ROW = "alpha_i"
"""The name of the row of a generic shape."""


@dataclass(frozen=True)
class GenericForce:
    """The force that a table makes on a generic amplitude: its term on the left-hand side, with the sums in it.

    kinetic, strain: its contributions to the energies.
    """

    family: Family
    term: Term
    sums: tuple[IndexedSum, ...]
    kinetic: sp.Expr = field(default_factory=zero)
    strain: sp.Expr = field(default_factory=zero)


ROTARY, ROTARY_RATE = (quantity(Family.ROTARY_MOMENT, shapes=(I,), derivative=d) for d in (2, 1))
ROTARY_PRODUCT = quantity(Family.ROTARY_PRODUCT)
ELASTIC, DAMPING = (quantity(family, shapes=(I,)) for family in (Family.ELASTIC, Family.DAMPING_FORCE))
STRAIN, PRELOAD_WORK = quantity(Family.STRAIN), quantity(Family.PRELOAD_WORK)
_R, _K, _B = (quantity(family, shapes=(I, J)) for family in (Family.ROTARY, Family.STIFFNESS, Family.DAMPING))
_ROTARY_RATE_J = quantity(Family.ROTARY_MOMENT, shapes=(J,), derivative=1)
_ELASTIC_J = quantity(Family.ELASTIC, shapes=(J,))
_N_I, _N_J = (quantity(Family.PRELOAD, shapes=(index,)) for index in (I, J))

DAMPING_TERM = Term(SHAPE_ROW, "damping", "(13)", DAMPING)

FORCES = (
    GenericForce(
        Family.ROTARY,
        Term(SHAPE_ROW, "rotary", "(10)", ROTARY),
        (
            IndexedSum(ROTARY, None, ((ALPHADDOT, _R),), "moment of the rotary inertia"),
            IndexedSum(ROTARY_RATE, None, ((ALPHADOT, _R),), "momentum of the rotary inertia"),
            IndexedSum(ROTARY_PRODUCT, None, ((ALPHADOT, _ROTARY_RATE_J),), "twice the energy of the rotary inertia"),
        ),
        kinetic=ROTARY_PRODUCT / 2,
    ),
    GenericForce(
        Family.STIFFNESS,
        Term(SHAPE_ROW, "elastic", "(13), (22)", ELASTIC),
        (
            IndexedSum(ELASTIC, None, ((ALPHA, _K),), "gradient of the strain energy"),
            IndexedSum(STRAIN, None, ((ALPHA, _ELASTIC_J),), "twice the strain energy"),
        ),
        strain=STRAIN / 2,
    ),
    GenericForce(
        Family.PRELOAD,
        Term(SHAPE_ROW, "preload", Source.STRETCHING, _N_I),
        (IndexedSum(PRELOAD_WORK, None, ((ALPHA, _N_J),), "work of forces at rest"),),
        strain=PRELOAD_WORK,
    ),
    GenericForce(
        Family.DAMPING,
        DAMPING_TERM,
        (IndexedSum(DAMPING, None, ((ALPHADOT, _B),), "damping force"),),
    ),
)
"""The forces in the order of their terms."""


def generic_forces(families: Container[Family]) -> tuple[GenericForce, ...]:
    """The forces of the tables of these families."""
    return tuple(force for force in FORCES if force.family in families)
