"""Results that are not finite have code 2: of every body of a class, in vectors of any width, in both lowerings.

The bodies do not know of each other, so that a check of the others does not find what is wrong with one of them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

import derive
from conftest import QUICK
from derive.backends.c.source import CBackend
from derive.backends.python.backend import PythonBackend
from derive.ir.expansion import expand
from derive.ir.interpreter import RequirementError, interpret, interpret_batch
from derive.ir.loop_nests import every
from derive.ir.model import Model
from derive.ir.statements import Require, Requirement, ReturnCode
from derive.lowering.flat.lower import lower
from derive.lowering.instances.lower import lower_instances
from derive.mechanics.multibody.mechanism import Mechanism
from derive.runtime.compiler import vector_flags
from derive.runtime.loading import load_scene
from derive.runtime.native_call import ModelError
from derive.runtime.native_scene import NativeScene
from kernel.test_instance_lanes import looped, nodes_in_lanes

WAYS = {"numbers": (*QUICK, "-DTISSERAND_NO_VECTORS"), "widest": (*vector_flags(), "-O1"), "quick": QUICK}
COMPILED = [("flat", "quick"), ("instances", "numbers"), ("instances", "widest")]
CHECKED = ("accel", "solve", "project_velocity", "solve_kkt")
"""The functions that check their results."""
BAD = (np.nan, np.inf, 1e200)
"""Values that give no finite results, the last one where it is squared."""
COUNTS = {"single": 1, "pair": 2, "trio": 3, "pendulum": 7}
"""The bodies of each class: a number, idle lanes, and a second block that overlaps the first one."""
BODIES = [(name, k) for name, count in COUNTS.items() for k in range(count)]


@cache
def mechanism() -> Mechanism:
    modes = dict(zip(COUNTS, (1, 2, 3, 1), strict=True))
    bodies = {
        f"{name}_{k}": {
            "ansatz": ["1", "xi", *(f"xi^{j + 2}" for j in range(modes[name]))],
            "mass": 2,
            "bending_stiffness": 30,
            "markers": {"left": -1} if name == "pendulum" else {},
        }
        for name, k in BODIES
    }
    pins = {
        f"pin_{k}": {"kind": "revolute", "between": ["ground.hook", f"pendulum_{k}.left"]}
        for k in range(COUNTS["pendulum"])
    }
    made = derive.derive(derive.scene("parts", ground={"hook": [0, 0]}, bodies=bodies, joints=pins))
    assert isinstance(made, Mechanism)
    return made


@cache
def model(lowering: str) -> Model:
    if lowering == "flat":
        return lower(mechanism().expanded(), sensitivities=True, explicit=True)
    return lower_instances(mechanism(), sensitivities=True, explicit=True)


@cache
def native(lowering: str, way: str) -> NativeScene:
    """The functions that check their results; others are empty, so that compilers take little time."""
    own = model(lowering)
    kernels = (k if k.name in ("setup", *CHECKED) else replace(k, sections=(), constants=()) for k in own.kernels)
    return load_scene(CBackend().files(replace(own, kernels=tuple(kernels)), ""), WAYS[way])


def first(body: tuple[str, int]) -> int:
    """The first coordinate of a body."""
    sizes = {"single": 4, "pair": 5, "trio": 6, "pendulum": 4}
    return sum(sizes[name] for name, _ in BODIES[: BODIES.index(body)])


def calls(body: tuple[str, int], bad: float) -> Iterator[tuple[str, dict[str, Any]]]:
    """Arguments of the functions with a bad value that concerns one body: a speed, or a right-hand side."""
    size, count = len(mechanism().rows), COUNTS["pendulum"]
    rng = np.random.default_rng(5)
    q, v, a = (rng.uniform(-0.1, 0.1, size) for _ in range(3))
    given: dict[str, Any] = {"t": 0.0, "q": q, "v": v, "a": a, "b": np.zeros(2 * count), "r": np.zeros(2 * count)}
    fast = {**given, "v": np.where(np.arange(size) == first(body) + 2, bad, v)}
    yield from (("accel", fast), ("solve", fast))
    if not np.isfinite(bad):
        yield "solve_kkt", {**given, "a": np.where(np.arange(size) == first(body) + 3, bad, a)}
        if body[0] == "pendulum":
            row = np.where(np.arange(2 * count) == 2 * body[1] + 1, bad, 0.0)
            yield from (("project_velocity", {**given, "r": row}), ("solve_kkt", {**given, "b": row}))


def code_of(function: Callable[..., object], arguments: list[Any]) -> int:
    try:
        function(*arguments)
    except (ModelError, RequirementError) as error:
        return int(error.code)
    return 0


def wrong_codes(lowering: str, called: Callable[[str], Callable[..., object]], k: Any) -> list[Any]:
    """The calls with a bad value that have another code than 2, and those with a small one that have one."""
    result = []
    for body in BODIES:
        for bad in (*BAD, 0.5):
            for name, given in calls(body, bad):
                arguments = [{**given, "k": k}[a.name] for a in model(lowering).kernel(name).arguments]
                code = code_of(called(name), arguments)
                result += [(body, bad, name, code)] if code != (0 if bad == 0.5 else 2) else []
    return result


@pytest.mark.parametrize(("lowering", "way"), COMPILED)
def test_c_checks_the_results_of_every_body(lowering: str, way: str) -> None:
    own = native(lowering, way)
    assert wrong_codes(lowering, lambda name: getattr(own, name), own.setup()) == []


@pytest.mark.parametrize(("lowering", "way"), COMPILED)
def test_batches_check_the_results_of_every_body(lowering: str, way: str) -> None:
    """Of nine states, a block and one more, the third and the last one have a bad value."""
    own, wrong = native(lowering, way), (2, 8)
    for body in BODIES:
        for bad in BAD:
            _, given = next(calls(body, 0.5))
            q, v = (np.tile(given[name], (9, 1)) for name in ("q", "v"))
            v[[*wrong], first(body) + 2] = bad
            found = own.accel_batch(0.0, q, v, own.setup(), check=False)
            assert [b for b in range(9) if np.isnan(found[b]).all()] == [*wrong], body
            assert np.isfinite(np.delete(found, wrong, axis=0)).all()
            assert code_of(own.accel_batch, [0.0, q, v, own.setup()]) == 2


@pytest.mark.parametrize(("lowering", "way"), COMPILED)
def test_a_pivot_that_vanishes_is_reported_first(lowering: str, way: str) -> None:
    """A deflection that is a NaN makes the pivots of a joint one as well, and then all results."""
    own, k = native(lowering, way), native(lowering, way).setup()
    for body in (("pendulum", number) for number in range(COUNTS["pendulum"])):
        _, given = next(calls(body, 0.5))
        q = np.where(np.arange(len(given["q"])) == first(body) + 3, np.nan, given["q"])
        assert code_of(own.accel, [0.0, q, given["v"], k]) == ReturnCode.PIVOT
        assert code_of(own.solve_kkt, [0.0, q, k, given["a"], given["b"]]) == ReturnCode.PIVOT
        many = np.tile(given["q"], (8, 1)), np.tile(given["v"], (8, 1))
        many[0][5] = q
        assert code_of(own.accel_batch, [0.0, *many, k]) == ReturnCode.PIVOT


@pytest.mark.parametrize("lowering", ["flat", "instances"])
def test_the_interpreter_and_python_check_the_results_of_every_body(lowering: str) -> None:
    own, k = model(lowering), [*native(*next(of for of in COMPILED if of[0] == lowering)).setup()]

    def interpreted(name: str) -> Callable[..., object]:
        kernel = own.kernel(name)
        names = [a.name for a in kernel.arguments]
        return lambda *values: interpret(kernel, dict(zip(names, (np.array(x).tolist() for x in values), strict=True)))

    assert wrong_codes(lowering, interpreted, k) == []
    module: dict[str, Any] = {}
    exec(PythonBackend().files(own, "")[0].text, module)

    def called(name: str) -> Callable[..., object]:
        def function(*values: Any) -> object:
            try:
                return module[name](*values)
            except module["ModelError"] as error:
                raise ModelError(name, error.code) from error

        return function

    assert wrong_codes(lowering, called, np.array(k)) == []


@pytest.mark.parametrize("body", [0, 4, 7, 8])
@pytest.mark.parametrize("bad", BAD)
def test_a_chain_whose_bodies_all_know_of_a_bad_speed(body: int, bad: float) -> None:
    """The speed of the first, a middle and the last body of a class, in order and in vectors; then of a body alone."""
    kernel = looped("chain_9").kernel("accel")
    given = {a.name: 0.3 if a.scalar else [0.01 * (k % 7) for k in range(a.size)] for a in kernel.arguments}
    assert np.isfinite(interpret(kernel, given)["vdot"]).all()
    given["v"][5 * body + 2] = bad
    for nodes in (None, nodes_in_lanes(kernel)):
        with pytest.raises(RequirementError) as caught:
            interpret(kernel, given, nodes=nodes)
        assert caught.value.code is ReturnCode.NOT_FINITE
    many = {name: [[x] * 2 for x in value] if isinstance(value, list) else value for name, value in given.items()}
    many["v"][5 * body + 2] = [0.0, bad]
    assert interpret_batch(kernel, many, 2)[1] == [0, 2]


@pytest.mark.parametrize("lowering", ["flat", "instances"])
def test_the_header_names_the_functions_that_check_their_results(lowering: str) -> None:
    own = model(lowering)
    finite = {
        kernel.name
        for kernel in own.kernels
        for node in every(node for statement in kernel.statements for node in expand(statement))
        if isinstance(node, Require) and node.kind is Requirement.FINITE
    }
    assert finite - {"setup"} == {*CHECKED}
    (header,) = (file.text for file in CBackend().files(own, "") if file.path.endswith(".h"))
    assert "0 for success. setup, accel, solve, project_velocity and solve_kkt return 1 if a pivot vanished" in header


@pytest.mark.parametrize("count", [2, 3, 5])
def test_batches_of_chains_check_bodies_that_share_a_step(count: int) -> None:
    """Of a short chain several bodies are computed in one step of the elimination, each with a check of its own."""
    own = looped(f"chain_{count}")
    kernels = (k if k.name in ("setup", "accel") else replace(k, sections=(), constants=()) for k in own.kernels)
    native = load_scene(CBackend().files(replace(own, kernels=tuple(kernels)), ""), QUICK)
    q, v = 0.1 * np.random.default_rng(3).uniform(-1, 1, (2, 8, 5 * count))
    k = native.setup()
    assert np.array_equal(
        native.accel_batch(0.0, q, v, k), [native.accel(0.0, *state, k) for state in zip(q, v, strict=True)]
    )
    for body in range(count):
        fast = v.copy()
        fast[3, 5 * body + 2] = 1e200
        found = native.accel_batch(0.0, q, fast, k, check=False)
        assert np.isnan(found[3]).all() and np.isfinite(np.delete(found, 3, axis=0)).all()
        assert code_of(native.accel_batch, [0.0, q, fast, k]) == ReturnCode.NOT_FINITE
