"""Implicit integration of a compiled scene by IDA of SUNDIALS, through the Python package scikit-sundae."""

from __future__ import annotations

import time
import warnings
from collections.abc import Sequence
from importlib import import_module
from typing import Any, Literal, Protocol

import numpy as np
from scipy.sparse import csc_array

from derive.ir.patterns import Pattern
from derive.runtime.native_call import ModelError, Vector
from derive.simulation.compiled_scene import ConstrainedSystem
from derive.simulation.errors import DriftTooLarge, SimulationError
from derive.simulation.integration.failure_diagnosis import diagnose_error, diagnose_failure
from derive.simulation.integration.solution import Cost, Progress, Solution, SolutionWriter, row_times

NO_ERROR_CONTROL = 1e30
"""The absolute tolerance of multipliers, so that error control and Newton's method consider q and v alone: in a short
step, rounding errors of q and v change the multipliers by more than any useful tolerance."""
STALL_STEPS, STALL_PROGRESS = 2000, 1e-9
"""The number of steps in which IDA has to advance by this fraction of the whole time. IDA itself continues even if its
steps no longer change the time."""


class Form(Protocol):
    """A form F(t, y, ydot) = 0 of `NativeScene.dae`: y = [q; v; lambda], or [q; v; lambda; mu] if stabilised."""

    size: int
    pattern: Pattern

    def residual(self, t: float, y: Vector, ydot: Vector, k: Vector) -> Vector:
        """The residual F (size,)."""

    def jacobian(self, t: float, y: Vector, ydot: Vector, cj: float, k: Vector) -> Vector:
        """The values of the iteration matrix dF/dy + cj dF/dydot by columns."""


class ImplicitSystem(ConstrainedSystem, Protocol):
    """A mechanism with its implicit forms."""

    dae: dict[str, Any]


class IdaMissing(SimulationError):
    """The package scikit-sundae is not installed."""


def integrate_ida(
    native: ImplicitSystem,
    k: Vector,
    q: Vector,
    v: Vector,
    times: Sequence[float] | Vector,
    *,
    form: Literal["ggl", "index1"] = "ggl",
    tolerance: float = 1e-6,
    order: int = 5,
    drift: float = 1e-9,
    projected: bool = True,
    max_step: float = 0.0,
    progress: Progress | None = None,
) -> Solution:
    """The motion of a compiled scene from a consistent state, by the variable-order BDF of IDA.

    native, k, q, v, times, tolerance, drift, progress: as for `integrate`. form: the equations, of `native.dae`; the
    stabilised form of index 2 ("ggl") keeps the state on the constraints, "index1" lets it drift. order: the highest
    order; 2 steps over vibrations that orders 3 to 5 have to resolve with short steps, and damps them. projected:
    whether rows are projected; the state of IDA never is. max_step: in s, 0 for none.

    Raises IdaMissing without the package scikit-sundae, and what `integrate` raises.
    """
    began = time.process_time()
    instants = row_times(times)
    rows = SolutionWriter(native, k, len(instants), drift, projected)
    solver = _solver(native.dae[form], native, k, tolerance, order, max_step)
    n = native.nq + native.nv
    t, y, reached = float(instants[0]), np.concatenate([q, v]), None
    steps, calls, mark = 0, 0, t
    try:
        rows.append(t, y)
        reached = solver.init_step(t, *_initial(native, k, t, q, v, native.dae[form].size))
        for at in instants[1:]:
            while t < at:
                reached = _step(solver, at, "onestep", instants[-1])
                calls, steps = calls + 1, steps + (reached.t > t)  # a call after a row gives the last step again
                if not reached.success:
                    raise diagnose_failure(native, k, t, y, None, f"IDA: {reached.message}")
                if calls % STALL_STEPS == 0:
                    if reached.t - mark < STALL_PROGRESS * (instants[-1] - instants[0]):
                        raise diagnose_failure(native, k, t, y, None, f"{STALL_STEPS} steps of IDA make no progress")
                    mark = reached.t
                t, y = reached.t, reached.y[:n]
                if progress is not None:
                    progress(t)
            rows.append(float(at), _step(solver, at, "normal", instants[-1]).y[:n] if t > at else y)
    except (ModelError, DriftTooLarge) as error:
        raise diagnose_error(native, k, t, y, error) from error
    cost = Cost(reached.nfev if reached else 0, steps, time.process_time() - began, reached.njev if reached else 0)
    return rows.solution(instants, cost)


def _step(solver: Any, at: float, method: str, last: float) -> Any:
    """The result of a step of IDA towards `at`, s, that never passes `last`, s."""
    return solver.step(float(at), method=method, tstop=float(last))


def _solver(form: Form, native: ConstrainedSystem, k: Vector, tolerance: float, order: int, max_step: float) -> Any:
    """IDA with the sparse solver SuperLU_MT and the compiled Jacobian."""
    try:
        ida = import_module("sksundae.ida").IDA
    except ImportError as error:
        raise IdaMissing("IDA needs the package scikit-sundae: pip install 'tisserand[ida]'") from error

    def residual(t: float, y: Vector, ydot: Vector, out: Vector) -> None:
        out[:] = form.residual(t, y, ydot, k)

    def jacobian(t: float, y: Vector, ydot: Vector, _: Vector, cj: float, out: Vector) -> None:
        out[:] = form.jacobian(t, y, ydot, cj, k)

    n, p = native.nq + native.nv, form.pattern
    absolute = np.full(form.size, NO_ERROR_CONTROL)
    absolute[:n] = tolerance
    indices = (np.array(p.rowidx, dtype=np.int32), np.array(p.colptr, dtype=np.int32))  # as the package is built
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Custom sparse Jacobian")  # harmless, as jacfn is given
        return ida(
            residual,
            jacfn=jacobian,
            linsolver="sparse",
            sparsity=csc_array((np.ones(len(p.rowidx)), *indices), shape=(form.size, form.size)),
            algebraic_idx=list(range(n, form.size)),
            rtol=tolerance,
            atol=absolute,
            max_order=order,
            max_step=max_step,
            max_num_steps=1_000_000,
        )


def _initial(native: ConstrainedSystem, k: Vector, t: float, q: Vector, v: Vector, size: int) -> tuple[Vector, Vector]:
    """The initial y and ydot (size,): accelerations and multipliers from `solve`, zero multipliers mu."""
    vdot, lam = native.solve(t, q, v, k)
    rest = np.zeros(size - len(q) - len(v) - len(lam))
    return np.concatenate([q, v, lam, rest]), np.concatenate([v, vdot, np.zeros(len(lam) + len(rest))])
