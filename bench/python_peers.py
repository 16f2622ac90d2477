"""M and h of a beam by CasADi, SymPy and Numba, as functions that Python calls, for `python_calls.py`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np
import sympy as sp
from numpy.typing import NDArray

Array = NDArray[np.float64]
Variants = dict[str, Callable[[], Any]]


@dataclass(frozen=True)
class Beam:
    """A beam as our C and as our module, with constants k and kp; and its M and h in the symbols q and v."""

    native: Any
    python: Any
    k: Array
    kp: Array
    qs: list[sp.Symbol]
    vs: list[sp.Symbol]
    mass: sp.Matrix
    h: list[sp.Expr]


def stacked(values: list[Any], count: int) -> Array:
    """Values, of which some are numbers, as rows."""
    return np.stack([np.broadcast_to(value, count) for value in values], axis=-1)


def casadi_solution(mass: ca.SX, forces: ca.SX) -> ca.SX:
    """The solution of M vdot = -h by the symbolic LDL^T of CasADi."""
    diagonal, upper, order = ca.ldl(mass)
    return ca.ldl_solve(-forces, diagonal, upper, order)


def casadi(given: Beam, result: Callable[[ca.SX, ca.SX], ca.SX], q: Array, v: Array) -> Variants:
    """A function of CasADi of M and h, which its virtual machine evaluates, called with arrays and through buffers."""
    x, y = ca.SX.sym("q", len(given.qs)), ca.SX.sym("v", len(given.vs))
    names = {"sin": ca.sin, "cos": ca.cos}
    made = sp.lambdify([given.qs, given.vs], (list(given.mass), given.h), modules=[names], cse=True)
    entries, h = made(ca.vertsplit(x), ca.vertsplit(y))
    mass = ca.reshape(ca.vertcat(*entries), len(h), len(h))
    computed = ca.cse(result(ca.sparsify(mass), ca.vertcat(*h)))
    function = ca.Function("made", [x, y], [ca.densify(computed)])
    out = np.zeros(len(h))
    buffers, evaluate = function.buffer()
    for i, array in enumerate((q, v)):
        buffers.set_arg(i, memoryview(array))
    buffers.set_res(0, memoryview(out))

    def buffered(_kept: object = buffers) -> Array:  # `evaluate` points to them, but does not keep them
        evaluate()
        return out

    return {"CasADi, arrays": lambda: np.array(function(q, v)).ravel(), "CasADi, buffer": buffered}


def numba_scalars(given: Beam, values: list[sp.Expr]) -> Any:
    """A function of q and v compiled by Numba, which returns a tuple of the values."""
    import numba

    doubles = tuple(sp.Float(x) if x.is_number else x for x in values)  # of one type, as Numba requires
    return numba.njit(sp.lambdify([given.qs, given.vs], doubles, modules="math", cse=True))


def add_numba(single: Variants, many: Variants, one: Callable[..., None], q: Array, v: Array) -> None:
    """`one`, which writes the result of a state, compiled by Numba: for one state, and in a loop over the states."""
    import numba

    of_one, count, nv = numba.njit(one), len(q), v.shape[1]

    def every(q: Array, v: Array, out: Array) -> None:
        for state in range(count):
            of_one(q[state], v[state], out[state])

    of_all, out, outs, q0, v0 = numba.njit(every), np.empty(nv), np.empty((count, nv)), q[0].copy(), v[0].copy()
    single["Numba, out"] = lambda: (of_one(q0, v0, out), out)[1]
    many["Numba, out"] = lambda: (of_all(q, v, outs), outs)[1]
