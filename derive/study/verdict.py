"""What the numbers say of Haug's conjecture, in words: no word is decided before the numbers are known."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from derive.study.pivots import InFrame, Looked, Pivots
from derive.terminal import magnitude

SUBSTANTIAL, ROUNDING = 10.0, 1e-15
"""Backward errors that differ by this factor differ substantially; those below `ROUNDING` are as good as none."""

SHARE = 0.1
"""So does the share of numberings in which a pivot vanishes, if it differs by this much."""


@dataclass(frozen=True)
class Judged:
    """An order: `gain` is 1 where the frame with more zeros is substantially more stable, -1 where the other one is."""

    order: str
    gain: int
    words: str


def verdict(first: InFrame, second: InFrame) -> list[str]:
    """Sentences: what holds, order by order, and what is left of the conjecture."""
    if first.counts.mass == second.counts.mass:
        return ["Both frames have equally many zeros in M: of these the conjecture says nothing."]
    sparse, full = (first, second) if first.counts.mass < second.counts.mass else (second, first)
    judged = [judge(order, sparse, full) for order in sparse.broken]
    return [
        _premise(sparse, full),
        *(j.words for j in judged),
        conclusion(judged, sparse, full),
        *_besides(sparse, full),
    ]


def judge(order: str, sparse: InFrame, full: InFrame) -> Judged:
    """Compare one order in both frames."""
    a, b = sparse.broken[order], full.broken[order]
    if a == b == 0 and not any(_vanish(one, order) for one in (sparse, full)):
        gain = _error_gain(order, sparse, full)
        worst = (_worst(sparse, order), _worst(full, order))
        growth = " and ".join(magnitude(p.growth) for p in worst)
        error = " and ".join(magnitude(p.backward_error) for p in worst)
        numbers = f"growth {growth}, backward error {error}"
        said = f"no pivot vanishes in either frame; {numbers} ({sparse.frame}, {full.frame})"
    else:
        gain = (b - a >= SHARE) - (a - b >= SHARE)
        shares = (
            f"{_percent(one.broken[order])} in the {one.frame} frame{_missing(one, order)}" for one in (sparse, full)
        )
        said = f"of the numberings some pivot vanishes in {' and in '.join(shares)}"
    return Judged(order, gain, f"{order}: {said}: {_gained(gain, sparse, full)}.{_reason(order, gain, sparse, full)}")


def conclusion(judged: Sequence[Judged], sparse: InFrame, full: InFrame) -> str:
    """What is left of the conjecture."""
    by_gain = {gain: [j.order for j in judged if j.gain == gain] for gain in (1, 0, -1)}
    if not by_gain[0] and not by_gain[-1]:
        return f"Haug's conjecture holds here: with every order the {sparse.frame} frame is substantially more stable."
    if not by_gain[1] and not by_gain[-1]:
        return (
            "Haug's conjecture does not hold here: the zeros make no substantial difference to stability in any order."
        )
    if not by_gain[1]:
        return (
            f"Haug's conjecture does not hold here: the {sparse.frame} frame is nowhere substantially more stable, and "
            f"less so with the order{_s(by_gain[-1])} {_and(by_gain[-1])}."
        )
    parts = [f"the {sparse.frame} frame is substantially more stable with the order{_s(by_gain[1])} {_and(by_gain[1])}"]
    parts += [f"not substantially different with {_and(by_gain[0])}"] if by_gain[0] else []
    parts += [f"substantially less stable with {_and(by_gain[-1])}"] if by_gain[-1] else []
    return f"Haug's conjecture holds in part: {', '.join(parts)}."


def _premise(sparse: InFrame, full: InFrame) -> str:
    size = sparse.counts.coordinates**2
    zeros = f"M has {size - sparse.counts.mass} zeros of {size} in the {sparse.frame} frame"
    zeros += f", {size - full.counts.mass} in the {full.frame} frame"
    gone = [max(one.undeformed.vanishing_mass, one.simulated.vanishing_mass) for one in (sparse, full)]
    if not any(gone):
        return f"{zeros}; no other entry vanishes in any state."
    told = (
        f"of its other {sparse.counts.mass} and {full.counts.mass} entries {gone[0]} and {gone[1]} vanish in some state"
    )
    return f"{zeros}; {told}."


def _reason(order: str, gain: int, sparse: InFrame, full: InFrame) -> str:
    """Why minimum degree gives another order, if the numbers bear it out."""
    (a, x), (b, y) = sparse.neighbours, full.neighbours
    if order != "blind" or gain != 1 or not a / max(x, 1e-9) < b / max(y, 1e-9):
        return ""
    return (
        f" Minimum degree takes first what is coupled with least: on average a coordinate with {a:.1f} others in the "
        f"{sparse.frame} frame and {b:.1f} in the {full.frame} frame, a multiplier with {x:.1f} and {y:.1f}."
    )


def _missing(one: InFrame, order: str) -> str:
    missing = one.simulated.orders[order].without_diagonal
    come = "multiplier comes before all of its" if missing == 1 else "multipliers come before all of their"
    return f" (here {missing} {come} coordinates)" if missing else ""


def _besides(sparse: InFrame, full: InFrame) -> list[str]:
    """Condition, and what it costs."""
    a, b = _condition(sparse), _condition(full)
    c, d = sparse.counts, full.counts
    return [
        f"The condition of the KKT matrix is {_times(b[0], a[0])} in the {sparse.frame} frame, and "
        f"{_times(b[1], a[1])} once rows and columns are scaled to 1.",
        f"LDL^T fills {c.fill} entries in, against {d.fill}, with {c.flops} operations against {d.flops} "
        f"({100 * (c.flops / d.flops - 1):+.0f} %): that is cost, not stability.",
    ]


def _condition(one: InFrame) -> tuple[float, float]:
    both = (one.undeformed, one.simulated)
    return max(x.condition for x in both), max(x.scaled_condition for x in both)


def _times(full: float, sparse: float) -> str:
    if 0.95 < full / sparse < 1.05:
        return "about the same"
    return f"{full / sparse:.1f} times smaller" if full > sparse else f"{sparse / full:.1f} times larger"


def _error_gain(order: str, sparse: InFrame, full: InFrame) -> int:
    a, b = (max(_worst(one, order).backward_error, ROUNDING) for one in (sparse, full))
    return int(b >= SUBSTANTIAL * a) - int(a >= SUBSTANTIAL * b)


def _worst(one: InFrame, order: str) -> Pivots:
    """The kind of states in which the backward error is larger."""
    kinds: tuple[Looked, Looked] = (one.undeformed, one.simulated)
    return max((kind.orders[order] for kind in kinds), key=lambda p: p.backward_error)


def _vanish(one: InFrame, order: str) -> bool:
    kinds = (one.undeformed.orders[order], one.simulated.orders[order])
    return any(p.without_diagonal or p.vanishing or p.failures for p in kinds)


def _gained(gain: int, sparse: InFrame, full: InFrame) -> str:
    if not gain:
        return "no substantial difference"
    return f"substantially more stable in the {(sparse if gain > 0 else full).frame} frame"


def _percent(share: float) -> str:
    return f"{100 * share:.0f} %"


def _and(names: Sequence[str]) -> str:
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"


def _s(names: Sequence[str]) -> str:
    return "s" if len(names) > 1 else ""
