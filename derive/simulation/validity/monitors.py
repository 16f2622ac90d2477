"""The monitors of a beam in a run: a quantity, the error that it implies, and one limit of it.

`docs/monitors.md` derives the errors and has their measurements.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from math import inf, isnan
from typing import assert_never

from derive.enumerations import enumeration
from derive.percentages import implied_percent, percent
from derive.spec.model.body import DisplacementOrder

ERROR_LIMIT = 0.05
"""A run warns of all that implies a larger error: root mean square over the run, of the peak of the deflection."""


MOST_NAMED = 4
"""The largest number of further beams that a warning names."""


class Cause(Enum):
    """The monitored quantities; the values are the names in JSON.

    Deflection, over the length. Axial force: the stiffness that it adds or removes, over that in bending, which first
    order leaves out. Bending moment: the root mean square of the largest that the shapes miss of it, over that of the
    largest moment: too few shapes, or those of other ends. Mass matrix: the part of the kinetic energy of a
    velocity that deflections take away; a truncated one is indefinite where nothing is left. Lateral buckling: the part
    of the stiffness in the weaker plane that bending and twisting moments take away, which first order leaves out.
    Twisting moment: as the bending moment, in torsion; the error is that of the twist.
    """

    DEFLECTION = "deflection"
    AXIAL_FORCE = "axial_force"
    BENDING_MOMENT = "bending_moment"
    MASS_MATRIX = "mass_matrix"
    LATERAL = "lateral_buckling"
    TWISTING_MOMENT = "twisting_moment"


@dataclass(frozen=True)
class Monitor:
    """The largest value of a monitored quantity of a beam in a run.

    value: of what `Cause` says, without unit. error: what it implies, root mean square over the run, of the peak of the
    deflection. t: when it occurs, s. axis: the one of a beam in space along which it deflects, 0 in the plane; 1 of its
    twist.
    """

    beam: str
    pieces: int
    cause: Cause
    order: DisplacementOrder
    value: float
    error: float
    t: float
    axis: int = 0

    @property
    def passed(self) -> bool:
        """Whether the implied error is beyond the limit; what is not a number is."""
        return not self.error <= ERROR_LIMIT

    @property
    def data(self) -> dict[str, object]:
        """The monitor as plain data."""
        return {
            "beam": self.beam,
            "pieces": self.pieces,
            **({"axis": f"e{self.axis}"} if self.axis else {}),
            "quantity": self.cause.value,
            "value": self.value,
            "t": self.t,
            "error": self.error,
            "limit": ERROR_LIMIT,
            "passed": self.passed,
        }

    @property
    def warning(self) -> str:
        """The value, the implied error, the limit and the remedy, in one line."""
        return self.warning_with(())

    def warning_with(self, others: Sequence[Monitor]) -> str:
        """The warning, and the errors of other beams in which the same causes smaller ones."""
        name = f"{self._bent} in {self.pieces} beam{'s' if self.pieces > 1 else ''}"
        of_others = enumeration([f"{other._error} in {other._bent}" for other in others], MOST_NAMED)
        return (
            f"{name}: {_WHAT[self.cause].format(percent(self.value))} at t = {self.t:.6g} s; this implies an error of "
            f"{self._error} in its {self._wrong} (rms over the run, relative to the peak; the limit is "
            f"{percent(ERROR_LIMIT)}){', and of ' * bool(others)}{of_others}; {self.remedy}"
        )

    @property
    def _bent(self) -> str:
        """The beam, and in space the axis along which it deflects."""
        way = "about" if self.cause is Cause.TWISTING_MOMENT else "along"
        return f"{self.beam} {way} its e{self.axis}" if self.axis else self.beam

    @property
    def _wrong(self) -> str:
        return "twist" if self.cause is Cause.TWISTING_MOMENT else "deflection"

    @property
    def _error(self) -> str:
        return implied_percent(self.error)

    @property
    def remedy(self) -> str:
        """The change of the model that lets it meet the limit."""
        match self.cause:
            case Cause.DEFLECTION:
                return "divide the beam into more pieces" + (" of order = 2" if self._first else "")
            case Cause.AXIAL_FORCE:
                return "choose order = 2 and at least three shapes, or divide the beam into more pieces"
            case Cause.BENDING_MOMENT:
                return "add a shape, choose shapes that fit its ends, or divide the beam into more pieces"
            case Cause.MASS_MATRIX:
                return 'choose terms = "full", or divide the beam into more pieces'
            case Cause.LATERAL:
                return "choose order = 2"
            case Cause.TWISTING_MOMENT:
                return "add a shape of torsion, or divide the beam into more pieces"
        assert_never(self.cause)

    @property
    def _first(self) -> bool:
        return self.order is DisplacementOrder.FIRST_ORDER


_WHAT = {
    Cause.DEFLECTION: "it bends by {} of its length",
    Cause.AXIAL_FORCE: "its axial force changes its bending stiffness by {}, which a model of first order leaves out,",
    Cause.BENDING_MOMENT: "its shapes miss the bending moment by {} of the largest one",
    Cause.TWISTING_MOMENT: "its shapes miss the twisting moment by {} of the largest one",
    Cause.LATERAL: "its bending and twisting moments take away {} of its stiffness, which first order leaves out,",
    Cause.MASS_MATRIX: "its deflection reduces the kinetic energy of some velocity by {}",
}


def warnings(monitors: Sequence[Monitor]) -> tuple[str, ...]:
    """One line for all beams that pass a limit by the same cause and need the same remedy: the worst comes first."""
    alike: dict[tuple[Cause, int, str], list[Monitor]] = {}
    for monitor in monitors:
        if monitor.passed:
            alike.setdefault((monitor.cause, monitor.pieces, monitor.remedy), []).append(monitor)
    ordered = (sorted(group, key=_severity, reverse=True) for group in alike.values())
    return tuple(worst.warning_with(others) for worst, *others in ordered)


def _severity(monitor: Monitor) -> float:
    return inf if isnan(monitor.error) else monitor.error  # a motion that is not a number is the worst
