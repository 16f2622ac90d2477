"""Cost model: predicts whether straight-line code or loops are faster, from the non-zeros of the integrals of a body.

The cost of straight-line code is proportional to the number of non-zeros, that of loops to the number of all entries.
The times are those of h, measured with gcc 12 at -O3 -march=x86-64-v3 on a server processor; bench/loops_by_hand.py
measures both forms:

    straight-line code   0.092 ns for each operation
    loops                22 ns, 1 ns for each mode, and 0.0235 ns for each operation, with 2 operations for each (i, j)

Straight-line code is limited to about 15 000 operations of h, beyond which derivation and compilation take minutes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from derive.errors import TisserandError
from derive.mechanics.body import Body
from derive.mechanics.symbols import Family
from derive.mechanics.tables import TableKind

MAX_FLAT_OPERATIONS = 15_000
"""The largest number of operations of h in straight-line code, whose derivation and compilation take seconds."""


class CodeTooLong(TisserandError):
    """The specification requires straight-line code, but that code would be too long."""


@dataclass(frozen=True)
class CostEstimate:
    """The predicted evaluation times (ns) of h in both lowerings.

    lowering: "flat" (straight-line code) or "loops" (loops), whichever is faster. operations: those of h if "flat".
    """

    lowering: str
    flat: float
    loops: float
    operations: int

    def selected(self, requested: str) -> str:
        """The lowering to use; `requested` is "auto", "flat" or "loops". Raises CodeTooLong."""
        if requested == "flat" and self.operations > MAX_FLAT_OPERATIONS:
            raise CodeTooLong(
                f"unrolled, the forces alone would take some {self.operations} operations, "
                f'and the limit is {MAX_FLAT_OPERATIONS}; use lowering = "loops" or "auto", or fewer modes'
            )
        return self.lowering if requested == "auto" else requested

    def reason(self, requested: str) -> str:
        """The selected lowering, the reason for it, and the predicted times as a line of text. Raises CodeTooLong."""
        form = {"flat": "unrolled", "loops": "looped"}[self.selected(requested)]
        why = "as the specification asks" if requested != "auto" else "the faster form"
        return f"{form}, {why}; predicted evaluation time of h: {self.flat:.0f} ns unrolled, {self.loops:.0f} ns looped"


def estimate_costs(body: Body) -> CostEstimate:
    """The predicted costs of both lowerings of a spatial body."""
    tables, modes = body.tables, body.modes
    operations = flat_operations(body)
    full = sum(
        len(t.components) for t in tables if t.kind is TableKind.FULL and t.counted == 2 and t.family is not Family.C8
    )
    flat, loops = 0.092 * operations, 22 + modes + 0.0235 * 2 * full * modes**2
    return CostEstimate(
        "loops" if loops < flat or operations > MAX_FLAT_OPERATIONS else "flat", flat, loops, operations
    )


def flat_operations(body: Body) -> int:
    """The approximate number of operations of h in straight-line code; tests/kernel/test_cost_model.py compares it.

    Each non-zero contributes: 2 operations for an entry (i, j) or a component of C4, 5 for a component of S_i (in J,
    Sdot and h_i), 4 for one of c7dot_i or c2_i, and 2 for one of c6_i. Each entry (i, j), i <= j, of c9 and c10
    contributes 6. The rigid motion adds a constant.
    """
    present = {table.family: body.values.present(table) for table in body.tables if table.counted}
    pairs = sum(int(present[name].sum()) for name in (Family.C5, Family.C7, Family.STIFFNESS, Family.DAMPING))
    s = present[Family.C4] | present[Family.C5].any(axis=1)
    c7dot = present[Family.C7].any(axis=1)
    c2, c4, c6 = (int(present[family].sum()) for family in (Family.C2, Family.C4, Family.C6))
    vectors = 4 * (int(c7dot.sum()) + c2) + 2 * (c6 + c4)
    upper = np.triu_indices(body.modes)
    second_order = sum(int(present[f][upper].sum()) for f in (Family.C9, Family.C10) if f in present)
    return 6 * second_order + 2 * pairs + 5 * int(s.sum()) + vectors + (135 if present[Family.C2].any() else 45)
