"""The derivation against the brute force of tests/paper, and its zeros with their reasons."""

from __future__ import annotations

import pytest
import sympy as sp

import beams
from derive.mechanics.bodies.reference_conditions import assumed_shapes
from derive.mechanics.fixed_symbols import MASS
from derive.mechanics.motion.kinematics import PHI, R
from derive.mechanics.motion.moments import PlanarMoments, total
from paper import brute_force
from plain_symbols import plain

XI = sp.Symbol("xi")
SOON = {*((frame, 2) for frame in beams.FRAMES), ("mean", 1), ("point", 3)}
"""Each frame, and one with one shape and with three."""
CASES = [
    pytest.param(frame, n, marks=() if (frame, n) in SOON else pytest.mark.long)
    for frame in beams.FRAMES
    for n in (1, 2, 3)
]


def shapes_of(frame: str, n: int) -> list[sp.Expr]:
    spec = beams.beam(frame, n)
    shapes = assumed_shapes(spec.deflection)
    return [sum(sp.Rational(c) * XI**k for k, c in enumerate(s.coefficients)) for s in shapes]


def same(frame: str, n: int, found: sp.Expr, expected: sp.Expr) -> bool:
    expanded = plain(beams.made(frame, n).equations.substituted(found))
    return bool(brute_force.expanded(expanded - expected) == 0)


@pytest.mark.parametrize(("frame", "n"), CASES)
def test_rows_are_those_of_the_brute_force(frame: str, n: int) -> None:
    equations = beams.made(frame, n).equations
    for row, expected in brute_force.rows(shapes_of(frame, n)).items():
        assert brute_force.expanded(plain(equations.row(row)) - expected) == 0, row


@pytest.mark.parametrize(("frame", "n"), CASES)
def test_energy_and_momentum_are_those_of_the_brute_force(frame: str, n: int) -> None:
    equations, shapes = beams.made(frame, n).equations, shapes_of(frame, n)
    assert same(frame, n, equations.kinetic_energy, brute_force.kinetic_energy(shapes))
    assert same(frame, n, equations.strain_energy, brute_force.strain_energy(shapes))
    assert same(frame, n, equations.angular_momentum[0], brute_force.angular_momentum(shapes))
    for found, expected in zip(equations.linear_momentum, brute_force.linear_momentum(shapes), strict=True):
        assert same(frame, n, found, expected)


@pytest.mark.parametrize(("frame", "n"), CASES)
def test_markers_are_those_of_the_brute_force(frame: str, n: int) -> None:
    equations, shapes = beams.made(frame, n).equations, shapes_of(frame, n)
    at = {"left": sp.Integer(-1), "inside": sp.Rational(1, 3), "right": sp.Integer(1)}
    for marker in equations.markers:
        expected = brute_force.marker(shapes, at[marker.name])
        local = {d.symbol: d.expr for d in marker.definitions}
        for k in (0, 1):
            assert same(frame, n, marker.position[k].xreplace(local), expected.position[k])
            assert same(frame, n, marker.velocity[k].xreplace(local), expected.velocity[k])
            for j, coordinate in enumerate(equations.coordinates):
                gradient = sp.diff(expected.position[k], plain(coordinate.q))
                assert same(frame, n, marker.jacobian[k, j].xreplace(local), gradient)


@pytest.mark.parametrize(("frame", "n"), [(f, n) for f in beams.FRAMES for n in (1, 2, 5)])
def test_every_zero_has_its_reason_and_no_other_entry_is_zero(frame: str, n: int) -> None:
    equations = beams.made(frame, n).equations
    zeros = {(i, j): str(reason) for i, j, reason in equations.mass_zeros}
    size = equations.mass.rows
    for i in range(size):
        for j in range(i + 1):
            assert (equations.mass[i, j] == 0) == ((i, j) in zeros)
            assert equations.mass[i, j] == equations.mass[j, i]
    assert all(zeros.values()) and all(v.reason for v in equations.vanished)
    assert all((c.value == 0) == bool(c.zero) for c in equations.coefficients)


def test_reasons_are_the_conditions_of_the_paper() -> None:
    zeros = {(i, j): str(reason) for i, j, reason in beams.made("mean", 2).equations.mass_zeros}
    assert "condition (17)" in zeros[3, 0] and "condition (17)" in zeros[2, 0]
    assert "condition (19)" in zeros[3, 2]
    assert "parity" in zeros[4, 3]
    assert "orthogonality" in {(i, j): str(r) for i, j, r in beams.made("mean", 4).equations.mass_zeros}[5, 3]
    assert "(19)" not in {(i, j): str(r) for i, j, r in beams.made("point", 2).equations.mass_zeros}[3, 2]


@pytest.mark.parametrize("frame", beams.FRAMES)
def test_reasons_without_an_integral_are_the_known_identities(frame: str) -> None:
    """In the plane omega is parallel to J omega; translations do not couple; one shape does not act on itself."""
    for n in (1, 3):
        equations = beams.made(frame, n).equations
        bare = {(v.term.row, v.term.name): str(v.reason) for v in equations.vanished if not v.reason.causes}
        assert bare.pop(("phi", "centrifugal")) == "planar motion: omega x (J . omega) = 0"
        assert {name for _, name in bare} <= {"Coriolis"}
        assert list(bare) == ([("alpha1", "Coriolis")] if n == 1 else [])
        assert all("odd in its indices" in reason for reason in bare.values())
        assert [(i, j) for i, j, reason in equations.mass_zeros if not reason.causes] == [(1, 0)]


def test_terms_add_up_to_mass_and_force() -> None:
    equations = beams.made("point", 3).equations
    for i, coordinate in enumerate(equations.coordinates):
        row = sum(equations.mass[i, j] * other.a for j, other in enumerate(equations.rows)) + equations.force[i]
        terms = sum(t.expr for t in equations.terms if t.row == str(coordinate.q))
        assert sp.expand(row - terms) == 0
        assert sum(t.expr for t in equations.terms if t.row == str(coordinate.q) and t.name == "elastic") == (
            sp.diff(equations.strain_energy, coordinate.q)
        )


def test_a_result_that_depends_on_the_body_frame_is_refused() -> None:
    """r1 phi2 alone is no invariant of the two fields: the moments refuse to name it."""
    moments = PlanarMoments(MASS, sp.eye(2))
    only_first = sp.Matrix([[1, 0], [0, 0]])
    with pytest.raises(ArithmeticError, match="depends on the choice of the body frame"):
        total({R: only_first}, {PHI: sp.eye(2)}, moments)


def test_numbers_in_the_specification_are_folded() -> None:
    equations = beams.build(beams.beam("point", 2, mass=3, length="1/2", bending_stiffness=0.25)).equations
    values = {str(c.symbol): c.value for c in equations.coefficients}
    assert values["mass"] == 3 and values["C3"] == sp.Rational(1, 16)
    assert values["K_1_1"] == 64 * sp.Rational(1, 4) * 8
    assert equations.parameters == ()
