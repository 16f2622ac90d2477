"""A function of Python that follows the rows of a C integrator while it runs: for its progress, or to end it."""

from __future__ import annotations

import ctypes
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from derive.runtime.native_call import Vector

Observe = Callable[[float, Vector], bool]
"""A function of the time (s) and the row [q; v; lambda] of an integration; if it returns true, the integration ends."""

_CALL = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_double, ctypes.POINTER(ctypes.c_double))


class _Structure(ctypes.Structure):
    _fields_ = [("call", _CALL), ("data", ctypes.c_void_p)]


class Observer:
    """A function as the observer of a C integrator, with rows of `width` numbers.

    `pointer` is the argument of the C function, None without a function; `address` is the same as a number, or 0. An
    exception of the function ends the integration, and `interrupts` raises it again outside the C.
    """

    def __init__(self, observe: Observe | None, width: int) -> None:
        self._error: BaseException | None = None

        def call(_: int | None, t: float, row: Any) -> int:
            assert observe is not None
            if self._error is not None:
                return 1
            try:
                return int(observe(t, np.array(row[:width])))
            except BaseException as error:  # an exception cannot pass through the C, not even a KeyboardInterrupt
                self._error = error
                return 1

        self._structure = _Structure(_CALL(call), None)  # keeps the function alive
        self.pointer = None if observe is None else ctypes.byref(self._structure)
        self.address = 0 if observe is None else ctypes.addressof(self._structure)

    @contextmanager
    def interrupts(self) -> Iterator[None]:
        """A context in which Ctrl-C ends the integration at the next row, and that raises the exception at its end.

        Python would raise it before the function's first line, from where it does not come through the C.
        """
        main = threading.current_thread() is threading.main_thread()
        handled = self.pointer is not None and main and signal.getsignal(signal.SIGINT) is signal.default_int_handler

        def interrupted(*_: object) -> None:
            self._error = KeyboardInterrupt()

        try:
            if handled:
                signal.signal(signal.SIGINT, interrupted)
            yield
        finally:
            if handled:
                signal.signal(signal.SIGINT, signal.default_int_handler)
        if self._error is not None:
            raise self._error
