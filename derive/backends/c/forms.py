"""The forms of equations for implicit integrators: one static function, which the function of each form calls.

Forms have their kinematics and equations of motion in common, and much of their constraints. Compilers take as long for
a text each time it occurs; a call, and a test in each iteration of a loop, are no measurable part of their time.
"""

from __future__ import annotations

from derive.backends.c.optional_parts import REDUCED_FORMS
from derive.backends.c.signatures import names, parameters, signature
from derive.backends.source_map import SourceLine, plain
from derive.ir.kernel import Kernel
from derive.ir.model import JACOBIAN, Model
from derive.ir.variants import Variants, variants

KINDS = ("residual", JACOBIAN)
"""The functions that have forms."""


def shared_forms(model: Model) -> list[Variants]:
    """The functions whose forms share their loops."""
    if model.lowering != "instances" or model.explicit:
        return []
    of_kinds = ([model.kernel(f"{kind}{suffix}") for suffix in ("", *REDUCED_FORMS.values())] for kind in KINDS)
    return [of for of in map(variants, of_kinds) if of]


def form_signature(model: Model, of: Variants) -> list[str]:
    """The signature of the static function."""
    return signature(f"TISSERAND_OF_FORMS int {_name(model, of)}", [f"int {of.selector}", *parameters(of.kernels[0])])


def form_call(model: Model, kernel: Kernel, of: Variants) -> list[SourceLine]:
    """The last lines of the function of a kernel, which call the static function."""
    number = of.kernels.index(kernel)
    return plain(f"    return {_name(model, of)}({', '.join([str(number), *names(kernel)])});", "}")


def _name(model: Model, of: Variants) -> str:
    return f"{model.name}_{of.kernels[0].name}_of_forms"
