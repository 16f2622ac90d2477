"""SymPy as `sp`, which is loaded when one of its names is first used.

The modules that describe joints, bodies, forces and outputs also derive their equations. A specification is checked,
and a kept model is simulated, with the descriptions alone, so that SymPy would be loaded in vain.
"""

from __future__ import annotations

from fractions import Fraction
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Any

__all__ = ["fraction", "sp", "zero"]

if TYPE_CHECKING:
    import sympy as sp
else:

    class _LoadedOnUse(ModuleType):
        """A module that has the names of the module of its own name, once one of them is used."""

        def __getattr__(self, name: str) -> Any:
            module = import_module(self.__name__)
            vars(self).update(vars(module))  # from now on a name is found as fast as in the module itself
            return getattr(module, name)

    sp = _LoadedOnUse("sympy")


def zero() -> sp.Expr:
    """The exact zero, as the default of a field."""
    return sp.S.Zero


def fraction(number: sp.Expr) -> Fraction:
    """A rational number of SymPy as one of Python."""
    return Fraction(int(number.p), int(number.q))
