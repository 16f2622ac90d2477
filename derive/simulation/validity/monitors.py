"""What is monitored of a beam in a run: the quantity, its limit with a reason, and the error that it implies.

Limits are where the implied error of deflections or frequencies is 3 to 5 %; `docs/theory.md` has the measurements.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from derive.spec.model.body import DisplacementOrder

FIRST, TRUNCATED, FULL = DisplacementOrder.FIRST_ORDER, DisplacementOrder.TRUNCATED, DisplacementOrder.FULL


class Cause(Enum):
    """What is monitored; the values are the names in JSON."""

    DEFLECTION = "deflection"
    SPIN = "spin"
    AXIAL_FORCE = "axial_force"
    HIGHEST_SHAPE = "highest_shape"
    END_MOMENT = "end_moment"
    MASS_MATRIX = "mass_matrix"


LIMITS: dict[tuple[Cause, DisplacementOrder], float] = {
    **{(Cause.DEFLECTION, order): 0.1 for order in DisplacementOrder},
    (Cause.SPIN, FIRST): 0.2,
    (Cause.AXIAL_FORCE, FIRST): 0.06,
    **{(Cause.END_MOMENT, order): 0.2 for order in DisplacementOrder},
    (Cause.MASS_MATRIX, TRUNCATED): 0.05,
}
"""The limits of the monitored quantities; a quantity without a limit is reported, and is no cause for a warning.

Deflection, of the length: the curvature is linear in it, and at first order so is the position. Spin, of the lowest
frequency, and axial force, of the load under which the beam buckles: what first order leaves out of the stiffness. End
moment, of the largest moment: too few shapes, or those of other ends. Mass matrix: the part of the kinetic energy of
a velocity that deflections take away; the truncated one is indefinite where nothing is left. The share of the highest
shape in the strain energy has no limit, since it does not tell how much the shapes beyond it would have.
"""


@dataclass(frozen=True)
class Monitor:
    """The largest value of a monitored quantity of a beam in a run.

    value, limit: of what `LIMITS` says, without unit; the limit is None where the quantity does no harm. error: an
    estimate of the relative error of deflections or frequencies that the value implies. t: when it occurs, s. piece:
    the piece of the beam, or the beam itself.
    """

    beam: str
    pieces: int
    cause: Cause
    order: DisplacementOrder
    value: float
    error: float
    t: float
    piece: str

    @property
    def limit(self) -> float | None:
        """The limit for a beam of this order."""
        return LIMITS.get((self.cause, self.order))

    @property
    def passed(self) -> bool:
        """Whether the value is beyond the limit; what is not a number is."""
        return self.limit is not None and not self.value <= self.limit

    @property
    def data(self) -> dict[str, object]:
        """The monitor as plain data."""
        return {
            "beam": self.beam,
            "pieces": self.pieces,
            "piece": self.piece,
            "quantity": self.cause.value,
            "value": self.value,
            "limit": self.limit,
            "error": self.error,
            "t": self.t,
            "passed": self.passed,
        }

    @property
    def warning(self) -> str:
        """The value, the limit, the implied error and the remedy, in one line."""
        name = f"{self.beam} in {self.pieces} beam{'s' if self.pieces > 1 else ''}"
        return (
            f"{name}: {_WHAT[self.cause].format(percent(self.value))} at t = {self.t:.6g} s, beyond the limit of "
            f"{percent(self.limit or 0.0)}: {self._consequence}; {self._remedy}"
        )

    @property
    def _consequence(self) -> str:
        if not self.error < 1:
            return "the motion has an error of 100 % or more"
        return f"deflections have an error of about {percent(self.error)}"

    @property
    def _remedy(self) -> str:
        if self.cause is Cause.MASS_MATRIX:
            return 'choose terms = "full", or the mean frame'
        if self.cause is Cause.END_MOMENT:
            return "add a shape, choose shapes that fit its ends, or divide the beam into more pieces"
        if self.order is FIRST and self.cause is not Cause.DEFLECTION:
            return "choose order = 2 and at least three shapes, or divide the beam into more pieces"
        return "divide the beam into more pieces"


_WHAT = {
    Cause.DEFLECTION: "it bends by {} of the length of a beam",
    Cause.SPIN: "its spin is {} of its lowest frequency",
    Cause.AXIAL_FORCE: "its axial force is {} of the load under which it buckles",
    Cause.HIGHEST_SHAPE: "its highest shape has {} of the strain energy",
    Cause.END_MOMENT: "its shapes miss the bending moment at an end, or between pieces, by {} of the largest one",
    Cause.MASS_MATRIX: "deflections take away {} of the kinetic energy of a velocity",
}


def percent(value: float) -> str:
    """A ratio as text, to two digits."""
    return f"{value * 100:.2g} %" if value < 0.995 else f"{value * 100:.0f} %"
