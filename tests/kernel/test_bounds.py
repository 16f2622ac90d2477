"""Bounds of the lowering from both sides: range of doubles, pivots of loops, checks of all results, cost, units."""

from __future__ import annotations

import re
from fractions import Fraction
from functools import cache

import numpy as np
import pytest

import derive
from conftest import QUICK, ROOT
from derive.generated_models import generated_explicit
from derive.lowering.cost_model import estimate_costs
from derive.lowering.flat.graph import Graph, LoweringError
from derive.lowering.flat.setup_constants import Constants
from derive.lowering.model_functions import functions_of
from derive.mechanics.bodies.spatial_body import parametric_body
from derive.runtime.compiled_model import Native
from derive.runtime.compiler import ESSENTIAL
from derive.runtime.loading import load_scene
from derive.runtime.native_call import ModelError
from derive.spec.toml.read import parse


@pytest.mark.parametrize("sign", [1, -1])
def test_numbers_out_of_the_range_of_doubles_are_refused(sign: int) -> None:
    """The smallest normal double is 2^-1022, the largest 2^1024 - 2^971; zero is a number, too."""
    graph = Graph(Constants(frozenset()))
    for number in (Fraction(1, 2**1022), Fraction(2**1024 - 2**971), Fraction(0)):
        assert graph.value(graph.number(sign * number)) == sign * number
    for number in (Fraction(1, 2**1022) * Fraction(99, 100), Fraction(2**1024)):
        with pytest.raises(LoweringError, match="out of the range of doubles; choose units"):
            graph.number(sign * number)


@cache
def looped() -> Native:
    return derive.load(
        derive.model_files(
            derive.lower(derive.derive(spec := derive.symbolic_body("looped", 1, frame="given", lowering="loops"))),
            spec,
        ),
        QUICK,
    )


@pytest.mark.parametrize(("remaining", "code"), [(2.0**-40, 0), (2.0**-48, 1), (0.0, 1), (-1.0, 1)])
def test_a_pivot_of_rounding_error_vanishes_in_loops(remaining: float, code: int) -> None:
    """The mode turns with the body about e3: c6 = e3 and c8 = 1 leave C3_33 - 1 of the moment of inertia."""
    native = looped()
    named = dict(zip(native.parameters, native.defaults, strict=True))
    inertia = [name for name in named if name.startswith("C3")]
    coupling = [name for name in named if name.startswith("c6")]
    assert len(inertia) == 6 and len(coupling) == 3
    k = native.setup({inertia[5]: 1.0 + remaining, coupling[2]: 1.0})
    q, v = np.array([0.0, 0, 0, 1, 0, 0, 0, 0]), np.zeros(7)
    if code == 0:
        assert np.all(np.isfinite(native.accel(0.0, q, v, k)))
        return
    with pytest.raises(ModelError) as caught:
        native.accel(0.0, q, v, k)
    assert caught.value.code == code


BARS = 'name = "two_bars"\n[ground.markers]\na = [0, 0]\nb = [5, 0]\n' + "".join(
    f"[bodies.{name}]\nmass = 1\ninertia = 0.1\nkeep_coordinates = true\nmarkers = {{ p = [-0.5, 0] }}\n"
    f'[joints.pin_{name}]\nkind = "revolute"\nbetween = ["ground.{marker}", "{name}.p"]\n'
    for name, marker in (("first", "a"), ("second", "b"))
)
"""Two pendulums that do not know of each other."""


@pytest.mark.parametrize("lowering", ["flat", "instances"])
def test_every_result_of_a_scene_is_checked(lowering: str) -> None:
    """The first pendulum is at rest; what is not finite concerns the second alone."""
    spec = parse(BARS.replace("[ground", f'scene.lowering = "{lowering}"\n[ground', 1))
    native = load_scene(generated_explicit(spec)[1], (*QUICK, *ESSENTIAL))
    k, q = native.setup(), np.array([0.5, 0, 0, 5.5, 0, 0])
    calm, wild = np.zeros(6), np.array([0, 0, 0, 0, 0, 1e200])
    assert np.all(np.isfinite(np.hstack(native.solve(0.0, q, calm, k))))
    for call in (native.solve, native.accel):
        with pytest.raises(ModelError) as caught:
            call(0.0, q, wild, k)
        assert caught.value.code == 2
    with pytest.raises(ModelError) as caught:
        native.project_velocity(0.0, q, k, [0.0, 0.0, 0.0, np.inf])
    assert caught.value.code == 2


@pytest.mark.long
def test_the_predicted_time_of_loops_follows_their_operations() -> None:
    """0.022 ns for each operation, 1 ns for each mode, and 27 ns; the model counts those that grow with n^2."""
    for n in (30, 60):
        spec = derive.symbolic_body("b", n, frame="given", lowering="loops")
        counted = derive.lower(derive.derive(spec)).kernel("force").operations
        predicted = estimate_costs(parametric_body(spec)).loops
        assert predicted == pytest.approx(27 + n + 0.022 * counted, rel=0.12)


UNITS = {
    "energy": ["J"],
    "momentum": ["N s", "N m s"],
    "x": ["m"],
    "xdot": ["m/s"],
    "pose": ["m", "rad"],
}
"""The units in the descriptions of outputs, by the names of these."""


def test_units_of_outputs() -> None:
    found = {}
    for name in ("free_beam_mean", "four_bar"):
        equations = derive.derive(derive.read(ROOT / "scenes" / f"{name}.toml"))
        for function in functions_of(equations.expanded()):
            found |= {output: re.findall(r"\[(.*?)\]", doc) for output, doc in function.outputs.items()}
    assert {name: found[name] for name in UNITS} == UNITS
