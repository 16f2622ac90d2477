"""IDA of SUNDIALS with KLU in C, compiled with a model."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from derive.artifacts import File
from derive.runtime.integrators.c_integrator import (
    CONSISTENT,
    PROXIMAL,
    STOPPED,
    Array,
    CIntegrator,
    Integration,
    check_numbers,
    checked_array,
    checked_result,
    fields,
    timed,
    times,
    types,
)
from derive.runtime.integrators.compilation import sundials
from derive.runtime.integrators.observer import Observe, Observer


class _IdaOptions(ctypes.Structure):
    _fields_ = [
        ("form", ctypes.c_char_p),
        ("rtol", ctypes.c_double),
        ("atol", ctypes.c_double),
        ("weights", ctypes.c_void_p),
        ("order", ctypes.c_int),
        ("start", ctypes.c_double),
        ("step_max", ctypes.c_double),
        ("steps_max", ctypes.c_long),
        ("proximal", ctypes.c_double),
    ]


class _IdaCounts(ctypes.Structure):
    _fields_ = fields(
        "steps", "residuals", "jacobians", "factorisations", "iterations", "error_failures", "convergence_failures"
    )


class Ida(CIntegrator):
    """IDA of SUNDIALS, `templates/host/ida.h`. Raises LibraryMissing."""

    def __init__(self, files: Sequence[File], flags: Sequence[str] = ()) -> None:
        include, link = sundials()
        super().__init__(files, ["fixed_step", "ida"], [*flags, *include], link)
        self.library.tisserand_ida.argtypes = types("ppddlpppppp")

    def run(
        self,
        q0: ArrayLike,
        v0: ArrayLike,
        *,
        interval: float,
        rows: int,
        form: str | None = "ggl",
        rtol: float = 1e-9,
        atol: float | None = None,
        weights: ArrayLike | None = None,
        order: int = 5,
        k: ArrayLike | None = None,
        t0: float = 0.0,
        consistent: float = CONSISTENT,
        step_max: float = 0.0,
        steps_max: int = 1_000_000,
        observe: Observe | None = None,
    ) -> Integration:
        """Integrate from the state q0 (nq,), v0 (nv,), with rows at t0 + i `interval`. Raises IntegratorError.

        `form`: "ggl" or "index1" of a scene, None for a body. `atol` is `rtol` if it is not given; `weights`
        (nq + nv,) are factors of it for the elements of q and v. `order` 2 damps
        vibrations that higher orders follow with short steps. The first state is brought to constraints and rates below
        `consistent`, unless that is 0. `steps_max`: between two rows. `observe` follows the rows.
        """
        check_numbers(
            t0=t0,
            interval=interval,
            rtol=rtol,
            atol=rtol if atol is None else atol,
            consistent=consistent,
            step_max=step_max,
        )
        q, v = self.state(q0, v0)
        if rows < 1 or not interval > 0:
            raise ValueError(f"{rows} rows at an interval of {interval} make no sense")
        name, absolute = None if form is None else form.encode(), rtol if atol is None else atol
        factors = None if weights is None else checked_array("weights", weights, (self.native.nq + self.native.nv,))
        scaled = None if factors is None else factors.ctypes.data
        term = PROXIMAL if self.native.proximal else 0.0
        options = _IdaOptions(name, rtol, absolute, scaled, order, consistent, step_max, steps_max, term)
        table: Array = np.empty((rows, self.width))
        counts, observer = _IdaCounts(), Observer(observe, self.width)
        with observer.interrupts():
            code, seconds = timed(
                self.library.tisserand_ida,
                *(self.model, ctypes.byref(options), t0, interval, rows, self.constants(k), q, v, table),
                *(observer.pointer, ctypes.byref(counts)),
            )
        observer.reraise()
        result = self.integration(times(t0, interval, rows), table, counts, seconds, code == STOPPED)
        return checked_result(self.native.name, code, result)


def run_ida(files: Sequence[File], q0: ArrayLike, v0: ArrayLike, **options: Any) -> Integration:
    """Compile a model with IDA and integrate it, see `Ida.run`."""
    return Ida(files).run(q0, v0, **options)
