"""The error of the reference of a search: its differences from coarser models, and what follows from them."""

from __future__ import annotations

from dataclasses import dataclass

from derive.spec.model.plots import Plot
from derive.study.accuracy.ladder_model import LadderModel

SHARE = 1 / 3
"""The largest difference of a reference from coarser models relative to the requested error."""
ROOM = 2 / 3
"""The largest error of a reference relative to the requested error: the models need the rest."""


@dataclass(frozen=True)
class Agreement:
    """The difference of the reference from a coarser model, rms over the peak, in the direction that `label` names.

    factor: the error of the reference in this direction over the difference: below 1 where fewer beams differ.
    """

    label: str
    difference: float
    factor: float = 1.0

    @property
    def error(self) -> float:
        """The error of the reference in this direction."""
        return self.factor * self.difference

    @property
    def decisive(self) -> float:
        """The difference of models with as many beams as the reference, which decides on a finer one."""
        return min(1.0, self.factor) * self.difference


@dataclass(frozen=True)
class TrustedReference:
    """Plots with the curves of the finest model, and how far coarser models differ from it; `model` is that model.

    agreements: with fewer beams, fewer shapes, nothing truncated, beams that are rigid here, and larger steps.
    truncation: the change by truncation in models with one beam. errors: those of the models that have run, rms over
    the peak, in the order in which they did.
    """

    plots: tuple[Plot, ...]
    model: LadderModel
    agreements: tuple[Agreement, ...]
    errors: tuple[tuple[LadderModel, float], ...] = ()
    truncation: float = 0.0

    @property
    def difference(self) -> float:
        """The largest of the differences, which decides on a finer reference."""
        return max(a.decisive for a in self.agreements)

    @property
    def error(self) -> float:
        """The sum of the errors, which may point the same way: a chosen model has to leave room for it."""
        return sum(a.error for a in self.agreements)

    def suffices(self, error: float) -> bool:
        """Whether the reference is good enough for a requested error."""
        return self.difference <= SHARE * error and self.error <= ROOM * error
