"""Implicit integration of a compiled scene by IDA of SUNDIALS, through the Python package scikit-sundae."""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable, Sequence
from importlib import import_module
from typing import Any, Literal, Protocol

import numpy as np
from scipy.sparse import csc_array

from derive.ir.patterns import Pattern
from derive.runtime.native import ModelError, Vector
from derive.simulation.compiled_scene import Mechanism
from derive.simulation.errors import DriftTooLarge, SimulationError
from derive.simulation.integration.explicit import increasing
from derive.simulation.integration.failure_diagnosis import explained, reason_to_stop
from derive.simulation.integration.trajectory import Cost, Trajectory
from derive.simulation.integration.trajectory_writer import Rows

NO_ERROR_CONTROL = 1e30
"""The absolute tolerance of multipliers: steps and Newton's method look at q and v alone. What is rounding there is far
above any tolerance in the multipliers of a short step."""
STALL_STEPS, STALL_PROGRESS = 2000, 1e-9
"""After so many steps it is looked whether IDA has come further than that part of the whole time: it never gives up
where steps do not change the time any more."""


class Form(Protocol):
    """F(t, y, ydot) = 0 with y = [q; v; lambda], and the mu of the stabilised form, as `NativeScene.dae` has it."""

    size: int
    pattern: Pattern

    def residual(self, t: float, y: Vector, ydot: Vector, k: Vector) -> Vector:
        """F."""

    def jacobian(self, t: float, y: Vector, ydot: Vector, cj: float, k: Vector) -> Vector:
        """Values of dF/dy + cj dF/dydot."""


class ImplicitMechanism(Mechanism, Protocol):
    """A mechanism with its implicit forms."""

    dae: dict[str, Any]


class IdaMissing(SimulationError):
    """The package scikit-sundae is not there."""


def integrate_ida(
    native: ImplicitMechanism,
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
    progress: Callable[[float], None] | None = None,
) -> Trajectory:
    """The motion from the consistent state (q, v) at times[0], at all `times` (s, increasing), by variable-order BDF.

    As `integrate`, but that rows are projected, never the state of IDA: the stabilised form of index 2 ("ggl") keeps it
    on the constraints by itself, "index1" lets it drift. `order` 2 steps over vibrations that orders 3 to 5 have to
    follow with short steps, and damps them. `max_step` 0 is any.

    Raises IdaMissing besides.
    """
    began = time.process_time()
    instants = increasing(times)
    rows = Rows(native, k, len(instants), drift, projected)
    solver = _solver(native.dae[form], native, k, tolerance, order, max_step)
    n = native.nq + native.nv
    t, y, found = float(instants[0]), np.concatenate([q, v]), None
    steps, calls, mark = 0, 0, t
    try:
        rows.write(t, y)
        found = solver.init_step(t, *_initial(native, k, t, q, v, native.dae[form].size))
        for at in instants[1:]:
            while t < at:
                found = _step(solver, at, "onestep", instants[-1])
                calls, steps = calls + 1, steps + (found.t > t)  # a call after a row gives the last step again
                if not found.success:
                    raise reason_to_stop(native, k, t, y, None, f"IDA: {found.message}")
                if calls % STALL_STEPS == 0:
                    if found.t - mark < STALL_PROGRESS * (instants[-1] - instants[0]):
                        raise reason_to_stop(native, k, t, y, None, f"{STALL_STEPS} steps of IDA lead nowhere")
                    mark = found.t
                t, y = found.t, found.y[:n]
                if progress is not None:
                    progress(t)
            rows.write(float(at), _step(solver, at, "normal", instants[-1]).y[:n] if t > at else y)
    except (ModelError, DriftTooLarge) as error:
        raise explained(native, k, t, y, error) from error
    cost = Cost(found.nfev if found else 0, steps, time.process_time() - began, found.njev if found else 0)
    return rows.trajectory(instants, cost)


def _step(solver: Any, at: float, method: str, last: float) -> Any:
    return solver.step(float(at), method=method, tstop=float(last))


def _solver(form: Form, native: Mechanism, k: Vector, tolerance: float, order: int, max_step: float) -> Any:
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
    indices = (np.array(p.rowidx, dtype=np.int32), np.array(p.colptr, dtype=np.int32))  # the integers it is made for
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Custom sparse Jacobian")  # it is not used, as there is a Jacobian
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


def _initial(native: Mechanism, k: Vector, t: float, q: Vector, v: Vector, size: int) -> tuple[Vector, Vector]:
    """y and ydot: accelerations and multipliers are the model's, the multipliers of the stabilisation are zero."""
    vdot, lam = native.solve(t, q, v, k)
    rest = np.zeros(size - len(q) - len(v) - len(lam))
    return np.concatenate([q, v, lam, rest]), np.concatenate([v, vdot, np.zeros(len(lam) + len(rest))])
