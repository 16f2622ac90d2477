"""The lines (14) to (20) and the appendix of the audit against their transcriptions: three points, two shapes."""

from __future__ import annotations

from random import Random
from typing import Any

import numpy as np
import pytest
import sympy as sp

from derive.report.notation.formula_reader import formula

from . import printed_appendix, printed_continuum
from .audit_lines import left, lines, right, sides, zero
from .formula_value import Meaning, Names, Value, column, scalar, tensor
from .printed_appendix import Cloud
from .printed_general import General, axial, equation_15, equation_20, first, gram

RANDOM = Random(1988)
INDICES = (0, 1)
ALPHA = (sp.Integer(4), sp.Integer(-7))


def some() -> sp.Matrix:
    return sp.Matrix(3, 1, lambda i, j: RANDOM.randint(-9, 9))


CLOUD = Cloud(
    tuple(map(sp.Integer, (2, 3, 5))),
    tuple(some() for _ in range(3)),
    tuple(tuple(some() for _ in range(3)) for _ in INDICES),
)


def at_point(p: int) -> Names:
    """rho is the mass of a point."""
    shapes = [shape[p] for shape in CLOUD.shapes]
    names = {"rho": scalar(CLOUD.masses[p]), "m": scalar(sum(CLOUD.masses)), "I": tensor(sp.eye(3))}
    vectors = {"X": tensor(CLOUD.X[p]), "Phi": column(shapes), "Phi_i": tensor(shapes[0])}
    return names | vectors | {"alpha": column(ALPHA)}


def over_the_cloud(integrand: Any) -> Value:
    values = [integrand(at_point(p)) for p in range(len(CLOUD.masses))]
    return Value(sum(value.data for value in values), values[0].columns)


MEANING = Meaning(at_point(0), over_the_cloud)


def table(of: Any) -> list[list[Any]]:
    return [[of(CLOUD, i, j) for j in INDICES] for i in INDICES]


INTEGRALS: dict[str, Any] = {
    "c1": printed_appendix.appendix_c1(CLOUD),
    "c2": [printed_appendix.appendix_c2(CLOUD, i) for i in INDICES],
    "C3": printed_appendix.appendix_C3(CLOUD),
    "C4": [printed_appendix.appendix_C4(CLOUD, i) for i in INDICES],
    "C5": table(printed_appendix.appendix_C5),
    "c6": [printed_appendix.appendix_c6(CLOUD, i) for i in INDICES],
    "c7": table(printed_appendix.appendix_c7),
    "c8": table(printed_appendix.appendix_c8),
}


def value(of: Any) -> Value:
    return column(of) if isinstance(of, list) else tensor(of)


@pytest.mark.parametrize("number", INTEGRALS)
def test_line_of_an_integral_is_the_transcription(number: str) -> None:
    found, stated = right(number, MEANING), value(INTEGRALS[number])
    assert found.columns == stated.columns
    assert zero(found.data - stated.data)


def test_composed_lines_of_the_appendix_are_the_transcriptions() -> None:
    at = Meaning({f"{k[0]}_{k[1]}": value(of) for k, of in INTEGRALS.items()} | {"alpha": column(ALPHA)})
    c1, c2, C3, C4, C5, c6, c7, _ = INTEGRALS.values()
    stated = {
        "J": printed_appendix.appendix_J(C3, C4, C5, ALPHA),
        "d1": printed_appendix.appendix_d1(c1, c2, ALPHA),
        "D2": [printed_appendix.appendix_D2(C4[i], C5[i], ALPHA) for i in INDICES],
        "d3": [printed_appendix.appendix_d3(c6[i], c7[i], ALPHA) for i in INDICES],
    }
    for number, of in stated.items():
        assert zero(right(number, at).data - value(of).data), number


def test_line_of_the_displacement_is_the_transcription() -> None:
    """(14), its last side."""
    _, _, last = lines("14")[0].split(" = ")
    stated = printed_continuum.displacement_14(ALPHA, [shape[0] for shape in CLOUD.shapes])
    assert zero(MEANING.value(formula(last)).data - tensor(stated).data)


def test_lines_of_the_conditions_are_the_transcriptions() -> None:
    field = CLOUD.shapes[0]
    stated = {
        "16": printed_continuum.held_16(field[0]),
        "17": printed_continuum.mean_displacement_17(CLOUD.masses, field),
        "19": printed_continuum.mean_rotation_19(CLOUD.masses, CLOUD.X, field),
    }
    for number, of in stated.items():
        assert zero(left(number, MEANING).data - tensor(of).data) and zero(right(number, MEANING).data), number


# (15) and (20): numbers in place of the free moments.

ROTATION = sp.Matrix(3, 3, sp.symbols("Q1:4(1:4)"))
BODY = General(2)
TERMS = {"15": equation_15(BODY, ROTATION), "20": equation_20(BODY)}
LEFT = {"delta c": ("c",), "delta pi": ("pi",), "delta alpha^T": ("alpha1", "alpha2")}


def numbers() -> dict[sp.Symbol, sp.Integer]:
    """A number for each symbol of the transcriptions; (19) holds, which (20) takes."""
    free = sorted({s for terms in TERMS.values() for t in terms for s in t.expr.free_symbols}, key=str)
    found = {s: sp.Integer(RANDOM.randint(1, 9)) for s in free}
    return found | {gram(0, i)[r, k]: found[gram(0, i)[k, r]] for i in (1, 2) for r in range(3) for k in range(r)}


NUMBERS = numbers()


def known(of: Any) -> Any:
    return [known(entry) for entry in of] if isinstance(of, list) else of.xreplace(NUMBERS)


def meaning() -> Meaning:
    one = (1, 2)
    vectors = {"c''": "c1ddot c2ddot c3ddot", "omega": "omega1:4", "omega'": "omega1dot omega2dot omega3dot"}
    names: dict[str, Any] = {name: sp.Matrix(sp.symbols(text)) for name, text in vectors.items()}
    names |= {"Q": ROTATION, "J": BODY.J, "d_1": BODY.d1, "c_2": [first(i) for i in one]}
    names |= {f"alpha{dots}": BODY.column(rate) for dots, rate in (("", ""), ("'", "dot"), ("''", "ddot"))}
    names |= {"D_2": [BODY.D2(i) for i in one], "d_3": [BODY.d3(i) for i in one]}
    names |= {"c_7": [[axial(i, j) for j in one] for i in one]}
    names |= {"c_8": [[gram(i, j).trace() for j in one] for i in one]}
    return Meaning({name: value(known(of)) for name, of in names.items()} | {"m": scalar(known(BODY.mass))})


@pytest.mark.parametrize("number", TERMS)
def test_rows_are_the_transcription(number: str) -> None:
    assert [line.split(":")[0] for line in lines(number)] == list(LEFT)
    for line, rows in zip(lines(number), LEFT.values(), strict=True):
        stated = []
        for row in rows:
            terms = [t.expr for t in TERMS[number] if t.row == row]
            stated += list(known(sum(terms[1:], terms[0])))
        found = np.ravel(meaning().value(sides(number, line)[1]).data)
        assert len(found) == len(stated) and all(stated)
        assert zero(found - np.array(stated, dtype=object)), line
