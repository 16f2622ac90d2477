"""Batches give the bits of single calls for each state, whatever their number, and keep within their arrays."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from toolchain import C99, run, tool, written

import beams
import derive
from derive.backends.c import batch as c_batch
from derive.backends.c.batch_block import StateBlock
from derive.backends.c.source import CBackend
from derive.ir.kernel import Kernel
from derive.runtime.compiled_model import Native
from derive.runtime.compiler import FLAGS, vector_flags
from derive.runtime.native_call import ModelError
from derive.spec.parsing.values import MAX_MODES

COUNTS = range(68)
KERNELS = {
    "mass": ("q",),
    "force": ("t", "q", "v"),
    "mass_force": ("t", "q", "v"),
    "accel": ("t", "q", "v"),
    "energy": ("q", "v"),
    "momentum": ("q", "v"),
    "rates": ("q", "v"),
}
"""The functions that have batches, with their arguments before the constants."""
VECTORS = ("-std=c99", "-O1", "-ftree-vectorize", "-ffp-contract=off")
"""Compiles in half the time of -O2."""

BEAMS = [("mean", 2), ("point", 2), ("point", 8)]
BODIES = [*((n, "given", "loops") for n in (0, 1, 5)), (5, "mean", "loops"), (2, "mean", "flat")]
MODELS: dict[str, Callable[[], tuple[derive.File, ...]]] = {
    **{f"{frame}_{n}": lambda frame=frame, n=n: beams.made(frame, n).files for frame, n in BEAMS},
    **{f"{frame}_{n}_{way}": lambda n=n, frame=frame, way=way: body(n, frame, way) for n, frame, way in BODIES},
}
LATER = ("point_8", "given_0_loops", "given_1_loops")
"""Many shapes, none and a single one, for tests with the mark `long`."""
EVERY_MODEL = pytest.mark.parametrize(
    "model", [pytest.param(name, marks=pytest.mark.long if name in LATER else ()) for name in MODELS]
)


def body(n: int, frame: str, lowering: str) -> tuple[derive.File, ...]:
    return beams.build(derive.symbolic_body(f"{lowering}_{frame}_{n}", n, frame=frame, lowering=lowering)).files


@cache
def compiled_models() -> dict[str, Future[Native]]:
    """All but those of LATER: one is compiled while the next is derived."""
    pool = ThreadPoolExecutor(2)
    return {name: pool.submit(derive.load, make(), VECTORS) for name, make in MODELS.items() if name not in LATER}


@cache
def native(model: str) -> Native:
    return derive.load(MODELS[model](), VECTORS) if model in LATER else compiled_models()[model].result()


def constants(model: Native) -> np.ndarray:
    """No integral is zero by chance."""
    rng = np.random.default_rng(1)
    return model.setup(model.defaults + rng.uniform(0.0, 0.01, model.np))


def states(model: Native, count: int) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(count)
    return rng.uniform(-1, 1, (count, model.nq)), rng.uniform(-1, 1, (count, model.nv))


def one_by_one(model: Native, name: str, q: np.ndarray, v: np.ndarray, k: np.ndarray) -> list[np.ndarray | int]:
    """Values of each state, those of all outputs after each other, or the code of one that fails."""
    found: list[np.ndarray | int] = []
    for state in zip(q, v, strict=True):
        given = dict(zip(("q", "v"), state, strict=True)) | {"t": 0.5}
        try:
            values = getattr(model, name)(*(given[argument] for argument in KERNELS[name]), k)
            found.append(np.concatenate(values) if isinstance(values, tuple) else values)
        except ModelError as error:
            found.append(error.code)
    return found


def together(model: Native, name: str, q: np.ndarray, v: np.ndarray, k: np.ndarray) -> np.ndarray:
    """The results for all states in one call of the batch function."""
    given = {"q": q, "v": v, "t": 0.5}
    arguments = [given[argument] for argument in KERNELS[name]]
    values = getattr(model, f"{name}_batch")(*arguments, k, check=False)
    return np.hstack(values) if isinstance(values, tuple) else values


def same(batch: np.ndarray, single: list[np.ndarray | int]) -> None:
    """Bit for bit; NaN where a state fails."""
    assert len(batch) == len(single)
    for row, values in zip(batch, single, strict=True):
        if isinstance(values, int):
            assert np.isnan(row).all()
        else:
            assert row.tobytes() == values.tobytes()


@EVERY_MODEL
@pytest.mark.parametrize("name", KERNELS)
def test_bits_are_those_of_single_calls(model: str, name: str) -> None:
    """This holds for any number of states, and for each at any place: they are rotated from count to count."""
    compiled = native(model)
    k, (q, v) = constants(compiled), states(compiled, max(COUNTS))
    single = one_by_one(compiled, name, q, v, k)
    good = [values for values in single if not isinstance(values, int)]
    assert len(good) >= len(single) / 2 and not any((values == 0).all() for values in good)
    for count in COUNTS:
        chosen = (np.arange(count) + count) % len(q)
        same(together(compiled, name, q[chosen], v[chosen], k), [single[i] for i in chosen])


FEATURES = {"avx2": {"avx2"}, "avx512": {"avx2", "avx512f", "avx512dq", "avx512vl"}}


@pytest.mark.parametrize(
    ("model", "features"),
    [
        ("point_2", "avx2"),
        ("mean_2_flat", "avx512"),
        pytest.param("point_2", "avx512", marks=pytest.mark.long),
        pytest.param("mean_2_flat", "avx2", marks=pytest.mark.long),
    ],
)
def test_bits_do_not_depend_on_the_vectors_of_the_processor(model: str, features: str) -> None:
    if vector_flags(FEATURES[features]) not in (vector_flags(), vector_flags(FEATURES["avx2"])):
        pytest.skip(f"this processor has no {features}")
    if vector_flags() == FLAGS:
        pytest.skip("this processor has no vectors that are known here")
    compiled, other = native(model), derive.load(MODELS[model](), vector_flags(FEATURES[features]))
    k, (q, v) = constants(compiled), states(compiled, 67)
    for name in KERNELS:
        same(together(other, name, q, v, k), one_by_one(compiled, name, q, v, k))
        same(together(compiled, name, q, v, k), one_by_one(other, name, q, v, k))


def test_vectors_of_a_processor() -> None:
    avx2, avx512 = (vector_flags(features) for features in FEATURES.values())
    assert "-mavx2" in avx2 and "-mavx512f" in avx512
    assert vector_flags({"avx2", "avx512f"}) == avx2  # the other parts are missing
    assert vector_flags({"sse2"}) == FLAGS
    for flags in (avx2, avx512):
        assert {*FLAGS, "-fno-tree-slp-vectorize"} <= {*flags} and not any("march" in flag for flag in flags)


ANGLES = (0.0, -0.0, 1e5, 1.03e5, -1e5, -3e5, 1e22, -1e300, 5e-324)


@pytest.mark.parametrize("angle", [*ANGLES, np.inf, -np.inf, np.nan])
@pytest.mark.parametrize("name", ["mass", "mass_force", "accel"])
def test_bits_of_a_state_whose_angle_is_left_to_the_c_library(angle: float, name: str) -> None:
    """Wherever it is: in a full block, and among the states that fill none; the others keep their bits."""
    compiled = native("point_2")
    k, (q, v) = constants(compiled), states(compiled, 13)
    for place in range(13):
        changed = q.copy()
        changed[place, 2] = angle
        single = one_by_one(compiled, name, changed, v, k)
        if np.isfinite(angle):
            same(together(compiled, name, changed, v, k), single)
        else:  # which NaN it is, compilers decide
            rows = [np.full(3, np.nan) if isinstance(values, int) else values for values in single]
            result = together(compiled, name, changed, v, k)
            for b, (row, values) in enumerate(zip(result, rows, strict=True)):
                if b == place:
                    assert np.isnan(row).any() and (name == "accel" or np.array_equal(row, values, equal_nan=True))
                else:
                    assert row.tobytes() == values.tobytes()


@pytest.mark.long
def test_narrow_blocks_have_the_same_bits(monkeypatch: pytest.MonkeyPatch) -> None:
    """Models with many shapes have them, for the sake of the stack."""
    monkeypatch.setattr(c_batch, "WIDTHS", {4: None})
    compiled = derive.load(body(1, "given", "loops"), VECTORS)
    k, (q, v) = constants(compiled), states(compiled, 37)
    for name in KERNELS:
        same(together(compiled, name, q, v, k), one_by_one(compiled, name, q, v, k))


def test_kernels_of_many_lines_are_compiled_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """States that fill no block are then copied to the function of single states."""
    monkeypatch.setattr(c_batch, "SHORT", 0)
    compiled = derive.load(beams.made("point", 2).files, VECTORS)
    k, (q, v) = constants(compiled), states(compiled, 29)
    v[[3, 26], 2] = 1e200
    for name in KERNELS:
        single = one_by_one(compiled, name, q, v, k)
        for count in (2, 7, 8, 9, 15, 29):
            same(together(compiled, name, q[:count], v[:count], k), single[:count])


def test_blocks_are_narrower_where_there_are_many_shapes() -> None:
    """The arrays grow with the number of shapes: with 100, sixteen states take what fits into 256 kB."""
    few, many = (derive.lower(derive.derive(derive.symbolic_body("b", n, lowering="loops"))) for n in (8, 100))
    assert {block.width for block in c_batch.batch_blocks(few).values()} == {32}
    blocks = c_batch.batch_blocks(many)
    widths = {name: blocks[name].width for name in ("mass", "accel", "rates")}
    assert widths == {"mass": 32, "accel": 16, "rates": 32}
    assert MAX_MODES == 300
    for name, block in blocks.items():
        of_eight = [c_batch.stack(StateBlock(model.kernel(name), model.name, 8)) for model in (few, many)]
        assert c_batch.stack(block) <= 1024 * 256
        assert of_eight[1] <= 100 / 8 * of_eight[0]
        assert 3 * of_eight[1] <= 1024 * 512
    flat = derive.lower(derive.derive(derive.symbolic_body("b", 8, lowering="flat")))
    assert {block.width for block in c_batch.batch_blocks(flat).values()} == {8}


def test_wrong_shapes_are_refused() -> None:
    compiled = native("mean_2")
    k, (q, v) = constants(compiled), states(compiled, 3)
    for wrong in (q[0], q[:, 1:], q.T, q[None]):
        with pytest.raises(ValueError, match="mass_batch: rows of 5 are needed"):
            compiled.mass_batch(wrong, k)
    with pytest.raises(ValueError, match="force_batch: 3 and 2 states do not go together"):
        compiled.force_batch(0.0, q, v[:2], k)
    with pytest.raises(ValueError, match="accel_batch: a vector of"):
        compiled.accel_batch(0.0, q, v, k[1:])


BOUNDS = """
#include <stdlib.h>
#include "beam_point_2.h"
#include "loops_given_1.h"

static double *filled(size_t count, double value)
{
    double *x = (double *) malloc((count ? count : 1) * sizeof(double));
    for (size_t i = 0; x && i < count; i++) x[i] = value;
    return x;
}

int main(void)
{
    const tisserand_model *models[] = {beam_point_2_model(), loops_given_1_model()};
    for (int m = 0; m < 2; m++)
        for (int n = 0; n < 70; n += n < 9 ? 1 : 29) {
            const tisserand_model *a = models[m];
            double *p = filled((size_t) a->np, 0.0), *k = filled((size_t) a->nk, 0.0);
            double *q = filled((size_t) (a->nq * n), 0.1), *v = filled((size_t) (a->nv * n), 0.1);
            double *M = (double *) malloc((size_t) (a->mass_pattern->nnz * n) * sizeof(double));
            double *h = (double *) malloc((size_t) (a->nv * n) * sizeof(double)), sum = 0.0;
            if (a->defaults(p) || a->setup(p, k) || a->mass_batch(n, q, k, M)) return 1;
            if (a->force_batch(n, 0.0, q, v, k, h)) return 2;
            for (int i = 0; i < a->mass_pattern->nnz * n; i++) sum += M[i];
            for (int i = 0; i < a->nv * n; i++) sum += h[i];
            if (a->accel_batch(n, 0.0, q, v, k, h)) return 3;
            for (int i = 0; i < a->nv * n; i++) sum += h[i];
            if (a->mass_force_batch(n, 0.0, q, v, k, M, h)) return 5;
            for (int i = 0; i < a->mass_pattern->nnz * n; i++) sum += M[i];
            for (int i = 0; i < a->nv * n; i++) sum += h[i];
            if (!(sum < 1e300)) return 4;
            free(p); free(k); free(q); free(v); free(M); free(h);
        }
    return 0;
}
"""


def test_batches_keep_within_their_arrays(tmp_path: Path) -> None:
    """Valgrind sees what is read or written outside, and what is not written."""
    sources = [*written(beams.made("point", 2).files, tmp_path), *written(body(1, "given", "loops"), tmp_path)]
    (tmp_path / "main.c").write_text(BOUNDS)
    include = [f"-I{source.parent}" for source in sources]
    program = tmp_path / "bounds"
    run(tool("gcc"), *C99, "-O1", "-g", *include, tmp_path / "main.c", *sources, "-o", program, "-lm")
    run(tool("valgrind"), "--quiet", "--error-exitcode=9", program)


def test_a_block_is_made_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """The size, the helpers and the function of a block come from the same object."""
    model, made = derive.lower(derive.derive(derive.symbolic_body("b", 2, lowering="flat"))), list[str]()

    class Counted(StateBlock):
        def __init__(self, kernel: Kernel, *others: Any) -> None:
            made.append(kernel.name)
            super().__init__(kernel, *others)

    monkeypatch.setattr(c_batch, "StateBlock", Counted)
    CBackend().files(model, "")
    assert sorted(made) == sorted(c_batch.KERNELS)
