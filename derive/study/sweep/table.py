"""The numbers of a sweep: as text for a terminal, as CSV, as NPZ, and as plain data."""

from __future__ import annotations

import io
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from derive.spec.set_values import SetValue
from derive.study.sweep.plan import Plan
from derive.study.sweep.result import SweepResult
from derive.study.sweep.samples import Samples
from derive.study.table import StudyColumn, StudyTable, columns, general

SHOWN = 5
"""The largest numbers of reasons and of notes that are printed."""


def sample_table(result: SweepResult) -> StudyTable:
    """A row for each sample: its values, its outputs with all digits, and its failure, if any."""
    both = zip(result.samples.values.tolist(), result.values.tolist(), strict=True)
    rows = tuple((*given, *values, result.failures.get(number, "")) for number, (given, values) in enumerate(both))
    return StudyTable(columns(*result.samples.names, *result.labels, "failure"), rows)


def sweep_npz(result: SweepResult) -> bytes:
    """The NPZ file: `names`, `samples` (n, names), `outputs`, `values` (n, outputs), `shape` of a grid, `failures`.

    They are read by `numpy.load(path)`; `values[:, 0].reshape(shape)` is the first output on a grid.
    """
    stream = io.BytesIO()
    failures = [result.failures.get(number, "") for number in range(len(result.samples))]
    np.savez(
        stream,
        names=np.array(result.samples.names),
        samples=result.samples.values,
        outputs=np.array(result.labels),
        values=result.values,
        shape=np.array(result.samples.shape, dtype=np.int64),
        failures=np.array(failures),
    )
    return stream.getvalue()


def sweep_data(result: SweepResult, plan: Plan) -> dict[str, Any]:
    """The sweep as plain data, without its values."""
    return {
        "name": result.name,
        "samples": len(result.samples),
        "shape": list(result.samples.shape),
        "names": [
            {"name": name, "values": len(axis), "least": float(axis.min()), "largest": float(axis.max())}
            for name in result.samples.names
            for axis in (result.samples.axis(name),)
        ],
        "set": [asdict(change) for change in plan.changes],
        "models": result.models,
        "initial_states": result.initial_states,
        "resumed": result.resumed,
        "damaged": result.damaged,
        "outputs": [_output(result, number) for number in range(len(result.outputs))],
        "failed": len(result.failures),
        "failures": _listed(result, result.reasons()),
        "notes": _listed(result, result.remarks()),
        "warnings": [
            {"sample": result.sample(number), "text": text}
            for number, texts in result.warnings.items()
            for text in texts
        ],
    }


def _output(result: SweepResult, number: int) -> dict[str, Any]:
    output, values = result.outputs[number], result.values[:, number]
    least, largest = int(np.nanargmin(values)), int(np.nanargmax(values))
    return {
        "name": output.label,
        "unit": output.unit,
        "least": {"value": float(values[least]), "at": result.sample(least)},
        "largest": {"value": float(values[largest]), "at": result.sample(largest)},
    }


def _listed(result: SweepResult, texts: Iterator[tuple[str, tuple[int, ...]]]) -> list[dict[str, Any]]:
    """Texts with the samples that have them: how many, the first one, and the rows of all in the table, from 0."""
    return [
        {"text": text, "samples": len(numbers), "first": result.sample(numbers[0]), "rows": list(numbers)}
        for text, numbers in texts
    ]


def sweep_text(data: dict[str, Any], samples: Samples) -> str:
    """The sweep as text."""
    lines = [_changed(SetValue(**change), samples) for change in data["set"]]
    grid = f", a grid of {' x '.join(map(str, data['shape']))}" if len(data["shape"]) > 1 else ""
    lines.append(f"{data['name']}: {_count(data['samples'], 'sample')}{grid}")
    counts = f"  {_count(data['models'], 'compiled model')}, {_count(data['initial_states'], 'initial state')}"
    if data["resumed"] == data["samples"]:
        there = "the only sample is" if data["samples"] == 1 else f"all {data['samples']} samples are"
        counts += f"; {there} finished already, so nothing is computed again"
    elif data["resumed"]:
        counts += f", {_count(data['resumed'], 'sample')} resumed"
    lines.append(counts)
    if data["damaged"]:
        lines.append(
            f"  note: the file of the interrupted sweep has {_count(data['damaged'], 'damaged line')}; the samples of "
            "damaged lines are computed again"
        )
    lines += _extremes(data["outputs"], samples).text
    if data["failed"]:
        lines.append(f"  warning: {_count(data['failed'], 'sample')} failed and have no values (nan):")
        lines += _texts(data["failures"], samples)
    if data["notes"]:
        lines.append("  notes of runs:")
        lines += _texts(data["notes"], samples)
    for warning in data["warnings"]:
        lines.append(f"  warning: at {sample_text(warning['sample'], samples)}: {warning['text']}")
    return "\n".join(lines)


def _extremes(outputs: Sequence[dict[str, Any]], samples: Samples) -> StudyTable:
    """The smallest and the largest value of each output, and the samples that have them."""
    at = StudyColumn("at", lambda sample: sample_text(sample, samples))
    shown = (
        StudyColumn("output", head=""),
        StudyColumn("minimum", general(6)),
        at,
        StudyColumn("maximum", general(6)),
        at,
    )
    rows = []
    for output in outputs:
        ends = (output["least"]["value"], output["least"]["at"], output["largest"]["value"], output["largest"]["at"])
        rows.append((", ".join(filter(None, (output["name"], output["unit"]))), *ends))
    return StudyTable(shown, tuple(rows))


def _changed(change: SetValue, samples: Samples) -> str:
    name = next((name for name in (change.key, change.symbol) if name in samples.names), None)
    if name is None or len(axis := samples.axis(name)) == 1:
        return f"set {change}"
    parameter = f", the parameter {change.symbol}" if change.symbol else ""
    return f"set {change.key}: {change.old} -> {len(axis)} values, {axis.min():g} ... {axis.max():g}{parameter}"


def _texts(listed: Sequence[dict[str, Any]], samples: Samples) -> list[str]:
    lines = [
        f"    {_count(item['samples'], 'sample')}, the first at {sample_text(item['first'], samples)}: {item['text']}"
        for item in listed[:SHOWN]
    ]
    return [*lines, *([f"    and {len(listed) - SHOWN} others, see sweep.json"] if len(listed) > SHOWN else [])]


def sample_text(sample: dict[str, float], samples: Samples) -> str:
    """The text of a sample: its values by the names that vary, shortened to their last part where that is unique."""
    short = short_names(samples)
    return ", ".join(f"{short[name]} = {sample[name]:.6g}" for name in samples.varying or samples.names)


def short_names(samples: Samples) -> dict[str, str]:
    """The names of a sweep, each shortened to the last parts of its key with which no other one ends."""
    parts_of = {key: key.split(".") for key in samples.names}
    ends = {name: [".".join(parts[k:]) for k in range(len(parts))] for name, parts in parts_of.items()}
    every = [end for each in ends.values() for end in each]
    return {name: next((end for end in reversed(each) if every.count(end) == 1), name) for name, each in ends.items()}


def _count(number: int, what: str) -> str:
    return f"{number} {what}{'' if number == 1 else 's'}"
