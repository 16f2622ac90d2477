"""The C hosts of `templates/host`, compiled together with a model: fixed steps, and IDA of SUNDIALS."""

from __future__ import annotations

import ctypes
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from derive.emit.files import File
from derive.native import FLAGS, Native, NativeScene, Vector
from derive.simulation.host_build import SundialsMissing, compile_host, header, sundials, written

__all__ = ["FixedStep", "Host", "HostError", "Ida", "Integration", "SundialsMissing", "program", "run_fixed", "run_ida"]

Array = NDArray[np.float64]

CONSISTENT = 1e-12
"""The largest g (m, rad) and gdot (m/s, rad/s) that hosts leave."""

CODES = {
    1: "a pivot vanished: joints are redundant, or in a singular position",
    2: "a value is not finite or not positive",
    3: "the constraints could not be met",
    4: "an argument makes no sense",
    5: "the model has no such form",
    -1: "too many steps between two rows",
    -2: "the tolerance is too small for double precision",
    -3: "a step failed its error test again and again",
    -4: "Newton's method failed again and again",
    -6: "the Jacobian is singular",
}
"""What the codes of the hosts mean; negative ones are those of IDA."""


class HostError(ArithmeticError):
    """An integration stopped with a code other than 0; `partial` is what it had reached, then NaN."""

    def __init__(self, name: str, code: int, partial: Integration) -> None:
        self.code, self.partial = code, partial
        good = partial.t[np.all(np.isfinite(partial.q), axis=-1)] if partial.q.ndim == 2 else partial.t[:0]
        where = f" after t = {good[-1]:g}" if len(good) else ""
        super().__init__(f"{name}: code {code}{where}: {CODES.get(code, 'see ida/ida.h')}")


@dataclass(frozen=True, eq=False)
class Integration:
    """t (rows,) in s, and q, v and multipliers lam (rows, n) there in SI units; of many states (states, rows, n).

    `counts`: evaluations by name; `seconds`: of CPU that the C took.
    """

    t: Vector
    q: Array
    v: Array
    lam: Array
    counts: dict[str, int]
    seconds: float


def _fields(*names: str) -> list[tuple[str, Any]]:
    return [(name, ctypes.c_long) for name in names]


class _FixedCounts(ctypes.Structure):
    _fields_ = _fields("steps", "accelerations", "constraints", "corrections")


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
    _fields_ = _fields(
        "steps", "residuals", "jacobians", "factorisations", "iterations", "error_failures", "convergence_failures"
    )


class Host:
    """A model and the host sources in one shared library; `native` is the model."""

    def __init__(
        self, files: Sequence[File], hosts: Sequence[str], extra: Sequence[str] = (), link: Sequence[str] = ()
    ):
        with tempfile.TemporaryDirectory(prefix="tisserand-") as folder:
            name, sources = written(files, hosts, Path(folder))
            library = Path(folder) / "host.so"
            compile_host([*FLAGS, *extra, *header(name, Path(folder)), "-shared", "-fPIC"], sources, library, link)
            self._library = ctypes.CDLL(str(library))
        scene = hasattr(self._library, f"{name}_poses")
        self.native = (NativeScene if scene else Native)(self._library, name)
        self._model = ctypes.cast(getattr(self._library, f"{name}_model")(), ctypes.c_void_p)
        self._width: int = self._library.tisserand_fixed_row(self._model)

    def _constants(self, k: ArrayLike | None) -> Vector:
        return self.native.setup() if k is None else _checked("k", k, (self.native.nk,))

    def _states(self, q0: ArrayLike, v0: ArrayLike) -> tuple[Array, Array]:
        """Copies, which the hosts overwrite."""
        q, v = np.array(q0, dtype=float, order="C"), np.array(v0, dtype=float, order="C")
        states = q.shape[:-1]
        return _checked("q0", q, (*states, self.native.nq)), _checked("v0", v, (*states, self.native.nv))

    def _integration(self, t: Vector, rows: Array, counts: ctypes.Structure, seconds: float) -> Integration:
        q, v, lam = np.split(rows, np.cumsum([self.native.nq, self.native.nv]), axis=-1)
        return Integration(t, q, v, lam, {n: getattr(counts, n) for n, *_ in counts._fields_}, seconds)


class FixedStep(Host):
    """The Runge-Kutta method of order 4, `templates/host/fixed_step.h`."""

    def __init__(self, files: Sequence[File], flags: Sequence[str] = ()) -> None:
        super().__init__(files, ["fixed_step"], flags)
        self._library.tisserand_rk4_batch.argtypes = _types("piddllpdpppppp")

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
        if steps < 0 or every < 1:
            raise ValueError(f"{steps} steps with a row every {every} steps make no sense")
        q, v = self._states(q0, v0)
        states = q.shape[:-1]
        rows: Array = np.empty((*states, steps // every + 1, self._width))
        number = int(np.prod(states))
        codes = np.zeros(max(number, 1), dtype=np.intc)
        work, counts = np.empty(self._library.tisserand_fixed_work(self._model)), _FixedCounts()
        code, seconds = _timed(
            self._library.tisserand_rk4_batch,
            *(self._model, number, t0, step, steps, every, self._constants(k), tolerance if project else 0.0),
            *(q, v, rows, codes, work, ctypes.byref(counts)),
        )
        t = _times(t0, step * every, steps // every + 1)
        return _finished(self.native.name, code, self._integration(t, rows, counts, seconds))


class Ida(Host):
    """IDA of SUNDIALS, `templates/host/ida.h`. Raises SundialsMissing."""

    def __init__(self, files: Sequence[File], flags: Sequence[str] = ()) -> None:
        include, link = sundials()
        super().__init__(files, ["fixed_step", "ida"], [*flags, *include], link)
        self._library.tisserand_ida.argtypes = _types("ppddlppppp")

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
        q, v = self._states(q0, v0)
        if q.ndim != 1:
            raise ValueError("q0 and v0 have to be vectors: IDA integrates one state")
        if rows < 1 or not interval > 0:
            raise ValueError(f"{rows} rows at an interval of {interval} make no sense")
        name, absolute = None if form is None else form.encode(), rtol if atol is None else atol
        options = _IdaOptions(name, rtol, absolute, order, consistent, step_max, steps_max)
        table: Array = np.empty((rows, self._width))
        counts = _IdaCounts()
        code, seconds = _timed(
            self._library.tisserand_ida,
            *(self._model, ctypes.byref(options), t0, interval, rows, self._constants(k), q, v, table),
            ctypes.byref(counts),
        )
        return _finished(self.native.name, code, self._integration(_times(t0, interval, rows), table, counts, seconds))


def run_fixed(files: Sequence[File], q0: ArrayLike, v0: ArrayLike, **options: Any) -> Integration:
    """`FixedStep.run` of a model that is compiled for it."""
    return FixedStep(files).run(q0, v0, **options)


def run_ida(files: Sequence[File], q0: ArrayLike, v0: ArrayLike, **options: Any) -> Integration:
    """`Ida.run` of a model that is compiled for it."""
    return Ida(files).run(q0, v0, **options)


def program(files: Sequence[File], target: Path, ida: bool = False, flags: Sequence[str] = ()) -> Path:
    """The program `templates/host/simulate.c` of a model, with IDA if that is wanted."""
    include, link = sundials() if ida else ([], [])
    hosts = ["simulate", "fixed_step", *(["ida"] if ida else [])]
    with tempfile.TemporaryDirectory(prefix="tisserand-") as folder:
        name, sources = written(files, hosts, Path(folder))
        defined = [f"-DTISSERAND_MODEL={name}_model", *(["-DTISSERAND_IDA"] if ida else [])]
        compile_host([*FLAGS, *flags, *include, *defined, *header(name, Path(folder))], sources, target, link)
    return target


def _times(t0: float, interval: float, rows: int) -> Vector:
    return np.asarray(t0 + interval * np.arange(rows), dtype=np.float64)


def _types(letters: str) -> list[Any]:
    kinds = {"p": ctypes.c_void_p, "i": ctypes.c_int, "l": ctypes.c_long, "d": ctypes.c_double}
    return [kinds[letter] for letter in letters]


def _timed(function: Callable[..., int], *arguments: Any) -> tuple[int, float]:
    """The code of a C function, and its CPU time. Arrays go as addresses."""
    given = [a.ctypes.data if isinstance(a, np.ndarray) else a for a in arguments]
    before = time.thread_time()
    code = function(*given)
    return code, time.thread_time() - before


def _finished(name: str, code: int, found: Integration) -> Integration:
    if code:
        raise HostError(name, code, found)
    return found


def _checked(name: str, given: ArrayLike, shape: tuple[int, ...]) -> Array:
    array = np.ascontiguousarray(given, dtype=np.float64)
    if array.shape != shape:
        raise ValueError(f"{name}: an array of shape {shape} is needed, not {array.shape}")
    return array
