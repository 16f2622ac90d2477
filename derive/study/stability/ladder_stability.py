"""The stability of all models of a ladder over a parameter, beside the truth: a known value, or the richest model."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from derive.display import html
from derive.enumerations import enumeration
from derive.remaining_time import RemainingTime
from derive.short_text import counted, summary
from derive.simulation.errors import SimulationError
from derive.study.accuracy.models import LadderModel, refinements
from derive.study.stability.model_path import ModelPath, model_path
from derive.study.stability.parameter import ParameterRange, StudiedParameter
from derive.study.stability.thresholds import Interval, wrong_intervals

CONVERGED = 0.05
"""The reference has converged if the verdicts of both richest models differ over less than this part of a threshold."""


@dataclass(frozen=True)
class KnownLoss:
    """The known value at which stability is lost; None if it is never lost."""

    value: float | None


@dataclass(frozen=True, eq=False)
class LadderStability:
    """The models of a ladder of `name` over a parameter.

    reference: the richest model. before: the next coarser one, whose difference is the error of the reference. known:
    the value that a user gives. motion: the text on the motion about which the models are linearised.
    """

    name: str
    range: ParameterRange
    paths: tuple[ModelPath, ...]
    reference: ModelPath
    before: ModelPath
    known: KnownLoss | None = None
    motion: str = ""

    @property
    def unit(self) -> str:
        """The unit of the parameter; empty if it is not known."""
        return self.reference.unit

    @property
    def error(self) -> float | None:
        """The difference of the losses of the two richest models; None if one of them loses no stability."""
        a, b = self.reference.loss, self.before.loss
        return None if a is None or b is None else abs(a - b)

    @property
    def converged(self) -> bool:
        """Whether the truth is known: given, or both richest models have the same verdicts, up to small distances."""
        if self.known is not None:
            return True
        both = (self.reference, self.before)
        if any(path.failure or path.gaps for path in both) or (self.reference.loss is None) != (
            self.before.loss is None
        ):
            return False
        largest = max((abs(c.value) for path in both for c in path.thresholds), default=0.0)
        return not wrong_intervals(self.before.intervals, self.reference.intervals, CONVERGED * largest)

    @property
    def truth(self) -> tuple[Interval, ...]:
        """The intervals in which the truth is stable or not: from the known value, or those of the richest model."""
        if self.known is None:
            return self.reference.intervals
        low, high, at = self.range.low, self.range.high, self.known.value
        if at is None or at >= high:
            return (Interval(low, high, True),)
        if at <= low:
            return (Interval(low, high, False),)
        return Interval(low, at, True), Interval(at, high, False)

    @property
    def true_loss(self) -> float | None:
        """The value at which the truth loses its stability; None if it does not."""
        return self.reference.loss if self.known is None else self.known.value

    def wrong(self, path: ModelPath) -> tuple[Interval, ...]:
        """The intervals where a model is stable and the truth is not, or vice versa, beyond the error of the reference.

        Nothing is wrong while the truth is not known: then the verdict is undecided.
        """
        if not self.converged:
            return ()
        return wrong_intervals(path.intervals, self.truth, 0.0 if self.known else self.error or 0.0)

    def __repr__(self) -> str:
        return summary(f"LadderStability of {self.name}: {counted(len(self.paths), 'model')}", {"about": self.motion})

    _repr_html_ = html


def distance(value: float | None, truth: float | None) -> float | None:
    """The relative distance of a threshold from the true one; None if one of them is missing, or the true one is 0."""
    return None if value is None or not truth else (value - truth) / abs(truth)


def ladder_stability(
    name: str,
    parameter: StudiedParameter,
    models: Sequence[LadderModel],
    known: KnownLoss | None,
    progress: Callable[[str], None],
) -> LadderStability:
    """The stability of the models of a ladder, and of the two richest models. Raises CompilerError, SimulationError."""
    if changing := parameter.functions.changing:
        raise SimulationError(
            f"no motion is steady, since these functions of time never come to rest: {enumeration(changing)}; give "
            "them an end, for example by step(t, ...), or a constant value by --set"
        )
    before, richest = refinements()[-2:]
    every = list(dict.fromkeys((*models, before, richest)))
    paths: dict[LadderModel, ModelPath] = {}
    remaining = RemainingTime(len(every))
    for model in every:
        progress(f"model {remaining.next()}: {model.label} ...")
        paths[model] = model_path(parameter, model)
    if all(path.failure for path in paths.values()):
        reasons = dict.fromkeys(path.failure for path in paths.values())
        raise SimulationError("\n".join(["no model has a steady motion:", *(f"  {reason}" for reason in reasons)]))
    shown = tuple(paths[model] for model in models)
    return LadderStability(name, parameter.range, shown, paths[richest], paths[before], known, parameter.motion)
