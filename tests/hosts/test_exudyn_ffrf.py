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
from derive.cli.main import main
from derive.errors import SpecError
from derive.export.exudyn.floating_frame_arguments import floating_frame_arguments
from derive.reduction.body import prepare, reduce
from derive.reduction.integrals import antisymmetric, shape_integrals
from derive.sid.read import read
from derive.sid.write import write
from derive.simulation.space.poses import SpatialPoses
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


def module_of(spec: Any, folder: Path) -> ModuleType:
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


ALL_JOINTS = """
name = "all_joints"
scene.gravity = [1, 2, -9]
[ground.markers]
base = { at = [0.1, 0, 0.2], rotation = { axis = [1, 2, 3], angle = 0.4 } }
rail = { at = [1, 0, 0], rotation = { axis = [0, 1, 3], angle = 0.7 } }
table = { at = [0, 2, 0], rotation = { axis = [1, 0, 0.3], angle = 0.2 } }
hook = [3, 0, 1]
"""
BODY = """
[bodies.NAME]
mass = 1.5
centre = [0.02, -0.03, 0.05]
inertia = [0.03, 0.04, 0.05, 0.004, -0.003, 0.002]
markers.near = { at = [0.1, 0, 0], rotation = { axis = [0, 2, 1], angle = 0.3 } }
markers.far = { at = [-0.2, 0.1, 0], rotation = { axis = [1, 0, 2], angle = -0.5 } }
start = { guess = true, position = PLACE }
"""
PAIRS = {
    "chain": {
        "revolute": ("ground.base", "a.near"),
        "universal": ("a.far", "b.near"),
        "spherical": ("b.far", "c.near"),
    },
    "guides": {
        "prismatic": ("ground.rail", "a.near"),
        "planar": ("a.far", "b.near"),
        "distance": ("ground.hook", "c.far"),
    },
}
LOADS = """
[springs.strut]
between = ["a.far", "c.near"]
stiffness = 30
damping = 0.5
rest = 0.4
[forces.push]
at = "c.far"
force = [1, 2, 3]
[torques.twist]
on = "b.near"
torque = [0.1, -0.2, 0.05]
[simulation]
duration = 0.05
output = 0.05
tolerance = 1e-10
"""


def poses(own: derive.Trajectory, body: str) -> tuple[Any, Any]:
    """The position and the rotation of a body at the end."""
    motion = own.motion
    at = SpatialPoses(motion.native, motion.k, float(own.t[-1]), own.q[-1], 1.0)
    return at.position(body), at.rotation(body)


@pytest.mark.parametrize("name", PAIRS)
def test_the_joints_of_a_scene_are_those_of_exudyn(name: str, exu: ModuleType, folder: Path) -> None:
    """Rigid bodies with a spring, a force and a torque; the error is that of the trapezoidal rule."""
    places = {"a": [0, 0, 0.2], "b": [0.3, 0.1, 0.2], "c": [0.6, 0.2, 0.2]}
    text = ALL_JOINTS.replace("all_joints", name)
    text += "".join(BODY.replace("NAME", body).replace("PLACE", str(at)) for body, at in places.items())
    for kind, markers in PAIRS[name].items():
        text += f'[joints.{kind}]\nkind = "{kind}"\nbetween = {list(markers)}\n'.replace("'", '"')
        text += "distance = 2.5\n" if kind == "distance" else ""
    spec = parse(text + LOADS)
    own, module, apart = derive.simulate(spec), module_of(spec, folder), []
    for steps in (50, 100):
        mbs = exu.SystemContainer().AddSystem()
        mechanism = module.add(mbs)
        mbs.Assemble()
        solved(exu, mbs, 0.05, steps)
        found = [(mechanism.pose(mbs, body), poses(own, body)) for body in places]
        apart.append(max(np.abs(a - b).max() for pair in found for a, b in zip(*pair, strict=True)))
    assert 3.5 < apart[0] / apart[1] < 4.5 and apart[1] < 1e-5, apart


def test_the_slider_crank_with_a_flexible_rod_moves_as_in_exudyn(exu: ModuleType, folder: Path) -> None:
    """By a method of index 3: the angular velocities of markers on sets of nodes are not exact in Exudyn."""
    spec = derive.read(ROOT / "examples/spatial_crank_slider.toml")
    own = derive.simulate(spec, duration=0.01, output=0.01, tolerance=1e-9)
    mbs = exu.SystemContainer().AddSystem()
    mechanism = module_of(spec, folder).add(mbs)
    mbs.Assemble()
    settings = exu.SimulationSettings()
    integration = settings.timeIntegration
    integration.numberOfSteps, integration.endTime, integration.verboseMode = 500, 0.01, 0
    integration.generalizedAlpha.spectralRadius, settings.solution.file.write = 0.9, False
    mbs.SolveDynamic(settings)
    for body in ("crank", "rod", "slider"):
        assert mechanism.pose(mbs, body)[0] == pytest.approx(poses(own, body)[0], abs=2e-6), body
    bent = own.q[-1][[name.startswith("rod_alpha") for name in own.motion.native.coordinates]]
    assert mechanism.amplitudes(mbs, "rod") == pytest.approx(bent, abs=0.02 * np.abs(bent).max())


UNKNOWN = """
[joints.screw]
kind = "screw"
between = ["ground.base", "a.near"]
pitch = 0.1
[drives.motor]
joint = "screw"
motion = "t"
[springs.mount]
kind = "bushing"
between = ["ground.rail", "b.near"]
stiffness = [1, 1, 1, 1, 1, 1]
[forces.wind]
at = "b.far"
force = ["sin(t)", 0, 0]
[torques.brake]
on = "b.far"
torque = [0, 0, 1]
against = "a.far"
[simulation]
duration = 0.05
output = 0.05
"""


def test_what_exudyn_has_no_item_for_is_named_by_its_line(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = ALL_JOINTS + "".join(BODY.replace("NAME", name).replace("PLACE", "[0, 0, 0]") for name in "ab") + UNKNOWN
    path = folder / "unknown.toml"
    path.write_text(text)
    assert main(["export", str(path), "--to", "exudyn-ffrf", "--out", str(folder / "unknown")]) == 2
    error, lines = capsys.readouterr().err, text.splitlines()
    for header, key in (
        ("[joints.screw]", "joints.screw.kind: Exudyn has no joint"),
        ("[drives.motor]", "drives.motor: drives are"),
        ("[springs.mount]", "springs.mount.kind: a bushing spring"),
        ("[forces.wind]", "forces.wind: a load"),
        ("[torques.brake]", "torques.brake: a load"),
    ):
        line = lines.index(header) + 1 + (".kind" in key)
        assert f"unknown.toml:{line}: {key}" in error
    assert not (folder / "unknown").exists()


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
