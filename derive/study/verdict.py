"""The verdict on Haug's conjecture in sentences, all of which follow from the numbers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from derive.percentages import percent
from derive.study.pivot_stability import FrameStability, PivotStatistics, StateStatistics
from derive.terminal import magnitude

SUBSTANTIAL, ROUNDING = 10.0, 1e-15
"""Backward errors that differ by this factor differ substantially; those below `ROUNDING` count as `ROUNDING`."""

SHARE = 0.1
"""Shares of numberings in which a pivot vanishes differ substantially if they differ by this much."""


@dataclass(frozen=True)
class OrderVerdict:
    """The verdict on one order: `gain` is 1 if the frame with more zeros is substantially more stable, -1 if less."""

    order: str
    gain: int
    words: str


def verdict(first: FrameStability, second: FrameStability) -> list[str]:
    """The sentences of the verdict: the zeros, each order, the conclusion, condition and cost."""
    if first.counts.mass == second.counts.mass:
        return ["Both frames have equally many zeros in M: of these the conjecture says nothing."]
    sparse, full = (first, second) if first.counts.mass < second.counts.mass else (second, first)
    judged = [judge(order, sparse, full) for order in sparse.broken]
    return [
        _premise(sparse, full),
        *(j.words for j in judged),
        conclusion(judged, sparse.frame),
        *_besides(sparse, full),
    ]


def judge(order: str, sparse: FrameStability, full: FrameStability) -> OrderVerdict:
    """The verdict on one order in both frames."""
    a, b = sparse.broken[order], full.broken[order]
    if a == b == 0 and not any(_vanish(frame, order) for frame in (sparse, full)):
        gain = _error_gain(order, sparse, full)
        worst = (_worst(sparse, order), _worst(full, order))
        growth = " and ".join(magnitude(p.growth) for p in worst)
        error = " and ".join(magnitude(p.backward_error) for p in worst)
        numbers = f"growth {growth}, backward error {error}"
        text = f"no pivot vanishes in either frame; {numbers} ({sparse.frame}, {full.frame})"
    else:
        gain = (b - a >= SHARE) - (a - b >= SHARE)
        shares = (
            f"{percent(one.broken[order])} in the {one.frame} frame{_missing(one, order)}" for one in (sparse, full)
        )
        text = f"of the numberings some pivot vanishes in {' and in '.join(shares)}"
    return OrderVerdict(
        order, gain, f"{order}: {text}: {_gained(gain, sparse, full)}.{_reason(order, gain, sparse, full)}"
    )


def conclusion(judged: Sequence[OrderVerdict], sparse_frame: str) -> str:
    """The sentence on whether the conjecture holds; `sparse_frame` names the frame with more zeros."""
    by_gain = {gain: [j.order for j in judged if j.gain == gain] for gain in (1, 0, -1)}
    if not by_gain[0] and not by_gain[-1]:
        return f"Haug's conjecture holds here: with every order the {sparse_frame} frame is substantially more stable."
    if not by_gain[1] and not by_gain[-1]:
        return (
            "Haug's conjecture does not hold here: the zeros make no substantial difference to stability in any order."
        )
    if not by_gain[1]:
        return (
            f"Haug's conjecture does not hold here: the {sparse_frame} frame is nowhere substantially more stable, and "
            f"less so with the order{_s(by_gain[-1])} {_and(by_gain[-1])}."
        )
    parts = [f"the {sparse_frame} frame is substantially more stable with the order{_s(by_gain[1])} {_and(by_gain[1])}"]
    parts += [f"not substantially different with {_and(by_gain[0])}"] if by_gain[0] else []
    parts += [f"substantially less stable with {_and(by_gain[-1])}"] if by_gain[-1] else []
    return f"Haug's conjecture holds in part: {', '.join(parts)}."


def _premise(sparse: FrameStability, full: FrameStability) -> str:
    size = sparse.counts.coordinates**2
    zeros = f"M has {size - sparse.counts.mass} zeros of {size} in the {sparse.frame} frame"
    zeros += f", {size - full.counts.mass} in the {full.frame} frame"
    gone = [max(one.undeformed.vanishing_mass, one.simulated.vanishing_mass) for one in (sparse, full)]
    if not any(gone):
        return f"{zeros}; no other entry vanishes in any state."
    vanishing = (
        f"of its other {sparse.counts.mass} and {full.counts.mass} entries {gone[0]} and {gone[1]} vanish in some state"
    )
    return f"{zeros}; {vanishing}."


def _reason(order: str, gain: int, sparse: FrameStability, full: FrameStability) -> str:
    """The reason why minimum degree gives another order, if the numbers confirm it."""
    (a, x), (b, y) = sparse.neighbours, full.neighbours
    if order != "unconstrained" or gain != 1 or not a / max(x, 1e-9) < b / max(y, 1e-9):
        return ""
    return (
        f" Minimum degree takes first what is coupled with least: on average a coordinate with {a:.1f} others in the "
        f"{sparse.frame} frame and {b:.1f} in the {full.frame} frame, a multiplier with {x:.1f} and {y:.1f}."
    )


def _missing(one: FrameStability, order: str) -> str:
    missing = one.simulated.orders[order].without_diagonal
    come = "multiplier comes before all of its" if missing == 1 else "multipliers come before all of their"
    return f" (here {missing} {come} coordinates)" if missing else ""


def _besides(sparse: FrameStability, full: FrameStability) -> list[str]:
    """The sentences on condition numbers and on cost."""
    a, b = _condition(sparse), _condition(full)
    c, d = sparse.counts, full.counts
    return [
        f"The condition of the KKT matrix is {_times(b[0], a[0])} in the {sparse.frame} frame, and "
        f"{_times(b[1], a[1])} once rows and columns are scaled to 1.",
        f"LDL^T has a fill-in of {c.fill} against {d.fill} entries and takes {c.flops} operations against {d.flops} "
        f"({percent(c.flops / d.flops - 1, signed=True)}): that is cost, not stability.",
    ]


def _condition(one: FrameStability) -> tuple[float, float]:
    both = (one.undeformed, one.simulated)
    return max(x.condition for x in both), max(x.scaled_condition for x in both)


def _times(full: float, sparse: float) -> str:
    if 0.95 < full / sparse < 1.05:
        return "about the same"
    return f"{full / sparse:.1f} times smaller" if full > sparse else f"{sparse / full:.1f} times larger"


def _error_gain(order: str, sparse: FrameStability, full: FrameStability) -> int:
    a, b = (max(_worst(one, order).backward_error, ROUNDING) for one in (sparse, full))
    return int(b >= SUBSTANTIAL * a) - int(a >= SUBSTANTIAL * b)


def _worst(one: FrameStability, order: str) -> PivotStatistics:
    """The statistics of the kind of states with the larger backward error."""
    kinds: tuple[StateStatistics, StateStatistics] = (one.undeformed, one.simulated)
    return max((kind.orders[order] for kind in kinds), key=lambda p: p.backward_error)


def _vanish(one: FrameStability, order: str) -> bool:
    kinds = (one.undeformed.orders[order], one.simulated.orders[order])
    return any(p.without_diagonal or p.vanishing or p.failures for p in kinds)


def _gained(gain: int, sparse: FrameStability, full: FrameStability) -> str:
    if not gain:
        return "no substantial difference"
    return f"substantially more stable in the {(sparse if gain > 0 else full).frame} frame"


def _and(names: Sequence[str]) -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"


def _s(names: Sequence[str]) -> str:
    return "s" if len(names) > 1 else ""
