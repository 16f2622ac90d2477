"""A finite-element body of first order that spins fast is noted, from a tenth of its lowest natural frequency."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import derive
from derive.spec.model.simulation import SpatialStart
from derive.spec.model.spatial_scene import SpatialScene
from derive.study.accuracy.ladder_model import LadderModel, Shapes
from derive.study.accuracy.ladder_run import LadderRun
from derive.study.accuracy.measurement import compiled, curves_of, measured, motion
from derive.study.accuracy.reference import Reference, bare_plots, reference_plots
from derive.study.choice.model_runs import ModelRuns
from derive.study.spin_notes import spin_notes
from derive.study.stability.model_path import model_path
from derive.study.stability.parameter import ParameterRange, studied
from explicit_motion import moved
from spring_lattice import lattice


@pytest.mark.parametrize(("spin", "noted"), [(0.9, False), (1.1, True)])
def test_a_body_that_spins_above_a_tenth_of_its_frequency_is_noted(spin: float, noted: bool) -> None:
    """The square breathes with 10 rad/s; it has its largest moment of inertia about its normal."""
    corners = [[1, 1, 0], [-1, 1, 0], [-1, -1, 0], [1, -1, 0]]
    breathing = [np.array(corners) / 8**0.5]
    nodes = {"positions": corners, "mass": np.eye(4), "modes": breathing, "modal_stiffness": [[100]]}
    square = derive.nodal_body("square", nodes, units="SI")
    turning = replace(square, start=SpatialStart(angular_velocity=(0.0, 0.0, spin)))
    notes = moved(turning, duration=0.01, output=0.01).notes
    assert [note for note in notes if "10 rad/s (free)" in note and "centrifugal" in note] == [*notes][: int(noted)]


MODEL = LadderModel(Shapes.CRAIG_BAMPTON, 1)


def truss(spin: float = 6.0) -> SpatialScene:
    """A lattice that a motor turns steadily about an axis across it, at a speed that is its parameter `spin`."""
    body = {
        "nodes": lattice(2),
        "units": "SI",
        "markers": {"left": {"nodes": [0, 1, 2, 3]}, "tip": 8},
        "interface": ["left"],
        "modes": 1,
    }
    return derive.spatial_scene(
        "turned",
        parameters={"spin": {"default": spin, "unit": "rad/s"}},
        ground={"o": (0, 0, 0)},
        bodies={"truss": body},
        joints={"hub": {"kind": "revolute", "between": ["ground.o", "truss.left"]}},
        drives={"motor": {"joint": "hub", "speed": "spin"}},
        outputs={"tip": {"kind": "position", "marker": "truss.tip"}},
        start="steady",
        simulation={"duration": 0.1, "output": 0.01},
        plots={"it": {"y": ["tip_2"]}},
    )


@pytest.mark.parametrize(("spin", "noted"), [(0.5, False), (6.0, True)])
def test_modes_about_a_steady_rotation_have_the_note(spin: float, noted: bool) -> None:
    notes = derive.modes(truss(spin)).notes
    assert len(notes) == noted and all("truss: it spins at up to" in note and "K0omega" in note for note in notes)


def test_a_sweep_warns_of_the_sample_that_spins_fast() -> None:
    result = derive.sweep(truss(), derive.grid({"spin": [0.5, 6.0]}), outputs=["peak:tip_1", "peak:tip_2"], workers=1)
    texts = {number: [text for text in of if "truss: it spins" in text] for number, of in result.warnings.items()}
    assert list(filter(texts.get, texts)) == [1]


def test_a_study_of_stability_notes_the_models_that_spin_fast() -> None:
    made = model_path(studied(truss(), ParameterRange("spin", 0.5, 6.0, 2)), MODEL)
    assert not made.failure and [bool(point.spins) for point in made.points] == [False, True]
    assert "truss: it spins at up to" in made.spins["truss"]


def test_a_ladder_has_the_note_of_its_models() -> None:
    scene = truss()
    of = compiled(scene, MODEL)
    bare = bare_plots(scene.plots[0])
    plots = reference_plots(bare, "itself", curves_of(bare, motion(of, 1e-5)), lambda _: None)
    line = measured(of, plots, [1e-4])
    run = LadderRun(scene, Reference(plots, "itself", None), (1e-4,))
    run.lines += [line, line]
    (note,) = run.notes
    assert note == f"{line.spins['truss']} ({line.label})" and "truss: it spins at up to" in note


def test_a_choice_knows_the_note_of_its_references() -> None:
    """The chosen model may be a rigid one, which has no note."""
    scene = truss()
    runs = ModelRuns(scene, scene.plots, lambda _: None)
    runs.curves(MODEL, 1e-4)
    (note,) = spin_notes(runs.spins.items())
    assert "truss: it spins at up to" in note and note.endswith(f"({MODEL.label})")


@pytest.mark.long
def test_a_study_of_methods_has_the_note() -> None:
    notes = derive.study_methods(truss(), integrators=["rk4"], steps=100, states=2).notes
    assert any("truss: it spins at up to" in note for note in notes)
