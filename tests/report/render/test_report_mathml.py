"""Formulas as MathML and in words: letters, dots, gaps, brackets."""

# ruff: noqa: RUF001 - letters are what is tested

from __future__ import annotations

import re
from xml.etree import ElementTree

import pytest
import sample_report
from sample_report import EVERYTHING, PHI, PHI1, alpha, row, square

from derive.report.document.formula import (
    Call,
    Fenced,
    Formula,
    Matrix,
    Name,
    NumberToken,
    OperatorToken,
    Part,
    Power,
    Quotient,
    Root,
)
from derive.report.notation.glyphs import index, number, styled
from derive.report.notation.spoken_math import equation_words, words
from derive.report.writers.mathml import math, math_in_text, mathml, summand_math

M, TIMES, APPLY = "\u2212", "\u2062", "\u2061"


def plain(formula: Formula) -> str:
    """The characters of a formula, whose MathML has to be XML."""
    return "".join(ElementTree.fromstring(math(formula)).itertext())


def test_letters() -> None:
    assert [mathml(Name(text)) for text in ("a", "alpha", "Phi", "phi")] == [f"<mi>{c}</mi>" for c in "aαΦφ"]
    assert mathml(Name("EI")) == "<mi>𝐸𝐼</mi>"
    assert mathml(Name("omega", style="vector")) == "<mi>𝝎</mi>"
    assert mathml(Name("Phi", style="vector")) == "<mi>𝜱</mi>"
    assert mathml(Name("J", style="tensor")) == "<mi>𝐉</mi>"
    assert mathml(Name("C4", style="tensor")) == "<mi>𝐂𝟒</mi>"
    assert mathml(Name("h", style="word")) == '<mi mathvariant="normal">h</mi>'
    assert mathml(Name("max", style="word")) == "<mi>max</mi>"
    assert styled("h", "ITALIC") == "ℎ" and styled("é", "BOLD") == "é"


def test_dots_are_spacing_accents() -> None:
    dotted = '<mover accent="true"><mi>φ</mi><mo>{}</mo></mover>'
    assert mathml(PHI1) == dotted.format("˙")
    assert mathml(Name("phi", 2)) == dotted.format("¨")
    assert mathml(alpha(1, 1)) == '<msub><mover accent="true"><mi>α</mi><mo>˙</mo></mover><mn>1</mn></msub>'


def test_indices() -> None:
    assert plain(Name("C", below=("1", "2"))) == "C12"
    assert plain(Name("C", below=("1", "12"))) == "C1,12"
    assert plain(Name("C", below=("alpha", "j"))) == "Cαj"
    assert plain(Name("x", below=("max",), above=("T",))) == "xmaxT"
    assert index(("i=1",)) == ["i", "=", "1"]
    assert mathml(Name("x", above=("T",))) == "<msup><mi>x</mi><mi>T</mi></msup>"
    assert mathml(Name("∑", below=("i",))).startswith("<munder>")
    assert mathml(Name("∫", below=("V",))).startswith("<msub>")


def test_numbers() -> None:
    assert plain(NumberToken("-1")) == f"{M}1"
    assert plain(NumberToken("1.5e-05")) == f"1.5⋅10{M}5"
    assert number("2e+10") == ("2", "10") and number("0.5") == ("0.5", "")


def test_products() -> None:
    assert plain(row(Name("m"), Name("l"))) == f"m{TIMES}l"
    assert plain(row(NumberToken("2"), NumberToken("3"))) == "2⋅3"
    assert plain(row(NumberToken("2"), Quotient(NumberToken("1"), NumberToken("3")))) == "2⋅13"
    assert 'lspace=".17em"' in mathml(row(Name("EI"), Name("l")))
    assert plain(row(OperatorToken("δ"), Name("c"))) == "δc"
    assert plain(row(Name("rho"), OperatorToken("d"), Name("V"))) == f"ρ{TIMES}dV"
    assert plain(row(Name("a"), OperatorToken("-"), Name("b"))) == f"a{M}b"


def test_functions() -> None:
    assert plain(Call("cos", PHI)) == f"cos{APPLY}φ"
    assert plain(row(Call("cos", PHI), Name("m"))) == f"cos{APPLY}(φ){TIMES}m"
    assert plain(row(Call("cos", PHI), OperatorToken("+"), Name("m"))) == f"cos{APPLY}φ+m"
    assert plain(Call("sin", row(NumberToken("2"), PHI))) == f"sin{APPLY}(2{TIMES}φ)"
    assert plain(square(Call("sin", PHI))) == f"sin2{APPLY}φ"
    assert plain(Call("f", Fenced(PHI, "[", "]"))) == f"f{APPLY}[φ]"


def test_powers_get_brackets() -> None:
    assert mathml(square(PHI)) == "<msup><mi>φ</mi><mn>2</mn></msup>"
    assert mathml(square(alpha(1))) == "<msubsup><mi>α</mi><mn>1</mn><mn>2</mn></msubsup>"
    assert plain(square(row(Name("a"), OperatorToken("+"), Name("b")))) == "(a+b)2"
    assert plain(square(Quotient(Name("a"), Name("b")))) == "(ab)2"
    assert plain(square(NumberToken("-1"))) == f"({M}1)2"
    assert plain(square(Name("x", above=("i",)))) == "(xi)2"
    assert plain(Power(square(Name("x")), Name("n"))) == "(x2)n"


def test_signs_of_summands() -> None:
    a, b = Name("a"), Name("b")
    assert summand_math(Part("+", a), True) == "<math><mi>a</mi></math>"
    assert summand_math(Part("-", a), True) == f'<math><mo form="prefix">{M}</mo><mi>a</mi></math>'
    assert summand_math(Part("+", a), False) == '<math><mo form="infix">+</mo><mi>a</mi></math>'
    shown = "".join(ElementTree.fromstring(summand_math(Part("-", row(a, OperatorToken("+"), b)), False)).itertext())
    assert shown == f"{M}(a+b)"


def test_zeros_of_a_matrix_are_dots() -> None:
    assert plain(Matrix(((Name("a"), None), (None, NumberToken("0"))))) == "[a··0]"


def test_long_sums_within_text_break_between_their_terms() -> None:
    a = row(Name("m"), Call("cos", PHI))
    short = row(Name("a"), OperatorToken("+"), Name("b"))
    assert math_in_text(short) == math(short)
    long = math_in_text(row(a, OperatorToken("+"), a, OperatorToken("-"), Fenced(short), OperatorToken("="), a))
    assert long.count("<math ") == 4 and long.count('form="infix"') == 3


def test_every_symbol_is_there() -> None:
    shown = plain(EVERYTHING)
    for symbol in ("∑", "ξ", "γ", "μ", "Ω", "λ", "cos", "sin", "max", "10,2", "i=1", "N", '<b>&"$#_{\\'):
        assert "".join(styled(c, "ITALIC") for c in symbol) in shown or symbol in shown, symbol
    tags = set(re.findall(r"<(\w+)", math(EVERYTHING)))
    core = "math mrow mi mn mo msup msub msubsup munder mover munderover mfrac msqrt mtable mtr mtd"
    assert tags <= set(core.split())


@pytest.mark.parametrize(
    ("formula", "said"),
    [
        (alpha(1, 2), "alpha double dot sub 1"),
        (Quotient(Name("m"), NumberToken("3")), "m over 3"),
        (Quotient(row(Name("m"), square(Name("l"))), NumberToken("12")), "fraction m l squared over 12 end fraction"),
        (square(row(Name("a"), OperatorToken("-"), Name("b"))), "open bracket a minus b close bracket squared"),
        (Call("cos", PHI), "cos of phi"),
        (Root(NumberToken("2")), "root of 2 end root"),
        (NumberToken("1.5e-05"), "1.5 times 10 to the power minus 5"),
        (Matrix(((Name("a"), None),)), "1 by 2 matrix, row 1: a, zero, end matrix"),
        (Name("∑", below=("i=1",), above=("N",)), "sum from i equals 1 to N"),
        (row(NumberToken("2"), NumberToken("3")), "2 times 3"),
    ],
)
def test_words(formula: Formula, said: str) -> None:
    assert words(formula) == said


def test_words_of_an_equation() -> None:
    assert equation_words(sample_report.deforming(1)).startswith(
        "delta alpha sub 1 : m over 5 alpha double dot sub 1 minus m over 5 phi dot squared alpha sub 1 plus"
    )
