"""Runs warn where the model of a beam is not valid, with cause, error and remedy; otherwise they are silent."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import derive
from conftest import ROOT
from derive.mechanics.multibody.outputs.registry import MONITORS, OUTPUTS
from derive.simulation.trajectory import Trajectory
from derive.simulation.validity.implied_errors import ImpliedErrors
from derive.simulation.validity.lost_inertia import lost_inertia
from derive.simulation.validity.measure import validity
from derive.simulation.validity.monitoring_outputs import MOST_PIECES, monitored_pieces, with_monitors
from derive.simulation.validity.monitors import ERROR_LIMIT, Cause, Monitor
from derive.simulation.validity.watched_beam import scene_watch
from derive.spec.model.body import DisplacementOrder
from derive.spec.model.planar_bodies import BeamBody
from derive.spec.model.ports import SceneOutput
from derive.spec.model.scene import Scene
from derive.spec.toml.read import parse
from explicit_motion import moved

SCENES = ROOT / "scenes"

COLUMN = """
name = "column"

[ground.markers]
foot = [0, 0]

[bodies.rod]
ansatz = ["1", "xi", "xi^2", "xi^3"]
frame = "mean"
mass = 1
length = 2
bending_stiffness = 4
markers = { left = -1, right = 1 }

[bodies.head]
mass = 0.01
inertia = 1e-4
markers = { pin = [0, 0] }
start = { position = [2, 0] }

[joints.foot]
kind = "revolute"
between = ["ground.foot", "rod.left"]

[joints.top]
kind = "revolute"
between = ["rod.right", "head.pin"]

[joints.guide]
kind = "translational"
between = ["ground.foot", "head.pin"]
axis = [1, 0]

[forces.load]
at = "head.pin"
components = [LOAD, 0]

[simulation]
duration = 0.02
output = 0.01
"""


def changed(name: str, *changes: tuple[str, str]) -> Scene:
    """A scene of the project without its plots, with other text in some places."""
    text = (SCENES / f"{name}.toml").read_text()
    for old, new in changes:
        assert re.search(old, text)
        text = re.sub(old, new, text)
    return parse(text.split("[plots")[0])


def run(scene: Scene, duration: float, output: float) -> Trajectory:
    return moved(scene, duration=duration, output=output)


def monitor(trajectory: Trajectory, cause: Cause, beam: str = "") -> Monitor:
    return next(m for m in trajectory.validity if m.cause is cause and m.beam.startswith(beam))


def spinning(spin: float) -> Trajectory:
    return run(changed("spinning_beam", ("spin = 25", f"spin = {spin}")), 0.02, 0.01)


def rod(pieces: int, *, highest: int = 3, second_order: bool = False) -> Trajectory:
    """Set A, up to the first maxima of its deflection."""
    ansatz = ", ".join(f'"xi^{n}"' for n in range(highest + 1))
    order = 'frame = "mean"\norder = 2' if second_order else 'frame = "mean"'
    changes = (
        ("pieces = 3", f"pieces = {pieces}"),
        (r"ansatz = \[.*\]", f"ansatz = [{ansatz}]"),
        ('frame = "mean"', order),
    )
    return run(changed("crank_slider_3", *changes), 0.02, 2e-4)


def cantilever(order: int) -> Trajectory:
    """Spun up, until it has half of its final speed; to first order its error is 25 % rms by then."""
    return run(
        changed(
            "spun_up_cantilever",
            ("mass = 12", f"mass = 12\norder = {order}" + ('\nterms = "truncated"' if order == 2 else "")),
        ),
        7.0,
        0.1,
    )


def struck(rate: float, duration: float = 0.6) -> Trajectory:
    """A free beam of second order with the deflection rates of P2; 0.6 s are two periods."""
    start = {"deflection_rate": f"{rate}*(3/2*xi^2 - 1/2)"}
    shapes = ["1", "xi", "xi^2", "xi^4", "xi^6"]
    beam = {"ansatz": shapes, "frame": "mean", "order": 2, "mass": 1, "length": 1, "bending_stiffness": 1}
    scene = derive.scene("struck", bodies={"rod": {**beam, "start": start, "markers": {"left": -1}}})
    return run(scene, duration, duration / 20)


def column(load: float) -> Trajectory:
    return moved(parse(COLUMN.replace("LOAD", str(load))))


# ---- warnings ----


def test_a_spin_beyond_the_stability_of_first_order_warns_while_the_deflection_is_small() -> None:
    trajectory = spinning(28)
    assert monitor(trajectory, Cause.DEFLECTION).value < 1e-3
    axial = monitor(trajectory, Cause.AXIAL_FORCE)
    # what second order adds: (m/5)(alpha1'' + 2 w^2 alpha1) in place of (m/5)(alpha1'' - w^2 alpha1), of K = 144
    assert axial.value == pytest.approx(3 * 28**2 / 720, rel=1e-4)
    assert axial.warning in trajectory.warnings and axial.error > 1
    assert "changes its bending stiffness by 327 %" in axial.warning and "the limit" in axial.warning
    assert "an error of 100 % or more" in axial.warning and "choose order = 2" in axial.warning


def test_a_column_at_three_euler_loads_warns() -> None:
    trajectory = column(-3 * np.pi**2)
    (warning,) = trajectory.warnings
    axial = monitor(trajectory, Cause.AXIAL_FORCE)
    assert axial.value == axial.error == pytest.approx(3 * np.pi**2 / 12, rel=1e-6)  # P2 buckles at 12
    assert "its axial force changes its bending stiffness by 247 %" in warning


def test_the_published_rod_in_one_beam_warns_of_its_axial_force() -> None:
    trajectory = rod(1, highest=4)
    (warning,) = trajectory.warnings
    assert "rod in 1 beam: its axial force changes its bending stiffness by 23 %" in warning
    assert "divide the beam into more pieces" in warning


def test_second_order_does_not_rescue_two_shapes_between_pins_and_warns() -> None:
    trajectory = run(rod(1, second_order=True).scene, 0.1, 2e-4)
    (warning,) = trajectory.warnings
    mismatch = monitor(trajectory, Cause.BENDING_MOMENT)
    assert mismatch.value > 0.95 and mismatch.error == pytest.approx(0.218, rel=0.5)  # measured: 21.8 % rms
    assert warning == mismatch.warning and "add a shape" in warning


def test_a_cantilever_warns_before_its_stiffness_is_lost() -> None:
    trajectory = cantilever(1)
    axial = monitor(trajectory, Cause.AXIAL_FORCE)
    assert axial.error == pytest.approx(0.25, rel=0.5)
    assert axial.warning in trajectory.warnings


def test_the_inertia_that_a_truncated_beam_loses_implies_an_error_without_bound() -> None:
    """The thrown beam loses half of its inertia at 0.3 s; against terms = "full" it is 0.04 % off."""
    text = (Path(__file__).parent / "test_definiteness.py").read_text()
    thrown = text.split('THROWN = """')[1].split('"""')[0].replace("TERMS", "truncated")
    assert monitor(run(parse(thrown), 0.05, 0.01), Cause.MASS_MATRIX).value < 0.01
    trajectory = run(parse(thrown), 0.3, 0.01)
    assert not trajectory.warnings and monitor(trajectory, Cause.MASS_MATRIX).value == pytest.approx(0.545, abs=0.01)
    motion = trajectory.motion
    scene = scene_watch(motion.scene, motion.native, motion.k, 0.0, motion.q[0], motion.v[0])
    seen = scene.of_rows(motion.t, motion.q, motion.v)
    errors, known = ImpliedErrors(scene.beams[0], seen), lost_inertia(scene, scene.beams[0], seen)
    assert not errors.of_lost_inertia(known) > ERROR_LIMIT
    assert monitor(trajectory, Cause.MASS_MATRIX).error == pytest.approx(0.0009, rel=0.1)
    assert all(errors.of_lost_inertia(replace(known, largest=lost)) == np.inf for lost in (1.0, np.nan))
    lost = replace(monitor(trajectory, Cause.MASS_MATRIX), error=np.inf)
    assert lost.passed and "100 % or more" in lost.warning and 'terms = "full"' in lost.warning


def test_two_shapes_between_pins_warn_at_first_order() -> None:
    """Measured: 39 % rms in the deflection of the coupler with P2, P3, and 5.4 % with P4."""
    trajectory = run(changed("four_bar"), 1.1, 0.01)
    of_coupler = monitor(trajectory, Cause.BENDING_MOMENT, "coupler")
    assert of_coupler.error == pytest.approx(0.39, rel=0.5)
    assert all("miss the bending moment" in warning for warning in trajectory.warnings)


def test_sine_waves_warn_at_a_clamped_end() -> None:
    """Which they cannot represent: measured 35 % rms in the tip, to second order."""
    sines = (r"ansatz = \[.*\]", 'ansatz = { kind = "pinned", count = 2 }')
    chord = ("frame = {.*}", 'frame = "chord"')
    slow = ("mass = 12", 'mass = 12\norder = 2\nterms = "truncated"')
    trajectory = run(changed("spun_up_cantilever", sines, chord, slow), 7.0, 0.1)
    assert monitor(trajectory, Cause.BENDING_MOMENT).value > 1
    (warning,) = trajectory.warnings
    assert "choose shapes that fit its ends" in warning


@pytest.mark.parametrize(("rate", "error"), [(1.4, 0.059), pytest.param(1.95, 0.11, marks=pytest.mark.long)])
def test_a_struck_beam_that_bends_far_warns(rate: float, error: float) -> None:
    """The errors are those of P2 to P7 against a geometrically exact rod; of them P2, P4 and P6 move."""
    warning, *others = struck(rate).warnings
    bent, truncated = (monitor(struck(rate), cause) for cause in (Cause.DEFLECTION, Cause.MASS_MATRIX))
    assert bent.warning == warning and "it bends by" in warning and "into more pieces" in warning
    assert error / 2 < bent.error < 2 * error
    assert others in ([], [truncated.warning]) and error / 2 < truncated.error < 2 * error


def test_the_error_of_a_vibration_grows_with_the_time() -> None:
    """The figures of docs/monitors.md: 0.8 % after two periods where it bends by 0.03, and twice as much after four."""
    after_two, after_four = (monitor(struck(0.466, duration), Cause.DEFLECTION) for duration in (0.6, 1.2))
    assert after_two.value == pytest.approx(0.03, rel=0.02)
    assert after_two.error == pytest.approx(0.0076, rel=0.03)
    assert after_four.error == pytest.approx(2 * after_two.error, rel=0.1)


def test_modes_of_a_free_beam_warn_of_a_blow_in_its_middle() -> None:
    """Its moment has an angle there, which they miss; they miss nothing at the ends. The truth is 48 %."""
    modes = (r"ansatz = \[.*\]", 'ansatz = { kind = "free-free", count = 2 }')
    trajectory = run(changed("spinning_beam", ("spin = 25", "spin = 2"), modes), 0.02, 0.01)
    missed = monitor(trajectory, Cause.BENDING_MOMENT)
    assert missed.value > 0.2 and 0.12 < missed.error < 0.96
    assert len(trajectory.warnings) == 1


@cache
def pushed(highest: int, pieces: int) -> Trajectory:
    """A rod between two pins that is pushed near one end from t = 0 on, so that all its modes vibrate."""
    markers = ", ".join(f"at{i} = {xi}" for i, xi in enumerate(PLACES))
    deflections = (
        f'[outputs.bent{i}]\nkind = "deflection"\nmarker = "rod.at{i}"\nchord = ["rod.left", "rod.right"]\n'
        for i in range(len(PLACES))
    )
    text = COLUMN.replace("LOAD", "0").replace("duration = 0.02", "duration = 2")
    text = text.replace('"1", "xi", "xi^2", "xi^3"', ", ".join(f'"xi^{n}"' for n in range(highest + 1)))
    text = text.replace("left = -1, right = 1", f"left = -1, right = 1, {markers}")
    text = text.replace("bending_stiffness = 4\n", f"bending_stiffness = 4\npieces = {pieces}\n")
    return moved(parse(f'{text}\n[forces.push]\nat = "rod.at0"\ncomponents = [0, 0.01]\n{"".join(deflections)}'))


PLACES = (-0.8, -0.4, 0.1, 0.5, 0.8)


@pytest.mark.long
@pytest.mark.parametrize(
    ("highest", "pieces"),
    [(4, 1), *(pytest.param(*case, marks=pytest.mark.long) for case in ((3, 1), (3, 2)))],
)
def test_each_vibration_is_late_by_its_own_missed_energy(highest: int, pieces: int) -> None:
    """Most of the strain energy is in the slowest vibration, which is right; the faster ones lose their phase."""
    exact, trajectory = pushed(4, 4), pushed(highest, pieces)
    bent, truth = (np.array([of[f"bent{i}"] for i in range(len(PLACES))]) for of in (trajectory, exact))
    error = np.sqrt(np.mean((bent - truth) ** 2, axis=1)).max() / np.abs(truth).max()
    assert 0.5 < monitor(trajectory, Cause.BENDING_MOMENT, "rod").error / error < 2


# ---- no false alarm ----


def test_a_column_far_from_buckling_is_silent() -> None:
    assert not column(-0.2).warnings


@pytest.mark.long
def test_the_published_rod_is_silent_in_three_beams_and_at_second_order() -> None:
    assert not rod(3).warnings
    accurate = rod(1, highest=4, second_order=True)
    assert not accurate.warnings
    assert monitor(accurate, Cause.AXIAL_FORCE).value > 0.2  # which second order knows


def test_the_cantilever_of_second_order_is_silent() -> None:
    assert not cantilever(2).warnings


def test_small_deflections_of_a_struck_beam_are_silent() -> None:
    assert not struck(0.3).warnings


@pytest.mark.parametrize(
    ("frame", "model", "error"),
    [
        ('{ kind = "tangent", at = -1 }', 'order = 2\nterms = "truncated"', 0.015),
        ('"mean"', "pieces = 2", 0.038),
        pytest.param('"mean"', "pieces = 3", 0.017, marks=pytest.mark.long),
    ],
)
def test_a_spin_up_is_silent_with_two_shapes_where_its_error_is_small(frame: str, model: str, error: float) -> None:
    """The errors of pieces against the file of the scene are in `docs/monitors.md`.

    That of second order is the largest along the beam, in the middle, against full terms and P2 to P5; the file has the
    tip alone, which is wrong by 0.6 %.
    """
    shapes = (r"ansatz = \[.*\]", 'ansatz = ["1", "xi", "xi^2", "xi^3"]')
    scene = changed(
        "spun_up_cantilever", shapes, ("frame = {.*}", f"frame = {frame}"), ("mass = 12", f"{model}\nmass = 12")
    )
    trajectory = run(scene, 9.0, 0.1)
    assert not trajectory.warnings
    assert error / 2 < max(m.error for m in trajectory.validity) < 2 * error


@pytest.mark.long
def test_a_four_bar_linkage_with_enough_shapes_is_silent() -> None:
    shapes = ("\nmass = ", '\nansatz = ["1", "xi", "xi^2", "xi^3", "xi^4", "xi^5"]\norder = 2\nmass = ')
    trajectory = run(changed("four_bar", shapes), 0.6, 0.01)
    assert not trajectory.warnings and {m.beam for m in trajectory.validity} == {"crank", "coupler", "rocker"}


# ---- what the monitors cost and change ----


def test_monitors_do_not_show_in_the_columns_and_take_no_name() -> None:
    scene = changed("spinning_beam")
    own = SceneOutput("axial_load_beam", "energy")
    trajectory = run(replace(scene, outputs=(own,)), 0.01, 0.01)
    assert [name for name in trajectory.columns if "axial" in name] == [o.name for o in trajectory.model.outputs]
    assert monitored_pieces(trajectory.scene)[0].outputs[0].name == "axial_load_beam_"
    assert monitor(trajectory, Cause.AXIAL_FORCE).value > 1


def test_a_scene_without_beams_is_compiled_as_it_is() -> None:
    scene = changed("four_bar")
    rigid = replace(scene, bodies=tuple(b for b in scene.bodies if not isinstance(b, BeamBody)))
    assert with_monitors(rigid) == rigid != with_monitors(scene)


def test_of_many_pieces_some_are_watched_with_both_ends() -> None:
    scene = changed("crank_slider_3", ("pieces = 3", "pieces = 12"))
    pieces = [m.piece for m in monitored_pieces(scene)]
    assert len(pieces) == MOST_PIECES and (pieces[0], pieces[-1]) == ("rod_1", "rod_12")


def test_no_specification_asks_for_a_monitor() -> None:
    assert not set(MONITORS) & set(OUTPUTS)


@pytest.mark.parametrize("cause", Cause)
def test_every_cause_warns_where_its_error_passes_the_limit(cause: Cause) -> None:
    for order in DisplacementOrder:
        at_limit = Monitor("rod", 2, cause, order, 0.5, ERROR_LIMIT, 0.1)
        assert not at_limit.passed and replace(at_limit, error=1.001 * ERROR_LIMIT).passed
        text = replace(at_limit, error=0.3).warning
        wrong = "twist" if cause is Cause.TWISTING_MOMENT else "deflection"
        assert text.startswith("rod in 2 beams: ") and f"an error of 30 % in its {wrong}" in text
        assert "the limit is 5 %" in text


def test_a_warning_says_100_percent_without_an_exponent() -> None:
    text = Monitor("rod", 1, Cause.BENDING_MOMENT, DisplacementOrder.FULL, 0.997, 0.17, 0.1).warning
    assert "by 100 % of the largest one" in text and "e+" not in text


def test_what_is_not_a_number_is_beyond_a_limit() -> None:
    assert Monitor("rod", 1, Cause.DEFLECTION, DisplacementOrder.FIRST_ORDER, np.nan, np.nan, 0.0).passed


# ---- where they look ----


def test_what_happens_between_two_rows_is_seen() -> None:
    """Set A in one beam: its deflection is largest between the two rows of the run."""
    often, ends = rod(1), run(rod(1).scene, 0.02, 0.02)
    assert len(ends["t"]) == 2
    for cause in (Cause.DEFLECTION, Cause.AXIAL_FORCE, Cause.BENDING_MOMENT):
        seen, same = monitor(ends, cause), monitor(often, cause)
        assert (seen.value, seen.t, seen.error) == (same.value, same.t, same.error)
    bent = monitor(often, Cause.DEFLECTION)
    of_rows = next(m for m in validity(ends.motion) if m.cause is Cause.DEFLECTION)
    assert bent.value > 0.009 and 0 < bent.t < 0.02 and of_rows.value < 0.8 * bent.value


def test_steps_in_c_and_rows_in_python_see_the_same() -> None:
    """Methods that do not watch their steps are judged by their rows, which here are closer than the steps."""
    scene = rod(2, second_order=True).scene
    in_c = run(scene, 0.02, 1e-5)
    rows = {m.cause: m for m in validity(in_c.motion)}
    for seen in in_c.validity:
        assert rows[seen.cause].value == pytest.approx(seen.value, rel=2e-3)
        assert rows[seen.cause].error == pytest.approx(seen.error, rel=2e-2)


def test_without_beams_nothing_is_watched() -> None:
    swing = """
        name = "swing"
        scene.gravity = [0, -9.81]
        ground.markers = { o = [0, 0] }
        [bodies.arm]
        mass = 1
        inertia = 0.1
        markers = { pin = [-0.5, 0] }
        start = { position = [0.5, 0] }
        [joints.pin]
        kind = "revolute"
        between = ["ground.o", "arm.pin"]
    """
    trajectory = run(parse(swing), 0.1, 0.05)
    assert trajectory.solution.watched is None and trajectory.validity == ()
