"""IDA with KLU: both forms come to the exact motion as the tolerance asks; failures, and SUNDIALS that is missing."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from pendulums import FILES, LEVEL, REST, driven, exact, fixed, gap, ida

import derive
from derive.generated_models import generated
from derive.runtime.integrators import compilation
from derive.runtime.integrators.c_integrator import IntegratorError
from derive.runtime.integrators.compilation import LibraryMissing
from derive.runtime.integrators.generalised_alpha import GeneralisedAlpha
from derive.runtime.integrators.ida import Ida, run_ida


@pytest.mark.parametrize("form", ["ggl", "index1"])
@pytest.mark.parametrize("rtol", [1e-6, 1e-8, 1e-10])
def test_error_follows_the_tolerance(form: str, rtol: float) -> None:
    found = ida().run(LEVEL, REST, interval=0.2, rows=21, form=form, rtol=rtol)
    q, v = exact(found.t)
    assert max(np.abs(found.q - q).max(), np.abs(found.v - v).max()) < 1000 * rtol
    assert np.array_equal(found.t, 0.2 * np.arange(21))


def test_stabilised_form_stays_on_the_constraints() -> None:
    ggl, index1 = (ida().run(LEVEL, REST, interval=1.0, rows=101, form=form, rtol=1e-7) for form in ("ggl", "index1"))
    assert gap(ggl).max() < 1e-7
    assert gap(index1)[-1] > 1e-5


def test_multipliers_are_those_of_runge_kutta() -> None:
    implicit = ida().run(LEVEL, REST, interval=0.2, rows=11, rtol=1e-10)
    explicit = fixed().run(LEVEL, REST, step=1e-3, steps=2000, every=200)
    assert implicit.lam == pytest.approx(explicit.lam, abs=1e-5)


def test_moving_pivot_is_followed_from_a_later_time_on() -> None:
    k, reference = driven(stroke=0.2)
    for form in ("ggl", "index1"):
        first = ida().run(LEVEL, [0.6, 0, 0], interval=0.5, rows=3, k=k, form=form)
        second = ida().run(first.q[-1], first.v[-1], interval=0.5, rows=3, k=k, form=form, t0=1.0)
        assert second.q[-1] == pytest.approx(reference(2.0), abs=1e-6)


def test_start_is_made_consistent_or_taken_as_it_is() -> None:
    off = LEVEL + np.array([0.01, 0.0, 0.0])
    assert gap(ida().run(off, REST, interval=0.1, rows=1))[0] < 1e-12
    assert np.array_equal(ida().run(off, REST, interval=0.1, rows=1, consistent=0.0).q[0], off)


def test_counts() -> None:
    found = ida().run(LEVEL, REST, interval=0.2, rows=11, rtol=1e-6)
    counts = found.counts
    assert 100 < counts["steps"] < counts["residuals"] < 1.5 * counts["steps"]  # one iteration does, as a rule
    assert 0 < counts["jacobians"] == counts["factorisations"] < counts["steps"]
    assert 0 < found.seconds < 1


def test_order_is_limited() -> None:
    low, high = (ida().run(LEVEL, REST, interval=0.2, rows=11, rtol=1e-6, order=order) for order in (2, 5))
    assert low.counts["steps"] > 2 * high.counts["steps"]
    with pytest.raises(IntegratorError, match="code -22"):
        ida().run(LEVEL, REST, interval=0.2, rows=11, order=6)


def test_tight_tolerances_start() -> None:
    """First steps are so short that rounding drowns the multipliers, which are not asked therefore."""
    x, y = 0.5 * np.cos(0.7), 0.5 * np.sin(0.7)
    found = ida().run([x, y, 0.7], [-10 * y, 10 * x, 10], interval=1e-3, rows=2, rtol=1e-9, steps_max=1000)
    assert found.counts["steps"] < 50


def test_failures_tell_what() -> None:
    with pytest.raises(IntegratorError, match="code 5: the model has no such form"):
        ida().run(LEVEL, REST, interval=0.1, rows=2, form="index0")
    with pytest.raises(IntegratorError, match="code -1 after t = 0: too many steps") as caught:
        ida().run(LEVEL, REST, interval=1.0, rows=3, steps_max=5)
    assert np.array_equal(caught.value.partial.q[0], LEVEL)
    assert np.isnan(caught.value.partial.q[1:]).all()
    with pytest.raises(ValueError, match="have to be vectors"):
        ida().run([LEVEL], [REST], interval=0.1, rows=2)
    with pytest.raises(ValueError, match="make no sense"):
        ida().run(LEVEL, REST, interval=0.0, rows=2)


def test_missing_sundials_is_said(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """A compiler that does not find its header, nor the libraries."""
    broken = tmp_path / "cc"
    broken.write_text('#!/bin/sh\necho "ida/ida.h: No such file or directory" >&2\nexit 1\n')
    broken.chmod(0o755)
    monkeypatch.setenv("CC", str(broken))
    compilation._library_flags.cache_clear()
    try:
        with pytest.raises(LibraryMissing, match=r"apt-get install libsundials-dev(.|\n)*ida.h: No such file"):
            run_ida(FILES, LEVEL, REST, interval=0.1, rows=2)
        with pytest.raises(LibraryMissing, match=r"KLU was not found(.|\n)*apt-get install libsuitesparse-dev`"):
            GeneralisedAlpha(FILES)
    finally:
        compilation._library_flags.cache_clear()


def test_sundials_elsewhere(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """SUNDIALS_DIR goes before the places of the compiler."""
    ida()
    monkeypatch.delenv("SUNDIALS_DIR", raising=False)
    include, link = compilation.sundials()
    monkeypatch.setenv("SUNDIALS_DIR", str(tmp_path))
    (tmp_path / "include").mkdir()
    compilation._library_flags.cache_clear()
    try:
        elsewhere, linked = compilation.sundials()
        assert elsewhere[:2] == ["-isystem", str(tmp_path / "include")]
        assert linked[0] == f"-L{tmp_path}/lib"
        assert set(include) < set(elsewhere)
        assert set(link) < set(linked)
        assert isinstance(Ida(FILES), Ida)
    finally:
        compilation._library_flags.cache_clear()


def test_numbers_that_are_not_finite_are_refused() -> None:
    """A NaN as `consistent` must not switch the first projection off."""
    for wrong in ({"consistent": np.nan}, {"rtol": np.nan}, {"interval": np.inf}, {"t0": np.nan}):
        with pytest.raises(ValueError, match="finite numbers are needed"):
            ida().run(LEVEL, REST, **{"interval": 0.1, "rows": 2, **wrong})


def test_a_quaternion_is_normalised_at_the_start_and_zero_is_refused() -> None:
    spec = derive.symbolic_body("falling", 1, frame="given", gravity=[0, 0, -9.81], lowering="flat")
    host = Ida(generated(spec)[1], ["-O0"])
    q, v = np.zeros(8), np.zeros(7)
    q[3], v[5] = 5.0, 3.0
    found = host.run(q, v, interval=0.5, rows=3, form=None, rtol=1e-9)
    assert found.q[:, 3] == pytest.approx(np.cos(1.5 * found.t), abs=1e-6)
    q[3] = 0.0
    with pytest.raises(IntegratorError, match="falling: code 2"):
        host.run(q, v, interval=0.5, rows=3, form=None)
