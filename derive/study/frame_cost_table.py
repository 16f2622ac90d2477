"""The table of `tisserand study frames`, as text and as plain data."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from derive.lowering.elimination_orders import EliminationRule
from derive.study.frame_cost import PAPER, FrameComparison, FrameCost
from derive.study.frame_study import FrameStudy
from derive.study.table import Row, StudyColumn, StudyTable
from derive.study.timing import DRIFT, STABLE, Ratio, machine_description
from derive.terminal import beam_count, magnitude, wrapped

COLUMNS = tuple(
    StudyColumn(name, head=head, unit=unit)
    for name, head, unit in (
        ("pieces", "beams", ""),
        ("frame", "frame", ""),
        ("mass", "nnz(M)", ""),
        ("kkt", "nnz(KKT)", ""),
        ("fill", "fill-in", ""),
        ("flops", "LDL^T", "flops"),
        ("factorise", "in code", "flops"),
        ("force", "force", "flops"),
        ("accel", "accel", "flops"),
        ("condition_mass", "cond(M)", ""),
        ("condition_kkt", "cond(KKT)", ""),
        ("force_ns", "force", "ns"),
        ("accel_ns", "accel", "ns"),
        ("step_ns", "step", "ns"),
        ("spread", "spread", "of step"),
        ("paper", "paper", ""),
    )
)
ELIMINATIONS = {
    EliminationRule.SAFE: "elimination: each multiplier after all of its coordinates, as in generated code; safe in "
    "every state with independent constraints",
    EliminationRule.MATCHED: "elimination: each multiplier after one of its coordinates, in the order with the least "
    "work found; not safe in every state, since a pivot vanishes with the entry that pairs the two, which is checked",
}
"""The notes on each elimination order."""


def frame_cost_data(study: FrameStudy) -> dict[str, Any]:
    """All numbers as plain data; times are CPU seconds."""
    first, second = study.frames
    return {
        "name": study.name,
        "frames": list(study.frames),
        "elimination": study.elimination.value,
        "safe_in_every_state": study.elimination is EliminationRule.SAFE,
        **machine_description(),
        "rows": [
            {
                "pieces": row.pieces,
                first: asdict(row.costs[0]),
                second: asdict(row.costs[1]),
                "times": asdict(row.times),
                "paper": _paper(study.frames, row.pieces),
            }
            for row in study.rows
        ],
    }


def frame_cost_text(study: FrameStudy) -> str:
    """The table with its notes."""
    return "\n".join([*frame_cost_table(study).text, *wrapped(frame_cost_notes(study), "  ")])


def frame_cost_table(study: FrameStudy) -> StudyTable:
    """The counts and the times of both frames, and their ratios, for each number of beams."""
    first, second = study.frames
    blocks = (_block(study.frames, row) for row in study.rows)
    between: Row = (None,) * len(COLUMNS)
    lines = [line for block in blocks for line in (between, *block)][1:]
    return StudyTable(COLUMNS, tuple(lines), f"{study.name}: the {first} frame against the {second} frame", 2)


def _block(frames: tuple[str, str], row: FrameComparison) -> list[Row]:
    """The rows of both frames, and that of their ratios."""
    times, lines = row.times, list[Row]()
    for side, (frame, framed) in enumerate(zip(frames, row.costs, strict=True)):
        taken = (times.force[side], times.accel[side], times.per_step[side])
        nanoseconds = (_nano(x) for x in taken)
        lines.append((None if side else row.pieces, frame, *_counts(framed), *nanoseconds, None, None))
    pairs = zip(_numbers(row.costs[0]), _numbers(row.costs[1]), strict=True)
    measured = (times.force_ratio, times.accel_ratio, times.integration_ratio)
    paper = _paper(frames, row.pieces)
    lines.append(
        (
            *(None, "ratio"),
            *(f"{a / b:.2f}" if b else "" for a, b in pairs),
            *(f"{x.median:.2f}" for x in measured),
            _spread(times.integration_ratio),
            f"{paper:.2f}" if paper else None,
        )
    )
    return lines


def _numbers(framed: FrameCost) -> tuple[float, ...]:
    c = framed.counts
    counted = (c.mass, c.kkt, c.fill, c.flops, c.factorise, c.force, c.accel)
    return (*counted, framed.condition_mass, framed.condition_kkt)


def _counts(framed: FrameCost) -> list[str]:
    *counted, mass, kkt = _numbers(framed)
    return [*(str(n) for n in counted), magnitude(mass), magnitude(kkt)]


def _nano(seconds: float) -> str:
    value = seconds * 1e9
    return f"{value:.0f}" if value >= 100 else f"{value:.1f}"


def _spread(ratio: Ratio) -> str:
    return f"{ratio.least:.2f}..{ratio.most:.2f}"


def _paper(frames: tuple[str, str], pieces: int) -> float | None:
    return PAPER.get(pieces) if frames == ("mean", "point") else None


def frame_cost_notes(study: FrameStudy) -> list[str]:
    """The meaning of the columns, how the times were measured, and by what."""
    rows, machine, runs = study.rows, machine_description(), study.rows[0].times.runs
    steps = (f"{beam_count(r.pieces)}: {r.times.steps} of {r.times.step:.2g} s" for r in rows)
    corrections = (f"{beam_count(r.pieces)}: {' and '.join(map(str, r.times.corrections))}" for r in rows)
    first, second = study.frames
    notes = [
        "non-zeros: structural ones in both triangles; fill-in: in one triangle",
        ELIMINATIONS[study.elimination],
        "LDL^T: operations of the factorisation if no entry is known before run time; in code: operations of the "
        "generated code, whose setup has already computed all that depends only on parameters",
        "force, accel: all operations of these functions; a sine counts as one",
        "cond: condition number in the initial state, in SI units, not scaled",
        f"times: CPU, median of {runs} interleaved runs ({first}, {second}, ...); spread: the ratios of pairs",
        f"step: one step of the same RK4 loop in C; both frames take the same step, {STABLE:g} of the longest stable "
        f"one; projection keeps the drift below {DRIFT:g}; steps: {'; '.join(steps)}; corrections in {first} and "
        f"{second}: {'; '.join(corrections)}",
        f"compiled by {machine['compiler']}, {machine['flags']}; {machine['machine']}",
    ]
    if any(row.redundant for row in rows):
        notes.append(
            "joints are redundant, and the KKT matrices are singular: pivots of multipliers have a proximal term, "
            "which gives reactions of least norm, and coordinates are eliminated first"
        )
    if any(_paper(study.frames, row.pieces) for row in rows):
        notes.append(
            "paper: CPU time of the whole program DADS in 1988, with another integrator and a general sparse solver, "
            "which is not the same measurement"
        )
    return notes
