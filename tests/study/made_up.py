"""Numbers that no scene gave."""

from __future__ import annotations

from dataclasses import replace

from derive.lowering.elimination_orders import EliminationRule
from derive.study.frame_cost import FrameComparison, FrameCost
from derive.study.frame_study import FrameStudy
from derive.study.pivot_stability import FrameStability, PivotStatistics, StateStatistics
from derive.study.timing import InterleavedTimes, Ratio
from derive.study.variants import OperationCounts

SPARSE = OperationCounts(16, 10, 16, 138, 29, 594, 411, 42, 922)
FULL = OperationCounts(16, 10, 46, 168, 34, 802, 662, 81, 1354)
FINE = PivotStatistics(0, 0, 0, 1e-3, 1.0, 2.0, 1e-15)


def times(first: float, second: float) -> InterleavedTimes:
    """CPU seconds of a step."""
    ratio = Ratio(first / second, 0.98 * first / second, 1.05 * first / second)
    pair = (first, second)
    return InterleavedTimes(7, 1e-5, 100, 1e-3, (400, 400), (3, 4), pair, pair, pair, ratio, ratio, ratio)


def row(pieces: int, first: float = 0.5e-6, second: float = 1e-6) -> FrameComparison:
    spent = {"derive": 0.1, "lower": 0.2, "emit": 0.3, "compile": 0.4}
    return FrameComparison(
        pieces, (FrameCost(SPARSE, 1e3, 1e7, spent), FrameCost(FULL, 1e4, 2e7, spent)), times(first, second)
    )


def frame_study(
    name: str,
    *rows: FrameComparison,
    frames: tuple[str, str] = ("mean", "point"),
    elimination: EliminationRule = EliminationRule.SAFE,
) -> FrameStudy:
    """A study of these rows."""
    return FrameStudy(name, frames, elimination, rows)


def in_frame(frame: str, orders: dict[str, PivotStatistics], broken: dict[str, float] | None = None) -> FrameStability:
    """A frame whose zeros are those of its name."""
    mean = frame == "mean"
    looked = StateStatistics(37, 0 if mean else 18, 36, 1e6, 1e4, 1e-15, orders)
    shares = dict.fromkeys(orders, 0.0) | (broken or {})
    neighbours = (3.8, 6.1) if mean else (5.7, 6.1)
    return FrameStability(frame, SPARSE if mean else FULL, neighbours, looked, looked, 10, shares)


def worse(growth: float = 1.0, error: float = 1.0) -> PivotStatistics:
    return replace(FINE, growth=growth * FINE.growth, backward_error=error * FINE.backward_error)
