"""Failures of methods, each on a small case: estimates, ringing, dead centres, momentum, attitude, shapes."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from bench.method_failures.attitude import tumble
from bench.method_failures.dead_centre import dead_centres
from bench.method_failures.free_flight import MomentumDrift, momentum_drifts
from bench.method_failures.lines import small_failures
from bench.method_failures.picture import failures_svg
from bench.method_failures.ringing import decay, ringing
from bench.method_failures.shape_bases import (
    basis_conditions,
    exact_condition,
    four_monomials_mass,
    gram,
    monomials,
    rigid_motion_left,
    shapes,
    solution_error,
)
from bench.method_failures.small_cases import SmallCases, small_cases
from bench.method_failures.small_scenes import Driven
from bench.method_failures.step_control import step_controls
from bench.method_failures.tables import tables
from conftest import ROOT
from derive.mechanics.bodies.reference_conditions import assumed_shapes
from derive.spec.model.beam_parts import AssumedDeflection, Frame
from derive.study.methods.failures import failure_lines
from derive.study.methods.implicit_steps import Rule


def test_estimates_hold_at_any_phase_of_a_vibration() -> None:
    for control in step_controls():
        assert control.classical > 100 and control.own < 2.3
        assert control.row < 2.5 < control.interpolated


@pytest.mark.long
def test_multipliers_ring_unless_rho_is_less_than_1() -> None:
    runs = ringing()
    assert [run.rho for run in runs] == [1.0, 0.9, 0.8, 0.5]
    assert [run.factor for run in runs] == pytest.approx([run.rho for run in runs], rel=0.03)
    assert runs[0].amplitude[-1] > 0.5 > 10 * runs[0].amplitude[0]
    assert all(run.amplitude[-1] < 1e-5 for run in runs[1:])


def test_the_factor_of_a_decay() -> None:
    n = np.arange(1, 61)
    assert decay(0.3 * n**2 * 0.7**n) == pytest.approx(0.7)


def test_dead_centres() -> None:
    longer, equal, slider = dead_centres()
    assert longer.driven is Driven.CRANK and longer.dead == () and longer.failure == ""
    assert longer.singular.min() > 0.5
    assert np.degrees(equal.dead) == pytest.approx([90, 270]) and equal.rod == 1
    assert np.degrees(slider.dead) == pytest.approx([0, 180, 360])
    around = np.abs(np.abs(slider.angles - np.pi) - 0.05) < 0.04
    slope = slider.singular[around] / np.abs(np.sin(slider.angles[around]))
    assert np.ptp(slope) < 0.01 * slope.max()  # it vanishes with sin(phi1)
    assert "the mechanism is at a dead centre at t = 1.819" in slider.failure
    assert "crank_pin_1" in slider.failure and 0 <= slider.reported < 1e-3


@cache
def drifts() -> tuple[MomentumDrift, ...]:
    return momentum_drifts()


def test_the_momentum_drifts_under_the_trapezoidal_rule() -> None:
    """2, 18 and 90 % of it, and at most 0.4 % under the midpoint rule."""
    trapezoidal = [m for m in drifts() if m.rule is Rule.TRAPEZOIDAL]
    assert [m.product for m in trapezoidal] == [1, 3, 10]
    assert [m.drift for m in trapezoidal] == pytest.approx([0.02, 0.18, 0.90], rel=0.08)
    assert trapezoidal[0].drift == pytest.approx(trapezoidal[0].small, rel=0.06)
    assert max(m.drift for m in drifts() if m.rule is Rule.MIDPOINT) <= 0.004


def test_a_quaternion_knows_no_gimbal_lock() -> None:
    t = tumble()
    assert np.degrees(np.abs(t.pitch).max()) > 89.5
    assert t.quaternion == pytest.approx(np.ones(len(t.t)), abs=1e-9)
    assert t.angles.max() > 200 and t.angles.min() == pytest.approx(1)
    assert max(t.energy, t.momentum) < 1e-7


def test_monomials_lose_digits_and_legendre_polynomials_do_not() -> None:
    """Exact for N = 2: c8 of xi^2, xi^3 is diag(1/5, 1/7)."""
    conditions = {b.count: b for b in basis_conditions(12)}
    assert list(conditions) == list(range(2, 13))
    assert conditions[2].monomials == pytest.approx(7 / 5)
    assert conditions[12].monomials == pytest.approx(3.51e8, rel=0.01)
    assert all(
        later.monomials > 5 * conditions[n].monomials
        for n, later in ((n - 4, b) for n, b in conditions.items() if n > 5)
    )
    for n, b in conditions.items():
        assert b.legendre == pytest.approx((2 * n + 3) / 5)
        assert b.error_legendre < 1e-14
    assert conditions[12].error_monomials > 1e-10


def test_twenty_monomials_leave_two_digits() -> None:
    c8 = gram(shapes(20, "point"))
    assert exact_condition(c8) == pytest.approx(5.45e14, rel=0.01)
    assert 1e-3 < solution_error(c8) < 1


def test_without_orthogonal_shapes_the_mean_frame_has_the_same_c8() -> None:
    ansatz, mean = monomials(8), Frame("mean")
    assert gram(assumed_shapes(AssumedDeflection(ansatz, mean))) == gram(shapes(7, "point"))


def test_rigid_motion_left_in_the_shapes() -> None:
    """M is singular at rest, and one of its two zero eigenvalues becomes 0.185 m alpha^2 when the beam is deformed."""
    left = rigid_motion_left()
    assert (left.rank, left.fields) == (4, 6)
    assert (left.at_rest, left.deformed, left.unknowns) == (5, 6, 7)
    assert left.slope == pytest.approx(0.185, abs=1e-3)
    assert "(1) = 1, a translation" in left.error and "(xi) = xi, a rotation" in left.error
    without = np.delete(np.delete(four_monomials_mass(0.01), 3, 0), 3, 1)  # without the shape 1
    assert np.linalg.cond(without) < 1e6  # a check at a deformed state passes


FAILURES = (
    "step control: fast vibrations",
    "dead centre",
    "trapezoidal rule: momentum",
    "trapezoidal rule: multipliers",
    "gimbal lock",
    "monomials, many shapes",
    "rigid motion left in the shapes",
)
"""The lines of the output: the rows of PHYSICS.md, section 4, on methods that small cases show."""


@cache
def cases() -> SmallCases:
    return small_cases()


@pytest.mark.long
def test_every_failure_has_a_line_that_agrees_with_theory() -> None:
    lines = small_failures(cases())
    assert tuple(line.failure for line in lines) == FAILURES
    assert [line.failure for line in lines if not line.agrees] == []
    text = "\n".join(failure_lines(lines))
    for line in lines:
        assert f"  {line.failure}: " in text
    assert text.count("agrees: ") == len(FAILURES) and "DIFFERS" not in text


@pytest.mark.long
def test_a_line_differs_where_its_measurement_does() -> None:
    """Each line alone, if what it measures is what it warns of."""
    s = cases()
    worse = {
        "step control: fast vibrations": replace(s, controls=tuple(replace(c, own=9.0) for c in s.controls)),
        "dead centre": replace(s, dead_centres=(*s.dead_centres[:2], replace(s.dead_centres[2], reported=np.nan))),
        "trapezoidal rule: momentum": replace(s, momentum=tuple(replace(m, drift=0.1) for m in s.momentum)),
        "trapezoidal rule: multipliers": replace(s, ringing=tuple(replace(r, factor=1.0) for r in s.ringing)),
        "gimbal lock": replace(s, tumble=replace(s.tumble, quaternion=s.tumble.angles)),
        "monomials, many shapes": replace(s, bases=tuple(replace(b, legendre=b.monomials) for b in s.bases)),
        "rigid motion left in the shapes": replace(s, rigid=replace(s.rigid, rank=s.rigid.fields)),
    }
    assert tuple(worse) == FAILURES
    for name, changed in worse.items():
        assert [line.failure for line in small_failures(changed) if not line.agrees] == [name]
        assert "\n".join(failure_lines(small_failures(changed))).count("DIFFERS: ") == 1


@pytest.mark.long
def test_the_tables_and_the_picture() -> None:
    text = "\n".join(line for table in tables(cases()) for line in table.text)
    for title in ("errors of a vibration", "ringing of multipliers", "dead centres", "angular momentum", "monomials"):
        assert title in text
    svg = failures_svg(cases())
    assert svg == failures_svg(cases()) and "mathdefault" not in svg and "Dead centres: G loses rank" in svg
    committed = (ROOT / "docs/method_failures.svg").read_text()
    assert [line for line in committed.splitlines() if "<title>" in line] == [
        line for line in svg.splitlines() if "<title>" in line
    ]
