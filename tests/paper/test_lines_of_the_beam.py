"""The lines (21) to (41) of the audit against their transcriptions, in symbols."""

from __future__ import annotations

from typing import Any

import pytest
import sympy as sp

from derive.report.notation.formula_reader import equation

from . import printed
from .audit_lines import ROWS, left, lines, right, sides, zero
from .formula_value import Meaning, Value, scalar, tensor

DOTS = {"": "", "'": "dot", "''": "ddot"}
SYMBOLS = {name: getattr(printed, name) for name in ("m", "l", "EI", "xi", "phi")}
SYMBOLS |= {f"phi{dots}": getattr(printed, f"phi{rate}") for dots, rate in DOTS.items()}
SYMBOLS |= {f"a_{k}": getattr(printed, f"a{k}") for k in range(4)}
SYMBOLS |= {
    f"{q}{dots}_{i}": getattr(printed, f"{q}{i}{rate}")
    for q in ("c", "alpha")
    for i in (1, 2)
    for dots, rate in DOTS.items()
}
SHAPES = sp.symbols("phi_1 phi_2")
V = 3 - 2 * printed.xi + 5 * printed.xi**2 + 7 * printed.xi**3
"""A cubic that meets no condition."""

UNITS = {f"e_{k + 1}": tensor(sp.eye(3)[:, k]) for k in range(3)}
NAMES = {name: scalar(symbol) for name, symbol in SYMBOLS.items()} | UNITS
NAMES |= {"ϕ_1": scalar(SHAPES[0]), "ϕ_2": scalar(SHAPES[1]), "δ phi": scalar(sp.Symbol("delta_phi"))}
NAMES |= {"v": scalar(V), "second derivative": scalar(sp.diff(V, printed.xi, 2))}


def along_the_beam(integrand: Any) -> Value:
    return scalar(sp.integrate(sp.expand(integrand(NAMES).data.item()), (printed.xi, -1, 1)))


MEANING = Meaning(NAMES, along_the_beam)

RIGHT = {
    "21": printed.DISPLACEMENT_21,
    "22": printed.strain_energy_22(V),
    "30": printed.displacement_30(*SHAPES),
    "31": printed.SHAPE_31,
    "32": printed.SHAPE_32,
    "38": printed.displacement_38(*SHAPES),
    "39": printed.SHAPE_39,
    "40": printed.SHAPE_40,
}
CONDITIONS = {
    "28": printed.CONDITION_28,
    "29": printed.CONDITION_29,
    "34": printed.mean_displacement_34(V),
    "35": printed.CONDITION_35,
    "36": printed.mean_rotation_36(V),
    "37": printed.CONDITION_37,
}
VECTORS = {
    "23": (printed.TRANSLATION_23,),
    "24": (printed.POSITION_24,),
    "25": (printed.displacement_25(V),),
    "26": (printed.ROTATION_26,),
    "27": (printed.axial_27(printed.phidot), printed.axial_27(sp.Symbol("delta_phi"))),
}
EQUATIONS = {"33": printed.EQUATION_33, "41": printed.EQUATION_41}


@pytest.mark.parametrize("number", RIGHT)
def test_line_is_the_transcription(number: str) -> None:
    assert RIGHT[number] != 0 and zero(right(number, MEANING).data - RIGHT[number])


@pytest.mark.parametrize("number", CONDITIONS)
def test_condition_is_the_transcription(number: str) -> None:
    assert CONDITIONS[number] != 0 and zero(left(number, MEANING).data - CONDITIONS[number])
    assert zero(right(number, MEANING).data)


@pytest.mark.parametrize("number", VECTORS)
def test_line_of_vectors_is_the_transcription(number: str) -> None:
    for line, stated in zip(lines(number), VECTORS[number], strict=True):
        assert zero(MEANING.value(sides(number, line)[1]).data - tensor(stated).data)


@pytest.mark.parametrize("number", EQUATIONS)
def test_rows_are_the_transcription(number: str) -> None:
    for line, row in zip(lines(number), printed.ROWS, strict=True):
        assert line.split(":")[0].removeprefix("delta ").replace("_", "") == row
        stated = printed.row_sum(EQUATIONS[number], row)
        assert zero(MEANING.value(sides(number, line)[1]).data - stated), line


def test_every_line_of_the_audit_is_evaluated() -> None:
    from .test_lines_of_sums import INTEGRALS, TERMS
    from .test_lines_of_vectors import STATED

    alone = ("7", "10", "11", "13", "14", "16", "17", "19", "J", "d1", "D2", "d3")
    assert sorted((*STATED, *INTEGRALS, *TERMS, *alone, *RIGHT, *CONDITIONS, *VECTORS, *EQUATIONS)) == sorted(ROWS)


@pytest.mark.parametrize("number", [row.number for row in ROWS.values() if row.misread])
def test_a_misread_line_is_the_line_with_other_dots(number: str) -> None:
    row = ROWS[number]
    assert len(row.shown) == len(row.lines)
    assert all(correct in "\n".join(row.lines) for correct, _ in row.misread)
    pairs = [[equation(line, row.scalars) for line in pair] for pair in zip(row.shown, row.lines, strict=True)]
    assert any(shown != line for shown, line in pairs)
    # What is mended are the dots of time, and two letters of J.
    without_dots = [[line.replace("'", "") for line in side] for side in (row.shown, row.lines)]
    assert (without_dots[0] == without_dots[1]) is (number != "J")
