"""Interleaved timing: several implementations run alternately in one process, so that other load affects all of them.

The program reads arrays from files and writes the values of each implementation to a file.
"""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from derive.runtime.compiler import compiler

Array = NDArray[np.float64]

COPIES = 4
"""The copies of a program that run one after the other. Each lies in other pages of memory, and the same instructions
took up to 60 % longer in some of them (measured on the machine of the README): the least time is that of good ones."""


@dataclass(frozen=True)
class TimedCall:
    """An implementation: C text `call` that computes `size` values of state s into `out`.

    together: the number of states that the call computes, from s on.
    """

    name: str
    call: str
    size: int
    together: int = 1


MAIN = """\
#define _POSIX_C_SOURCE 199309L
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
%(declare)s

enum { CALLS = %(calls)d, STATES = %(states)d, REPEATS = %(repeats)d };
static double *out;
static int timing; /* the values have been written: peers need not copy their results any more */

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t); /* other programs that run meanwhile do not count */
    return 1e9 * (double) t.tv_sec + (double) t.tv_nsec;
}

static double *array(size_t count)
{
    double *x = (double *) aligned_alloc(64, (count * sizeof(double) / 64 + 1) * 64);
    if (!x) exit(3);
    memset(x, 0, count * sizeof(double));
    return x;
}

static double *loaded(const char *path, size_t count)
{
    double *x = array(count);
    FILE *file = fopen(path, "rb");
    if (!file || fread(x, sizeof(double), count, file) != count) exit(4);
    fclose(file);
    return x;
}

%(data)s
%(functions)s
typedef void (*timed_call)(int s);
static const timed_call calls[] = {%(names)s};
static const int sizes[] = {%(sizes)s}, together[] = {%(together)s};

int main(void)
{
    out = array(%(largest)d);
%(load)s
    for (int w = 0; w < CALLS; w++) {
        char path[64];
        sprintf(path, "values_%%d.bin", w);
        FILE *file = fopen(path, "wb");
        for (int s = 0; s < STATES; s += together[w]) {
            calls[w](s);
            fwrite(out, sizeof(double), (size_t) sizes[w], file);
        }
        fclose(file);
    }
    timing = 1;
    long passes[CALLS];
    for (int w = 0; w < CALLS; w++) {
        passes[w] = 1;
        for (;;) {
            const double start = now();
            for (long k = 0; k < passes[w]; k++) for (int s = 0; s < STATES; s += together[w]) calls[w](s);
            if (now() - start > %(minimum)g) break;
            passes[w] *= 2;
        }
    }
    for (int r = 0; r < REPEATS; r++)
        for (int w = 0; w < CALLS; w++) {
            const double start = now();
            for (long k = 0; k < passes[w]; k++) for (int s = 0; s < STATES; s += together[w]) calls[w](s);
            printf("%%.17g\\n", (now() - start) / (double) passes[w] / STATES);
        }
    return 0;
}
"""


def interleaved(
    calls: Sequence[TimedCall],
    *,
    declare: str,
    once: str,
    arrays: Mapping[str, Array],
    scratch: Mapping[str, int],
    objects: Sequence[Path],
    folder: Path,
    states: int,
    repeats: int,
    libraries: Sequence[str] = (),
    minimum: float = 1e6,
    statistic: Callable[..., Array] = np.median,
) -> tuple[list[float], list[Array]]:
    """The median CPU time (ns) per state, or another `statistic` of it, and the values of each call.

    declare, once: C text before the functions, and after the arrays are loaded. arrays: arrays by name, for use in C.
    scratch: sizes of further arrays. objects, libraries: files to link. folder: for the program and its data. states:
    the number of states. repeats: the number of measurements of each call, each of at least `minimum` ns.
    """
    for name, values in arrays.items():
        np.ascontiguousarray(values, dtype=np.float64).tofile(folder / f"{name}.bin")
    names = [*arrays, *scratch]
    load = [f'    {name} = loaded("{name}.bin", {values.size});' for name, values in arrays.items()]
    load += [f"    {name} = array({size});" for name, size in scratch.items()]
    text = MAIN % {
        "declare": declare,
        "calls": len(calls),
        "states": states,
        "repeats": -(-repeats // min(COPIES, repeats)),
        "data": "\n".join(f"static double *{name};" for name in names),
        "functions": "\n".join(f"static void call_{n}(int s) {{ {call.call} }}" for n, call in enumerate(calls)),
        "names": ", ".join(f"call_{n}" for n in range(len(calls))),
        "sizes": ", ".join(str(call.size) for call in calls),
        "together": ", ".join(str(call.together) for call in calls),
        "largest": max(call.size for call in calls) + 8,
        "load": "\n".join([*load, f"    {once}"]),
        "minimum": minimum,
    }
    (folder / "main.c").write_text(text)
    program = folder / "program"
    command = [*compiler(), "-O1", "-w", "-o", program, folder / "main.c", *objects, *libraries, "-lm"]
    subprocess.run(list(map(str, command)), check=True)
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}
    copies = min(COPIES, repeats)
    lines: list[str] = []
    for number in range(copies):
        copy = shutil.copy(program, folder / f"program_{number}")
        result = subprocess.run([str(copy)], cwd=folder, env=environment, stdout=subprocess.PIPE, text=True, check=True)
        lines += result.stdout.split()
    times = np.array(lines, dtype=float).reshape(-1, len(calls))
    values = [np.fromfile(folder / f"values_{n}.bin").reshape(-1, call.size) for n, call in enumerate(calls)]
    return statistic(times, axis=0).tolist(), values
