"""Lanes of looped kernels: vectors of gcc and clang, numbers elsewhere, and the same bits in every way."""

from __future__ import annotations

import itertools
import platform
import re
from dataclasses import replace
from fractions import Fraction
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from toolchain import body, run, tool, written

import derive
from derive.backends.c.nests import CNests
from derive.backends.c.source import CBackend
from derive.backends.source_map import source_map
from derive.ir.expansion import expand
from derive.ir.expressions import Element, Expr, Number, Operation, Operator, ScalarRef
from derive.ir.indices import variable
from derive.ir.lanes import in_lanes
from derive.ir.statements import Accumulate, Let, MatrixStore, MatVec, Sum
from derive.runtime.compiler import FLAGS, WITHOUT_BATCHES, vector_flags

MODELS = ("given_3_loops", "given_13_loops")
PLAIN = (*FLAGS, WITHOUT_BATCHES)
WAYS = {
    "numbers": (*PLAIN, "-O1", "-DTISSERAND_NO_VECTORS"),
    "numbers, vectorised": (*PLAIN, "-O3", "-DTISSERAND_NO_VECTORS"),
    "two": PLAIN,
    "widest": (*vector_flags(), WITHOUT_BATCHES),
}
FUNCTIONS = ("mass", "force", "accel", "jacobian")


@cache
def files(model: str) -> tuple[derive.File, ...]:
    """The C in which functions besides those that are called are empty, so that compilers take little time."""
    made = body(model).model
    kernels = (k if k.name in ("setup", *FUNCTIONS) else replace(k, sections=(), constants=()) for k in made.kernels)
    return CBackend().files(replace(made, kernels=tuple(kernels)), "")


@cache
def values(model: str, compiler: str, way: str) -> list[np.ndarray]:
    """The outputs of some functions in one state."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("CC", tool(compiler))
        native = derive.load(files(model), WAYS[way])
    rng = np.random.default_rng(3)
    q, v, ydot = (rng.uniform(-1, 1, n) for n in (native.nq, native.nv, native.nq + native.nv))
    k = native.setup(native.defaults + rng.uniform(0, 0.01, native.np))
    given = {"mass": (q, k), "jacobian": (0.0, np.append(q, v), ydot, 2.3, k)}
    return [getattr(native, name)(*given.get(name, (0.0, q, v, k))) for name in FUNCTIONS]


SOON = {
    ("given_13_loops", "gcc", "two"),
    ("given_13_loops", "gcc", "widest"),
    ("given_13_loops", "clang", "numbers"),
    ("given_13_loops", "clang", "widest"),
    ("given_3_loops", "gcc", "widest"),
    ("given_3_loops", "clang", "two"),
}
"""Each way and each compiler, with blocks and without one; the other combinations have the mark `long`."""
COMBINATIONS = [
    pytest.param(*one, marks=() if one in SOON else pytest.mark.long)
    for one in itertools.product(MODELS, ("gcc", "clang"), WAYS)
]


@pytest.mark.parametrize(("model", "compiler", "way"), COMBINATIONS)
def test_bits_do_not_depend_on_the_width_or_the_compiler(model: str, compiler: str, way: str) -> None:
    for name, one, other in zip(FUNCTIONS, values(model, compiler, way), values(model, "gcc", "numbers"), strict=True):
        assert one.tobytes() == other.tobytes(), name


def products(compiler: str, folder: Path, *flags: str) -> dict[str, int]:
    """The multiplications in the machine code of a looped model without batches, by the width of their registers."""
    (source,) = written(files("given_13_loops"), folder)
    out = folder / "code.s"
    command = (tool(compiler), "-std=c99", "-O1", WITHOUT_BATCHES, *flags, "-S", source, "-o", out)
    run(*command)
    found = re.findall(r"\sv?mulpd\s.*%([xy])mm\d+$", out.read_text(), re.MULTILINE)
    return {width: found.count(width) for width in "xy"}


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_both_compilers_get_vectors_without_looking_for_them(compiler: str, tmp_path: Path) -> None:
    """Each product of a table with a vector is one instruction with AVX and with SSE2."""
    if platform.machine() != "x86_64":
        pytest.skip("the instructions of x86 are counted")
    model = body("given_13_loops").model
    tables = sum(
        len(term.sums) for name in FUNCTIONS for s in model.kernel(name).statements for term in getattr(s, "terms", ())
    )
    assert tables == 9 + 10 + 13 + 21
    assert products(compiler, tmp_path, "-mavx")["y"] >= tables
    if compiler == "gcc":
        assert products(compiler, tmp_path)["x"] >= tables
        assert products(compiler, tmp_path, "-mavx", "-DTISSERAND_NO_VECTORS")["y"] < tables


@pytest.mark.parametrize("name", ["given_3_loops", "given_13_loops", "mean_20_loops"])
def test_the_jacobian_goes_through_the_blocks_of_its_tables_once(name: str) -> None:
    """In a block the products precede the stores of its entries; each line knows the statement that it is a part of."""
    made = body(name)
    function = source_map(made.files, "c").functions["jacobian"]
    products = next(s for s in function.kernel.statements if isinstance(s, MatVec))
    heads = [
        line for line in function.lines if line.text == f"    for (int i = 0; i < {products.packing.padded}; i += 4) {{"
    ]
    columns = [line for line in function.lines if line.stores and isinstance(function.statement(line), MatrixStore)]
    stores = [s for s in function.kernel.statements if isinstance(s, MatrixStore)]
    assert len(stores) == 2
    assert [function.statement(line) for line in heads[:1]] == [products]
    parts = 2 if products.packing.count > 4 and products.packing.count % 4 else 1
    assert [function.statement(line) for line in columns] == [s for s in stores for _ in range(parts)]
    positions = [function.lines.index(line) for line in (heads[0], *columns)]
    end = next(k for k in range(positions[0], len(function.lines)) if function.lines[k].text == "    }")
    assert positions == sorted(positions) and positions[-1] < end


X = Element("x", variable("i"))


def text_of(loop: Accumulate) -> str:
    """The C of sums."""
    return "\n".join(line.text.strip() for line in CNests().lines(in_lanes(expand(loop))))


@pytest.mark.parametrize(
    "term",
    [Operation(Operator.SQRT, (X,)), Element("x", variable("i", 2)), Operation(Operator.MIN, (X, ScalarRef("a")))],
)
def test_what_vectors_do_not_have_is_summed_number_by_number(term: Expr) -> None:
    sums = (Sum("s", Number(Fraction(0)), term),)
    text = text_of(Accumulate(8, (), sums))
    assert "TISSERAND_LOAD" not in text and "double sums_s[4] = {0.0};" in text and "sums_s[i % 4] += " in text


def test_values_in_a_sum_are_vectors_where_they_differ_from_lane_to_lane() -> None:
    product = Operation(Operator.MUL, (ScalarRef("a"), ScalarRef("b")))
    lets = (Let("same", product), Let("own", Operation(Operator.ADD, (X, ScalarRef("same")))))
    sums = (Sum("s", Number(Fraction(0)), Operation(Operator.MUL, (ScalarRef("own"), X))),)
    text = text_of(Accumulate(8, lets, sums))
    assert "const double same = a * b;" in text
    assert "const tisserand_lanes own = TISSERAND_LOAD(x + i + l) + same;" in text
    assert "s_l += own * TISSERAND_LOAD(x + i + l);" in text


def test_sums_of_fewer_terms_than_lanes_are_straight_lines() -> None:
    """Compilers need no array of lanes then; a sum of negative zeros is a positive one, as with lanes."""
    lets = (Let("own", Operation(Operator.ADD, (X, ScalarRef("a")))),)
    sums = (Sum("s", ScalarRef("b"), Operation(Operator.MUL, (ScalarRef("own"), X))),)
    assert text_of(Accumulate(2, lets, sums)).splitlines() == [
        "const double own_0 = x[0] + a;",
        "const double own_1 = x[1] + a;",
        "const double s = b + (0.0 + own_0 * x[0] + own_1 * x[1]);",
    ]
