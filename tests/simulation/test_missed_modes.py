"""Notes on finite-element bodies whose modes miss the deformation under the forces of joints, and on no others."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import derive
from derive.generated_models import generated_explicit
from derive.percentages import implied_percent
from derive.runtime.loading import load_scene
from derive.simulation.trajectory import Trajectory
from derive.simulation.validity.mode_content import ModeError, mode_errors
from derive.simulation.validity.monitoring_outputs import MOST_LOADED, acting_loads
from derive.spec.model.spatial_bodies import FlexibleBody
from derive.spec.model.spatial_scene import SpatialScene
from derive.study.accuracy.doubts import doubt_lines
from derive.study.accuracy.ladder_model import LadderModel, Shapes
from derive.study.accuracy.measurement import compiled, curves_of, measured, motion
from derive.study.accuracy.reference import bare_plots, reference_plots
from explicit_motion import moved
from spring_lattice import lattice


@pytest.mark.parametrize(
    ("modes", "noted"),
    [({"component_modes": "free", "modes": 3}, True), ({"component_modes": "craig_bampton", "modes": 3}, False)],
)
def test_modes_of_a_clamped_body(modes: dict[str, Any], noted: bool) -> None:
    """Three free modes of a lattice that a joint fixes miss most of its motion; three of the fixed body suffice."""
    held = {} if noted else {"interface": ["left"]}
    body = {"nodes": lattice(1), "units": "SI", "markers": {"left": {"nodes": [0, 1, 2, 3]}}, **modes, **held}
    scene = derive.spatial_scene(
        "held",
        gravity=[0, 0, -0.1],
        ground={"o": (0, 0, 0)},
        bodies={"truss": body},
        joints={"h": {"kind": "fixed", "between": ["ground.o", "truss.left"]}},
    )
    run = moved(scene, duration=0.5, output=0.05)
    assert any("under its loads its 3 modes imply" in note for note in run.notes) == noted
    assert any("of its deformation" in note or "in its deformation" in note for note in run.notes) == noted


def test_a_joint_that_gives_coordinates_has_no_multipliers() -> None:
    """The forces of the other joints are found behind it, so that the same error is implied as if it had some."""

    def implied(keep_coordinates: bool) -> float:
        scene = derive.spatial_scene(
            "carried",
            gravity=[0, 0, -0.1],
            ground={"o": (0, 0, 0)},
            bodies={
                "seat": {
                    "mass": 1,
                    "inertia": [1, 1, 1, 0, 0, 0],
                    "markers": {"m": (0, 0, 0)},
                    "keep_coordinates": keep_coordinates,
                },
                "truss": {
                    "nodes": lattice(1),
                    "units": "SI",
                    "markers": {"left": {"nodes": [0, 1, 2, 3]}},
                    "component_modes": "free",
                    "modes": 3,
                },
            },
            joints={
                "hinge": {"kind": "revolute", "between": ["ground.o", "seat.m"]},
                "h": {"kind": "fixed", "between": ["seat.m", "truss.left"]},
            },
        )
        run = moved(scene, duration=0.5, output=0.05).motion
        (of,) = mode_errors(scene, run.native, run.k, run.t, run.q, run.v)
        assert of.of_loads
        return of.error

    assert implied(False) == pytest.approx(implied(True), rel=1e-3) and implied(False) > 0.05


def test_a_study_shows_what_a_run_notes() -> None:
    """Three free modes of a held body: the error that they imply is in the line of a ladder and its texts."""
    scene = derive.spatial_scene(
        "held",
        gravity=[0, 0, -0.1],
        ground={"o": (0, 0, 0)},
        bodies={
            "truss": {
                "nodes": lattice(1),
                "units": "SI",
                "markers": {"left": {"nodes": [0, 1, 2, 3]}, "tip": 4},
                "component_modes": "free",
                "modes": 3,
            }
        },
        joints={"h": {"kind": "fixed", "between": ["ground.o", "truss.left"]}},
        outputs={"tip": {"kind": "position", "marker": "truss.tip"}},
        simulation={"duration": 0.5, "output": 0.05},
        plots={"it": {"y": ["tip_3"]}},
    )
    of = compiled(scene, LadderModel(Shapes.FREE, 3))
    bare = bare_plots(scene.plots[0])
    plots = reference_plots(bare, "itself", curves_of(bare, motion(of, 1e-5)), lambda _: None)
    line = measured(of, plots, [1e-4])
    (missed,) = line.missed
    assert line.valid and missed.of_loads and line.implied == missed.error > 0.05
    percent = implied_percent(missed.error)
    assert f"a monitor implies {percent} in" in line.outcome
    assert doubt_lines([line], []).pop().startswith(f"the modes of truss: {line.label} ({percent}, ")


@pytest.mark.parametrize("load", [{}, {"pull": {"at": "truss.tip", "force": [0, 3, "4*sin(9*t)"]}}])
def test_a_body_without_joints_is_loaded_by_its_spin_and_by_forces(load: dict[str, Any]) -> None:
    """Modes that a spin deforms are not told by the fastest one that is kept: it may take no part at all."""

    def run(modes: int) -> tuple[Trajectory, np.ndarray]:
        body = {
            "nodes": lattice(2),
            "units": "SI",
            "markers": {"tip": 8},
            "component_modes": "free",
            "modes": modes,
            "start": {"angular_velocity": [1.0, -2.0, 0.5] if not load else [0, 0, 0]},
        }
        moved_on = moved(derive.spatial_scene("spun", bodies={"truss": body}, forces=load), duration=1.0, output=0.02)
        motion = moved_on.motion
        amplitudes = np.zeros((len(motion.t), 12))  # of orthonormal modes
        amplitudes[:, :modes] = motion.q[
            :, [motion.native.coordinates.index(f"truss_alpha{i + 1}") for i in range(modes)]
        ]
        return moved_on, amplitudes

    (few, own), (_, exact) = run(4), run(12)
    error = np.sqrt(np.mean(np.sum((own - exact) ** 2, axis=1))) / np.linalg.norm(exact, axis=1).max()
    motion = few.motion
    (of,) = mode_errors(motion.scene, motion.native, motion.k, motion.t, motion.q, motion.v)
    assert of.of_loads and error > 0.05 and error / 2 < of.error < 2 * error
    assert any("under its loads its 4 modes imply" in note for note in few.notes)


def pulled(force: bool, **changes: Any) -> SpatialScene:
    """A lattice in three free modes that a joint holds, under its weight and perhaps a force."""
    body = {
        "nodes": lattice(1),
        "units": "SI",
        "markers": {"left": {"nodes": [0, 1, 2, 3]}, "tip": 4},
        "component_modes": "free",
        "modes": 3,
    }
    return derive.spatial_scene(
        "held",
        gravity=[0, 0, -0.1],
        ground={"o": (0, 0, 0)},
        bodies={"truss": body},
        joints={"h": {"kind": "fixed", "between": ["ground.o", "truss.left"]}},
        forces={"pull": {"at": "truss.tip", "force": [0, 3, 0]}} if force else {},
        **changes,
    )


def implied_of(scene: SpatialScene, *, monitored: bool = True) -> ModeError:
    """The implied error of the one body of a scene, which may be compiled without its monitors."""
    run = moved(scene, duration=0.1, output=0.05).motion
    native = run.native if monitored else load_scene(generated_explicit(scene)[1])
    (of,) = mode_errors(scene, native, np.asarray(run.k), run.t, run.q, run.v)
    return of


def test_loops_over_bodies_imply_the_same_where_no_action_loads_a_body() -> None:
    """Loops compute no outputs of loads, so that with a force the fastest mode tells."""
    looped, alone = implied_of(pulled(False, lowering="instances")), implied_of(pulled(False))
    assert looped.of_loads and looped.error == pytest.approx(alone.error, rel=1e-6)
    assert implied_of(pulled(True)).of_loads and not implied_of(pulled(True, lowering="instances")).of_loads


def test_a_run_without_monitors_does_not_leave_out_a_force_in_silence() -> None:
    assert implied_of(pulled(False), monitored=False).of_loads
    assert not implied_of(pulled(True), monitored=False).of_loads


def test_loads_are_outputs_where_they_are_used() -> None:
    """Of few bodies with a stiffness matrix: others have the part of the fastest mode."""
    scene = pulled(True)
    (body,) = scene.bodies
    assert isinstance(body, FlexibleBody)
    many = tuple(replace(body, name=f"truss{i}") for i in range(MOST_LOADED))
    soft = replace(body, body=replace(body.body, data=replace(body.body.data, stiffness=None)))
    assert [len(outputs) for outputs in acting_loads(scene).values()] == [6]
    assert not acting_loads(replace(scene, bodies=(body, *many))) and not acting_loads(replace(scene, bodies=(soft,)))
