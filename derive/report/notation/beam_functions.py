"""Functions of xi along a beam as formulas: polynomials exactly, others with their numbers in decimals."""

from __future__ import annotations

from math import lcm

from derive.mechanics.bodies.beam_functions import BeamFunction, RealTerm
from derive.report.document.formula import (
    Call,
    Fenced,
    Formula,
    FormulaRow,
    Name,
    NumberToken,
    OperatorToken,
    Part,
    Power,
    Quotient,
)
from derive.report.notation.expressions import DIGITS, join, row
from derive.spec.model.beam_parts import Polynomial

XI = Name("xi")

SHAPE = "\N{GREEK PHI SYMBOL}"
"""The letter of the shape functions of a beam; its rotation is the other phi."""


def shape_name(index: str) -> Name:
    """A shape function of a beam."""
    return Name(SHAPE, below=(index,))


def beam_function(of: BeamFunction) -> tuple[Part, ...]:
    """The summands of a function."""
    if of.is_exact:
        return polynomial_of(of.coefficients)
    return tuple(part for term in of.real_terms for part in _parts(term))


def polynomial_of(coefficients: Polynomial) -> tuple[Part, ...]:
    """A polynomial in xi with ascending powers, behind its common denominator if it has one: 1/2 (-1 + 3 xi^2)."""
    shared = lcm(1, *(c.denominator for c in coefficients))
    parts = []
    for power, c in enumerate(coefficients):
        if c:
            whole = abs(c) * shared
            factor = [] if whole == 1 and power else [NumberToken(str(whole))]
            parts.append(Part("-" if c < 0 else "+", row([*factor, *_to_the(power)])))
    if shared == 1:
        return tuple(parts)
    fraction = Quotient(NumberToken("1"), NumberToken(str(shared)))
    if len(parts) == 1 and parts[0].sign == "+":
        return (Part("+", row([fraction, parts[0].formula])),)
    return (Part("+", FormulaRow((fraction, Fenced(join(parts))))),)


def _to_the(power: int) -> list[Formula]:
    """A power of xi; nothing for the power 0."""
    return [XI if power == 1 else Power(XI, NumberToken(str(power)))] if power else []


def _parts(term: RealTerm) -> list[Part]:
    """A cosine and a sine, each if it is there, with the power and the exponential before it."""
    result = []
    for factor, wave in ((term.cosine, "cos"), (term.sine, "sin")):
        factors: list[Formula] = [_number(abs(factor))] if abs(factor) != 1 else []
        factors += _to_the(term.power)
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
