"""Implicit integration of a compiled scene by IDA of SUNDIALS, through the Python package scikit-sundae."""

from __future__ import annotations

import time
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import Any, Literal, Protocol

import numpy as np
from scipy.sparse import csc_array

from derive.runtime.native_call import ModelError, Vector
from derive.simulation.compiled_scene import ConstrainedSystem
from derive.simulation.errors import DriftTooLarge, SimulationError
from derive.simulation.integration.failure_diagnosis import diagnose_error, diagnose_failure
from derive.simulation.integration.implicit_forms import Form, ProximalForm
from derive.simulation.integration.solution import Cost, Progress, Solution, SolutionWriter, row_times
from derive.simulation.integration.stop_event import StopEvent
from derive.simulation.integration.time_segments import smooth_ends
from derive.simulation.integration.tolerances import absolute_tolerances, rounding_note

NO_ERROR_CONTROL = 1e30
"""The absolute tolerance of multipliers, so that error control and Newton's method consider q and v alone: in a short
step, rounding errors of q and v change the multipliers by more than any useful tolerance."""
STALL_STEPS, STALL_PROGRESS = 2000, 1e-9
"""The number of steps in which IDA has to advance by this fraction of the whole time. IDA itself continues even if its
steps no longer change the time."""


class ImplicitSystem(ConstrainedSystem, Protocol):
    """A mechanism with its implicit forms."""

    @property
    def dae(self) -> Mapping[str, Form]:
        """The forms by their names."""


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
    size: float = 1.0,
    order: int = 5,
    drift: float = 1e-9,
    projected: bool = True,
    max_step: float = 0.0,
    breaks: Sequence[float] = (),
    until: StopEvent | None = None,
    progress: Progress | None = None,
) -> Solution:
    """The motion of a compiled scene from a consistent state, by the variable-order BDF of IDA.

    native, k, q, v, times, tolerance, size, drift, breaks, until, progress: as for `integrate`. form: the equations, of
    `native.dae`; the stabilised form of index 2 ("ggl") keeps the state on the constraints, "index1" lets it drift.
    order: the highest order; 2 steps over vibrations that orders 3 to 5 have to resolve with short steps, and damps
    them. projected: whether rows are projected, and the state from which IDA starts anew at a break; its internal
    state never is. max_step: in s, 0 for none.

    Where joints are redundant, a proximal term keeps the iteration matrix regular; singular positions stop IDA.

    Raises IdaMissing without the package scikit-sundae, and what `integrate` raises.
    """
    began = time.process_time()
    instants = row_times(times)
    rows = SolutionWriter(native, k, instants, drift, projected, until)
    ends = smooth_ends(instants, breaks)
    absolute, notes = absolute_tolerances(native, tolerance, size, q), rounding_note(tolerance, q)
    t, y, mark = float(instants[0]), np.concatenate([q, v]), float(instants[0])
    steps, calls, done = 0, 0, list[_Segment]()
    equations = ProximalForm(native.dae[form], len(y)) if native.proximal else native.dae[form]

    def cost() -> Cost:
        evaluations, jacobians = (sum(getattr(segment.result, name) for segment in done) for name in ("nfev", "njev"))
        return Cost(evaluations, steps, time.process_time() - began, jacobians)

    try:
        rows.append(t, y)
        while rows.count < len(instants):
            end = ends.pop(0)
            latest = float(np.nextafter(end, t)) if ends else end
            segment = _Segment(_solver(equations, k, tolerance, absolute, order, max_step, latest), end, len(y))
            done.append(segment)
            segment.start(t, *_initial(native, k, t, y[: native.nq], y[native.nq :], equations.size))
            while t < end:
                before, calls = t, calls + 1
                reached, state = segment.step(min(rows.following, end))
                if not segment.result.success:
                    raise diagnose_failure(native, k, t, y, None, f"IDA: {segment.result.message}")
                if calls % STALL_STEPS == 0:
                    if reached - mark < STALL_PROGRESS * (instants[-1] - instants[0]):
                        raise diagnose_failure(native, k, t, y, None, f"{STALL_STEPS} steps of IDA make no progress")
                    mark = reached
                if reached == t:  # a call after an interpolation gives the last step again
                    continue
                t, y, steps = reached, state, steps + 1
                stop = rows.stop_time(before, t, segment.dense)
                if stop is not None:
                    return rows.stopped_solution(stop, segment.dense, cost(), notes)
                while rows.count < len(instants) and rows.following <= t:
                    rows.append(rows.following, segment.dense(rows.following) if rows.following < t else y)
                if progress is not None:
                    progress(t)
            y = rows.projected_state(t, y) if projected and ends else y
    except (ModelError, DriftTooLarge) as error:
        raise diagnose_error(native, k, t, y, error) from error
    return rows.solution(cost(), notes)


@dataclass
class _Segment:
    """IDA between two breaks, up to `end` (s). Its states begin with `size` elements [q; v]. `result`: the last one."""

    solver: Any
    end: float
    size: int
    result: Any = None

    def start(self, t: float, y: Vector, ydot: Vector) -> None:
        """Begin at t (s) with a consistent y and ydot."""
        self.result = self.solver.init_step(t, y, ydot)

    def step(self, towards: float) -> tuple[float, Vector]:
        """The time (s) and the state [q; v] after a step towards a time, which it may pass, though not `end`."""
        self.result = self.solver.step(towards, method="onestep", tstop=self.end)
        return float(self.result.t), self.result.y[: self.size]

    def dense(self, t: float) -> Vector:
        """The state [q; v] at a time (s) within the last step."""
        return np.asarray(self.solver.step(t, method="normal", tstop=self.end).y[: self.size])


def _solver(
    form: Form, k: Vector, tolerance: float, absolute: Vector, order: int, max_step: float, latest: float
) -> Any:
    """IDA with the sparse solver SuperLU_MT and the compiled Jacobian.

    absolute: the absolute tolerances (nq + nv,) of q and v. latest: the last time at which the model is evaluated, s.
    """
    try:
        ida = import_module("sksundae.ida").IDA
    except ImportError as error:
        raise IdaMissing("IDA needs the package scikit-sundae: pip install 'tisserand[ida]'") from error

    def residual(t: float, y: Vector, ydot: Vector, out: Vector) -> None:
        out[:] = form.residual(min(t, latest), y, ydot, k)

    def jacobian(t: float, y: Vector, ydot: Vector, _: Vector, cj: float, out: Vector) -> None:
        out[:] = form.jacobian(min(t, latest), y, ydot, cj, k)

    n, p = len(absolute), form.pattern
    every = np.concatenate([absolute, np.full(form.size - n, NO_ERROR_CONTROL)])
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
            atol=every,
            max_order=order,
            max_step=max_step,
            max_num_steps=1_000_000,
        )


def _initial(native: ConstrainedSystem, k: Vector, t: float, q: Vector, v: Vector, size: int) -> tuple[Vector, Vector]:
    """The initial y and ydot (size,): accelerations and multipliers from `solve`, zero multipliers mu."""
    vdot, lam = native.solve(t, q, v, k)
    rest = np.zeros(size - len(q) - len(v) - len(lam))
    qdot = v if len(q) == len(v) else native.rates(q, v, k)  # in the plane both are the same
    return np.concatenate([q, v, lam, rest]), np.concatenate([qdot, vdot, np.zeros(len(lam) + len(rest))])
