"""The flexible bodies of scenes in space as the models of a ladder have them."""

from __future__ import annotations

import tomllib
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import tomlkit

import derive
from conftest import ROOT
from derive.errors import SpecError
from derive.mechanics.bodies.spatial_beam import spatial_beam_body
from derive.mechanics.body import ExactValues
from derive.reduction.body import reduce
from derive.simulation.observables.motion import si_value
from derive.simulation.space.marker_frames import own_frame
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.spatial_beam import SpatialBeam
from derive.spec.model.spatial_bodies import FlexibleBody, SpatialRigidBody
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.model.spatial_start import SpatialInitialValues
from derive.spec.toml.read import parse
from derive.study.accuracy.ladder_model import LadderModel, Shapes
from derive.study.accuracy.measurement import compiled, motion
from derive.study.accuracy.models import model_scene
from derive.study.accuracy.reference import compared_plot
from derive.study.accuracy.spatial_models import interface, mode_count

RIGID, FLEXIBLE = LadderModel(Shapes.RIGID), LadderModel(Shapes.POLYNOMIALS, 2)
TRUNCATED = DisplacementOrder.TRUNCATED


def example(name: str) -> SpatialScene:
    scene = derive.read(ROOT / "examples" / f"{name}.toml")
    assert isinstance(scene, SpatialScene)
    return scene


def body_of(scene: SpatialScene, name: str) -> Any:
    return next(body for body in scene.bodies if body.name == name)


def modelled(scene: SpatialScene, name: str, model: LadderModel) -> Any:
    return body_of(model_scene(scene, model), name)


def tensor(body: SpatialRigidBody) -> Any:
    """The tensor of inertia about the origin of the frame."""
    assert body.mass is not None and body.inertia is not None
    xx, yy, zz, xy, xz, yz = (si_value(x) for x in body.inertia)
    own = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    centre = np.array([si_value(x) for x in body.centre])
    return own + si_value(body.mass) * (centre @ centre * np.eye(3) - np.outer(centre, centre))


def test_a_rigid_beam_has_the_inertia_of_the_undeformed_one() -> None:
    """With centres of mass beside the axis, and markers that are rotated."""
    scene = example("spatial_crank_slider_beam")
    rod = replace(body_of(scene, "rod"), centre=("0.001", "-0.002"))
    scene = derive.validated(replace(scene, bodies=(scene.bodies[0], rod, scene.bodies[2])))
    flexible, rigid = body_of(scene, "rod"), modelled(scene, "rod", RIGID)
    assert isinstance(rigid, SpatialRigidBody)
    body = spatial_beam_body(flexible)
    assert isinstance(body.values, ExactValues)
    values = {str(constant.symbol): float(constant.value) for constant in body.values.every}
    of = [[values[f"C3_{min(i, j)}{max(i, j)}"] for j in (1, 2, 3)] for i in (1, 2, 3)]
    np.testing.assert_allclose(tensor(rigid), of, atol=1e-18)
    assert rigid.mass and si_value(rigid.mass) == 0.07536
    yoke = next(m for m in rigid.markers if m.name == "yoke")
    assert yoke.rotation == next(m for m in flexible.markers if m.name == "yoke").rotation
    assert [si_value(x) for x in yoke.position] == [0.15, 0, 0]


def test_a_rigid_finite_element_body_has_the_inertia_of_its_nodes() -> None:
    scene = example("spatial_crank_slider")
    flexible, rigid = body_of(scene, "rod"), modelled(scene, "rod", RIGID)
    data = reduce(flexible.body)
    np.testing.assert_allclose(tensor(rigid), data.C3, atol=1e-15)
    assert si_value(rigid.mass) == data.mass
    for marker in rigid.markers:
        old = own_frame(next(m for m in flexible.markers if m.name == marker.name), flexible)
        np.testing.assert_array_equal([si_value(x) for x in marker.position], old.position)
        assert np.allclose(own_frame(marker).axes, old.axes)


def test_component_modes_are_those_of_the_markers_of_joints() -> None:
    """The two ends of the rod are sets of nodes: twelve displacements and rotations, six of which are rigid motion."""
    scene = example("spatial_crank_slider")
    rod = body_of(scene, "rod")
    assert interface(scene, rod) == ("ball", "yoke")
    for shapes, modes in ((Shapes.CRAIG_BAMPTON, 8), (Shapes.ATTACHMENT, 14), (Shapes.FREE, 2)):
        model = LadderModel(shapes, 2)
        assert mode_count(scene, rod, model) == modes
        changed = modelled(scene, "rod", model)
        assert isinstance(changed, FlexibleBody)
        assert changed.body.modes == modes and len(reduce(changed.body).stiffness) == modes
        assert changed.body.interface == (() if shapes is Shapes.FREE else ("ball", "yoke"))


def test_a_beam_keeps_its_stiffness_in_the_other_plane_and_has_as_many_twists_as_asked() -> None:
    scene = example("spatial_crank_slider_beam")
    model = LadderModel(Shapes.POLYNOMIALS, 3, TRUNCATED)
    for torsion, twists in ((None, 1), (0, 0), (2, 2)):
        rod = modelled(scene, "rod", replace(model, torsion=torsion))
        assert isinstance(rod, SpatialBeam)
        assert [si_value(x) for x in rod.bending_stiffnesses] == [35.84, 8.96]
        assert rod.order is TRUNCATED and rod.orthogonal
        assert len(rod.torsion.ansatz if rod.torsion else ()) == twists
    assert replace(model, torsion=2).label == "1 beam, P2 to P4, 2 twists, truncated"


def test_models_of_one_kind_of_body_leave_the_other_kind_as_it_is() -> None:
    beam, finite = example("spatial_crank_slider_beam"), example("spatial_crank_slider")
    assert modelled(beam, "rod", LadderModel(Shapes.FREE, 2)) == body_of(beam, "rod")
    kept = modelled(finite, "rod", LadderModel(Shapes.POLYNOMIALS, 2))
    assert kept.body.modes == 4 and kept.body.component_modes is None


def test_amplitudes_of_other_shapes_are_refused() -> None:
    scene = example("spatial_crank_slider_beam")
    rod = replace(body_of(scene, "rod"), start=SpatialInitialValues(amplitudes=(0.001,)))
    scene = derive.validated(replace(scene, bodies=(scene.bodies[0], rod, scene.bodies[2])))
    with pytest.raises(SpecError, match=r"bodies\.rod\.start: models have other shapes"):
        model_scene(scene, RIGID)


def loaded() -> SpatialScene:
    """A free beam with loads of each kind, and a rigid body on its section beside the axis."""
    return derive.spatial_scene(
        "loaded",
        bodies={
            "rod": {
                **{"length": 2, "mass": 3, "bending_stiffness": 2000, "rotary_inertia": "0.02", "order": 1},
                "torsion": {"ansatz": ["xi"], "stiffness": 1000},
                "markers": {"right": 1},
                "start": {"rotation": {"axis": [1, 2, 2], "angle": 0.5}},
                "loads": {
                    "wind": {"force": ["1", "2*xi", "3 - xi"], "time": "cos(t)"},
                    "twist": {"force": [0, "1 + xi", 0], "torque": [1, 0, "xi^2"], "frame": "body"},
                },
                "masses": {
                    "knob": {"at": "1/2", "mass": 1, "centre": [0, "0.1", "0.2"], "inertia": [1, 1, 1, 0, 0, 0]}
                },
            }
        },
        outputs={"end": {"kind": "position", "marker": "rod.right"}},
        plots={"place": {"y": ["end_2", "end_3"]}},
        simulation={"duration": 0.4, "output": 0.1},
    )


def test_a_rigid_beam_with_loads_and_masses_moves_as_a_stiff_one() -> None:
    scene = loaded()
    stiff, rigid = (motion(compiled(scene, model, monitored=False), 1e-9) for model in (FLEXIBLE, RIGID))
    for name in ("end_2", "end_3"):
        moved = rigid[name] - rigid[name][0]
        assert np.abs(moved).max() > 0.05
        np.testing.assert_allclose(stiff[name] - stiff[name][0], moved, atol=0.01)


@pytest.mark.parametrize(
    ("table", "column", "does"),
    [
        ({"kind": "deflection", "marker": "rod.middle"}, "seen_2", "give it a chord"),
        ({"kind": "twist", "section": "rod.middle"}, "seen", "plot the rotation of a marker"),
        ({"kind": "deflection", "marker": "rod.middle", "chord": ["rod.ball", "rod.yoke"]}, "seen_2", ""),
    ],
)
def test_curves_in_the_frame_of_a_beam_are_not_compared(table: dict[str, Any], column: str, does: str) -> None:
    """Such curves of beams in the mean frame and in pieces differ by hundreds of per cent, and never converge."""
    text = (ROOT / "examples" / "spatial_crank_slider_beam.toml").read_text(encoding="utf-8")
    tables = tomllib.loads(text) | {"outputs": {"seen": table}, "plots": {"seen": {"y": column}}}
    scene = parse(tomlkit.dumps(tables))
    assert isinstance(scene, SpatialScene)
    if not does:
        assert compared_plot(scene, None).name == "seen"
        return
    with pytest.raises(SpecError, match=f"floating frame of rod, which each model.*{does}, or "):
        compared_plot(scene, None)
