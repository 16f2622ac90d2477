"""The time of one call from Python, for h and the accelerations of a free beam: our C and our module, and others.

python bench/python_calls.py [--frames mean point] [--shapes 2] [--states 1000] [--rounds 15] [--calls 2000]

All compute the same h or vdot (nv,) from q and v, with numbers for the parameters, and agree to 1e-12. SymPy's
`lambdify` gets the equations expanded in q and v, with `cse`; CasADi and Numba the function that `lambdify` writes. For
vdot, M vdot = -h is solved by CasADi's symbolic LDL^T, and by loops of a Cholesky factorisation under Numba. `ctypes`
is the bare call of our C with addresses that are known: what no call through ctypes can be faster than. All are timed
in one process, in turns; the figures are the least of all rounds, in microseconds a call, and in nanoseconds a state
for many states in one call. Numba is left out where it is not installed.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from importlib.util import find_spec, module_from_spec, spec_from_loader
from typing import Any

import numpy as np
import sympy as sp
from machine import described
from python_peers import Array, Beam, Variants, add_numba, casadi, casadi_solution, numba_scalars, stacked
from rows import Row, row

import derive
from derive.backends.model_files import emit
from derive.runtime.compiled_function import address_of

LAMBDIFY = ("lambdify, math, arrays", "lambdify, numpy, arrays")
"""The two ways to call what SymPy writes with arrays: converted to numbers, and as they are."""
MANY_SHAPES = 8


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


def generated(frame: str, shapes: int) -> Beam:
    """The code of a beam."""
    spec = beam(frame, shapes)
    equations = derive.derive(spec)
    assert isinstance(equations, derive.Equations)
    files = emit(derive.lower(equations), spec)
    native, python, form = derive.load(files), module(files), equations.expanded()
    qs, vs, h = expressions(equations)
    mass = form.mass.applyfunc(lambda entry: sp.nsimplify(form.substituted(entry), rational=True))
    return Beam(native, python, native.setup(), python.setup(np.array(python.DEFAULTS)), qs, vs, mass, h)


def called(native: Any, name: str, *arrays: Array) -> Callable[[], Array]:
    """The bare call through ctypes of a function of our C; the last array is the result."""
    bare, addresses = native._compiled[name]._function, [address_of(a) for a in arrays]

    def call() -> Array:
        bare(0.0, *addresses)
        return arrays[-1]

    return call


def of_forces(given: Beam, q: Array, v: Array) -> tuple[Variants, Variants]:
    """Functions of the first state of q and v (n, nq), which return h (nv,), and of all, which return (n, nv)."""
    native, python, k, kp = given.native, given.python, given.k, given.kp
    q0, v0, out = q[0].copy(), v[0].copy(), np.empty(native.nv)
    qs, vs, h = given.qs, given.vs, given.h
    scalar = sp.lambdify([qs, vs], h, modules="math", cse=True)
    vector = sp.lambdify([qs, vs], h, modules="numpy", cse=True)
    q_list, v_list, k_list = q0.tolist(), v0.tolist(), kp.tolist()
    native.force(0.0, q0, v0, k, out=out)
    single: Variants = {
        "Tisserand, C, out=": lambda: native.force(0.0, q0, v0, k, out=out),
        "Tisserand, C, new result": lambda: native.force(0.0, q0, v0, k),
        "Tisserand, C, new arrays": lambda: native.force(0.0, q[0], v[0], k),
        "ctypes, addresses known": called(native, "force", q0, v0, k, out),
        "Tisserand, Python": lambda: python.force(0.0, q0, v0, kp),
        "Tisserand, Python, lists": lambda: python.numbers.force(0.0, q_list, v_list, k_list),
        "lambdify, math, lists": lambda: scalar(q_list, v_list),
        "lambdify, math, arrays": lambda: np.array(scalar(q0.tolist(), v0.tolist())),
        "lambdify, numpy, arrays": lambda: np.array(vector(q0, v0)),
        **casadi(given, lambda _mass, forces: forces, q0, v0),
    }
    many: Variants = {
        "Tisserand, C, batch": lambda: native.force_batch(0.0, q, v, k),
        "Tisserand, Python": lambda: python.force(0.0, q, v, kp),
        "lambdify, numpy": lambda: stacked(vector(q.T, v.T), len(q)),
    }
    if find_spec("numba"):
        compiled = numba_scalars(given, h)
        nv = len(h)

        def one(q: Array, v: Array, out: Array) -> None:
            values = compiled(q, v)
            for i in range(nv):
                out[i] = values[i]

        add_numba(single, many, one, q, v)
    return single, many


def of_accelerations(given: Beam, q: Array, v: Array) -> Variants:
    """Functions of the first state of q and v (n, nq), which return vdot (nv,)."""
    native, python, k, kp = given.native, given.python, given.k, given.kp
    q0, v0, out = q[0].copy(), v[0].copy(), np.empty(native.nv)
    native.accel(0.0, q0, v0, k, out=out)
    single: Variants = {
        "Tisserand, C, out=": lambda: native.accel(0.0, q0, v0, k, out=out),
        "ctypes, addresses known": called(native, "accel", q0, v0, k, out),
        "Tisserand, Python": lambda: python.accel(0.0, q0, v0, kp),
        **casadi(given, casadi_solution, q0, v0),
    }
    if find_spec("numba"):
        nv = len(given.h)
        lower = [given.mass[i, j] for i in range(nv) for j in range(i + 1)]
        compiled = numba_scalars(given, lower + given.h)

        def one(q: Array, v: Array, out: Array) -> None:
            values = compiled(q, v)
            factor = np.empty((nv, nv))
            n = 0
            for i in range(nv):
                out[i] = -values[len(values) - nv + i]
                for j in range(i + 1):
                    entry = values[n]
                    n += 1
                    for m in range(j):
                        entry -= factor[i, m] * factor[j, m]
                    factor[i, j] = entry / factor[j, j] if j < i else np.sqrt(entry)
                for m in range(i):
                    out[i] -= factor[i, m] * out[m]
                out[i] /= factor[i, i]
            for i in range(nv - 1, -1, -1):
                for m in range(i + 1, nv):
                    out[i] -= factor[m, i] * out[m]
                out[i] /= factor[i, i]

        add_numba(single, {}, one, q, v)
    return single


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


def states(shapes: int, count: int) -> tuple[Array, Array]:
    """q and v (count, 3 + shapes)."""
    rng = np.random.default_rng(1)
    q, v = (rng.uniform(-0.1, 0.1, (count, 3 + shapes)) for _ in range(2))
    return q, v


def rows(quick: bool = False) -> list[Row]:
    """Calls from Python, see `rows.py`; by hand is the bare call of our C, which no call through ctypes can beat."""
    count, calls, rounds = (5, 5, 1) if quick else (1000, 2000, 15)
    absent = "" if find_spec("numba") else "Numba is not installed"
    result = []
    for frame in ("mean", "point"):
        given, (q, v) = generated(frame, 2), states(2, count)
        single, many = of_forces(given, q, v)
        force, accel = (least(calls_of, calls, rounds) for calls_of in (single, of_accelerations(given, q, v)))
        batch = least(many, max(1, calls // count), rounds)
        for function, times in (("force", force), ("accel", accel)):
            ours, bare = times["Tisserand, C, out="], times["ctypes, addresses known"]
            peers = chosen(times, "CasADi, buffer", "Numba, out")
            name = f"native.{function}, one call, {frame}"
            result.append(row(name, 1e9 * ours, peers=peers, hand=1e9 * bare, note=absent))
        ours = 1e9 * force["Tisserand, Python"]
        peers = chosen(force, *LAMBDIFY)
        result.append(row(f"generated Python, force, one call, {frame}", ours, peers=peers, goal=1))
        ours, peers = 1e9 * force["Tisserand, Python, lists"], chosen(force, "lambdify, math, lists")
        result.append(row(f"generated Python, force, one call with lists, {frame}", ours, peers=peers, goal=1))
        ours = 1e9 * batch["Tisserand, Python"] / count
        for peer, note in (("Numba, out", absent), ("lambdify, numpy", "")):
            peers = {name: ns / count for name, ns in chosen(batch, peer).items()}
            name = f"generated Python, force, a state of {count}, {frame}"
            result.append(row(name, ours, peers=peers, goal=1, note=note))
    given, (q, v) = generated("point", MANY_SHAPES), states(MANY_SHAPES, 1)
    single, _ = of_forces(given, q, v)
    force = least({name: single[name] for name in ("Tisserand, Python", *LAMBDIFY)}, calls, rounds)
    name = f"generated Python, force, one call, point, {MANY_SHAPES} shapes"
    return [*result, row(name, 1e9 * force["Tisserand, Python"], peers=chosen(force, *LAMBDIFY), goal=1)]


def chosen(times: dict[str, float], *names: str) -> dict[str, float]:
    """The times (ns) of some variants, as far as they were measured."""
    return {name: 1e9 * times[name] for name in names if name in times}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--frames", nargs="+", default=["mean", "point"])
    parser.add_argument("--shapes", type=int, default=2)
    parser.add_argument("--states", type=int, default=1000)
    parser.add_argument("--rounds", type=int, default=15)
    parser.add_argument("--calls", type=int, default=2000, help="of a variant in a round")
    options = parser.parse_args()
    print("\n".join(described("numpy", "sympy", "casadi", *(["numba"] if find_spec("numba") else []))))
    for frame in options.frames:
        given, (q, v) = generated(frame, options.shapes), states(options.shapes, options.states)
        single, many = of_forces(given, q, v)
        for name, variants in (("h", single), ("vdot", of_accelerations(given, q, v))):
            print(f"\nframe {frame}, {options.shapes} shapes, {name}: us a call")
            for variant, seconds in least(variants, options.calls, options.rounds).items():
                print(f"  {variant:26}{1e6 * seconds:8.2f}")
        print(f"\nframe {frame}, h: ns a state, {options.states} states in a call")
        for variant, seconds in least(many, max(1, options.calls // options.states), options.rounds).items():
            print(f"  {variant:26}{1e9 * seconds / options.states:8.1f}")


if __name__ == "__main__":
    main()
