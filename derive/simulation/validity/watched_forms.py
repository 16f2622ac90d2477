"""Linear forms of the state and the outputs of a scene, and their products: the quantities of a watch."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from derive.runtime.integrators.watch import WatchedQuantity
from derive.runtime.native_call import Matrix, Vector
from derive.runtime.native_scene import NativeScene


class WatchedForms:
    """The quantities of a watch, in the order in which they are added, as forms of z = [q; v; outputs; t]."""

    def __init__(self, native: NativeScene) -> None:
        self.native, self.quantities = native, list[WatchedQuantity]()
        self.size = native.nq + native.nv + len(native.outputs) + 1

    def add(self, columns: Sequence[int], factors: Matrix, factor: int | None = None) -> int:
        """The number of a new quantity whose forms have these factors (forms, columns) of some elements of z."""
        matrix = np.zeros((len(factors), self.size))
        matrix[:, columns] = factors
        self.quantities.append(WatchedQuantity(matrix, factor))
        return len(self.quantities) - 1

    def output(self, name: str) -> int:
        """The number of an output in z."""
        return int(self.native.nq + self.native.nv + self.native.outputs.index(name))

    def of_output(self, name: str) -> Vector:
        """An output as a form (z,)."""
        form = np.zeros(self.size)
        form[self.output(name)] = 1
        return form
