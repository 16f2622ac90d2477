"""Functions that are the beginning of another one: both call one static function, whose last outputs may be null.

The accelerations are the beginning of the function that gives the multipliers as well. Loops over instances have the
text of both once, since compilers take long for it; a call and a test of a pointer are no measurable part of its time.
"""

from __future__ import annotations

from collections.abc import Sequence

from derive.backends.c.optional_parts import optional_part
from derive.backends.c.signatures import names, parameters, signature
from derive.backends.repeated import repeated
from derive.backends.source_map import SourceLine, plain
from derive.ir.kernel import Kernel
from derive.ir.model import Model


def beginnings(model: Model) -> dict[str, str]:
    """The kernels that are the beginning of another one, by name, with the names of the others."""
    if model.lowering != "instances":
        return {}
    return {a.name: b.name for a in model.kernels for b in model.kernels if _begins(a, b)}


def by_solution(model: Model) -> dict[str, Kernel]:
    """The kernels that a model for explicit integration computes by calling a function with more outputs, by name.

    These are the accelerations: straight-line code for them is nearly all of that for accelerations and multipliers,
    whose compilation takes a third of the time of such a model, and multipliers take a hundredth of the run time.
    """
    if not model.explicit or model.lowering != "flat" or not model.multipliers:
        return {}
    return {"accel": model.kernel("solve")}


def repeated_functions(model: Model) -> dict[str, Kernel]:
    """The kernels with the text of an earlier one that is part of every library that they are part of, by name."""

    def together(kernel: Kernel, other: Kernel) -> bool:
        return optional_part(other.name) in (None, optional_part(kernel.name))

    return repeated(model, together)


def calling_repeated(model: Model, kernel: Kernel, other: Kernel) -> list[SourceLine]:
    """The function of a kernel that calls another one with the same text."""
    unused = (f"    (void) {name};" for name in names(kernel) if name not in names(other))
    body = f"    return {model.name}_{other.name}({', '.join(names(other))});"
    return plain(*signature(f"int {model.name}_{kernel.name}", parameters(kernel)), "{", *unused, body, "}")


def calling_solution(model: Model, kernel: Kernel, whole: Kernel) -> list[SourceLine]:
    """The function of a kernel that calls the function of another one, whose last output it does not return."""
    last = whole.outputs[-1]
    body = [
        f"    double {last.name}[{last.size}];",
        f"    return {model.name}_{whole.name}({', '.join([*names(kernel), last.name])});",
    ]
    return plain(*signature(f"int {model.name}_{kernel.name}", parameters(kernel)), "{", *body, "}")


def _begins(a: Kernel, b: Kernel) -> bool:
    """Whether `b` computes the outputs of `a` in the same way, and more outputs in further sections."""
    return (
        0 < len(a.sections) < len(b.sections)
        and len(a.outputs) + 1 == len(b.outputs)
        and a.arguments == b.arguments
        and [o.name for o in a.outputs] == [o.name for o in b.outputs[:-1]]
        and a.sections == b.sections[: len(a.sections)]
    )


def shared_signature(model: Model, whole: Kernel) -> list[str]:
    """The signature of the static function."""
    return signature(f"TISSERAND_SHARED int {_shared(model, whole)}", parameters(whole))


def without_last(whole: Kernel) -> list[str]:
    """The line that ends the static function before the sections of the output that a caller does without."""
    return [f"    if (!{whole.outputs[-1].name}) return 0;"]


def calling(model: Model, kernel: Kernel, whole: Kernel) -> list[SourceLine]:
    """The function of a kernel that calls the static function, without its last output or with all."""
    passed: Sequence[str] = names(kernel) if kernel is whole else [*names(kernel), "0"]
    call = f"    return {_shared(model, whole)}({', '.join(passed)});"
    return plain(*signature(f"int {model.name}_{kernel.name}", parameters(kernel)), "{", call, "}")


def _shared(model: Model, whole: Kernel) -> str:
    return f"{model.name}_{whole.name}_or_less"
