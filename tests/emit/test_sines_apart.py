"""Sines of single bodies beside loops over many are computed by one function, with the bits of those in the loops."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from toolchain import tool

import derive
from derive.backends.c.source import CBackend
from derive.runtime.compiler import FLAGS, WITHOUT_BATCHES
from derive.runtime.loading import load_scene
from emit.test_text_of_instances import FEW, MANY, chain

FIRST, SECOND, LAST = 2, 7, 5 * MANY - 3
"""The angles of three beams in q: a single one, the first of those in one loop, and a single one."""


@cache
def files() -> tuple[derive.File, ...]:
    """A chain, of whose functions all but the constraints are empty."""
    model = chain(MANY)[0]
    kept = ("setup", "constraints")
    kernels = (k if k.name in kept else replace(k, sections=(), constants=()) for k in model.kernels)
    return CBackend().files(replace(model, kernels=tuple(kernels)), "")


def constraints(compiler: str, q: np.ndarray, *flags: str) -> np.ndarray:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("CC", tool(compiler))
        scene = load_scene(files(), (*FLAGS, WITHOUT_BATCHES, *flags))
    return scene.constraints(0.0, q, scene.setup())


def test_short_chains_have_no_calls() -> None:
    """Where single bodies are a tenth of all, calls would take more than they are worth."""
    (source,) = (file.text for file in chain(FEW)[1] if file.path.endswith(".c"))
    assert "_APART(link" not in source and "tisserand_cos(link" in source


def test_single_bodies_call_the_function_and_loops_over_many_do_not() -> None:
    (source,) = (file.text for file in files() if file.path.endswith(".c"))
    _, body = source.split("int chain_constraints(", 1)
    loops = re.split(r"\n    for \(", body.split("\n}\n", 1)[0])[1:]
    calls = [re.findall(r"(\w+_(?:COS|SIN|cos|sin)\w*)\(", loop) for loop in loops if "cos_phi" in loop]
    apart, within = ["TISSERAND_COS_APART", "TISSERAND_SIN_APART"], ["tisserand_cos", "tisserand_sin"]
    assert calls == [apart, within, apart]


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
@pytest.mark.parametrize("angle", [0.7, -2.5, 1e6, -1e300])
def test_bits_are_those_of_loops_and_of_the_library(compiler: str, angle: float) -> None:
    """The sums of positions are those of a beam in a loop, near zero and where the library computes the sine."""
    q = np.zeros(5 * MANY)
    q[[FIRST, SECOND, LAST]] = angle
    found = constraints(compiler, q)
    assert found.tobytes() == constraints(compiler, q, "-DTISSERAND_NO_VECTORS").tobytes()
    cosine, sine = np.cos(angle), np.sin(angle)
    expected = [-cosine / 20, -sine / 20, -cosine / 10, -sine / 10, 0]
    np.testing.assert_allclose(found[:5], expected, rtol=1e-14)
    np.testing.assert_allclose(found[-3:], [-cosine / 20 - 1 / 20, -sine / 20, angle], rtol=1e-14)
