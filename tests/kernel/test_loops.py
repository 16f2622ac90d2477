"""Loops over the shapes: interpreter, C and Python give the same; their size and cost are what they should be."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
import sympy as sp
from toolchain import tool

import beams
import derive
from conftest import QUICK
from derive.ir.interpreter import RequirementError, interpret
from derive.ir.packing import Packing
from derive.ir.statements import Accumulate, Let, Map, MatrixStore, MatVec, Require, Requirement, Store
from derive.lowering.loops.assignments import NOTHING
from derive.lowering.loops.context import LoopContext
from derive.lowering.loops.gradient import derivative
from derive.mechanics.symbols import Family, I, J, quantity
from derive.runtime.compiled_model import Native
from derive.runtime.compiler import RUN_FLAGS, WITHOUT_BATCHES
from derive.runtime.native_call import ModelError

SIZES = {"given": (1, 4, 5), "mean": (0, 2, 9)}
LATER = (5, "given")
"""A size of which others have what is different: a whole vector and what is left of one."""
CASES = [
    pytest.param(n, frame, marks=pytest.mark.long if (n, frame) == LATER else ())
    for frame, of in SIZES.items()
    for n in of
]
GRAVITY = [1, {"symbol": "gy", "default": 2.0}, "-981/100"]


@cache
def made(n: int, frame: str) -> beams.Made:
    spec = derive.symbolic_body("loops", n, frame=frame, damping=True, gravity=GRAVITY, lowering="loops")
    return beams.build(spec)


@cache
def native(n: int, frame: str) -> Native:
    """Compiled in a moment, without batches; one of them as models are by default, vectorised."""
    if n != 5:
        return derive.load(made(n, frame).files, (*QUICK, WITHOUT_BATCHES))
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("CC", tool("gcc"))  # that of conftest does not optimise without batches
        return derive.load(made(n, frame).files, RUN_FLAGS)


@cache
def module(n: int, frame: str) -> dict[str, Any]:
    return beams.run_module(made(n, frame).files)


def parameters(n: int, frame: str) -> np.ndarray:
    """Parameters of a body with all integrals there may be, near to those that make one."""
    rng = np.random.default_rng(n)
    defaults = np.array(made(n, frame).model.defaults)
    return np.abs(defaults + np.where(defaults == 1, 0.0, 0.05 * rng.normal(size=len(defaults))))


def arguments(n: int, frame: str) -> dict[str, Any]:
    rng = np.random.default_rng(100 + n)
    q, v = rng.uniform(-0.5, 0.5, 7 + n), rng.uniform(-1, 1, 6 + n)
    ydot = rng.uniform(-1, 1, 13 + 2 * n)
    k = native(n, frame).setup(parameters(n, frame))
    return {"t": 0.0, "q": q, "v": v, "y": np.concatenate([q, v]), "ydot": ydot, "cj": 2.3, "k": k}


def outputs(found: Any) -> tuple[np.ndarray, ...]:
    return found if isinstance(found, tuple) else (found,)


@pytest.mark.parametrize(("n", "frame"), CASES)
def test_interpreter_and_c_agree_to_the_last_bit_and_python_nearly(n: int, frame: str) -> None:
    model, given = made(n, frame).model, arguments(n, frame)
    for kernel in model.kernels[1:]:
        expected = interpret(kernel, given)
        call = [given[a.name] for a in kernel.arguments]
        by_c = outputs(getattr(native(n, frame), kernel.name)(*call))
        by_python = outputs(module(n, frame)[kernel.name](*call))
        for output, c, python in zip(kernel.outputs, by_c, by_python, strict=True):
            values = np.array(expected[output.name], dtype=float)
            assert np.array_equal(values, c), kernel.name
            assert np.max(np.abs(values - python)) <= 1e-13 * np.max(np.abs(values)), kernel.name


@pytest.mark.parametrize(("n", "frame"), CASES)
def test_setup_packs_the_same_constants(n: int, frame: str) -> None:
    p = parameters(n, frame)
    expected = np.array(interpret(made(n, frame).model.kernel("setup"), {"p": p})["k"], dtype=float)
    assert np.array_equal(native(n, frame).setup(p), expected)
    assert np.allclose(module(n, frame)["setup"](p), expected, rtol=1e-13, atol=0)
    assert np.array_equal(native(n, frame).defaults, made(n, frame).model.defaults)
    assert np.array_equal(module(n, frame)["DEFAULTS"], made(n, frame).model.defaults)


@pytest.mark.parametrize(("n", "frame"), CASES)
def test_patterns_of_loops_are_those_of_the_model(n: int, frame: str) -> None:
    model = made(n, frame).model
    for kernel, output, found in (("mass", "M", "mass_pattern"), ("jacobian", "jac", "jacobian_pattern")):
        pattern = model.pattern(kernel, output)
        assert getattr(native(n, frame), found).entries == pattern.entries
        assert len(set(pattern.entries)) == len(pattern.entries)
        assert list(pattern.entries) == sorted(pattern.entries, key=lambda e: (e[1], e[0]))  # columns, rows ascending
        python = module(n, frame)[kernel.upper()]
        assert (python.colptr, python.rowidx) == (pattern.colptr, pattern.rowidx)


@pytest.mark.parametrize("frame", ["given", "mean"])
def test_python_takes_batches(frame: str) -> None:
    n = SIZES[frame][-1]
    given, names = arguments(n, frame), module(n, frame)
    for kernel in made(n, frame).model.kernels[1:]:
        call = [given[a.name] for a in kernel.arguments]
        many = [
            np.stack([x, x + 0.0]) if a.name in ("q", "v", "y") else x
            for a, x in zip(kernel.arguments, call, strict=True)
        ]
        single, batch = outputs(names[kernel.name](*call)), outputs(names[kernel.name](*many))
        for one, both in zip(single, batch, strict=True):
            assert both.shape == (2, *one.shape) and np.allclose(both[1], one, rtol=1e-13, atol=1e-15)
    p = np.stack([parameters(n, frame), 2 * parameters(n, frame)])
    assert np.allclose(names["setup"](p)[1], names["setup"](p[1]), rtol=1e-14)


def test_a_mass_matrix_that_is_not_positive_is_refused() -> None:
    p = parameters(5, "given")
    (place,) = (sum(v.size for v in made(5, "given").model.parameters[:k]) for k in (8,))
    assert made(5, "given").model.parameters[8].name == "c8"
    p[place] = -1.0
    with pytest.raises(ModelError) as of_c:
        native(5, "given").setup(p)
    with pytest.raises(RequirementError) as of_interpreter:
        interpret(made(5, "given").model.kernel("setup"), {"p": p})
    assert of_c.value.code == of_interpreter.value.code == 1
    with pytest.raises(ValueError, match="c8 is not positive definite"):
        module(5, "given")["setup"](p)
    p[place] = np.nan
    with pytest.raises(ModelError) as of_nan:
        native(5, "given").setup(p)
    assert of_nan.value.code == 2


@pytest.mark.parametrize(("n", "frame"), [(4, "given"), (2, "mean")])
def test_a_pivot_that_vanishes_is_reported(n: int, frame: str) -> None:
    p = parameters(n, frame)
    names = [v.name for v in made(n, frame).model.parameters]
    sizes = [v.size for v in made(n, frame).model.parameters]
    for name in ("C3", "C4", "C5", "c1", "c2", "c6", "c7"):
        if name in names:
            place = sum(sizes[: names.index(name)])
            p[place : place + sizes[names.index(name)]] = 0.0
    given = arguments(n, frame)
    k = native(n, frame).setup(p)
    with pytest.raises(ModelError) as failed:
        native(n, frame).accel(0.0, given["q"], given["v"], k)
    assert failed.value.code == 1


@pytest.mark.parametrize(("n", "frame"), [(4, "given"), (2, "mean")])
def test_an_acceleration_that_is_not_finite_is_reported(n: int, frame: str) -> None:
    """A shape that no rigid motion sees: its force overflows, and nothing else does."""
    p = np.array(made(n, frame).model.defaults)
    given = arguments(n, frame)
    q = given["q"].copy()
    q[7:] = 0.0
    k = native(n, frame).setup(p)
    assert np.all(np.isfinite(native(n, frame).accel(0.0, q, 0 * given["v"], k)))
    q[-1] = 1e308
    names = [v.name for v in made(n, frame).model.parameters]
    sizes = [v.size for v in made(n, frame).model.parameters]
    p[sum(sizes[: names.index("K")]) + sizes[names.index("K")] - 1] = 100.0
    with pytest.raises(ModelError) as failed:
        native(n, frame).accel(0.0, q, 0 * given["v"], native(n, frame).setup(p))
    assert failed.value.code == 2


@cache
def symbolic(n: int, frame: str) -> derive.Model:
    return derive.lower(derive.derive(derive.symbolic_body("loops", n, frame=frame, lowering="loops")))


@pytest.mark.parametrize(("frame", "h", "m", "jacobian"), [
    pytest.param("given", 20, 18, 68, marks=pytest.mark.long),
    ("mean", 18, 18, 66),
])  # fmt: skip
def test_operations_grow_with_the_square_of_the_shapes(frame: str, h: int, m: int, jacobian: int) -> None:
    """The factors of N^2: 2 for each table, of which h has six of C5, three of c7 and K, and M the first nine."""
    small, large = symbolic(50, frame), symbolic(100, frame)
    for name, factor in (("force", h), ("mass", m), ("jacobian", jacobian)):
        grown = large.kernel(name).operations - small.kernel(name).operations
        linear = small.kernel(name).operations - factor * 50**2
        assert abs(grown - factor * 7_500 - linear) < 0.02 * grown, name
    assert large.kernel("force").operations <= factor_limit(frame)


def factor_limit(frame: str) -> int:
    """Operations of h with 100 modes as they are today; a smaller number is progress and is written here."""
    return {"given": 207_376, "mean": 185_587}[frame]


def test_size_of_the_code_does_not_depend_on_the_shapes() -> None:
    def length(n: int) -> int:
        return sum(len(f.text) for f in beams.build(derive.symbolic_body("loops", n, lowering="loops")).files[:2])

    assert length(60) < 1.05 * length(20)


def test_loops_of_a_kernel_are_few_and_simple() -> None:
    """The code has one contraction, one loop of sums and one loop of rows; no table is read twice."""
    kernel = symbolic(8, "mean").kernel("force")
    loops = [s for s in kernel.statements if not isinstance(s, Let | Store | Require)]
    assert [type(loop) for loop in loops] == [MatVec, Accumulate, Map]
    (contract,) = (loop for loop in loops if isinstance(loop, MatVec))
    tables = [product.table for term in contract.terms for product in term.sums]
    assert len(tables) == len(set(tables)) == 9
    pairs = [s for s in symbolic(8, "mean").kernel("jacobian").statements if isinstance(s, MatrixStore)]
    assert len(pairs) == 2  # by alpha, by alphadot


@pytest.mark.parametrize("frame", ["given", "mean"])
def test_matrices_of_the_jacobian_are_stored_with_the_products(frame: str) -> None:
    """Their factors depend on no sum, so that they are known before the tables are read."""
    (section,) = (s for s in symbolic(8, frame).kernel("jacobian").sections if s.name == "tables")
    assert [type(item) for item in section.body] == [MatVec, MatrixStore, MatrixStore]


def test_a_matrix_with_a_factor_that_is_a_sum_is_stored_at_the_end() -> None:
    context = LoopContext(derive.derive(derive.symbolic_body("loops", 8, frame="given", lowering="loops")))
    inertia = next(s for s in context.gradient.mode_sums if str(s) == "J_11")
    packing, entry = context.layout.packing, quantity(Family.STIFFNESS, shapes=(I, J))
    program = context.program(context.q)
    target = MatrixStore(packing, "out", 0, 8, NOTHING, None)
    program.phase("test", "", "a product", pairs=[(target, inertia * entry, sp.S.Zero), (target, 2 * entry, sp.S.Zero)])
    order = [(s.name, [type(item) for item in s.body if not isinstance(item, Let)]) for s in program.sections]
    assert order == [("tables", [MatVec, MatrixStore]), ("sums", [Accumulate]), ("test_i", [MatrixStore])]


def test_derivatives_of_polynomials_are_those_of_sympy() -> None:
    x, y, z = sp.symbols("x y z")
    for expr in (3 * x**3 * y * (x - y * x**2) ** 2 - x / y + 5, y + sp.Rational(1, 2), x * sp.sin(x * y), sp.S(2)):
        for symbol in (x, y, z):
            assert sp.expand(derivative(expr, symbol) - expr.diff(symbol)) == 0


JACOBIAN_OPERATIONS = {"given": 1316, "mean": 709}
"""Operations of the iteration matrix with 2 modes as they are today; a smaller number is progress."""


@pytest.mark.parametrize("frame", JACOBIAN_OPERATIONS)
def test_columns_of_the_attitude_share_their_factors(frame: str) -> None:
    """Written out in products of the state that of a given frame takes 1633."""
    assert symbolic(2, frame).kernel("jacobian").operations == JACOBIAN_OPERATIONS[frame]


@pytest.mark.parametrize("n", [1, 4, 5, 9])
def test_packing_puts_each_entry_in_a_place_of_its_own(n: int) -> None:
    packing = Packing("tables", n, (("a", "b"), ("c",)))
    places = {packing.entry(t).at({"i": i, "j": j}) for t in packing.tables for i in range(n) for j in range(n)}
    assert len(places) == 3 * n * n and max(places) < packing.size


def test_tables_of_a_function_are_read_once_and_in_order() -> None:
    """M reads C5 and c7 as they lie in memory, without a gap; h reads K in addition, which lies behind them."""
    for name, groups in (("mass", 1), ("force", 2)):
        (loop,) = (s for s in symbolic(8, "given").kernel(name).statements if isinstance(s, MatVec))
        packing = loop.packing
        read = {product.table for term in loop.terms for product in term.sums}
        tables = [table for table in packing.tables if table in read]
        assert tuple(tables) == sum(packing.groups[:groups], ())
        cells = ((i, j, t) for group in packing.groups[:groups] for i in (0, 4) for j in range(8) for t in group)
        assert [packing.entry(t).at({"i": i, "j": j}) for i, j, t in cells] == list(range(0, len(tables) * 64, 4))


def test_translations_without_force_and_coupling_are_no_part_of_the_system() -> None:
    """In the mean frame three pivots are left, and one more for each direction of gravity."""
    for gravity, pivots in ((None, 3), ([0, 0, 1], 4), ([1, 1, 1], 6)):
        spec = derive.symbolic_body("loops", 8, frame="mean", gravity=gravity, lowering="loops")
        kernel = derive.lower(derive.derive(spec)).kernel("accel")
        checks = [s for s in kernel.statements if isinstance(s, Require) and s.kind is Requirement.POSITIVE]
        assert len([s for s in checks if "pivot" in s.text]) == pivots


@pytest.mark.parametrize("n", [2, pytest.param(1, marks=pytest.mark.long)])
def test_coordinates_have_the_names_of_straight_lines(n: int) -> None:
    flat = derive.load(beams.build(derive.symbolic_body("lines", n, lowering="flat")).files, QUICK)
    loops = derive.load(beams.build(derive.symbolic_body("loops", n, lowering="loops")).files, QUICK)
    assert loops.coordinates == flat.coordinates
