"""Mechanisms of rigid bodies in space move as in Pinocchio, which computes them by recursions in joint coordinates."""

from __future__ import annotations

from types import ModuleType
from typing import Any

import numpy as np
import pytest
from pinocchio_models import KINDS, PinocchioModel, ends, pinocchio_model, tree
from programs import package
from reference_mechanisms import slider_crank_scene
from scipy.linalg import null_space

import derive
from conftest import QUICK
from derive.backends.model_files import explicit_files
from derive.derivation import derive as equations
from derive.model_lowering import lower
from derive.runtime.loading import load_scene
from derive.spec.toml.read import parse

pytestmark = pytest.mark.hosts

LIMIT = 1e-12
"""The largest difference of accelerations, relative to the largest one."""


@pytest.fixture(scope="module")
def pin() -> ModuleType:
    return package("pinocchio")


def native(text: str) -> derive.NativeScene:
    """The compiled accelerations of a scene."""
    spec = parse(text)
    return load_scene(explicit_files(lower(equations(spec), explicit=True), spec), QUICK)


def differences(own: derive.NativeScene, other: PinocchioModel, q: Any, v: Any, vdot: Any, data: Any) -> list[float]:
    """Differences in a state of Pinocchio: constraints, their rates, accelerations, kinetic and potential energy."""
    pin, k = other.pin, own.setup()
    energies = pin.computeKineticEnergy(other.model, data, q, v), pin.computePotentialEnergy(other.model, data, q)
    pin.forwardKinematics(other.model, data, q, v, vdot)
    motions = other.motions(data)
    names = [name.removesuffix("_c1") for name in own.coordinates if name.endswith("_c1")]
    q, v, expected = (np.concatenate([motions[name][i] for name in names]) for i in range(3))
    assert len(q) == own.nq and len(v) == own.nv
    accelerations, _ = own.solve(0.0, q, v, k)
    kinetic, gravity = own.energy(q, v, k)[[0, -1]]
    speeds = 1 + np.abs(v).max()
    return [
        np.abs(own.constraints(0.0, q, k)).max(initial=0),
        np.abs(own.constraint_rates(0.0, q, v, k)).max(initial=0) / speeds,
        np.abs(accelerations - expected).max() / (1 + np.abs(expected).max()),
        abs(kinetic - energies[0]) / kinetic,
        abs(gravity - energies[1]) / (1 + abs(gravity)),
    ]


TREES = {1: KINDS, 2: ("spherical", "free", "revolute"), 3: ("planar", "spherical", "universal", "cylindrical")}


@pytest.mark.parametrize(("seed", "kinds"), TREES.items())
def test_trees_in_random_states(seed: int, kinds: tuple[str, ...], pin: ModuleType) -> None:
    """All joints, and free bodies, in any attitude; a force and a torque act on two of them."""
    text = tree(kinds, seed)
    own, other = native(text), pinocchio_model(pin, text)
    data, rng = other.model.createData(), np.random.default_rng(seed)
    for _ in range(3):
        q = pin.integrate(other.model, pin.neutral(other.model), rng.uniform(-2, 2, other.model.nv))
        v = rng.uniform(-2, 2, other.model.nv)
        pin.forwardKinematics(other.model, data, q, v)
        forces = other.external_forces(data)
        vdot = pin.aba(other.model, data, q, v, np.zeros_like(v), forces).copy()
        assert max(differences(own, other, q, v, vdot, data)) < LIMIT


@pytest.mark.parametrize("angle", [0.4, 2.0])
def test_a_closed_loop(angle: float, pin: ModuleType) -> None:
    """The slider-crank, whose ball joint at the crank pin closes the loop of the other joints."""
    text = slider_crank_scene(6.0, angle=angle)
    own, other = native(text), pinocchio_model(pin, text, closing=("pin",))
    model, data = other.model, other.model.createData()
    q = other.start()
    (first, at_first), (second, at_second) = (other.marker(end) for end in ends(other.scene["joints"]["pin"]))
    frame = pin.ReferenceFrame.LOCAL
    closing = pin.RigidConstraintModel(pin.ContactType.CONTACT_3D, model, first, at_first, second, at_second, frame)
    models, stores = pin.StdVec_RigidConstraintModel(), pin.StdVec_RigidConstraintData()
    models.append(closing)
    stores.append(closing.createData())
    pin.initConstraintDynamics(model, data, models, stores)

    def accelerations(v: Any) -> Any:
        settings = pin.ProximalSettings(1e-15, 1e-15, 1e-12, 20)
        return pin.constraintDynamics(model, data, q, v, np.zeros_like(v), models, stores, settings).copy()

    accelerations(np.zeros(model.nv))  # which computes the frames of the constraint
    free = null_space(pin.getConstraintJacobian(model, data, closing, stores[0]))
    v = 6 / free[0, 0] * free[:, 0]
    vdot = accelerations(v)
    assert max(differences(own, other, q, v, vdot, data)) < LIMIT
