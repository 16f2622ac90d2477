"""The C++17 wrapper of a model: its functions as members with spans of fixed sizes, in a header alone."""

from __future__ import annotations

from dataclasses import dataclass

from derive.backends.wrapping import comment
from derive.export.host_model import HostModel
from derive.ir.model import Kernel

KEPT = ("u", "k")
"""The arguments that an object of the wrapper holds: inputs and constants."""


@dataclass(frozen=True)
class MemberFunction:
    """A member function: comment, name, parameters with their types, and the arguments of the C function."""

    doc: str
    name: str
    parameters: str
    arguments: str


def member_functions(model: HostModel) -> list[MemberFunction]:
    """The functions of a model but `setup`, in the order of its header; batches are called in C."""
    return [_member_function(kernel) for kernel in model.model.kernels if kernel.name != "setup"]


def _member_function(kernel: Kernel) -> MemberFunction:
    parameters, arguments = [], []
    for argument in kernel.arguments:
        if argument.name in KEPT:
            arguments.append(f"{argument.name}_.data()")
        elif argument.scalar:
            parameters.append(f"double {argument.name}")
            arguments.append(argument.name)
        else:
            parameters.append(f"tisserand::span<const double, {argument.size}> {argument.name}")
            arguments.append(f"{argument.name}.data()")
    for output in kernel.outputs:
        parameters.append(f"tisserand::span<double, {output.size}> {output.name}")
        arguments.append(f"{output.name}.data()")
    doc = "\n".join(comment((kernel.doc,), "    "))
    return MemberFunction(doc, kernel.name, ", ".join(parameters), ", ".join(arguments))
