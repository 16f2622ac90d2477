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
    Array,
    CIntegrator,
    Integration,
    check_numbers,
    checked_array,
    fields,
    times,
    types,
)
from derive.runtime.integrators.compilation import sundials
from derive.runtime.integrators.observer import Observe


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
    """IDA of SUNDIALS, a method of variable order and step, `templates/host/ida.h`, and a model.

    Arguments:
        files: those of `model_files`.
        flags: further ones of the compiler.

    Raises:
        LibraryMissing: if SUNDIALS with KLU is not installed.
        CompilerError: if there is no compiler.
        ValueError: unless there is one C file among the files.
        TypeError: for anything but files.

    Examples:
        >>> import derive
        >>> ball = derive.scene("ball", gravity=(0, -10), bodies={"ball": {"mass": 1, "inertia": 1}})
        >>> ida = derive.Ida(derive.model_files(derive.lower(derive.derive(ball)), ball))
        >>> ida.native.coordinates
        ('ball_c1', 'ball_c2', 'ball_phi')
    """

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
        """Integrate from a state, with rows at t0 + i `interval`.

        Arguments:
            q0: the coordinates (nq,) at t0.
            v0: the generalised velocities (nv,) at t0.
            interval: the time between rows, s.
            rows: the number of rows, the first of which is at t0.
            form: "ggl" or "index1" of a scene, None for a body.
            rtol: the relative tolerance.
            atol: the absolute tolerance, `rtol` if it is not given.
            weights: (nq + nv,) factors of `atol` for the elements of q and v.
            order: the largest order; 2 damps vibrations that higher orders follow with short steps.
            k: the constants (nk,) of `setup`; by default those of the default parameters.
            t0: the time of the first row, s.
            consistent: the limit of constraints and rates to which the first state is brought, unless that is 0.
            step_max: the longest step, s; 0 for no limit.
            steps_max: the largest number of steps between two rows.
            observe: a function of the time and the row [q; v; lambda], called after each row; if it returns true, the
                integration ends.

        Raises:
            IntegratorError: if the integration stops.
            ValueError: on wrong lengths.

        Examples:
            >>> ida.run([0, 0, 0], [3, 4, 0], interval=0.4, rows=3).q[-1].round(6) + 0.0
            array([2.4, 0. , 0. ])
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
        given = (self.model, ctypes.byref(options), t0, interval, rows, self.constants(k), q, v, table)
        instants = times(t0, interval, rows)
        return self.observed(self.library.tisserand_ida, given, table, instants, _IdaCounts(), observe)


def run_ida(files: Sequence[File], q0: ArrayLike, v0: ArrayLike, **options: Any) -> Integration:
    """Compile a model with IDA and integrate it, see `Ida.run`."""
    return Ida(files).run(q0, v0, **options)
