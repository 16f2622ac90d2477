"""The method of Dormand and Prince of order 8 in C, with adaptive steps, for any compiled model by its descriptor."""

from __future__ import annotations

import ctypes
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from derive.backends.c.source import ABI
from derive.errors import TisserandError
from derive.rendering import render
from derive.roles import Role
from derive.runtime.compiler import FLAGS
from derive.runtime.integrators.c_integrator import (
    CODES,
    CONSISTENT,
    STOPPED,
    Array,
    check_numbers,
    checked_array,
    timed,
    types,
)
from derive.runtime.integrators.compilation import host_sources
from derive.runtime.integrators.observer import Observe, Observer
from derive.runtime.integrators.watch import Watch, Watched, WatchInC
from derive.runtime.loading import library_data, load_data
from derive.runtime.native_call import Vector
from derive.runtime.native_scene import NativeScene

ADAPTIVE_CODES = {
    **CODES,
    10: "the tolerance requires steps that are shorter than the spacing of times",
    11: "the steps are too many",
}
"""The meanings of the return codes of the adaptive method."""
OFF = 3
"""The code of an integration whose constraints cannot be met."""

SOURCES = ("fixed_step", "dormand_prince", "adaptive", "adaptive_rows", "watch")
HEADER = "tisserand.h"

EventFunction = Callable[[float, Vector], float]
"""A function of the time (s) and the state y = [q; v]."""

_VALUE = ctypes.CFUNCTYPE(
    ctypes.c_double,
    ctypes.c_void_p,
    ctypes.c_double,
    ctypes.POINTER(ctypes.c_double),
    ctypes.POINTER(ctypes.c_double),
)


class _Options(ctypes.Structure):
    _fields_ = [
        ("rtol", ctypes.c_double),
        ("atol", ctypes.c_void_p),
        ("consistent", ctypes.c_double),
        ("drift", ctypes.c_double),
        ("step_max", ctypes.c_double),
        ("steps_max", ctypes.c_long),
    ]


class _Counts(ctypes.Structure):
    _fields_ = [(n, ctypes.c_long) for n in ("steps", "accelerations", "constraints", "corrections", "rejected")]


class _Solver(ctypes.Structure):
    _fields_ = [
        ("model", ctypes.c_void_p),
        ("k", ctypes.c_void_p),
        ("options", _Options),
        ("t", ctypes.c_double),
        ("y", ctypes.POINTER(ctypes.c_double)),
        ("last", ctypes.c_double),
        ("step", ctypes.c_double),
        ("limit", ctypes.c_double),
        ("refused", ctypes.c_int),
        ("refused_t", ctypes.c_double),
        ("f", ctypes.c_void_p),
        ("begin", ctypes.c_void_p),
        ("end", ctypes.c_void_p),
        ("stages", ctypes.c_void_p),
        ("interpolant", ctypes.c_void_p),
        ("within", ctypes.c_int),
        ("trial", ctypes.POINTER(ctypes.c_double)),
        ("work", ctypes.c_void_p),
        ("counts", _Counts),
    ]


class _Event(ctypes.Structure):
    _fields_ = [("value", _VALUE), ("data", ctypes.c_void_p), ("crossing", ctypes.c_int)]


class _Request(ctypes.Structure):
    _fields_ = [
        ("count", ctypes.c_long),
        ("times", ctypes.c_void_p),
        ("nbreaks", ctypes.c_int),
        ("breaks", ctypes.c_void_p),
        ("event", ctypes.c_void_p),
        ("observer", ctypes.c_void_p),
        ("steps", ctypes.c_void_p),
        ("rows", ctypes.c_void_p),
        ("outputs", ctypes.c_void_p),
        ("drift", ctypes.c_void_p),
    ]


class _Result(ctypes.Structure):
    _fields_ = [("rows", ctypes.c_long), ("met", ctypes.c_int), ("time", ctypes.c_double)]


@dataclass(frozen=True, eq=False)
class AdaptiveRun:
    """The result of an adaptive integration, in SI units.

    t (rows,), q (rows, nq), v (rows, nv), multipliers lam (rows, nlambda), outputs (rows, nout). drift, drift_before
    (rows, 2): |g| (m, rad) and |gdot| (m/s, rad/s) of each row after and before its projection. counts: evaluations by
    name. seconds: CPU time of the C function. met: whether the event has ended the integration, in the last row.
    watched: the largest and mean values of the quantities that are watched.
    """

    t: Vector
    q: Array
    v: Array
    lam: Array
    outputs: Array
    drift: Array
    drift_before: Array
    counts: dict[str, int]
    seconds: float
    met: bool
    watched: Watched | None = None


class AdaptiveError(TisserandError):
    """An integration stopped with a return code other than 0, in the state y = [q; v] at t (s).

    refused: the code with which the model has refused a state after it, if it has, and its time (s). trial: the last
    state that was computed; with the code OFF, the state that violates the constraints at the time of `refused`.
    """

    def __init__(
        self, name: str, code: int, t: float, y: Vector, refused: tuple[int, float] | None, trial: Vector
    ) -> None:
        self.code, self.t, self.y, self.refused, self.trial = code, t, y, refused, trial
        self.meaning = ADAPTIVE_CODES[code]
        super().__init__(f"{name}: code {code} after t = {t:g}: {self.meaning}")


class Adaptive:
    """The integrator of `templates/host/adaptive_rows.h`, compiled once for all models. Raises CompilerError.

    library: one that `adaptive_library` returned in another process, which is loaded instead.
    """

    def __init__(self, native: NativeScene, library: bytes | None = None) -> None:
        self.native, self._library = native, _loaded(adaptive_library() if library is None else library)

    def run(
        self,
        q0: ArrayLike,
        v0: ArrayLike,
        times: ArrayLike,
        *,
        rtol: float = 1e-9,
        atol: ArrayLike | None = None,
        k: ArrayLike | None = None,
        consistent: float = CONSISTENT,
        drift: float = 0.0,
        step_max: float = 0.0,
        steps_max: int = 0,
        breaks: Sequence[float] = (),
        event: EventFunction | None = None,
        crossing: bool = False,
        observe: Observe | None = None,
        watch: Watch | None = None,
    ) -> AdaptiveRun:
        """Integrate from the state q0 (nq,), v0 (nv,) at times[0], with rows at `times` (n,), s.

        rtol, atol (nq + nv,): the relative and absolute tolerances of a step; without atol it is rtol. Constraints are
        met to `consistent` after each step and in each row, unless that is 0, and a violation of more than `drift` is
        an error, unless that is 0. step_max (s), steps_max: the longest step, and the largest number of steps; 0 is no
        limit. breaks: times (s) at which functions of time are discontinuous. event: a function that ends the
        integration where it becomes positive or, with `crossing`, where it changes its sign. observe: follows the rows.
        watch: quantities of a scene that are evaluated after each step. Raises AdaptiveError, ValueError.
        """
        native = self.native
        n = native.nq + native.nv
        check_numbers(rtol=rtol, consistent=consistent, drift=drift, step_max=step_max)
        constants = native.setup() if k is None else checked_array("k", native.own(k), (native.nk,))
        q, v = checked_array("q0", q0, (native.nq,)), checked_array("v0", v0, (native.nv,))
        absolute = np.full(n, rtol) if atol is None else checked_array("atol", atol, (n,))
        instants, jumps = np.array(times, dtype=np.float64), np.array(breaks, dtype=np.float64)
        size = len(instants) + (event is not None)
        rows, drifts = np.empty((size, n + native.nlambda)), np.empty((size, 4))
        outputs = np.empty((size, len(native.outputs)))
        observer, happening = Observer(observe, n + native.nlambda), _EventCall(event, crossing, native.nq, native.nv)
        watching = None if watch is None else WatchInC(watch, self._library, native, constants)
        request = _Request(
            *(len(instants), instants.ctypes.data, len(jumps), jumps.ctypes.data),
            *(happening.address, observer.address, watching.address if watching else 0),
            *(rows.ctypes.data, outputs.ctypes.data, drifts.ctypes.data),
        )
        options = _Options(rtol, absolute.ctypes.data, consistent, drift, step_max, steps_max)
        solver, result = _Solver(), _Result()
        work = np.empty(self._library.tisserand_adaptive_work(native.address))
        with observer.interrupts():
            code, seconds = timed(
                self._library.tisserand_adaptive_integrate,
                *(
                    ctypes.byref(solver),
                    native.address,
                    ctypes.byref(options),
                    ctypes.byref(request),
                    constants,
                    q,
                    v,
                    work,
                ),
                ctypes.byref(result),
            )
        happening.reraise()
        if code == 4:
            raise ValueError(f"{native.name}: {ADAPTIVE_CODES[4]}: give times that increase, and positive tolerances")
        if code not in (0, STOPPED):
            refused = (solver.refused, solver.refused_t) if solver.refused else None
            state, trial = np.array(solver.y[:n]), np.array(solver.trial[:n])
            raise AdaptiveError(native.name, code, solver.t, state, refused, trial)
        count = result.rows
        t = np.append(instants[: count - 1], result.time)
        q_rows, v_rows, lam = np.split(rows[:count], [native.nq, n], axis=1)
        counts = {name: getattr(solver.counts, name) for name, _ in solver.counts._fields_}
        return AdaptiveRun(
            t, q_rows, v_rows, lam, outputs[:count], drifts[:count, 2:], drifts[:count, :2], counts, seconds,
            bool(result.met), watching.seen(float(t[-1] - t[0])) if watching else None,
        )  # fmt: skip


class _EventCall:
    """A function as the event of the C integrator; `address` is 0 without one. `reraise` raises its exception again."""

    def __init__(self, event: EventFunction | None, crossing: bool, nq: int, nv: int) -> None:
        self._error: BaseException | None = None

        def value(_: int | None, t: float, q: Any, v: Any) -> float:
            assert event is not None
            try:
                return float(event(t, np.array([*q[:nq], *v[:nv]])))
            except BaseException as error:  # an exception cannot pass through the C, not even a KeyboardInterrupt
                self._error = error
                return float("nan")

        self._structure = _Event(_VALUE(value), None, int(crossing))  # keeps the function alive
        self.address = 0 if event is None else ctypes.addressof(self._structure)

    def reraise(self) -> None:
        """Raise the exception of the function again, if it has raised one."""
        if self._error is not None:
            raise self._error


@cache
def adaptive_library() -> bytes:
    """The library of the host, compiled with the types of the descriptor alone. Raises CompilerError."""
    with tempfile.TemporaryDirectory(prefix="tisserand-") as temporary:
        folder = Path(temporary)
        (folder / HEADER).write_text(render("c/descriptor.h.jinja", {"abi": ABI, "roles": Role}), encoding="utf-8")
        paths = host_sources(SOURCES, folder)
        return library_data(paths, folder, [*FLAGS, f"-I{folder}", f'-DTISSERAND_HEADER="{HEADER}"'])


@cache
def _loaded(data: bytes) -> ctypes.CDLL:
    library = load_data(data)
    library.tisserand_adaptive_work.argtypes = types("p")
    library.tisserand_adaptive_integrate.argtypes = types("ppppppppp")
    return library
