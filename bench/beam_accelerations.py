"""Accelerations of the free planar beam in straight-line C: generated, by CasADi, and written by hand.

`python bench/beam_accelerations.py` prints a table; all implementations run alternately in one process.
"""

from __future__ import annotations

import argparse
import shlex
import subprocess
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
from interleaved import TimedCall, interleaved
from machine import OWN_OPTION, described
from numpy.polynomial import Polynomial
from numpy.polynomial.legendre import Legendre
from numpy.typing import NDArray
from problem import PARAMETERS, Problem, beam, problem
from rows import Row, row
from variants import HAND, constants, entries, state_symbols, to_casadi, zeros

from derive.runtime.compiler import FLAGS as LOADED
from derive.runtime.compiler import compiler

Array = NDArray[np.float64]

FRAMES, SIZES = ("point", "mean"), (2, 4, 8)
FLAGS = ("-O3", "-march=x86-64-v3")
REPEATS = 41
GOAL = 1.1
TOLERANCE = 1e-9
PEERS = {"CasADi, LDL^T": "ldl", "CasADi, QR": "qr"}
"""The solutions of M vdot = -h that CasADi writes out."""


def rows(quick: bool = False) -> list[Row]:
    """The rows of `rows.py` for both sets of flags."""
    sizes, repeats = (SIZES[:1], 1) if quick else (SIZES, REPEATS)
    return [row for flags in (FLAGS, LOADED) for row in table(sizes, flags, repeats)]


def table(sizes: Sequence[int], flags: Sequence[str], repeats: int) -> Iterator[Row]:
    """A row for each frame and size."""
    for frame in FRAMES:
        for n in sizes:
            ns = times(frame, n, flags, repeats)
            peers = {peer: ns[peer] for peer in PEERS}
            used = "derive.load" if flags == LOADED else " ".join(flags)
            name = f"accelerations, {frame} frame, N = {n}, {used}"
            yield row(name, ns["ours"], peers=peers, hand=ns["hand"], goal=GOAL)


def times(frame: str, n: int, flags: Sequence[str], repeats: int = REPEATS) -> dict[str, float]:
    """The median times (ns) of an evaluation by name. Raises ArithmeticError if the values differ."""
    made = problem(beam(frame, n))
    name, nv, states = made.model.name, made.inputs.nv, made.inputs.states
    with tempfile.TemporaryDirectory(prefix="tisserand-bench-") as directory:
        folder = Path(directory)
        objects = list(_compiled(made, frame, n, flags, folder))
        state = f"qs + s * {nv}, vs + s * {nv}"
        calls = [
            TimedCall("ours", f"{name}_accel(0.0, {state}, k, out);", nv),
            TimedCall("hand", f"hand_{frame}_accel({state}, hand, out);", nv),
            *(
                TimedCall(
                    peer,
                    f"given[0] = qs + s * {nv}; given[1] = vs + s * {nv}; casadi_{method}(given, result, 0, 0, 0);",
                    nv,
                )
                for peer, method in PEERS.items()
            ),
        ]
        peers = "".join(
            f"int casadi_{m}(const double **, double **, long long *, double *, int);\n" for m in PEERS.values()
        )
        ns, values = interleaved(
            calls,
            declare=f'#include "{folder}/{name}.h"\n{peers}'
            f"void hand_{frame}_accel(const double *, const double *, const double *, double *);\n"
            "static const double *given[3]; static double *result[1];",
            once=f"if ({name}_setup(p, k)) return 5; given[2] = numbers; result[0] = out;",
            arrays={
                "p": np.array(made.inputs.p),
                "qs": states[:, :nv],
                "vs": states[:, nv:],
                "hand": hand_constants(frame, n),
                "numbers": np.array(list(constants(made).values())),
            },
            scratch={"k": len(made.model.constants)},
            objects=objects,
            folder=folder,
            states=len(states),
            repeats=repeats,
        )
    for call, other in zip(calls, values, strict=True):
        error = np.max(np.abs(values[0] - other)) / np.max(np.abs(values[0]))
        if not error < TOLERANCE:
            raise ArithmeticError(f"{frame} frame, N = {n}: {call.name} is off by {error:.1e}")
    return {call.name: t for call, t in zip(calls, ns, strict=True)}


def _compiled(made: Problem, frame: str, n: int, flags: Sequence[str], folder: Path) -> Iterator[Path]:
    """The object files of all implementations, compiled with the same flags; see OWN_OPTION."""
    for file in made.files:
        if file.path.endswith((".c", ".h")):
            (folder / file.path.rsplit("/", 1)[1]).write_text(file.text)
    sources: dict[Path, tuple[str, ...]] = {folder / f"{made.model.name}.c": (OWN_OPTION,)}
    sources[HAND.with_name("handwritten_accelerations.c")] = ("-std=gnu99", f"-DN={n}")
    for method in PEERS.values():
        path = folder / f"casadi_{method}.c"
        path.write_text(casadi_accelerations(made, method))
        sources[path] = ()
    for source, more in sources.items():
        out = folder / f"{source.stem}.o"
        subprocess.run([*compiler(), *flags, *more, "-w", "-c", source, "-o", out], check=True)
        yield out


def casadi_accelerations(made: Problem, method: str) -> str:
    """The C of CasADi for its solution of M vdot = -h, with shape integrals computed beforehand."""
    q, v = state_symbols(made)
    known = constants(made)
    inputs = [ca.SX.sym(name, len(s)) for name, s in (("q", q), ("v", v), ("k", known))]
    columns = [x for column in inputs for x in ca.vertsplit(column)]
    values: dict[Any, Any] = dict(zip([*q, *v, *known], columns, strict=True)) | zeros(made)
    for definition in made.equations.definitions:
        values[definition.symbol] = to_casadi(list(values), [definition.expr])(*values.values())[0]
    mass, force = (to_casadi(list(values), group)(*values.values()) for group in entries(made))
    shape = made.model.pattern("mass", "M")
    M = ca.SX(shape.rows, shape.rows)
    for (i, j), entry in zip(shape.entries, mass, strict=True):
        M[i, j] = M[j, i] = entry
    h = ca.vertcat(*force)
    solution = ca.solve(M, -h) if method == "qr" else ca.ldl_solve(-h, *ca.ldl(M))
    function = ca.Function(f"casadi_{method}", inputs, [ca.densify(solution)], {"cse": True})
    generator = ca.CodeGenerator(f"casadi_{method}.c", {"with_header": False})
    generator.add(function)
    return generator.dump()


def hand_constants(frame: str, n: int) -> Array:
    """The constants of handwritten_accelerations.c, from Gauss quadrature over the beam."""
    m, length, EI = (PARAMETERS[name] for name in ("m", "l", "EI"))
    x, weights = np.polynomial.legendre.leggauss(n + 4)
    weights = weights / 2
    shapes = [Polynomial.basis(i + 2) if frame == "point" else Legendre.basis(i + 2) for i in range(n)]
    phi, curvature = np.array([s(x) for s in shapes]), np.array([s.deriv(2)(x) for s in shapes])
    c2, c6, c8 = phi @ weights, phi @ (weights * x * length / 2), phi * weights @ phi.T
    K = 16 * EI / (m * length**3) * (curvature * weights @ curvature.T)
    G = c8 - np.outer(c2, c2)
    B = np.linalg.solve(G, K)
    blocks = [*(A[i::2, i::2].ravel() for A in (G, B) for i in (0, 1))]
    if frame == "mean":
        return np.concatenate([[length**2 / 12], np.diag(c8), *blocks[2:]])
    share = np.linalg.solve(G, c6)
    parts = [blocks, [(c2 @ B)[::2], c2[::2], c6[1::2], share[1::2], (share @ K)[1::2]]]
    return np.concatenate([[length**2 / 12 - c6 @ share], *parts[0], *parts[1]])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--shapes", type=int, nargs="+", default=SIZES, choices=SIZES)
    parser.add_argument("--repeats", type=int, default=REPEATS)
    options = parser.parse_args()
    print("\n".join(described("casadi")))
    for flags in (FLAGS, LOADED):
        print(f"\nflags     {shlex.join(flags)}; nanoseconds of an evaluation")
        print("".ljust(72) + "".join(f"{title:>8}" for title in ("ours", "peer", "hand", "ratio")) + "  best peer")
        for given in table(options.shapes, flags, options.repeats):
            numbers = "".join(f"{given[key]:8.1f}" for key in ("ours_ns", "peer_ns", "hand_ns"))
            print(f"{given['name']:72}{numbers}{given['ratio']:8.2f}  {given['peer_name']}", flush=True)


if __name__ == "__main__":
    main()
