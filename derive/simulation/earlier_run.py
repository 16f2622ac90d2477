"""A run that has been written to files, and that another one continues from its last state."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from derive.artifacts import settle, sha256
from derive.backends.model_files import fingerprint
from derive.ir.model import Model
from derive.runtime.native_call import Matrix, Vector
from derive.simulation.errors import SimulationError
from derive.simulation.integration.solution import Solution
from derive.spec.model.body import NodalBody
from derive.spec.model.specification import AnyScene


class NothingToResume(SimulationError):
    """There is no run that can be continued: its files are missing or changed, or they are of another model."""


@dataclass(frozen=True, eq=False)
class EarlierRun:
    """The rows of an earlier run, columns by their names, and its last state q (nq,), v (nv,) at t (s), all digits.

    drift (n, 4): the drift of each row, after its projection and before it, see `Solution`.
    """

    columns: dict[str, Vector]
    drift: Matrix
    t: float
    q: Vector
    v: Vector

    def times(self, times: Vector) -> Vector:
        """The last time and those after it of the rows (n,), s. Raises NothingToResume if there are none."""
        later = times[times > self.t * (1 + 1e-12)]
        if not len(later):
            raise NothingToResume(f"the earlier run has reached {self.t:g} s already; give a longer duration")
        return np.concatenate([[self.t], later])

    def continued(self, model: Model, solution: Solution) -> Solution:
        """The earlier rows and those of a solution that begins with the last state."""
        q, v = (
            self._matrix([name for x in each for name in x.columns]) for each in (model.coordinates, model.velocities)
        )
        lam = self._matrix([f"lambda_{name}" for x in model.multipliers for name in x.columns])
        return replace(
            solution,
            t=np.concatenate([self.columns["t"][:-1], solution.t]),
            q=np.vstack([q[:-1], solution.q]),
            v=np.vstack([v[:-1], solution.v]),
            lam=np.vstack([lam[:-1], solution.lam]),
            drift=np.vstack([self.drift[:-1, :2], solution.drift]),
            drift_before=np.vstack([self.drift[:-1, 2:], solution.drift_before]),
            outputs=None,  # the earlier run has not kept the outputs that monitor its model
            watched=None,
            notes=(f"resumed at t = {self.t:.9g} s, after {len(q)} rows", *solution.notes),
        )

    def _matrix(self, names: list[str]) -> Matrix:
        """The columns (n, names) of these names."""
        rows = len(self.columns["t"])
        return np.column_stack([self.columns[name] for name in names]) if names else np.zeros((rows, 0))


def read_run(folder: Path, spec: AnyScene | NodalBody) -> EarlierRun:
    """The run of a specification whose files are in a folder.

    Raises NothingToResume if there is none, if its files have been changed, or if it is of another specification.
    """
    name = spec.name
    settle(folder)
    record_file, table_file = folder / name / f"{name}.json", folder / name / f"{name}.csv"
    try:
        record: dict[str, Any] = json.loads(record_file.read_bytes())
        table = table_file.read_bytes()
        same = record["files"][table_file.name] == sha256(table)
        last, given = record["last_state"], record["specification_sha256"]
        drift = np.array(record["drift"], dtype=np.float64)
    except OSError as error:
        raise NothingToResume(f"{error.filename}: there is no earlier run to resume: {error.strerror}") from None
    except (ValueError, KeyError, TypeError):
        raise NothingToResume(f"{record_file}: this is no record of a run; run without --resume") from None
    if not same:
        raise NothingToResume(f"{table_file}: it is not as the earlier run wrote it; run without --resume")
    if given != fingerprint(spec):
        raise NothingToResume(
            f"{record_file}: the earlier run is of another specification or other values; make them the same, or run "
            "without --resume"
        )
    header, *rows = table.decode().splitlines()
    numbers = np.array([[float(cell) for cell in row.split(",")] for row in rows])
    columns = dict(zip(header.split(","), numbers.T, strict=True))
    return EarlierRun(columns, drift, float(last["t"]), np.array(last["q"]), np.array(last["v"]))
