"""The signatures of the functions of a model in C."""

from __future__ import annotations

from collections.abc import Sequence

from derive.ir.kernel import Argument, Kernel


def signature(name: str, parameters: Sequence[str]) -> list[str]:
    """The lines of a signature, with one parameter in each; the type of the result precedes the name."""
    *others, last = parameters
    return [f"{name}(", *(f"    {parameter}," for parameter in others), f"    {last})"]


def parameters(kernel: Kernel, outputs: str = "double *") -> list[str]:
    """The arguments and outputs of a kernel; `outputs` precedes the names of the latter."""
    return [*(f"{_type(a)}{a.name}" for a in kernel.arguments), *(f"{outputs}{o.name}" for o in kernel.outputs)]


def parameters_by_name(kernel: Kernel) -> dict[str, str]:
    """The parameters of a kernel by the names of its arguments and outputs."""
    return dict(zip(names(kernel), parameters(kernel), strict=True))


def _type(argument: Argument) -> str:
    """The type of an argument, before its name."""
    if argument.scalar:
        return "int " if argument.integer else "double "
    return "const double *TISSERAND_RESTRICT "


def names(kernel: Kernel) -> list[str]:
    """The names of the arguments and outputs of a kernel, in their order."""
    return [*(a.name for a in kernel.arguments), *(o.name for o in kernel.outputs)]
