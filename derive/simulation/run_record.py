"""The record of a run: units of its columns, how they were computed, and its last state, as a JSON file."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from derive.artifacts import MARK, File, sha256
from derive.backends.model_files import fingerprint
from derive.simulation.observables.csv_writer import csv
from derive.simulation.trajectory import Trajectory
from derive.spec.model.specification import AnyScene
from derive.version import VERSION

DRIFT_COLUMNS = 4
"""The drift numbers of each row in the record: the violations of g and gdot, after the projection and before it."""


def run_files(trajectory: Trajectory) -> tuple[File, File]:
    """The CSV file of a trajectory, and its record NAME.json, in the folder NAME.

    The CSV has nothing but names and numbers; the record has the units of its columns, the settings of the integrator,
    the hash of the specification, the values of the parameters, the notes, the drift of each row, the monitors of the
    beams with their warnings, and the last state with all digits.
    """
    name = trajectory.name
    table, record = f"{name}/{name}.csv", f"{name}/{name}.json"
    text = csv(trajectory.table)
    content = {**_content(trajectory), "files": {f"{name}.csv": sha256(text.encode())}}
    drift = np.hstack([trajectory.solution.drift, trajectory.solution.drift_before])
    written = f'{json.dumps(content, indent=2)[:-2]},\n  "drift": {json.dumps(drift.tolist())}\n}}\n'
    return File(table, text, record=record), File(record, written)


def _content(trajectory: Trajectory) -> dict[str, Any]:
    """The record as plain data, in SI units."""
    settings, solution = trajectory.settings, trajectory.solution
    simulation = settings.simulation
    return {
        "generator": f"{MARK} {VERSION}. Do not edit.",
        "name": trajectory.name,
        "specification_sha256": fingerprint(trajectory.spec),
        "integrator": settings.integrator,
        "tolerance": simulation.tolerance,
        "step": settings.step,
        "duration": simulation.duration,
        "output": simulation.output,
        "until": simulation.until,
        "parameters": {
            p.name: {"value": p.default, "unit": p.unit} for p in trajectory.model.parameters if p.size == 1
        },
        "columns": [{"name": column.name, "unit": column.unit} for column in trajectory.table],
        "notes": [*trajectory.notes],
        **_validity(trajectory),
        "last_state": {"t": float(solution.t[-1]), "q": solution.q[-1].tolist(), "v": solution.v[-1].tolist()},
    }


def _validity(trajectory: Trajectory) -> dict[str, Any]:
    """The data of the monitors of beams, and the warnings where a limit is passed; empty where there are no beams."""
    if not trajectory.validity:
        return {}
    return {"validity": [monitor.data for monitor in trajectory.validity], "warnings": [*trajectory.warnings]}


def recorded_warnings(record: Path, spec: AnyScene) -> tuple[str, ...]:
    """The warnings of the monitors in the record of a run of this scene; none if there is no such record."""
    try:
        content = json.loads(record.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return ()
    if not isinstance(content, dict) or content.get("specification_sha256") != fingerprint(spec):
        return ()
    warnings = content.get("warnings", [])
    return tuple(w for w in warnings if isinstance(w, str)) if isinstance(warnings, list) else ()
