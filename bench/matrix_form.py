"""M, h and the iteration matrix of a spatial body in CasADi, written by hand from the matrix form of (15).

python bench/matrix_form.py DATA SIZE ITEM FOLDER

The only parts of Tisserand in it are the numbers of the body and the order of the stored values. The C is that of
`Function.generate` after `ca.cse`. Prints the seconds, the operations and the sizes as JSON.
"""

from __future__ import annotations

import json
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
from bodies import BODIES

PAIRS = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))
NO_OPERATION = {ca.OP_CONST, ca.OP_INPUT, ca.OP_OUTPUT, ca.OP_PARAMETER, ca.OP_ASSIGN}


@dataclass
class Integrals:
    """The integrals of a body as numbers or, if `symbolic`, as a parameter for each independent entry."""

    symbolic: bool
    symbols: list[Any] = field(default_factory=list)
    values: list[float] = field(default_factory=list)

    def table(self, numbers: np.ndarray, kind: str = "full") -> Any:
        """A matrix of kind "full", "symmetric" or "skew"; of the last two the lower triangle is independent."""
        rows, cols = numbers.shape
        if not self.symbolic:
            return ca.SX(ca.sparsify(ca.DM(numbers)))
        below = np.tril(np.ones((rows, cols)), -1 if kind == "skew" else 0) if kind != "full" else np.ones((rows, cols))
        symbols = ca.SX.sym("p", ca.sparsify(ca.DM(below)).sparsity())
        self.symbols.append(ca.vertcat(*symbols.nonzeros()))
        row, col = symbols.sparsity().get_triplet()
        self.values += [float(numbers[i, j]) for i, j in zip(row, col, strict=True)]
        if kind == "full":
            return symbols
        return ca.tril2symm(symbols) if kind == "symmetric" else symbols - symbols.T


def skew(a: Any) -> Any:
    """The skew-symmetric matrix of a vector."""
    return ca.skew(a)


@dataclass(frozen=True)
class Expressions:
    """M and h of (15), and the residual F of the first-order form, in terms of symbols."""

    q: Any
    v: Any
    ydot: Any
    parameters: Any
    values: list[float]
    M: Any
    h: Any
    F: Any


def matrix_form(data: str, n: int) -> Expressions:
    """The expressions of (15) and the appendix. Since D2_i w = S_i w - d3_i x w / 2, only S_i is needed, not D2_i."""
    body = BODIES[data](n)
    given = Integrals(data == "dense")
    even = (body.C5 + np.swapaxes(body.C5, -1, -2)) / 2
    even4 = (body.C4 + np.swapaxes(body.C4, -1, -2)) / 2
    mass = given.table(np.array([[body.mass]]))
    c1, c2 = given.table(body.c1[:, None]), given.table(body.c2.T)
    C3, c6 = given.table(body.C3, "symmetric"), given.table(body.c6.T)
    C4 = [given.table(even4[:, a, b, None]) for a, b in PAIRS]
    C5 = [given.table(even[:, :, a, b], "symmetric") for a, b in PAIRS]
    c7 = [given.table(body.c7[:, :, k], "skew") for k in range(3)]
    c8, K = given.table(body.c8, "symmetric"), given.table(body.stiffness, "symmetric")

    q, v = ca.SX.sym("q", 7 + n), ca.SX.sym("v", 6 + n)
    ydot = ca.SX.sym("ydot", 13 + 2 * n)
    e, alpha, w, alphadot = q[3:7], q[7:], v[3:6], v[6:]
    e0, im = e[0], e[1:]
    Q = (e0**2 - ca.dot(im, im)) * ca.SX.eye(3) + 2 * im @ im.T + 2 * e0 * skew(im)

    S = [C4[k] + C5[k] @ alpha for k in range(6)]
    d3 = ca.vertcat(*((c6[k, :].T - c7[k] @ alpha).T for k in range(3)))
    c7dot = ca.vertcat(*((c7[k] @ alphadot).T for k in range(3)))
    d1, d1dot = c1 + c2 @ alpha, c2 @ alphadot
    J = C3 + tensor([ca.dot(alpha, C4[k] + S[k]) for k in range(6)])
    Sdot, d3dot = tensor([ca.dot(alphadot, s) for s in S]), d3 @ alphadot

    B = ca.horzcat((Q @ c2).T, d3.T)
    rigid = ca.blockcat([[mass * ca.SX.eye(3), -Q @ skew(d1)], [skew(d1) @ Q.T, J]])
    M = ca.blockcat([[rigid, B.T], [B, c8]])
    wSw = sum((S[k] * (w[a] * w[b] * (1 if a == b else 2)) for k, (a, b) in enumerate(PAIRS)), ca.SX(n, 1))
    h = ca.vertcat(
        Q @ (ca.cross(w, ca.cross(w, d1)) + 2 * ca.cross(w, d1dot)),
        ca.cross(w, J @ w) + 2 * Sdot @ w + ca.cross(w, d3dot),
        K @ alpha - wSw - 2 * c7dot.T @ w,
    )
    rates = ca.vertcat(v[:3], -ca.dot(im, w) / 2, (e0 * w + ca.cross(im, w)) / 2, alphadot)
    F = ca.vertcat(ydot[: 7 + n] - rates, M @ ydot[7 + n :] + h)
    return Expressions(q, v, ydot, ca.vertcat(*given.symbols), given.values, M, h, F)


def tensor(pairs: list[Any]) -> Any:
    """The symmetric tensor of six components."""
    a, b, c, d, e, f = pairs
    return ca.blockcat([[a, b, c], [b, d, e], [c, e, f]])


def result(item: str, expressions: Expressions, cj: Any) -> Any:
    """The lower triangle of M, h, or the iteration matrix, without structural zeros."""
    if item == "force":
        return ca.densify(expressions.h)
    if item == "mass":
        return ca.sparsify(ca.tril(expressions.M))
    y = ca.vertcat(expressions.q, expressions.v)
    return ca.sparsify(ca.jacobian(expressions.F, y) + cj * ca.jacobian(expressions.F, expressions.ydot))


def main(argv: list[str]) -> None:
    data, size, item, folder = argv[0], int(argv[1]), argv[2], Path(argv[3])
    start = time.perf_counter()
    form = matrix_form(data, size)
    cj = ca.SX.sym("cj")
    expr = result(item, form, cj)
    shape = expr.sparsity()
    flat = ca.vertcat(*expr.nonzeros())
    arguments = {"mass": [form.q], "force": [form.q, form.v], "jacobian": [form.q, form.v, form.ydot, cj]}[item]
    name = f"casadi_{item}"
    function = ca.Function(name, [*arguments, form.parameters], [ca.cse(flat)])
    function.generate(f"{name}.c", {"with_header": False})
    seconds = time.perf_counter() - start
    Path(f"{name}.c").rename(folder / f"{name}.c")
    np.array(form.values).tofile(folder / "parameters.bin")
    row, col = shape.get_triplet()
    np.savez(folder / f"{name}.npz", row=row, col=col)
    kinds = (function.instruction_id(k) for k in range(function.n_instructions()))
    figures = {
        "seconds": seconds,
        "operations": sum(kind not in NO_OPERATION for kind in kinds),
        "bytes": (folder / f"{name}.c").stat().st_size,
        "size": int(flat.numel()),
        "work": function.sz_w(),
        "arguments": len(arguments) + 1,
    }
    print(json.dumps(figures))


if __name__ == "__main__":
    main(sys.argv[1:])
