"""IDA through scikit-sundae: the motion of the explicit method, in both forms; skipped where the package is missing."""

from __future__ import annotations

import os
from types import SimpleNamespace

import numpy as np
import pytest
from compiled import crank_slider
from double_dae import DoubleDae
from mechanisms import pendulum

from derive.simulation.errors import DriftTooLarge, IntegrationStopped
from derive.simulation.integration import scikit_sundae
from derive.simulation.integration.scikit_sundae import IdaMissing, integrate_ida
from derive.simulation.integration.scipy_methods import integrate

if not os.environ.get("CI"):
    pytest.importorskip("sksundae")


@pytest.mark.parametrize("form", ["ggl", "index1"])
def test_a_pendulum_falls_as_by_the_explicit_method(form: str) -> None:
    model, q, v = pendulum()
    model.dae = {form: DoubleDae(model, form)}
    times = np.linspace(0, 2, 21)
    k = model.setup()
    exact = integrate(model, k, q, v, times, tolerance=1e-11)
    errors = []
    for tolerance in (1e-4, 1e-8):
        found = integrate_ida(model, k, q, v, times, form=form, tolerance=tolerance)
        errors.append(np.abs(found.q - exact.q).max())
        assert found.drift.max() < 1e-13
        assert found.cost.steps > 20 and found.cost.jacobians > 5
        assert found.lam == pytest.approx(exact.lam, abs=3e3 * tolerance)
    assert errors[0] < 0.02
    assert errors[1] < 1e-3 * errors[0]


def test_the_crank_slider_with_its_compiled_jacobian() -> None:
    made = crank_slider(1, complete=True)
    start, times = made.start(), np.linspace(0, 0.02, 41)
    exact = integrate(made.native, made.k, start.q, start.v, times, tolerance=1e-11)
    found = integrate_ida(made.native, made.k, start.q, start.v, times, tolerance=1e-7)
    assert np.abs(found.q - exact.q).max() < 1e-6
    assert np.abs(found.lam - exact.lam).max() < 0.05
    assert found.cost.evaluations < 3 * found.cost.steps


def test_a_step_that_fails_ends_the_run_with_what_ida_says(monkeypatch: pytest.MonkeyPatch) -> None:
    made = crank_slider(1, complete=True)
    start, step = made.start(), scikit_sundae._Segment.step

    def failing(part: scikit_sundae._Segment, towards: float) -> tuple[float, np.ndarray]:
        t, y = step(part, towards)
        part.result = SimpleNamespace(success=t < 0.005, message="the error test failed", nfev=0, njev=0)
        return t, y

    monkeypatch.setattr(scikit_sundae._Segment, "step", failing)
    with pytest.raises(IntegrationStopped, match="IDA: the error test failed") as error:
        integrate_ida(made.native, made.k, start.q, start.v, np.linspace(0, 0.02, 41))
    assert 0.004 < error.value.t < 0.006


def test_the_stabilised_form_stays_on_the_constraints_by_itself() -> None:
    made = crank_slider(1, complete=True)
    start, times = made.start(), np.linspace(0, 0.1, 101)
    drift = {}
    for form in ("ggl", "index1"):
        options = {"form": form, "tolerance": 1e-6, "projected": False, "drift": np.inf}
        drift[form] = integrate_ida(made.native, made.k, start.q, start.v, times, **options).drift[:, 0]
    assert drift["ggl"].max() < 1e-6 < drift["index1"][-1]
    with pytest.raises(DriftTooLarge):
        integrate_ida(made.native, made.k, start.q, start.v, times, form="index1", projected=False)


def test_without_the_package_it_is_told_how_to_get_it(monkeypatch: pytest.MonkeyPatch) -> None:
    model, q, v = pendulum()
    model.dae = {"ggl": DoubleDae(model, "ggl")}
    monkeypatch.setitem(__import__("sys").modules, "sksundae.ida", None)
    with pytest.raises(IdaMissing, match=r"pip install 'tisserand\[ida\]'"):
        integrate_ida(model, model.setup(), q, v, [0.0, 1.0])
