"""The linear algebra with a fixed order is right, and gives the same bytes for any setting of the processor type."""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest

from derive.reduction.arithmetic import (
    cholesky,
    eigh,
    forward_substitution,
    inner_products,
    matrix_product,
    pairwise_sum,
)

TESTS = Path(__file__).parent


@pytest.mark.parametrize("n", [0, 1, 2, 7, 30])
def test_eigenvalues(n: int) -> None:
    root = np.random.default_rng(n).normal(size=(n, n))
    matrix = (root + root.T) * 10.0 ** np.add.outer(np.arange(n) % 4, np.arange(n) % 4)
    values, vectors = eigh(matrix)
    size = np.abs(matrix).max(initial=1.0)
    assert np.allclose(vectors @ matrix @ vectors.T, np.diag(values), atol=1e-13 * size)
    assert np.allclose(vectors @ vectors.T, np.eye(n), atol=1e-13) and np.all(np.diff(values) >= 0)
    assert np.allclose(values, np.linalg.eigvalsh(matrix) if n else [], atol=1e-12 * size)


def test_equal_eigenvalues_and_none() -> None:
    values, vectors = eigh(np.zeros((3, 3)))
    assert not np.any(values) and np.array_equal(vectors, np.eye(3))
    values, _ = eigh(np.ones((4, 4)))
    assert np.allclose(values, [0, 0, 0, 4], atol=1e-15)


def test_cholesky_and_products() -> None:
    rng = np.random.default_rng(0)
    root = rng.normal(size=(9, 9))
    matrix = root @ root.T
    lower = cholesky(matrix)
    assert lower is not None and np.allclose(lower @ lower.T, matrix, rtol=1e-12)
    assert np.allclose(lower @ forward_substitution(lower, root), root, rtol=1e-9, atol=1e-12)
    assert cholesky(-matrix) is None and cholesky(np.full((2, 2), np.nan)) is None
    assert np.allclose(matrix_product(matrix, root), matrix @ root) and np.allclose(
        inner_products(root, matrix), root @ matrix.T
    )
    ones = np.full(100_001, 0.1)
    assert abs(pairwise_sum(ones) - 10000.1) < 1e-11 and pairwise_sum(np.zeros((0, 2))).tolist() == [0, 0]


def digest() -> str:
    """The digest of all numbers of the block with its modes as given."""
    sys.path.insert(0, str(TESTS))
    from bodies_of_nodes import nodal
    from test_block import block

    from derive.reduction import reduce

    found = reduce(nodal(block(), modes=8))
    values = [getattr(found, f.name) for f in fields(found)]
    data = [v.tobytes() for v in values if isinstance(v, np.ndarray)] + [found.points[0].shapes.tobytes()]
    return hashlib.sha256(b"".join(data)).hexdigest()


@pytest.mark.parametrize(
    "environment",
    [
        {"OPENBLAS_NUM_THREADS": "1", "OPENBLAS_CORETYPE": "Prescott"},
        {"OPENBLAS_CORETYPE": "Haswell", "NPY_DISABLE_CPU_FEATURES": "AVX512F AVX512_SKX AVX2 FMA3"},
    ],
)
def test_given_modes_make_the_same_bytes_on_any_processor(environment: dict[str, str]) -> None:
    code = "import test_arithmetic; print(test_arithmetic.digest())"
    run = subprocess.run(
        [sys.executable, "-c", code],
        cwd=TESTS,
        env=os.environ | environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.stdout.strip() == digest(), run.stderr
