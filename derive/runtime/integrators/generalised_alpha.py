"""The generalised-alpha method with KLU in C, with fixed steps, compiled with a model."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from derive.artifacts import File
from derive.runtime.integrators.c_integrator import (
    CODES,
    CONSISTENT,
    PROXIMAL,
    Array,
    CIntegrator,
    Integration,
    check_numbers,
    check_steps,
    fields,
    times,
    types,
)
from derive.runtime.integrators.compilation import klu
from derive.runtime.integrators.observer import Observe

ALPHA_CODES = {
    **CODES,
    5: "the model has no form of index 3",
    6: "there is not enough memory",
    7: "the iteration matrix is singular: joints are redundant, or in a singular position",
    8: "Newton's method does not converge: take a shorter step",
}
"""The meanings of the return codes of the generalised-alpha method."""


SOURCES = ("fixed_step", "rotations", "generalised_alpha")
"""The C files of the method in `templates/host`."""


class _AlphaOptions(ctypes.Structure):
    _fields_ = [(name, ctypes.c_double) for name in ("rho", "tolerance", "start", "proximal")]


class _AlphaCounts(ctypes.Structure):
    _fields_ = fields("steps", "residuals", "jacobians")


class GeneralisedAlpha(CIntegrator):
    """The generalised-alpha method with fixed steps, `templates/host/generalised_alpha.h`, and a model.

    Arguments:
        files: those of `model_files`.
        flags: further ones of the compiler.

    Raises:
        LibraryMissing: if SuiteSparse with KLU is not installed.
        CompilerError: if there is no compiler.
        ValueError: unless there is one C file among the files.
        TypeError: for anything but files.

    Examples:
        >>> import derive
        >>> ball = derive.scene("ball", gravity=(0, -10), bodies={"ball": {"mass": 1, "inertia": 1}})
        >>> alpha = derive.GeneralisedAlpha(derive.model_files(derive.lower(derive.derive(ball)), ball))
        >>> alpha.native.coordinates
        ('ball_c1', 'ball_c2', 'ball_phi')
    """

    def __init__(self, files: Sequence[File], flags: Sequence[str] = ()) -> None:
        include, link = klu()
        super().__init__(files, list(SOURCES), [*flags, *include], link)
        self.library.tisserand_alpha.argtypes = types("ppddllpppppp")

    def run(
        self,
        q0: ArrayLike,
        v0: ArrayLike,
        *,
        step: float,
        steps: int,
        every: int = 1,
        rho: float = 0.8,
        k: ArrayLike | None = None,
        t0: float = 0.0,
        tolerance: float = 1e-11,
        consistent: float = CONSISTENT,
        observe: Observe | None = None,
    ) -> Integration:
        """Integrate from a state.

        Arguments:
            q0: the coordinates (nq,) at t0.
            v0: the generalised velocities (nv,) at t0.
            step: the step, s.
            steps: the number of steps.
            every: the number of steps between rows, the first of which is at t0.
            rho: the spectral radius at infinite frequency, 0 to 1, by which a step multiplies fast vibrations.
            k: the constants (nk,) of `setup`; by default those of the default parameters.
            t0: the time of the first row, s.
            tolerance: that of Newton's method, for q and `step` * v.
            consistent: the limit of constraints and rates to which the first state is brought, unless that is 0.
            observe: a function of the time and the row [q; v; lambda], called after each row; if it returns true, the
                integration ends.

        Raises:
            IntegratorError: if the integration stops.
            ValueError: on wrong lengths.

        Examples:
            >>> alpha.run([0, 0, 0], [3, 4, 0], step=0.01, steps=80).q[-1].round(3) + 0.0
            array([2.4, 0. , 0. ])
        """
        check_steps(steps, every)
        check_numbers(t0=t0, step=step, rho=rho, tolerance=tolerance, consistent=consistent)
        if not step > 0 or not 0 <= rho <= 1:
            raise ValueError(f"a step of {step} s with rho = {rho} makes no sense")
        q, v = self.state(q0, v0)
        table: Array = np.empty((steps // every + 1, self.width))
        term = PROXIMAL if self.native.proximal else 0.0
        options, counts = _AlphaOptions(rho, tolerance, consistent, term), _AlphaCounts()
        given = (self.model, ctypes.byref(options), t0, step, steps, every, self.constants(k), q, v, table)
        rows = times(t0, step * every, len(table))
        return self.observed(self.library.tisserand_alpha, given, table, rows, counts, observe, meanings=ALPHA_CODES)
