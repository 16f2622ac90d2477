"""What all C hosts have in common: a library that holds model and host, states that go in, rows that come out."""

from __future__ import annotations

import ctypes
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
from derive.runtime.compiler import FLAGS, compile_c
from derive.runtime.integrators.build import header, written
from derive.runtime.native import Vector, native_model

Array = NDArray[np.float64]

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


class HostError(TisserandError):
    """An integration stopped with a code other than 0; `partial` is what it had reached, then NaN."""

    def __init__(self, name: str, code: int, partial: Integration, meanings: Mapping[int, str] = CODES) -> None:
        self.code, self.partial = code, partial
        good = partial.t[np.all(np.isfinite(partial.q), axis=-1)] if partial.q.ndim == 2 else partial.t[:0]
        where = f" after t = {good[-1]:g}" if len(good) else ""
        super().__init__(f"{name}: code {code}{where}: {meanings.get(code, 'see ida/ida.h')}")


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


def fields(*names: str) -> list[tuple[str, Any]]:
    """Members of a C structure of counts."""
    return [(name, ctypes.c_long) for name in names]


class Host:
    """A model and the host sources in one shared library; `native` is the model."""

    def __init__(
        self, files: Sequence[File], hosts: Sequence[str], extra: Sequence[str] = (), link: Sequence[str] = ()
    ):
        with tempfile.TemporaryDirectory(prefix="tisserand-") as folder:
            name, sources = written(files, hosts, Path(folder))
            library = Path(folder) / "host.so"
            compile_c(sources, library, [*FLAGS, *extra, *header(name, Path(folder)), "-shared", "-fPIC"], link)
            self.library = ctypes.CDLL(str(library))
        self.native = native_model(self.library, name)
        self.model = ctypes.cast(getattr(self.library, f"{name}_model")(), ctypes.c_void_p)
        self.width: int = self.library.tisserand_fixed_row(self.model)

    def constants(self, k: ArrayLike | None) -> Vector:
        """k as given, or of the default parameters."""
        return self.native.setup() if k is None else checked("k", k, (self.native.nk,))

    def states(self, q0: ArrayLike, v0: ArrayLike) -> tuple[Array, Array]:
        """Copies, which the hosts overwrite."""
        q, v = np.array(q0, dtype=float, order="C"), np.array(v0, dtype=float, order="C")
        states = q.shape[:-1]
        return checked("q0", q, (*states, self.native.nq)), checked("v0", v, (*states, self.native.nv))

    def state(self, q0: ArrayLike, v0: ArrayLike) -> tuple[Vector, Vector]:
        """The same of one state."""
        q, v = self.states(q0, v0)
        if q.ndim != 1:
            raise ValueError("q0 and v0 have to be vectors: this method integrates one state")
        return q, v

    def integration(self, t: Vector, rows: Array, counts: ctypes.Structure, seconds: float) -> Integration:
        """Rows of q, v, lambda taken apart."""
        q, v, lam = np.split(rows, np.cumsum([self.native.nq, self.native.nv]), axis=-1)
        return Integration(t, q, v, lam, {n: getattr(counts, n) for n, *_ in counts._fields_}, seconds)


def times(t0: float, interval: float, rows: int) -> Vector:
    """The instants of the rows, s."""
    return np.asarray(t0 + interval * np.arange(rows), dtype=np.float64)


def check_steps(steps: int, every: int) -> None:
    """Raise ValueError unless there are such steps and rows."""
    if steps < 0 or every < 1:
        raise ValueError(f"{steps} steps with a row every {every} steps make no sense")


def types(letters: str) -> list[Any]:
    """Types of arguments: a letter each, for pointer, int, long and double."""
    kinds = {"p": ctypes.c_void_p, "i": ctypes.c_int, "l": ctypes.c_long, "d": ctypes.c_double}
    return [kinds[letter] for letter in letters]


def timed(function: Callable[..., int], *arguments: Any) -> tuple[int, float]:
    """The code of a C function, and its CPU time. Arrays go as addresses."""
    given = [a.ctypes.data if isinstance(a, np.ndarray) else a for a in arguments]
    before = time.thread_time()
    code = function(*given)
    return code, time.thread_time() - before


def finished(name: str, code: int, found: Integration, meanings: Mapping[int, str] = CODES) -> Integration:
    """What was found; raises HostError, which holds it, when the code is not 0."""
    if code:
        raise HostError(name, code, found, meanings)
    return found


def checked(name: str, given: ArrayLike, shape: tuple[int, ...]) -> Array:
    """An array as C takes it; raises ValueError when it has another shape."""
    array = np.ascontiguousarray(given, dtype=np.float64)
    if array.shape != shape:
        raise ValueError(f"{name}: an array of shape {shape} is needed, not {array.shape}")
    return array
