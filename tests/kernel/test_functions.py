"""The table of the functions of a model: both lowerings have an implementation of each, and the code has them all."""

from __future__ import annotations

import pytest

import derive
from conftest import ROOT
from derive.lowering.flat.lower import OF_BODIES, OF_MECHANISMS
from derive.lowering.loops.body_functions import IMPLEMENTATIONS
from derive.lowering.model_functions import FunctionKind, functions_of
from derive.lowering.requested_functions import JACOBIANS


def test_both_lowerings_implement_every_function() -> None:
    assert set(OF_BODIES) | set(OF_MECHANISMS) == set(FunctionKind)
    without = {FunctionKind.PARAMETER_JACOBIAN, FunctionKind.SOLVE_KKT, *JACOBIANS, *JACOBIANS.values()}
    loops = set(OF_BODIES) - without  # which loops do not have
    assert set(IMPLEMENTATIONS) == loops


@pytest.mark.parametrize("name", ["free_beam_mean", "body_symbolic", "crank_slider_3"])
def test_a_model_has_the_functions_of_the_table(name: str) -> None:
    derived = derive.derive(derive.read(ROOT / "scenes" / f"{name}.toml"))
    equations = derived.expanded() if name == "crank_slider_3" else derived
    model, table = derive.lower(derived), functions_of(equations)
    assert [kernel.name for kernel in model.kernels] == ["setup", *(function.name for function in table)]
    for kernel, function in zip(model.kernels[1:], table, strict=True):
        assert kernel.doc.startswith(function.doc)
        assert [a.name for a in kernel.arguments] == list(function.arguments)
        assert {o.name: o.doc for o in kernel.outputs} == dict(function.outputs)


def test_both_lowerings_describe_their_functions_alike() -> None:
    specs = (derive.symbolic_body("body", 3, frame="given", lowering=lowering) for lowering in ("flat", "loops"))
    flat, loops = (derive.lower(derive.derive(spec)) for spec in specs)
    assert flat.lowering != loops.lowering
    for one, other in zip(flat.kernels[1:], loops.kernels[1:], strict=True):
        assert one.name == other.name and [o.doc for o in one.outputs] == [o.doc for o in other.outputs]
        assert one.doc.partition(", by ")[0] == other.doc.partition(", by ")[0]
