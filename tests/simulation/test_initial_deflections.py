"""Initial deflections of beams, and initial states in equilibrium."""

from __future__ import annotations

import numpy as np
import pytest
from test_initial_values import FLEXIBLE, GROUND, made, pinned, start, values

from derive.simulation.errors import MovingDrives
from derive.simulation.initial.kinematics import Kinematics
from derive.simulation.initial.targets import targets

Array = np.ndarray


def _long(*cases: tuple[str, int]) -> list[object]:
    """Cases that the others are like."""
    return [pytest.param(*case, marks=pytest.mark.long) for case in cases]


MEAN, TANGENT, CHORD = ('frame = "mean"', 'frame = { kind = "tangent", at = -1 }', 'frame = "chord"')


@pytest.mark.parametrize(("frame", "pieces"), [(TANGENT, 1), (MEAN, 3), *_long((MEAN, 1), (CHORD, 1))])
def test_a_deflection_is_that_of_the_beam_in_any_frame_and_in_any_number_of_pieces(frame: str, pieces: int) -> None:
    """The slopes between the pieces make a difference of second order, in rotations of 0.004 rad."""
    given = 'position = [1, 2], angle = 0, velocity = [0, 0], spin = 0, deflection = "0.002*(xi^2 + xi)"'
    given = f'start = {{ {given}, deflection_rate = "0.1*xi^3" }}'
    text = FLEXIBLE.replace("{body}", f"{frame}\npieces = {pieces}\n{given}")
    state, scene = start(text), made(text)
    for name, xi in (("left", -1.0), ("quarter", 0.5), ("right", 1.0)):
        position, velocity, _ = scene.native.marker(f"beam_{name}", state.q, state.v, scene.k)
        assert position == pytest.approx([1 + xi, 2 + 0.002 * (xi**2 + xi)], abs=3e-5)
        assert velocity[1] == pytest.approx(0.1 * xi**3, abs=3e-4)
    assert not state.deformed and not state.deforming


def test_a_beam_that_is_not_deflected_stays_straight() -> None:
    """Although its deflection is not given, and could take part in what the given velocity demands."""
    text = GROUND + FLEXIBLE.replace("{body}", "start = { spin = 3 }")
    text += '[joints.pin]\nkind = "revolute"\nbetween = ["ground.a", "beam.left"]\n'
    found = values(text)
    assert all(value == (0.0, 0.0) for name, value in found.items() if name.startswith("beam_alpha"))
    assert found["beam_phi"][1] == pytest.approx(3.0, rel=1e-13)


@pytest.mark.parametrize(("frame", "pieces"), [(TANGENT, 1), (MEAN, 2), *_long((MEAN, 1), (CHORD, 1))])
def test_a_joint_on_a_beam_of_second_order_begins_where_the_shortened_beam_is(frame: str, pieces: int) -> None:
    """A guide at its right end, which 0.1 xi^2 draws in by 1/2 int (0.2 xi)^2 dxi from the middle: 0.0067 m."""
    given = 'start = { deflection = "0.1*xi^2", deflection_rate = "0.3*xi^2" }'
    text = GROUND + FLEXIBLE.replace("{body}", f"order = 2\n{frame}\npieces = {pieces}\n{given}")
    text += '[joints.rail]\nkind = "translational"\nbetween = ["ground.a", "beam.right"]\n'
    text += "start = { displacement = 0.7, speed = 0.4 }\n"
    for kind in ("position", "velocity"):
        text += f'[outputs.{kind}]\nkind = "{kind}"\nmarker = "beam.right"\n'
    state, scene = start(text), made(text)
    still = np.zeros(scene.native.nv)
    motion = scene.native.evaluate_outputs(0.0, state.q, state.v, still, np.zeros(scene.native.nlambda), scene.k)
    assert motion == pytest.approx([0.7, 0, 0.4, 0], abs=1e-12)
    assert not state.corrections
    assert max(abs(state.q[i]) for i, n in enumerate(scene.native.coordinates) if "alpha" in n) > 0.01


def test_the_section_of_a_beam_that_bends_and_stretches_is_where_the_outputs_have_it() -> None:
    """This holds in any configuration, with derivatives by coordinates: a pin that turns and a guide that slides."""
    more = 'order = 2\naxial = { ansatz = ["xi", "xi^2"], stiffness = 900 }'
    text = GROUND + FLEXIBLE.replace("{body}", more)
    for kind, end, key in (("revolute", "left", "angle"), ("translational", "right", "displacement")):
        text += f'[joints.{kind}]\nkind = "{kind}"\nbetween = ["ground.a", "beam.{end}"]\nstart = {{ {key} = 0 }}\n'
    text += '[outputs.turned]\nkind = "rotation"\nmarker = "beam.left"\n'
    text += '[outputs.moved]\nkind = "position"\nmarker = "beam.right"\n'
    scene = made(text)
    native, k, still = scene.native, scene.k, np.zeros(scene.native.nv)
    found = {target.path: target.function for target in targets(scene.scene, native)}
    turned, moved = found["joints.revolute.start.angle"], found["joints.translational.start.displacement"]

    def outputs(q: Array) -> Array:
        return native.evaluate_outputs(0.0, q, still, still, np.zeros(native.nlambda), k)[:2]

    q = np.random.default_rng(4).uniform(-0.3, 0.3, native.nq)
    linear = [function(Kinematics(native, k, 0.0, q, 1.0, False)) for function in (turned, moved)]
    np.testing.assert_allclose([part.value for part in linear], outputs(q), atol=1e-12)
    steps = 1e-5 * np.eye(native.nq)
    slopes = [(outputs(q + step) - outputs(q - step)) / 2e-5 for step in steps]
    np.testing.assert_allclose([part.gradient for part in linear], np.transpose(slopes), atol=1e-8)


HANGING = '[scene]\ngravity = [0, -9.81]\nstart = "equilibrium"\n'


def test_a_scene_begins_in_equilibrium_and_says_what_it_has_moved() -> None:
    text = HANGING + pinned("start = { angle = 0.2, spin = 1 }")
    state = start(text)
    assert state.q == pytest.approx([-np.pi / 2], rel=1e-12) and state.v == pytest.approx([1.0], rel=1e-12)
    assert state.equilibrium is not None and "stable, lowest natural frequency 0.6105 Hz" in state.notes[0]
    assert state.notes[1].startswith("bodies.rod.start.angle: 0.2 rad -> -1.57079632679 rad (its value in equilibrium)")


def test_drives_that_move_have_no_static_equilibrium() -> None:
    bob = "[bodies.bob]\nmass = 1\ninertia = 1\nmarkers = { p = [0, 1] }\n"
    bob += '[joints.bob]\nkind = "revolute"\nbetween = ["rod.end", "bob.p"]\n'
    drive = '[drives.motor]\njoint = "pin"\nmotion = "{}"\n'
    with pytest.raises(MovingDrives, match="does not hold for motor"):
        start(HANGING + pinned() + bob + drive.format("sin(t)"))
    with pytest.raises(MovingDrives):
        start(HANGING + pinned() + bob + drive.format("1 - cos(t)"))
    assert start(HANGING + pinned() + bob + drive.format("t^3")).equilibrium is not None
