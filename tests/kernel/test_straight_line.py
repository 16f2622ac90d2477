"""Kernels in straight line as Python functions: the results of the interpreter to the last bit, and its errors."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

import derive
from derive.ir.expressions import Expr, Number, Operation, Operator, ScalarRef
from derive.ir.interpreter import RequirementError, check_requirement
from derive.ir.kernel import Argument, Kernel, Output, Section
from derive.ir.statements import Let, Require, Requirement, ReturnCode, Store
from derive.ir.straight_line import straight_line_function

EXAMPLES = Path(__file__).parents[2] / "examples"


def test_functions_give_the_bits_of_the_interpreter() -> None:
    """All kernels of a mechanism in space have the same results interpreted and as functions of Python."""
    model = derive.lower(derive.derive(derive.read(EXAMPLES / "spatial_crank_slider_beam.toml")))
    random = np.random.default_rng(4)
    compared = 0
    for kernel in model.kernels:
        function = straight_line_function(kernel, lambda value, requirement: None, {})
        assert function is not None
        given = {a.name: 0.3 if a.scalar else random.uniform(0.5, 1.5, a.size).tolist() for a in kernel.arguments}
        expected = derive.interpret(kernel, given, check=False)
        assert function(given) == expected
        compared += sum(map(len, expected.values()))
    assert compared > 500


def test_deep_sums_and_requirements() -> None:
    """Sums deeper than the parentheses that Python reads have a function; a requirement that does not hold ends it."""
    total: Expr = ScalarRef("x")
    for _ in range(299):
        total = Operation(Operator.ADD, (Number(Fraction(1, 3)), total))
    required = Require(Requirement.POSITIVE, ScalarRef("sum"), ReturnCode.NOT_FINITE, "a positive sum")
    body = (Let("sum", total), required, Store("y", 0, ScalarRef("sum")))
    x, y = Argument("x", ("x",), "", scalar=True), Output("y", ("y",), "")
    kernel = Kernel("deep", "", (x,), (y,), (Section("", "", "", body),))
    function = straight_line_function(kernel, check_requirement, {})
    assert function is not None
    assert function({"x": 0.1}) == derive.interpret(kernel, {"x": 0.1})
    with pytest.raises(RequirementError, match="a positive sum"):
        function({"x": -1e3})
