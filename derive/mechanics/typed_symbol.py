"""The class of the symbols of the derivation.

It is apart from the identities, which name the coordinates of a model also where nothing is derived.
"""

from __future__ import annotations

from typing import Any

from derive.algebra import sp


class Symbol(sp.Symbol):  # type: ignore[misc]  # SymPy has no types
    """A SymPy symbol with an identity.

    SymPy orders sums and products by the names of classes first. This class has the name of its base, so that typed
    and plain symbols sort alike.
    """

    __slots__ = ("identity",)
    identity: Any
    """The Identity, which makes its symbol itself."""

    __hash__ = object.__hash__  # equal symbols are the same object; SymPy's own is called a million times

    def __new__(cls, identity: Any, **assumptions: bool | None) -> Symbol:
        """Return the symbol of an identity, the same object for equal arguments."""
        given = tuple(sorted((k, v) for k, v in assumptions.items() if v is not None)) if assumptions else ()
        known = _SYMBOLS.get((identity, given))
        if known is None:
            known = sp.Symbol.__xnew__(cls, "", **dict(given))
            known.identity = identity
            known = _SYMBOLS.setdefault((identity, given), known)  # of two threads one is first
        return known

    @property
    def name(self) -> str:
        """The printed name, which is composed when it is needed: names of most entries that vanish are never used."""
        name: str = self.identity.name
        return name

    @name.setter
    def name(self, _: str) -> None:
        """Accept the name that the constructor of SymPy sets."""

    def _hashable_content(self) -> tuple[Any, ...]:
        return (*super()._hashable_content(), self.identity)

    def __getnewargs_ex__(self) -> tuple[tuple[Any], dict[str, bool]]:
        """Return the arguments for copying and pickling."""
        return (self.identity,), self._assumptions_orig


_SYMBOLS: dict[tuple[Any, tuple[tuple[str, bool], ...]], Symbol] = {}
"""All symbols by their identity and their assumptions."""
