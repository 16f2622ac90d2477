"""The tables of a study of methods, from which its text, its page and its plain data follow."""

from __future__ import annotations

from math import isfinite, isnan
from typing import Any

import numpy as np

from derive.rendering import render
from derive.runtime.native_call import Vector
from derive.study.methods.drift import exponent
from derive.study.methods.failures import failure_lines, failure_table, failures
from derive.study.methods.formulations import FORM_NAMES
from derive.study.methods.method_study import MethodStudy
from derive.study.methods.methods_chart import methods_svg
from derive.study.methods.stability_functions import bdf, last_growth
from derive.study.methods.step_limits import GROWN, LARGE, LONGEST, STEPS, StepLimit
from derive.study.table import StudyColumn, StudyTable, fixed, general, plain
from derive.terminal import magnitude, wrapped


def tables(study: MethodStudy) -> tuple[StudyTable, ...]:
    """All tables of a study."""
    made = (step_limit_table(study), _drift(study), _forms(study), _conditioning(study))
    return tuple(table for table in made if table.rows)


def methods_text(study: MethodStudy) -> str:
    """The text of the tables, and of the failures with the measurements of each."""
    lines = [f"{study.name}: stability of methods"]
    for table in tables(study):
        lines += ["", *table.text]
    if known := failures(study):
        lines += ["", *failure_lines(known)]
    return "\n".join([*lines, *wrapped(study.notes)])


def methods_html(study: MethodStudy) -> str:
    """The text of the page: the picture, the failures, and all tables; it loads no other files."""
    values = {
        "name": study.name,
        "picture": methods_svg(study),
        "failures": failures(study),
        "tables": tables(study),
        "notes": study.notes,
    }
    return render("study/methods.html.jinja", values)


def methods_data(study: MethodStudy) -> dict[str, Any]:
    """All numbers as plain data; a number that is not finite becomes None."""
    return {**plain(study), "failures": failure_table(failures(study)).data}


def _seconds(h: float) -> str:
    return f"{h:.3e}"


def _stable(stable: bool) -> str:
    return "stable" if stable else "grows"


LIMITS = (
    StudyColumn("integrator"),
    StudyColumn("omega_h", lambda y: f"{y:.4g}" if isfinite(y) else "no limit", "omega h"),
    StudyColumn("theory_s", _seconds, "theory, s"),
    StudyColumn("experiment_s", head="experiment, s"),
    StudyColumn("ratio", fixed(3)),
    StudyColumn("at_0.95", _stable, "at 0.95"),
    StudyColumn("at_1.05", _stable, "at 1.05"),
    StudyColumn("growth", general(5), "growth per step at 1.05"),
)
NOT_TRIED = "not tried"
EXPERIMENT = (
    f"experiment: the longest step with which a disturbance of the fastest mode grows by less than {GROWN:g} times in "
    f"{STEPS} steps, from the state with the highest frequency"
)


def step_limit_table(study: MethodStudy) -> StudyTable:
    """The largest stable steps, by theory and by experiment."""
    w = study.frequency
    title = (
        f"largest stable step; omega_max {w.unloaded:.0f} rad/s undeformed at rest, {w.largest:.0f} at most in "
        f"{study.along}"
    )
    long = f"{NOT_TRIED}: steps of omega h = {LARGE[-1]:g} are more than a {LONGEST}th of {study.along}"
    notes = (EXPERIMENT, *((long,) if any(isnan(line.measured) for line in study.limits) else ()), _bdf_note())
    return StudyTable(LIMITS, tuple(map(_limit, study.limits)), title, notes=notes)


def _limit(line: StepLimit) -> tuple[Any, ...]:
    if isfinite(line.theory):
        cells = (line.predicted, _seconds(line.measured), line.ratio, line.below, line.above, line.growth)
        return (line.method.value, line.theory, *cells)
    grows = f"grows at omega h = {LARGE[-1]:g}"
    tried = NOT_TRIED if isnan(line.measured) else f">= {_seconds(line.measured)}" if line.measured else grows
    return (line.method.value, line.theory, None, tried, None, None, None, None)


def _bdf_note() -> str:
    """The note on the theory of the formulas of IDA, which have no fixed step that could be tried."""
    last = {order: last_growth(bdf(order)) for order in range(1, 6)}
    growing = ", ".join(f"{y:.2f} (order {order})" for order, y in last.items() if y)
    return f"ida and c_ida choose steps and orders by their tolerance: vibrations grow with omega h up to {growing}"


def _power(p: float) -> str:
    return f"{round(p, 1) + 0.0:g}" if isfinite(p) else ""


DRIFT = (
    StudyColumn("method"),
    StudyColumn("steps"),
    StudyColumn("g", magnitude, "|g|"),
    StudyColumn("g_power", _power, "as t^"),
    StudyColumn("gdot", magnitude, "|gdot|"),
    StudyColumn("energy", magnitude, doc="|E - E0 - W| over the largest kinetic energy, with the work W of the drives"),
    StudyColumn("energy_power", _power, "as t^"),
    StudyColumn("failure", head=""),
)
DRIFT_NOTE = "|g| (m, rad) and |gdot| (m/s, rad/s): the largest"


def _drift(study: MethodStudy) -> StudyTable:
    rows: list[tuple[Any, ...]] = []
    for run in study.drifts:
        if not len(run.t):
            rows.append((run.label, 0, None, None, None, None, None, run.failure))
            continue
        powers = [exponent(run.t, of) for of in (run.position, run.energy)]
        lost = run.energy[-1] if len(run.energy) else None
        failure = run.failure and f"fails after {run.t[-1]:.3g} s"
        rows.append((run.label, run.steps, run.position[-1], powers[0], run.velocity[-1], lost, powers[1], failure))
    title = f"drift over {study.steps} steps of {_seconds(study.h)} s, {study.step_text}"
    notes = [DRIFT_NOTE, *filter(None, [study.missing_energies])]
    if any(len(run.t) and not isfinite(exponent(run.t, run.position)) for run in study.drifts):
        notes.append("no powers of t where there is no drift, or where a run is too short")
    return StudyTable(DRIFT, tuple(rows), title, notes=tuple(notes))


FORMS = (
    StudyColumn("form"),
    StudyColumn("rule"),
    StudyColumn("g", magnitude, "|g|"),
    StudyColumn("gdot", magnitude, "|gdot|"),
    StudyColumn("ringing_first", magnitude, "ringing, first"),
    StudyColumn("ringing_last", magnitude, "last"),
    StudyColumn("iterations", fixed(1)),
    StudyColumn("quaternion", magnitude, "||e| - 1|", doc="of quaternions e, which no form keeps at unit length"),
    StudyColumn("condition", magnitude, doc="of the scaled iteration matrix"),
    StudyColumn("condition_power", fixed(1), "as h^"),
    StudyColumn("failure", head=""),
)
FORMS_NOTE = (
    "ringing: the part of the multipliers that alternates from step to step, over the largest, in the first and the "
    "last tenth of the run"
)


def _forms(study: MethodStudy) -> StudyTable:
    rows: list[tuple[Any, ...]] = []
    for run in study.forms:
        sizes = (run.position, run.velocity, run.early, run.late, run.iterations)
        known = (None,) * len(sizes) if run.failure else sizes
        after = (run.quaternion, run.conditions[0], run.exponent, run.failure)
        rows.append((FORM_NAMES[run.form], run.rule.value, *known, *after))
    title = f"formulations under one rule, steps of {_seconds(study.h)} s"
    table = StudyTable(FORMS, tuple(rows), title, 2, (FORMS_NOTE,))
    if any(run.quaternion is not None for run in study.forms):
        return table
    return table.only([column.name for column in FORMS if column.name != "quaternion"])


CONDITIONING = (
    StudyColumn("of", head=""),
    StudyColumn("least", general(3)),
    StudyColumn("most", general(3)),
    StudyColumn("worst_s", general(4), "worst at, s"),
)


def _conditioning(study: MethodStudy) -> StudyTable:
    c = study.conditioning
    rows = [_along("cond(M)", c.t, c.mass, int(np.argmax(c.mass)))]
    notes: tuple[str, ...] = ("condition numbers are in SI units",)
    if c.weakest:
        rows += [
            _along("cond(KKT)", c.t, c.kkt, int(np.argmax(c.kkt))),
            _along("smallest singular value of G", c.t, c.singular, int(np.argmin(c.singular))),
        ]
        notes = (
            f"{notes[0]}; G is scaled, so that its typical value is 1",
            f"the weakest constraints are {', '.join(c.weakest)}",
        )
    return StudyTable(CONDITIONING, tuple(rows), f"conditioning in {len(c.t)} states of {study.along}", notes=notes)


def _along(name: str, t: Vector, values: Vector, worst: int) -> tuple[Any, ...]:
    return name, float(values.min()), float(values.max()), float(t[worst])
