"""The files of a finished sweep, from which `--resume` takes the result where no samples are left to compute."""

from __future__ import annotations

import json
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from derive.artifacts import MARK, sha256
from derive.study.sweep.plan import Plan
from derive.study.sweep.result import SweepResult

IDENTITY = "identity"
"""The key of the record for everything on which the results depend, by a name for each part."""


def finished_sweep(folder: Path, name: str, plan: Plan) -> tuple[SweepResult, dict[str, Any]] | None:
    """The result of a finished sweep with its data as plain data, if the files in a folder are those of this plan.

    name: that of the files without their endings. The result has no notes and warnings; the data have them.
    """
    record = _record(folder / f"{name}.json")
    files = record.get("files")
    if record.get(IDENTITY) != dict(plan.identity) or not isinstance(files, Mapping):
        return None
    try:
        if any(sha256((folder / file).read_bytes()) != digest for file, digest in files.items()):
            return None
        with np.load(folder / f"{name}.npz", allow_pickle=False) as arrays:
            values = np.array(arrays["values"], dtype=np.float64)
            texts = [str(text) for text in arrays["failures"]]
    except (OSError, ValueError, KeyError, zipfile.BadZipFile):
        return None
    count = len(plan.runs)
    result = SweepResult(
        plan.name,
        plan.samples,
        plan.outputs,
        values,
        {number: text for number, text in enumerate(texts) if text},
        {},
        {},
        len(plan.models),
        plan.initial_states,
        plan.units,
        resumed=count,
    )
    kept = {key: value for key, value in record.items() if key not in ("generator", "files", IDENTITY)}
    return result, {**kept, "resumed": count, "damaged": 0}


def _record(path: Path) -> dict[str, Any]:
    """The record of a sweep; empty if there is none that this program wrote."""
    try:
        content = path.read_bytes()
        record = json.loads(content) if MARK.encode() in content[:1000] else {}
    except (OSError, ValueError):
        return {}
    return record if isinstance(record, dict) else {}
