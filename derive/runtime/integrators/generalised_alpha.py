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
from derive.runtime.integrators.compilation import klu
from derive.runtime.integrators.observer import Observe, Observer

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
    """The generalised-alpha method, `templates/host/generalised_alpha.h`. Raises LibraryMissing."""

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
        """Integrate from the state q0 (nq,), v0 (nv,), with rows at t0 and after every `every` steps.

        Raises IntegratorError. `rho`, 0 to 1, is the spectral radius at infinite frequency, by which a step multiplies
        vibrations that are too fast for it. `tolerance` is that of Newton's method, for q and `step` * v. The first
        state is brought to constraints and rates below `consistent`, unless that is 0. `observe` follows the rows.
        """
        check_steps(steps, every)
        check_numbers(t0=t0, step=step, rho=rho, tolerance=tolerance, consistent=consistent)
        if not step > 0 or not 0 <= rho <= 1:
            raise ValueError(f"a step of {step} s with rho = {rho} makes no sense")
        q, v = self.state(q0, v0)
        table: Array = np.empty((steps // every + 1, self.width))
        term = PROXIMAL if self.native.proximal else 0.0
        options, counts = _AlphaOptions(rho, tolerance, consistent, term), _AlphaCounts()
        observer = Observer(observe, self.width)
        with observer.interrupts():
            code, seconds = timed(
                self.library.tisserand_alpha,
                *(self.model, ctypes.byref(options), t0, step, steps, every, self.constants(k), q, v, table),
                *(observer.pointer, ctypes.byref(counts)),
            )
        observer.reraise()
        t = times(t0, step * every, steps // every + 1)
        result = self.integration(t, table, counts, seconds, code == STOPPED)
        return checked_result(self.native.name, code, result, ALPHA_CODES)
