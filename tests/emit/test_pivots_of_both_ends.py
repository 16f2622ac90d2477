"""Loops from both ends of a path: a step has one test, which fails for each requirement of each end."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from toolchain import tool

from derive.backends.c.source import CBackend
from derive.ir.expressions import Ends, Operation, Operator, ScalarRef
from derive.ir.indices import constant, variable
from derive.ir.interpreter import RequirementError, interpret
from derive.ir.kernel import Kernel, Section
from derive.ir.model import Model
from derive.ir.statements import ForEach, Let, Require, Requirement, ReturnCode, StoreElement
from derive.runtime.compiler import FLAGS, WITHOUT_BATCHES, vector_flags
from derive.runtime.loading import load_scene
from derive.runtime.native_call import ModelError
from derive.runtime.native_scene import NativeScene
from kernel.test_instance_lanes import looped

WAYS = {"numbers": (*FLAGS, "-DTISSERAND_NO_VECTORS"), "two": FLAGS, "widest": vector_flags()}
COUNT = 10
"""The coordinates of two rods, of which the loop takes three from each end."""
TAKEN = (0, 1, 2, 7, 8, 9)


def own_kernel(kernel: Kernel) -> Kernel:
    """vdot = q v at the places taken, where q and v must be positive."""

    def at(array: str) -> Ends:
        return Ends(array, variable("step"), variable("step", -1, COUNT - 1), "end")

    requirements = [
        item
        for name, array in (("a", "q"), ("b", "v"))
        for item in (
            Let(name, at(array)),
            Require(Requirement.POSITIVE, ScalarRef(name), ReturnCode.PIVOT, f"{array} is not positive"),
        )
    ]
    product = Operation(Operator.MUL, (ScalarRef("a"), ScalarRef("b")))
    body = (*requirements, StoreElement(at("vdot"), product))
    steps = ForEach("step", constant(0), constant(3), body)
    both = ForEach("end", constant(0), constant(2), (steps,), independent=True)
    return replace(kernel, sections=(Section("joints", "", "both ends", (both,)),), constants=())


@cache
def model() -> Model:
    """Two rods, whose accelerations are those of `own_kernel`; other functions are empty."""
    made = looped("chain_2")
    kernels = (
        own_kernel(k) if k.name == "accel" else k if k.name == "setup" else replace(k, sections=(), constants=())
        for k in made.kernels
    )
    return replace(made, kernels=tuple(kernels))


@cache
def native(compiler: str, way: str) -> NativeScene:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("CC", tool(compiler))
        return load_scene(CBackend().files(model(), ""), (*WAYS[way], "-O1", WITHOUT_BATCHES))


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_each_requirement_of_each_end_counts(compiler: str, way: str) -> None:
    scene, kernel = native(compiler, way), model().kernel("accel")
    q, v = np.arange(1.0, COUNT + 1), np.arange(2.0, COUNT + 2)
    k = scene.setup()
    assert np.array_equal(scene.accel(0.0, q, v, k)[list(TAKEN)], (q * v)[list(TAKEN)])
    for which in (0, 1):
        for place in range(COUNT):
            for bad in (0.0, -1.0, np.nan):
                given = [q.copy(), v.copy()]
                given[which][place] = bad
                if place not in TAKEN:
                    scene.accel(0.0, *given, k)
                    continue
                with pytest.raises(ModelError) as failed:
                    scene.accel(0.0, *given, k)
                assert failed.value.code == ReturnCode.PIVOT
                with pytest.raises(RequirementError):
                    interpret(kernel, {"t": 0.0, "q": given[0].tolist(), "v": given[1].tolist(), "k": list(k)})


def test_a_step_has_one_test() -> None:
    """It is behind the last requirement and before the results."""
    (source,) = (file for file in CBackend().files(model(), "") if file.path.endswith(".c"))
    function = source.text[source.text.index("_accel(\n") :].partition("\n}\n")[0]
    lines = [line.strip() for line in function.splitlines()]
    checks = [n for n, line in enumerate(lines) if line.startswith("TISSERAND_CHECK_ENDS(holds_1, ")]
    (test,) = (n for n, line in enumerate(lines) if line.startswith("if (!TISSERAND_BOTH(holds_1)) return 1;"))
    (store,) = (n for n, line in enumerate(lines) if line.startswith("TISSERAND_STORE_BOTH(vdot, "))
    assert len(checks) == 2 and checks[-1] < test < store
