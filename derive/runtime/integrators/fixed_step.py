"""The Runge-Kutta method of order 4 in C, with fixed steps and projection, compiled with a model."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from derive.artifacts import File
from derive.runtime.integrators.c_integrator import (
    CONSISTENT,
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
from derive.runtime.integrators.observer import Observe


class _FixedCounts(ctypes.Structure):
    _fields_ = fields("steps", "accelerations", "constraints", "corrections")


class FixedStep(CIntegrator):
    """The Runge-Kutta method of order 4 with fixed steps and projection, `templates/host/fixed_step.h`, and a model.

    Arguments:
        files: those of `model_files`.
        flags: further ones of the compiler.

    Raises:
        CompilerError: if there is no compiler.
        ValueError: unless there is one C file among the files.
        TypeError: for anything but files.

    Examples:
        >>> import derive
        >>> ball = derive.scene("ball", gravity=(0, -10), bodies={"ball": {"mass": 1, "inertia": 1}})
        >>> rk4 = derive.FixedStep(derive.model_files(derive.lower(derive.derive(ball)), ball))
        >>> rk4.native.coordinates
        ('ball_c1', 'ball_c2', 'ball_phi')
    """

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
        """Integrate from a state, or from each row of several states.

        Arguments:
            q0: the coordinates (nq,) at t0, or (n, nq).
            v0: the generalised velocities (nv,) at t0, or (n, nv).
            step: the step, s.
            steps: the number of steps.
            every: the number of steps between rows, the first of which is at t0.
            k: the constants (nk,) of `setup`; by default those of the default parameters.
            t0: the time of the first row, s.
            project: whether constraints and their rates are kept below `tolerance`, from the first state on.
            tolerance: m, rad and m/s, rad/s.
            observe: a function of the time and the row [q; v; lambda] of a single state, called after each row; if it
                returns true, the integration ends.

        Raises:
            IntegratorError: if the integration stops.
            ValueError: on wrong lengths, and for many states with an observer.

        Examples:
            >>> result = rk4.run([0, 0, 0], [3, 4, 0], step=0.1, steps=8)
            >>> result.q[-1].round(6) + 0.0
            array([2.4, 0. , 0. ])
        """
        check_steps(steps, every)
        check_numbers(t0=t0, step=step, tolerance=tolerance)
        q, v = self.states(q0, v0)
        states = q.shape[:-1]
        rows: Array = np.empty((*states, steps // every + 1, self.width))
        work, counts = np.empty(self.library.tisserand_fixed_work(self.model)), _FixedCounts()
        given = (t0, step, steps, every, self.constants(k), tolerance if project else 0.0, q, v, rows)
        t = times(t0, step * every, steps // every + 1)
        if not states:
            rk4 = self.library.tisserand_rk4
            return self.observed(rk4, (self.model, *given), rows, t, counts, observe, [work])
        if observe is not None:
            raise ValueError("many states have no observer; integrate each by a call of its own")
        number = int(np.prod(states))
        codes = np.zeros(max(number, 1), dtype=np.intc)
        batch = self.library.tisserand_rk4_batch
        code, seconds = timed(batch, self.model, number, *given, codes, work, ctypes.byref(counts))
        return checked_result(self.native.name, code, self.integration(t, rows, counts, seconds))
