"""Initial deflections and twists of beams in space: the planar beam, curves in both planes, pieces, and messages."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

import derive
from derive.mechanics.bodies.section_fields import section_shapes
from derive.simulation.errors import ExcessiveDeformation
from derive.simulation.observables.beams import function_values
from derive.simulation.prepared_run import PreparedRun
from derive.spec.model.spatial_beam import SpatialBeam
from derive.study.accuracy.ladder_model import LadderModel, Shapes
from derive.study.accuracy.models import start_remainders
from derive.study.accuracy.spatial_models import modelled_in_space

ROD: dict[str, Any] = {"length": 2, "mass": 3, "bending_stiffness": 100, "ansatz": ["1", "xi", "xi^2", "xi^3"]}
IN_SPACE = {"rotary_inertia": "1/50", "torsion": {"ansatz": ["xi", "xi^2"], "stiffness": 30}}
CURVE, RATE = "0.02*xi^2*(1 - xi) + 0.01 + 0.02*xi", "0.1*(xi^2 - 1)"
POINTS = {"left": -1, "tip": 1}


def run(scene: Any) -> Any:
    """A short motion of a scene."""
    simulation = derive.Simulation(duration=1e-3, output=1e-3, tolerance=1e-13)
    return PreparedRun(replace(scene, simulation=simulation), complete=False).trajectory()


def planar_start(hinged: bool) -> dict[str, Any]:
    """Initial values of a planar rod; those of its position only if it is free."""
    free = {} if hinged else {"position": (0.1, 0.2), "velocity": (1, 2)}
    return {"deflection": CURVE, "deflection_rate": RATE, "angle": 0.3, "spin": 2.0} | free


def spatial_start(hinged: bool) -> dict[str, Any]:
    """The same in space."""
    free = {} if hinged else {"position": (0.1, 0.2, 0), "velocity": (1, 2, 0)}
    turned = {"rotation": {"axis": [0, 0, 1], "angle": 0.3}, "angular_velocity": [0, 0, 2]}
    return {"deflection": [CURVE, 0], "deflection_rate": [RATE, 0]} | turned | free


@pytest.mark.parametrize(
    ("frame", "hinged", "pieces", "order"),
    [
        ("mean", False, 1, 1),
        pytest.param({"kind": "tangent", "at": -1}, False, 1, 1, marks=pytest.mark.long),
        pytest.param("chord", True, 1, 2, marks=pytest.mark.long),
    ],
    ids=["free", "tangent", "second-order"],
)
def test_a_bent_beam_in_a_plane_starts_as_the_planar_beam(frame: Any, hinged: bool, pieces: int, order: int) -> None:
    """Poses, amplitudes and all rates agree, with a rigid part of the curve in every frame, and so does the motion."""
    rod = ROD | {"frame": frame, "pieces": pieces, "order": order, "markers": POINTS}
    rod |= {"terms": "truncated"} if order == 2 else {}
    joints = {"h": {"kind": "revolute", "between": ["ground.o", "rod.left"]}} if hinged else {}
    tip = {"tip": {"kind": "position", "marker": "rod.tip"}}
    plane = run(
        derive.scene(
            "plane",
            ground={"o": (0, 0)},
            gravity=(0, "-9.81"),
            bodies={"rod": rod | {"start": planar_start(hinged)}},
            joints=joints,
            outputs=tip,
        )
    )
    space = run(
        derive.spatial_scene(
            "space",
            ground={"o": (0, 0, 0)},
            gravity=(0, "-9.81", 0),
            bodies={"rod": rod | IN_SPACE | {"start": spatial_start(hinged)}},
            joints=joints,
            outputs=tip,
        )
    )
    assert np.ptp([plane["tip_1"], plane["tip_2"]], axis=1).min() > 1e-4
    for k in ("1", "2"):
        assert space[f"tip_{k}"] == pytest.approx(plane[f"tip_{k}"], abs=1e-13)
    for name in [n for n in plane.columns if "alpha" in n or n.endswith(("c1", "c2", "c1dot", "c2dot"))]:
        assert space[name][0] == pytest.approx(plane[name][0], abs=1e-13), name
    assert np.abs(space["tip_3"]).max() < 1e-15


@pytest.mark.long
def test_pieces_start_as_those_in_the_plane_but_for_the_cube_of_the_slope() -> None:
    """The weld of pieces of first order turns by a quaternion, whose vector is an angle but for its cube."""
    rod = ROD | {"frame": "chord", "pieces": 2, "markers": POINTS}
    tip = {"tip": {"kind": "position", "marker": "rod.tip"}}
    joints = {"h": {"kind": "revolute", "between": ["ground.o", "rod.left"]}}

    def apart(part: str) -> float:
        """The distance of a start with this part of the curve from that in the plane."""
        curve, rate = f"{part}*({CURVE})", f"{part}*({RATE})"
        flat = planar_start(True) | {"deflection": curve, "deflection_rate": rate}
        curved = spatial_start(True) | {"deflection": [curve, 0], "deflection_rate": [rate, 0]}
        ground, solid = {"o": (0, 0)}, {"o": (0, 0, 0)}
        plane = run(derive.scene("p", ground=ground, bodies={"rod": rod | {"start": flat}}, joints=joints, outputs=tip))
        bodies = {"rod": rod | IN_SPACE | {"start": curved}}
        space = run(derive.spatial_scene("s", ground=solid, bodies=bodies, joints=joints, outputs=tip))
        names = [f"rod_{piece}_c{k}{dot}" for piece in (1, 2) for k in (1, 2) for dot in ("", "dot")]
        return max(abs(float(space[name][0] - plane[name][0])) for name in names)

    whole, half = apart("1"), apart("1/2")
    assert whole < 1e-5
    assert whole / half > 7.5


@cache
def curved(pieces: int) -> Any:
    """A free beam with curves in both planes and twisted, in some pieces."""
    start = {
        "position": [1, 2, 3],
        "rotation": {"axis": [1, 2, 2], "angle": 0.7},
        "velocity": [0.3, -0.2, 0.1],
        "angular_velocity": [0.5, 1, -0.4],
        "deflection": ["0.03*xi^2 + 0.02*xi^3 - 0.01", "0.05*xi - 0.04*xi^2"],
        "deflection_rate": ["0.3*xi^2", "0.2 - 0.1*xi^3"],
        "twist": "0.02 + 0.1*xi + 0.06*xi^2",
        "twist_rate": "0.5*xi - 0.1",
    }
    rod = ROD | IN_SPACE | {"frame": "mean", "pieces": pieces, "start": start, "markers": POINTS | {"at": "1/2"}}
    scene = derive.spatial_scene("free", bodies={"rod": rod}, outputs={"at": {"kind": "position", "marker": "rod.at"}})
    return run(scene)


def test_a_beam_that_bends_in_both_planes_has_its_curve() -> None:
    """The marker at 1/2 lies at the curve of the straight axis, but for the square of the slopes of its rigid part."""
    trajectory, xi = curved(1), 0.5
    axis = np.array([1, 2, 2]) / 3
    K = np.cross(axis, np.eye(3)).T
    S = np.eye(3) + np.sin(0.7) * K + (1 - np.cos(0.7)) * K @ K
    curve = np.array([xi, 0.03 * xi**2 + 0.02 * xi**3 - 0.01, 0.05 * xi - 0.04 * xi**2])
    found = S.T @ (np.array([trajectory[f"at_{k}"][0] for k in (1, 2, 3)]) - [1, 2, 3])
    assert found == pytest.approx(curve, abs=2e-3)
    assert np.linalg.norm(found - curve * [1, 0, 0]) > 1e-2


def test_the_twist_is_the_rotation_of_the_sections() -> None:
    """The amplitudes of torsion and the turn of the frame make up the twist at every point."""
    trajectory = curved(1)
    (beam,) = trajectory.scene.bodies
    assert isinstance(beam, SpatialBeam)
    shapes = [shape.of for shape in section_shapes(beam)]
    xi = np.linspace(-1, 1, 5)
    amplitudes = [trajectory[f"rod_alpha{i}"][0] for i in range(1, len(shapes) + 1)]
    twist = sum(a * function_values(f, xi) for a, f in zip(amplitudes[4:], shapes[4:], strict=True))
    assert twist - twist[2] == pytest.approx(0.1 * xi + 0.06 * xi**2, abs=1e-15)


def test_the_pieces_of_a_bent_beam_meet() -> None:
    """Pieces begin with the curve of the whole beam: they meet, and the marker is where it is on one piece."""
    one, two = curved(1), curved(2)
    assert [two[f"at_{k}"][0] for k in (1, 2, 3)] == pytest.approx([one[f"at_{k}"][0] for k in (1, 2, 3)], abs=3e-3)
    assert two.initial.position_error < 1e-9 and two.initial.velocity_error < 1e-8


def test_curves_that_the_shapes_do_not_have() -> None:
    """They are refused where they are given, with the key; as a guess the nearest is taken, with the planar note."""
    base = ROD | IN_SPACE | {"ansatz": ["1", "xi", "xi^2"], "torsion": {"ansatz": ["xi"], "stiffness": 30}}
    start = {"deflection": ["xi^3", "xi"], "deflection_rate": [0, "xi^4"], "twist": "xi^2"}
    with pytest.raises(derive.SpecError) as refused:
        derive.spatial_scene("free", bodies={"rod": base | {"start": start}})
    paths = [problem.path for problem in refused.value.problems]
    assert paths == [f"bodies.rod.start.{key}" for key in ("deflection[0]", "deflection_rate[1]", "twist")]
    guess = {"deflection": ["xi^3/100", 0], "twist": "xi^2/100", "guess": True}
    notes = run(derive.spatial_scene("free", bodies={"rod": base | {"start": guess}})).initial.notes
    plane = derive.scene(
        "free", bodies={"rod": ROD | {"ansatz": base["ansatz"], "start": {"deflection": "xi^3/100", "guess": True}}}
    )
    (planar,) = run(plane).initial.notes
    assert [planar.replace(" (rms)", " along e2 (rms)"), notes[1]] == [*notes]
    assert notes[1].startswith("bodies.rod.start.twist: ")


def test_amplitudes_beside_curves_are_refused() -> None:
    """Both describe the deformation."""
    start = {"amplitudes": [0.1], "deflection": ["xi^2", 0]}
    with pytest.raises(derive.SpecError, match="`amplitudes` and `deflection` describe the same"):
        derive.spatial_scene("free", bodies={"rod": ROD | IN_SPACE | {"start": start}})


def test_joints_that_bend_a_beam_too_far_are_refused() -> None:
    """A clamped rod whose other end is held 0.8 of its length beside its axis has no state, as in the plane."""
    rod = ROD | {"rotary_inertia": "1/50", "frame": {"kind": "tangent", "at": -1}, "markers": POINTS}
    joints = {
        "clamp": {"kind": "fixed", "between": ["ground.o", "rod.left"]},
        "ball": {"kind": "spherical", "between": ["ground.far", "rod.tip"]},
    }
    ground: dict[str, Any] = {"o": (0, 0, 0), "far": (2, 0, "8/5")}
    scene = derive.spatial_scene("far", ground=ground, bodies={"rod": rod}, joints=joints)
    with pytest.raises(ExcessiveDeformation, match=r"only by bending rod by 0\.8 of the length"):
        run(scene)


def test_other_bodies_have_no_curves() -> None:
    """A rigid body in space has no deflection."""
    ball = {"mass": 1, "inertia": [1, 1, 1, 0, 0, 0], "start": {"twist": "xi"}}
    with pytest.raises(derive.SpecError, match=r"bodies\.ball\.start\.twist: unknown key"):
        derive.spatial_scene("free", bodies={"ball": ball})


def test_models_of_a_study_start_with_the_curve() -> None:
    """Other shapes take the nearest curve, and say so; a rigid rod starts along the line nearest to the curve."""
    start = {"position": [1, 2, 3], "rotation": [1, 0, 0, 0], "velocity": [0, 0, 0], "angular_velocity": [0, 0, 0]}
    curves = {"deflection": ["0.3*xi^3", "0.1"], "deflection_rate": ["0.5*xi", 0], "twist": "0.2 + 0.1*xi^2"}
    scene = derive.spatial_scene("free", bodies={"rod": ROD | IN_SPACE | {"start": start | curves}})
    rigid, coarse = LadderModel(Shapes.RIGID), LadderModel(Shapes.POLYNOMIALS, 1)
    body = modelled_in_space(scene, scene.bodies[0], rigid)
    slope = 3 / 5 * 0.3  # of the line nearest to xi^3, over half the length, 1 m
    assert body.start.position == pytest.approx((1, 2, 3.1), abs=1e-15)
    mean_twist = 0.2 + 0.1 / 3
    angle = np.hypot(mean_twist, slope)
    expected = np.r_[np.cos(angle / 2), np.sin(angle / 2) / angle * np.array([mean_twist, 0, slope])]
    assert body.start.rotation == pytest.approx(expected, abs=1e-14)
    assert body.start.angular_velocity is not None
    assert body.start.angular_velocity[2] == pytest.approx(0.5, rel=0.02)
    assert body.start.guess
    bent = modelled_in_space(scene, scene.bodies[0], coarse)
    assert bent.start.guess
    assert bent.start.deflection == scene.bodies[0].start.deflection
    (line,) = start_remainders(scene, coarse)
    assert "start.deflection: " in line
    left = [line.split("(rms) is not in ")[1] for line in start_remainders(scene, rigid)]
    assert [text[:16] for text in left] == ["the rigid motion"] * 2
