"""Beams in space in pieces: motions in a plane, frequencies, damping, and the places of markers."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
import pytest

import derive
from derive.pipeline import generate
from derive.runtime.interpreted_scene import InterpretedFunction
from derive.spec.as_tables import as_table
from derive.spec.model.beam_pieces import in_pieces
from derive.spec.model.spatial_beam import SpatialBeam
from some_functions import only

ROD: dict[str, Any] = {"length": 2, "mass": 3, "bending_stiffness": 100, "ansatz": ["1", "xi", "xi^2", "xi^3"]}
IN_SPACE = {"rotary_inertia": "1/50", "torsion": {"ansatz": ["xi"], "stiffness": 30}}
CLAMP = {"clamp": {"kind": "fixed", "between": ["ground.o", "rod.left"]}}
FIRST = 1.8751040687119611
"""The first root of cos x cosh x = -1."""


def cantilever(pieces: int, **changes: Any) -> derive.SpatialScene:
    """A cantilever of some pieces."""
    lateral = {"bending_stiffness": 40}
    rod = ROD | IN_SPACE | {"lateral": lateral, "markers": {"left": -1, "right": 1}, "pieces": pieces} | changes
    return derive.spatial_scene("cantilever", ground={"o": (0, 0, 0)}, bodies={"rod": rod}, joints=CLAMP)


def started(scene: Any) -> tuple[Any, dict[str, InterpretedFunction], Any]:
    """The model of a scene with its initial state, its functions, and its constants."""
    model = generate(scene, backends=(), start_needed=True).model
    return model, *functions(model)


def functions(model: Any) -> tuple[dict[str, InterpretedFunction], Any]:
    """The functions of a model, and its constants."""
    run = {k.name: InterpretedFunction(model, k) for k in model.kernels if k.name in ("setup", "accel", "constraints")}
    return run, run["setup"]((np.array(model.defaults),))


@pytest.mark.parametrize("order", [pytest.param(1, marks=pytest.mark.long), 2])
def test_pieces_in_a_plane_are_those_of_the_planar_beam(order: int) -> None:
    """A bent pendulum of two pieces with damping has the accelerations of the planar rod in two pieces.

    The section at the cut is not turned against the pieces: a rotation in space is that of a quaternion, which is the
    planar one to second order.
    """
    rod = ROD | {
        "ansatz": [*ROD["ansatz"], "xi^4"],
        "frame": "chord",
        "order": order,
        "pieces": 2,
        "damping": {"ratio": "1/20"},
    }
    start = {"deflection": "0.02*xi^2*(1 - xi^2)", "angle": 0.3, "spin": 2.0, "deflection_rate": "0.1*(xi^2 - 1)"}
    planar = rod | {"markers": {"left": -1}, "start": start} | ({"terms": "truncated"} if order == 2 else {})
    hinge = {"h": {"kind": "revolute", "between": ["ground.o", "rod.left"]}}
    gravity = (0, "-9.81")
    plane = derive.scene("plane", ground={"o": (0, 0)}, gravity=gravity, bodies={"rod": planar}, joints=hinge)
    ours, run, k = started(plane)
    q, v = np.array(ours.start.q).reshape(2, -1), np.array(ours.start.v).reshape(2, -1)
    assert np.abs(q[:, 3:]).min() > 1e-4
    expected = run["accel"].at(0.0, q.ravel(), v.ravel(), k).reshape(2, -1)
    of_space = rod | IN_SPACE | {"markers": {"left": -1}}
    space = derive.spatial_scene(
        "space", ground={"o": (0, 0, 0)}, gravity=(*gravity, 0), bodies={"rod": of_space}, joints=hinge
    )
    with only("accel", "constraints"):
        model = derive.lower(derive.derive(space), explicit=True)
    run, k = functions(model)
    none = np.zeros((2, 1))
    turned = np.c_[np.cos(q[:, 2] / 2), none, none, np.sin(q[:, 2] / 2)]
    still = np.zeros((2, len(model.coordinates) // 2 - 7 - (q.shape[1] - 3)))
    Q = np.c_[q[:, :2], none, turned, q[:, 3:], still].ravel()
    V = np.c_[v[:, :2], none, none, none, v[:, 2:], still].ravel()
    assert np.abs(run["constraints"]((Q, k), 0.0)).max() < 1e-14
    result = run["accel"].at(0.0, Q, V, k).reshape(2, -1)
    scale = np.abs(expected).max()
    assert np.abs(result[:, [0, 1, *range(5, 6 + q.shape[1] - 3)]] - expected).max() < 1e-12 * scale
    assert np.abs(np.delete(result, [0, 1, *range(5, 6 + q.shape[1] - 3)], axis=1)).max() < 1e-12 * scale


@pytest.mark.long
def test_frequencies_converge_with_the_pieces() -> None:
    """The frequencies of a cantilever in pieces of order 1 converge to those of both bendings, and of the torsion."""
    errors = []
    for pieces in (1, 2):
        found = derive.modes(cantilever(pieces)).frequencies * 2 * np.pi
        exact = [FIRST**2 * np.sqrt(stiffness / (3 * 2**3)) for stiffness in (40, 100)]
        twist = np.pi / 2 * np.sqrt(30 * 2 / 0.02) / 2
        errors.append([*(found[:2] / exact - 1), np.abs(found / twist - 1).min()])
    assert errors[0][:2] == pytest.approx([4.75e-3] * 2, rel=1e-2)  # as cubic finite elements
    assert errors[1] == pytest.approx([4.83e-4] * 2 + [2.59e-2], rel=1e-2)


@pytest.mark.long
def test_damping_of_pieces_is_that_of_the_whole_beam() -> None:
    """Every free mode of a beam in two pieces has the damping ratio that is given, and rigid motions have none."""
    rod = ROD | IN_SPACE | {"frame": "mean", "damping": {"ratio": "1/50"}, "pieces": 2}
    modes = derive.modes(derive.spatial_scene("free", bodies={"rod": rod | {"axial": AXIAL}}))
    bent = modes.frequencies > 1e-3
    assert bent.sum() == 2 * 6 + 6 - 6
    assert modes.damping_ratios[bent] == pytest.approx(np.full(12, 0.02), rel=1e-6)


AXIAL = {"ansatz": ["xi"], "stiffness": 1000}


def test_markers_are_on_their_pieces() -> None:
    """A scene in pieces has their bodies and welds, and markers on the pieces, with the rotations that are given."""
    markers = {"left": -1, "at": {"at": "1/2", "rotation": [0, 1, 0, 0]}, "middle": 0, "right": 1}
    scene = cantilever(2, markers=markers)
    cut = in_pieces(scene)
    assert [body.name for body in cut.bodies] == ["rod_1", "rod_2"]
    assert [(str(j.first), str(j.second), j.kind) for j in cut.joints] == [
        ("ground.o", "rod_1.left", "fixed"),
        ("rod_1.cut_right", "rod_2.cut_left", "fixed"),
    ]
    second = cut.bodies[1]
    assert isinstance(second, SpatialBeam)
    assert [(m.name, m.at, m.rotation) for m in second.markers[:1]] == [("at", Fraction(0), (0, 1, 0, 0))]
    mechanism: Any = derive.derive(scene)
    assert [instance.name for instance in mechanism.instances] == ["rod_1", "rod_2"]
    assert in_pieces(cut) is cut
    assert as_table(scene.bodies[0])["pieces"] == 2
    with only():
        model = derive.lower(derive.derive(scene))
    assert {marker.name for marker in model.markers if "frame" not in marker.name} == {
        "rod_left",
        "rod_at",
        "rod_middle",
        "rod_right",
    }


@pytest.mark.long
def test_start_of_pieces_is_that_of_the_beam() -> None:
    """The initial pose and velocities of a beam in pieces are the means over its pieces."""
    start: dict[str, object] = {
        "position": (1, 2, 3),
        "rotation": {"axis": (0, 0, 1), "angle": np.pi / 2},
        "velocity": (4, 0, 0),
    }
    rod = ROD | {
        "rotary_inertia": "1/50",
        "frame": "mean",
        "pieces": 3,
        "start": start | {"angular_velocity": (0.5, 0, 0)},
    }
    model, _, _ = started(derive.spatial_scene("free", bodies={"rod": rod}))
    q, v = np.array(model.start.q).reshape(3, -1), np.array(model.start.v).reshape(3, -1)
    assert q[:, :3] == pytest.approx(np.array([[1, 2 - 2 / 3, 3], [1, 2, 3], [1, 2 + 2 / 3, 3]]), abs=1e-12)
    assert q[:, 7:] == pytest.approx(np.zeros((3, 4)), abs=1e-12)
    assert v[:, :6] == pytest.approx(np.tile([4, 0, 0, 0.5, 0, 0], (3, 1)), abs=1e-9)


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({"ansatz": {"kind": "pinned", "count": 2}, "frame": "chord"}, "in one piece"),
        ({"start": {"amplitudes": [0.1]}}, "in one piece"),
    ],
)
def test_pieces_are_refused(changes: dict[str, Any], text: str) -> None:
    """Families of shapes, and amplitudes, are for beams in one piece."""
    with pytest.raises(derive.SpecError, match=text):
        cantilever(2, **changes)


def test_names_of_pieces_are_taken() -> None:
    """A body, and a joint, are not called like a piece of a beam or a weld between pieces."""
    other = {"mass": 1, "inertia": [1, 1, 1, 0, 0, 0]}
    rod = ROD | IN_SPACE | {"pieces": 2, "markers": {"left": -1}}
    with pytest.raises(derive.SpecError, match="rod_1"):
        derive.spatial_scene("taken", bodies={"rod": rod, "rod_1": other})
    clamp = {"rod_cut_1": {"kind": "fixed", "between": ["ground.o", "rod.left"]}}
    with pytest.raises(derive.SpecError, match="rod_cut_1"):
        derive.spatial_scene("taken", ground={"o": (0, 0, 0)}, bodies={"rod": rod}, joints=clamp)
