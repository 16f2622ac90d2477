"""(21)-(27), (30) and (38) as the tool uses them for its beam, against the printed ones."""

from __future__ import annotations

import pytest
import sympy as sp

import beams
from derive.mechanics.bodies.beam_functions import polynomial
from derive.mechanics.bodies.reference_conditions import assumed_shapes, conditions
from derive.mechanics.equations import Equations
from derive.mechanics.motion.kinematics import ONE, R
from derive.mechanics.motion.planar import planar_motion
from derive.mechanics.motion.spatial import rotation_of
from derive.spec.construction.bodies import planar_beam
from derive.spec.model.beam_parts import Frame
from paper import printed, printed_continuum
from paper.printed import xi
from plain_symbols import plain

FRAMES = {"point": printed.POINT_SHAPES, "mean": printed.MEAN_SHAPES}
MARKERS = {"left": -1, "inside": sp.Rational(1, 3), "right": 1}


def derived(frame: str) -> Equations:
    return beams.made(frame).equations


def polynomials(frame: str) -> tuple[sp.Expr, ...]:
    spec = beams.beam(frame)
    found = assumed_shapes(spec.deflection)
    return tuple(sum(sp.Rational(c) * xi**n for n, c in enumerate(shape.coefficients)) for shape in found)


def test_ansatz_without_a_specification_is_21() -> None:
    """The terms of the ansatz, each with an amplitude of its own."""
    amplitudes = (printed.a0, printed.a1, printed.a2, printed.a3)
    terms = [sum(sp.Rational(c) * xi**n for n, c in enumerate(p)) for p in planar_beam("paper").ansatz]
    found = sum(a * term for a, term in zip(amplitudes, terms, strict=True))
    assert sp.expand(found - printed.DISPLACEMENT_21) == 0


@pytest.mark.parametrize("frame", FRAMES)
def test_strain_energy_is_22(frame: str) -> None:
    v = printed.displacement_30(*FRAMES[frame])
    found = plain(derived(frame).substituted(derived(frame).strain_energy))
    assert sp.expand(found - printed.strain_energy_22(v)) == 0


def test_translation_is_23() -> None:
    assert plain(planar_motion(2).position[ONE]) == printed.TRANSLATION_23[:2, :]


@pytest.mark.parametrize("frame", FRAMES)
def test_places_of_markers_are_1_with_23_to_26(frame: str) -> None:
    """X of (24), u of (25) with (30), c of (23) and Q of (26), in (1)."""
    v = printed.displacement_30(*FRAMES[frame])
    found = {marker.name: marker for marker in derived(frame).markers}
    for name, at in MARKERS.items():
        X, u = (place.subs(xi, at) for place in (printed.POSITION_24, printed.displacement_25(v)))
        stated = printed_continuum.position_1(printed.TRANSLATION_23, printed.ROTATION_26, X, u)
        local = {d.symbol: d.expr for d in found[name].definitions}
        place = plain(found[name].position.xreplace(local).applyfunc(derived(frame).substituted))
        assert (place - stated[:2, :]).expand() == sp.zeros(2, 1)


def test_rotation_tensor_of_a_turn_about_e3_is_26() -> None:
    """The rotation tensor of the body in space, of the quaternion of that turn."""
    half = printed.phi / 2
    found = rotation_of((sp.cos(half), sp.S.Zero, sp.S.Zero, sp.sin(half)))
    assert (found - printed.ROTATION_26).applyfunc(sp.simplify) == sp.zeros(3, 3)


def test_rates_and_variations_of_the_turn_have_the_axis_27() -> None:
    """omega x r and delta pi x r, from the derivatives of the rotation tensor."""
    motion = planar_motion(2)
    r = sp.Matrix([*sp.symbols("r_1 r_2"), 0])
    (turn,) = motion.frame.rotations()
    varied = sp.Symbol("delta_phi") * plain(turn[R]) * r[:2, :]
    spun = plain(motion.frame.velocity[R]) * r[:2, :]
    assert varied == printed.axial_27(sp.Symbol("delta_phi")).cross(r)[:2, :]
    assert spun == printed.axial_27(printed.phidot).cross(r)[:2, :]


def test_mean_conditions_are_34_and_36() -> None:
    """On each power of xi; a condition may lose a factor, these do not."""
    mean = conditions(Frame("mean"))
    for n in range(6):
        found = [condition.on(polynomial([0] * n + [1])) for condition in mean]
        assert found == [printed.mean_displacement_34(xi**n), printed.mean_rotation_36(xi**n)]


def test_displacement_in_the_frame_of_the_middle_is_30() -> None:
    assert _sum_of_shapes("point") == sp.expand(printed.displacement_30(*printed.POINT_SHAPES))


def test_displacement_in_the_mean_frame_is_38() -> None:
    assert _sum_of_shapes("mean") == sp.expand(printed.displacement_38(*printed.MEAN_SHAPES))


def _sum_of_shapes(frame: str) -> sp.Expr:
    alpha = (plain(c.q) for c in derived(frame).coordinates[3:])
    return sp.expand(sum(a * shape for a, shape in zip(alpha, polynomials(frame), strict=True)))


@pytest.mark.parametrize(
    ("left", "conditions"),
    [
        (printed.displacement_30(*printed.POINT_SHAPES), (printed.CONDITION_28, printed.CONDITION_29)),
        (printed.displacement_38(*printed.MEAN_SHAPES), (printed.CONDITION_35, printed.CONDITION_37)),
    ],
)
def test_what_the_conditions_leave_of_21_is_30_and_38(left: sp.Expr, conditions: tuple[sp.Expr, ...]) -> None:
    """All of it: for each cubic that meets the conditions there are amplitudes alpha."""
    (solution,) = sp.solve(conditions, [printed.a0, printed.a1], dict=True)
    cubic = sp.expand(printed.DISPLACEMENT_21.subs(solution))
    alphas = [printed.alpha1, printed.alpha2]
    (found,) = sp.solve(sp.Poly(sp.expand(cubic - left), xi).coeffs(), alphas, dict=True)
    assert set(found) == set(alphas)
    assert sp.expand(cubic - left.subs(found)) == 0


def test_translation_does_not_couple_with_deformation_in_41() -> None:
    mass = derived("mean").mass
    assert not any(mass[i, j] for i in (0, 1) for j in (2, 3, 4))
    assert all(derived("point").mass[i, j] for i in (0, 1) for j in (2, 3))


def test_rotation_couples_with_deformation_in_products_alone_in_41() -> None:
    """In the row of phi the amplitudes stand in second order; in their rows with phidot^2, in first order."""
    shapes = {sp.Symbol(f"alpha{i}{dot}") for i in (1, 2) for dot in ("", "dot", "ddot")}
    phi = {printed.phidot, printed.phiddot}
    found = {}
    for row in ("phi", "alpha1", "alpha2"):
        for term in sp.Add.make_args(plain(derived("mean").row(row))):
            powers = term.as_powers_dict()
            orders = tuple(sum(int(powers[s]) for s in group if s in powers) for group in (shapes, phi))
            if all(orders):
                found.setdefault(row, set()).add(orders)
    assert found == {"phi": {(2, 1)}, "alpha1": {(1, 2)}, "alpha2": {(1, 2)}}


def test_5_of_25_entries_are_left_in_41_and_15_in_33() -> None:
    counts = {frame: sum(entry != 0 for entry in derived(frame).mass) for frame in FRAMES}
    assert counts == {"point": 15, "mean": 5}
