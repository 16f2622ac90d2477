"""Generated accelerations of a body in the mean frame, compared with the dense Cholesky solution of LAPACK."""

from __future__ import annotations

import shlex
from pathlib import Path

import numpy as np
from bodies import states
from interleaved import TimedCall, interleaved
from limited import limited

import derive
from derive.backends.c.source import CBackend
from derive.runtime.compiler import compiler

STATES = 8
TOLERANCE = 1e-9
"""The largest relative difference; it exceeds rounding errors because of the condition number of the system."""

LAPACK = """
void scipy_dposv_(const char *, const int *, const int *, double *, const int *, double *, const int *, int *, long);
static void solve(double *A, double *b)
{
    const int n = %(n)d, one = 1;
    int info;
    scipy_dposv_("L", &n, &one, A, &n, b, &n, &info, 1L);
    if (info) exit(6);
}
static void spread(const double *M, const double *h, const double *positions, double *A, double *b)
{
    memset(A, 0, %(n)d * %(n)d * sizeof(double));
    for (int i = 0; i < %(nnz)d; i++) A[(int) positions[i]] = M[i];
    for (int i = 0; i < %(n)d; i++) b[i] = -h[i];
}
"""


def openblas() -> Path | None:
    """The path of the OpenBLAS library in the wheel of SciPy, if there is one."""
    import scipy

    return next((Path(scipy.__file__).parent.parent / "scipy.libs").glob("libscipy_openblas-*.so"), None)


def accelerations(size: int, flags: str, repeats: int, folder: Path) -> dict[str, float]:
    """Times (ns) of M and h, of generated accelerations, of the LAPACK solution, and of the latter with M and h."""
    spec = derive.symbolic_body("body", size, frame="mean", lowering="loops")
    model = derive.lower(derive.derive(spec))
    derive.write(CBackend().files(model, "a benchmark"), folder)
    source = folder / "body" / "body.c"
    command = [*compiler(), *shlex.split(flags), "-w", "-c", source, "-o", source.with_suffix(".o")]
    limited(command)
    shape = model.pattern("mass", "M")
    n, nq, nnz = 6 + size, 7 + size, len(shape.rowidx)
    rng = np.random.default_rng(size)
    p = np.array(model.defaults) + rng.uniform(0, 0.01, len(model.defaults))
    lapack = openblas()
    given = f"0.0, q + s * {nq}, v + s * {n}, k"
    both = f"body_mass_force({given}, M, h);"
    calls = [TimedCall("M and h", both, 1), TimedCall("accel", f"body_accel({given}, out);", n)]
    if lapack:
        copied = "memcpy(A, As + s * NN, NN * sizeof(double)); memcpy(out, bs + s * N, N * sizeof(double));"
        calls += [
            TimedCall("dposv, with the copy that it overwrites", f"{copied} solve(A, out);", n),
            TimedCall("M and h, spread, dposv", f"{both} spread(M, h, positions, A, out); solve(A, out);", n),
        ]
    fill = f"{both} spread(M, h, positions, As + s * NN, bs + s * N);" if lapack else ""
    times, values = interleaved(
        calls,
        declare=f'#include "{source.with_suffix(".h").resolve()}"\nenum {{ N = {n}, NN = N * N }};\n'
        + (LAPACK % {"n": n, "nnz": nnz} if lapack else ""),
        once=f"if (body_setup(p, k)) return 5; for (int s = 0; s < STATES; s++) {{ {fill} }}",
        arrays={
            "p": p,
            "positions": np.array([j * n + i for i, j in shape.entries], dtype=float),
            **{name: a for name, a in states(size, STATES).items() if name in ("q", "v")},
        },
        scratch={
            "k": sum(v.size for v in model.constants),
            "M": nnz,
            "h": n,
            "A": n * n,
            "As": n * n * STATES,
            "bs": n * STATES,
        },
        objects=[source.with_suffix(".o")],
        folder=folder,
        states=STATES,
        repeats=repeats,
        libraries=[str(lapack), f"-Wl,-rpath,{lapack.parent}"] if lapack else [],
    )
    for other in values[2:]:
        error = np.max(np.abs(values[1] - other)) / np.max(np.abs(other))
        if not error < TOLERANCE:
            raise ArithmeticError(f"accelerations are off by {error:.1e}")
    return {call.name: t for call, t in zip(calls, times, strict=True)}
