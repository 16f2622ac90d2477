"""Integrals of functions of time in closed form: against quadrature, for several parameters; what is refused."""

from __future__ import annotations

from collections.abc import Callable

import mpmath
import pytest
from scipy.integrate import quad

from derive.mechanics.time_integrals.closed_form import time_integral
from derive.mechanics.time_integrals.no_closed_form import NoClosedForm
from derive.spec.files.splines import cubic_spline
from derive.spec.model.quantity import Parameter
from derive.spec.model.time_function import TimeFunction, break_times, value_at
from derive.spec.parsing.time_expression import Known, time_function
from derive.spec.parsing.time_text import function_text

DEFAULTS = {"Omega": 60.0, "w": -2.5, "T": 0.7, "c": 1.3}
OTHERS = {"Omega": -1.0, "w": 1.7, "T": 1.9, "c": 0.4}
KNOTS = [0.0, 0.4, 0.5, 1.1, 1.7, 2.4]
KNOWN = Known(
    {name: TimeFunction("parameter", parameter=Parameter(name, "", value)) for name, value in DEFAULTS.items()},
    {"tab": cubic_spline("tab", KNOTS, [1.0, 2.5, -1.0, 0.3, 0.2, 4.0])},
)
TIMES = (-0.7, 0.0, 0.01, 0.33, 0.9, 1.5, 2.2, 4.1)
FUNCTIONS = (
    "sqrt(2)",
    "2*t^3 - t + 4",
    "Omega*step(t, 0, 0.3)",
    "t^2*step(t, T, 2*T)",
    "step(w*t, -3, -1)",
    "t*step(-t, -2, -1)",
    "step(t, 0, 1)*sin(w*t)",
    "step(t, 0, 1)*step(t, 0.5, 2)",
    "step(t, 0, 1)^2",
    "step(t, 0, T)*exp(-t)",
    "step(t, T, c)*t",
    "sin(2*t)",
    "3*cos(w*t + 1)",
    "t^2*exp(-t)*sin(3*t)",
    "exp(-w*t)",
    "sin(t)^2*cos(3*t)^3",
    "(1 - exp(-t/T))*Omega",
    "piecewise(t < 1, 0, t < 2, t - 1, 1)",
    "piecewise(t < T, t, t < c, T*cos(t), 1)",
    "abs(w*t + 1)*t",
    "min(t, 1) + max(w*t, c)",
    "tab(t) + t^2*tab(2*t - 0.3)",
    "t*tab(w*t + 3)",
    "tab(t)*step(t, 0, 1)",
    "t*sqrt(1 + c*(t + 1))",
    "1/(9 + t) + t/(12 + c*t)^2",
    "t*log(3 + t)",
    "tanh(w*t)",
)


def by_quadrature(function: TimeFunction, end: float, values: dict[str, float]) -> float:
    edges = sorted({*break_times(function, 5.0, values), *KNOTS, *((x - 3) / values["w"] for x in KNOTS)})
    edges += [(x + 0.3) / 2 for x in KNOTS]
    inside = [t for t in edges if min(0.0, end) < t < max(0.0, end)]
    f = lambda t: value_at(function, t, values)  # noqa: E731
    return float(quad(f, 0.0, end, points=inside or None, epsabs=1e-13, epsrel=1e-13, limit=200)[0])


@pytest.mark.parametrize("text", FUNCTIONS)
def test_an_integral_is_that_of_quadrature(text: str) -> None:
    function = time_function(text, KNOWN)
    integral = time_integral(function)
    for values in (DEFAULTS, OTHERS):
        for t in TIMES:
            expected = by_quadrature(function, t, values)
            assert value_at(integral, t, values) == pytest.approx(expected, rel=2e-12, abs=2e-12), (values, t)
    assert value_at(integral, 0.0) == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize(
    ("text", "t", "expected"),
    [
        ("step(t, 100, 100.5)", 101, 0.75),
        ("piecewise(t < 100, 0, t < 100.5, 64*(t - 100)^5, 2)", 100.5, 1 / 6),
        ("sin(1/10^7*t)", 2.0, 2e-7),
        ("exp(1/10^9*t)", 2.0, 2.000000002),
    ],
)
def test_no_digits_are_lost(text: str, t: float, expected: float) -> None:
    assert value_at(time_integral(time_function(text)), t) == pytest.approx(expected, rel=1e-13)


@pytest.mark.parametrize(
    ("text", "exact"),
    [
        ("t^5*sin(1/1000*t)", lambda t: t**5 * mpmath.sin(t / 1000)),
        ("step(t, 0, 5)*cos(1/100000*t + 1)", lambda t: rising(t / 5) * mpmath.cos(t / mpmath.mpf(10) ** 5 + 1)),
        ("step(t, 0, 5)*sin(4*t)^2", lambda t: rising(t / 5) * mpmath.sin(4 * t) ** 2),
        ("t^2*exp(-1/10^6*t)", lambda t: t**2 * mpmath.exp(-t / mpmath.mpf(10) ** 6)),
        ("exp(1/1000*t)*cos(1/1000*t)", lambda t: mpmath.exp(t / 1000) * mpmath.cos(t / 1000)),
        ("t*exp(2*t)*sin(t)", lambda t: t * mpmath.exp(2 * t) * mpmath.sin(t)),
    ],
)
def test_slow_waves_lose_no_digits_either(text: str, exact: Callable[[mpmath.mpf], mpmath.mpf]) -> None:
    integral = time_integral(time_function(text))
    for end in (0.01, 0.1, 0.9, 2.1, 5.0):
        with mpmath.workdps(40):
            expected = mpmath.quad(exact, mpmath.linspace(0, mpmath.mpf(end), 9))
        assert value_at(integral, end) == pytest.approx(float(expected), rel=3e-13)


def test_a_switch_at_a_parameter_loses_no_digits() -> None:
    integral = time_integral(time_function("step(c*t, 0, 2)*step(t, 0, 12/125)", KNOWN))
    expected = mpmath.quad(lambda t: rising(1.3 * t / 2) * rising(t * 125 / 12), [0, 0.05])
    assert value_at(integral, 0.05) == pytest.approx(float(expected), rel=1e-12)


def rising(s: mpmath.mpf) -> mpmath.mpf:
    return s**3 * (10 + s * (6 * s - 15))


@pytest.mark.parametrize(
    ("text", "part"),
    [
        ("3*t + exp(-t^2)", "exp(-t^2)"),
        ("sin(t^2)", "sin(t^2)"),
        ("2*tab(t)*sin(t)", "2*tab(t)*sin(t)"),
        ("abs(sin(t))", "abs(sin(t))"),
        ("1/sin(t + 1)", "1/sin(1 + t)"),
        ("atan2(t, 1)", "atan2(t, 1)"),
        ("t + c*step(t, 0, 1)*tanh(t)", "c*step(t, 0, 1)*tanh(t)"),
    ],
)
def test_what_has_no_closed_form_is_named(text: str, part: str) -> None:
    with pytest.raises(NoClosedForm) as caught:
        time_integral(time_function(text, KNOWN))
    assert caught.value.part is not None
    assert function_text(caught.value.part) == part


@pytest.mark.parametrize("text", [*FUNCTIONS, "-(t - 2)^2/3 + 2/(t*(t + 1)) - (1 - (2 - t))", "(-t)^3", "2^3*pi*t"])
def test_the_text_of_a_function_is_read_as_the_function(text: str) -> None:
    function = time_function(text, KNOWN)
    again = time_function(function_text(function), KNOWN)
    assert all(value_at(again, t) == pytest.approx(value_at(function, t), rel=1e-11) for t in (0.3, 1.6))
