"""Ladders of finite-element bodies whose elements give component modes of second order."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from assembled import assembled
from grid_meshes import box_mesh

import derive
from derive.solids.stresses import IntegratedMesh
from derive.spec.files.mesh_arrays import mesh_arrays
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.mesh import ElementKind, Material
from derive.spec.model.plots import ReferenceCurve
from derive.spec.model.spatial_scene import SpatialScene
from derive.study.accuracy.ladder_model import LadderModel, Shapes
from derive.study.accuracy.models import ladder, model_scene, refinements
from derive.study.accuracy.spatial_ladder import linear_reference
from derive.study.accuracy.spatial_models import can_have
from derive.study.choice.modes_of_bodies import ModesOfBodies
from derive.study.study_options import LadderRange
from explicit_motion import moved

SIDES = (1.0, 0.02, 0.01)
FEW = LadderRange(("first", "truncated"), component_modes=("craig_bampton",), component_counts=(2,))
SECOND = DisplacementOrder.TRUNCATED


def blade(order: int = 1) -> SpatialScene:
    """A blade of twelve bricks that turns fast about e3 and falls along it, clamped to a hub."""
    x, mesh = box_mesh(ElementKind.HEX20, SIDES, (6, 2, 1), material=Material("light", 70e9, 0.0, 2700.0))
    x = x - np.array(SIDES) / 2
    m, k = assembled(IntegratedMesh(mesh, x, False))
    ends = {"hub": np.abs(x[:, 0] + 0.5) < 1e-9, "tip": np.abs(x[:, 0] - 0.5) < 1e-9}
    sets = {name: {"nodes": np.flatnonzero(own).tolist(), "motion": "rigid"} for name, own in ends.items()}
    body: dict[str, Any] = {"nodes": {"positions": x, "mass": m, "stiffness": k, **mesh_arrays(mesh)}, "units": "SI"}
    body |= {"modes": 4, "interface": ["hub"], "order": order, "markers": sets}
    return derive.spatial_scene(
        "blade",
        gravity=(0, 0, "-9.81"),
        ground={"shaft": (-0.5, 0, 0)},
        bodies={"blade": body},
        joints={"shaft": {"kind": "revolute", "between": ["ground.shaft", "blade.hub"]}},
        drives={"motor": {"joint": "shaft", "speed": 60}},
        outputs={"tip": {"kind": "position", "marker": "blade.tip"}},
        plots={"height": {"y": "tip_3"}},
        simulation={"duration": 0.1, "output": 0.005},
    )


def test_elements_give_rungs_of_second_order_and_such_a_reference() -> None:
    """No rung has full displacements, which are those of beams, and none without modes is of second order."""
    scene = blade()
    labels = [model.label for model in ladder(FEW, scene)]
    modes = [f"Craig-Bampton + {count}" for count in ("no vibration", "2 vibrations", "2 vibrations, truncated")]
    assert labels == ["rigid", *modes]
    assert {model.order for model in refinements(scene)} == {SECOND} and not linear_reference(scene)
    (body,) = scene.bodies
    assert not can_have(scene, body, LadderModel(Shapes.FREE, 2, DisplacementOrder.FULL))  # type: ignore[arg-type]


@pytest.mark.parametrize("order", [1, 2])
def test_models_that_are_chosen_have_second_order_where_elements_give_it(order: int) -> None:
    """All kinds of modes may be computed, also where the specification has second order already."""
    scene = blade(order)
    modes, (body,) = ModesOfBodies(scene), scene.bodies
    assert modes.order(body) is SECOND  # type: ignore[arg-type]
    assert Shapes.CRAIG_BAMPTON in modes.kinds(body) and Shapes.FREE in modes.kinds(body)  # type: ignore[arg-type]


@pytest.mark.long
def test_spin_stiffens_models_of_second_order_alone() -> None:
    """A blade that turns sinks less than its modes of first order say."""
    scene = blade()
    run = moved(model_scene(scene, LadderModel(Shapes.CRAIG_BAMPTON, 4, SECOND)))
    rows = tuple(zip(run.t.tolist(), run["tip_3"].tolist(), strict=True))
    (plot,) = scene.plots
    known = replace(scene, plots=(replace(plot, reference=ReferenceCurve("finer.csv", "t", "y", rows)),))
    few: dict[str, Any] = {"orders": FEW.orders, "component_modes": FEW.component_modes, "component_counts": [2]}
    study = derive.study_accuracy(known, **few, runs=1, tolerances=[1e-5], error=0.1)
    errors = {line.label: line.best for line in study.lines if line.points}  # the motor moves a rigid one
    assert errors["Craig-Bampton + 2 vibrations, truncated"] < 0.05
    assert errors["Craig-Bampton + 2 vibrations"] > 0.1
