"""Derivatives by elimination of vertices beside those of CasADi."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
import sympy as sp

import derive
from conftest import ROOT
from derive.ir.expressions import Number, ScalarRef
from derive.lowering.flat.casadi_symbols import Symbols
from derive.lowering.flat.context import Context
from derive.lowering.flat.dae import jacobian, residual_rows, states
from derive.lowering.flat.vertex_elimination import Matrix, by_elimination, fewest_operations
from derive.lowering.model_functions import FORMS, functions_of

LIMIT = 1e-13
OPERATIONS = {"": 1957, "ggl": 3783, "index1": 3630}
"""Operations of the iteration matrices; without the frames of joints and this elimination 2456, 3887 and 4716."""


def differences(symbols: Symbols, rows: list[ca.SX], y: list[ca.SX], rates: list[ca.SX]) -> Matrix:
    """Compare the derivatives in a random state with those of CasADi; returns those of the elimination."""
    column, *of = (ca.vertcat(*x) for x in (rows, y, rates[:-1]))
    expected = ca.jacobian(column, of[0]) + rates[-1] * ca.jacobian(column, of[1])
    result = by_elimination(symbols, rows, y, rates)
    assert set(result) <= set(zip(*expected.sparsity().get_triplet(), strict=True))
    dense = ca.SX(*expected.shape)
    for (i, j), value in result.items():
        dense[i, j] = value
    function = ca.Function("both", [ca.vertcat(*symbols.inputs)], [ca.densify(dense), ca.densify(expected)])
    random = np.random.default_rng(1).uniform(0.3, 1.2, len(symbols.inputs))
    numbers = [float(s.value) if isinstance(s, Number) else x for s, x in zip(symbols.leaves, random, strict=True)]
    found, known = (x.full() for x in function(numbers))
    sizes = abs(known) + abs(known).max(axis=1, keepdims=True)
    assert np.all(abs(found - known) <= LIMIT * sizes)
    assert np.count_nonzero(known) > len(rows)
    return result


@pytest.fixture(scope="module")
def crank() -> Context:
    spec = derive.read(ROOT / "examples" / "spatial_crank_slider.toml")
    return Context(derive.derive(spec).expanded())


@pytest.mark.parametrize("form", FORMS)
def test_iteration_matrices(form: str, crank: Context) -> None:
    y, ydot = states(crank, form)
    symbols = crank.symbols(crank.t, y, ydot, crank.cj)
    rows = residual_rows(crank, form, symbols)
    differences(symbols, rows, symbols.values_of(y.symbols), symbols.values_of((*ydot.symbols, *crank.cj.symbols)))


@pytest.mark.parametrize("form", FORMS)
def test_operations(form: str, crank: Context) -> None:
    """A smaller number is progress."""
    function = next(f for f in functions_of(crank.equations) if f.name == "_".join(filter(None, ("jacobian", form))))
    assert jacobian(crank, function).operations == OPERATIONS[form]


def variables(*names: str) -> tuple[Symbols, list[ca.SX]]:
    """Symbols with some variables, and their values."""
    symbols = Symbols(frozenset(), frozenset())
    every = sp.symbols(names)
    for symbol in every:
        symbols.input(symbol, ScalarRef(symbol.name))
    return symbols, symbols.values_of(every)


def test_all_operations() -> None:
    symbols, (a, b, a_t, b_t, cj, c) = variables("a", "b", "a_t", "b_t", "cj", "c")
    rows = [
        ca.sin(a) * ca.cos(b) / ca.sqrt(a + c) - 1 / b,
        ca.exp(a_t) * ca.log(b_t + 1) + ca.tanh(a * a_t) + a * a + b + b,
        ca.atan2(a, b) + ca.fmin(a, b_t) * ca.fmax(b, c) - ca.sign(a) * b,
        ca.if_else(a < b, a * b, c * b_t) - (-a) - a * c,
        c * c + a - a + b,
    ]
    result = differences(symbols, rows, [a, b], [a_t, b_t, cj])
    assert (4, 0) not in result or result[4, 0].is_zero()


def test_the_shorter_form_is_taken() -> None:
    symbols, (a, b) = variables("a", "b")
    long, short = [a * b + b * b, a * a], [(a + b) * b, a * a]
    assert fewest_operations(symbols, [long, short]) is short
    assert fewest_operations(symbols, [short, long]) is short
    assert fewest_operations(symbols, [short, list(short)]) is short
