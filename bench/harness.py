"""Compile a variant of M and h with a loop around it, check its values, count its instructions, measure its time."""

from __future__ import annotations

import statistics
import subprocess
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from callgrind import Count, count
from numpy.typing import NDArray

from derive.runtime.compiler import compiler

Matrix = NDArray[np.float64]

ROUNDS = 100
REPEATS = 15
TOLERANCE = 1e-12


@dataclass(frozen=True)
class Variant:
    """An implementation of M and h in C.

    files: their texts by name. function: the function whose instructions are counted. declare: its declarations. once:
    C text before the loop, which may use the parameters p. call: C text in the loop; it computes M and h from q and v.
    """

    name: str
    files: dict[str, str]
    function: str
    declare: str
    once: str
    call: str


@dataclass(frozen=True)
class Inputs:
    """Parameters p, states (n, 2 nv) with rows [q, v], the number nnz of stored values of M, and the size nv of h."""

    p: tuple[float, ...]
    states: Matrix
    nnz: int
    nv: int


@dataclass(frozen=True)
class Measured:
    """Instructions and nanoseconds of an evaluation of a variant."""

    name: str
    instructions: Count
    nanoseconds: float


# Without an argument the program prints the values of all states. The first argument is a number of evaluations, the
# second a number of repeats, whose times are printed. The function is in another file, so that it is not inlined.
MAIN = """\
#define _POSIX_C_SOURCE 199309L
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
{declare}

enum {{ STATES = {rows}, NV = {nv}, NNZ = {nnz} }};
static const double states[STATES][2 * NV] = {{
{states}
}};
static const double p[] = {{{p}}};
static double M[NNZ], h[NV];

static double now(void)
{{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return 1e9 * (double) t.tv_sec + (double) t.tv_nsec;
}}

int main(int argc, char **argv)
{{
    const long evaluations = argc > 1 ? atol(argv[1]) : STATES;
    const long repeats = argc > 2 ? atol(argv[2]) : 1;
    (void) p;
    {once}
    for (long repeat = 0; repeat < repeats; repeat++) {{
        const double start = now();
        for (long i = 0; i < evaluations; i++) {{
            const double *q = states[i % STATES], *v = q + NV;
            {call};
            if (argc == 1) {{
                for (int j = 0; j < NNZ; j++) printf("%.17g ", M[j]);
                for (int j = 0; j < NV; j++) printf("%.17g ", h[j]);
                puts("");
            }}
        }}
        if (argc > 2) printf("%.17g\\n", (now() - start) / (double) evaluations);
    }}
    return 0;
}}
"""


def program(variant: Variant, inputs: Inputs, flags: tuple[str, ...], folder: Path) -> Path:
    """The compiled program of a variant with its main function."""
    folder.mkdir()
    rows = ",\n".join("    {" + ", ".join(map(repr, row.tolist())) + "}" for row in inputs.states)
    main = MAIN.format(
        declare=variant.declare, once=variant.once, call=variant.call, rows=len(inputs.states), nv=inputs.nv,
        nnz=inputs.nnz, states=rows, p=", ".join(map(repr, inputs.p)),
    )  # fmt: skip
    files = {"main.c": main, **variant.files}
    for name, text in files.items():
        (folder / name).write_text(text)
    out = folder / "program"
    sources = [str(folder / name) for name in files if name.endswith(".c")]
    subprocess.run([*compiler(), *flags, "-o", str(out), *sources, "-lm"], check=True)
    return out


def values(path: Path) -> Matrix:
    """The values (states, nnz + nv) of M and h that a program computes."""
    text = subprocess.run([str(path)], capture_output=True, text=True, check=True).stdout
    return np.array([[float(word) for word in line.split()] for line in text.splitlines()])


def instructions(path: Path, variant: Variant, inputs: Inputs) -> Count:
    """The instructions of an evaluation, as the mean over all states."""
    return count(path, variant.function, 10 * len(inputs.states))


def nanoseconds(path: Path, inputs: Inputs) -> float:
    """The CPU time (ns) of an evaluation and its call, as the median over the repeats."""
    evaluations = str(ROUNDS * 10 * len(inputs.states))
    text = subprocess.run([str(path), evaluations, str(REPEATS)], capture_output=True, text=True, check=True).stdout
    return statistics.median(map(float, text.split()))


def measure(
    variant: Variant, inputs: Inputs, flags: tuple[str, ...], folder: Path, reference: Matrix | None
) -> Measured:
    """The instructions and the time of a variant. Raises ArithmeticError if its values differ from `reference`."""
    path = program(variant, inputs, flags, folder)
    if reference is not None:
        error = np.max(np.abs(values(path) - reference) / (1.0 + np.abs(reference)))
        if not error < TOLERANCE:
            raise ArithmeticError(f"{variant.name} is off by {error:.1e}")
    return Measured(variant.name, instructions(path, variant, inputs), nanoseconds(path, inputs))
