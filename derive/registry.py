"""Open sets of named things: joints, bodies, integrators, backends; an unknown name is an error that lists them."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Iterator, Mapping
from typing import Generic, TypeVar

from derive.display import html
from derive.errors import TisserandError, quoted
from derive.short_text import counted, listed, summary

T = TypeVar("T")
MOST_LISTED = 30
"""The largest number of known names that a message lists."""


class UnknownNameError(TisserandError, KeyError):
    """A name that is not in an open set; the text lists the names that are, and the nearest one.

    Attributes:
        name: the name as it was given.
        known: the names of the set, in its order.

    Examples:
        >>> import derive
        >>> try:
        ...     derive.JOINTS["revolut"]
        ... except derive.UnknownNameError as error:
        ...     print(error)
        there is no joint "revolut"; did you mean "revolute"? known: revolute, weld, fixed, translational
    """

    def __init__(self, kind: str, name: str, known: Iterable[str]) -> None:
        self.name, self.known = name, tuple(known)
        names = ", ".join(self.known[:MOST_LISTED]) or "none"
        if len(self.known) > MOST_LISTED:
            names += f" and {len(self.known) - MOST_LISTED} more"
        text = str(name)  # a number or a tuple, as of columns, is given as well
        near = difflib.get_close_matches(text[:40], self.known, n=1)
        hint = f"did you mean {quoted(near[0])}? " if near else ""
        self.message = f"there is no {kind} {quoted(text)}; {hint}known: {names}"
        super().__init__(self.message)

    def __str__(self) -> str:
        return self.message  # that of KeyError is in quotation marks


class Registry(Mapping[str, T], Generic[T]):
    """The members of an open set by their names, in the order of their registration: a mapping that can be extended.

    `registry[name]` raises UnknownNameError if there is no such member. `kind` is what messages call a member.
    """

    def __init__(self, kind: str, members: Mapping[str, T] | None = None, doc: str = "") -> None:
        if doc:
            self.__doc__ = doc
        self.kind = kind
        self._members: dict[str, T] = dict(members or {})
        self._first = dict(self._members)

    @property
    def extended(self) -> bool:
        """Whether the members differ from those of the package."""
        return self._members != self._first

    def register(self, name: str, member: T) -> None:
        """Add a member under a name.

        Raises:
            ValueError: if the name is taken, since two members of one name hide each other.

        Examples:
            >>> derive.JOINTS.register("hinge", derive.JOINTS["revolute"])
            >>> "hinge" in derive.JOINTS
            True
            >>> derive.JOINTS.unregister("hinge")
        """
        if name in self._members:
            raise ValueError(f"the {self.kind} {quoted(name)} is registered already")
        self._members[name] = member

    def unregister(self, name: str) -> None:
        """Remove the member with a name.

        Raises:
            UnknownNameError: if there is no such member.

        Examples:
            >>> derive.JOINTS.register("pin", derive.JOINTS["revolute"])
            >>> derive.JOINTS.unregister("pin")
            >>> "pin" in derive.JOINTS
            False
        """
        self[name]
        del self._members[name]

    def __getitem__(self, name: str) -> T:
        if name not in self._members:
            raise UnknownNameError(self.kind, name, self._members)
        return self._members[name]

    def __contains__(self, name: object) -> bool:
        return name in self._members

    def __iter__(self) -> Iterator[str]:
        return iter(self._members)

    def __len__(self) -> int:
        return len(self._members)

    def __repr__(self) -> str:
        return summary(f"Registry ({self.kind}): {counted(len(self), 'member')}", {"names": listed(self)})

    _repr_html_ = html
