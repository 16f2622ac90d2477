"""The markers of a compiled model: each has functions of its own, or those of its class and a number among them."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

from derive.ir.patterns import Pattern
from derive.runtime.descriptor import MarkerClassStruct, MarkerStruct, ModelStruct, pattern_of


@dataclass(frozen=True)
class NativeMarker:
    """A marker in a library: the structure that it belongs to, and, in a class, its number among the instances."""

    holder: MarkerStruct | MarkerClassStruct
    number: int | None = None

    @property
    def dimension(self) -> int:
        """The number of coordinates of a point."""
        return int(self.holder.dimension)

    @property
    def size(self) -> int:
        """The number of values of the Jacobian."""
        return int(self.holder.pattern.contents.nnz)

    def bound(self, function: Callable[..., int]) -> Callable[..., int]:
        """A function of the structure with the number of the instance in front."""
        return function if self.number is None else partial(function, self.number)

    def pattern(self, columns: int) -> Pattern:
        """The pattern of the Jacobian, with that many columns."""
        own = pattern_of(self.holder.pattern.contents)
        if self.number is None:
            return own
        first = self.holder.columns[self.number]
        return own.among(first, columns)


def native_markers(library: ctypes.CDLL, model: ModelStruct, name: str) -> dict[str, NativeMarker]:
    """The markers of a model by their names."""
    result = {model.markers[i].name.decode(): NativeMarker(model.markers[i]) for i in range(model.nmarkers)}
    try:
        entry: Any = getattr(library, f"{name}_marker_classes")
    except AttributeError:  # only loops over instances have classes of markers
        return result
    entry.restype = ctypes.POINTER(MarkerClassStruct)
    classes = entry()
    k = 0
    while classes[k].name:
        of = classes[k]
        result |= {of.names[number].decode(): NativeMarker(of, number) for number in range(of.count)}
        k += 1
    return result
