"""The tables of `tisserand study pivots`, as text and as plain data."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from derive.percentages import percent
from derive.study.elimination import VANISHING
from derive.study.pivot_orders import THRESHOLD
from derive.study.pivot_stability import FrameStability, PivotStatistics
from derive.study.verdict import verdict
from derive.terminal import beam_count, magnitude, table, wrapped

LEGEND = (
    "constrained: minimum degree (AMD) in which multipliers are eliminated after their coordinates: the generated code",
    "matched: each multiplier directly after one coordinate, matched by the values of the first state",
    f"markowitz: pivots selected in the first state (Markowitz, threshold {THRESHOLD:g}) and used in all states; rows "
    "and columns differ",
    "unconstrained: minimum degree (AMD), in which multipliers are treated as any other unknown",
    "no diagonal: pivots of multipliers that are zero by structure; vanish: other pivots that are below "
    f"{VANISHING:g} of the largest entry of their columns, or change their sign between two states, if none before "
    "them does; fail: states without a result",
    "smallest, growth and error are of matrices whose rows and columns are scaled to 1, so that units do not matter",
    "smallest: pivot over the largest entry of its column; growth: max |L D| / max |A| (markowitz: max |U| / max |A|), "
    "median and worst; error: backward error |A x - b| / (|A| |x| + |b|) in the largest norm, worst",
    "broken: numberings of the unknowns in which some pivot vanishes; in half of them orders that depend on the values "
    "of the first state use SI units",
)


def pivot_data(name: str, pieces: int, frames: tuple[FrameStability, FrameStability]) -> dict[str, Any]:
    """All numbers as plain data; a number that is not finite becomes None."""
    content = {
        "name": name,
        "pieces": pieces,
        "frames": [asdict(frame) for frame in frames],
        "verdict": verdict(*frames),
    }
    data: dict[str, Any] = _finite(content)
    return data


def pivot_text(name: str, pieces: int, along: str, frames: tuple[FrameStability, FrameStability]) -> str:
    """The text of the two tables and of the verdict."""
    count, title = frames[0].simulated.states, f"{name}, {beam_count(pieces)}"
    return "\n".join(
        [
            f"{title}: {count} states of {along}, undeformed and as simulated; no exchange of pivots",
            *table(_entries(frames), left=2),
            "",
            *table(_orders(frames), left=3),
            "",
            *wrapped(verdict(*frames)),
        ]
    )


def pivot_legend() -> str:
    """The meaning of the columns of the tables."""
    return "\n".join(wrapped(LEGEND))


def _entries(frames: Sequence[FrameStability]) -> list[list[str]]:
    head = ("frame", "states", "nnz(M)", "vanish", "nnz(KKT)", "vanish", "fill-in", "LDL^T flops", "cond(KKT)")
    rows = [[*head, "scaled", "error of LU with pivoting"]]
    for one in frames:
        for kind, looked in (("undeformed", one.undeformed), ("simulated", one.simulated)):
            counted = (one.counts.mass, looked.vanishing_mass, one.counts.kkt, looked.vanishing_kkt, one.counts.fill)
            sizes = (looked.condition, looked.scaled_condition, looked.pivoted_backward_error)
            rows.append([one.frame, kind, *map(str, counted), str(one.counts.flops), *map(magnitude, sizes)])
    return rows


def _orders(frames: Sequence[FrameStability]) -> list[list[str]]:
    rows = [
        ["order", "frame", "states", "no diagonal", "vanish", "fail", "smallest", "growth", "worst", "error", "broken"]
    ]
    for order in frames[0].broken:
        for one in frames:
            for kind, looked in (("undeformed", one.undeformed), ("simulated", one.simulated)):
                last = percent(one.broken[order]) if kind == "simulated" else ""
                rows.append([order, one.frame, kind, *_cells(looked.orders[order]), last])
    return rows


def _cells(p: PivotStatistics) -> list[str]:
    sizes = (p.smallest, p.typical_growth, p.growth, p.backward_error)
    return [*map(str, (p.without_diagonal, p.vanishing, p.failures)), *map(magnitude, sizes)]


def _finite(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _finite(x) for key, x in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(x) for x in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
