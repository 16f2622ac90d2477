"""The data of the audit of the paper: rows, assumptions and statements."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from derive.report.document.formula import Equation

Verdict = Literal["equal", "equal after the correction", "definition", "assumption"]
"""`equal`: the formula in the text equals the derived one; `equal after the correction`: it does once the faults of the
text are corrected; `definition`: it defines a name; `assumption`: the paper, or a user, chooses it."""

Derived = Callable[[], tuple[Equation, ...]]
"""A function that returns the derived equations, called when the page is built."""

Source = Literal["the package", "a test", "the user"]
"""Who derives, or chooses: the derivation that makes code, a test that the package does not need, the specification."""


@dataclass(frozen=True)
class AuditRow:
    """One equation of the paper, or one line of its appendix.

    `shown` are its lines as the recognised text has them, `holds` the same lines with the faults mended (empty where
    nothing is to be mended), both in the notation of `reader`. `where` are the places that define it here, each as
    `file::name`; `tests` the node ids of the tests that compare it.
    """

    number: str
    title: str
    shown: tuple[str, ...]
    verdict: Verdict
    derived: Derived
    by: Source
    holds: tuple[str, ...] = ()
    correction: str = ""
    note: str = ""
    where: tuple[str, ...] = ()
    tests: tuple[str, ...] = ()
    scalars: bool = False

    @property
    def true(self) -> tuple[str, ...]:
        """The correct lines."""
        return self.holds or self.shown

    @property
    def anchor(self) -> str:
        """The anchor of the row on the page."""
        return f"eq-{self.number}"


@dataclass(frozen=True)
class AuditSection:
    """The rows of one section of the paper."""

    title: str
    anchor: str
    rows: tuple[AuditRow, ...]


@dataclass(frozen=True)
class Assumption:
    """An assumption that the paper makes in words, its place, its meaning here, and the options that lift it.

    `options` are keys of a specification, such as `beam.gravity`; none where nothing lifts it yet. `lifts`
    describes what they lift, and what remains.
    """

    name: str
    place: str
    here: str
    options: tuple[str, ...] = ()
    lifts: str = ""


@dataclass(frozen=True)
class Statement:
    """A statement of the paper outside of its equations, paraphrased: its place, what is true, and tests that prove it.

    The place is also the key by which tests are marked. Formulas stand between dollar signs, code between backticks;
    likewise in the texts of rows and assumptions.
    """

    place: str
    shown: str
    verdict: Literal["holds", "holds after the correction", "not compared"]
    holds: str
    tests: tuple[str, ...] = ()


def tests(file: str, *names: str) -> tuple[str, ...]:
    """Node ids of tests of the paper."""
    return tuple(f"tests/paper/{file}::{name}" for name in names)
