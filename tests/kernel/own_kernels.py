"""Kernels of a test's own statements: of an array x, with results y."""

from __future__ import annotations

from derive.ir.kernel import Argument, Kernel, Output, Section, View
from derive.ir.statements import Statement


def own_kernel(given: int, results: int, statements: tuple[Statement, ...] = ()) -> Kernel:
    """A kernel with so many elements of x and of y."""
    x = Argument("x", (), "given", arrays=(View("x", 0, given),))
    y = Output("y", tuple(f"y{k}" for k in range(results)), "result")
    return Kernel("own", "", (x,), (y,), (Section("", "", "", statements),))
