"""Markers of a body in space that are nodes or sets of nodes."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from derive.short_text import record_text

if TYPE_CHECKING:
    pass


@dataclass(frozen=True)
class NodeMarker:
    """A named node of a body in space.

    Attributes:
        name: the name of the marker.
        node: the number of the node, counted from 0.

    Examples:
        >>> import derive
        >>> derive.NodeMarker("corner", 3).node
        3
    """

    name: str
    node: int
    __repr__ = record_text

    @property
    def nodes(self) -> tuple[int, ...]:
        """The node as a set of nodes."""
        return (self.node,)

    @property
    def weights(self) -> tuple[Fraction, ...]:
        """The weights of the set, which are equal."""
        return ()


@dataclass(frozen=True)
class InterfaceMarker:
    """A marker of the interface of a body: a node, which is displaced, or a set, which is displaced and rotated.

    The mean displacement and rotation of the set are those of the marker; weights are equal if there are none.
    """

    name: str
    nodes: tuple[int, ...]
    weights: tuple[Fraction, ...] = ()
    __repr__ = record_text

    @property
    def motions(self) -> int:
        """The number of its displacements and rotations."""
        return 6 if len(self.nodes) > 1 else 3
