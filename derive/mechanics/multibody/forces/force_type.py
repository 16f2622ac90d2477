"""What a type of force declares, and the virtual work of forces and torques at material points."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import ClassVar, Generic, TypeVar

import sympy as sp

from derive.mechanics.multibody.point_motion import PointMotion
from derive.mechanics.symbols import Symbol
from derive.mechanics.terms import EquationOfMotion, Intermediate, Term
from derive.spec.model.scene import Force, MarkerRef, Spring, TimeFunction, Torque

F = TypeVar("F", Force, Torque, Spring)

Constants = Mapping[str, sp.Expr]
"""The constants of a force by the names of their keys: numbers, or symbols of the derivation."""


@dataclass(frozen=True)
class GeneralisedForce:
    """Terms on the left-hand side of the rows, the intermediate quantities in them, and the potential, if any."""

    terms: tuple[Term, ...]
    definitions: tuple[Intermediate, ...] = ()
    potential: sp.Expr = sp.S.Zero


class ForceType(ABC, Generic[F]):
    """A type of force. Subclasses are registered in `registry.FORCES`.

    section: the table of a specification that its elements are in; doc: what tells it from others of its section, empty
    if its name does; units: its constants and their units; lengths: constants that are not negative; intermediates: the
    labels of the definitions it makes, so that no other name of a scene meets them; along_line: whether it acts, and is
    drawn, along the line between its markers.
    """

    section: ClassVar[str]
    doc: ClassVar[str] = ""
    units: ClassVar[Mapping[str, str]] = {}
    lengths: ClassVar[tuple[str, ...]] = ()
    intermediates: ClassVar[tuple[str, ...]]
    along_line: ClassVar[bool] = False

    @abstractmethod
    def markers(self, element: F) -> tuple[MarkerRef, ...]:
        """Where it acts."""

    @abstractmethod
    def generalised_force(
        self, element: F, points: tuple[PointMotion, ...], constants: Constants, rows: tuple[EquationOfMotion, ...]
    ) -> GeneralisedForce:
        """Its virtual work on the rows of a mechanism; `points` are the motions of its markers."""

    def functions(self, element: F) -> Iterator[tuple[str, TimeFunction]]:
        """The functions of time of the force, by their TOML keys."""
        yield from ()


class SpringType(ForceType[Spring]):
    """The type of a spring with a damper between two markers."""

    section = "springs"

    def markers(self, element: Spring) -> tuple[MarkerRef, ...]:
        """Its two ends."""
        return (element.first, element.second)


def force_terms(name: str, at: PointMotion, force: sp.Matrix, rows: tuple[EquationOfMotion, ...]) -> tuple[Term, ...]:
    """The virtual work of a force: its product with the columns of the Jacobian of the point."""
    return _terms(name, sp.expand(force.dot(at.acceleration)), rows)


def torque_terms(name: str, at: PointMotion, torque: sp.Expr, rows: tuple[EquationOfMotion, ...]) -> tuple[Term, ...]:
    """The virtual work of a torque about e3 on the section at a point."""
    return _terms(name, sp.expand(torque * at.angular_acceleration), rows)


def _terms(name: str, work: sp.Expr, rows: tuple[EquationOfMotion, ...]) -> tuple[Term, ...]:
    present = work.free_symbols
    factors = ((row, work.coeff(row.a)) for row in rows if row.a in present)
    return tuple(Term(row.name, name, "(10)", -factor) for row, factor in factors if factor != 0)


def define(symbol: Symbol, value: sp.Expr, doc: str, definitions: list[Intermediate]) -> sp.Expr:
    """A number as it is; else a symbol, whose definition is added to the list."""
    if value.is_Rational:
        return value
    definitions.append(Intermediate(symbol, value, symbol.name, "(10)", doc))
    return symbol
