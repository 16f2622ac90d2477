"""The tables of `tisserand study pivots`, as text and as plain data."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from derive.percentages import percent
from derive.study.elimination import VANISHING
from derive.study.pivot_orders import THRESHOLD
from derive.study.pivot_stability import FrameStability, StateStatistics
from derive.study.pivot_study import PivotComparison, PivotStudy
from derive.study.table import StudyColumn, StudyTable, columns, plain
from derive.study.verdict import verdict
from derive.terminal import beam_count, magnitude, wrapped

LEGEND = (
    "constrained: minimum degree in which multipliers are eliminated after their coordinates: the generated code",
    "matched: each multiplier directly after one coordinate, matched by the values of the first state",
    f"markowitz: pivots selected in the first state (Markowitz, threshold {THRESHOLD:g}) and used in all states; rows "
    "and columns differ",
    "unconstrained: minimum degree, in which multipliers are treated as any other unknown",
    "no diagonal: pivots of multipliers that are zero by structure; vanish: other pivots that are below "
    f"{VANISHING:g} of the largest entry of their columns, or change their sign between two states, if none before "
    "them does; fail: states without a result",
    "smallest, growth and error are of matrices whose rows and columns are scaled to 1, so that units do not matter",
    "smallest: pivot over the largest entry of its column; growth: max |L D| / max |A| (markowitz: max |U| / max |A|), "
    "median and worst; error: backward error |A x - b| / (|A| |x| + |b|) in the largest norm, worst",
    "broken: numberings of the unknowns in which some pivot vanishes; in half of them orders that depend on the values "
    "of the first state use SI units",
)


def pivot_data(study: PivotStudy) -> list[dict[str, Any]]:
    """All numbers as plain data, for each number of beams; a number that is not finite becomes None."""
    return [
        {
            "name": study.name,
            "pieces": row.pieces,
            "frames": plain(row.frames),
            "verdict": verdict(*row.frames),
        }
        for row in study.rows
    ]


def pivot_text(study: PivotStudy) -> str:
    """The text of the tables and the verdict for each number of beams, and the meaning of the columns."""
    return "\n\n".join([*(_block(study, row) for row in study.rows), "\n".join(wrapped(LEGEND))])


def pivot_title(study: PivotStudy, row: PivotComparison) -> str:
    """The line above the tables of a number of beams."""
    states = f"{row.frames[0].simulated.states} states of {study.along}, undeformed and as simulated"
    return f"{study.name}, {beam_count(row.pieces)}: {states}; no exchange of pivots"


def _block(study: PivotStudy, row: PivotComparison) -> str:
    tables = (*entry_table(row).text, "", *order_table(row).text)
    return "\n".join([pivot_title(study, row), *tables, "", *wrapped(verdict(*row.frames))])


def pivot_table(study: PivotStudy) -> StudyTable:
    """The pivots of each order in both frames, for each number of beams."""
    rows = ((row.pieces, *cells) for row in study.rows for cells in order_table(row).rows)
    return StudyTable((*columns("pieces"), *ORDERS), tuple(rows), left=4)


STATES = columns("frame", "states")
ENTRIES = (
    *STATES,
    StudyColumn("mass", head="nnz(M)"),
    StudyColumn("vanishing_mass", head="vanish"),
    StudyColumn("kkt", head="nnz(KKT)"),
    StudyColumn("vanishing_kkt", head="vanish"),
    *columns("fill-in", "LDL^T flops"),
    *columns("cond(KKT)", "scaled", "error of LU with pivoting", format=magnitude),
)
ORDERS = (
    *columns("order"),
    *STATES,
    *columns("no diagonal", "vanish", "fail"),
    *columns("smallest", "growth", "worst", "error", format=magnitude),
    StudyColumn("broken", percent),
)


def entry_table(of: PivotComparison) -> StudyTable:
    """The entries of the matrices in both frames, and their conditions."""
    rows = []
    for frame, kind, looked in _kinds(of.frames):
        counted = (frame.counts.mass, looked.vanishing_mass, frame.counts.kkt, looked.vanishing_kkt)
        sizes = (looked.condition, looked.scaled_condition, looked.pivoted_backward_error)
        rows.append((frame.frame, kind, *counted, frame.counts.fill, frame.counts.flops, *sizes))
    return StudyTable(ENTRIES, tuple(rows), left=2)


def order_table(of: PivotComparison) -> StudyTable:
    """The pivots of each order in both frames."""
    rows = []
    for order in of.frames[0].broken:
        for frame, kind, looked in _kinds(of.frames):
            p = looked.orders[order]
            pivots = (p.without_diagonal, p.vanishing, p.failures)
            sizes = (p.smallest, p.typical_growth, p.growth, p.backward_error)
            broken = frame.broken[order] if kind == "simulated" else None
            rows.append((order, frame.frame, kind, *pivots, *sizes, broken))
    return StudyTable(ORDERS, tuple(rows), left=3)


def _kinds(frames: Sequence[FrameStability]) -> Iterator[tuple[FrameStability, str, StateStatistics]]:
    """Each frame with the name and the statistics of both kinds of its states."""
    for frame in frames:
        yield frame, "undeformed", frame.undeformed
        yield frame, "simulated", frame.simulated
