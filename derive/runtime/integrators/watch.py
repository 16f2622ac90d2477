"""The largest and mean values of quantities along a motion: `templates/host/watch.h`, or from rows."""

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
    """What was seen of each quantity in a motion.

    largest (n,): its largest value; times (n,): when, s; states (n, nq): in which q. mean_squares (n,): of its values
    over the time.
    """

    largest: Vector
    times: Vector
    states: Matrix
    mean_squares: Vector


@dataclass(frozen=True, eq=False)
class Watch:
    """Quantities of a scene that are watched: each is the largest |f| of its forms f = F z of z = [q; v; outputs].

    forms: the matrices F (forms, nq + nv + nout) of the quantities.
    """

    forms: tuple[Matrix, ...] = ()

    def of_rows(self, t: Vector, z: Matrix, nq: int) -> Watched:
        """What is seen in the rows z (rows, nq + nv + nout) at the times t (rows,), s."""
        values = np.array([np.abs(z @ form.T).max(axis=1) for form in self.forms]).reshape(len(self.forms), len(t))
        rows, squares = values.argmax(axis=1), values**2
        means = squares[:, 0]
        if len(t) > 1:
            means = (squares[:, 1:] + squares[:, :-1]) @ np.diff(t) / 2 / (t[-1] - t[0])
        return Watched(values.max(axis=1), t[rows], z[rows, :nq], means)


class _Structure(ctypes.Structure):
    _fields_ = [
        ("model", ctypes.c_void_p),
        ("k", ctypes.c_void_p),
        ("count", ctypes.c_int),
        *((name, ctypes.c_void_p) for name in ("forms", "terms", "columns", "factors")),
        *((name, ctypes.c_void_p) for name in ("largest", "times", "at", "integrals", "last", "work")),
        ("states", ctypes.c_long),
    ]


class _Observer(ctypes.Structure):
    _fields_ = [("call", ctypes.c_void_p), ("data", ctypes.c_void_p)]


@dataclass(eq=False)
class WatchInC:
    """A watch as an observer of the steps of a C integrator; `address` is the argument, `seen` what it has seen.

    library: that of the hosts. native, k: the compiled scene and its constants (nk,).
    """

    watch: Watch
    library: ctypes.CDLL
    native: NativeScene
    k: Vector
    largest: Vector = field(init=False)
    times: Vector = field(init=False)
    states: Matrix = field(init=False)
    integrals: Vector = field(init=False)
    last: Vector = field(init=False)

    def __post_init__(self) -> None:
        native, forms = self.native, self.watch.forms
        n = len(forms)
        self.largest, self.times, self.integrals = np.zeros(n), np.zeros(n), np.zeros(n)
        self.states, self.last = np.zeros((n, native.nq)), np.zeros(n + 1)
        work = np.zeros(native.nq + 2 * native.nv + native.nlambda + len(native.outputs))
        rows = [row for form in forms for row in form]
        terms = [np.flatnonzero(row) for row in rows]
        self._arrays = (
            _numbers(len(form) for form in forms),
            _numbers(len(columns) for columns in terms),
            np.concatenate([*terms, []]).astype(np.int32),
            np.concatenate([*(row[columns] for row, columns in zip(rows, terms, strict=True)), []]),
            *(self.largest, self.times, self.states, self.integrals, self.last, work),
        )
        addresses = [array.ctypes.data for array in self._arrays]
        self._structure = _Structure(native.address, self.k.ctypes.data, n, *addresses, 0)
        call = ctypes.cast(self.library.tisserand_watch_state, ctypes.c_void_p).value
        self._observer = _Observer(call, ctypes.addressof(self._structure))
        self.address = ctypes.addressof(self._observer)

    def seen(self, duration: float) -> Watched:
        """What it has seen in a motion over `duration`, s."""
        means = self.integrals / duration if duration > 0 else self.last[:-1]
        return Watched(self.largest, self.times, self.states, means)


def _numbers(counts: Iterable[int]) -> NDArray[np.int32]:
    """(n + 1,): the number of the first of `counts` things that follow each other, and that of all."""
    return np.cumsum([0, *counts], dtype=np.int32)
