"""Two or three bodies of a kind in the lanes of vectors: the same bits in every width, and idle lanes do not count."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from toolchain import tool

import derive
from derive.backends.c.source import CBackend
from derive.ir.interpreter import interpret
from derive.ir.model import Model
from derive.lowering.instances.lower import lower_instances
from derive.mechanics.multibody.mechanism import Mechanism
from derive.runtime.compiler import FLAGS, WITHOUT_BATCHES, vector_flags
from derive.runtime.loading import load_scene

WAYS = {
    "numbers": (*FLAGS, "-O1", "-DTISSERAND_NO_VECTORS"),
    "two": FLAGS,
    "widest": vector_flags(),
}
BEYOND = 40
"""The numbers behind the state, more than a body has coordinates, that nothing may read: they are NaN."""
ROD = {"ansatz": ["1", "xi", "xi^2"], "mass": 2, "bending_stiffness": 30, "markers": {"left": -1, "right": 1}}


def in_a_row(count: int) -> dict[str, tuple[str, str]]:
    """The markers of the pins of a chain that hangs from the ground."""
    ends = ["ground.hook", *(f"rod_{k}.right" for k in range(count))]
    return {f"pin_{k}": (ends[k], f"rod_{k}.left") for k in range(count)}


BODIES = {
    "two beside": {f"rod_{k}": ROD for k in range(2)},
    "three in a row": {f"rod_{k}": ROD for k in range(3)},
    "three beside": {f"rod_{k}": ROD for k in range(3)},
    # joints in pieces come after those between beams, so that places in the system count downwards
    "three in pieces": {f"rod_{k}": {**ROD, "pieces": 2} for k in range(3)},
    # a rigid body between them: integers place their elements, which are copied
    "three apart": {
        "rod_0": ROD,
        "block": {"mass": 1, "inertia": 1, "keep_coordinates": True, "markers": {"left": [1, 0]}},
        "rod_1": ROD,
        "rod_2": ROD,
    },
}
JOINTS = {
    "three in a row": in_a_row(3),
    "three in pieces": in_a_row(3),
    **{
        name: {f"pin_{body}": ("ground.hook", f"{body}.left") for body in BODIES[name]}
        for name in ("two beside", "three beside", "three apart")
    },
}


@cache
def model(name: str) -> Model:
    scene = derive.scene(
        "few",
        ground={"hook": [0, 0]},
        gravity=[0, -9],
        bodies=BODIES[name],
        joints={joint: {"kind": "revolute", "between": list(ends)} for joint, ends in JOINTS[name].items()},
    )
    mechanism = derive.derive(scene)
    assert isinstance(mechanism, Mechanism)
    return lower_instances(mechanism, explicit=True)


@cache
def files(name: str) -> tuple[derive.File, ...]:
    """The C of the accelerations; other functions are empty, so that compilers take little time."""
    kernels = (
        k if k.name in ("setup", "accel") else replace(k, sections=(), constants=()) for k in model(name).kernels
    )
    return tuple(CBackend().files(replace(model(name), kernels=tuple(kernels)), ""))


def state(name: str) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(5)
    count = len(model(name).coordinates)
    q, v = (np.append(rng.uniform(-scale, scale, count), [np.nan] * BEYOND) for scale in (0.3, 1))
    return q[:count], v[:count]


@cache
def accelerations(name: str, compiler: str, way: str) -> np.ndarray:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("CC", tool(compiler))
        native = load_scene(files(name), (*WAYS[way], WITHOUT_BATCHES))
    return native.accel(0.0, *state(name), native.setup())


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("compiler", ["gcc", "clang"])
@pytest.mark.parametrize("name", BODIES)
def test_bits_do_not_depend_on_the_width_or_the_compiler(name: str, compiler: str, way: str) -> None:
    found, numbers = accelerations(name, compiler, way), accelerations(name, "gcc", "numbers")
    assert found.tobytes() == numbers.tobytes()
    kernel, (q, v) = model(name).kernel("accel"), state(name)
    constants = interpret(model(name).kernel("setup"), {"p": list(model(name).defaults)})["k"]
    given = {"t": 0.0, "q": q.tolist(), "v": v.tolist(), "k": constants}
    expected = interpret(kernel, {a.name: given[a.name] for a in kernel.arguments})["vdot"]
    assert numbers == pytest.approx(expected, rel=1e-12, abs=1e-12)


@pytest.mark.parametrize("name", BODIES)
def test_the_lanes_that_are_left_are_filled(name: str) -> None:
    (source,) = (file for file in files(name) if file.path.endswith(".c"))
    function = source.text[source.text.index("int few_accel(") :].partition("\n}\n")[0]
    count = 2 if name == "two beside" else 3
    assert f"tisserand_sines(TISSERAND_FILLED({count}), angle_1, sine_1, cosine_1);" in function
    assert "TISSERAND_LOAD(copies_" not in function
    assert ("TISSERAND_GATHER_FEW(copies_" in function) == (name in ("three apart", "three in pieces"))
