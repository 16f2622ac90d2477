"""The sets of statements, operators and return codes are closed: what is not in them is an error everywhere."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import pytest

import beams
from derive.backends.c.batch import batch_function
from derive.backends.c.batch_block import StateBlock
from derive.backends.c.source import CBackend
from derive.backends.python.backend import PythonBackend
from derive.ir.analysis import expressions, operations, reads
from derive.ir.interpreter import interpret
from derive.ir.kernel import Kernel
from derive.ir.model import Model
from derive.ir.statements import ReturnCode
from derive.runtime.native_call import ModelError


@dataclass(frozen=True)
class Unknown:
    """No statement."""

    output: str = "M"


def kernel() -> Kernel:
    """`mass` of a beam with a statement that nobody knows."""
    mass = beams.made("mean", 2).model.kernel("mass")
    section: Any = replace(mass.sections[-1], body=(*mass.sections[-1].body, Unknown()))
    return replace(mass, sections=(*mass.sections[:-1], section))


def model() -> Model:
    """The beam with that kernel."""
    whole = beams.made("mean", 2).model
    return replace(whole, kernels=tuple(kernel() if k.name == "mass" else k for k in whole.kernels))


USES: dict[str, Callable[[], Any]] = {
    "operations": lambda: operations(Unknown()),  # type: ignore[arg-type]
    "operations of a kernel": lambda: kernel().operations,
    "expressions": lambda: expressions(Unknown()),  # type: ignore[arg-type]
    "reads": lambda: list(reads(Unknown())),  # type: ignore[arg-type]
    "C": lambda: CBackend().files(model(), ""),
    "Python": lambda: PythonBackend().files(model(), ""),
    "a batch in C": lambda: batch_function(StateBlock(kernel(), "beam", 32)),
    "interpreter": lambda: interpret(kernel(), {"q": [0.0] * 5, "k": [1.0] * len(kernel().arguments[1].elements)}),
}


@pytest.mark.parametrize("use", USES)
def test_an_unknown_statement_is_an_error(use: str) -> None:
    with pytest.raises(AssertionError, match="Unknown"):
        USES[use]()


@pytest.mark.parametrize("code", ReturnCode)
def test_errors_give_the_meaning_of_their_code(code: ReturnCode) -> None:
    assert str(ModelError("f", code)) == f"f returned {int(code)}: {code.meaning}"
    assert ModelError("f", code).code == code


def test_an_unknown_code() -> None:
    assert str(ModelError("f", 7)) == "f returned 7: unknown"
