"""Loops over instances: the accelerations and the multipliers have one text."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import derive
from derive.backends.c.beginnings import beginnings
from derive.backends.c.shared_sections import shared_sections
from derive.backends.c.source import CBackend
from derive.backends.source_map import source_map
from derive.ir.interpreter import interpret
from derive.ir.model import Model
from derive.lowering.instances.lower import lower_instances
from derive.mechanics.multibody.mechanism import Mechanism
from derive.runtime.loading import load_scene

BEAM = {"ansatz": ["1", "xi", "xi^2"], "bending_stiffness": "1/5", "mass": "1/20", "length": "1/10"}


@pytest.fixture(scope="module")
def model() -> Model:
    """Three beams in loops, welded to each other."""
    scene = derive.scene(
        "links",
        ground={"origin": [0, 0]},
        bodies={f"link_{k}": {**BEAM, "markers": {"left": -1, "right": 1}} for k in range(3)},
        joints={
            "pin": {"kind": "revolute", "between": ["ground.origin", "link_0.left"]},
            **{f"weld_{k}": {"kind": "weld", "between": [f"link_{k}.right", f"link_{k + 1}.left"]} for k in range(2)},
        },
    )
    mechanism = derive.derive(scene)
    assert isinstance(mechanism, Mechanism)
    return lower_instances(mechanism, explicit=True)


def test_accelerations_are_the_beginning_of_the_solution(model: Model) -> None:
    assert beginnings(model) == {"accel": "solve"}
    kernels = tuple(replace(k, sections=k.sections[1:]) if k.name == "accel" else k for k in model.kernels)
    assert not beginnings(replace(model, kernels=kernels))
    assert not beginnings(replace(model, lowering="flat"))


def test_their_statements_are_written_once(model: Model) -> None:
    files = CBackend().files(model, "a test")
    code = source_map(files, "c")
    accel, solve = code.functions["accel"], code.functions["solve"]
    assert len(accel.lines) < 12 < len(solve.lines)
    text = next(file.text for file in files if file.path.endswith(".c"))
    assert text.count("the blocks of the joints") == 2  # here, and in `project_velocity`
    assert text.splitlines()[solve.first - 1] == solve.lines[0].text


def test_projections_call_the_elimination_of_the_accelerations(model: Model) -> None:
    """The pivots of joints are in one function, which is neither of the two that call it."""
    files = CBackend().files(model, "a test")
    functions = source_map(files, "c").functions
    callers = [name for name, of in functions.items() if any("_joints_of_several(" in line.text for line in of.lines)]
    assert callers == ["solve", "project_velocity"]
    for name in callers:
        assert not any("the pivot of a joint" in line.text for line in functions[name].lines)
    text = next(file.text for file in files if file.path.endswith(".c"))
    head, *_ = text.partition("links_setup(")
    assert head.count("TISSERAND_SHARED int links_joints_of_several(") == 1
    assert "the pivot of a joint" in head


def test_projections_give_the_values_of_the_interpreter(model: Model) -> None:
    native = load_scene(CBackend().files(model, "a test"))
    rng = np.random.default_rng(2)
    q, r = rng.uniform(-0.5, 0.5, len(model.velocities)), rng.uniform(-1, 1, len(model.multipliers))
    k = native.setup()
    dv = native.project_velocity(0.0, q, k, r)
    known = interpret(model.kernel("project_velocity"), {"t": 0.0, "q": q, "k": k, "r": r})
    assert np.allclose(dv, np.array(known["dv"], float), rtol=1e-10, atol=1e-10 * np.abs(dv).max())


def test_sections_with_other_text_are_not_shared(model: Model) -> None:
    """Nothing is shared with a section that has another statement, or where a model is no loop over instances."""
    kernels = [k for k in model.kernels if k.name != "accel"]
    (shared,) = shared_sections(model, kernels).values()
    assert shared.section in model.kernel("solve").sections
    assert not shared_sections(replace(model, lowering="flat"), kernels)
    changed = replace(shared.section, body=shared.section.body[:-1])
    own = (*(changed if s == shared.section else s for s in model.kernel("solve").sections),)
    assert not shared_sections(model, [replace(k, sections=own) if k.name == "solve" else k for k in kernels])


def test_both_give_the_values_of_the_interpreter(model: Model) -> None:
    native = load_scene(CBackend().files(model, "a test"))
    rng = np.random.default_rng(1)
    q, v = rng.uniform(-0.5, 0.5, (2, len(model.velocities)))
    k = native.setup()
    vdot, lam = native.solve(0.0, q, v, k)
    known = interpret(model.kernel("solve"), {"t": 0.0, "q": q, "v": v, "k": k})
    assert np.array_equal(native.accel(0.0, q, v, k), vdot)
    assert np.allclose(vdot, np.array(known["vdot"], float), rtol=1e-10, atol=1e-10 * np.abs(vdot).max())
    assert np.allclose(lam, np.array(known["lam"], float), rtol=1e-10, atol=1e-10 * np.abs(lam).max())
