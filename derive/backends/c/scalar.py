"""Functions in C that have no loops."""

from __future__ import annotations

from derive.ir.model import Kernel
from derive.ir.statements import Let, Require, Store

SCALAR_MACRO = """\
/* Before a function without loops: gcc would make vectors of neighbouring values, which takes longer than it saves. */
#if defined(__GNUC__) && !defined(__clang__)
#  define TISSERAND_SCALAR __attribute__((optimize("no-tree-slp-vectorize")))
#else
#  define TISSERAND_SCALAR
#endif
"""


def before(kernel: Kernel) -> str:
    """The line before the function of a kernel."""
    return "TISSERAND_SCALAR\n" if all(isinstance(s, Let | Store | Require) for s in kernel.statements) else ""
