"""(33) and (41) against what the tool derives, lowers and emits: the proof that the chain is the paper's."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import sympy as sp

import beams
from derive.ir.interpreter import interpret
from paper.printed import EQUATION_33, EQUATION_41, MEAN_SHAPES, POINT_SHAPES, PrintedTerm, row_sum
from plain_symbols import plain

ROWS = ("c1", "c2", "phi", "alpha1", "alpha2")
PRINTED = {"point": EQUATION_33, "mean": EQUATION_41}
PLAIN = {sp.Symbol(name, positive=True): sp.Symbol(name) for name in ("m", "l", "EI")}
ACCELERATIONS = sp.symbols("c1ddot c2ddot phiddot alpha1ddot alpha2ddot")
RATES = sp.symbols("c1dot c2dot phidot alpha1dot alpha2dot")
COORDINATES = sp.symbols("c1 c2 phi alpha1 alpha2")
PARAMETERS = sp.symbols("m l EI", positive=True)


def derived_rows(frame: str) -> dict[str, sp.Expr]:
    equations = beams.made(frame).equations
    return {row: plain(equations.row(row)) for row in ROWS}


def rows_of(mass: Any, force: Any, entries: tuple[tuple[int, int], ...]) -> dict[str, sp.Expr]:
    """M vdot + h from the values of the lower triangle."""
    rows = [sp.S.Zero + h for h in force]
    for (i, j), value in zip(entries, mass, strict=True):
        rows[i] += value * ACCELERATIONS[j]
        if i != j:
            rows[j] += value * ACCELERATIONS[i]
    return {row: sp.sympify(expr).xreplace(PLAIN) for row, expr in zip(ROWS, rows, strict=True)}


def kernel_rows(frame: str) -> dict[str, sp.Expr]:
    """The kernels, run on symbols."""
    model = beams.made(frame).model
    options: dict[str, Any] = {
        "number": lambda x: sp.Rational(x.numerator, x.denominator),
        "functions": {"sin": sp.sin, "cos": sp.cos},
        "check": False,
    }
    k = interpret(model.kernel("setup"), {"p": PARAMETERS}, **options)["k"]
    state = {"t": sp.S.Zero, "q": COORDINATES, "v": RATES, "k": k}
    both = interpret(model.kernel("mass_force"), state, **options)
    mass = interpret(model.kernel("mass"), state, **options)["M"]
    force = interpret(model.kernel("force"), state, **options)["h"]
    assert (mass, force) == (both["M"], both["h"])
    return rows_of(mass, force, model.pattern("mass", "M").entries)


class Symbols:
    """An array of symbols with the few functions of the array-API standard that the generated Python calls."""

    def __init__(self, values: Any) -> None:
        self.values = list(values)
        self.shape = (len(self.values),)

    def __array_namespace__(self) -> type[Symbols]:
        return Symbols

    def __getitem__(self, index: Any) -> sp.Expr:
        return self.values[index[-1]]

    sin, cos = staticmethod(sp.sin), staticmethod(sp.cos)
    float64 = float
    isfinite = staticmethod(lambda x: True)
    all = staticmethod(bool)
    dtype = None
    isdtype = staticmethod(lambda dtype, kind: False)
    result_type = staticmethod(lambda *dtypes: None)
    full = staticmethod(lambda shape, value, dtype: sp.Integer(int(value)))
    broadcast_to = staticmethod(lambda value, shape: value)
    stack = staticmethod(lambda arrays, axis: Symbols(arrays))

    @staticmethod
    def asarray(value: Any, dtype: Any) -> Any:
        return np.asarray(value, dtype)


def python_rows(frame: str) -> dict[str, sp.Expr]:
    """The generated Python, run on symbols."""
    module = beams.module(frame)
    k = module["setup"](Symbols(PARAMETERS))
    q, v = Symbols(COORDINATES), Symbols(RATES)
    mass, force = module["mass"](q, k), module["force"](0.0, q, v, k)
    return rows_of(mass.values, force.values, beams.made(frame).model.pattern("mass", "M").entries)


SOURCES = {"derived": derived_rows, "kernel": kernel_rows, "python": python_rows}


def differing(printed: tuple[PrintedTerm, ...], rows: dict[str, sp.Expr]) -> set[str]:
    """The rows in which the printed equation is not the given one."""
    return {row for row in ROWS if sp.expand(row_sum(printed, row) - rows[row]) != 0}


@pytest.mark.parametrize("frame", PRINTED)
@pytest.mark.parametrize("source", SOURCES)
def test_equations_are_the_printed_ones(frame: str, source: str) -> None:
    assert differing(PRINTED[frame], SOURCES[source](frame)) == set()


@pytest.mark.parametrize(("frame", "index"), [(f, i) for f, terms in PRINTED.items() for i in range(len(terms))])
@pytest.mark.parametrize("sign", [0, -1])
def test_a_changed_term_is_noticed(frame: str, index: int, sign: int) -> None:
    terms = list(PRINTED[frame])
    term = terms[index]
    terms[index] = PrintedTerm(term.row, sign * term.expr)
    assert differing(tuple(terms), derived_rows(frame)) == {term.row}


@pytest.mark.parametrize(("frame", "printed"), [("point", POINT_SHAPES), ("mean", MEAN_SHAPES)])
def test_shapes_are_the_printed_ones(frame: str, printed: tuple[sp.Expr, ...]) -> None:
    from derive.mechanics.bodies.reference_conditions import assumed_shapes

    spec = beams.beam(frame)
    xi = sp.Symbol("xi")
    shapes = assumed_shapes(spec.deflection)
    for shape, expected in zip(shapes, printed, strict=True):
        found = sum(sp.Rational(c) * xi**n for n, c in enumerate(shape.coefficients))
        assert sp.expand(found - expected) == 0


@pytest.mark.parametrize("frame", PRINTED)
def test_compiled_c_is_the_printed_equation(frame: str) -> None:
    """1000 random states; an error is measured against the sum of the magnitudes of the printed terms."""
    native = beams.native(frame)
    symbols = (*COORDINATES, *RATES, *ACCELERATIONS, *sp.symbols("m l EI"))
    terms = [sp.lambdify(symbols, [t.expr for t in PRINTED[frame] if t.row == row], "numpy", cse=True) for row in ROWS]
    rng = np.random.default_rng(33)
    worst = 0.0
    for _ in range(1000):
        q, v, a = rng.uniform(-3, 3, (3, 5))
        p = rng.uniform(0.2, 5, 3)
        values, h = native.mass_force(0.0, q, v, native.setup(p))
        found = _dense(native.mass_pattern, values) @ a + h
        for row in range(5):
            parts = np.array(terms[row](*q, *v, *a, *p))
            worst = max(worst, abs(found[row] - parts.sum()) / np.abs(parts).sum())
    assert worst < 1e-14


def _dense(pattern: Any, values: np.ndarray) -> np.ndarray:
    matrix = np.zeros((pattern.rows, pattern.cols))
    for (i, j), value in zip(pattern.entries, values, strict=True):
        matrix[i, j] = matrix[j, i] = value
    return matrix
