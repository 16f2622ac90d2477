"""Inputs of a run beside the outputs: their Jacobian, batches, ports that are wrong, and the Python module."""

from __future__ import annotations

import numpy as np
import pytest
from test_outputs import DRIVEN, compiled

import derive
from conftest import QUICK
from derive.generated_models import generated
from derive.spec.toml.read import parse
from explicit_motion import moved


def test_the_jacobian_of_outputs_by_differences():
    spec = parse(DRIVEN)
    native = compiled(spec)
    assert native.inputs == ("turn", "turndot", "turnddot", "lift")
    sizes = (native.nq, native.nv, native.nv, native.nlambda, 4)
    rng = np.random.default_rng(3)
    x = rng.normal(size=sum(sizes)) * 0.3

    def values(x):
        q, v, vdot, lam, u = np.split(x, np.cumsum(sizes)[:-1])
        return native.evaluate_outputs(0.2, q, v, vdot, lam, native.with_inputs(native.setup(), u))

    h = 1e-6
    differences = np.array([(values(x + h * e) - values(x - h * e)) / (2 * h) for e in np.eye(len(x))]).T
    q, v, vdot, lam, u = np.split(x, np.cumsum(sizes)[:-1])
    k = native.with_inputs(native.setup(), u)
    exact = native.outputs_pattern.dense(native.outputs_jacobian(0.2, q, v, vdot, lam, k))
    np.testing.assert_allclose(exact, differences, rtol=1e-7, atol=1e-7 * np.abs(exact).max())
    assert np.abs(exact[:, -1]).max() == 0  # the force acts through the accelerations


def test_inputs_of_functions_of_python_and_of_the_specification_are_one():
    spec = parse(DRIVEN)
    known = moved(spec)
    inputs = {"turn": lambda t: (0.3 * t**2, 0.6 * t, 0.6), "lift": np.sin}
    for some in (inputs, {"lift": np.sin}):
        given = moved(spec, inputs=some)
        np.testing.assert_allclose(given.q, known.q, atol=1e-8)
        np.testing.assert_allclose(given["torque"], known["torque"], atol=1e-6)
        np.testing.assert_allclose(given["tip_2"], known["tip_2"], atol=1e-6)


def test_batches_share_the_inputs():
    spec = parse(DRIVEN)
    native = compiled(spec)
    rng = np.random.default_rng(5)
    k = native.with_inputs(native.setup(), [0.3, 0.2, 0.1, 2.0])
    q, v = rng.normal(size=(2, 5, native.nq)) * 0.1
    one = np.array([native.accel(0.0, a, b, k) for a, b in zip(q, v, strict=True)])
    np.testing.assert_array_equal(native.accel_batch(0.0, q, v, k), one)


def refused(text: str) -> str:
    with pytest.raises(derive.SpecError) as caught:
        parse(text)
    return str(caught.value)


def test_wrong_ports_are_refused():
    assert 'there is no input "lft"; did you mean "lift"?' in refused(
        DRIVEN.replace('{ input = "lift" }', '{ input = "lft" }')
    )
    unused = refused(DRIVEN.replace('[0, { input = "lift" }]', "[0, 1]"))
    assert "inputs.lift: no force, torque, load or drive uses it" in unused
    unknown = refused(DRIVEN.replace('drive = "motor"', 'drive = "moto"'))
    assert 'there is no drive "moto"; did you mean "motor"?' in unknown
    assert "the body crank is no beam" in refused(
        DRIVEN.replace('kind = "acceleration"\nmarker = "rod.right"', 'kind = "curvature"\nsection = "crank.pin"')
    )
    message = refused(DRIVEN.replace('kind = "acceleration"', 'kind = "jerk"'))
    assert 'the output is one of "position", "velocity"' in message
    assert "a acceleration output has no joint" not in message
    taken = refused(DRIVEN.replace("[outputs.torque]", "[outputs.rod_phi]"))
    assert 'outputs.rod_phi: "rod_phi" is taken: it is a coordinate of the body rod; choose another name' in taken
    assert "there is no body" in refused(DRIVEN.replace('marker = "rod.right"', 'marker = "rood.right"'))


def test_an_input_without_a_value_needs_one_in_a_simulation():
    spec = parse(DRIVEN.replace('value = "sin(t)"\n', ""))
    with pytest.raises(derive.SpecError, match=r"inputs\.lift: a simulation needs its value"):
        moved(spec)
    with pytest.raises(derive.UnknownNameError, match='there is no input of driven "lit"; did you mean "lift"'):
        moved(spec, inputs={"lit": np.sin})


def test_the_python_module_has_the_same_inputs_and_outputs():
    spec = parse(DRIVEN)
    files = generated(spec)[1]
    (source,) = (file.text for file in files if file.path.endswith(".py"))
    module = {}
    exec(compile(source, "driven.py", "exec"), module)
    native = derive.load_scene(files, QUICK)
    rng = np.random.default_rng(7)
    q, v, u = rng.normal(size=native.nq) * 0.1, rng.normal(size=native.nv), rng.normal(size=4)
    k, constants = native.with_inputs(native.setup(), u), module["setup"](native.defaults)
    vdot, lam = native.solve(0.2, q, v, k)
    np.testing.assert_array_equal(module["accel"](0.2, q, v, u, constants), vdot)
    arguments = (0.2, q, v, vdot, lam)
    np.testing.assert_array_equal(module["outputs"](*arguments, u, constants), native.evaluate_outputs(*arguments, k))
    np.testing.assert_array_equal(
        module["outputs_jacobian"](*arguments, u, constants), native.outputs_jacobian(*arguments, k)
    )
