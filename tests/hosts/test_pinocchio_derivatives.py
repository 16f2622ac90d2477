"""Derivatives of inverse and of forward dynamics of a robot are those of Pinocchio."""

from __future__ import annotations

import numpy as np
import pytest
from programs import package
from test_urdf import read_by_pinocchio, robot_file, written

import derive
from conftest import QUICK
from derive.spec.toml.read import parse

pytestmark = pytest.mark.hosts

LIMIT = 1e-11
"""The largest difference, relative to the largest number."""


def close(a: np.ndarray, b: np.ndarray) -> None:
    assert np.abs(a - b).max() <= LIMIT * np.abs(b).max()


def test_derivatives_of_an_arm() -> None:
    """Of M vdot + h by q, v and vdot, and with these of the accelerations by q, v and the torques of the joints."""
    pin, path = package("pinocchio"), robot_file("ur_description/urdf/ur5_robot.urdf")
    spec, model = parse(written(path, "fixed")), read_by_pinocchio(pin, path, "fixed")
    lowered = derive.lower(derive.derive(spec), sensitivities=True, functions=["inverse_dynamics"])
    native = derive.load_scene(derive.model_files(lowered, spec), QUICK)
    k, n, data, rng = native.setup(), native.nv, model.createData(), np.random.default_rng(8)
    pattern = native.patterns["inverse_dynamics_jacobian"]
    for _ in range(20):
        q, v, vdot, torques = rng.uniform(-2, 2, (4, n))
        of_q, of_v, M = np.split(pattern.dense(native.inverse_dynamics_jacobian(0.0, q, v, vdot, k))[:, : 3 * n], 3, 1)
        theirs = pin.computeRNEADerivatives(model, data, q, v, vdot)
        close(of_q, theirs[0])
        close(of_v, theirs[1])
        close(M, np.triu(theirs[2]) + np.triu(theirs[2], 1).T)

        loaded = native.with_inputs(k, torques)
        vdot = native.accel(0.0, q, v, loaded)
        jacobian = pattern.dense(native.inverse_dynamics_jacobian(0.0, q, v, vdot, loaded))
        inverse = [native.solve_kkt(0.0, q, loaded, -column)[0] for column in jacobian.T]
        by_q, by_v, _, by_u = np.split(np.column_stack(inverse), [n, 2 * n, 3 * n], 1)
        theirs = pin.computeABADerivatives(model, data, q, v, torques)
        close(by_q, theirs[0])
        close(by_v, theirs[1])
        close(by_u, np.triu(theirs[2]) + np.triu(theirs[2], 1).T)
