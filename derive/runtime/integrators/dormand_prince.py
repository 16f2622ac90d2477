"""The error estimates of `templates/host/dormand_prince.c`, for the same method in Python."""

from __future__ import annotations

import ctypes
import tempfile
from functools import cache
from pathlib import Path

import numpy as np

from derive.runtime.integrators.c_integrator import Array, types
from derive.runtime.integrators.compilation import host_sources
from derive.runtime.loading import library_data, load_data
from derive.runtime.native_call import Vector


def step_error(h: float, change: Vector, stages: Array, allowed: Vector) -> float:
    """The error estimate of a step of h (s), relative to `allowed` (n,), the error of each element that is accepted.

    change (n,): of the state in the step. stages (12 or more, n): the derivatives in the stages. Raises CompilerError.
    """
    start, end = np.zeros_like(change), np.ascontiguousarray(change)
    arrays = (start, end, np.ascontiguousarray(stages))
    addresses = [array.ctypes.data for array in arrays]
    scale = np.ascontiguousarray(allowed)
    return float(_library().tisserand_step_error(len(change), h, *addresses, 0.0, scale.ctypes.data))


def interpolant_error(interpolant: Array, allowed: Vector) -> float:
    """The error estimate of an interpolant within its step: below 1, it is as exact as a state there has to be.

    interpolant: its coefficients (7, n). allowed (n,): see `step_error`. Raises CompilerError.
    """
    none, coefficients = np.zeros_like(allowed), np.ascontiguousarray(interpolant)
    scale = np.ascontiguousarray(allowed)
    addresses = [array.ctypes.data for array in (none, none, coefficients)]
    return float(_library().tisserand_interpolant_error(len(allowed), *addresses, 0.0, scale.ctypes.data))


@cache
def _library() -> ctypes.CDLL:
    with tempfile.TemporaryDirectory(prefix="tisserand-") as temporary:
        folder = Path(temporary)
        library = load_data(library_data(host_sources(["dormand_prince"], folder), folder))
    library.tisserand_step_error.argtypes = types("idpppdp")
    library.tisserand_interpolant_error.argtypes = types("ipppdp")
    for function in (library.tisserand_step_error, library.tisserand_interpolant_error):
        function.restype = ctypes.c_double
    return library
