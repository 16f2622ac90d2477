"""Functions with the text of an earlier one, which they call.

Without constraints the forms for implicit integrators are one form, and the multipliers of a solution are none.
"""

from __future__ import annotations

from collections.abc import Callable

from derive.ir.kernel import Kernel
from derive.ir.model import Model


def repeated(model: Model, may_call: Callable[[Kernel, Kernel], bool]) -> dict[str, Kernel]:
    """The kernels with the text of an earlier one that they may call, by name, with the first such one."""
    result: dict[str, Kernel] = {}
    for n, kernel in enumerate(model.kernels):
        for other in model.kernels[:n]:
            if _repeats(kernel, other) and may_call(kernel, other):
                result.setdefault(kernel.name, other)
    return result


def _repeats(kernel: Kernel, other: Kernel) -> bool:
    """Whether a kernel does what another one does, to outputs of which it may have further ones without elements."""
    same = kernel.sections and kernel.sections == other.sections and kernel.arguments == other.arguments
    filled = [(o.name, o.size) for o in kernel.outputs if o.size]
    return bool(same) and filled == [(o.name, o.size) for o in other.outputs]
