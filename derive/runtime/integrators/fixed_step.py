"""The Runge-Kutta method of order 4 in C, with fixed steps and projection, compiled with a model."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from derive.artifacts import File
from derive.runtime.integrators.c_integrator import (
    CONSISTENT,
    STOPPED,
    Array,
    CIntegrator,
    Integration,
    check_numbers,
    check_steps,
    checked_result,
    fields,
    timed,
    times,
    types,
)
from derive.runtime.integrators.observer import Observe, Observer


class _FixedCounts(ctypes.Structure):
    _fields_ = fields("steps", "accelerations", "constraints", "corrections")


class FixedStep(CIntegrator):
    """The Runge-Kutta method of order 4, `templates/host/fixed_step.h`."""

    def __init__(self, files: Sequence[File], flags: Sequence[str] = ()) -> None:
        super().__init__(files, ["fixed_step"], flags)
        self.library.tisserand_rk4.argtypes = types("pddllpdpppppp")
        self.library.tisserand_rk4_batch.argtypes = types("piddllpdpppppp")

    def run(
        self,
        q0: ArrayLike,
        v0: ArrayLike,
        *,
        step: float,
        steps: int,
        every: int = 1,
        k: ArrayLike | None = None,
        t0: float = 0.0,
        project: bool = True,
        tolerance: float = CONSISTENT,
        observe: Observe | None = None,
    ) -> Integration:
        """Integrate from the state q0 (nq,), v0 (nv,), or each row of these; rows at t0 and after every `every` steps.

        `project` keeps constraints and their rates below `tolerance`, from the first state on. `observe` follows the
        rows of a single state. Raises IntegratorError.
        """
        check_steps(steps, every)
        check_numbers(t0=t0, step=step, tolerance=tolerance)
        q, v = self.states(q0, v0)
        states = q.shape[:-1]
        rows: Array = np.empty((*states, steps // every + 1, self.width))
        work, counts = np.empty(self.library.tisserand_fixed_work(self.model)), _FixedCounts()
        given = (t0, step, steps, every, self.constants(k), tolerance if project else 0.0, q, v, rows)
        if states:
            if observe is not None:
                raise ValueError("many states have no observer; integrate each by a call of its own")
            number = int(np.prod(states))
            codes = np.zeros(max(number, 1), dtype=np.intc)
            batch = self.library.tisserand_rk4_batch
            code, seconds = timed(batch, self.model, number, *given, codes, work, ctypes.byref(counts))
        else:
            observer = Observer(observe, self.width)
            rk4 = self.library.tisserand_rk4
            with observer.interrupts():
                code, seconds = timed(rk4, self.model, *given, observer.pointer, work, ctypes.byref(counts))
            observer.reraise()
        t = times(t0, step * every, steps // every + 1)
        return checked_result(self.native.name, code, self.integration(t, rows, counts, seconds, code == STOPPED))
