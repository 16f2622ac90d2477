"""C integrators compiled together with a model in one shared library: their arguments, results and errors."""

from __future__ import annotations

import ctypes
import math
import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from derive.artifacts import File
from derive.errors import TisserandError
from derive.runtime.compiler import FLAGS
from derive.runtime.integrators.compilation import header_flags, write_sources
from derive.runtime.integrators.observer import Observe, Observer
from derive.runtime.loading import shared_library
from derive.runtime.native_call import Vector, doubles
from derive.runtime.native_scene import NativeScene
from derive.short_text import counted, summary

Array = NDArray[np.float64]

CODES = {
    1: "a pivot vanished: joints are redundant, or in a singular position, or a mass matrix is not definite",
    2: "a value is not finite or not positive",
    3: "the constraints could not be met",
    4: "an argument makes no sense",
    5: "the model has no such form",
    9: "the observer has ended the integration",
    -1: "too many steps between two rows",
    -2: "the tolerance is too small for double precision",
    -3: "a step failed its error test again and again",
    -4: "Newton's method failed again and again",
    -6: "the Jacobian is singular",
}
"""The meanings of the return codes; negative ones are those of IDA."""


STOPPED = 9
"""The code of an integration that its observer has ended."""

CONSISTENT = 1e-12
"""The largest |g| (m, rad) and |gdot| (m/s, rad/s) after projection."""

PROXIMAL = 1e-9
"""The proximal term in the iteration matrix of a model whose joints may be redundant, relative to the compliance of
each constraint."""


class IntegratorError(TisserandError):
    """An integration in C stopped with a return code other than 0.

    Attributes:
        code: the return code.
        partial: the rows it has reached, then NaN.

    Examples:
        >>> import derive
        >>> pendulum = derive.scene(
        ...     "pendulum",
        ...     gravity=(0, -9.81),
        ...     ground={"pivot": (0, 0)},
        ...     bodies={"rod": {"mass": 1, "inertia": 1, "markers": {"top": (0, 0.5)}, "keep_coordinates": True}},
        ...     joints={"hinge": {"kind": "revolute", "between": ["ground.pivot", "rod.top"]}},
        ... )
        >>> rk4 = derive.FixedStep(derive.model_files(derive.lower(derive.derive(pendulum)), pendulum))
        >>> try:
        ...     rk4.run([0, -0.5, 0], [1, 0, 2], step=1000, steps=10)
        ... except derive.IntegratorError as error:
        ...     print(error)
        pendulum: code 3 after t = 0: the constraints could not be met
    """

    def __init__(self, name: str, code: int, partial: Integration, meanings: Mapping[int, str] = CODES) -> None:
        self.code, self.partial = code, partial
        good = partial.t[np.all(np.isfinite(partial.q), axis=-1)] if partial.q.ndim == 2 else partial.t[:0]
        where = f" after t = {good[-1]:g}" if len(good) else ""
        super().__init__(f"{name}: code {code}{where}: {meanings.get(code, 'see ida/ida.h')}")


@dataclass(frozen=True, eq=False)
class Integration:
    """The result of an integration in C, in SI units.

    For many initial states q, v and lam have a first axis with one element for each. An observer that ends the
    integration leaves the rows up to the one that it has seen last.

    Attributes:
        t: the times (rows,), s.
        q: coordinates (rows, nq).
        v: generalised velocities (rows, nv).
        lam: multipliers (rows, nlambda).
        counts: evaluations by name.
        seconds: CPU time of the C function.

    Examples:
        >>> import derive
        >>> ball = derive.scene("ball", gravity=(0, -10), bodies={"ball": {"mass": 1, "inertia": 1}})
        >>> rk4 = derive.FixedStep(derive.model_files(derive.lower(derive.derive(ball)), ball))
        >>> result = rk4.run([0, 0, 0], [3, 4, 0], step=0.1, steps=8, every=4)
        >>> result.t
        array([0. , 0.4, 0.8])
        >>> result.q[:, 1].round(6) + 0.0
        array([0. , 0.8, 0. ])
        >>> result.counts["steps"]
        8
    """

    t: Vector
    q: Array
    v: Array
    lam: Array
    counts: dict[str, int]
    seconds: float

    def __repr__(self) -> str:
        states = f", {self.q.shape[0]} states" if self.q.ndim == 3 else ""
        counts = ", ".join(f"{count} {name}" for name, count in self.counts.items())
        return summary(
            f"Integration: {counted(len(self.t), 'row')}, nq = {self.q.shape[-1]}, nv = {self.v.shape[-1]}{states}",
            {"cost": f"{counts}; {self.seconds:.3g} s of CPU time"},
        )


def fields(*names: str) -> list[tuple[str, Any]]:
    """The members of a C structure of counts."""
    return [(name, ctypes.c_long) for name in names]


class CIntegrator:
    """A model and C integrators in one shared library; `native` is the model.

    files: those of `model_files`. sources: the integrators of `templates/host`. flags, link: of the compiler. Raises
    CompilerError.
    """

    def __init__(
        self, files: Sequence[File], sources: Sequence[str], flags: Sequence[str] = (), link: Sequence[str] = ()
    ):
        with tempfile.TemporaryDirectory(prefix="tisserand-") as folder:
            name, paths = write_sources(files, sources, Path(folder))
            used = [*FLAGS, *flags, *header_flags(name, Path(folder))]
            self.library = shared_library(paths, Path(folder), used, link)
        self.native = NativeScene(self.library, name)
        self.model = ctypes.cast(getattr(self.library, f"{name}_model")(), ctypes.c_void_p)
        self.width: int = self.library.tisserand_fixed_row(self.model)

    def constants(self, k: ArrayLike | None) -> Vector:
        """The constants k (nk,) as given, or those of the default parameters."""
        return self.native.setup() if k is None else checked_array("k", self.native.own(k), (self.native.nk,))

    def states(self, q0: ArrayLike, v0: ArrayLike) -> tuple[Array, Array]:
        """Copies of the states q0 (..., nq), v0 (..., nv), which the C overwrites."""
        q, v = np.array(doubles(q0, "q0"), order="C"), np.array(doubles(v0, "v0"), order="C")
        states = q.shape[:-1]
        return checked_array("q0", q, (*states, self.native.nq)), checked_array("v0", v, (*states, self.native.nv))

    def state(self, q0: ArrayLike, v0: ArrayLike) -> tuple[Vector, Vector]:
        """Copies of one state q0 (nq,), v0 (nv,)."""
        q, v = self.states(q0, v0)
        if q.ndim != 1:
            raise ValueError("q0 and v0 have to be vectors: this method integrates one state")
        return q, v

    def observed(
        self,
        function: Callable[..., int],
        arguments: Sequence[Any],
        rows: Array,
        row_times: Vector,
        counts: ctypes.Structure,
        observe: Observe | None,
        work: Sequence[Array] = (),
        meanings: Mapping[int, str] = CODES,
    ) -> Integration:
        """The result of a C function that fills rows. Raises IntegratorError, and what the observer raises."""
        observer = Observer(observe, self.width)
        with observer.interrupts():
            code, seconds = timed(function, *arguments, observer.pointer, *work, ctypes.byref(counts))
        result = self.integration(row_times, rows, counts, seconds, code == STOPPED)
        return checked_result(self.native.name, code, result, meanings)

    def integration(
        self, t: Vector, rows: Array, counts: ctypes.Structure, seconds: float, stopped: bool = False
    ) -> Integration:
        """The result from rows of q, v, lambda (..., nq + nv + nlambda); those after a stop are left out."""
        if stopped:
            good = int(np.sum(np.isfinite(rows[:, 0])))
            t, rows = t[:good], rows[:good]
        q, v, lam = np.split(rows, np.cumsum([self.native.nq, self.native.nv]), axis=-1)
        return Integration(t, q, v, lam, {n: getattr(counts, n) for n, *_ in counts._fields_}, seconds)

    def __repr__(self) -> str:
        return f"{type(self).__name__} of {self.native.name}"


def times(t0: float, interval: float, rows: int) -> Vector:
    """The times (rows,) of the rows, s."""
    return np.asarray(t0 + interval * np.arange(rows), dtype=np.float64)


def check_steps(steps: int, every: int) -> None:
    """Raise ValueError if the numbers of steps, and of steps for each row, make no sense."""
    if steps < 0 or every < 1:
        raise ValueError(f"{steps} steps with a row every {every} steps make no sense")


def check_numbers(**numbers: float) -> None:
    """Raise ValueError, with the names of the arguments, if a number is not finite."""
    if wrong := [f"{name} = {value}" for name, value in numbers.items() if not math.isfinite(value)]:
        raise ValueError(f"finite numbers are needed: {', '.join(wrong)}")


def types(letters: str) -> list[Any]:
    """The ctypes of arguments, by the letters p (pointer), i (int), l (long), d (double)."""
    kinds = {"p": ctypes.c_void_p, "i": ctypes.c_int, "l": ctypes.c_long, "d": ctypes.c_double}
    return [kinds[letter] for letter in letters]


def timed(function: Callable[..., int], *arguments: Any) -> tuple[int, float]:
    """The return code of a C function and its CPU time, s. Arrays are passed by their addresses."""
    given = [a.ctypes.data if isinstance(a, np.ndarray) else a for a in arguments]
    before = time.thread_time()
    code = function(*given)
    return code, time.thread_time() - before


def checked_result(name: str, code: int, result: Integration, meanings: Mapping[int, str] = CODES) -> Integration:
    """The result of an integration. Raises IntegratorError if the return code is not 0, and no observer's stop."""
    if code not in (0, STOPPED):
        raise IntegratorError(name, code, result, meanings)
    return result


def checked_array(name: str, given: ArrayLike, shape: tuple[int, ...]) -> Array:
    """A contiguous array of doubles. Raises ValueError if it has another shape."""
    array = np.ascontiguousarray(doubles(given, name))
    if array.shape != shape:
        raise ValueError(f"{name}: an array of shape {shape} is needed, not {array.shape}")
    return array
