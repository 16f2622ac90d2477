"""Stability of models: each model's own threshold, by the eigenvalues of its generated Jacobians, beside the truth."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

import derive
from conftest import QUICK, ROOT
from derive.cli.specifications import read_scene
from derive.generated_models import generated
from derive.simulation.initial.initial_state import initial_state
from derive.simulation.linear.linearisation import linearise
from derive.simulation.linear.steady_motion import NoSteadyMotion, steady_motion
from derive.spec.model.beam_parts import BeamDamping
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.planar_bodies import BeamBody
from derive.spec.set_values import with_values
from derive.study.accuracy.ladder_model import LadderModel, Shapes
from derive.study.stability.eigenvalues import eigenvalues
from derive.study.stability.model_path import ModelPath, model_path
from derive.study.stability.parameter import ParameterRange, studied
from derive.study.stability.thresholds import Interval, Threshold

FIRST, SECOND = DisplacementOrder.FIRST_ORDER, DisplacementOrder.TRUNCATED
COLUMN, BECK, CANTILEVER = (
    ROOT / f"examples/{name}.toml" for name in ("pinned_column", "beck_column", "rotating_cantilever")
)
SPINNING = ROOT / "scenes/spinning_beam.toml"
SPIN = "bodies.beam.start.spin"
STILL = {"forces.knock.components": "[0, 0]"}
EULER = np.pi**2


def polynomials(count: int, order: DisplacementOrder, frame: str = "mean", pieces: int = 1) -> LadderModel:
    return LadderModel(Shapes.POLYNOMIALS, count, order, frame, pieces)


def path(
    file: Path, name: str, low: float, high: float, model: LadderModel, changes: dict[str, str] | None = None
) -> ModelPath:
    """A model over 21 values."""
    scene, _ = with_values(read_scene(file), changes or {})
    made = model_path(studied(scene, ParameterRange(name, low, high, 21)), model)
    assert not made.failure and not made.gaps
    for c in made.thresholds:
        assert c.high - c.low < 1e-6 * c.high
    return made


@pytest.mark.long
@pytest.mark.parametrize(("frame", "second"), [("mean", np.sqrt(8400)), ("point", np.sqrt(8400 / 6.25))])
def test_a_spinning_beam_of_first_order_is_lost_at_the_same_spin_in_both_frames_and_then_at_another(
    frame: str, second: float
) -> None:
    """sqrt(720) = 26.83 in both, then 91.65 in the mean and 36.66 in the point frame, in sqrt(EI/(m l^3))."""
    made = path(SPINNING, SPIN, 0, 100, polynomials(2, FIRST, frame), STILL)
    assert [(c.before, c.after) for c in made.thresholds] == [(0, 1), (1, 2)]
    assert [c.value for c in made.thresholds] == pytest.approx([np.sqrt(720), second], rel=1e-6)
    assert made.loss == made.thresholds[0].value and made.unit == "rad/s"
    assert made.intervals == (Interval(0, made.loss, True), Interval(made.loss, 100, False))


def test_a_spinning_beam_of_second_order_is_not_lost() -> None:
    """omega^2 = 720 + 2 spin^2, as with a rigid rotation of its points."""
    made = path(SPINNING, SPIN, 0, 100, polynomials(2, SECOND), STILL)
    assert made.thresholds == () and made.loss is None
    for point in made.points:
        assert point.eigenvalues is not None
        assert point.eigenvalues.frequencies[0] == pytest.approx(np.sqrt(720 + 2 * point.value**2), rel=1e-6)


@pytest.mark.long
def test_a_rotating_cantilever_of_first_order_is_lost_at_its_natural_frequency() -> None:
    """3.5160 sqrt(EI/(m l^3)) in the frame of the hub, from above; of second order it is not lost."""
    made = path(CANTILEVER, "speed", 0, 10, polynomials(4, FIRST, "tangent"))
    assert made.loss == pytest.approx(3.51602, rel=2e-6)
    assert made.unit == "rad/s"
    assert path(CANTILEVER, "speed", 0, 10, polynomials(2, SECOND)).loss is None


@pytest.mark.parametrize(
    ("model", "expected"),
    [
        (LadderModel(Shapes.SINES, 1, SECOND, "chord"), 1.0),  # the exact mode of buckling
        (polynomials(1, SECOND, "chord"), 12 / EULER),
        pytest.param(polynomials(4, SECOND, "mean"), 1.00056, marks=pytest.mark.long),
        pytest.param(polynomials(2, SECOND, "mean", 2), 1.00752, marks=pytest.mark.long),
        pytest.param(polynomials(2, FIRST, "mean", 2), 1.21888, marks=pytest.mark.long),
        (polynomials(4, FIRST, "mean"), None),
        (LadderModel(Shapes.RIGID), None),
    ],
    ids=lambda value: value.label if isinstance(value, LadderModel) else None,
)
def test_a_pinned_column_buckles_at_the_load_of_euler(model: LadderModel, expected: float | None) -> None:
    """Over pi^2 EI/l^2, up to three loads of Euler: one beam of first order never buckles."""
    made = path(COLUMN, "P", 0, 3 * EULER, model)
    exact = 1e-6 if expected in (1.0, 12 / EULER) else 1e-5
    assert made.loss == (None if expected is None else pytest.approx(expected * EULER, rel=exact))


@pytest.mark.long
@pytest.mark.parametrize(
    ("model", "expected"), [(polynomials(5, SECOND, "tangent"), 20.0511), (polynomials(4, FIRST, "tangent"), None)]
)
def test_the_column_of_beck_flutters_with_foreshortening_alone(model: LadderModel, expected: float | None) -> None:
    """The column loses its stability at 20.0509 EI/l^2, where two frequencies meet."""
    made = path(BECK, "P", 0, 40, model)
    assert made.loss == (None if expected is None else pytest.approx(expected, rel=1e-5))
    known = [p.eigenvalues.frequencies for p in made.points if p.eigenvalues is not None and p.value > 22]
    assert all((f[0] == pytest.approx(f[1])) == (expected is not None) for f in known)


def test_a_mass_on_a_rotating_guide_leaves_where_its_spring_yields() -> None:
    """A steady motion that is not the initial state: r = k r0/(k - m w^2), and the frequency is sqrt(k/m - w^2)."""
    scene = derive.scene(
        "slider_on_hub",
        ground={"axis": [0, 0]},
        bodies={
            "hub": {"markers": {"centre": [0, 0]}},
            "bead": {"mass": 2, "inertia": 1, "markers": {"pin": [0, 0]}, "start": {"position": [1, 0]}},
        },
        joints={
            "shaft": {"kind": "revolute", "between": ["ground.axis", "hub.centre"]},
            "guide": {"kind": "translational", "between": ["hub.centre", "bead.pin"]},
        },
        drives={"motor": {"joint": "shaft", "speed": {"symbol": "speed", "default": 3}}},
        springs={"tie": {"kind": "linear", "between": ["hub.centre", "bead.pin"], "stiffness": 50, "rest": 1}},
    )
    native = derive.load_scene(generated(scene)[1], QUICK)
    k = native.setup()
    start = initial_state(scene, native, k)
    steady = steady_motion(native, k, start.q, start.v)
    radius = np.hypot(*native.poses(0.0, steady.q, k)[list(native.bodies).index("bead"), :2])
    assert radius == pytest.approx(50 / (50 - 18), rel=1e-9)
    linear = linearise(native, k, 0.0, steady.q, steady.v, steady.axes)
    assert eigenvalues(linear.A, steady.spin).values.imag.max() == pytest.approx(4, rel=1e-9)  # sqrt(25 - 9)


def whirling(stiffness_y: float) -> tuple[derive.NativeScene, np.ndarray, np.ndarray]:
    """A mass of 2 kg that spins at 3 rad/s on springs of 50 N/m along x, and its state."""
    scene = derive.scene(
        f"whirling_{stiffness_y:g}",
        ground={"axis": [0, 0]},
        bodies={
            "disc": {"mass": 2, "inertia": 1, "markers": {"pin": [0, 0]}, "start": {"position": [0, 0], "spin": 3}}
        },
        springs={
            "tie": {
                "kind": "bushing",
                "between": ["ground.axis", "disc.pin"],
                "stiffness_x": 50,
                "stiffness_y": stiffness_y,
            }
        },
    )
    native = derive.load_scene(generated(scene)[1], QUICK)
    start = initial_state(scene, native)
    return native, start.q, start.v


def test_positions_are_those_in_axes_that_rotate() -> None:
    """A mass at 5 rad/s in space vibrates at 5 - 3 and 5 + 3 rad/s; with two stiffnesses it is not steady."""
    native, q, v = whirling(50)
    steady = steady_motion(native, native.setup(), q, v)
    linear = linearise(native, native.setup(), 0.0, steady.q, steady.v, steady.axes)
    assert eigenvalues(linear.A, steady.spin).frequencies == pytest.approx([2, 8], rel=1e-9)
    native, q, v = whirling(51)
    with pytest.raises(NoSteadyMotion, match="is not the same in axes that move with the scene"):
        steady_motion(native, native.setup(), q, v)


def test_a_fall_is_not_steady() -> None:
    disc = {"mass": 2, "inertia": 1, "markers": {"pin": [0, 0]}, "start": {"position": [0, 0]}}
    scene = derive.scene("falling", gravity=[0, -9.81], bodies={"disc": disc})
    native = derive.load_scene(generated(scene)[1], QUICK)
    start = initial_state(scene, native)
    with pytest.raises(NoSteadyMotion, match="is not steady: the acceleration of disc_c2"):
        steady_motion(native, native.setup(), start.q, start.v)


def test_motions_that_are_not_steady_are_refused() -> None:
    scene = read_scene(SPINNING)
    native = derive.load_scene(generated(scene)[1], QUICK)
    start = initial_state(scene, native)
    with pytest.raises(NoSteadyMotion, match=r"does not find|depends on time or on a direction"):
        steady_motion(native, native.setup(), start.q, start.v)
    bending = start.v.copy()
    bending[-1] = 1.0
    with pytest.raises(NoSteadyMotion, match="alpha2 is not that of a rigid rotation"):
        steady_motion(native, native.setup(), start.q, bending)


def lost_at(model: LadderModel, value: float | None) -> ModelPath:
    """A model that loses its stability at a value, over 0 to 40."""
    if value is None:
        return ModelPath(model, intervals=(Interval(0, 40, True),))
    change = Threshold(value, value, 0, 1)
    return ModelPath(model, 5, thresholds=(change,), intervals=(Interval(0, value, True), Interval(value, 40, False)))


@pytest.mark.long
def test_the_column_of_beck_with_damping_of_the_mass_is_lost_at_the_same_load_in_pieces() -> None:
    """Damping of the deformation makes it flutter at 4.54 N already; it must not depend on the number of pieces."""
    scene = read_scene(BECK)
    rod = scene.bodies[0]
    assert isinstance(rod, BeamBody)
    damped = replace(rod, beam=replace(rod.beam, damping=BeamDamping(mass=Fraction(1, 2))))
    parameter = studied(replace(scene, bodies=(damped,)), ParameterRange("P", 3, 6, 4))
    found = [model_path(parameter, model).loss for model in (polynomials(4, SECOND), polynomials(3, SECOND, pieces=2))]
    assert found == pytest.approx([4.54, 4.54], rel=2e-3)


PENDULUM = """
name = "rod_on_hinge"
scene.gravity = [0, -9.81]
ground.markers = {{ hook = [0, 0] }}
[bodies.rod]
mass = 1
length = 1
bending_stiffness = 100
markers = {{ top = -1, tip = 1 }}
start = {{ position = [{x}, {y}], angle = {angle} }}
[joints.hinge]
kind = "revolute"
between = ["ground.hook", "rod.top"]
[simulation]
duration = 1
output = 0.1
"""


def hanging(tmp_path: Path, angle: float) -> Path:
    """A rod that hangs from a hinge, rotated by an angle from the vertical."""
    file = tmp_path / "rod_on_hinge.toml"
    down = angle - np.pi / 2
    file.write_text(PENDULUM.format(x=np.cos(down) / 2, y=np.sin(down) / 2, angle=down))
    return file


@pytest.mark.long
def test_an_equilibrium_is_sought_near_the_initial_state_and_then_from_value_to_value(tmp_path: Path) -> None:
    """A rod that hangs: sqrt(3 g/(2 l)); the mass is a parameter of flexible beams, and a number of rigid ones.

    From 1.2 rad Newton's method would come to the rod that stands.
    """
    made = path(hanging(tmp_path, 0.3), "bodies.rod.mass", 1, 2, polynomials(2, FIRST))
    assert made.thresholds == () and made.unit == "kg"
    for point in made.points:
        assert point.eigenvalues is not None
        assert point.eigenvalues.frequencies[0] == pytest.approx(np.sqrt(1.5 * 9.81), rel=1e-3)
    for angle, name, model, reason in (
        (1.2, "bodies.rod.mass", polynomials(2, FIRST), "far from the initial state: rod_phi differs by 1.9 rad"),
        (0.3, "bodies.rod.mass", LadderModel(Shapes.RIGID), "this model has numbers in place of the parameter"),
    ):
        scene = read_scene(hanging(tmp_path, angle))
        assert reason in model_path(studied(scene, ParameterRange(name, 1, 2, 3)), model).failure
    rigid = path(hanging(tmp_path, 0.3), "bodies.rod.bending_stiffness", 1, 2, LadderModel(Shapes.RIGID))
    assert rigid.coordinates == 1 and not rigid.failure
