"""A formula as a small tree, the same for MathML, LaTeX, Typst and plain text."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class NumberToken:
    """A number as it is written, such as `3`, `-1` or `0.1`."""

    text: str


@dataclass(frozen=True)
class Name:
    """A symbol: one letter or a word, with a time derivative (`dots`), indices below and above.

    `style` is how it is set: scalars italic, vectors bold italic, tensors and matrices bold upright, words upright.
    """

    text: str
    dots: int = 0
    below: tuple[str, ...] = ()
    above: tuple[str, ...] = ()
    style: Literal["scalar", "vector", "tensor", "word"] = "scalar"


@dataclass(frozen=True)
class OperatorToken:
    """An operator between formulas or before a formula: = + - and others."""

    text: str


@dataclass(frozen=True)
class FormulaRow:
    """Formulas beside each other."""

    parts: tuple[Formula, ...]


@dataclass(frozen=True)
class Quotient:
    """One formula over another."""

    above: Formula
    below: Formula


@dataclass(frozen=True)
class Power:
    """A formula with an exponent."""

    base: Formula
    exponent: Formula


@dataclass(frozen=True)
class Root:
    """A square root."""

    of: Formula


@dataclass(frozen=True)
class Fenced:
    """A formula in brackets."""

    of: Formula
    left: str = "("
    right: str = ")"


@dataclass(frozen=True)
class Call:
    """A function such as sin or cos of a formula."""

    name: str
    of: Formula


@dataclass(frozen=True)
class Matrix:
    """Rows of formulas in brackets; a structural zero is None, shown as a dot."""

    rows: tuple[tuple[Formula | None, ...], ...]


Formula = NumberToken | Name | OperatorToken | FormulaRow | Quotient | Power | Root | Fenced | Call | Matrix


@dataclass(frozen=True)
class Part:
    """A summand of a long equation: its sign, its formula, and the term it is, by which other places link to it.

    `group` is the name of its group (accelerations, rates, elastic, ...); `title` is the text that hovering shows.
    `to` is the target of its link, such as `#line-120` of the code that computes it; without one it links to itself.
    """

    sign: Literal["+", "-"]
    formula: Formula
    anchor: str = ""
    group: str = ""
    title: str = ""
    to: str = ""


@dataclass(frozen=True)
class Equation:
    """left = right, or a sum of parts that breaks between them; `number` is that of the paper, `anchor` its own."""

    left: Formula
    parts: tuple[Part, ...]
    relation: str = "="
    number: str = ""
    anchor: str = ""
