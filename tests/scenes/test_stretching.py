"""Beams that stretch against closed forms: bars, strings, and the angle of sections that stretch and bend."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from made import make

import derive
from derive.simulation.initial.initial_state import initial_state
from derive.simulation.linear.linearisation import linearise
from derive.spec.model.scene import Scene
from derive.spec.toml.read import parse

MASS, LENGTH, EA, EI, FORCE = 1.3, 1.4, 900.0, 2.25, 40.0
BAR = f"""
ansatz = {{ansatz}}
mass = {MASS}
length = {LENGTH}
bending_stiffness = {EI}
order = 2
markers = {{{{ left = -1, middle = 0, right = 1 }}}}
start = {{{{ position = [{LENGTH / 2}, 0] }}}}
"""
POLYNOMIALS = [f"xi^{n}" for n in range(4)]
ENDS = f"ground.markers = {{ left = [0, 0], right = [{LENGTH}, 0] }}\n"


def scene(keys: str, joints: str = "", ansatz: Any = POLYNOMIALS) -> Scene:
    """A bar between two points of the ground; keys: those of how it stretches, and more."""
    body = BAR.format(ansatz=ansatz) + keys
    return parse(f'name = "bar"\n{ENDS}[bodies.bar]\n{body}\n{joints}')


def frequencies(of: Scene) -> np.ndarray:
    """All natural frequencies about the initial state at rest, rad/s, ascending."""
    native = make(of, complete=True).native
    k = native.setup()
    q = initial_state(of, native, k).q
    linear = linearise(native, k, 0.0, q, np.zeros(native.nv))
    squares = np.linalg.eigvals(linear.A[linear.count :, : linear.count])
    assert np.abs(squares.imag).max() < 1e-6 * np.abs(squares).max()
    result: np.ndarray = np.sqrt(np.sort(-squares.real).clip(0))
    return result


@pytest.mark.long
def test_a_free_bar_rings_at_its_frequencies() -> None:
    """n pi sqrt(EA/(m l)); a polynomial of degree 7 has the first two to 1e-8 and 1e-4."""
    ansatz = [f"xi^{n}" for n in range(1, 8)]
    found = frequencies(scene(f"axial = {{ ansatz = {ansatz}, stiffness = {EA} }}"))
    expected = np.pi * np.sqrt(EA / (MASS * LENGTH)) * np.array([1, 2])
    errors = [np.abs(found / e - 1).min() for e in expected]
    assert errors[0] < 1e-8 and errors[1] < 1e-4


HINGES = """
[joints.left]
kind = "revolute"
between = ["ground.left", "bar.left"]
[joints.right]
kind = "revolute"
between = ["ground.right", "bar.right"]
"""


@pytest.mark.parametrize("preload", [60.0, pytest.param(-10.0, marks=pytest.mark.long)])
def test_a_string_is_tuned_by_its_axial_force(preload: float) -> None:
    """w^2 = (EI k^4 + N k^2) l/m with k = n pi/l: sines and a uniform strain are exact."""
    family = '{ kind = "pinned", count = 3 }'
    axial = f'axial = {{ ansatz = ["xi"], stiffness = {EA}, preload = {preload} }}'
    found = frequencies(scene(axial, HINGES, ansatz=family))
    k = np.pi / LENGTH * np.arange(1, 4)
    np.testing.assert_allclose(found, np.sqrt((EI * k**4 + preload * k**2) * LENGTH / MASS), rtol=1e-9)


def test_a_column_between_fixed_hinges_buckles_at_the_load_of_euler() -> None:
    """The square of the lowest frequency falls with the axial force by a line, which vanishes at pi^2 EI/l^2."""
    euler = np.pi**2 * EI / LENGTH**2
    family = '{ kind = "pinned", count = 1 }'

    def square(load: float) -> float:
        axial = f'axial = {{ ansatz = ["xi"], stiffness = {EA}, preload = {-load} }}'
        return float(frequencies(scene(axial, HINGES, ansatz=family))[0] ** 2)

    low, high = square(0.25 * euler), square(0.75 * euler)
    assert 0.25 * euler + low / (low - high) * 0.5 * euler == pytest.approx(euler, rel=1e-9)


def test_a_bent_string_between_fixed_ends_has_the_energy_of_its_tension() -> None:
    """EI k^4 l A^2/4 + EA l/2 (k A/2)^4: half a sine wave A sin(k x) is longer than the straight line."""
    family, bent = '{ kind = "pinned", count = 1 }', 0.03
    axial = f'axial = {{ ansatz = ["xi"], stiffness = {EA} }}'
    text = scene(axial, f'{HINGES}[outputs]\nenergy = {{ kind = "energy" }}\n', ansatz=family)
    native = make(text, complete=True).native
    k, wave = native.setup(), np.pi / LENGTH
    q = np.zeros(native.nq)
    q[[native.coordinates.index(name) for name in ("bar_c1", "bar_alpha1")]] = LENGTH / 2, bent
    q[native.coordinates.index("bar_alpha2")] = (wave * bent) ** 2 * LENGTH / 8
    assert np.abs(native.constraints(0.0, q, k)).max() < 1e-15
    v = np.zeros(native.nv)
    vdot, lam = native.solve(0.0, q, v, k)
    energies = native.evaluate_outputs(0.0, q, v, vdot, lam, k)
    expected = EI * wave**4 * LENGTH * bent**2 / 4 + EA * LENGTH / 2 * (wave * bent / 2) ** 4
    assert energies[native.outputs.index("energy_strain")] == pytest.approx(expected, rel=1e-14)


def test_a_pulled_bar_has_the_strain_of_the_force_and_its_tension() -> None:
    """Clamped, and pulled along its axis in equilibrium: strain F/EA, axial force F, both everywhere."""
    clamp = '[joints.clamp]\nkind = "weld"\nbetween = ["ground.left", "bar.left"]\n'
    pull = f'[forces.pull]\nat = "bar.right"\ncomponents = [{FORCE}, 0]\n'
    outputs = """[outputs]
strain = { kind = "strain", section = "bar.middle", height = 0.01 }
tension = { kind = "axial_force", section = "bar.middle" }
end = { kind = "position", marker = "bar.right" }
"""
    text = scene(f'axial = {{ ansatz = ["xi", "xi^2"], stiffness = {EA} }}', clamp + pull + outputs)
    native = make(text, complete=True).native
    k, q, v = native.setup(), np.zeros(native.nq), np.zeros(native.nv)
    q[native.coordinates.index("bar_c1")] = LENGTH / 2 + FORCE / EA * LENGTH / 2
    q[native.coordinates.index("bar_alpha3")] = FORCE / EA * LENGTH / 2
    vdot, lam = native.solve(0.0, q, v, k)
    assert np.abs(vdot).max() < 1e-10
    found = dict(zip(native.outputs, native.evaluate_outputs(0.0, q, v, vdot, lam, k), strict=True))
    assert found["strain"] == pytest.approx(FORCE / EA, rel=1e-13)
    assert found["tension"] == pytest.approx(FORCE, rel=1e-12)
    assert found["end_1"] == pytest.approx(LENGTH * (1 + FORCE / EA), rel=1e-13)


def test_a_section_turns_by_the_slope_of_the_stretched_axis() -> None:
    """atan2(v', 1 + u') through second order: the error falls with the third power of the amplitudes."""
    angle = '[outputs]\nturn = { kind = "rotation", marker = "bar.right" }\n'
    native = make(scene(f'axial = {{ ansatz = ["xi", "xi^2"], stiffness = {EA} }}', angle), complete=True).native
    k, v = native.setup(), np.zeros(native.nv)

    def error(size: float) -> float:
        q = np.zeros(native.nq)
        q[3:] = np.array([0.3, -0.2, 0.5, 0.7]) * size
        vdot, lam = native.solve(0.0, q, v, k)
        # The right end of P2, P3 along and across: slopes 3 and 6, of xi and P2 1 and 3; all times 2/l.
        across, along = (q[3] * 3 + q[4] * 6) * 2 / LENGTH, (q[5] * 1 + q[6] * 3) * 2 / LENGTH
        turned = native.evaluate_outputs(0.0, q, v, vdot, lam, k)[native.outputs.index("turn")]
        return float(abs(turned - np.arctan2(across, 1 + along - across**2 / 2)))

    assert 0 < error(1e-3) < 1.1e-3 * error(1e-2)


def test_damping_of_a_bar_is_that_of_all_its_free_modes() -> None:
    """A ratio is that of bending and of stretching alike."""
    keys = f'axial = {{ ansatz = ["xi", "xi^2", "xi^3"], stiffness = {EA} }}\ndamping = {{ ratio = 0.02 }}'
    native = make(scene(keys), complete=True).native
    k = native.setup()
    linear = linearise(native, k, 0.0, np.zeros(native.nq), np.zeros(native.nv))
    values = np.linalg.eigvals(linear.A)
    moving = values[np.abs(values) > 1]
    assert len(moving) == 10
    np.testing.assert_allclose(-moving.real / np.abs(moving), 0.02, rtol=1e-6)


def test_what_is_wrong_is_said() -> None:
    def problem(**keys: Any) -> str:
        with pytest.raises(derive.SpecError) as caught:
            derive.planar_beam("b", **keys)
        return "; ".join(f"{p.path}: {p.message}" for p in caught.value.problems)

    axial = {"ansatz": ["xi"], "stiffness": 10}
    assert "write order = 2" in problem(axial={**axial, "preload": 3})
    assert "nothing but a translation; add xi" in problem(axial={**axial, "ansatz": ["2"]})
    dependent = problem(axial={**axial, "ansatz": ["xi", "2*xi + 1"]})
    assert "axial.ansatz" in dependent and "linearly dependent, together with the translation 1" in dependent
    mass = {"tip": {"at": 1, "mass": 1, "inertia": 1}}
    assert 'write terms = "truncated"' in problem(axial=axial, order=2, terms="full", masses=mass)
    assert "a positive number is needed" in problem(axial={**axial, "stiffness": -1})
