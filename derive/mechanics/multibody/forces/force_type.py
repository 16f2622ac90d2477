"""The base class of the types of forces, and the virtual work of forces and torques at material points."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar, Generic, TypeVar

from derive.algebra import sp, zero
from derive.mechanics.quantity import rounded
from derive.mechanics.symbols import element
from derive.mechanics.terms import EquationOfMotion, Intermediate, Term
from derive.spec.model.forces import CustomForce, SceneForce
from derive.spec.model.keys import Key
from derive.spec.model.markers import MarkerRef

if TYPE_CHECKING:
    from derive.mechanics.multibody.point_motion import PointMotion
    from derive.mechanics.typed_symbol import Symbol

F = TypeVar("F", bound=SceneForce)

Values = Mapping[str, Any]
"""The values of the keys of a force as expressions: numbers, symbols of parameters, functions of t, columns of 2."""


@dataclass(frozen=True)
class GeneralisedForce:
    """Terms on the left-hand side of the rows, and the intermediate quantities in them.

    `potential` (J) is the energy it stores, if any; `dissipation` (W, not positive) the power it takes away from it.
    """

    terms: tuple[Term, ...]
    definitions: tuple[Intermediate, ...] = ()
    potential: sp.Expr = field(default_factory=zero)
    dissipation: sp.Expr = field(default_factory=zero)


class ForceType(ABC, Generic[F]):
    """A type of force. Subclasses are registered in `registry.FORCES`.

    section: the table of a specification that its elements are in: `forces`, at a marker; `torques`, at a marker, with
    a reaction at a second one or without; `springs`, between two markers. doc: what distinguishes it from others of its
    section, empty if its name does; keys: what its table has besides `kind` and the markers; lengths: keys whose values
    are not negative, where another type of the section allows both signs; intermediates: the labels of the definitions
    it makes, so that no other name of a scene meets them; along_line: whether it acts, and is drawn, along the line
    between its markers.
    """

    section: ClassVar[str]
    doc: ClassVar[str] = ""
    keys: ClassVar[tuple[Key, ...]] = ()
    lengths: ClassVar[tuple[str, ...]] = ()
    intermediates: ClassVar[tuple[str, ...]] = ()
    along_line: ClassVar[bool] = False

    @abstractmethod
    def generalised_force(
        self, element: F, points: tuple[PointMotion, ...], values: Values, rows: tuple[EquationOfMotion, ...]
    ) -> GeneralisedForce:
        """Return the virtual work of an element on the rows of a mechanism; `points` are the motions of its markers."""

    def element(self, name: str, kind: str, markers: tuple[MarkerRef, ...], values: Mapping[str, Any]) -> SceneForce:
        """An element of a scene from the values of its keys as they are specified."""
        return CustomForce(name, kind, markers, values)

    def specified(self, element: F) -> Mapping[str, Any]:
        """The values of the keys of an element as they are specified."""
        if isinstance(element, CustomForce):
            return element.values
        return {key.name: getattr(element, key.name) for key in self.keys}


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


def section_rotation(owner: str, doc: str, at: PointMotion, definitions: list[Intermediate]) -> sp.Matrix:
    """The rotation matrix of the section at a point, whose cosine and sine are added to the definitions.

    owner: the element whose definitions they are; doc: what the element is called.
    """
    cosine, sine = (
        define(element(owner, label), rounded(function(at.rotation)), f"{text} of the section of {doc}", definitions)
        for label, function, text in (
            ("cos", sp.cos, "cosine of the rotation"),
            ("sin", sp.sin, "sine of the rotation"),
        )
    )
    return sp.Matrix([[cosine, -sine], [sine, cosine]])


def define(symbol: Symbol, value: sp.Expr, doc: str, definitions: list[Intermediate]) -> sp.Expr:
    """Return a number as it is; for other values a symbol, whose definition is added to the list."""
    if value.is_Rational:
        return value
    definitions.append(Intermediate(symbol, value, symbol.name, "(10)", doc))
    return symbol


def intermediate(symbol: Symbol, expr: sp.Expr, section: str, doc: str, definitions: list[Intermediate]) -> sp.Expr:
    """Return a number rounded to a double; for other expressions a symbol, whose definition in `section` is added."""
    if expr.is_number:
        return rounded(expr)
    definitions.append(Intermediate(symbol, expr, section, "(10)", doc))
    return symbol
