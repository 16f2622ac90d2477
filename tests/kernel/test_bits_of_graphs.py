"""Python, C and batches of loops over bodies and joints have the bits of the interpreter, on random graphs."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from both_lowerings import results
from generated_sine import sines
from test_instance_graphs import small

import derive
from conftest import QUICK
from derive.backends.c.source import CBackend
from derive.backends.python.backend import PythonBackend
from derive.ir.interpreter import interpret
from derive.runtime.loading import load_scene
from derive.runtime.native_scene import NativeScene

GENERATED = ((0, False, False), (9, False, False), (57, True, False), (15, False, True))
"""Seeds, whether their joints are varying, and whether beams are in pieces."""


@cache
def files(*of: int) -> tuple[derive.File, ...]:
    model = small(*of).instances
    return (*CBackend().files(model, ""), *PythonBackend().files(model, ""))


@cache
def native(*of: int) -> NativeScene:
    return load_scene(files(*of), QUICK)


@cache
def module(*of: int) -> ModuleType:
    (file,) = (file for file in files(*of) if file.path.endswith(".py"))
    result = ModuleType("generated")
    exec(compile(file.text, file.path, "exec"), result.__dict__)
    return result


def evaluated(*of: int) -> list[str]:
    """The functions besides setup and those of markers."""
    names = (kernel.name for kernel in small(*of).instances.kernels)
    return [name for name in names if name.partition("_")[0] not in ("setup", "marker", "load")]


@pytest.mark.parametrize(
    ("seed", "varying", "pieces"), [pytest.param(*GENERATED[0], marks=pytest.mark.long), *GENERATED[1:]]
)
def test_python_has_the_bits_of_the_interpreter(seed: int, varying: bool, pieces: bool) -> None:
    of = small(seed, varying, pieces)
    for name in evaluated(seed, varying, pieces):
        given = [x if isinstance(x, float) else np.array(x) for x in of.arguments(name).values()]
        found = getattr(module(seed, varying, pieces), name)(*given)
        expected = results(of, of.instances, name).values()
        for a, b in zip(found if isinstance(found, tuple) else (found,), expected, strict=True):
            assert a.tobytes() == b.tobytes(), name


SINES: Mapping[str, Callable[[float], float]] = {
    "sin": lambda x: float(sines(np.array([x]), flags=QUICK)[0][0]),
    "cos": lambda x: float(sines(np.array([x]), flags=QUICK)[1][0]),
}


@pytest.mark.parametrize(("seed", "varying", "pieces"), GENERATED)
def test_c_has_the_bits_of_the_interpreter(seed: int, varying: bool, pieces: bool) -> None:
    """With the sines of C."""
    of = small(seed, varying, pieces)
    for name in evaluated(seed, varying, pieces):
        kernel, given = of.instances.kernel(name), of.arguments(name)
        expected = interpret(kernel, given, functions=SINES).values()
        found = in_c(native(seed, varying, pieces), name)(*given.values())
        for a, b in zip(found if isinstance(found, tuple) else (found,), expected, strict=True):
            assert np.ravel(a).tobytes() == np.array(b, float).tobytes(), name


def in_c(scene: NativeScene, name: str) -> Any:
    """The function of a kernel; those of the forms are functions of the form."""
    kind, _, form = name.partition("_")
    if kind in ("residual", "jacobian"):
        return getattr(scene.dae[form or "index3"], kind)
    return getattr(scene, name)


BATCHES = ("mass", "force", "mass_force", "accel", "energy", "momentum", "rates")


@pytest.mark.parametrize(("seed", "varying", "pieces"), GENERATED)
def test_batches_have_the_bits_of_single_states(seed: int, varying: bool, pieces: bool) -> None:
    scene, rng = native(seed, varying, pieces), np.random.default_rng(seed)
    q = np.array(small(seed, varying, pieces).state["q"]) * rng.uniform(0.5, 1.0, (11, scene.nq))
    v, k = rng.uniform(-1, 1, (11, scene.nv)), scene.setup()
    for name in BATCHES:
        given = {"mass": (q,)}.get(name, (q, v))
        time = (0.5,) if name in ("force", "mass_force", "accel") else ()
        batch = getattr(scene, f"{name}_batch")(*time, *given, k)
        single = [getattr(scene, name)(*time, *state, k) for state in zip(*given, strict=True)]
        if isinstance(batch, tuple):
            batch, single = np.hstack(batch), [np.concatenate(parts) for parts in single]
        assert batch.tobytes() == np.array(single).tobytes(), name
