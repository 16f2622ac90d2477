"""Models with straight-line code, which some exports need, and their Python functions without branches on data."""

from __future__ import annotations

from collections.abc import Collection

from derive.backends.python.constants import constant_array
from derive.backends.python.module import Failure, python_function
from derive.errors import Problem, SpecError
from derive.ir.model import Model


def require_straight_line(model: Model) -> None:
    """Raise SpecError for a model with loops over modes; loops over bodies are unrolled where they run."""
    if model.lowering == "loops":
        text = f'{model.choice}; an export for arrays or symbols has straight-line code: lowering = "flat"'
        raise SpecError((Problem("body.lowering", text),))


def straight_line_functions(model: Model, failure: Failure, names: Collection[str] | None = None) -> str:
    """The functions of the kernels of these names, or of all, for arrays that are traced and for symbols.

    Raises SpecError for a model with loops.
    """
    require_straight_line(model)
    kernels = [kernel for kernel in model.kernels if names is None or kernel.name in names]
    functions = (python_function(kernel, elements=True, numbers=False, failure=failure) for kernel in kernels)
    arrays = {array.name: array for kernel in kernels for array in kernel.constants}
    constants = [f"{name} = {values}" for name, values in map(constant_array, arrays.values())]
    texts = ("\n".join(line.text for line in lines) for lines in functions)
    return "\n\n\n".join([*(["\n".join(constants)] if constants else []), *texts])
