"""The modes of a model as files: a table (CSV), the state-space matrices (NumPy), and the record of both (JSON)."""

from __future__ import annotations

import io
import json
from typing import Any

import numpy as np

from derive.artifacts import MARK, BinaryFile, File, sha256
from derive.backends.model_files import fingerprint
from derive.simulation.linear.modes import Modes
from derive.simulation.linear.whirl import whirls
from derive.simulation.observables.csv_writer import Column, csv
from derive.version import VERSION


def mode_files(modes: Modes) -> tuple[File | BinaryFile, ...]:
    """NAME.modes.csv with a row for each mode, NAME.modes.npz with A, B, C, D, and NAME.modes.json, in the folder NAME.

    The record has `modes_data` with all digits, and the hashes of the specification and of the other two files.
    """
    stem = f"{modes.spec.name}.modes"
    folder, record = modes.spec.name, f"{modes.spec.name}/{stem}.json"
    table, matrices = csv(_columns(modes)), _state_space(modes)
    content = {
        "generator": f"{MARK} {VERSION}. Do not edit.",
        "specification_sha256": fingerprint(modes.spec),
        **modes_data(modes),
        "files": {f"{stem}.csv": sha256(table.encode()), f"{stem}.npz": sha256(matrices)},
    }
    return (
        File(f"{folder}/{stem}.csv", table, record=record),
        BinaryFile(f"{folder}/{stem}.npz", matrices, record=record),
        File(record, json.dumps(content, indent=2) + "\n"),
    )


def modes_data(modes: Modes) -> dict[str, Any]:
    """The modes as plain data, in SI units; a shape has the real and the imaginary part of each element.

    whirl: see `whirls`; None where there is none.
    """
    linear, circling = modes.linear, whirls(modes) or (None,) * len(modes.modes)
    return {
        "name": modes.spec.name,
        "time": linear.t,
        "q": linear.q.tolist(),
        "v": linear.v.tolist(),
        "vdot": linear.vdot.tolist(),
        "equilibrium": modes.equilibrium is not None,
        "steady": None if modes.steady is None else {"motion": modes.steady.text, "spin": modes.steady.spin},
        "functions_of_time": list(modes.functions_of_time),
        "notes": list(modes.notes),
        "coordinates": list(modes.native.coordinates),
        "zero_eigenvalues": modes.zero_eigenvalues,
        "modes": [
            {
                "frequency": mode.frequency,
                "damping_ratio": mode.damping_ratio,
                "eigenvalue": [mode.eigenvalue.real, mode.eigenvalue.imag],
                "shape": [mode.shape.real.tolist(), mode.shape.imag.tolist()],
                "whirl": whirl,
            }
            for mode, whirl in zip(modes.modes, circling, strict=True)
        ],
        "states": list(linear.states),
        "inputs": list(linear.inputs),
        "outputs": list(linear.outputs),
    }


def _columns(modes: Modes) -> list[Column]:
    """A row for each mode: its number, frequency, damping ratio, eigenvalue, and the elements of the shape."""
    count = len(modes.modes)
    values = np.array([mode.eigenvalue for mode in modes.modes], dtype=complex)
    shapes = np.array([mode.shape for mode in modes.modes], dtype=complex).reshape(count, modes.native.nq)
    columns = [
        Column("mode", "", np.arange(1.0, count + 1)),
        Column("frequency", "Hz", modes.frequencies),
        Column("damping_ratio", "", modes.damping_ratios),
        Column("eigenvalue_real", "1/s", values.real),
        Column("eigenvalue_imag", "rad/s", values.imag),
    ]
    for name, elements in zip(modes.native.coordinates, shapes.T, strict=True):
        columns += [Column(f"{name}_real", "", elements.real), Column(f"{name}_imag", "", elements.imag)]
    return columns


def _state_space(modes: Modes) -> bytes:
    """An uncompressed .npz with A, B, C, D, the names of states, inputs and outputs, and the state t, q, v."""
    linear = modes.linear
    arrays = {name: getattr(linear, name) for name in ("A", "B", "C", "D", "t", "q", "v")}
    names = {name: np.array(getattr(linear, name), dtype=np.str_) for name in ("states", "inputs", "outputs")}
    stream = io.BytesIO()
    np.savez(stream, allow_pickle=False, **arrays, **names)
    return stream.getvalue()
