"""The stability of a ladder of models: as a table for a terminal, as CSV, and as plain data."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from derive.percentages import percent
from derive.study.accuracy.ladder_model import MODEL_COLUMNS, model_row
from derive.study.spin_notes import spin_notes
from derive.study.stability.ladder_stability import CONVERGED, LadderStability, distance
from derive.study.stability.model_path import ModelPath, PathPoint
from derive.study.stability.thresholds import Interval, Threshold
from derive.study.table import StudyColumn, StudyTable, columns, named
from derive.terminal import wrapped

MODE_COLUMNS = columns("parameter", "spin_rad_s", "growth_rate_1_s", "frequency_rad_s", "rounding_error_1_s", "grows")
"""The columns of a mode of a model at a value of the parameter."""


def stability_text(of: LadderStability) -> str:
    """The table of the models, and what is known of the truth."""
    lines = [head(of), *wrapped([*filter(None, [of.motion]), *truth_sentences(of)], "  "), "", *loss_table(of).text]
    return "\n".join([*lines, *wrapped(gap_sentences(of), "  ")])


def loss_table(of: LadderStability) -> StudyTable:
    """A row for each model: where it loses its stability, how far that is from the truth, and wrong verdicts."""
    truth = "exact" if of.known else "reference"
    shown = (
        *columns("model", "loses stability at"),
        StudyColumn(f"from the {truth}", lambda near: percent(near, signed=True)),
        *columns("further changes at", "wrong verdict"),
    )
    return StudyTable(shown, tuple(_row(of, path) for path in _listed(of) if not path.failure))


def gap_sentences(of: LadderStability) -> list[str]:
    """The models that fail, or have no steady motion at some values, for each reason; and bodies that spin fast."""
    models: dict[str, list[str]] = {}
    advice: dict[str, None] = {}
    for path in (path for path in _listed(of) if path.gaps or path.failure):
        models.setdefault(path.failure or gap_text(path), []).append(path.model.label)
        advice.update(dict.fromkeys(filter(None, [path.advice, *(point.advice for point in path.gaps)])))
    reasons = [f"{'; '.join(labels)}: {reason}" for reason, labels in models.items()]
    return [*reasons, *(f"advice: {text}" for text in advice), *_spin_notes(of)]


def _spin_notes(of: LadderStability) -> list[str]:
    return spin_notes((path.model.label, path.spins) for path in _listed(of))


def head(of: LadderStability) -> str:
    """The heading: the studied scene, the parameter, its range and the number of its values."""
    return f"{of.name}: stability of models over {of.range.name} = {_range(of)}, {of.range.count} values"


def _range(of: LadderStability) -> str:
    return f"{of.range.low:g} to {of.range.high:g}{f' {of.unit}' if of.unit else ''}"


def truth_sentences(of: LadderStability) -> list[str]:
    """The sentences on the truth with which the verdicts are compared, and on its certainty."""
    richest = f"the reference is the richest model, {of.reference.model.label}"
    result = []
    if of.known is not None:
        at = "never lost" if of.known.value is None else f"lost at {of.known.value:.7g}, exactly"
        result.append(f"given: stability is {at}")
    if of.reference.failure:
        return [*result, f"{richest}, which fails: {of.reference.failure}"]
    before = of.before.model.label
    if of.reference.loss is None:
        result.append(
            f"{richest}, which keeps its stability" + (" where it moves steadily" if of.reference.gaps else "")
        )
    elif of.error is not None:
        result.append(f"{richest}, {of.reference.loss:.7g}; {before} differs by {of.error:.1e}")
    if not of.converged:
        result.append(f"the reference has not converged: {_difference(of)}")
    return result


def _difference(of: LadderStability) -> str:
    """The text on why the reference has not converged."""
    before = of.before.model.label
    if of.before.failure:
        return f"{before} fails: {of.before.failure}"
    if gaps := [path.model.label for path in (of.reference, of.before) if path.gaps]:
        return f"no steady motion is known at some values of {' and '.join(gaps)}"
    if (of.reference.loss is None) == (of.before.loss is None):
        return f"the verdict of {before} differs over more than {100 * CONVERGED:g} % of a threshold"
    return f"{before} " + ("keeps its stability" if of.before.loss is None else f"loses it at {of.before.loss:.7g}")


def _listed(of: LadderStability) -> Sequence[ModelPath]:
    """The models of the ladder, and the reference behind them if it is not one of them."""
    return of.paths if of.reference in of.paths else (*of.paths, of.reference)


def _row(of: LadderStability, path: ModelPath) -> tuple[Any, ...]:
    return (
        path.model.label,
        loss_text(path),
        distance(path.loss, of.true_loss),
        ", ".join(f"{c.value:.7g}" for c in further(path)),
        "; ".join(verdict_text(interval) for interval in of.wrong(path)) if of.converged else "undecided",
    )


def loss_text(path: ModelPath) -> str:
    """The text of the value at which stability is lost; "not found" if some values have no steady motion."""
    if path.loss is not None:
        return f"{path.loss:.7g}"
    return "not found" if path.gaps else "not lost"


def further(path: ModelPath) -> tuple[Threshold, ...]:
    """The thresholds behind the first loss of stability."""
    return tuple(c for c in path.thresholds if c.value != path.loss)


def verdict_text(wrong: Interval) -> str:
    """The text of a wrong verdict: that of the model, and its interval."""
    return f"{'stable' if wrong.stable else 'unstable'} from {wrong.low:.7g} to {wrong.high:.7g}"


def gap_text(path: ModelPath) -> str:
    """The text on where a model has no steady motion, and why."""
    first, last = path.gaps[0], path.gaps[-1]
    where = (
        f"at {first.value:g}" if first is last else f"at {len(path.gaps)} values from {first.value:g} to {last.value:g}"
    )
    return f"no steady motion {where}: {first.failure}"


def _with_advice(of: ModelPath | PathPoint) -> str:
    """The failure and the advice on it as one text; empty if there is none."""
    return "; ".join(filter(None, (of.failure, of.advice)))


def mode_table(of: LadderStability) -> StudyTable:
    """A row for each mode of each model at each value of the parameter; one for a conjugate pair."""
    rows = []
    for path in _listed(of):
        for point in path.points:
            if point.eigenvalues is None:
                continue
            known = point.eigenvalues
            for value, error, grows in zip(known.values, known.errors, known.grows, strict=True):
                numbers = (point.value, known.spin, float(value.real), float(value.imag), float(error), bool(grows))
                rows.append((*model_row(path.model, path.model.label), *numbers))
    return StudyTable((*MODEL_COLUMNS, *MODE_COLUMNS), tuple(rows))


def stability_data(of: LadderStability) -> dict[str, Any]:
    """The whole study as plain data, without the eigenvalues."""
    return {
        "name": of.name,
        "parameter": {
            "name": of.range.name,
            "unit": of.unit,
            "from": of.range.low,
            "to": of.range.high,
            "values": of.range.count,
        },
        "linearised_about": of.motion,
        "notes": _spin_notes(of),
        "exact": None if of.known is None else {"loss": of.known.value},
        "reference": {
            "model": of.reference.model.label,
            "loss": of.reference.loss,
            "error": of.error,
            "converged": of.converged,
        },
        "models": [
            {
                **named(MODEL_COLUMNS, model_row(path.model, path.model.label)),
                "coordinates": path.coordinates,
                "loss": path.loss,
                "distance_to_exact": None if of.known is None else distance(path.loss, of.known.value),
                "distance_to_reference": distance(path.loss, of.reference.loss),
                "thresholds": [
                    {"low": c.low, "high": c.high, "growing_before": c.before, "growing_after": c.after}
                    for c in path.thresholds
                ],
                "wrong": [{"from": w.low, "to": w.high, "stable": w.stable} for w in of.wrong(path)]
                if of.converged
                else None,
                "without_steady_motion": [{"value": p.value, "reason": _with_advice(p)} for p in path.gaps],
                "failure": _with_advice(path),
            }
            for path in _listed(of)
        ],
    }
