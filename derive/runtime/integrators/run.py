"""The C hosts of `templates/host`, compiled together with a model: fixed steps, and IDA of SUNDIALS."""

from __future__ import annotations

import ctypes
import tempfile
from collections.abc import Collection, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from derive.artifacts import File
from derive.runtime.compiler import FLAGS, compile_c
from derive.runtime.integrators.build import header, klu, sundials, written
from derive.runtime.integrators.library import (
    CODES,
    Array,
    Host,
    Integration,
    check_steps,
    fields,
    finished,
    timed,
    times,
    types,
)

CONSISTENT = 1e-12
"""The largest g (m, rad) and gdot (m/s, rad/s) that hosts leave."""

ALPHA_CODES = {
    **CODES,
    5: "the model has no form of index 3, or is no planar one",
    6: "there is not enough memory",
    7: "the iteration matrix is singular: joints are redundant, or in a singular position",
    8: "Newton's method does not converge: take a shorter step",
}
"""The same of the generalised-alpha method."""


class _FixedCounts(ctypes.Structure):
    _fields_ = fields("steps", "accelerations", "constraints", "corrections")


class _IdaOptions(ctypes.Structure):
    _fields_ = [
        ("form", ctypes.c_char_p),
        ("rtol", ctypes.c_double),
        ("atol", ctypes.c_double),
        ("order", ctypes.c_int),
        ("start", ctypes.c_double),
        ("step_max", ctypes.c_double),
        ("steps_max", ctypes.c_long),
    ]


class _IdaCounts(ctypes.Structure):
    _fields_ = fields(
        "steps", "residuals", "jacobians", "factorisations", "iterations", "error_failures", "convergence_failures"
    )


class _AlphaOptions(ctypes.Structure):
    _fields_ = [(name, ctypes.c_double) for name in ("rho", "tolerance", "start")]


class _AlphaCounts(ctypes.Structure):
    _fields_ = fields("steps", "residuals", "jacobians")


class FixedStep(Host):
    """The Runge-Kutta method of order 4, `templates/host/fixed_step.h`."""

    def __init__(self, files: Sequence[File], flags: Sequence[str] = ()) -> None:
        super().__init__(files, ["fixed_step"], flags)
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
    ) -> Integration:
        """Rows at t0 and after every `every` steps, from the state q0 (nq,), v0 (nv,), or one of each row of these.

        `project` keeps constraints and their rates below `tolerance`, from the first state on. Raises HostError.
        """
        check_steps(steps, every)
        q, v = self.states(q0, v0)
        states = q.shape[:-1]
        rows: Array = np.empty((*states, steps // every + 1, self.width))
        number = int(np.prod(states))
        codes = np.zeros(max(number, 1), dtype=np.intc)
        work, counts = np.empty(self.library.tisserand_fixed_work(self.model)), _FixedCounts()
        code, seconds = timed(
            self.library.tisserand_rk4_batch,
            *(self.model, number, t0, step, steps, every, self.constants(k), tolerance if project else 0.0),
            *(q, v, rows, codes, work, ctypes.byref(counts)),
        )
        t = times(t0, step * every, steps // every + 1)
        return finished(self.native.name, code, self.integration(t, rows, counts, seconds))


class Ida(Host):
    """IDA of SUNDIALS, `templates/host/ida.h`. Raises LibraryMissing."""

    def __init__(self, files: Sequence[File], flags: Sequence[str] = ()) -> None:
        include, link = sundials()
        super().__init__(files, ["fixed_step", "ida"], [*flags, *include], link)
        self.library.tisserand_ida.argtypes = types("ppddlppppp")

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
        order: int = 5,
        k: ArrayLike | None = None,
        t0: float = 0.0,
        consistent: float = CONSISTENT,
        step_max: float = 0.0,
        steps_max: int = 1_000_000,
    ) -> Integration:
        """Rows at t0 + i `interval`, from the state q0 (nq,), v0 (nv,). Raises HostError.

        `form`: "ggl" or "index1" of a scene, None for a body. `atol` is `rtol` if it is not given. `order` 2 damps
        vibrations that higher orders follow with short steps. The first state is brought to constraints and rates below
        `consistent`, unless that is 0. `steps_max`: between two rows.
        """
        q, v = self.state(q0, v0)
        if rows < 1 or not interval > 0:
            raise ValueError(f"{rows} rows at an interval of {interval} make no sense")
        name, absolute = None if form is None else form.encode(), rtol if atol is None else atol
        options = _IdaOptions(name, rtol, absolute, order, consistent, step_max, steps_max)
        table: Array = np.empty((rows, self.width))
        counts = _IdaCounts()
        code, seconds = timed(
            self.library.tisserand_ida,
            *(self.model, ctypes.byref(options), t0, interval, rows, self.constants(k), q, v, table),
            ctypes.byref(counts),
        )
        return finished(self.native.name, code, self.integration(times(t0, interval, rows), table, counts, seconds))


class GeneralisedAlpha(Host):
    """The generalised-alpha method, `templates/host/generalised_alpha.h`. Raises LibraryMissing."""

    def __init__(self, files: Sequence[File], flags: Sequence[str] = ()) -> None:
        include, link = klu()
        super().__init__(files, ["fixed_step", "generalised_alpha"], [*flags, *include], link)
        self.library.tisserand_alpha.argtypes = types("ppddllppppp")

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
    ) -> Integration:
        """Rows at t0 and after every `every` steps, from the state q0 (nq,), v0 (nv,). Raises HostError.

        `rho`, 0 to 1, is what is left, in a step, of vibrations that are too fast for it. `tolerance` is that of
        Newton's method, for q and `step` * v. The first state is brought to constraints and rates below `consistent`,
        unless that is 0.
        """
        check_steps(steps, every)
        if not step > 0 or not 0 <= rho <= 1:
            raise ValueError(f"a step of {step} s with rho = {rho} makes no sense")
        q, v = self.state(q0, v0)
        table: Array = np.empty((steps // every + 1, self.width))
        options, counts = _AlphaOptions(rho, tolerance, consistent), _AlphaCounts()
        code, seconds = timed(
            self.library.tisserand_alpha,
            *(self.model, ctypes.byref(options), t0, step, steps, every, self.constants(k), q, v, table),
            ctypes.byref(counts),
        )
        t = times(t0, step * every, steps // every + 1)
        return finished(self.native.name, code, self.integration(t, table, counts, seconds), ALPHA_CODES)


def run_ida(files: Sequence[File], q0: ArrayLike, v0: ArrayLike, **options: Any) -> Integration:
    """`Ida.run` of a model that is compiled for it."""
    return Ida(files).run(q0, v0, **options)


def program(
    files: Sequence[File], target: Path, methods: Collection[str] = ("rk4",), flags: Sequence[str] = ()
) -> Path:
    """The program `templates/host/simulate.c` of a model, with the methods "rk4", "ida", "alpha" that are wanted."""
    hosts, wanted = ["simulate", "fixed_step"], list(flags)
    link: list[str] = []
    for method, host, library in (("ida", "ida", sundials), ("alpha", "generalised_alpha", klu)):
        if method in methods:
            include, libraries = library()
            hosts, link = [*hosts, host], [*link, *libraries]
            wanted += [*include, f"-DTISSERAND_{method.upper()}"]
    with tempfile.TemporaryDirectory(prefix="tisserand-") as folder:
        name, sources = written(files, hosts, Path(folder))
        wanted += [f"-DTISSERAND_MODEL={name}_model", *header(name, Path(folder))]
        compile_c(sources, target, [*FLAGS, *wanted], link)
    return target
