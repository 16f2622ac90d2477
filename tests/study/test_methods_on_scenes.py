"""The stability of methods on scenes: steps, drift, forms, conditioning, by theory and by experiment."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.linalg import eigh

from conftest import QUICK, ROOT
from derive.generated_models import generated_explicit
from derive.runtime.compiler import ESSENTIAL
from derive.runtime.loading import load_scene
from derive.simulation.errors import SimulationError
from derive.simulation.integration.step_limit import natural_frequencies
from derive.spec.model.scene import Scene
from derive.spec.toml.read import parse, read
from derive.study.methods import drift
from derive.study.methods import stability_functions as theory
from derive.study.methods.drift import DriftRun, conserves, drift_order, drift_run, drift_runs, exponent
from derive.study.methods.formulations import FormRun, form_run
from derive.study.methods.implicit_steps import Rule, initial_values, march
from derive.study.methods.method_study import conditioning
from derive.study.methods.scene_methods import Method, MethodScene, method_scene
from derive.study.methods.step_limits import highest_frequency, step_limits
from derive.study.states import start_state
from derive.study.variants import variant

STEP = 2e-4
"""The step of RK4 in PHYSICS.md, s: 209 or 210 of them are a revolution of the crank."""


@cache
def crank_slider() -> MethodScene:
    """Set A with one beam."""
    scene = read(ROOT / "scenes/crank_slider_3.toml")
    assert isinstance(scene, Scene)
    return method_scene(replace(variant(scene, 1, "mean").scene, plots=()))


def test_limits_on_the_imaginary_axis() -> None:
    assert theory.step_limit(theory.classical()) == pytest.approx(np.sqrt(8), rel=1e-8)
    assert theory.step_limit(theory.dormand_prince_5()) == pytest.approx(0.9972, abs=1e-4)
    eighth = theory.dormand_prince_8()
    limit = theory.step_limit(eighth)
    assert limit == pytest.approx(5.960, abs=1e-3)
    assert all(eighth(y) <= 1 for y in np.linspace(0.05, limit - 1e-6, 500)) and eighth(limit + 1e-3) > 1


def test_implicit_methods_have_no_limit_and_leave_rho_of_high_frequencies() -> None:
    for rho in (0.0, 0.5, 0.8, 1.0):
        growth = theory.generalised_alpha(rho)
        assert theory.step_limit(growth) == np.inf
        assert growth(1e5) == pytest.approx(rho, abs=1e-3)
    assert [theory.step_limit(theory.bdf(order)) for order in (1, 2)] == [np.inf, np.inf]
    assert [theory.last_growth(theory.bdf(order)) for order in (2, 3, 4, 5)] == pytest.approx(
        [0, 1.94, 4.71, 9.39], abs=0.02
    )


@pytest.mark.parametrize("pieces", [1, 2])
def test_the_highest_frequency_of_a_free_beam(pieces: int) -> None:
    """Welded cubic beams are Hermite elements. A lone one has sqrt(8400) sqrt(EI/(m l^3)); welds lower that of P3."""
    scene = read(ROOT / "scenes/spinning_beam.toml")
    assert isinstance(scene, Scene)
    cut = replace(variant(scene, pieces, "mean").scene, plots=(), forces=())
    native = load_scene(generated_explicit(cut)[1], (*QUICK, *ESSENTIAL))
    k = native.setup()
    _, q, v = start_state(cut, native, k)
    highest = natural_frequencies(native, k, 0.0, q, v, loaded=False)[-1]
    assert highest == pytest.approx(hermite_frequency(pieces), rel=1e-6)
    assert highest <= np.sqrt(8400) * pieces**2 * (1 + 1e-9)


def hermite_frequency(elements: int) -> float:
    """The highest frequency of a free beam of Hermite elements with m = l = EI = 1, rad/s."""
    h, size = 1 / elements, 2 * elements + 2
    stiffness = np.array([[12, 6 * h, -12, 6 * h], [6 * h, 4 * h**2, -6 * h, 2 * h**2]]) / h**3
    stiffness = np.vstack([stiffness, -stiffness[0], [6 / h**2, 2 / h, -6 / h**2, 4 / h]])
    mass = np.array(
        [
            [156, 22 * h, 54, -13 * h],
            [22 * h, 4 * h**2, 13 * h, -3 * h**2],
            [54, 13 * h, 156, -22 * h],
            [-13 * h, -3 * h**2, -22 * h, 4 * h**2],
        ]
    )
    K, M = np.zeros((size, size)), np.zeros((size, size))
    for n in range(elements):
        own = slice(2 * n, 2 * n + 4)
        K[own, own] += stiffness
        M[own, own] += mass * h / 420
    return float(np.sqrt(eigh(K, M, eigvals_only=True)[-1]))


@pytest.mark.long
def test_explicit_steps_are_stable_up_to_their_limit_alone() -> None:
    of = crank_slider()
    frequency = highest_frequency(of, of.motion(13).states)
    assert frequency.unloaded == pytest.approx(4218, abs=1)
    assert 0 < frequency.largest / frequency.unloaded - 1 < 0.005
    rk4, adaptive, alpha, trapezoidal = step_limits(
        of,
        frequency,
        [Method.RK4, Method.ADAPTIVE, Method.GENERALISED_ALPHA, Method.TRAPEZOIDAL],
        lambda _: None,
    )
    assert rk4.predicted == pytest.approx(np.sqrt(8) / frequency.largest)
    for limit in (rk4, adaptive):
        assert limit.below is True and limit.above is False
        assert limit.ratio == pytest.approx(1, abs=0.01)
    assert adaptive.measured > 2 * rk4.measured
    for limit in (alpha, trapezoidal):
        assert limit.theory == np.inf and limit.measured >= 3 / frequency.largest


def test_drift_of_accelerations_grows_with_the_square_of_the_time_and_the_fourth_power_of_the_step() -> None:
    of = crank_slider()
    free, projected = (drift_run(of, Method.RK4, p, STEP, 1047) for p in (False, True))
    assert free.position[-1] == pytest.approx(3.0e-7, rel=0.05)  # after 5 revolutions
    assert exponent(free.t, free.position) == pytest.approx(2, abs=0.05)
    order = drift_order(of, STEP, 400)
    assert order.step == pytest.approx(4, abs=0.1) and order.time == pytest.approx(2, abs=0.3)
    assert projected.position[-1] < 1e-14 and projected.velocity[-1] < 1e-13


def test_the_energy_changes_by_the_work_of_the_drive_alone() -> None:
    """The error falls with the fourth power of the step at least; a run that fails keeps the rows up to there."""
    of = crank_slider()
    assert conserves(of, of.motion(5).states)
    coarse, fine = (drift_run(of, Method.RK4, True, STEP / n, 400 * n).energy[-1] for n in (1, 2))
    assert 1e-9 < fine < coarse / 10 < 1e-6
    assert drift_run(of, Method.ADAPTIVE, True, STEP, 400).energy[-1] < 1e-6
    failed = drift_run(of, Method.TRAPEZOIDAL, True, 0.5 * 2.83 / 4227, 2000)
    assert "does not converge" in failed.failure and 100 < failed.steps < 2000
    assert failed.energy[-1] > 1 and failed.position[-1] < 1e-10
    assert failed.t[-1] == pytest.approx(failed.h * failed.steps)


def test_a_run_that_diverges_keeps_what_it_has_reached(monkeypatch: pytest.MonkeyPatch) -> None:
    of = crank_slider()
    rows = of.run(Method.RK4, STEP, 300)
    rows.v[101:] *= 1e100
    monkeypatch.setattr(MethodScene, "run", lambda *_: rows)
    cut = drift_run(of, Method.RK4, True, STEP, 300)
    assert cut.steps == 100 and cut.failure == "diverges after t = 0.02 s"
    assert cut.t[-1] == pytest.approx(0.02) and cut.energy[-1] < 1e-4


@pytest.mark.long
def test_a_scene_that_dissipates_has_no_energy_to_keep() -> None:
    text = (ROOT / "scenes/spinning_beam.toml").read_text()
    text = text[: text.index("[plots.")].replace('frame = "mean"', 'frame = "mean"\ndamping = { stiffness = 1e-3 }')
    scene = parse(text, str(ROOT / "scenes/damped.toml"))
    assert isinstance(scene, Scene)
    of = method_scene(scene)
    moving = [(t, q, v + 1.0) for t, q, v in of.motion(3).states]
    assert not conserves(of, moving)
    (run, _) = drift_runs(of, 1e-3, 20, [Method.RK4], False, lambda _: None)
    assert len(run.energy) == 0


def test_no_power_is_fitted_to_nothing() -> None:
    t, none = np.geomspace(1, 10, 20), np.zeros(0)
    assert exponent(t, t**3) == pytest.approx(3)
    for times, size in ((t, none), (none, none), (t[-2:], t[-2:]), (t, 0 * t), (t, np.where(t > 9, 0, t))):
        assert np.isnan(exponent(times, size))


def test_drift_that_is_nothing_or_far_has_no_order(monkeypatch: pytest.MonkeyPatch) -> None:
    of, t = crank_slider(), np.array([1.0, 2.0])

    def drifting(size: float) -> None:
        def drifted(of: MethodScene, method: Method, projected: bool, h: float, steps: int, energy: bool) -> DriftRun:
            position = size * steps**-4.0 * t
            return DriftRun(method, projected, h, steps, t, position, position, np.zeros(0))

        monkeypatch.setattr(drift, "drift_run", drifted)

    drifting(1e4)
    assert drift_order(of, STEP, 100).step == pytest.approx(4)
    drifting(0.0)
    with pytest.raises(SimulationError, match=r"rk4 drifts by 0 m in 100 steps, and by 0 m .* may be rounding errors"):
        drift_order(of, STEP, 100)
    drifting(1e8)
    with pytest.raises(SimulationError, match=r"rk4 drifts by 2.0e\+00 m in 100 steps, which is too far to follow"):
        drift_order(of, STEP, 100)


def test_the_forms_hold_what_they_say_and_index_3_alone_rings() -> None:
    of = crank_slider()
    h = 0.5 * 2.83 / 4227

    def run(form: str, rule: Rule = Rule.TRAPEZOIDAL) -> FormRun:
        return form_run(of, form, rule, h, 200)

    three, two, one = (run(form) for form in ("index3", "ggl", "index1"))
    assert three.position < 1e-14 and three.velocity > 1e-3
    assert two.position < 1e-14 and two.velocity < 1e-12
    assert one.position > 1e-5 and one.velocity > 1e-3
    assert three.late > 5 * three.early > 5 * two.late  # it grows
    for other in (two, one, run("index3", Rule.BDF2)):
        assert other.late < 0.01
    assert three.exponent == pytest.approx(-1, abs=0.1)  # condition of the scaled iteration matrix
    assert two.exponent > -0.1 and one.exponent > -0.1


def test_the_trapezoidal_rule_is_the_generalised_alpha_method_with_rho_1() -> None:
    """The rule in Python and the method in C, which have no code in common, on the form of index 3."""
    of = crank_slider()
    assert of.alpha is not None
    h, form = 2e-4, of.native.dae["index3"]
    y, ydot = initial_values(of.native, form, of.k, 0.0, of.q, of.v)
    run = march(form, of.k, 0.0, y, ydot, h, 50, Rule.TRAPEZOIDAL, of.native.nq, of.native.nv)
    compiled = of.alpha.run(of.q, of.v, step=h, steps=50, rho=1.0)
    assert run.y == pytest.approx(np.hstack([compiled.q, compiled.v, compiled.lam]), rel=1e-5, abs=1e-5)


def test_conditioning_along_the_motion() -> None:
    of = crank_slider()
    along = conditioning(of, of.motion(13).states)
    assert along.kkt.max() == pytest.approx(2.9e3, rel=0.02)
    assert np.ptp(along.mass) < 1e-3 * along.mass.max()  # in the mean frame M hardly changes with the deformation
    assert 0.05 < along.singular.min() < along.singular.max() < 1
    assert set(along.weakest) <= set(of.native.multipliers)
