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


@dataclass(frozen=True)
class AuditRow:
    """One equation of the paper, or one line of its appendix.

    `lines` are those of the paper as `formula_reader` takes them, `scalars` is its option. `misread` are pairs: a part
    of the lines, and how the recognised text shows it. `derived` returns the equations that the package derives or the
    user specifies; `stated` are the lines that tests derive where the package does without them. `where` are the places
    that define it here, `tests` those that compare it in the folder `tests/paper`, each as `file::name`.
    """

    number: str
    title: str
    lines: tuple[str, ...]
    kind: Literal["equal", "definition", "assumption"] = "equal"
    derived: Derived | None = None
    stated: tuple[str, ...] = ()
    by_user: bool = False
    misread: tuple[tuple[str, str], ...] = ()
    correction: str = ""
    note: str = ""
    where: tuple[str, ...] = ()
    tests: tuple[str, ...] = ()
    scalars: bool = False

    @property
    def shown(self) -> tuple[str, ...]:
        """The lines as the recognised text has them."""
        text = "\n".join(self.lines)
        for correct, recognised in self.misread:
            text = text.replace(correct, recognised)
        return tuple(text.split("\n"))

    @property
    def verdict(self) -> Verdict:
        """The result of the comparison of the text with the derivation."""
        return "equal after the correction" if self.misread else self.kind

    @property
    def source(self) -> str:
        """Who derives, or chooses: the package, a test that the package does not need, or the specification."""
        return "specified" if self.by_user else "derived in a test" if self.stated else "derived"

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

    Formulas stand between dollar signs, code between backticks; likewise in the texts of rows and assumptions.
    """

    place: str
    shown: str
    verdict: Literal["holds", "holds after the correction", "not compared"]
    holds: str
    tests: tuple[str, ...] = ()


def tests(file: str, *names: str) -> tuple[str, ...]:
    """Tests of a file."""
    return tuple(f"{file}::{name}" for name in names)
