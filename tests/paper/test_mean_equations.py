"""(20) against the derivation under its conditions, and what the paper says in words around (17), (19) and (20)."""

from __future__ import annotations

from functools import cache

import pytest
import sympy as sp

from derive.mechanics.expanded_sums import expanded_moments, expanded_sums
from derive.mechanics.fixed_symbols import MASS
from derive.mechanics.motion.spatial import spatial_motion
from derive.mechanics.symbols import Family, identity, vector
from derive.mechanics.virtual_work_equations import linear_momentum
from paper.printed_general import General, PrintedVector, axial, equation_15, equation_20, first, gram
from paper.test_general_body import ROTATION, derived, derived_rows, differing

Rows = dict[str, tuple[sp.Expr, ...]]


def no_mean_rotation(n: int) -> dict[sp.Symbol, sp.Expr]:
    """(19): int rho X (x) Phi_i is symmetric."""
    pairs = [(gram(0, i), a, b) for i in range(1, n + 1) for a in range(3) for b in range(a)]
    return {g[a, b]: g[b, a] for g, a, b in pairs}


def no_mean_displacement(n: int) -> dict[sp.Symbol, int]:
    """(17), and the centre of mass in O."""
    return {s: 0 for p in range(n + 1) for s in first(p)}


def under(terms: tuple[PrintedVector, ...], conditions: dict) -> tuple[PrintedVector, ...]:
    return tuple(PrintedVector(t.row, t.text, t.expr.xreplace(conditions)) for t in terms)


@cache
def rows_under(n: int, mean: bool, displacement: bool = True, rotation: bool = True) -> Rows:
    """The derived rows with (17) and the choice of O, and with (19), or without."""
    conditions = (no_mean_displacement(n) if displacement else {}) | (no_mean_rotation(n) if rotation else {})
    return {row: tuple(e.xreplace(conditions) for e in found) for row, found in derived_rows(n, mean=mean).items()}


@pytest.mark.parametrize("n", [1, 2])
def test_equations_in_the_mean_frame_are_20(n: int) -> None:
    assert differing(under(equation_20(General(n)), no_mean_rotation(n)), rows_under(n, mean=True)) == set()


@pytest.mark.parametrize("index", range(len(equation_20(General(2)))))
@pytest.mark.parametrize("sign", [0, pytest.param(-1, marks=pytest.mark.long)])
def test_a_changed_term_of_20_is_noticed(index: int, sign: int) -> None:
    terms = list(under(equation_20(General(2)), no_mean_rotation(2)))
    changed = terms[index]
    terms[index] = PrintedVector(changed.row, changed.text, sign * changed.expr)
    assert differing(tuple(terms), rows_under(2, mean=True)) == {changed.row}


@pytest.mark.parametrize("n", [1, 2])
def test_19_cancels_c6_and_leaves_d3_proportional_to_alpha(n: int) -> None:
    """Not c3; and what d3 is proportional to is the whole column alpha."""
    body, rotation = General(n), no_mean_rotation(n)
    alpha = body.column("")
    for i in body.shapes:
        assert axial(0, i).xreplace(rotation) == sp.zeros(3, 1)
        d3 = body.d3(i).xreplace(rotation)
        minus_c7_alpha = sum((-a * axial(i, j) for j, a in enumerate(alpha, 1)), sp.zeros(3, 1))
        assert (d3 - minus_c7_alpha).expand() == sp.zeros(3, 1)


def test_20_needs_19_as_well() -> None:
    """With (17) and the choice of O alone the rows of the shapes keep omegadot . c6."""
    terms = under(equation_20(General(2)), no_mean_displacement(2))
    rows = rows_under(2, mean=False, rotation=False)
    assert differing(terms, rows) == {"alpha1", "alpha2"}
    omegadot = sp.Matrix(sp.symbols("omega1dot omega2dot omega3dot"))
    for i in (1, 2):
        missing = PrintedVector(f"alpha{i}", "wdot . c6", sp.Matrix([omegadot.dot(axial(0, i))]))
        terms = (*terms, missing)
    assert differing(terms, rows) == set()


def test_17_and_the_choice_of_o_cancel_d1_and_c2() -> None:
    """Under (17) and the choice of O, the terms of (15) without d1 and c2 are left."""
    body = General(2)
    terms = under(equation_15(body, ROTATION), no_mean_displacement(2))
    gone = {t.text for t in terms if t.expr.applyfunc(sp.expand).is_zero_matrix}
    assert gone == {t.text for t in terms if "d1" in t.text or "c2" in t.text}
    assert differing(terms, rows_under(2, mean=False, rotation=False)) == set()


def test_the_mass_matrix_is_sparser_in_the_mean_frame() -> None:
    """The accelerations of c leave all other rows, and those of the others leave the rows of c."""
    for n in (1, 2):
        general, mean = derived(n).mass, derived(n, mean=True).mass
        assert not any(mean[i, j] for i in range(3) for j in range(3, 6 + n))
        assert all(general[i, j] for i in range(3) for j in range(3, 6 + n))


def test_c_is_the_translation_of_the_centre_of_mass_when_o_is_there() -> None:
    """int rho xdot = m cdot takes (17) and the choice of O: with (17) alone c1 is left."""
    motion = spatial_motion(2)
    momentum = sp.Matrix([sp.expand(expanded_sums(motion, motion.row_sums).put_in(p)) for p in linear_momentum(motion)])
    written = momentum.xreplace({d.symbol: d.expr for d in expanded_moments(motion)[0]})
    of_c = MASS * vector(Family.TRANSLATION, 3, derivative=1)
    c1, c2 = ({s for s in written.free_symbols if identity(s).family is f} for f in (Family.C1, Family.C2))
    assert c1 and c2
    with_17 = written.xreplace(dict.fromkeys(c2, sp.S.Zero))
    assert (with_17 - of_c).expand() != sp.zeros(3, 1)
    assert (with_17.xreplace(dict.fromkeys(c1, sp.S.Zero)) - of_c).expand() == sp.zeros(3, 1)
