"""Variables of a model that symbols of the derivation become."""

from __future__ import annotations

from derive.algebra import sp
from derive.ir.model import Variable
from derive.mechanics.symbols import identity
from derive.roles import Role


def symbol_variable(symbol: sp.Symbol, doc: str, unit: str, role: Role | None = None) -> Variable:
    """A coordinate or a velocity with its name for people."""
    return Variable(str(symbol), doc, unit, role=role, shown=identity(symbol).shown)
