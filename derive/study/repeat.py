"""A function of a compiled model, called again and again by a loop in C: its time without that of Python."""

from __future__ import annotations

import ctypes
import tempfile
import time
from pathlib import Path

import numpy as np

from derive.runtime.compiler import compile_shared
from derive.runtime.native import Matrix, ModelError, NativeScene, Vector

SOURCE = """\
typedef int function(double t, const double *q, const double *v, const double *k, double *result);

int repeat(function *f, long calls, long states, int nq, int nv, const double *t, const double *q, const double *v,
           const double *k, double *result)
{
    for (long i = 0, s = 0; i < calls; i++, s = s + 1 < states ? s + 1 : 0) {
        const int code = f(t[s], q + s * nq, v + s * nv, k, result);
        if (code != 0) {
            return code;
        }
    }
    return 0;
}
"""
"""One state after the other, in a circle; all functions f(t, q, v, k) have this form."""


class Repeater:
    """The loop, compiled."""

    def __init__(self) -> None:
        with tempfile.TemporaryDirectory(prefix="tisserand-") as folder:
            source = Path(folder) / "repeat.c"
            source.write_text(SOURCE)
            self._library = ctypes.CDLL(str(compile_shared([source], Path(folder) / "repeat.so")))
        long, whole, address = ctypes.c_long, ctypes.c_int, ctypes.c_void_p
        self._library.repeat.argtypes = [address, long, long, whole, whole, *[address] * 5]

    def seconds(self, native: NativeScene, function: str, calls: int, t: Vector, q: Matrix, v: Matrix) -> float:
        """CPU seconds of one call of `accel` or `force`, in the states t (n,), q (n, nq), v (n, nv) in turn.

        Raises ModelError.
        """
        address = ctypes.cast(native.function(function), ctypes.c_void_p)
        arrays = [np.ascontiguousarray(x) for x in (t, q, v, native.setup())] + [np.empty(native.nv)]
        given = [x.ctypes.data for x in arrays]
        before = time.thread_time()
        code = self._library.repeat(address, calls, len(t), native.nq, native.nv, *given)
        taken = time.thread_time() - before
        if code:
            raise ModelError(f"{native.name}_{function}", code)
        return taken / calls
