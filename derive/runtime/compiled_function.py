"""One function of a compiled model, called with NumPy arrays whose addresses are looked up once."""

from __future__ import annotations

import ctypes
import weakref
from collections.abc import Callable, Sequence
from operator import is_
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from derive.runtime.native_call import ModelError, Vector, checked_number, checked_origin, checked_vector

DOUBLE = ctypes.sizeof(ctypes.c_double)

Known = tuple[tuple[object, ...], tuple[int, ...], tuple[object, ...]]
"""Arrays, their addresses, and weak references to them, as which NumPy refuses to move their values (`resize`)."""


NO_OUTPUT: Known = (object(),), (0,), ()
"""An output that no caller can give."""


class CompiledFunction:
    """A function of numbers and vectors of given lengths, which writes vectors of given lengths.

    Everything is checked by which an argument could harm: an input is converted to a contiguous vector of doubles and
    must have the right length; an output that the caller gives must be such a vector, writeable, and apart from the
    inputs. The arrays of the last call are kept, and recognised as the same objects: their values may have changed, but
    not where they are, so that neither their length is checked nor their address looked up again. An array that had to
    be converted is not recognised, since its converted copy has the values of that call.
    """

    def __init__(
        self,
        name: str,
        function: Any,
        inputs: Sequence[int],
        results: Sequence[int],
        build: tuple[str, str] | None = None,
        constants: int = -1,
        order: Callable[[Callable[..., int]], Callable[..., int]] = lambda function: function,
    ) -> None:
        """function: a function of ctypes; name: its name in messages.

        inputs, results: lengths of the vectors. build: hash and name of the model whose `setup` the constants must come
        from; constants: which input that is. order: makes a function that takes the numbers first of one that does not.
        """
        self.name = name
        address = ctypes.cast(function, ctypes.c_void_p).value
        self._function = order(type(function)(address))  # calls of members of structures take longer
        self._inputs, self._sizes = tuple(inputs), tuple(results)
        self._build, self._constants = build, constants
        self._known: Known = tuple(object() for _ in inputs), (0,) * len(inputs), ()
        self._known_out = NO_OUTPUT

    @property
    def sizes(self) -> tuple[int, ...]:
        """The lengths of the results."""
        return self._sizes

    def __call__(self, arrays: tuple[ArrayLike, ...], *numbers: float, out: Vector | None = None) -> Vector:
        """The first result, written into `out` where it is given.

        Raises ModelError if the function returns a code other than 0, ValueError for a wrong argument.
        """
        known, addresses, _ = self._known
        vectors: Sequence[ArrayLike] = arrays
        if not all(map(is_, arrays, known)):
            vectors, addresses = self._checked(arrays)
            known = ()
        for number in numbers:
            if type(number) is not float:
                numbers = tuple(checked_number(x, self.name) for x in numbers)
                break
        if out is None:
            result = np.empty(self._sizes[0])
            code = self._function(*numbers, *addresses, address_of(result))
        else:
            result = out
            (last,), place, _ = self._known_out
            if last is not out or not out.flags.writeable:
                place = self._checked_out(out)
                known = ()
            if not known:
                self._check_overlap(place[0], addresses)
            code = self._function(*numbers, *addresses, *place)
        del vectors  # they live until here
        if code:
            raise ModelError(self.name, code)
        return result

    def at(self, t: float, q: ArrayLike, v: ArrayLike, k: ArrayLike, out: Vector | None = None) -> Vector:
        """The first result for the inputs q, v, k and the number t; faster if all arrays are those of the last call."""
        (last_q, last_v, last_k), addresses, _ = self._known
        (last,), place, _ = self._known_out
        if not (q is last_q and v is last_v and k is last_k and out is last and type(t) is float):
            return self((q, v, k), t, out=out)
        if out is None or not out.flags.writeable:
            return self((q, v, k), t, out=out)
        code = self._function(t, *addresses, *place)
        if code:
            raise ModelError(self.name, code)
        return out

    def results(self, arrays: tuple[ArrayLike, ...], *numbers: float) -> list[Vector]:
        """All results, in new arrays. Raises as a call does."""
        vectors, addresses = self._checked(arrays)
        given = [checked_number(x, self.name) for x in numbers]
        results = [np.empty(size) for size in self._sizes]
        code = self._function(*given, *addresses, *map(address_of, results))
        del vectors  # they live until here
        if code:
            raise ModelError(self.name, code)
        return results

    def _checked(self, arrays: tuple[ArrayLike, ...]) -> tuple[list[Vector], tuple[int, ...]]:
        """The inputs as vectors and their addresses; they are kept where none had to be converted."""
        if self._build:
            checked_origin(*self._build, arrays[self._constants])
        last, places, _ = self._known
        vectors: list[Vector] = []
        addresses: list[int] = []
        for size, given, known, place in zip(self._inputs, arrays, last, places, strict=True):
            vector = known if given is known else checked_vector(size, given, self.name)
            vectors.append(vector)  # type: ignore[arg-type]  # what is known is a vector
            addresses.append(place if given is known else address_of(vectors[-1]))
        if all(map(is_, vectors, arrays)):
            self._known = arrays, tuple(addresses), tuple(map(weakref.ref, vectors))
            self._known_out = NO_OUTPUT  # the last output may be one of these arrays
        return vectors, tuple(addresses)

    def _checked_out(self, out: Vector) -> tuple[int]:
        """The address of an output that the caller gives, which is kept."""
        size = self._sizes[0]
        if not (type(out) is np.ndarray and out.dtype == np.float64 and out.shape == (size,)):
            kind = f"{getattr(out, 'dtype', type(out).__name__)} of shape {np.shape(out)}"
            raise ValueError(f"{self.name}: `out` must be an array of {size} doubles (float64), not {kind}")
        if not (out.flags.c_contiguous and out.flags.writeable):
            raise ValueError(f"{self.name}: `out` must be contiguous and writeable")
        place = (address_of(out),)
        self._known_out = (out,), place, (weakref.ref(out),)
        return place

    def _check_overlap(self, place: int, addresses: tuple[int, ...]) -> None:
        """Raises ValueError if the output overwrites an input while it is read."""
        end = place + DOUBLE * self._sizes[0]
        for length, address in zip(self._inputs, addresses, strict=True):
            if address < end and place < address + DOUBLE * length:
                raise ValueError(f"{self.name}: `out` shares memory with an argument, which would be overwritten")


def address_of(array: Vector) -> int:
    """The address of the values of a contiguous array."""
    try:
        return ctypes.addressof(ctypes.c_char.from_buffer(array))  # type: ignore[arg-type]
    except (TypeError, ValueError):  # read-only arrays, and those without values
        return int(array.ctypes.data)
