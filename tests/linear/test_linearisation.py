"""The linearisation agrees with differences of the accelerations and with Euler's equations of a free body."""

from __future__ import annotations

import numpy as np
import pytest
from linear_scenes import GRAVITY, chart, derivative

import derive
from conftest import QUICK, ROOT
from derive.generated_models import generated
from derive.runtime.native_scene import NativeScene
from derive.simulation.constraints.projection import project
from derive.simulation.linear.linearisation import linearise
from derive.simulation.linear.run_time_inputs import input_values

ROD = {
    "ansatz": ["1", "xi", "xi^2", "xi^3"],
    "frame": "mean",
    "mass": 0.5,
    "length": 1,
    "bending_stiffness": 2,
    "markers": {"left": -1, "middle": "1/3", "right": 1},
    "start": {"position": [0.5, 0]},
}


def test_a_driven_mechanism_in_motion() -> None:
    """The mechanism has inputs of each kind, and outputs of positions, velocities, accelerations and multipliers."""
    scene = derive.scene(
        "in_motion",
        gravity=[0, -GRAVITY],
        ground={"hook": [0, 0], "wall": [1, 1]},
        bodies={
            "rod": ROD,
            "bob": {"mass": 0.3, "inertia": 0.01, "markers": {"pin": [-0.1, 0]}, "start": {"position": [1.1, 0]}},
        },
        joints={
            "hinge": {"kind": "revolute", "between": ["ground.hook", "rod.left"]},
            "pin": {"kind": "revolute", "between": ["rod.right", "bob.pin"]},
        },
        inputs={"angle": {"unit": "rad", "value": "0.5*sin(3*t)"}, "pull": {"unit": "N"}, "twist": {"unit": "N m"}},
        drives={"motor": {"joint": "hinge", "motion": {"input": "angle"}}},
        forces={"push": {"at": "rod.middle", "components": [{"input": "pull"}, "t"]}},
        torques={"turn": {"at": "bob.pin", "against": "rod.right", "value": {"input": "twist"}}},
        springs={"tie": {"kind": "linear", "between": ["ground.wall", "rod.middle"], "stiffness": 20, "damping": 2}},
        outputs={
            "shock": {"kind": "acceleration", "marker": "bob.pin"},
            "hold": {"kind": "reaction", "joint": "hinge"},
            "bend": {"kind": "bending_moment", "section": "rod.middle"},
            "energy": {"kind": "energy"},
            "far": {"kind": "distance", "between": ["ground.wall", "bob.pin"]},
        },
    )
    native = derive.load_scene(generated(scene)[1], QUICK)
    t, random = 0.3, np.random.default_rng(0)
    u = np.array([*input_values(scene, t)[0], 0.7, -0.4])
    np.testing.assert_allclose(u[:3], [0.5 * np.sin(0.9), 1.5 * np.cos(0.9), -4.5 * np.sin(0.9)], rtol=1e-15)
    k = native.with_inputs(native.setup(), u)
    q = np.zeros(native.nq)
    q[list(native.coordinates).index("rod_c1")] = 0.5
    q[list(native.coordinates).index("bob_c1")] = 1.1
    for _ in range(12):
        q, v = project(native, k, t, q, random.standard_normal(native.nv))
    linear = linearise(native, k, t, q, v)
    n = linear.count
    assert n == native.nv - native.nlambda == 3
    values, arguments = chart(native, k, linear)
    expected = derivative(values, arguments)
    found = np.vstack([np.hstack([linear.A, linear.B])[n:], np.hstack([linear.C, linear.D])])
    scale = np.maximum(np.abs(expected).max(axis=1), 1.0)[:, None]
    np.testing.assert_allclose(found / scale, expected / scale, atol=1e-7)
    np.testing.assert_array_equal(linear.A[:n], np.hstack([np.zeros((n, n)), np.eye(n)]))
    assert not linear.B[:n].any() and linear.inputs == native.inputs and linear.outputs == native.outputs


def test_a_rigid_body_that_spins_in_space() -> None:
    body = derive.nodal_body("rigid_block", str(ROOT / "scenes/block.npz"), units="SI", modes=0, frame="mean")
    native = derive.load(generated(body)[1], QUICK)
    k, spin = native.setup(), 3.0
    turned = np.array([0.8, 0.0, 0.36, 0.48])
    q, v = np.concatenate([np.zeros(3), turned]), np.array([0.1, 0.2, 0.3, 0.0, 0.0, spin])
    linear = linearise(native, k, 0.0, q, v)
    J1, J2, J3 = np.diag(derive.modal(body).C3)
    nutation = 1j * spin * np.sqrt((J3 - J1) * (J3 - J2) / (J1 * J2))
    expected = sorted([*[0] * 8, nutation, -nutation, 1j * spin, -1j * spin], key=lambda x: x.imag)
    values = sorted(np.linalg.eigvals(linear.A), key=lambda x: x.imag)
    np.testing.assert_allclose(values, expected, atol=1e-6)


def test_forces_and_displacements_of_markers() -> None:
    beam = derive.planar_beam("state_space", frame="mean", mass=2, length=1, bending_stiffness=3, markers={"tip": 1})
    native = derive.load(generated(beam)[1], QUICK)
    k, q = native.setup(), np.array([0.0, 0.0, 0.7, 0.0, 0.0])
    linear = linearise(native, k, 0.0, q, np.zeros(5))
    assert linear.inputs == ("tip_F1", "tip_F2") and linear.outputs == ("tip_x1", "tip_x2")
    M = native.mass_pattern.dense(native.mass(q, k))
    for i, force in enumerate(np.eye(2)):
        np.testing.assert_allclose(M @ linear.B[5:, i], native.load("tip", q, force, k), atol=1e-12)
    step = 1e-6 * np.arange(1.0, 6.0)
    moved = native.marker("tip", q + linear.displacements @ step, np.zeros(5), k)[0]
    still = native.marker("tip", q, np.zeros(5), k)[0]
    np.testing.assert_allclose(linear.C[:, :5] @ step, moved - still, atol=1e-9)
    assert not linear.B[:5].any() and not linear.C[:, 5:].any() and not linear.D.any()


@pytest.mark.parametrize("ports", ["inputs", "outputs"])
def test_a_scene_with_inputs_or_outputs_alone(ports: str) -> None:
    """Outputs alone have no inputs beside them, and inputs alone have the positions of the markers."""
    tables = {
        "inputs": {
            "inputs": {"pull": {"unit": "N"}},
            "forces": {"push": {"at": "rod.right", "components": [{"input": "pull"}, 0]}},
        },
        "outputs": {
            "outputs": {
                "hold": {"kind": "reaction", "joint": "hinge"},
                "end": {"kind": "velocity", "marker": "rod.right"},
            }
        },
    }
    rod = {**ROD, "start": {"angle": 0.3, "spin": 1.5}}
    hinge = {"kind": "revolute", "between": ["ground.hook", "rod.left"]}
    scene = derive.scene(
        f"only_{ports}",
        gravity=[0, -GRAVITY],
        ground={"hook": [0, 0]},
        bodies={"rod": rod},
        joints={"hinge": hinge},
        **tables[ports],
    )
    result = derive.modes(scene, at=0.0)
    linear, native = result.linear, result.native
    assert isinstance(native, NativeScene)
    assert linear.inputs == (("pull",) if ports == "inputs" else ())
    assert linear.outputs == (
        native.outputs or tuple(f"rod_{m}_x{i}" for m in ("left", "middle", "right") for i in (1, 2))
    )
    n = linear.count
    assert linear.B.shape == (2 * n, len(linear.inputs)) and linear.D.shape == (len(linear.outputs), len(linear.inputs))
    values, arguments = chart(native, result.k, linear)
    expected = derivative(values, arguments)
    computed = np.vstack(
        [np.hstack([linear.A, linear.B])[n:], *[np.hstack([linear.C, linear.D])] * bool(native.outputs)]
    )
    scale = np.maximum(np.abs(expected).max(axis=1), 1.0)[:, None]
    np.testing.assert_allclose(computed / scale, expected / scale, atol=1e-7)
