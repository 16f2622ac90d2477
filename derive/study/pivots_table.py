"""The tables of `tisserand study pivots`, as text and as plain data."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from derive.study.eliminate import VANISHING
from derive.study.orders import THRESHOLD
from derive.study.pivots import InFrame, Pivots
from derive.study.verdict import verdict
from derive.terminal import beam_count, magnitude, table, wrapped

LEGEND = (
    "fixed: the order of the generated code; each multiplier waits for all of its coordinates",
    "paired: each multiplier directly behind one coordinate, matched by the values of the first state",
    f"kept: pivots chosen in the first state (Markowitz, threshold {THRESHOLD:g}), then kept; rows and columns differ",
    "blind: minimum degree (AMD), as if multipliers were like any other unknown",
    "no diagonal: pivots of multipliers that are zero by structure; vanish: other pivots that are below "
    f"{VANISHING:g} of the largest entry of their columns, or change their sign between two states, if none before "
    "them does; fail: states without a result",
    "smallest, growth and error are of matrices whose rows and columns are scaled to 1, so that units do not matter",
    "smallest: pivot over the largest entry of its column; growth: max |L D| / max |A| (kept: max |U| / max |A|), "
    "median and worst; error: backward error |A x - b| / (|A| |x| + |b|) in the largest norm, worst",
    "broken: numberings of the unknowns in which some pivot vanishes; in half of them orders that look at the values "
    "of the first state see them in SI units",
)


def plain(name: str, pieces: int, found: tuple[InFrame, InFrame]) -> dict[str, Any]:
    """All numbers; what is not finite is None."""
    content = {"name": name, "pieces": pieces, "frames": [asdict(one) for one in found], "verdict": verdict(*found)}
    made: dict[str, Any] = _finite(content)
    return made


def text(name: str, pieces: int, along: str, found: tuple[InFrame, InFrame]) -> str:
    """Two tables and the verdict."""
    count, title = found[0].simulated.states, f"{name}, {beam_count(pieces)}"
    return "\n".join(
        [
            f"{title}: {count} states of {along}, undeformed and as simulated; no exchange of pivots",
            *table(_entries(found), left=2),
            "",
            *table(_orders(found), left=3),
            "",
            *wrapped(verdict(*found)),
        ]
    )


def legend() -> str:
    """What the tables mean."""
    return "\n".join(wrapped(LEGEND))


def _entries(found: Sequence[InFrame]) -> list[list[str]]:
    head = ("frame", "states", "nnz(M)", "vanish", "nnz(KKT)", "vanish", "fill-in", "LDL^T flops", "cond(KKT)")
    rows = [[*head, "scaled", "error of LU with pivoting"]]
    for one in found:
        for kind, looked in (("undeformed", one.undeformed), ("simulated", one.simulated)):
            counted = (one.counts.mass, looked.vanishing_mass, one.counts.kkt, looked.vanishing_kkt, one.counts.fill)
            sizes = (looked.condition, looked.scaled_condition, looked.pivoted_backward_error)
            rows.append([one.frame, kind, *map(str, counted), str(one.counts.flops), *map(magnitude, sizes)])
    return rows


def _orders(found: Sequence[InFrame]) -> list[list[str]]:
    rows = [
        ["order", "frame", "states", "no diagonal", "vanish", "fail", "smallest", "growth", "worst", "error", "broken"]
    ]
    for order in found[0].broken:
        for one in found:
            for kind, looked in (("undeformed", one.undeformed), ("simulated", one.simulated)):
                last = f"{100 * one.broken[order]:.0f} %" if kind == "simulated" else ""
                rows.append([order, one.frame, kind, *_cells(looked.orders[order]), last])
    return rows


def _cells(p: Pivots) -> list[str]:
    sizes = (p.smallest, p.typical_growth, p.growth, p.backward_error)
    return [*map(str, (p.without_diagonal, p.vanishing, p.failures)), *map(magnitude, sizes)]


def _finite(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _finite(x) for key, x in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(x) for x in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
