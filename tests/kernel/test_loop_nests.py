"""Plain statements: lanes and batches leave every bit as it is, which the interpreter shows by running both."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache
from typing import Any

import numpy as np
import pytest

import beams
import derive
from conftest import ROOT
from derive.ir.analysis import operations
from derive.ir.expansion import expand
from derive.ir.expressions import Element, Expr, Operation, Operator, ScalarRef
from derive.ir.indices import ElementIndex, IndexTerm, Of, constant, triangle, variable
from derive.ir.interpreter import RequirementError, interpret, interpret_batch
from derive.ir.kernel import Argument, Kernel, Output, Section, View
from derive.ir.lanes import in_lanes, section_in_lanes
from derive.ir.loop_nests import For, If, LoopKind, Node, PartOf, every
from derive.ir.model import Model
from derive.ir.statements import (
    Accumulate,
    Cholesky,
    Let,
    MatrixStore,
    MatVec,
    ReturnCode,
    Store,
    Sum,
    TriangularSolve,
)

GRAVITY = [1, {"symbol": "gy", "default": 2.0}, "-981/100"]
BODIES = [(n, frame) for n in (0, 1, 3, 4, 6, 9) for frame in ("given", "mean")]
SOON = {(3, "given"), (4, "given"), (9, "given"), (0, "mean"), (1, "mean"), (6, "mean")}
"""Each number of modes in one frame; in the other one the tests have the mark `long`."""


@cache
def looped(n: int, frame: str) -> Model:
    spec = derive.symbolic_body("loops", n, frame=frame, damping=True, gravity=GRAVITY, lowering="loops")
    return derive.lower(derive.derive(spec))


def arguments(model: Model, kernel: Kernel, seed: int = 0) -> dict[str, Any]:
    """A state near the undeformed one, with the constants of parameters of which none vanishes."""
    rng = np.random.default_rng(seed)
    given: dict[str, Any] = {a.name: rng.uniform(-0.4, 0.6, a.size).tolist() for a in kernel.arguments}
    given |= {a.name: 0.5 for a in kernel.arguments if a.scalar}
    p = parameters(model)
    return given | ({"p": p} if kernel.name == "setup" else {"k": constants(model, tuple(p))})


def parameters(model: Model) -> list[float]:
    noise = np.random.default_rng(1).uniform(0.0, 0.05, len(model.defaults))
    return (np.array(model.defaults) + noise).tolist()


@cache
def constants(model: Model, p: tuple[float, ...]) -> list[float]:
    return interpret(model.kernel("setup"), {"p": p})["k"]


def nodes_in_lanes(kernel: Kernel) -> Iterator[Node]:
    return (node for section in kernel.sections for _, part in section_in_lanes(section.body) for node in part)


@pytest.mark.parametrize(
    ("n", "frame"), [pytest.param(*one, marks=() if one in SOON else pytest.mark.long) for one in BODIES]
)
def test_loops_in_lanes_keep_the_bits(n: int, frame: str) -> None:
    """Sums, rows and fused matrices, also where modes fill no block of four."""
    model = looped(n, frame)
    for kernel in model.kernels:
        given = arguments(model, kernel)
        assert interpret(kernel, given, nodes=nodes_in_lanes(kernel)) == interpret(kernel, given), kernel.name


def test_lanes_are_really_used() -> None:
    """The products of nine modes run in three blocks, and the matrices of the iteration matrix are stored in them."""
    kernel = looped(9, "given").kernel("jacobian")
    loops = [node for node in every(nodes_in_lanes(kernel)) if isinstance(node, For)]
    assert {LoopKind.LANES, LoopKind.ORDERED} == {loop.kind for loop in loops}
    (products,) = (loop for loop in loops if any(isinstance(node, PartOf) for node in loop.body))
    assert products.count == 3
    stores = [node for node in every(products.body) if isinstance(node, PartOf)]
    assert [type(node) for store in stores for node in store.body] == [If, If]


MODELS: dict[str, Callable[[], Model]] = {
    **{f"{frame} {n}": lambda n=n, frame=frame: looped(n, frame) for n, frame in BODIES},  # type: ignore[misc]
    "beam": lambda: beams.made("point", 2).model,
    "mechanism": lambda: beams.build(derive.read(ROOT / "scenes" / "double_pendulum.toml")).model,
}


OF_BODIES = {f"{frame} {n}" for n, frame in {*BODIES} - SOON}


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.long if name in OF_BODIES else ()) for name in MODELS]
)
def test_batches_keep_the_bits_of_each_state(name: str) -> None:
    """Sines keep their bits, too; they are computed for all states before the lines that need them."""
    model, states = MODELS[name](), 3
    for kernel in (model.kernel(k) for k in ("mass", "force", "mass_force", "accel", "energy", "momentum", "rates")):
        shared = arguments(model, kernel)
        given = [shared | {a: v for a, v in arguments(model, kernel, b).items() if a in "qv"} for b in range(states)]
        rows = {a: [list(row) for row in zip(*(g[a] for g in given), strict=True)] for a in "qv" if a in shared}
        outputs, codes = interpret_batch(kernel, shared | rows, states)
        for b, single in enumerate(given):
            assert {o: [row[b] for row in values] for o, values in outputs.items()} == interpret(kernel, single)
        assert codes == [0] * states


def test_a_batch_knows_the_code_of_each_state() -> None:
    model = looped(3, "given")
    kernel, states = model.kernel("accel"), 3
    shared = arguments(model, kernel)
    rows = {a: [[value] * states for value in shared[a]] for a in "qv"}
    for k in range(3, 7):  # the quaternion of one state
        rows["q"][k] = [rows["q"][k][0], 0.0, rows["q"][k][2]]
    with pytest.raises(RequirementError) as error:
        interpret(kernel, shared | {a: [row[1] for row in rows[a]] for a in "qv"})
    _, codes = interpret_batch(kernel, shared | rows, states)
    assert codes == [0, error.value.code, 0] and error.value.code


# ---- indices ----


IN_BLOCKS = ElementIndex(5, (IndexTerm(8, "i", Of.BLOCK), IndexTerm(1, "i", Of.LANE)))


@pytest.mark.parametrize("index", [variable("i", 3, 2), IN_BLOCKS])
def test_a_variable_is_a_multiple_of_four_and_a_lane(index: ElementIndex) -> None:
    split = index.split("i", "l")
    assert [split.at({"i": i - i % 4, "l": i % 4}) for i in range(13)] == [index.at({"i": i}) for i in range(13)]
    assert index.scaled(3, 1).at({"i": 7}) == 3 * index.at({"i": 7}) + 1
    assert index.with_value("i", 7) == constant(index.at({"i": 7}))


@pytest.mark.parametrize("parity", [1, -1])
def test_pairs_lie_in_a_triangle_row_by_row(parity: int) -> None:
    pairs = [(i, j) for i in range(6) for j in range(i if parity > 0 else i + 1, 6)]
    index = triangle(6, parity, "i", "j")
    assert [index.at({"i": i, "j": j}) for i, j in pairs] == list(range(len(pairs)))


# ---- what statements mean and cost ----

X = Element("x", variable("i"))


def test_a_sum_adds_four_lanes() -> None:
    """Numbers of which the order of additions can be seen."""
    x = [1e16, 1.0, -1e16, 1.0, 3.0, 1e-3, 7.0, 0.1, 0.2]
    lanes = [sum(x[lane::4], start=0.0) for lane in range(4)]
    expected = 2.0 + ((lanes[0] + lanes[1]) + (lanes[2] + lanes[3]))
    loop = Accumulate(9, (), (Sum("s", ScalarRef("b"), X),))
    assert value_of(loop, x) == expected != 2.0 + sum(x)


def value_of(loop: Accumulate, x: list[float]) -> float:
    inputs = (Argument("x_", (), "", arrays=(View("x", 0, len(x)),)), Argument("b", (), "", scalar=True))
    body = (loop, Store("y", 0, ScalarRef("s")))
    kernel = Kernel("test", "", inputs, (Output("y", ("y",), ""),), (Section("", "", "", body),))
    results = [interpret(kernel, {"x_": x, "b": 2.0}, nodes=nodes) for nodes in (None, tuple(nodes_in_lanes(kernel)))]
    assert results[0] == results[1]
    return float(results[0]["y"][0])


def test_operations_are_those_of_the_loops() -> None:
    """Exactly; the additions of four lanes are among those to the lanes."""
    square: Expr = Operation(Operator.MUL, (X, X))
    assert operations(Accumulate(7, (Let("a", square),), (Sum("s", ScalarRef("b"), ScalarRef("a")),))) == 7 * 2 + 1
    n = 5
    assert operations(TriangularSolve("low", n, ("x", "y"), False)) == 2 * n**2
    assert operations(TriangularSolve("low", n, ("x", "y"), True)) == 2 * n**2
    cholesky = Cholesky("k", 0, "c", n, ReturnCode.PIVOT, "")
    assert operations(cholesky) == (n**3 - n) // 3 + n * (n - 1) // 2 + 2 * n


def test_only_independent_loops_run_in_lanes() -> None:
    for statement in (Cholesky("k", 0, "c", 8, ReturnCode.PIVOT, ""), TriangularSolve("low", 8, ("x",), True)):
        assert in_lanes(expand(statement)) == expand(statement)
    for kernel in looped(9, "given").kernels:
        for statement in (s for s in kernel.statements if isinstance(s, MatVec | MatrixStore)):
            assert in_lanes(expand(statement)) != expand(statement)
