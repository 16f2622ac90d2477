"""The functions of the descriptor of a model with run-time inputs, which read the inputs behind the constants.

Hosts call all models through one descriptor, whose functions have no argument u. A host that knows of inputs writes
them behind the constants; all others leave the zeros that setup writes.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass

from derive.backends.c.optional_parts import OptionalPart, optional_part
from derive.ir.kernel import Kernel
from derive.ir.model import Model

SETUP = "setup"


@dataclass(frozen=True)
class PackedFunction:
    """A function as text: its signature, and the call of the function with separate inputs; the part it belongs to."""

    signature: str
    body: str
    part: OptionalPart | None = None


def entries(model: Model, batches: tuple[str, ...]) -> dict[str, str]:
    """The C name of the function in the descriptor, by the names of kernels and batches; "0" if there is none."""
    packed = {kernel.name for kernel in _packed(model)}
    names = {kernel.name: kernel.name for kernel in model.kernels}
    names |= {f"{name}_batch": name for name in batches}
    prefix = {True: f"{model.name}_packed", False: model.name}
    present = {name: f"{prefix[kernel in packed]}_{name}" for name, kernel in names.items()}
    return defaultdict(lambda: "0", present)


def packed_functions(model: Model, batches: tuple[str, ...]) -> Iterator[PackedFunction]:
    """The functions with packed inputs; `batches` are the kernels that are functions of batches as well."""
    size = f"{model.name.upper()}_NK"
    for kernel in _packed(model):
        if kernel.name == SETUP:
            yield PackedFunction(
                f"static int {model.name}_packed_setup(const double *p, double *k)",
                f"    for (int i = 0; i < {model.name.upper()}_NU; i++) k[{size} + i] = 0.0;\n"
                f"    return {model.name}_setup(p, k);",
            )
            continue
        names = [*(a.name for a in kernel.arguments), *(o.name for o in kernel.outputs)]
        types = ["double " if a.scalar else "const double *" for a in kernel.arguments]
        types += ["double *" for _ in kernel.outputs]
        parameters = list(zip(types, names, strict=True))
        yield _function(model.name, kernel.name, size, parameters, optional_part(kernel.name))
        if kernel.name in batches:
            many = [("int ", "n"), *parameters]
            yield _function(model.name, f"{kernel.name}_batch", size, many, OptionalPart.BATCHES)


def _function(
    model: str, name: str, size: str, parameters: list[tuple[str, str]], part: OptionalPart | None
) -> PackedFunction:
    declared = ", ".join(f"{kind}{parameter}" for kind, parameter in parameters if parameter != "u")
    passed = ", ".join(f"k + {size}" if parameter == "u" else parameter for _, parameter in parameters)
    signature, body = f"static int {model}_packed_{name}({declared})", f"    return {model}_{name}({passed});"
    return PackedFunction(signature, body, part)


def _packed(model: Model) -> tuple[Kernel, ...]:
    """The kernels whose functions in the descriptor differ from those of the header."""
    if not model.inputs:
        return ()
    return tuple(k for k in model.kernels if k.name == SETUP or any(a.name == "u" for a in k.arguments))
