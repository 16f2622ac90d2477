"""The lines (1) to (13) and (18) of the audit against their transcriptions, with whole numbers in their components."""

from __future__ import annotations

from random import Random

import pytest
import sympy as sp

from . import printed, printed_continuum
from .audit_lines import left, right, zero
from .formula_value import Meaning, product, scalar, tensor

RANDOM = Random(1988)
VECTORS = ("c", "X", "u", "w", "d X", "n", "b", "x", "e", "∇", "omega", "omega'", "u'", "u''", "c''", "x''")
VARIED = ("δ c", "δ pi", "δ u", "δ x")


def some(columns: int = 1) -> sp.Matrix:
    return sp.Matrix(3, columns, lambda i, j: RANDOM.randint(-9, 9))


def symmetric() -> sp.Matrix:
    half = some(3)
    return half + half.T


V = {name: some() for name in (*VECTORS, *VARIED)}
Q, F = some(3), some(3)
E, T, DELTA_E = symmetric(), symmetric(), symmetric()
RHO, MU, LAMDA, CHI = map(sp.Integer, (3, 5, -2, 7))
TENSORS = {"Q": Q, "F": F, "E": E, "T": T, "δ E": DELTA_E, "I": sp.eye(3)}
SCALARS = {"rho": RHO, "mu": MU, "lambda": LAMDA, "chi": CHI}
NAMES = {name: tensor(value) for name, value in (V | TENSORS).items()} | {k: scalar(v) for k, v in SCALARS.items()}
ONCE = Meaning(NAMES, lambda integrand: integrand(NAMES))
"""Integrals are taken over one point."""

R = V["X"] + V["u"]
STATED = {
    "1": printed_continuum.position_1(V["c"], Q, V["X"], V["u"]),
    "2": printed_continuum.difference_2(Q, V["d X"], V["w"], V["u"]),
    "3": printed_continuum.line_element_3(F, V["d X"]),
    "4": printed.deformation_4(Q, V["∇"] * V["u"].T),
    "5": printed.acceleration_5(V["c''"], Q, V["omega"], V["omega'"], R, V["u'"], V["u''"]),
    "6": printed.virtual_displacement_6(V["δ c"], Q, V["δ pi"], R, V["δ u"]),
    "8": printed_continuum.stress_8(E, MU, LAMDA),
    "9": printed.green_lagrange_9(F),
    "12": printed_continuum.load_12(T, F, V["n"]),
    "18": printed_continuum.rotation_18(CHI, V["e"], V["X"]),
}


@pytest.mark.parametrize("number", STATED)
def test_line_is_the_transcription(number: str) -> None:
    assert zero(right(number, ONCE).data - tensor(STATED[number]).data)


AT = sp.symbols("X1:4")
STRESS = T * V["∇"].dot(sp.Matrix(AT))
"""A stress that is T at one place, and whose divergence is nabla . T, nabla taken for a vector."""
THERE = dict(zip(AT, V["∇"] / V["∇"].dot(V["∇"]), strict=True))


def test_lines_with_a_divergence_are_the_transcriptions() -> None:
    stated = printed_continuum.momentum_7(STRESS, F, RHO, V["b"], V["x''"], AT).subs(THERE)
    assert zero(left("7", ONCE).data - right("7", ONCE).data - tensor(stated).data)
    work = printed_continuum.virtual_work_10(STRESS, F, RHO, V["x''"], V["δ x"], AT).subs(THERE)
    assert zero(left("10", ONCE).data - work) and zero(right("10", ONCE).data)


def test_lines_of_virtual_work_are_the_transcriptions() -> None:
    inside = printed_continuum.volume_11(T, DELTA_E, RHO, V["x''"], V["δ x"])
    assert zero(left("11", ONCE).data - inside)
    assert zero(right("11", ONCE).data - printed_continuum.surface_11(T, F, V["n"], V["δ x"]))
    inside = printed_continuum.volume_13(E, DELTA_E, MU, LAMDA, RHO, V["x''"], V["δ x"])
    assert zero(left("13", ONCE).data - inside) and zero(right("13", ONCE).data)


def test_products_of_values() -> None:
    """The evaluation itself: u x (w x n) = w (u . n) - n (u . w), and a dyad on a vector."""
    u, w, n = V["u"], V["w"], V["n"]
    inner = product("\u00d7", tensor(u), product("\u00d7", tensor(w), tensor(n)))
    assert zero(inner.data - tensor(w * u.dot(n) - n * u.dot(w)).data)
    assert zero(product("·", product("", tensor(u), tensor(w)), tensor(n)).data - tensor(u * w.dot(n)).data)
