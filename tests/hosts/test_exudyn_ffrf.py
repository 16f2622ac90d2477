"""`--to exudyn-ffrf`: the floating-frame body of Exudyn with our integrals moves as ours."""

from __future__ import annotations

import importlib.util
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest
from exudyn_systems import added, solved, tumbling
from host_models import PUSHED
from programs import package
from scipy.sparse import kron

import derive
from conftest import ROOT
from derive.errors import SpecError
from derive.export.exudyn.floating_frame import floating_frame_arguments
from derive.reduction.body import prepare, reduce
from derive.reduction.integrals import antisymmetric, shape_integrals
from derive.sid.read import read
from derive.sid.write import write
from derive.spec.toml.read import parse

pytestmark = pytest.mark.hosts


@pytest.fixture(scope="module")
def exu() -> ModuleType:
    module = package("exudyn")
    module.config.printToConsole = False
    return module


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("ffrf")


def module_of(spec: derive.NodalBody, folder: Path) -> ModuleType:
    derive.write(derive.exported(spec, "exudyn-ffrf"), folder)
    path = folder / f"{spec.name}-exudyn-ffrf/{spec.name}_ffrf.py"
    found = importlib.util.spec_from_file_location(f"{spec.name}_ffrf", path)
    module = importlib.util.module_from_spec(found)
    found.loader.exec_module(module)
    return module


def difference(one: Any, other: Any) -> float:
    """The largest difference of q and v, each relative to its largest element of the same kind."""
    worst = 0.0
    for a, b, kinds in zip(one, other, ((0, 3, 7, 15), (0, 3, 6, 14)), strict=True):
        for i, j in pairwise(kinds):
            worst = max(worst, np.max(np.abs(a[i:j] - b[i:j])) / np.max(np.abs(b[i:j])))
    return float(worst)


def test_integrals_are_those_that_exudyn_computes_of_the_mesh(exu: ModuleType) -> None:
    """Exudyn sums over the nodes with the consistent mass matrix; no integral vanishes for this frame and modes."""
    spec, rng = tumbling(), np.random.default_rng(1)
    prepared = prepare(spec)
    x = prepared.shapes.x + np.array([0.3, -0.2, 0.5])
    phi = prepared.shapes.phi + 3 * rng.standard_normal(prepared.shapes.phi.shape)
    i = shape_integrals(prepared.mass, x, phi)
    parts = {"C4": i.S4 + antisymmetric(i.c6), "C5": i.S5 - antisymmetric(i.c7)}
    same = {name: getattr(i, name) for name in ("mass", "c1", "c2", "C3", "c6", "c7", "c8")}
    ours = floating_frame_arguments(replace(reduce(spec), **same, **parts))
    mass = kron(prepared.mass, np.eye(3), format="csr")
    mesh = SimpleNamespace(
        modeBasis={"matrix": phi.reshape(len(phi), -1).T},
        GetNodePositionsAsArray=lambda: x,
        GetSurfaceTriangles=list,
        GetSurfaceTriangles6=list,
        postProcessingModes={},
        GetMassMatrix=lambda sparse: mass,
        GetStiffnessMatrix=lambda sparse: 0.0 * mass,
    )
    theirs = importlib.import_module("exudyn.FEM").ObjectFFRFreducedOrderInterface(mesh)
    named = {"mass": "totalMass", "inertia": "inertiaLocal", "centerOfMass": "chiU", "massMatrixReduced": ""}
    for name in [*named, *(name for name in ours if name.startswith("m") and name[1].isupper())]:
        expected = np.asarray(getattr(theirs, named.get(name) or name))
        assert ours[name].shape == expected.shape, name
        assert np.max(np.abs(ours[name] - expected)) < 1e-12 * np.max(np.abs(expected)), name


@pytest.mark.parametrize("gravity", [None, (Fraction(1), Fraction(2), Fraction(-9))])
def test_a_tumbling_body_moves_as_ours(gravity: Any, exu: ModuleType, folder: Path) -> None:
    """Step by step as the generated body, to the tolerance of Newton's method; and as ours with order 2."""
    spec, duration, errors = replace(tumbling(), gravity=gravity), 0.1, []
    module = module_of(spec, folder / str(gravity))
    own = derive.simulate(spec, duration=duration, output=duration, tolerance=1e-11)
    for steps in (1000, 2000):
        mbs = exu.SystemContainer().AddSystem()
        body = module.add(mbs)
        mbs.Assemble()
        solved(exu, mbs, duration, steps)
        errors.append(difference(body.state(mbs), (own.q[-1], own.v[-1])))
    assert 3.8 < errors[0] / errors[1] < 4.2 and errors[1] < 2e-3
    if gravity is None:
        other, generated = added(exu, "block", folder)
        other.Assemble()
        solved(exu, other, duration, 2000)
        assert difference(body.state(mbs), generated.state(other)) < 1e-7


def test_both_bodies_hang_at_a_joint_of_exudyn(exu: ModuleType, folder: Path) -> None:
    """A corner of the block in a spherical joint: floating-frame body and generated body of the same integrals."""
    items, duration, steps, states = exu.itemInterface, 0.05, 1000, []
    start = {"v": np.array([0.0] * 3 + [3.0, 20.0, -5.0] + [0.0] * 8), "q": np.array([0.0] * 3 + [1.0] + [0.0] * 11)}
    corner = reduce(tumbling()).points[0].position
    start["v"][:3] = -np.cross(start["v"][3:6], corner)
    for kind in ("ffrf", "generated"):
        if kind == "ffrf":
            mbs = exu.SystemContainer().AddSystem()
            body = module_of(tumbling(), folder / "hung").add(mbs, **start)
            tip = body.add_marker(mbs, "corner")
        else:
            mbs, body = added(exu, "block", folder, points=("corner",), **start)
            tip = mbs.AddMarker(items.MarkerBodyPosition(bodyNumber=body.points["corner"].body))
        ground = mbs.AddObject(items.ObjectGround(referencePosition=corner.tolist()))
        fixed = mbs.AddMarker(items.MarkerBodyPosition(bodyNumber=ground))
        joint = mbs.AddObject(items.ObjectJointSpherical(markerNumbers=[fixed, tip]))
        mbs.Assemble()
        solved(exu, mbs, duration, steps)
        states.append((body.state(mbs), mbs.GetObjectOutput(joint, exu.OutputVariableType.Force)))
    assert difference(states[0][0], states[1][0]) < 1e-5
    assert np.allclose(states[0][1], states[1][1], rtol=0, atol=1e-3 * np.max(np.abs(states[0][1])))


HUNG = """
name = "hung"
[scene]
gravity = [1, 2, -9]
[ground.markers]
hook = [-0.2, -0.05, -0.03]
[bodies.block]
nodes = "soft.npz"
units = "SI"
modes = 8
frame = "mean"
markers = { corner = 0 }
[bodies.block.start]
position = [0, 0, 0]
rotation = [1, 0, 0, 0]
velocity = [0.85, -1.09, -3.85]
angular_velocity = [3, 20, -5]
amplitudes = [0, 0, 0, 0, 0, 0, 0, 0]
amplitude_rates = [0, 0, 0, 0, 0, 0, 0, 0]
[joints.ball]
kind = "spherical"
between = ["ground.hook", "block.corner"]
[simulation]
duration = 0.05
output = 0.05
tolerance = 1e-10
"""
"""The soft block at a corner of it, without deformation at the start."""


def test_a_mechanism_in_space_moves_as_in_exudyn(exu: ModuleType, folder: Path) -> None:
    """The difference is the error of the trapezoidal rule, of order 2; extrapolated, the motion is ours."""
    arrays = {name: of for name, of in np.load(ROOT / "scenes/block.npz").items() if not name.startswith("stiffness")}
    np.savez(folder / "soft.npz", **arrays | {"modal_stiffness": 1e-4 * arrays["modal_stiffness"]})
    (folder / "hung.toml").write_text(HUNG)
    own = derive.simulate(derive.read(folder / "hung.toml"))
    module = module_of(replace(tumbling(), gravity=tuple(map(Fraction, (1, 2, -9)))), folder / "in_gravity")
    states = []
    for steps in (1000, 2000):
        mbs = exu.SystemContainer().AddSystem()
        body = module.add(mbs, q=own.q[0], v=own.v[0])
        ground = mbs.AddObject(exu.itemInterface.ObjectGround(referencePosition=[-0.2, -0.05, -0.03]))
        hook = mbs.AddMarker(exu.itemInterface.MarkerBodyPosition(bodyNumber=ground))
        tip = body.add_marker(mbs, "corner")
        mbs.AddObject(exu.itemInterface.ObjectJointSpherical(markerNumbers=[hook, tip]))
        mbs.Assemble()
        solved(exu, mbs, 0.05, steps)
        states.append(body.state(mbs))
    (q1, v1), (q2, v2) = states
    ours = own.q[-1], own.v[-1]
    errors = [difference(state, ours) for state in (*states, ((4 * q2 - q1) / 3, (4 * v2 - v1) / 3))]
    assert 3.8 < errors[0] / errors[1] < 4.2 and errors[1] < 2e-3
    assert errors[2] < 2e-7, errors


def test_a_body_of_an_sid_file_has_the_same_arguments() -> None:
    body = reduce(tumbling())
    ours, given = (floating_frame_arguments(of) for of in (body, read(write(body))))
    for name, array in ours.items():
        assert np.allclose(given[name], array, rtol=1e-12, atol=1e-12 * np.max(np.abs(array), initial=0)), name


def test_what_is_refused(folder: Path) -> None:
    block = derive.read(ROOT / "scenes/block.toml")
    assert isinstance(block, derive.NodalBody)
    for spec, message in (
        (parse(PUSHED), "is one in space"),
        (derive.read(ROOT / "scenes/solid_beam.toml"), "first order"),
        (replace(block, modes=0), "a mode and a marker"),
        (replace(block, markers=()), "a mode and a marker"),
    ):
        with pytest.raises(SpecError, match=message):
            derive.exported(spec, "exudyn-ffrf")
