"""The time of one call from Python, for the forces h of a free beam: our C and our module, and what others make of h.

python bench/python_calls.py [--frames mean point] [--shapes 2] [--states 1000] [--rounds 15] [--calls 2000]

All compute the same h (nv,) from q and v, with numbers for the parameters, and agree to 1e-12. SymPy's `lambdify` gets
the equations expanded in q and v, with `cse`; CasADi and Numba the function that `lambdify` writes. `ctypes` is the
bare call of our C with addresses that are known: what no call through ctypes can be faster than. All are timed in one
process, in turns; the figures are the least of all rounds, in microseconds a call, and in nanoseconds a state for many
states in one call. Numba is left out where it is not installed.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from importlib.util import find_spec, module_from_spec, spec_from_loader
from typing import Any

import casadi as ca
import numpy as np
import sympy as sp
from machine import described
from numpy.typing import NDArray

import derive
from derive.backends.model_files import model_files
from derive.runtime.compiled_function import address_of

Array = NDArray[np.float64]
Variants = dict[str, Callable[[], Any]]


def beam(frame: str, shapes: int) -> derive.PlanarBeam:
    """A free beam whose parameters are numbers."""
    ansatz = [f"xi^{power}" for power in range(shapes + 2)]
    return derive.planar_beam(f"calls_{frame}", ansatz=ansatz, frame=frame, mass=1.3, length=0.7, bending_stiffness=2.1)


def expressions(equations: derive.Equations) -> tuple[list[sp.Symbol], list[sp.Symbol], list[sp.Expr]]:
    """The symbols of q and of v, and h in these."""
    form = equations.expanded()
    at_rest = {row.a: 0 for row in form.rows}
    return (
        [c.q for c in form.coordinates],
        [row.v for row in form.rows],
        [sp.nsimplify(form.row(row.name).subs(at_rest), rational=True) for row in form.rows],
    )


def module(files: tuple[derive.File, ...]) -> Any:
    """The generated Python module."""
    source = next(file.text for file in files if file.path.endswith(".py"))
    spec = spec_from_loader("generated", loader=None)
    assert spec is not None
    result = module_from_spec(spec)
    exec(compile(source, "generated", "exec"), result.__dict__)
    return result


def variants(frame: str, shapes: int, q: Array, v: Array) -> tuple[Variants, Variants]:
    """Functions of the first state of q and v (n, nq), which return h (nv,), and of all, which return (n, nv)."""
    spec = beam(frame, shapes)
    equations = derive.derive(spec)
    assert isinstance(equations, derive.Equations)
    files = model_files(derive.lower(equations), spec)
    native, python = derive.load(files), module(files)
    k, kp = native.setup(), python.setup(np.array(python.DEFAULTS))
    q0, v0, out = q[0].copy(), v[0].copy(), np.empty(native.nv)
    qs, vs, h = expressions(equations)
    scalar = sp.lambdify([qs, vs], h, modules="math", cse=True)
    vector = sp.lambdify([qs, vs], h, modules="numpy", cse=True)
    q_list, v_list = q0.tolist(), v0.tolist()
    native.force(0.0, q0, v0, k, out=out)
    bare, addresses = native._compiled["force"]._function, [address_of(a) for a in (q0, v0, k, out)]

    def called() -> Array:
        bare(0.0, *addresses)
        return out

    single: Variants = {
        "Tisserand, C, out=": lambda: native.force(0.0, q0, v0, k, out=out),
        "Tisserand, C, new result": lambda: native.force(0.0, q0, v0, k),
        "Tisserand, C, new arrays": lambda: native.force(0.0, q[0], v[0], k),
        "ctypes, addresses known": called,
        "Tisserand, Python": lambda: python.force(0.0, q0, v0, kp),
        "lambdify, math, lists": lambda: scalar(q_list, v_list),
        "lambdify, numpy, arrays": lambda: np.array(vector(q0, v0)),
        **casadi(qs, vs, h, q0, v0),
    }
    many: Variants = {
        "Tisserand, C, batch": lambda: native.force_batch(0.0, q, v, k),
        "Tisserand, Python": lambda: python.force(0.0, q, v, kp),
        "lambdify, numpy": lambda: stacked(vector(q.T, v.T), len(q)),
    }
    if find_spec("numba"):
        doubles = tuple(sp.Float(x) if x.is_number else x for x in h)  # of one type, as Numba requires
        add_numba(single, many, sp.lambdify([qs, vs], doubles, modules="math", cse=True), q, v)
    return single, many


def stacked(values: list[Any], count: int) -> Array:
    """Values, of which some are numbers, as rows."""
    return np.stack([np.broadcast_to(value, count) for value in values], axis=-1)


def casadi(qs: list[sp.Symbol], vs: list[sp.Symbol], h: list[sp.Expr], q: Array, v: Array) -> Variants:
    """A function of CasADi, which its virtual machine evaluates, called with arrays and through its buffers."""
    x, y = ca.SX.sym("q", len(qs)), ca.SX.sym("v", len(vs))
    made = sp.lambdify([qs, vs], h, modules=[{"sin": ca.sin, "cos": ca.cos}], cse=True)
    function = ca.Function("h", [x, y], [ca.vertcat(*made(ca.vertsplit(x), ca.vertsplit(y)))])
    out = np.zeros(len(h))
    buffers, evaluate = function.buffer()
    for i, given in enumerate((q, v)):
        buffers.set_arg(i, memoryview(given))
    buffers.set_res(0, memoryview(out))

    def buffered(_kept: object = buffers) -> Array:  # `evaluate` points to them, but does not keep them
        evaluate()
        return out

    return {"CasADi, arrays": lambda: np.array(function(q, v)).ravel(), "CasADi, buffer": buffered}


def add_numba(single: Variants, many: Variants, scalar: Any, q: Array, v: Array) -> None:
    """Compiled by Numba: for one state with `out`, and in a loop over the states."""
    import numba

    compiled, count, nv = numba.njit(scalar), len(q), v.shape[1]

    def one(q: Array, v: Array, out: Array) -> None:
        values = compiled(q, v)
        for i in range(nv):
            out[i] = values[i]

    of_one = numba.njit(one)

    def every(q: Array, v: Array, out: Array) -> None:
        for state in range(count):
            of_one(q[state], v[state], out[state])

    of_all, out, outs, q0, v0 = numba.njit(every), np.empty(nv), np.empty((count, nv)), q[0].copy(), v[0].copy()
    single["Numba, out"] = lambda: (of_one(q0, v0, out), out)[1]
    many["Numba, out"] = lambda: (of_all(q, v, outs), outs)[1]


def least(variants: Variants, calls: int, rounds: int) -> dict[str, float]:
    """The least time (s) of a call of each variant, which take turns. Raises ArithmeticError if they disagree."""
    expected = np.array(next(iter(variants.values()))())
    for name, call in variants.items():
        if not np.allclose(call(), expected, rtol=1e-12, atol=1e-12 * np.abs(expected).max()):
            raise ArithmeticError(f"{name} computes other values")
    best = dict.fromkeys(variants, np.inf)
    for _ in range(rounds):
        for name, call in variants.items():
            before = time.perf_counter()
            for _ in range(calls):
                call()
            best[name] = min(best[name], (time.perf_counter() - before) / calls)
    return best


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--frames", nargs="+", default=["mean", "point"])
    parser.add_argument("--shapes", type=int, default=2)
    parser.add_argument("--states", type=int, default=1000)
    parser.add_argument("--rounds", type=int, default=15)
    parser.add_argument("--calls", type=int, default=2000, help="of a variant in a round")
    options = parser.parse_args()
    print("\n".join(described("numpy", "sympy", "casadi", *(["numba"] if find_spec("numba") else []))))
    rng = np.random.default_rng(1)
    for frame in options.frames:
        q, v = (rng.uniform(-0.1, 0.1, (options.states, 3 + options.shapes)) for _ in range(2))
        single, many = variants(frame, options.shapes, q, v)
        print(f"\nframe {frame}, {options.shapes} shapes: us a call")
        for name, seconds in least(single, options.calls, options.rounds).items():
            print(f"  {name:26}{1e6 * seconds:8.2f}")
        print(f"  ns a state, {options.states} states in a call")
        for name, seconds in least(many, max(1, options.calls // options.states), options.rounds).items():
            print(f"  {name:26}{1e9 * seconds / options.states:8.1f}")


if __name__ == "__main__":
    main()
