"""Every formula on a page has the number of what was derived: terms, rows, moments, integrals, shapes."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from typing import Any

import numpy as np
import pages
import pytest
import sympy as sp
from formula_number import Draw, magnitude, number, total

from derive.mechanics.bodies.reference_conditions import assumed_shapes
from derive.mechanics.bodies.spatial_tables import DOCS
from derive.mechanics.fixed_symbols import MASS
from derive.mechanics.indexed_equations import IndexedEquations
from derive.mechanics.symbols import Family, amplitude, identity, owned, quantity
from derive.report.document.formula import Call, Equation, FormulaRow, Matrix, Name
from derive.report.notation.expressions import notation
from derive.report.notation.families import WRITERS, written
from derive.report.notation.integral_formulas import INTEGRANDS, SYMMETRIC
from derive.report.notation.typeset_names import chosen
from derive.report.sections.moments import moments
from derive.report.sections.terms import row_names

BODIES = (
    "point", "mean", "block", "loops", "beam_chord_2", "beam_point_8", "beam_mean_8",
    "heavy", "carrying", "flat", "loops_given", "rigid", "beam_point_1",
)  # fmt: skip
FLAT = [name for name in BODIES if not name.startswith("loops")]
LATER = ("beam_point_8", "beam_mean_8", "beam_point_1")
"""Other numbers of shapes than those of point, mean and the block, for tests with the mark `long`."""

BEAMS = [name for name in BODIES if name in ("point", "mean", "heavy") or name.startswith("beam")]


def each(names: Iterable[str]) -> list[Any]:
    return [pytest.param(name, marks=pytest.mark.long if name in LATER else ()) for name in names]


def draw(name: str) -> Draw:
    """Numbers for all symbols of a body; definitions have numbers of their own."""
    equations = pages.built(name).equations
    found = Draw(notation(equations))
    found.add(*(t.expr for t in equations.terms), *(v.term.expr for v in equations.vanished))
    found.add(*(s for d in equations.definitions for s in (d.symbol, d.expr)))
    if not isinstance(equations, IndexedEquations):
        found.add(*(s for c in equations.coefficients for s in (c.symbol, c.value)))
    for symbol in list(found.symbols):  # sines and products of omega are what they are
        if identity(symbol).family is Family.OMEGA_PRODUCT:
            first, second = (quantity(Family.ANGULAR_VELOCITY, k) for k in identity(symbol).components)
            found.add(first, second)
            found.give(symbol, found.symbols[first] * found.symbols[second])
    return found


def consistent(name: str, seed: int = 7) -> Draw:
    """Numbers for coordinates, rates, accelerations and parameters; all else has the number that it stands for."""
    equations = pages.built(name).equations
    found = Draw(notation(equations), seed)
    state = [c.q for c in equations.coordinates] + [s for row in equations.rows for s in (row.v, row.a)]
    found.add(*state, *(p.symbol for p in equations.parameters))
    for c in equations.coefficients:
        found.give(c.symbol, found.of(c.value))
    for d in equations.definitions:
        found.give(d.symbol, found.of(d.expr))
    return found


def close(parts, known_numbers, expected: float, digits: float = 1e-9) -> bool:
    return abs(total(parts, known_numbers) - expected) <= digits * max(magnitude(parts, known_numbers), 1e-30)


def rows(name: str) -> dict[str, list[Equation]]:
    """The equations of motion of a page by their rows."""
    found: dict[str, list[Equation]] = {}
    equations = pages.built(name).equations
    names = {notation(equations).variation(row): row for row in row_names(equations)}
    row = ""
    for line in pages.equations(pages.section(name, "motion")):
        row = names.get(line.left, row)
        found.setdefault(row, []).append(line)
    return found


@pytest.mark.parametrize("name", each(BODIES))
def test_rows_in_integrals_are_those_derived(name: str) -> None:
    equations, numbers = pages.built(name).equations, draw(name)
    shown = rows(name)
    assert list(shown) == list(row_names(equations))
    for row, lines in shown.items():
        assert close(lines[0].parts, numbers.formulas, numbers.of(equations.sum_of(row)))
        assert lines[0].number == "15"


@pytest.mark.parametrize("name", each(name for name in FLAT if name != "block"))
def test_rows_written_out_are_the_same(name: str) -> None:
    """The rows are evaluated with numbers of coordinates, rates, accelerations and parameters alone."""
    equations, numbers = pages.built(name).equations, consistent(name)
    plain = {numbers.notation.formula(s) for c in equations.coefficients for s in (c.symbol,) if s != MASS}
    plain |= {numbers.notation.formula(d.symbol) for d in equations.definitions if d.section not in ("Q", "oo")}
    state = {f: x for f, x in numbers.formulas.items() if f not in plain}
    for p in equations.parameters:
        state[numbers.notation.formula(p.symbol)] = numbers.symbols[p.symbol]
    for row, lines in rows(name).items():
        expected = numbers.of(equations.sum_of(row))
        for line in lines[1:]:
            assert close(line.parts, state, expected, 1e-5 if name == "heavy" else 1e-9)
        if len(lines) == 1 and name in ("point", "mean"):
            assert close(lines[0].parts, numbers.formulas, expected)


def test_which_rows_are_written_out() -> None:
    assert {len(lines) for lines in rows("block").values()} == {1}  # they would have 376 summands
    assert [len(lines) for lines in rows("point").values()] == [2] * 5
    assert [len(lines) for lines in rows("mean").values()] == [1, 1, 2, 2, 2]
    assert [line.number for lines in rows("point").values() for line in lines[1:]] == ["33"] * 5
    assert [line.number for lines in rows("mean").values() for line in lines[1:]] == ["41"] * 3
    assert {line.number for lines in rows("beam_chord_2").values() for line in lines[1:]} == {""}


@pytest.mark.parametrize("name", each(BODIES))
def test_moments_are_those_derived(name: str) -> None:
    """In a sum over the shapes, one summand is compared."""
    equations, numbers = pages.built(name).equations, draw(name)
    by_name = {d.symbol: d.expr for d in equations.definitions}
    if isinstance(equations, IndexedEquations):
        for c in equations.table_sums:
            by_name[c.symbol] = c.offset + sum(f * entry for f, entry in c.sums)
        by_name |= {t.symbol: t.offset + t.term for t in equations.mode_sums}
    numbers.add(*by_name, *by_name.values())
    found = [moment for some in moments(equations, numbers.notation) for moment in some]
    assert len(found) == len({m.symbol for m in found}) and (found or name == "rigid")
    for moment in found:
        assert close(moment.parts, numbers.formulas, numbers.of(by_name[moment.symbol]))
    shown = {line.left for line in pages.equations(pages.section(name, "moments"))}
    assert shown == {numbers.notation.written(m.symbol).formula for m in found}


@pytest.mark.parametrize("name", each(FLAT))
def test_integrals_have_their_values(name: str) -> None:
    equations = pages.built(name).equations
    values = Draw(notation(equations))
    values.add(*(c.value for c in equations.coefficients))
    there = [c for c in equations.coefficients if not c.zero]
    table = next(t for t in pages.tables(pages.section(name, "integrals")) if "value" in map(pages.plain, t.head))
    column = [pages.plain(h) for h in table.head].index("value")
    assert len(table.rows) == len(there)
    for row, c in zip(table.rows, there, strict=True):
        assert row[0].text[0].formula == values.notation.formula(c.symbol)
        assert row[-1].text[0].text == str(c.symbol)
        if isinstance(row[column].text[0], str):
            assert row[column].text == ("a parameter",)
            continue
        expected = values.of(c.value)
        assert number(row[column].text[0].formula, values.formulas) == pytest.approx(expected, rel=6e-6)


@pytest.mark.parametrize("name", ["point", "mean", "beam_chord_2", "heavy", "rigid"])
def test_mass_matrix_is_the_one_derived(name: str) -> None:
    equations, numbers = pages.built(name).equations, draw(name)
    (matrix,) = (
        part.formula
        for line in pages.equations(pages.section(name, "mass"))
        for part in line.parts
        if isinstance(part.formula, Matrix)
    )
    for i, row in enumerate(matrix.rows):
        for j, entry in enumerate(row):
            assert (entry is None) == (equations.mass[i, j] == 0)
            assert number(entry, numbers.formulas) == pytest.approx(numbers.of(sp.S.Zero + equations.mass[i, j]))


@pytest.mark.parametrize("name", each(BEAMS))
def test_shapes_and_ansatz_are_those_of_the_beam(name: str) -> None:
    spec = pages.built(name).spec
    at, factors = Fraction(3, 7), [Fraction(k + 2, 5) for k in range(len(spec.ansatz))]
    numbers = {Name("xi"): float(at)} | {Name("a", below=(str(j),)): float(a) for j, a in enumerate(factors)}
    lines = pages.equations(pages.section(name, "frame"))
    expected = sum(a * value(p, at) for a, p in zip(factors, spec.ansatz, strict=True))
    assert total(lines[0].parts, numbers) == pytest.approx(float(expected))
    shapes = assumed_shapes(spec.deflection)
    for line, shape in zip(lines[-len(shapes) :], shapes, strict=True):
        assert total(line.parts, numbers) == pytest.approx(float(value(shape.coefficients, at)))


def value(polynomial, at: Fraction) -> Fraction:
    return sum((c * at**n for n, c in enumerate(polynomial)), Fraction(0))


def test_kinematics_in_components_are_those_derived() -> None:
    from derive.mechanics.motion.kinematics import RDOT, R
    from derive.mechanics.motion.planar import planar_motion

    motion, numbers = planar_motion(0), draw("point")
    line = pages.equations(pages.section("point", "kinematics"))[-1]
    rows = [part.formula.parts for part in line.parts if isinstance(part.formula, FormulaRow)]
    assert all(row[0] == Name("Q", style="tensor") for row in rows) and len(rows) == 3
    given = [factor for row in rows for factor in row if isinstance(factor, Matrix)]
    for field, matrix in zip((R, RDOT), given, strict=True):
        found = np.array([[number(entry, numbers.formulas) for entry in row] for row in matrix.rows])
        expected = motion.acceleration[field].applyfunc(lambda e: sp.Float(numbers.of(sp.S.Zero + e)))
        assert np.allclose(found, np.array(expected.tolist(), dtype=float))


def test_every_family_is_written() -> None:
    assert set(WRITERS) == set(Family)


def test_quantities_of_scenes_have_their_body_above() -> None:
    rod = owned(amplitude(1, 1), "rod_2")
    assert written(rod).formula == Name("alpha", 1, ("1",), ("rod 2",))
    assert written(owned(quantity(Family.GUIDE, derivative=2), "slider")).formula == Name("s", 2, (), ("slider",))
    cosine = written(owned(quantity(Family.COSINE), "rod")).formula
    assert isinstance(cosine, Call) and cosine.of == Name("phi", 0, (), ("rod",))
    hub = owned(quantity(Family.POINT_POSITION, 1), "crank", "hub")
    assert written(hub).formula == Name("X", 0, ("hub 1",), ("crank",))


def test_formulas_of_integrals_are_those_of_the_derivation() -> None:
    """The report and the generated code of a body in space show the same integral for each table."""
    for family, (text, _) in DOCS.items():
        if family in INTEGRANDS:
            plain = INTEGRANDS[family].replace("><", "x").replace("{", "").replace("}", "")
            assert text.removeprefix("symmetric part of ") == f"int rho {plain}"
            assert (family in SYMMETRIC) == text.startswith("symmetric")


def test_names_that_users_choose() -> None:
    shown = {text: chosen(text) for text in ("EI", "l1", "m_rod", "k2_left_end")}
    assert shown["EI"] == Name("EI") and shown["l1"] == Name("l", below=("1",))
    assert shown["m_rod"] == Name("m", below=("rod",)) and shown["k2_left_end"] == Name("k", below=("2,left end",))
