"""A function of Python that follows the rows of a C integrator while it runs: for its progress, or to end it."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
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

    `pointer` is the argument of the C function, None without a function; `address` is the same as a number, or 0. What
    the function raises ends the integration, and `reraise` raises it again outside the C.
    """

    def __init__(self, observe: Observe | None, width: int) -> None:
        self._error: BaseException | None = None

        def call(_: int | None, t: float, row: Any) -> int:
            assert observe is not None
            try:
                return int(observe(t, np.array(row[:width])))
            except BaseException as error:  # an exception cannot pass through the C, not even a KeyboardInterrupt
                self._error = error
                return 1

        self._structure = _Structure(_CALL(call), None)  # keeps the function alive
        self.pointer = None if observe is None else ctypes.byref(self._structure)
        self.address = 0 if observe is None else ctypes.addressof(self._structure)

    def reraise(self) -> None:
        """Raise what the function has raised, if it has."""
        if self._error is not None:
            raise self._error
