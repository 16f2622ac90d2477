"""Functions of xi along a beam as formulas: polynomials exactly, others with their numbers in decimals."""

from __future__ import annotations

import sympy as sp

from derive.mechanics.bodies.beam_functions import BeamFunction, RealTerm
from derive.report.document.formula import Call, Formula, FormulaRow, Name, NumberToken, OperatorToken, Part, Power
from derive.report.notation.expressions import DIGITS, polynomial, row
from derive.spec.model.body import Polynomial

XI = Name("xi")


def beam_function(of: BeamFunction) -> tuple[Part, ...]:
    """The summands of a function."""
    if of.is_exact:
        return polynomial_of(of.coefficients)
    return tuple(part for term in of.real_terms for part in _parts(term))


def polynomial_of(coefficients: Polynomial) -> tuple[Part, ...]:
    """A polynomial in xi with ascending powers."""
    return polynomial([sp.Rational(c) for c in coefficients], XI)


def _parts(term: RealTerm) -> list[Part]:
    """A cosine and a sine, each if it is there, with the power and the exponential before it."""
    result = []
    for factor, wave in ((term.cosine, "cos"), (term.sine, "sin")):
        factors: list[Formula] = [_number(abs(factor))] if abs(factor) != 1 else []
        factors += [XI if term.power == 1 else Power(XI, NumberToken(str(term.power)))] if term.power else []
        factors += [Power(Name("e"), _times_xi(term.growth))] if term.growth else []
        factors += [Call(wave, _times_xi(term.frequency))] if term.frequency else []
        if factor:
            result.append(Part("-" if factor < 0 else "+", row(factors or [NumberToken("1")])))
    return result


def _times_xi(factor: float) -> Formula:
    parts = ([OperatorToken("-")] if factor < 0 else [], [_number(abs(factor))] if abs(factor) != 1 else [])
    return FormulaRow((*parts[0], *parts[1], XI))


def _number(value: float) -> NumberToken:
    return NumberToken(f"{value:.{DIGITS}g}")
