"""Models with some of their functions, for tests of these: the lowering of the others would take most of the time."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import pytest

from derive.lowering.model_functions import FunctionKind, ModelFunction, functions_of

PATTERNS = ("mass", "constraint_jacobian")
"""Functions that models and the interpreter ask for the places of non-zeros, which take little time."""


@contextmanager
def only(*names: str) -> Iterator[None]:
    """Mechanisms are lowered with the functions of these names alone, and those of `PATTERNS`.

    "markers" stands for the motions of all markers, which the interpreter has where the model has markers.
    """

    def functions(*of: Any) -> tuple[ModelFunction, ...]:
        kept = {*PATTERNS, *names}
        return tuple(
            function
            for function in functions_of(*of)
            if function.name in kept or (function.kind is FunctionKind.MARKER and "markers" in kept)
        )

    with pytest.MonkeyPatch.context() as patch:
        for form in ("flat", "instances", "trees"):
            patch.setattr(f"derive.lowering.{form}.lower.functions_of", functions)
        yield
