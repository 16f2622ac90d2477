"""The values that a section of a beam needs, in the plane and in space: constants, and the motion of its instance."""

from __future__ import annotations

from collections.abc import Collection
from typing import TYPE_CHECKING

from derive.algebra import sp
from derive.mechanics.symbols import element
from derive.mechanics.terms import ModelConstant

if TYPE_CHECKING:
    from derive.mechanics.body import Body
    from derive.mechanics.multibody.instances import InstanceEquations


class SectionValues:
    """The constants of a section with a name, which is one of `what`, and those of the part of the beam behind it."""

    def __init__(self, name: str, what: str, instance: InstanceEquations) -> None:
        self.name, self.what, self.instance = name, what, instance
        self._constants: dict[sp.Symbol, ModelConstant] = {}

    @property
    def constants(self) -> tuple[ModelConstant, ...]:
        """The constants that have been used so far."""
        return tuple(self._constants.values())

    def constant(self, label: str, value: sp.Expr, doc: str, unit: str) -> sp.Expr:
        """Return a number as it is, and a value that depends on parameters as a constant of the model."""
        value = sp.expand(value)
        if value.is_Rational:
            return value
        symbol = element(self.name, label)
        self._constants[symbol] = ModelConstant(symbol, value, "", f"{doc}; {self.what} {self.name}", unit)
        return symbol

    def known(self, part: Body, gravity: Collection[ModelConstant]) -> dict[sp.Basic, sp.Expr]:
        """The values of the symbols of a part of the beam, which moves as the instance does, besides gravity."""
        known: dict[sp.Basic, sp.Expr] = {}
        for own, of_instance in zip(part.motion.coordinates, self.instance.coordinates, strict=True):
            known[own.q] = of_instance.q
        for own_row, row in zip(part.motion.rows, self.instance.rows, strict=True):
            known |= {own_row.v: row.v, own_row.a: row.a}
        for c in part.constants:
            if c not in gravity:
                known[c.symbol] = sp.S.Zero if c.zero else self.constant(c.symbol.name, c.value, c.doc, c.unit)
        return known
