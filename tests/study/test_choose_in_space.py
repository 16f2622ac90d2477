"""`tisserand choose` of scenes in space: which models it tries, what it writes, and that this keeps its promise."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import derive
from conftest import ROOT
from derive.cli.main import main
from derive.simulation.simulate import simulate
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.spatial_beam import SpatialBeam
from derive.spec.model.spatial_bodies import FlexibleBody, SpatialRigidBody
from derive.spec.model.spatial_scene import SpatialScene
from derive.spec.toml.read import parse, read
from derive.study.accuracy.ladder_model import LadderModel, Shapes, mixed
from derive.study.accuracy.models import model_scene
from derive.study.accuracy.predicted_cost import PredictedCost
from derive.study.choice import one_beam, reference_models
from derive.study.choice.body_candidates import candidates, cannot_do, clamped_ends
from derive.study.choice.modes_of_bodies import ModesOfBodies
from derive.study.choice.reference_models import ReferenceModels
from derive.study.choice.untried import untried
from derive.study.choice.written_specification import chosen_specification

BEAM, NODES = (ROOT / "examples" / f"{name}.toml" for name in ("spatial_crank_slider_beam", "spatial_crank_slider"))
RIGID = LadderModel(Shapes.RIGID)
TRUNCATED = DisplacementOrder.TRUNCATED

ARM = """
name = "arm"
[scene]
gravity = [0, 0, -9.81]
[ground.markers]
hub = { at = [0, 0, 0], rotation = { x = [1, 0, 0], z = [0, 1, 0] } }
[bodies.arm]  # falls and bends
length = 1
mass = 1
rotary_inertia = 1e-4
bending_stiffness = 5
ansatz = ["1", "xi", "xi^2"]
markers = { root = { at = -1, rotation = { x = [1, 0, 0], z = [0, 1, 0] } }, tip = 1 }
start = { position = [0.5, 0, 0], rotation = [1, 0, 0, 0], guess = true }
[joints.hub]
kind = "revolute"
between = ["ground.hub", "arm.root"]
[springs.stop]  # bends the arm at its root
kind = "bushing"
between = ["ground.hub", "arm.root"]
stiffness = [0, 0, 0, 0, 0, 20]
[outputs.tip]
kind = "position"
marker = "arm.tip"
[plots.height]
y = ["tip_3"]
[simulation]
duration = 0.5
output = 0.01
"""


def scene_of(path: Path) -> SpatialScene:
    scene = read(path)
    assert isinstance(scene, SpatialScene)
    return scene


def rod_of(scene: SpatialScene) -> SpatialBeam | FlexibleBody:
    (rod,) = (body for body in scene.bodies if isinstance(body, (SpatialBeam, FlexibleBody)))
    return rod


@pytest.mark.parametrize(
    ("path", "model"),
    [
        (BEAM, RIGID),
        (BEAM, LadderModel(Shapes.SINES, 2, TRUNCATED, "chord", torsion=0)),
        (BEAM, LadderModel(Shapes.POLYNOMIALS, 3, TRUNCATED, "mean", 2, torsion=2)),
        (NODES, RIGID),
        (NODES, LadderModel(Shapes.FREE, 3)),
        (NODES, LadderModel(Shapes.CRAIG_BAMPTON, 2)),
    ],
    ids=lambda value: value.label if isinstance(value, LadderModel) else value.stem,
)
def test_what_is_written_in_space_is_the_model_that_was_run(path: Path, model: LadderModel, tmp_path: Path) -> None:
    scene, target = scene_of(path), tmp_path / "deep" / "chosen.toml"
    target.parent.mkdir()
    written = chosen_specification(path.read_text(), path, target, scene, model, 1e-5)
    target.write_text(written.text)
    chosen = scene_of(target)  # the nodes are found from there
    run = model_scene(scene, model)
    for one, other in zip(chosen.bodies, run.bodies, strict=True):
        nodes = (one.body, other.body) if isinstance(one, FlexibleBody) and isinstance(other, FlexibleBody) else ()
        same = [replace(of, data=rod.body.data) for of in nodes if isinstance(rod := rod_of(scene), FlexibleBody)]
        assert same[0] == same[1] if same else one == other
    assert chosen.simulation is not None and chosen.simulation.tolerance == 1e-5
    assert "# the cross turns about z of the slider" in written.text and model.label in written.text.splitlines()[0]


def test_loads_of_a_rigid_beam_in_space_are_written_as_forces(tmp_path: Path) -> None:
    loads = '\n[bodies.arm.loads.wind]\nforce = [0, "3 + 3*xi", 0]\ntorque = [2, 0, 0]\ntime = "sin(2*t)"\n'
    scene = parse(ARM + loads)
    assert isinstance(scene, SpatialScene)
    written = chosen_specification(ARM + loads, tmp_path / "a.toml", tmp_path / "b.toml", scene, RIGID, 1e-3)
    chosen = parse(written.text)
    run = model_scene(scene, RIGID)
    assert isinstance(chosen, SpatialScene) and isinstance(chosen.bodies[0], SpatialRigidBody)
    assert [force.name for force in chosen.forces] == [force.name for force in run.forces] and chosen.forces
    assert [torque.name for torque in chosen.torques] == [torque.name for torque in run.torques] and chosen.torques


def test_outputs_of_the_deformation_of_a_body_that_is_rigid_now_are_left_out(tmp_path: Path) -> None:
    """The deflection of a panel without a chord was kept, and no specification was written after the whole search."""
    outputs = '\n[outputs.bent]\nkind = "deflection"\nmarker = "arm.tip"\n[plots.bent]\ny = "bent_2"\n'
    scene = parse(ARM + outputs)
    assert isinstance(scene, SpatialScene)
    written = chosen_specification(ARM + outputs, tmp_path / "a.toml", tmp_path / "b.toml", scene, RIGID, 1e-3)
    chosen = parse(written.text)
    assert isinstance(chosen, SpatialScene) and {output.name for output in chosen.outputs} == {"tip"}
    assert (
        written.notes[0] == "outputs.bent: left out, since arm is rigid" and "plots.bent: left out" in written.notes[1]
    )


def test_references_in_space_are_refined_in_pieces_shapes_and_modes() -> None:
    """Beams and finite-element bodies each get models of their own kind."""
    beams, nodes = (ReferenceModels(scene_of(path)) for path in (BEAM, NODES))
    assert beams.first.label == "2 beams, P2 to P4, 2 twists, truncated"
    coarser = [way.coarser(beams.first) for way in beams.directions]
    assert [of.label for of in coarser if of] == [
        "1 beam, P2 to P4, 2 twists, truncated",
        "2 beams, P2, P3, 1 twist, truncated",
    ]
    assert beams.finer(beams.first, True) == replace(beams.first, pieces=3)
    for pieces, text in ((1, "1 beam"), (2, "2 beams")):
        few, full = (of.label for of in beams.truncated(beams.first, pieces) or ())
        assert few == f"{text}, P2, P3, 1 twist, truncated" and full == f"{text}, P2, P3, 1 twist, full"
    assert nodes.truncated(nodes.first, 1) is None
    assert nodes.first == LadderModel(Shapes.CRAIG_BAMPTON, 6)
    others = [way.coarser(nodes.first) for way in (*nodes.directions, *nodes.confirming)]
    assert others == [replace(nodes.first, count=2), LadderModel(Shapes.ATTACHMENT, 6)]
    assert nodes.needed(nodes.first) == [nodes.first, others[0]] and beams.confirming == ()
    assert nodes.finer(nodes.first, True) == replace(nodes.first, count=10)


def test_bodies_that_no_joint_holds_have_free_modes_alone() -> None:
    scene = scene_of(NODES)
    loose = replace(scene, joints=tuple(joint for joint in scene.joints if joint.name in ("bearing", "guide")))
    modes, rod = ModesOfBodies(loose), rod_of(loose)
    assert isinstance(rod, FlexibleBody)
    assert modes.kinds(rod) == (Shapes.FREE,) and (rod.name, Shapes.CRAIG_BAMPTON) in modes.refusals
    lines = untried(loose, modes)
    assert any(line.startswith("rod has no Craig-Bampton modes") for line in lines)
    assert "rod has modes of first order alone: a load along it does not change its stiffness" in lines
    assert "rod: errors are those of its modes; what finer elements would change is not known" in lines
    push = derive.SpatialForce("push", derive.MarkerRef("rod", "middle"), (0, 0, 1))
    unwatched = "no monitor watches these bodies: errors are those that are measured"
    assert unwatched in lines and unwatched in untried(replace(loose, forces=(push,)), modes)
    assert unwatched not in untried(scene_of(BEAM), modes)
    assert untried(scene_of(BEAM), modes)[0] == "rod does not stretch, as its table has no stiffness against it"


def test_candidates_in_space_are_tried_from_cheap_to_dear() -> None:
    """Shapes without twist come first; where joints hold rotations of an end, half sine waves come last."""
    scene = scene_of(BEAM)
    rod = rod_of(scene)
    models = candidates(scene, rod, PredictedCost(scene), ModesOfBodies(scene))
    assert models[:2] == (RIGID, LadderModel(Shapes.SINES, 1, TRUNCATED, "chord", torsion=0))
    assert {model.torsion for model in models[1:]} == {0, 1, 2}
    arm = parse(ARM)
    assert isinstance(arm, SpatialScene)
    assert clamped_ends(arm, rod_of(arm)) == {-1} and not clamped_ends(scene, rod)  # type: ignore[arg-type]
    few, more = (LadderModel(Shapes.SINES, 2, TRUNCATED, "chord", torsion=twists) for twists in (0, 1))
    assert cannot_do(few, {more: 0.2}, 0.1) and not cannot_do(more, {few: 0.2}, 0.1)


def test_scenes_in_space_without_flexible_body_or_plot(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    spec = tmp_path / "arm.toml"
    spec.write_text(ARM.replace('[plots.height]\ny = ["tip_3"]', ""))
    assert main(["choose", str(spec)]) == 2
    assert "plots: a ladder compares a plot" in capsys.readouterr().err
    rod = ARM[ARM.index("length = 1") : ARM.index("markers = ")]
    hub = "{ root = [-0.5, 0, 0], tip = [0.5, 0, 0] }"
    rigid = "mass = 1\ninertia = [1, 1, 1, 0, 0, 0]\nmarkers = " + hub + "\n"
    markers = ARM[ARM.index("markers = ") : ARM.index("start = ")]
    spec.write_text(ARM.replace(rod + markers, rigid))
    assert main(["choose", str(spec)]) == 0
    captured = capsys.readouterr()
    assert captured.out.startswith("arm: nothing to choose, and no file written: all bodies are rigid")
    assert not captured.err and not (tmp_path / "arm_chosen.toml").exists()
    assert main(["choose", str(spec), "--json"]) == 0
    assert "all bodies are rigid" in json.loads(capsys.readouterr().out)["notes"][0]


@pytest.mark.long
def test_the_model_chosen_in_space_keeps_its_promise(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The written specification runs, and differs from a finer model in two pieces by no more than was asked for."""
    monkeypatch.setattr(reference_models, "FIRST", reference_models.FLEXIBLE)  # in one piece, which is enough here
    monkeypatch.setattr(one_beam, "BEYOND", 0)
    polynomials = [LadderModel(Shapes.POLYNOMIALS, count, TRUNCATED) for count in (1, 2)]
    monkeypatch.setattr(one_beam, "candidates", lambda *_: (RIGID, *polynomials))
    spec, target = tmp_path / "arm.toml", tmp_path / "chosen.toml"
    spec.write_text(ARM)
    assert main(["choose", str(spec), "--error", "0.02", "--out", str(target)]) == 0
    assert "Not tried, or not checked" in capsys.readouterr().out
    fine = model_scene(scene_of(spec), mixed({"arm": LadderModel(Shapes.POLYNOMIALS, 3, TRUNCATED, "mean", 2)}))
    truth = simulate(fine, tolerance=1e-9)["tip_3"]
    error = {name: simulate(scene_of(path))["tip_3"] - truth for name, path in (("chosen", target), ("given", spec))}
    size = {name: float(np.sqrt(np.mean(of**2)) / np.abs(truth).max()) for name, of in error.items()}
    assert size["chosen"] <= 0.02 < size["given"]
