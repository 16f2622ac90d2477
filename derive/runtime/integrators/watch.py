"""The largest and mean values of quantities along a motion, by `templates/host/watch.h` or from rows."""

from __future__ import annotations

import ctypes
from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from derive.runtime.native_call import Matrix, Vector
from derive.runtime.native_scene import NativeScene


@dataclass(frozen=True, eq=False)
class Watched:
    """The largest and mean values of each watched quantity in a motion.

    largest (n,): the largest absolute values; times (n,), s, and states (n, nq): the time and the coordinates q of
    each. means, mean_squares (n,): the means over time of the values and of their squares.
    """

    largest: Vector
    times: Vector
    states: Matrix
    means: Vector
    mean_squares: Vector


@dataclass(frozen=True, eq=False)
class WatchedQuantity:
    """A quantity of a motion: the one of its forms f = F z, z = [q; v; outputs; t], with the largest absolute value.

    forms: the matrix F (forms, nq + nv + nout + 1), where t is the time since the begin, s. factor: the number of an
    earlier quantity whose value multiplies it.
    """

    forms: Matrix
    factor: int | None = None


@dataclass(frozen=True, eq=False)
class Watch:
    """Quantities of a scene that are watched."""

    quantities: tuple[WatchedQuantity, ...] = ()

    def of_rows(self, t: Vector, z: Matrix, nq: int) -> Watched:
        """The largest and mean values in the rows z (rows, nq + nv + nout) at the times t (rows,), s."""
        values = self.values(t, z)
        rows = np.abs(values).argmax(axis=1)
        largest = np.abs(values).max(axis=1)
        return Watched(largest, t[rows], z[rows, :nq], *(_mean(t, x) for x in (values, values**2)))

    def values(self, t: Vector, z: Matrix) -> Matrix:
        """The values (quantities, rows) in the same rows."""
        z = np.hstack([z, (t - t[0])[:, None]])
        values = np.zeros((len(self.quantities), len(t)))
        for i, quantity in enumerate(self.quantities):
            forms = z @ quantity.forms.T
            values[i] = np.take_along_axis(forms, np.abs(forms).argmax(axis=1)[:, None], axis=1)[:, 0]
            if quantity.factor is not None:
                values[i] *= values[quantity.factor]
        return values


def _mean(t: Vector, values: Matrix) -> Vector:
    """The mean values over the time (n,) of quantities (n, rows), by the trapezoidal rule."""
    if len(t) == 1:
        return values[:, 0]
    result: Vector = (values[:, 1:] + values[:, :-1]) @ np.diff(t) / 2 / (t[-1] - t[0])
    return result


class _Structure(ctypes.Structure):
    _fields_ = [
        ("model", ctypes.c_void_p),
        ("k", ctypes.c_void_p),
        ("count", ctypes.c_int),
        *((name, ctypes.c_void_p) for name in ("forms", "terms", "columns", "factors", "multipliers")),
        *((name, ctypes.c_void_p) for name in ("largest", "times", "at", "integrals", "squares", "last", "work")),
        ("begin", ctypes.c_double),
        ("states", ctypes.c_long),
    ]


class _Observer(ctypes.Structure):
    _fields_ = [("call", ctypes.c_void_p), ("data", ctypes.c_void_p)]


@dataclass(eq=False)
class WatchInC:
    """A watch as an observer of the steps of a C integrator; `address` is the argument, `seen` returns the values.

    library: the one with `tisserand_watch_state`. native, k: the compiled scene and its constants (nk,).
    """

    watch: Watch
    library: ctypes.CDLL
    native: NativeScene
    k: Vector
    largest: Vector = field(init=False)
    times: Vector = field(init=False)
    states: Matrix = field(init=False)
    integrals: Vector = field(init=False)
    squares: Vector = field(init=False)
    last: Vector = field(init=False)

    def __post_init__(self) -> None:
        native, quantities = self.native, self.watch.quantities
        n = len(quantities)
        self.largest, self.times, self.integrals, self.squares = (np.zeros(n) for _ in range(4))
        self.states, self.last = np.zeros((n, native.nq)), np.zeros(n + 1)
        work = np.zeros(native.nq + 2 * native.nv + native.nlambda + len(native.outputs) + 1)
        rows = [row for quantity in quantities for row in quantity.forms]
        terms = [np.flatnonzero(row) for row in rows]
        self._arrays = (
            _numbers(len(quantity.forms) for quantity in quantities),
            _numbers(len(columns) for columns in terms),
            np.concatenate([*terms, []]).astype(np.int32),
            np.concatenate([*(row[columns] for row, columns in zip(rows, terms, strict=True)), []]),
            np.array([-1 if q.factor is None else q.factor for q in quantities], dtype=np.int32),
            *(self.largest, self.times, self.states, self.integrals, self.squares, self.last, work),
        )
        addresses = [array.ctypes.data for array in self._arrays]
        self._structure = _Structure(native.address, self.k.ctypes.data, n, *addresses, 0.0, 0)
        call = ctypes.cast(self.library.tisserand_watch_state, ctypes.c_void_p).value
        self._observer = _Observer(call, ctypes.addressof(self._structure))
        self.address = ctypes.addressof(self._observer)

    def seen(self, duration: float) -> Watched:
        """The largest and mean values in the observed motion over `duration`, s."""
        last = self.last[:-1]
        means = (self.integrals / duration, self.squares / duration) if duration > 0 else (last, last**2)
        return Watched(self.largest, self.times, self.states, *means)


def _numbers(counts: Iterable[int]) -> NDArray[np.int32]:
    """The offsets (n + 1,) of n consecutive groups with `counts` elements; the last is the number of all elements."""
    return np.cumsum([0, *counts], dtype=np.int32)
