"""The tables of the small cases in which methods fail."""

from __future__ import annotations

import numpy as np

from bench.method_failures.free_flight import AMPLITUDE
from bench.method_failures.small_cases import SmallCases
from bench.method_failures.step_control import PHASES
from derive.percentages import percent
from derive.study.table import StudyColumn, StudyTable, columns, fixed, general
from derive.terminal import magnitude

SHOWN = (2, 4, 8, 12, 16, 20)
"""The numbers of shapes that the table of monomials shows."""


def tables(cases: SmallCases) -> tuple[StudyTable, ...]:
    """All tables."""
    return _controls(cases), _ringing(cases), _dead_centres(cases), _momentum(cases), _bases(cases)


def _controls(cases: SmallCases) -> StudyTable:
    own = (
        StudyColumn("omega h", general(4)),
        StudyColumn("step, as SciPy's DOP853", magnitude),
        StudyColumn("step", fixed(2)),
        StudyColumn(
            "row, interpolated", fixed(1), doc="the largest error within the step, over the estimate of the step"
        ),
        StudyColumn("row", fixed(2), doc="with a shorter step where the estimate of the interpolant asks for it"),
    )
    rows = tuple((c.product, c.classical, c.own, c.interpolated, c.row) for c in cases.controls)
    title = f"errors of a vibration over their estimates, adaptive steps, worst of {len(PHASES)} phases"
    return StudyTable(own, rows, title, 0)


def _ringing(cases: SmallCases) -> StudyTable:
    last = len(cases.ringing[0].amplitude)
    steps = (1, 20, last)
    own = (StudyColumn("rho", general(2)), StudyColumn("factor per step", fixed(3)))
    rows = tuple((r.rho, r.factor, *(r.amplitude[n - 1] for n in steps)) for r in cases.ringing)
    title = "ringing of multipliers, rigid crank-slider, generalised-alpha on index 3"
    return StudyTable((*own, *columns(*(f"step {n}" for n in steps), format=magnitude)), rows, title)


def _dead_centres(cases: SmallCases) -> StudyTable:
    own = (
        StudyColumn("driven"),
        StudyColumn("rod / crank", general(2)),
        StudyColumn("smallest singular value", magnitude),
        StudyColumn("dead centres, deg"),
        StudyColumn("a run"),
    )
    rows = tuple(
        (
            case.driven.value,
            case.rod,
            float(case.singular.min()),
            ", ".join(f"{np.degrees(angle):.0f}" for angle in case.dead) or "none",
            "stops with an error" if case.failure else "passes",
        )
        for case in cases.dead_centres
    )
    return StudyTable(own, rows, "dead centres of a rigid crank-slider over a revolution of the crank")


def _momentum(cases: SmallCases) -> StudyTable:
    rules = list(dict.fromkeys(m.rule for m in cases.momentum))
    rows = tuple((rule.value, *(m.drift for m in cases.momentum if m.rule is rule)) for rule in rules)
    products = columns(*(f"omega_1 h = {m.product:g}" for m in cases.momentum if m.rule is rules[0]), format=percent)
    title = f"angular momentum of a free beam that vibrates by {AMPLITUDE:.2f} l"
    return StudyTable((StudyColumn("rule"), *products), rows, title)


def _bases(cases: SmallCases) -> StudyTable:
    own = (
        StudyColumn("N"),
        StudyColumn("monomials, cond(c8)", magnitude),
        StudyColumn("error of c8 x = b", magnitude),
        StudyColumn("Legendre, cond(c8)", fixed(1)),
        StudyColumn("error of c8 x = b", magnitude),
    )
    rows = tuple(
        (b.count, b.monomials, b.error_monomials, b.legendre, b.error_legendre) for b in cases.bases if b.count in SHOWN
    )
    return StudyTable(own, rows, "monomials against Legendre polynomials")
