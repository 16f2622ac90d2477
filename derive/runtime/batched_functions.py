"""Functions of a compiled model for many states at once."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from derive.backends.c.optional_parts import OptionalPart
from derive.runtime.compiled_function import CompiledFunction
from derive.runtime.compiler import CompilerError
from derive.runtime.native_call import (
    Matrix,
    ModelError,
    checked_number,
    checked_rows,
    checked_vector,
)


class BatchedFunctions:
    """The functions of a `Native` that take a row for each state."""

    name: str
    nk: int
    _model: Any
    _compiled: dict[str, CompiledFunction]
    own: Any

    def mass_batch(self, q: ArrayLike, k: ArrayLike, check: bool = True) -> Matrix:
        """Values of M (n, nnz) for each row of q. The C takes structures of arrays: both are transposed.

        Examples:
            >>> native.mass_batch([q, q, q], k).shape
            (3, 5)
        """
        (values,) = self._batch("mass", (q,), k, check)
        return values

    def force_batch(self, t: float, q: ArrayLike, v: ArrayLike, k: ArrayLike, check: bool = True) -> Matrix:
        """The vector h (n, nv) for each row of q and v.

        Examples:
            >>> native.force_batch(0.0, [q, q], [v, v], k).shape
            (2, 5)
        """
        (h,) = self._batch("force", (q, v), k, check, t)
        return h

    def mass_force_batch(
        self, t: float, q: ArrayLike, v: ArrayLike, k: ArrayLike, check: bool = True
    ) -> tuple[Matrix, Matrix]:
        """Values of M (n, nnz), and h (n, nv), for each row of q and v.

        Examples:
            >>> M, h = native.mass_force_batch(0.0, [q, q], [v, v], k)
            >>> M.shape, h.shape
            ((2, 5), (2, 5))
        """
        values, h = self._batch("mass_force", (q, v), k, check, t)
        return values, h

    def accel_batch(self, t: float, q: ArrayLike, v: ArrayLike, k: ArrayLike, check: bool = True) -> Matrix:
        """The accelerations vdot (n, nv) for each row of q and v.

        Examples:
            >>> native.accel_batch(0.0, [q, q], [[0, 0, 3, 0, 0], [0, 0, 6, 0, 0]], k).round(2) + 0.0
            array([[   0.  ,    0.  ,    0.  , -215.91,    0.  ],
                   [   0.  ,    0.  ,    0.  , -215.64,    0.  ]])
        """
        (vdot,) = self._batch("accel", (q, v), k, check, t)
        return vdot

    def energy_batch(self, q: ArrayLike, v: ArrayLike, k: ArrayLike, check: bool = True) -> Matrix:
        """The energies of `energy` (n, energies), J, for each row of q and v.

        Examples:
            >>> native.energy_batch([q, q], [[0, 0, 3, 0, 0], [0, 0, 6, 0, 0]], k).round(4)
            array([[0.3751, 0.216 ],
                   [1.5004, 0.216 ]])
        """
        (energies,) = self._batch("energy", (q, v), k, check)
        return energies

    def momentum_batch(self, q: ArrayLike, v: ArrayLike, k: ArrayLike, check: bool = True) -> Matrix:
        """The momenta of `momentum` (n, momenta) for each row of q and v.

        Examples:
            >>> native.momentum_batch([q], [v], k).round(4)
            array([[0.    , 0.    , 0.2501]])
        """
        (momenta,) = self._batch("momentum", (q, v), k, check)
        return momenta

    def rates_batch(self, q: ArrayLike, v: ArrayLike, k: ArrayLike, check: bool = True) -> Matrix:
        """The rates qdot (n, nq) for each row of q and v.

        Examples:
            >>> native.rates_batch([q], [v], k)
            array([[0., 0., 3., 0., 0.]])
        """
        (qdot,) = self._batch("rates", (q, v), k, check)
        return qdot

    def _batch(
        self, kernel: str, states: Sequence[ArrayLike], k: ArrayLike, check: bool, *t: float, holder: Any = None
    ) -> list[Matrix]:
        """The results of a function: matrices with a row for each state, whose vectors are those of a single call.

        holder: the structure of the descriptor that has the function, if it is not the descriptor itself.
        """
        name, single = f"{kernel}_batch", self._compiled[kernel]
        rows = [checked_rows(columns, given, name) for columns, given in zip(single.inputs, states, strict=False)]
        count = len(rows[0])
        if any(len(given) != count for given in rows):
            raise ValueError(f"{name}: {' and '.join(str(len(given)) for given in rows)} states do not go together")
        columns_first = [np.ascontiguousarray(given.T) for given in rows]
        results = [np.empty((size, count)) for size in single.sizes]
        arrays = [*columns_first, checked_vector(self.nk, self.own(k), name), *results]
        function: Callable[..., int] | None = getattr(holder or self._model, name)  # a null pointer is false
        if not function:
            macro = OptionalPart.BATCHES.value
            raise CompilerError(f"{self.name}_{name} is not in this library, whose C was compiled with {macro}")
        code = function(count, *(checked_number(x, name) for x in t), *(a.ctypes.data for a in arrays))
        if code and check:
            raise ModelError(f"{self.name}_{name}", code)
        return [np.ascontiguousarray(result.T) for result in results]
