"""Stability of models: each model's own threshold, by the eigenvalues of its generated Jacobians, beside the truth."""

from __future__ import annotations

import csv
import json
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

import derive
from conftest import QUICK, ROOT
from derive.cli.main import main
from derive.cli.specifications import read_scene
from derive.generated_models import generated
from derive.simulation.errors import SimulationError
from derive.simulation.initial.initial_state import initial_state
from derive.simulation.linear.linearisation import linearise
from derive.simulation.linear.settled_functions import settled_functions
from derive.simulation.linear.steady_motion import NoSteadyMotion, steady_motion
from derive.spec.model.beam_parts import BeamDamping
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.planar_bodies import BeamBody
from derive.spec.model.scene import Scene
from derive.spec.model.time_function import depends_on_time, value_at
from derive.spec.set_values import with_values
from derive.spec.toml.read import parse
from derive.study.accuracy.ladder_model import LadderModel, Shapes
from derive.study.stability.chart import _description, frequency_line, growth_line
from derive.study.stability.eigenvalues import Eigenvalues, eigenvalues
from derive.study.stability.ladder_stability import KnownLoss, LadderStability, distance, study_stability
from derive.study.stability.model_path import ModelPath, PathPoint, model_path
from derive.study.stability.parameter import ParameterRange, studied
from derive.study.stability.table import gap_sentences, stability_data, stability_text
from derive.study.stability.thresholds import Interval, Threshold, intervals, loss, thresholds, wrong_intervals

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


def state_space(stiffness: Sequence[float], coupling: float = 0.0) -> np.ndarray:
    """Two displacements with a stiffness over the mass each, and a gyroscopic coupling."""
    A = np.zeros((4, 4))
    A[:2, 2:] = np.eye(2)
    A[2:, :2] = -np.diag(stiffness)
    A[2, 3], A[3, 2] = coupling, -coupling
    return A


def test_rounding_errors_do_not_grow() -> None:
    """The stiffness is zero: a double eigenvalue is split by their root; a true negative one grows."""
    assert eigenvalues(state_space([-1e-8, 1e6])).growing == 0
    assert eigenvalues(state_space([-1e-4, 1e6])).growing == 1
    assert eigenvalues(state_space([-1e-4, 1e6])).growth == pytest.approx(1e-2)
    assert eigenvalues(np.zeros((0, 0))).growing == 0
    free = state_space([-9.0, -9.0], 6.0)  # a free mass in axes that rotate at 3
    assert eigenvalues(free).growing == 0
    assert eigenvalues(free, spin=3.0).frequencies.size == 0
    assert eigenvalues(state_space([4, 9]), spin=3.0).frequencies == pytest.approx([2])


def counted(changes: Sequence[float]) -> tuple[list[float], list[int | None], tuple[Threshold, ...]]:
    """A count that changes by one at each value, over 0, 1, ..., 4; there is none above 3.5."""

    def count(x: float) -> int | None:
        return None if x > 3.5 else sum(x > c for c in changes) % 3

    values = [float(n) for n in range(5)]
    counts = [count(x) for x in values]
    return values, counts, thresholds(count, values, counts)


def test_frequencies_in_rotating_axes_are_those_of_modes_that_vibrate() -> None:
    """A mode that decays at once turns there at about the spin; a whirl near the critical speed is slow."""
    values = np.array([-500 + 9j, -0.3 + 0.2j, 20j, 3, -3], dtype=complex)
    made = Eigenvalues(values, np.full(len(values), 1e-9), spin=10.0)
    assert made.frequencies == pytest.approx([0.2, 20]) and made.diverging == 1


def test_two_equal_real_eigenvalues_are_two_growing_modes() -> None:
    """Of a symmetric shaft, which rounding makes a conjugate pair."""
    A = state_space([-4, -4])
    A[2, 1], A[3, 0] = 1e-13, -1e-13
    assert eigenvalues(A).growing == 2


def test_all_thresholds_between_two_values_are_bracketed() -> None:
    values, counts, found = counted([0.3, 0.4, 2.5])
    assert [c.value for c in found] == pytest.approx([0.3, 0.4, 2.5], rel=1e-6)
    assert [(c.before, c.after) for c in found] == [(0, 1), (1, 2), (2, 0)]
    known = intervals(values, counts, found)
    assert [i.stable for i in known] == [True, False, True, None]
    assert [i.low for i in known] == pytest.approx([0, 0.3, 2.5, 3]) and known[-1].high == 4
    assert loss(known) == pytest.approx(0.3)
    assert loss(known[1:]) is None


def test_numbers_that_keep_changing_are_given_up() -> None:
    calls: list[float] = []

    def count(x: float) -> int:
        calls.append(x)
        return int(x * 2**16) % 5

    assert thresholds(count, [0.0, 3.3], [0, 1])
    assert len(calls) == 200


def test_a_wrong_verdict_is_stable_where_the_truth_is_not_and_vice_versa() -> None:
    truth = (Interval(0, 2, True), Interval(2, 4, False))
    late = (Interval(0, 3, True), Interval(3, 4, False))
    early = (Interval(0, 1, True), Interval(1, 3.5, False), Interval(3.5, 4, None))
    assert wrong_intervals(late, truth) == (Interval(2, 3, True),)
    assert wrong_intervals(early, truth) == (Interval(1, 2, False),)
    assert wrong_intervals(truth, truth) == ()
    assert wrong_intervals(late, truth, least=1.0) == ()  # within the error of the truth
    of = LadderStability(
        "made",
        ParameterRange("P", 0, 4, 5),
        (),
        ModelPath(LadderModel(Shapes.RIGID)),
        ModelPath(LadderModel(Shapes.RIGID)),
    )
    for known, expected in (
        (2.0, truth),
        (None, (Interval(0, 4, True),)),
        (9.0, (Interval(0, 4, True),)),
        (-1.0, (Interval(0, 4, False),)),
    ):
        assert LadderStability(of.name, of.range, (), of.reference, of.before, KnownLoss(known)).truth == expected
    assert distance(3, 2) == 0.5 and distance(None, 2) is None and distance(3, 0.0) is None


def lost_at(model: LadderModel, value: float | None) -> ModelPath:
    """A model that loses its stability at a value, over 0 to 40."""
    if value is None:
        return ModelPath(model, intervals=(Interval(0, 40, True),))
    change = Threshold(value, value, 0, 1)
    return ModelPath(model, 5, thresholds=(change,), intervals=(Interval(0, value, True), Interval(value, 40, False)))


@pytest.mark.parametrize(
    ("before", "reference", "why"),
    [
        (22.0, 20.0, "differs over more than 5 % of a threshold"),
        (None, 20.0, "2 beams, P2, P3, truncated keeps its stability"),
        (20.0, None, "2 beams, P2, P3, truncated loses it at 20"),
    ],
)
def test_without_a_converged_reference_verdicts_are_undecided(
    before: float | None, reference: float | None, why: str
) -> None:
    limits, models = ParameterRange("P", 0, 40, 5), (polynomials(2, SECOND, pieces=2), polynomials(4, SECOND, pieces=3))
    paths = lost_at(polynomials(2, FIRST), None), lost_at(polynomials(2, SECOND), 10.0)
    of = LadderStability("made", limits, paths, lost_at(models[1], reference), lost_at(models[0], before))
    assert not of.converged and not any(of.wrong(path) for path in paths)
    text = " ".join(stability_text(of).split())
    assert "the reference has not converged: " in text and why in text
    assert text.count("undecided") == len(paths) + 1 and "stable from" not in text
    data = stability_data(of)
    assert not data["reference"]["converged"] and [model["wrong"] for model in data["models"]] == [None] * 3
    assert "wrong somewhere" not in _description(of)
    given = LadderStability("made", limits, paths, of.reference, of.before, KnownLoss(20.0))
    assert given.converged and given.wrong(paths[1]) == (Interval(10.0, 20.0, False),)


def test_a_reference_without_steady_motion_at_some_values_has_not_converged_for_that_reason() -> None:
    limits, models = ParameterRange("P", 0, 40, 5), (polynomials(2, SECOND, pieces=2), polynomials(4, SECOND, pieces=3))
    gap = replace(lost_at(models[1], None), points=(PathPoint(40.0, None, failure="it is far away"),))
    text = " ".join(stability_text(LadderStability("made", limits, (), gap, lost_at(models[0], None))).split())
    assert "which keeps its stability where it moves steadily" in text
    assert "has not converged: no steady motion is known at some values of 3 beams, P2 to P5, truncated" in text


def test_with_a_converged_reference_verdicts_are_given() -> None:
    limits, models = ParameterRange("P", 0, 40, 5), (polynomials(2, SECOND, pieces=2), polynomials(4, SECOND, pieces=3))
    of = LadderStability("made", limits, (), lost_at(models[1], 20.0), lost_at(models[0], 20.5))
    assert of.converged and of.wrong(lost_at(polynomials(2, FIRST), None)) == (Interval(20.0, 40, True),)
    assert of.wrong(lost_at(polynomials(2, FIRST), 19.6)) == ()  # within the error of the reference


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


def test_lines_of_the_picture_keep_to_their_modes() -> None:
    """The lowest frequency ends where its mode begins to grow, and the second one goes on."""
    values = [np.array(x, dtype=complex) for x in ([2j, 5j], [1j, 6j], [1.5, -1.5, 7j])]
    points = tuple(PathPoint(float(n), Eigenvalues(v, np.full(len(v), 1e-9))) for n, v in enumerate(values))
    change = Threshold(1.2, 1.2, 0, 1)
    made = ModelPath(polynomials(2, FIRST), points=points, thresholds=(change,))
    assert frequency_line(made, 0) == ([0, 1], [2, 1])
    assert frequency_line(made, 1) == ([0, 1, 2], [5, 6, 7])
    assert frequency_line(made, 2) == ([], [])
    assert growth_line(made) == ([0, 1, 1.2, 2], [0, 0, 0, 1.5])


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


@pytest.fixture
def coarse_reference(monkeypatch: pytest.MonkeyPatch) -> None:
    """A reference that is quick to derive, and good to 0.06 %."""
    models = (polynomials(2, SECOND, pieces=2), polynomials(4, SECOND))
    monkeypatch.setattr("derive.study.stability.ladder_stability.refinements", lambda _: models)


def test_keys_that_are_no_parameters_are_refused_with_what_to_name() -> None:
    with pytest.raises(derive.SpecError, match="nor an initial value; name a mass, a stiffness"):
        studied(read_scene(COLUMN), ParameterRange("simulation.tolerance", 1e-8, 1e-7, 3))


@pytest.mark.long
@pytest.mark.usefixtures("coarse_reference")
def test_the_command_marks_wrong_verdicts(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    asked = ["study", "stability", str(COLUMN), "--parameter", "P=0:30:16", "--orders", "first", "--shapes", "2"]
    asked += ["--pieces", "2", "--sines", "1", "--out", str(tmp_path)]
    assert main([*asked, "--exact", "9.8696044", "--json"]) == 0
    said = capsys.readouterr()
    assert "loses its stability at" in said.err
    data = json.loads(said.out)
    models = {model["model"]: model for model in data["models"]}
    never = [name for name, model in models.items() if model["loss"] is None]
    assert never == ["rigid", "1 sine, first", "1 beam, P2, P3, first"]
    for name in never:
        assert models[name]["wrong"] == [{"from": 9.8696044, "to": 30.0, "stable": True}]
    late = models["2 beams, P2, P3, first"]
    assert late["distance_to_exact"] == pytest.approx(0.21888, abs=1e-5)
    assert late["wrong"] == [{"from": 9.8696044, "to": late["loss"], "stable": True}]
    assert data["reference"]["model"] == "1 beam, P2 to P5, truncated"
    assert data["reference"]["loss"] == pytest.approx(1.00056 * EULER, rel=1e-5)
    assert data["reference"]["error"] == pytest.approx((1.00752 - 1.00056) * EULER, rel=1e-2)
    assert [Path(name).name for name in data["files"]] == ["stability.svg", "stability.csv", "stability.json"]
    rows = list(csv.DictReader((tmp_path / "stability.csv").read_text().splitlines()))
    growing = {row["model"] for row in rows if row["grows"] == "True"}
    assert growing == {"2 beams, P2, P3, first", "1 beam, P2 to P5, truncated"}
    at_rest = [row for row in rows if row["model"] == "1 beam, P2, P3, first" and float(row["parameter"]) == 0]
    assert min(float(row["frequency_rad_s"]) for row in at_rest) == pytest.approx(np.sqrt(120), rel=1e-6)
    svg = (tmp_path / "stability.svg").read_text()
    assert (
        svg.count("wrong: stable</text>") == 3
        and "truth: given" in svg
        and "http" not in svg.replace("http://www.w3.org", "")
    )
    assert "<title>2 beams, P2, P3, first, 11 coordinates\n0 -&gt; 1 growing modes at 12.02985" in svg
    assert main(asked) == 0  # over its own files, and with the richest model as the truth
    text = capsys.readouterr().out
    assert "2 beams, P2, P3, truncated differs by 6.9e-02" in " ".join(text.split())
    assert any(line.split()[-5:] == ["stable", "from", "9.875098", "to", "30"] for line in text.splitlines())
    assert (tmp_path / "stability.svg").read_text() != svg


def test_after_three_models_without_steady_motion_no_other_is_compiled(monkeypatch: pytest.MonkeyPatch) -> None:
    tried = []

    def falling(_: object, model: LadderModel) -> ModelPath:
        tried.append(model)
        return ModelPath(model, coordinates=len(tried) - 1, failure="it falls")  # the first has no motion of its own

    monkeypatch.setattr("derive.study.stability.ladder_stability.model_path", falling)
    pushed, _ = with_values(read_scene(SPINNING), {"forces.knock.components": "[0, 1]"})
    with pytest.raises(
        SimulationError, match=r"no model has a steady motion:\n  it falls\n7 finer models of the ladder"
    ):
        study_stability(pushed, (SPIN, 0, 40, 3))
    assert len(tried) == 4 and tried[0].shapes is Shapes.RIGID


def test_a_reason_that_models_share_is_said_once_and_advice_behind_them(monkeypatch: pytest.MonkeyPatch) -> None:
    """Reasons differ by amounts, such as that of the rigid model; the advice on them is the same."""
    told: list[str] = []

    def falling(_: object, model: LadderModel) -> ModelPath:
        reason = f"it falls by {1 if model.shapes is Shapes.RIGID else 2} m/s"
        return ModelPath(model, coordinates=1, failure=reason, advice="hold it")

    monkeypatch.setattr("derive.study.stability.ladder_stability.model_path", falling)
    pushed, _ = with_values(read_scene(SPINNING), {"forces.knock.components": "[0, 1]"})
    message = r"steady motion:\n  it falls by 1 m/s\n  it falls by 2 m/s\nadvice: hold it\n8 finer models"
    with pytest.raises(SimulationError, match=message):
        study_stability(pushed, (SPIN, 0, 40, 3), progress=told.append)
    assert [" ".join(told).count(f"it falls by {i} m/s") for i in (1, 2)] == [1, 1]
    assert "it fails as 1 sine, first does" in told[-1]


def test_models_with_the_same_gaps_share_a_sentence() -> None:
    at = PathPoint(40.0, None, failure="it is far away", advice="start nearer")
    paths = [replace(lost_at(polynomials(n, FIRST), None), points=(at,)) for n in (2, 3)]
    of = LadderStability("rod", ParameterRange("P", 1, 2, 3), tuple(paths), paths[1], paths[0])
    both = "; ".join(path.model.label for path in paths)
    assert gap_sentences(of) == [f"{both}: no steady motion at 40: it is far away", "advice: start nearer"]
    told = [model["without_steady_motion"] for model in stability_data(of)["models"]]
    assert told == [[{"value": 40.0, "reason": "it is far away; start nearer"}]] * 2


def test_where_a_model_has_no_steady_motion_it_says_so(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    models = (LadderModel(Shapes.RIGID), polynomials(2, FIRST))
    monkeypatch.setattr("derive.study.stability.ladder_stability.refinements", lambda _: models)
    asked = ["--orders", "first", "--shapes", "2", "--pieces", "1", "--sines", "1", "--out", str(tmp_path)]
    assert main(["study", "stability", str(SPINNING), "--parameter", f"{SPIN}=0:40:3", *asked]) == 2
    assert "these functions of time never come to rest: forces.knock.components;" in capsys.readouterr().err
    pushed = ["--set", "forces.knock.components=[0, 1]"]
    assert main(["study", "stability", str(SPINNING), "--parameter", f"{SPIN}=0:40:3", *asked, *pushed]) == 2
    assert "no model has a steady motion" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


RAMPS = {
    "speed": 'speed = "Omega*step(t, 0, 0.3)"',
    "motion": 'motion = "Omega*piecewise(t < 0.3, 0.3*((t/0.3)^6 - 3*(t/0.3)^5 + 2.5*(t/0.3)^4), t - 0.15)"',
    "table": 'speed = "Omega*ramp(t)"',
    "constant": 'speed = "Omega"',
}


def driven(drive: str, parameter: str, more: str = "") -> str:
    """The rotating cantilever with another drive."""
    text = CANTILEVER.read_text()
    constant = next(line for line in text.splitlines() if line.startswith("speed ="))
    return f"{text.replace(constant, drive)}\n[parameters]\n{parameter} = {{ default = 0.4 }}\n{more}"


@pytest.mark.parametrize(
    "ramp", ["speed", *(pytest.param(of, marks=pytest.mark.long) for of in RAMPS if of != "speed")]
)
def test_a_ramp_is_linearised_about_the_steady_motion_that_it_leads_to(tmp_path: Path, ramp: str) -> None:
    (tmp_path / "ramp.csv").write_text("t,w\n0,0\n0.1,0.3\n1,1\n")
    table = '[tables]\nramp = { file = "ramp.csv", x = "t", y = "w" }\n' if ramp == "table" else ""
    scene = parse(driven(RAMPS[ramp], "Omega", table), str(tmp_path / "ramp.toml"))
    assert isinstance(scene, Scene)
    parameter = studied(scene, ParameterRange("Omega", 0, 10, 3))
    made = model_path(parameter, polynomials(2, FIRST, "tangent"))
    assert made.loss == pytest.approx(3.532732, rel=1e-6)
    assert [point.eigenvalues.spin for point in made.points if point.eigenvalues] == pytest.approx([0, 5, 10])
    if ramp == "constant":
        assert parameter.motion.endswith("at each value, in axes that rotate along")
    else:
        key, time = "motion" if ramp == "motion" else "speed", 1 if ramp == "table" else 0.3
        text = f"with drives.motor.{key} as from t = {time:g} s on, when nothing changes any more"
        assert parameter.motion.endswith(text)


def test_loads_and_inputs_that_come_to_rest_have_their_last_values() -> None:
    """Euler's load of a column, applied smoothly, as a function and as an input."""
    text, losses = COLUMN.read_text(), []
    for load in ('["-P", 0]', '["-P*step(t, 0, 0.5)", 0]', '[{ input = "press" }, 0]'):
        press = '[inputs.press]\nvalue = "-P*step(t, 0, 0.5)"\n' if "input" in load else ""
        scene = parse(text.replace('["-P", 0]', load) + press)
        assert isinstance(scene, Scene)
        losses.append(model_path(studied(scene, ParameterRange("P", 0, 30, 4)), polynomials(1, SECOND)).loss)
    assert losses[0] is not None and EULER < losses[0] < 1.3 * EULER
    assert losses[1:] == pytest.approx([losses[0]] * 2, rel=1e-9)


def test_a_drive_that_stops_stays_where_it_is() -> None:
    scene = parse(driven('motion = "turn*step(t, 0, 0.3)"', "turn"))
    assert isinstance(scene, Scene)
    functions = settled_functions([scene, scene])
    (drive,) = functions.scene(scene).drives
    assert functions.settled == ("drives.motor.motion",) and functions.stopping == {"motor"}
    assert drive.motion is not None and not depends_on_time(drive.motion)
    assert value_at(drive.motion, 0.0) == 0.4


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        (["--parameter", "Q=0:3:4"], '--parameter: "Q" is no parameter and no key'),
        (["--parameter", "P=3:0:4"], "A is less than B"),
        (["--parameter", "P=0:3:1"], "N is between 2 and 10000"),
        (["--parameter", "bodies.rod.markers.left=-1:-0.9:3"], "neither a number that can be a run-time parameter nor"),
        (["--parameter", "P"], "expected NAME=A:B:N"),
        (["--parameter", "bodies.rod.order=1:2:2"], "bodies.rod.order"),
        (["--parameter", "simulation.duration=1:2:2", "--exact", "x"], "expected a number, or none"),
        (["--parameter", "P=0:3:4", "--set", "P=1", "--set", "P=2"], "P has several values"),
        (["--parameter", "P=0:3:4", "--out", f"{COLUMN}/x"], "this is a file, not a folder"),
    ],
)
def test_wrong_arguments(asked: list[str], message: str, capsys: pytest.CaptureFixture[str]) -> None:
    try:
        code = main(["study", "stability", str(COLUMN), *asked])
    except SystemExit as stopped:
        code = int(str(stopped.code))
    assert code == 2 and message in capsys.readouterr().err
