"""Cost model: predicts whether straight-line code or loops are faster, from the non-zeros of the tables of a body.

Straight lines cost by the entry that is there, loops by the entry that could be. Times are those of h, measured with
gcc 12 at -O3 -march=native on a server processor with AVX-512 (bench/scale.py measures them anew):

    straight line   0.075 ns an operation
    loops           27 ns, 1 ns for each shape, and 0.022 ns an operation, of which there are 2 for each entry (i, j)

The first serves to about 15 000 operations of h: from there on, derivation and compilers take minutes.
"""

from __future__ import annotations

from dataclasses import dataclass

from derive.errors import TisserandError
from derive.mechanics.body import Body
from derive.mechanics.symbols import Family
from derive.mechanics.tables import TableKind

MOST = 15_000
"""Operations of h in straight line that derivation and compilers still take in seconds."""


class CodeTooLong(TisserandError):
    """The specification requires straight-line code, which would be too long."""


@dataclass(frozen=True)
class CostEstimate:
    """The predicted evaluation times of h in nanoseconds, for both lowerings, and the faster lowering."""

    lowering: str
    flat: float
    table: float
    operations: int

    def taken(self, requested: str) -> str:
        """The lowering that is taken; `requested` is auto, flat or table. Raises CodeTooLong."""
        if requested == "flat" and self.operations > MOST:
            raise CodeTooLong(
                f"unrolled, the forces alone would take some {self.operations} operations, "
                f'and {MOST} is the most; use lowering = "table" or "auto", or fewer modes'
            )
        return self.lowering if requested == "auto" else requested

    def reason(self, requested: str) -> str:
        """A line of text that states the choice and the predicted times."""
        form = {"flat": "unrolled", "table": "looped"}[self.taken(requested)]
        why = "as the specification asks" if requested != "auto" else "the faster form"
        return f"{form}, {why}; predicted evaluation time of h: {self.flat:.0f} ns unrolled, {self.table:.0f} ns looped"


def choose(body: Body) -> CostEstimate:
    """The faster form for a body in space."""
    tables, modes = body.tables, body.modes
    operations = straight_operations(body)
    full = sum(
        len(t.components) for t in tables if t.kind is TableKind.FULL and t.counted == 2 and t.family is not Family.C8
    )
    flat, table = 0.075 * operations, 27 + modes + 0.022 * 2 * full * modes**2
    return CostEstimate("table" if table < flat or operations > MOST else "flat", flat, table, operations)


def straight_operations(body: Body) -> int:
    """About how many operations h takes in straight line: see tests/kernel/test_choice.py.

    Two for each entry (i, j) and each component of C4; five for each component of an S_i that is there (J, Sdot and
    h_i), four for c7dot_i and c2_i, two for c6_i; and those of the rigid motion.
    """
    present = {table.family: body.values.present(table) for table in body.tables if table.counted}
    pairs = sum(int(present[name].sum()) for name in (Family.C5, Family.C7, Family.STIFFNESS, Family.DAMPING))
    s = present[Family.C4] | present[Family.C5].any(axis=1)
    c7dot = present[Family.C7].any(axis=1)
    c2, c4, c6 = (int(present[family].sum()) for family in (Family.C2, Family.C4, Family.C6))
    vectors = 4 * (int(c7dot.sum()) + c2) + 2 * (c6 + c4)
    return 2 * pairs + 5 * int(s.sum()) + vectors + (150 if present[Family.C2].any() else 60)
