"""Beams in space warn in both planes as planar beams do, and of lateral buckling; otherwise runs are silent."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import derive
from derive.runtime.interpreted_scene import InterpretedScene
from derive.simulation.validity.bending_planes import bending_planes
from derive.simulation.validity.lateral_buckling import lateral_monitors
from derive.simulation.validity.monitoring_outputs import MOST_PIECES_IN_SPACE, monitoring_note, monitoring_outputs
from derive.simulation.validity.monitors import Cause, Monitor
from derive.spec.model.beam_pieces import in_pieces
from explicit_motion import moved

ROD: dict[str, Any] = {
    "length": 1,
    "mass": 1,
    "bending_stiffness": 2,
    "ansatz": ["1", "xi", "xi^2", "xi^3"],
    "frame": "mean",
    "markers": {"left": -1, "right": 1},
}
IN_SPACE = {"rotary_inertia": "1/1000"}


def cantilever(**changes: Any) -> derive.SpatialScene:
    """A beam in space that is clamped at its left end."""
    forces = changes.pop("forces", {})
    return derive.spatial_scene(
        "cantilever",
        ground={"o": (0, 0, 0)},
        bodies={"rod": ROD | IN_SPACE | changes},
        joints={"h": {"kind": "fixed", "between": ["ground.o", "rod.left"]}},
        forces=forces,
    )


def test_monitors_are_those_of_the_planar_beam() -> None:
    """A cantilever that a load bends in a plane has the monitors of the planar beam there, and no others pass."""
    joint = derive.Joint("h", "weld", derive.MarkerRef("ground", "o"), derive.MarkerRef("rod", "left"))
    load = ["-3", "sin(3*t)/10"]
    plane = derive.scene(
        "plane",
        ground={"o": (0, 0)},
        bodies={"rod": ROD},
        joints=[joint],
        forces={"f": {"at": "rod.right", "components": load}},
    )
    space = cantilever(forces={"f": {"at": "rod.right", "force": [*load, 0]}})
    first, second = (moved(scene, duration=1, output=0.05) for scene in (plane, space))
    own = [m for m in second.validity if m.axis == 2]
    assert [m.cause for m in own] == [m.cause for m in first.validity]
    for ours, known in zip(own, first.validity, strict=True):
        assert ours.value == pytest.approx(known.value, rel=0.02)
        assert ours.error == pytest.approx(known.error, rel=0.2)  # means over the steps of the integrator
    assert len(second.warnings) == len(first.warnings) > 0
    assert all("rod along its e2" in warning for warning in second.warnings)


def test_the_small_inertia_about_the_axis_of_a_beam_is_no_doubt() -> None:
    """A slender beam that bends loses nearly all of it at second order, but of its motion along e2 2 % alone."""
    slender = {"order": 2, "rotary_inertia": "1/100000", "start": {"amplitudes": [0.05]}}
    scene = derive.spatial_scene("free", bodies={"rod": ROD | slender})
    run = moved(scene, duration=0.02, output=0.01)
    (along,) = (m.value for m in run.validity if m.cause is Cause.MASS_MATRIX and m.axis == 2)
    assert 0.01 < along < 0.03


def test_valid_models_are_silent() -> None:
    """A beam of second order with enough shapes, which bends little, has monitors in both planes and no warning."""
    force = {"f": {"at": "rod.right", "force": [0, "sin(t)/100", "t/100"]}}
    scene = cantilever(order=2, ansatz=["1", "xi", "xi^2", "xi^3", "xi^4"], forces=force)
    run = moved(scene, duration=0.5, output=0.05)
    assert {m.axis for m in run.validity} == {2, 3}
    assert run.warnings == ()


def buckling(scene: derive.SpatialScene, amplitudes: dict[int, float]) -> Monitor:
    """The monitor of lateral buckling in a state with these amplitudes, by their numbers."""
    native = InterpretedScene(derive.lower(derive.derive(scene)))
    q = np.zeros(native.nq)
    q[:4] = 0.5, 0, 0, 1
    for number, value in amplitudes.items():
        q[6 + number] = value
    (monitor,) = lateral_monitors(scene, native, native.setup(native.defaults), np.zeros(1), q[None])
    return monitor


TWIST = {"ansatz": ["xi"], "stiffness": 3}
FLAT: dict[str, Any] = {
    "frame": {"kind": "tangent", "at": -1},
    "ansatz": [f"xi^{power}" for power in range(6)],
    "torsion": {"ansatz": ["xi", "xi^2", "xi^3"], "stiffness": 3},
}


def test_lateral_buckling_of_a_cantilever() -> None:
    """An end load in the stiff plane takes away the square of its part of 4.013 sqrt(EI GJ)/l^2 of the stiffness."""
    load, EI = 2.0, 1000.0
    scene = cantilever(bending_stiffness=1000, lateral={"bending_stiffness": 1}, **FLAT)
    shapes, xi = bending_planes(scene)[0], np.linspace(-1, 1, 20)
    x = (1 + xi) / 2  # the deflection is F (3 l x^2 - x^3)/(6 EI)
    amplitudes = np.linalg.lstsq(shapes.values(xi).T, load * (3 * x**2 - x**3) / (6 * EI), rcond=None)[0]
    monitor = buckling(scene, dict(enumerate(amplitudes, 1)))
    critical = 4.013 * np.sqrt(3)
    assert monitor.value == pytest.approx((load / critical) ** 2 * (1 - 1 / EI), rel=0.01)
    assert monitor.axis == 3 and not monitor.passed  # it does not bend in the weaker plane
    beyond = buckling(scene, {i: 4 * a for i, a in enumerate(amplitudes, 1)})
    assert beyond.value > 1 and beyond.passed
    assert "order = 2" in beyond.warning


def test_torque_on_a_shaft() -> None:
    """A torque takes away the square of its part of pi^2/2 EI/l, which turns with the ends of a shaft by half."""
    torque = 3.0
    shaft = ROD | IN_SPACE | FLAT | {"frame": "chord", "bending_stiffness": 1, "torsion": TWIST}
    held = {"kind": "general", "removes": ["x", "y", "z", "rx"], "between": ["ground.o", "rod.left"]}
    guided = {"kind": "general", "removes": ["y", "z"], "between": ["ground.p", "rod.right"]}
    ground = {"o": (0, 0, 0), "p": (1, 0, 0)}
    scene = derive.spatial_scene("shaft", ground=ground, bodies={"rod": shaft}, joints={"h": held, "g": guided})
    of_twist = len(FLAT["ansatz"]) - 2  # shapes of each deflection
    monitor = buckling(scene, {2 * of_twist + 1: torque / (4 * 3)})  # theta' = 4 a/l^2 = T/GJ
    assert monitor.value == pytest.approx((torque / (np.pi**2 / 2)) ** 2, rel=0.01)


def test_scenes_of_many_beams_are_not_monitored_and_say_so() -> None:
    """Of a beam in too many pieces nothing is monitored, and a line says it; a scene without beams has no line."""
    few, many = (in_pieces(cantilever(pieces=n)) for n in (2, MOST_PIECES_IN_SPACE + 1))
    assert monitoring_outputs(few) and not monitoring_note(few)
    assert not monitoring_outputs(many) and "is monitored" in monitoring_note(many)[0]
    assert monitoring_note(derive.spatial_scene("none", bodies={"b": {"mass": 1, "inertia": [1, 1, 1, 0, 0, 0]}})) == ()
